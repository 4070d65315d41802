#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "solvers/auto/auto_rules.h"
#include "solvers/friction/contact_rows.h"
#include "solvers/friction/coulomb_path.h"
#include "solvers/friction/friction_answer.h"
#include "solvers/friction/mode_steps.h"
#include "solvers/friction/normal_map_path.h"
#include "solvers/friction/shift_rounds.h"

/// Internal to solvers/.
namespace lcpbench {

/// Asks the rules of AutoStage::kLaws of one island, but the first, which Ladder asks [docs/friction.md section 5].
/// Only Reserve allocates where the island's A is dense.
class LawLadder {
 public:
  /// @param tableau  of the relaxations of a dense A, outlives this
  /// @param plain    of other relaxations, and of rays; without it there are none
  /// @param limits   outlive this
  LawLadder(SmallPivoting* tableau, const WithinOptions& plain, const AutoLimits& limits);
  /// For islands of up to so many rows, of a dense A.
  void Reserve(Index max_rows);
  /// The method that answered, in words; nullptr if none did: then answer->Fail or others.
  /// @param next  the first rule to ask; the first that was not asked afterwards
  const char* Solve(const ContactRows& rows, std::size_t* next, FrictionAnswer* answer, LcpResult* result);

 private:
  const char* TryMethod(const AutoRule& rule, const ContactRows& rows, FrictionAnswer* answer, LcpResult* result);
  const char* TrySweeps(const ContactRows& rows, double granted, FrictionAnswer* answer);
  bool TryLaggedBounds(int rounds, FrictionAnswer* answer, LcpResult* result) const;
  bool FindRay(const FrictionAnswer& answer, LcpResult* result) const;

  const WithinOptions plain_;
  const AutoLimits& limits_;
  AutoFacts facts_;
  ModeSteps newton_;
  ShiftRounds rounds_;
  bool has_rounds_ = false;  // rounds_ has begun with this island
  NormalMapPath path_;
  CoulombPath coulomb_path_;
  PaddedVector phi_;
};

/// Puts the answer to a Subproblem of these rows into that to the whole: forces and iterations and, where it is not
/// solved, status and ray; a ray that the verifier of the whole does not accept makes it a numerical failure.
void TakeAnswer(const LcpProblem& problem, std::span<const Index> rows, const LcpResult& part, LcpResult* result);

/// LawLadder of an LcpProblem with friction, sliding or bounded rows, island by island. LcpResult::detail names what
/// answered the largest one.
class LawPortfolio {
 public:
  /// @param plain  what makes the solver of plain problems
  LawPortfolio(SmallPivoting* tableau, const WithinOptions& plain, const AutoLimits& limits)
      : ladder_(tableau, plain, limits) {}
  void Prepare(const LcpProblem& problem);  ///< LcpSolver::DoPrepare
  /// LcpSolver::DoSolve.
  /// @param next   the first rule to ask, of islands of up to ModeFactor::kMostDense rows
  /// @param reached  n forces that Ladder has reached, or nullptr
  void Solve(const LcpProblem& problem, const LcpOptions& options, std::size_t next, const Eigen::VectorXd* reached,
             LcpResult* result);

 private:
  // An island, or the whole problem.
  struct Part {
    std::vector<Index> rows;  // of the whole problem; empty: all
    std::optional<LcpProblem> problem;
    ContactRows contacts;
  };
  void SolvePart(Part* part, const LcpProblem& problem, const LcpOptions& options, std::size_t next,
                 const Eigen::VectorXd* reached, LcpResult* result);

  LawLadder ladder_;
  std::vector<Part> parts_;
};

}  // namespace lcpbench
