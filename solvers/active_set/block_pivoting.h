#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/solver.h"
#include "solvers/linear_algebra/active_block.h"
#include "solvers/linear_algebra/scaled_lcp.h"
#include "solvers/rows/row_input.h"

namespace lcpbench {

/// Block principal pivoting inside a proximal-point loop, on any ActiveBlock: what `bpp`, `semismooth-newton` and `ipm`
/// share. The method is described at BppSolver. Internal to solvers/. Vectors are by row of the problem, in the units
/// of ScaledVectors. Only Reserve and a ray allocate.
class BlockPivoting {
 public:
  enum class End {
    kDone,            ///< the sink says so
    kInfeasible,      ///< with a ray
    kNotMet,          ///< the proximal loop ended above the tolerance
    kSingular,        ///< Rules::end_when_singular
    kCycling,         ///< Rules::end_when_cycling
    kGaveUp,          ///< too many rows violated for Rules
    kIterationLimit,  ///< Task::factors
    kStopped,         ///< the deadline passed, or the block has no factor
  };

  /// One problem and what to solve it with.
  struct Task {
    /// nullptr: rows that no LcpProblem holds. Nothing is refined in extended precision, and no ray is found.
    const LcpProblem* problem = nullptr;
    const ScaledVectors* scaled = nullptr;
    ActiveBlock* block = nullptr;        ///< loaded
    AnswerSink* sink = nullptr;          ///< judges the candidates
    const Deadline* deadline = nullptr;  ///< nullptr for none
    std::int64_t factors = 0;            ///< limit
    double tolerance = 0;
    /// Whether forces are corrected by conjugate gradients in double, preconditioned with the factor: faster than
    /// refinement, which follows in extended precision, but they magnify what of b is inconsistent with dependent rows.
    bool conjugate = false;
    /// Forces beside loaded bodies are rounding where those by A are 0 (BodySpace).
    bool through_bodies = false;
  };

  /// How far TakeProximalSteps goes.
  struct Rules {
    double weight = 1e-8;        ///< proximal weight e at the start, at least kLeastWeight
    double largest_weight = 1;   ///< see BppOptions::largest_proximal
    double weight_factor = 0.3;  ///< of e from one proximal step to the next
    int steps = 60;              ///< proximal ones
    int patience = 3;            ///< see BppOptions::patience
    bool end_when_singular = false;
    bool end_when_cycling = false;
    bool try_every_set = false;  ///< offers what solves A on it, clipped: worth while where factors are dear
    /// A set ends it that leaves more than this part of the least number of violated rows before it ...
    double progress = std::numeric_limits<double>::infinity();
    double most_wrong = 1;  ///< ... as does the first set with more than this part of all rows violated, ...
    double few_wrong = 0;   ///< ... unless at most this part is left
    std::int64_t factors = std::numeric_limits<std::int64_t>::max();  ///< of this call
  };
  static constexpr double kLeastWeight = 1e-11;
  /// Proofs of infeasibility are looked for above this tier, or above the tolerance if that is less.
  static constexpr double kProofTolerance = 1e-9;

  static constexpr Index kDependentShare = 50;  ///< see BppOptions::end_when_singular

  void Reserve(const LcpProblem& problem);
  void Reserve(Index rows);  ///< for tasks without a problem
  /// @param task  what it points to must outlive the runs
  void SetTask(const Task& task);
  /// F = all rows that can act, c = 0.
  void StartCold();
  /// F = {D f > w}, c = f.
  void StartFrom(const Eigen::VectorXd& f, const Eigen::VectorXd& w);
  /// The proximal loop from the latest start.
  End TakeProximalSteps(const Rules& rules);

  /// A factor of A_FF + weight D_FF within the limits of the task: kDone, or why it failed.
  End Factor(const std::vector<char>& active, double weight);
  /// Corrects f_F on A itself from the given F and f, with a new factor of that weight; rows that are violated then
  /// change sides while their number falls, from less than `most`; refines to rounding. kNotMet if no candidate was
  /// good enough.
  End Finish(const std::vector<char>& active, const Eigen::VectorXd& f, double weight, Index most);
  /// Whether the direction, made a ray by a few corrections, is accepted by VerifyFarkasRay; ray() is it then.
  bool FindRay(const Eigen::VectorXd& direction);

  /// The active set of the latest start; may be changed before TakeProximalSteps.
  std::vector<char>& active() { return active_; }
  /// The forces of the latest TakeProximalSteps or Finish, and w = A f + b.
  const Eigen::VectorXd& f() const { return f_; }
  const Eigen::VectorXd& w() const { return w_; }
  std::optional<Eigen::VectorXd>& ray() { return accepted_ray_; }
  std::int64_t factors() const { return factors_; }
  std::int64_t single_exchanges() const { return single_exchanges_; }

 private:
  End PivotBlocks(const Rules& rules);
  End SolveActive();
  End CorrectForces();
  bool Refine(double tolerance);
  End Polish(Index most, double tolerance);
  Index FindViolated(bool of_proximal);
  void Exchange(bool least_only);
  // Candidate forces, in the problem's units: those up to `least` of the largest D^1/2 f are 0.
  void GiveForces(double least, Eigen::VectorXd* f) const;
  bool Publish();
  double tier() const { return task_.sink->tier(); }
  // Whether rounding may be what keeps the latest candidate from being an answer.
  bool IsNear() const;
  double LargestForce() const { return f_.cwiseAbs().cwiseProduct(root_).maxCoeff(); }
  double proof_tolerance() const { return std::min(task_.tolerance, kProofTolerance); }
  bool TimeIsUp() const { return task_.deadline != nullptr && task_.deadline->Expired(); }
  double GapRoot(Index i) const { return root_[i] * unit_; }

  Task task_;
  GivenFormTest product_;
  std::int64_t factors_ = 0;
  std::int64_t run_factors_ = 0;  // of them, before this call
  std::int64_t single_exchanges_ = 0;
  double weight_ = 0;
  double unit_ = 1;  // A_ii of the first row that can act
  Eigen::VectorXd root_;
  std::vector<char> active_, active_proximal_;
  std::vector<Index> violated_;
  Eigen::VectorXd f_, w_, center_, proximal_;
  Eigen::VectorXd residual_, direction_, image_, preconditioned_, ray_;
  std::optional<Eigen::VectorXd> accepted_ray_;
};

/// Engines for rows, each for one of a few sizes, to which rows are filled up: no solve allocates but the first of its
/// size. An Engine has PrepareRows(size), PivotingSetup's.
template <typename Engine>
class EnginesBySize {
 public:
  /// With more rows a dense block is no longer the cheapest one.
  static constexpr Index kMostRows = 128;

  template <typename Options>
  Engine& Find(Index rows, const Options& options) {
    std::size_t k = 0;
    while (kSizes[k] < rows) ++k;
    if (engines_[k] == nullptr) {
      engines_[k] = std::make_unique<Engine>(options);
      engines_[k]->PrepareRows(kSizes[k]);
    }
    return *engines_[k];
  }

 private:
  static constexpr std::array<Index, 8> kSizes = {8, 16, 24, 32, 48, 64, 96, kMostRows};
  std::array<std::unique_ptr<Engine>, kSizes.size()> engines_;
};

/// Judges candidates of one solve by the rows. Only Reserve allocates.
class RowSink final : public AnswerSink {
 public:
  void Reserve(Index rows) {
    for (Eigen::VectorXd* v : {&f_, &best_}) v->setZero(rows);
  }
  /// @param task  must outlive the solve
  void Start(const RowTask& task);
  Eigen::VectorXd& candidate() override { return f_; }
  /// True if it passes at the tolerance, or at kProofTolerance if that is less. The best one that passes is kept.
  bool Publish() override;
  Eigen::VectorXd& best() { return best_; }
  double tier() const override { return tier_; }
  double rho() const override { return rho_; }

 private:
  const RowTask* task_ = nullptr;
  double tier_ = 0, rho_ = 0;
  Eigen::VectorXd f_, best_;
};

/// What `bpp` and `semismooth-newton` have around it: units, a form of the active block and a judge of answers.
struct PivotingSetup {
  void Prepare(const LcpProblem& problem, ActiveBlockChoice::Allowed allowed);
  /// Loads the problem. False where result says already how it ends.
  /// @param factors  limit unless the options have one
  bool Load(const LcpProblem& problem, const LcpOptions& options, const Deadline* deadline, std::int64_t factors,
            bool conjugate, LcpResult* result);
  /// Prepare for rows of a step, up to `size` of them, filled up by rows that do not act: dense, without a problem.
  void PrepareRows(Index size);
  /// The same as Load. False where a row has A_ii = 0.
  bool LoadRows(const RowTask& task, std::int64_t factors, bool conjugate);
  /// Whether the rows are solved. Writes f and iterations then.
  bool ConcludeRows(const RowTask& task, LcpResult* result);
  /// The result of a solve that ended so; its detail is left to the solver.
  void Conclude(BlockPivoting::End end, double tolerance, LcpResult* result);
  double StepTime() const { return blocks.StepTime(block, scaled.b.size()); }

  ActiveBlockChoice blocks;
  ActiveBlock* block = nullptr;
  ScaledVectors scaled;
  AnswerJudge answer;
  AnswerSink* sink = &answer;  ///< whoever judges
  BlockPivoting pivoting;
  // A solve that begins at rows uses these.
  DenseActiveBlock block_of_rows;
  RowSink row_answer;
  Eigen::VectorXd given_diagonal, given_b;
};

}  // namespace lcpbench
