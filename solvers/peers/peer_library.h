#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"
#include "solvers/peers/peer_table.h"

namespace lcpbench {

/// What one worker executable is built from: an adapter file defines ThisPeerLibrary() and is linked with
/// worker_main.cc and the one library.
struct PeerLibrary {
  std::string version;  ///< as the library itself says, where it does
  /// One of its solvers, by the key in peer_table.h. @throws InputError for impossible settings
  std::unique_ptr<LcpSolver> (*make)(std::string_view key, SettingsReader* reader) = nullptr;
};
PeerLibrary ThisPeerLibrary();

/// PeerLibrary::make of a library with one adapter for all of its keys.
template <typename Adapter>
std::unique_ptr<LcpSolver> MakePeer(std::string_view key, SettingsReader* reader) {
  return std::make_unique<Adapter>(key, reader);
}

/// What a library prints as it solves goes nowhere from the first call on, once per process: nobody reads it, and a
/// campaign's terminal would drown in it. Not before the worker has greeted the host, which it does on standard output.
inline void SilenceLibrary() {
  static const bool is_silent = [] {
    std::fflush(nullptr);
    return std::freopen("/dev/null", "w", stdout) != nullptr && std::freopen("/dev/null", "w", stderr) != nullptr;
  }();
  static_cast<void>(is_silent);
}

/// max_iterations if given, else `usual`; what an int holds of it.
inline int IterationLimit(const LcpOptions& options, double usual) {
  const double most = options.max_iterations > 0 ? static_cast<double>(options.max_iterations) : usual;
  return static_cast<int>(std::min<double>(most, std::numeric_limits<int>::max()));
}

/// What the requested tier means to a solver whose tolerance follows it; nothing to keys that end in "-default", whose
/// library decides.
class PeerTier {
 public:
  PeerTier() = default;
  /// The setting `tolerance` wins over the table of peer_table.cc.
  PeerTier(std::string_view key, SettingsReader* reader, const char* setting = "tolerance")
      : key_(key), is_library_default_(key.ends_with("-default")) {
    if (!is_library_default_) chosen_ = reader->Number(setting, 0, 0, 1);
  }
  bool is_library_default() const { return is_library_default_; }
  double Tolerance(const LcpOptions& options) const {
    return chosen_ > 0 ? chosen_ : TierTolerance(key_, options.tolerance);
  }
  /// @param usual  where the library decides
  int Iterations(const LcpOptions& options, double usual = 0) const {
    return IterationLimit(options, is_library_default_ ? usual : TierIterations(key_));
  }

 private:
  std::string key_;
  bool is_library_default_ = false;
  double chosen_ = 0;
};

/// WhyUnsupported of solvers of quadratic programs.
inline std::string WhyNotQuadraticProgram(const LcpProblem& problem) {
  return problem.IsNumericallySymmetric() ? "" : "A is not symmetric, so the LCP is not the optimality of a QP";
}

/// WhyUnsupported of codes whose friction rows have bounds that follow from normal forces.
inline std::string WhySliding(std::span<const FrictionRow> friction) {
  return std::ranges::any_of(friction, [](const FrictionRow& row) { return row.slip != 0; }) ? "sliding rows" : "";
}

/// What the words of a setting stand for; the first is the library's own choice.
template <typename Value, std::size_t n>
Value Choose(SettingsReader* reader, const char* setting, const std::pair<std::string_view, Value> (&choices)[n]) {
  const auto read = [&]<std::size_t... k>(std::index_sequence<k...>) {
    return reader->Choice(setting, choices[0].first, {choices[k].first...});
  };
  const std::string chosen = read(std::make_index_sequence<n>());
  return std::find_if(choices, choices + n, [&](const auto& choice) { return choice.first == chosen; })->second;
}

/// The status that a library's code of its end stands for, kNumericalFailure where it is not `known`, and the detail of
/// a failure or infeasibility.
/// @param said  in the library's words
template <typename Code, std::size_t n>
void Report(const std::pair<Code, LcpStatus> (&known)[n], Code code, const std::string& said, LcpResult* result) {
  const auto* found = std::find_if(known, known + n, [code](const auto& end) { return end.first == code; });
  result->status = found == known + n ? LcpStatus::kNumericalFailure : found->second;
  const bool failed = result->status == LcpStatus::kNumericalFailure || result->status == LcpStatus::kInfeasible;
  if (failed) result->detail = said;
}

/// Adds the seconds that `work` takes to `*sum`, which is negative while nothing is known, where parts are wanted.
template <typename Work>
void TimePart(const LcpOptions& options, double* sum, Work work) {
  const double start = options.time_parts ? SteadyNow() : 0;
  work();
  if (options.time_parts) *sum = (*sum > 0 ? *sum : 0) + (SteadyNow() - start);
}

/// Runs `work`, the library's call alone, and notes its time in the result where parts are wanted: adapters put
/// everything else (copies, padding, orderings) before or after.
template <typename Work>
void TimeLibraryCall(const LcpOptions& options, LcpResult* result, Work work) {
  TimePart(options, &result->own_solve_s, work);
}

/// The same for what a solve has to convert.
template <typename Work>
void TimeConversion(const LcpOptions& options, LcpResult* result, Work work) {
  TimePart(options, &result->own_convert_s, work);
}

/// Asks a code that has no clock for its sweeps in portions, about 20 ms of work each: short beside any time limit,
/// long beside what a portion costs besides. Writes status and iterations, which are sweeps asked for.
/// @param products  of one sweep
/// @param converges  bool(int sweeps): makes so many, or stops; whether nothing more is to be done
template <typename Converges>
void SweepInPortions(std::int64_t most, double products, const Deadline& deadline, LcpResult* result,
                     Converges converges) {
  constexpr double kPortion = 2e7;  // products
  const auto portion = std::max<std::int64_t>(1000, static_cast<std::int64_t>(kPortion / products));
  result->status = LcpStatus::kIterationLimit;
  result->iterations = 0;
  while (result->iterations < most) {
    const auto sweeps = static_cast<int>(std::min(portion, most - result->iterations));
    result->iterations += sweeps;
    if (converges(sweeps)) {
      result->status = LcpStatus::kSolved;
      return;
    }
    if (deadline.Expired()) {
      result->status = LcpStatus::kTimeLimit;
      return;
    }
  }
}

}  // namespace lcpbench
