#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/solver.h"
#include "solvers/rows/row_input.h"

/// Internal to solvers/.
namespace lcpbench {

/// What the engines of all first-order solvers (solvers/lcp/engine_solver.h) have in common: the rows, passes over them
/// that read the clock as they go, and when a solve is over and what it then returns.
///
/// A check makes the image of f afresh, so that no rounding of earlier passes is left in it, and evaluates rho of the
/// scaled problem: about two sweeps. Where rho meets the tolerance, rho and the backward error are evaluated by the
/// *given* form in extended precision (from arrays: RowJudge), and only that makes a kSolved. The iterate of least rho
/// among those checked (the start and, but for the time limit, the last one are) is kept and returned.
class FirstOrderEngine {
 public:
  /// Multiply-adds between two readings of the clock, about 20 us.
  static constexpr Index kEntriesPerClockRead = Index{1} << 15;

  std::string WhyUnsupported(const LcpProblem& problem) const;

 protected:
  struct Setup {
    RowForm form = RowForm::kAuto;
    bool coloured = true;
    bool needs_symmetry = false;     ///< refuses A that is not numerically symmetric
    bool end_when_hopeless = false;  ///< see NncgOptions
    std::int64_t hopeful_iterations = 0;
    std::int64_t default_limit = 0;  ///< iterations where LcpOptions names no limit
  };
  explicit FirstOrderEngine(const Setup& setup) : setup_(setup) {}

  void PrepareRows(const LcpProblem& problem);
  /// Before Iterate: b and the start, of the prepared problem or one that shares its matrix.
  void TakeProblem(const LcpProblem& problem, const LcpOptions& options);
  /// Before Iterate: rows, b and the start of a task, which must outlive it. False where a row acts on no body that can
  /// move, or `form` asks for other rows.
  bool TakeRows(const RowTask& task);

  /// A solve of what was taken. `step` makes one iteration on rows_.x and returns the norm of the natural residuals
  /// that its last pass saw, or nothing if ForAllRows returned false.
  template <typename Step>
  void Iterate(const LcpOptions& options, LcpResult* result, const Step& step) {
    bool over = Start(options, result);
    while (!over) {
      const std::optional<double> residual = step();
      over = residual.has_value() ? Continue(*residual) : EndOutOfTime();
    }
    Finish();
  }

  /// Calls pass(begin, end) on ranges that cover all rows, from the last range on if `backward`. False, and not all
  /// rows done, when the time is up.
  template <typename Pass>
  bool ForAllRows(bool backward, const Pass& pass) {
    const Index n = rows_.scaled.size;
    for (Index done = 0; done < n;) {
      const Index take = std::min(n - done, chunk_ - unread_);
      const Index begin = backward ? n - done - take : done;
      pass(begin, begin + take);
      done += take;
      unread_ += take;
      if (unread_ >= chunk_ && Expired()) return false;
    }
    return true;
  }
  /// A Gauss-Seidel pass.
  bool Sweep(bool backward, double omega, StepSums* sums) {
    return ForAllRows(backward,
                      [&](Index begin, Index end) { rows_.rows->Sweep(begin, end, backward, omega, &rows_.x, sums); });
  }

  RowWork rows_;

 private:
  bool Start(const LcpOptions& options, LcpResult* result);
  bool Continue(double residual);
  bool EndOutOfTime();
  void Finish();
  bool Check();
  bool Claim();
  bool Passes();
  bool IsHopeless(double residual);
  bool Expired();

  const Setup setup_;
  GivenFormTest given_;            // of a problem
  const RowTask* task_ = nullptr;  // nullptr: the solve begins at a problem
  Array best_;
  double best_rho_ = 0;
  bool claimed_ = false;  // the result has f
  double tolerance_ = 0;
  std::int64_t limit_ = 0;
  std::int64_t unchecked_ = 0;  // iterations since the last check
  std::int64_t patience_ = 1;   // iterations between checks that the residual asks for
  double first_log_residual_ = 0;
  const LcpOptions* options_ = nullptr;
  std::optional<Deadline> deadline_;  // from the first reading of the clock on
  Index chunk_ = 1;                   // rows between two readings of the clock
  Index unread_ = 0;                  // rows since the last one
  LcpResult* result_ = nullptr;
};

}  // namespace lcpbench
