#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "solvers/lcp/settings.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// A physics engine's dense Dantzig code: A x = b + w, lo <= x <= hi, with A row after row, rows `stride` apart. So
/// b = -b of ours. It may overwrite everything it is given.
struct DantzigProblem {
  int rows = 0;
  int stride = 0;
  double* A = nullptr;
  double* x = nullptr;
  double* b = nullptr;
  double* w = nullptr;
  double* lower = nullptr;
  double* upper = nullptr;
  /// Per row the normal row of a friction row, else -1. `upper` of a friction row is mu; where the code comes to the
  /// first one it puts mu times the normal force of then in its place, and minus that in `lower`. It permutes findex
  /// and the bounds.
  int* findex = nullptr;
  bool has_friction = false;  ///< not all of findex is -1
};

/// Adapter of such a code. Bilateral rows are boxes (-inf, inf). Friction rows are pivoted after all others, within
/// bounds that the normal forces without friction gave once: FrictionModel::kFrozenBounds. Any number of them may share
/// a normal row. The codes have no tolerance, no limits and no way to
/// stop: the host's time limit ends them. A is assembled into the memory that the code works on and destroys, as an
/// engine does each step, and once more for every further solve of the same matrix. Dense: O(n^2) memory.
class DantzigPeer : public LcpSolver {
 public:
  /// What the engines' users take, and enough to get through redundant rows.
  static constexpr double kEngineCfm = 1e-9;
  /// One library's code.
  struct Code {
    /// How many doubles lie between the beginnings of two rows.
    int (*stride)(int rows) = nullptr;
    /// The call alone: false where the code says it failed.
    bool (*call)(const DantzigProblem& problem) = nullptr;
    /// What a code of another data layout does around each call, timed as conversion; may be null.
    void (*before)(const DantzigProblem& problem) = nullptr;
    void (*after)(const DantzigProblem& problem) = nullptr;
  };

  /// Setting `cfm`, constraint force mixing: what is added to the diagonal, relative to its largest entry, in [0, 1]; 0
  /// is the plain code, the default kEngineCfm for keys that end in "-cfm". Engines add about 1e-9 ... 1e-5, which
  /// makes redundant contacts nonsingular and forces slightly soft.
  DantzigPeer(std::string_view key, SettingsReader* reader, Code code)
      : cfm_(reader->Number("cfm", key.ends_with("-cfm") ? kEngineCfm : 0, 0, 1)), code_(code) {}

  bool TakesFriction() const override { return true; }
  bool TakesBounded() const override { return true; }
  std::string WhyUnsupported(const LcpProblem& problem) const override;

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;
  bool DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) override;

 private:
  using Doubles = std::vector<double, Eigen::aligned_allocator<double>>;

  void Assemble(const ProblemView& given);
  /// On A_ as assembled.
  void Run(const ProblemView& given, const LcpOptions& options, LcpResult* result);
  /// Sets the bounds of friction and bounded rows.
  void SetBounds(const ProblemView& given);
  void TakeBounds(const ProblemView& given, LcpResult* result) const;

  double cfm_;
  Code code_;
  bool is_whole_ = false;  // A_, as assembled
  Doubles A_, b_, lower_, upper_, x_, w_;
  std::vector<int> findex_;
};

/// Rows of ODE and of what was taken from it lie a multiple of four apart.
constexpr int PadToFour(int rows) {
  constexpr int kLast = 3;
  return (rows + kLast) & ~kLast;
}

}  // namespace lcpbench
