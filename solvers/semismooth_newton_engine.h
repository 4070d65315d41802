#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "solvers/active_block_choice.h"
#include "solvers/answer_judge.h"
#include "solvers/given_form.h"
#include "solvers/scaled_vectors.h"
#include "solvers/semismooth_newton.h"

namespace lcpbench {

/// The workings of SemismoothNewtonSolver, shared by semismooth_newton.cc (proximal steps and their subproblems) and
/// semismooth_newton_finish.cc (from a guess of the active set to an answer or a proof); no part of the interface.
/// Vectors are by row of the problem, in the units of ScaledVectors.
class SemismoothNewtonSolver::Engine {
 public:
  explicit Engine(SemismoothNewtonOptions options) : options_(options) {}

  void Prepare(const LcpProblem& problem);
  double StepTime() const { return blocks_.StepTime(block_, n_); }
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  static size_t At(Index i) { return static_cast<size_t>(i); }
  enum class End { kGoOn, kStalled, kDone, kInfeasible, kTimeLimit, kIterationLimit };

  bool Start(const Eigen::VectorXd* initial_f);
  double Residual(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const;
  End Factor(double shift);
  Index FindActiveSet(double eps);
  End SolveSubproblem(double eps);
  bool IsDiverging(int steps) const;
  void RestartFromCenter();
  double StepLength() const;
  double Slope(double t, double* curvature) const;
  End Finish(LcpResult* result);
  End FinishWith(double shift, LcpResult* result);
  End FinishFromStart(LcpResult* result);
  End Correct(double rho, LcpResult* result);
  Index FindWrongRows();
  void GiveForces(Eigen::VectorXd* f) const;
  bool Publish(double rho_in_double, LcpResult* result);
  bool IsAnswer(LcpResult* result);
  bool RepairTinyRows(LcpResult* result);
  End TryRay(LcpResult* result);
  double RhoInDouble();

  bool is_joint(Index p) const { return bilateral_[At(p)] != 0; }

  SemismoothNewtonOptions options_;
  std::optional<LcpProblem> problem_;
  ActiveBlockChoice blocks_;
  ActiveBlock* block_ = nullptr;
  GivenFormTest test_;
  AnswerJudge judge_;
  LcpResult judged_;  // its f is what judge_ saw
  double tolerance_ = 0;
  std::int64_t factors_ = 0, factor_limit_ = 0;
  std::optional<Deadline> deadline_;

  Index n_ = 0;
  bool continuation_ = false;  // still
  bool exact_ = false;         // u solves the latest subproblem
  ScaledVectors scaled_;
  std::vector<char> bilateral_;
  Eigen::VectorXd c_, u_, w_;      // proximal centre, dual point, A u + b
  Eigen::VectorXd step_, step_w_;  // u' - u and A (u' - u)
  Eigen::VectorXd inverse_;        // 1 / (eps D)
  Eigen::VectorXd growth_;         // c - previous c
  Eigen::VectorXd f_, residual_;   // of the finish
  Eigen::VectorXd f_trial_;        // in the problem's units
  std::vector<char> in_F_;
  std::vector<Index> stack_;               // of TryRay; of FinishFromStart the wrong rows
  double slope_at_0_ = 0, curvature_ = 0;  // of 1/2 u.A u along the step
  double best_rho_ = std::numeric_limits<double>::infinity();
  double center_rho_ = std::numeric_limits<double>::infinity();  // of c, before its correction
};

}  // namespace lcpbench
