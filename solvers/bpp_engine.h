#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "solvers/active_block_choice.h"
#include "solvers/answer_judge.h"
#include "solvers/bpp.h"
#include "solvers/given_form.h"
#include "solvers/scaled_vectors.h"

namespace lcpbench {

/// The workings of BppSolver, shared by bpp.cc (a solve from loading to the final judgement) and bpp_blocks.cc (block
/// pivoting and polishing); no part of the interface. Vectors are by row of the problem, in scaled units: S A S, t S b,
/// t S^-1 f as in PermutedLcp.
class BppSolver::Engine {
 public:
  explicit Engine(BppOptions options) : options_(options) {}

  bool TooLargeForDense(const LcpProblem& problem) const;
  void Prepare(const LcpProblem& problem);
  double StepTime() const { return blocks_.StepTime(block_, f_.size()); }
  bool is_dense() const { return blocks_.is_dense(block_); }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  enum class End { kDone, kInfeasible, kNotMet, kSingular, kCycling, kIterationLimit, kTimeLimit };

  bool Load();
  void SetStart();
  void StartCold();
  double Residual(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const;
  End Run(LcpResult* result);

  // The proximal step from center_: on return active_, f_ solve the problem of A + shift D.
  End PivotBlocks();
  // The same for A itself from active_, f_, a few exchanges at most. Publishes; kDone if the answer is good enough.
  End Polish(LcpResult* result);
  void SolveActive();
  End CorrectForces();
  Index FindViolated(bool of_shifted);
  void Exchange(bool least_only);
  bool ClaimRay(LcpResult* result);
  void GiveForces(double least, Eigen::VectorXd* f) const;
  double LargestForce() const;
  bool Publish(LcpResult* result);

  // A factorisation that the deadline ends leaves f_ meaningless, which TimeIsUp() then says, and judge_ would.
  const Deadline* deadline() const { return deadline_.has_value() ? &*deadline_ : nullptr; }
  bool TimeIsUp() const { return deadline_.has_value() && deadline_->Expired(); }
  static size_t At(Index i) { return static_cast<size_t>(i); }
  double ForceRoot(Index i) const { return root_[i]; }
  double GapRoot(Index i) const { return root_[i] * unit_; }

  const BppOptions options_;
  std::optional<LcpProblem> problem_;  // a copy shares storage and outlives the caller's
  AnswerJudge judge_;
  GivenFormTest product_;
  ActiveBlockChoice blocks_;
  ActiveBlock* block_ = nullptr;
  bool through_bodies_ = false;
  ScaledVectors scaled_;
  std::vector<char> bilateral_;

  // One call.
  double tolerance_ = 0;
  double proof_tolerance_ = 0;
  const Eigen::VectorXd* initial_f_ = nullptr;
  std::optional<Deadline> deadline_;
  std::int64_t factorisations_ = 0;
  std::int64_t limit_ = 0;
  std::int64_t single_exchanges_ = 0;
  bool started_warm_ = false;  // and still on the way from there

  // State.
  double shift_ = 0;
  double unit_ = 1;  // A_ii of the first row that can act
  Eigen::VectorXd root_;
  std::vector<char> active_, active_shifted_;
  std::vector<Index> violated_;
  Eigen::VectorXd f_, w_, center_, shifted_;
  Eigen::VectorXd residual_, direction_, image_, preconditioned_, ray_;
};

}  // namespace lcpbench
