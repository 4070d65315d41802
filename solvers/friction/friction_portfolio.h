#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <vector>

#include "solvers/friction/contact_rows.h"
#include "solvers/friction/mode_path.h"
#include "solvers/friction/mode_steps.h"
#include "solvers/friction/shift_rounds.h"

/// Internal to solvers/.
namespace lcpbench {

/// `auto` for problems with friction, sliding or bounded rows, island by island [docs/friction.md section 5]. Methods
/// are asked in turn until an answer passes: modes one by one (few contacts); the modes of initial_f; rounds of the
/// shifted relaxation, the first one unshifted, with Newton steps on modes after each; Lemke's path along modes in
/// small islands; proximal points by paths of the normal map. LcpResult::detail names the one that answered. With
/// sliding or bounded rows there are no relaxations: Newton steps come first.
class FrictionPortfolio {
 public:
  /// @param plain  of the relaxation: what makes the solver of plain problems
  explicit FrictionPortfolio(const WithinOptions& plain) : plain_(plain), rounds_(RelaxProblems(plain)) {}
  void Prepare(const LcpProblem& problem);                                              ///< LcpSolver::DoPrepare
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);  ///< LcpSolver::DoSolve

 private:
  // An island, or the whole problem.
  struct Part {
    std::vector<Index> rows;  // of the whole problem; empty: all
    std::optional<LcpProblem> problem;
    ContactRows contacts;
  };
  void SolvePart(Part* part, const LcpProblem& problem, const LcpOptions& options, LcpResult* result);
  const char* Ask(const ContactRows& rows, FrictionAnswer* answer, LcpResult* result);
  bool FindRay(const FrictionAnswer& answer, LcpResult* result) const;

  const WithinOptions plain_;
  ModeSteps newton_;
  ShiftRounds rounds_;
  ModePath mode_path_;
  std::vector<Part> parts_;
  Eigen::VectorXd phi_;
};

}  // namespace lcpbench
