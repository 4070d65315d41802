#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/lcp/fresh_pass.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// What fresh_benchmark times: a solver, and where it runs.
class Contestant {
 public:
  Contestant(std::string key, bool is_own, const char* place) : key_(std::move(key)), is_own_(is_own), place_(place) {}
  virtual ~Contestant() = default;
  Contestant(const Contestant&) = delete;
  Contestant& operator=(const Contestant&) = delete;

  const std::string& key() const { return key_; }
  bool is_own() const { return is_own_; }              ///< else a peer
  const char* place() const { return place_; }         ///< where the timed passes run, in words
  virtual bool is_elsewhere() const { return false; }  ///< they run in another process

  /// "" or the rule by which it is not given problems of this size.
  virtual std::string WhyRefused(Index rows) const = 0;
  /// Solves one problem, which nothing else is told of, within the time limit. @param seconds  what it took
  virtual LcpResult Judge(const LcpProblem& problem, const ProblemArrays& arrays, const LcpOptions& options,
                          double* seconds) = 0;
  /// lcpbench::RunPass. @param stream  the same until it is told otherwise: BeginStream
  /// @throws WorkerFailure where another process did not come to its end
  virtual PassReply Pass(std::span<const ProblemArrays> stream, const PassRequest& request) = 0;
  /// The next pass is over another stream than before.
  virtual void BeginStream() {}

 private:
  std::string key_;
  bool is_own_;
  const char* place_;
};

/// By keys of the registry. Own solvers run in this process. So do peers whose libraries are linked into this program
/// (linked_peers.h); but each problem is judged by their workers first, so that what crashes or hangs there is never
/// timed here. Other peers run in their workers.
/// @param only_workers  linked peers run in their workers, too
/// @param from_rows     timed from an engine's arrays (StepRows) instead of ProblemArrays: `auto` as StepSolver, and
///                      codes of linked peers that take a dense A, which is assembled from the rows on their clock.
///                      Problems without such arrays are refused (InputError) when they are met.
/// @throws InputError for an unknown key, a solver that is not in this build, or one that takes no rows
std::vector<std::unique_ptr<Contestant>> MakeContestants(const std::vector<std::string>& keys, bool only_workers,
                                                         bool from_rows);

}  // namespace lcpbench
