// DART's LCP solvers: a Dantzig code that descends from ODE's, and projected Gauss-Seidel. Both take
// A x = b + w with rows of A padded to a multiple of four, and destroy A and b.
//
// Dantzig returns whether it succeeded, and gives up at the first step without positive length if asked to
// (early termination), as the engine itself asks, since it falls back on Gauss-Seidel then. Otherwise it carries on
// with "hacks" (its own word) and returns true, whatever comes of it. Option early-termination: yes, as in the engine,
// or no.
//
// Gauss-Seidel returns true when no force changed by more than a tolerance in the first sweep (absolute, in the unit of
// force) or a later one (relative to the force; forces below 1e-9 are not looked at), false after its number of sweeps.
// Rows with A_ii < 1e-9 are left at zero. It starts from what x holds. It has no clock: sweeps are asked for in
// portions and the time read in between; that only repeats the first-sweep test. An iteration is a sweep asked for: how
// many of the last portion were made it does not tell.

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <dart/config.hpp>
#include <dart/constraint/DantzigBoxedLcpSolver.hpp>
#include <dart/constraint/PgsBoxedLcpSolver.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "solvers/peers/dantzig_peer.h"
#include "solvers/peers/given_matrix.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

using dart::constraint::DantzigBoxedLcpSolver;
using dart::constraint::PgsBoxedLcpSolver;

static_assert(EIGEN_MAX_ALIGN_BYTES == 16,
              "libdart passes Eigen objects and was built for plain x86-64: no -march=native here");

template <bool kEarlyTermination>
bool CallDantzig(const DantzigProblem& p) {
  static DantzigBoxedLcpSolver solver;
  return solver.solve(p.rows, p.A, p.x, p.b, 0, p.lower, p.upper, p.findex, kEarlyTermination);
}

class Pgs : public LcpSolver {
 public:
  struct Options {
    bool as_the_library_has_it = false;
    PeerTolerance relative_tolerance;
    bool randomize = false;
    double epsilon_for_division = 1e-9;
  };

  explicit Pgs(Options options) : options_(std::move(options)) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    Assemble(problem);
    lower_.setZero(problem.size());
    upper_.setConstant(problem.size(), std::numeric_limits<double>::infinity());
    for (const Index row : problem.bilateral_rows()) lower_[row] = -std::numeric_limits<double>::infinity();
    findex_.assign(static_cast<std::size_t>(rows_), -1);
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    TimeConversion(options, result, [&] {
      if (!is_whole_) Assemble(problem);
      is_whole_ = false;
      b_ = -problem.b();
      if (options.initial_f != nullptr) result->f = *options.initial_f;
    });
    PgsBoxedLcpSolver::Option option;
    std::int64_t most = option.mMaxIteration;
    if (!options_.as_the_library_has_it) {
      // The first sweep's threshold has the unit of force: never stop by it, but where nothing moves at all.
      option.mDeltaXThreshold = 0;
      option.mRelativeDeltaXTolerance = options_.relative_tolerance.For(options);
      option.mRandomizeConstraintOrder = options_.randomize;
      option.mEpsilonForDivision = options_.epsilon_for_division;
      most = static_cast<std::int64_t>(TierIterations("dart-pgs"));
    }
    if (options.max_iterations > 0) most = options.max_iterations;
    const Deadline deadline(options);
    TimeLibraryCall(options, result, [&] { Sweep(option, most, deadline, result); });
  }

 private:
  // About 20 ms of work: short beside any time limit, long beside what the repeated first test costs.
  static constexpr double kPortion = 2e7;  // products

  void Assemble(const LcpProblem& problem) {
    rows_ = static_cast<int>(problem.size());
    A_.resize(problem.size(), PadToFour(rows_));
    WriteDenseRows(problem, PadToFour(rows_), A_.data());
    is_whole_ = true;
  }

  void Sweep(PgsBoxedLcpSolver::Option option, std::int64_t most, const Deadline& deadline, LcpResult* result) {
    const auto products = static_cast<double>(A_.size());
    const auto portion = std::max<std::int64_t>(1000, static_cast<std::int64_t>(kPortion / products));
    result->iterations = 0;
    while (result->iterations < most) {
      option.mMaxIteration = static_cast<int>(std::min(portion, most - result->iterations));
      solver_.setOption(option);
      result->iterations += option.mMaxIteration;
      if (solver_.solve(rows_, A_.data(), result->f.data(), b_.data(), 0, lower_.data(), upper_.data(), findex_.data(),
                        false)) {
        result->status = LcpStatus::kSolved;
        return;
      }
      if (deadline.Expired()) {
        result->status = LcpStatus::kTimeLimit;
        return;
      }
    }
    result->status = LcpStatus::kIterationLimit;
  }

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  Options options_;
  PgsBoxedLcpSolver solver_;
  int rows_ = 0;
  bool is_whole_ = false;  // A_, as assembled
  RowMajor A_;
  Eigen::VectorXd b_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
  std::vector<int> findex_;
};

std::unique_ptr<LcpSolver> Make(std::string_view key, const Settings& settings) {
  SettingsReader reader(key, settings);
  if (key.starts_with("dart-dantzig")) {
    const bool early = reader.Choice("early-termination", "yes", {"yes", "no"}) == "yes";
    return std::make_unique<DantzigPeer>(
        DantzigPeer::Options::FromSettings(key, &reader),
        DantzigPeer::Code{&PadToFour, early ? &CallDantzig<true> : &CallDantzig<false>});
  }
  Pgs::Options options;
  options.as_the_library_has_it = key == "dart-pgs-default";
  if (!options.as_the_library_has_it) {
    options.relative_tolerance = PeerTolerance(key, &reader, "relative-tolerance");
    options.randomize = reader.Choice("randomize", "no", {"no", "yes"}) == "yes";
    options.epsilon_for_division = reader.Number("epsilon-for-division", options.epsilon_for_division, 0, 1);
  }
  reader.Finish();
  return std::make_unique<Pgs>(options);
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  // The library does not tell its version at run time.
  return {DART_VERSION, &Make};
}

}  // namespace lcpbench
