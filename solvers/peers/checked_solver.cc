#include "solvers/peers/checked_solver.h"

#include <algorithm>
#include <sstream>
#include <utility>

#include "solvers/lcp/residual.h"

namespace lcpbench {
namespace {

// [J, I] with s as the masses of the new columns.
LcpProblem ShiftedFactors(const LcpProblem& problem, double s) {
  const Index n = problem.size();
  const Index columns = problem.J().cols();
  Eigen::SparseMatrix<double, Eigen::ColMajor, int> J(n, columns + n), identity(n, n);
  identity.setIdentity();
  J.leftCols(columns) = problem.J();
  J.rightCols(n) = identity;
  Eigen::VectorXd inverse_mass(columns + n);
  inverse_mass << problem.inverse_mass(), Eigen::VectorXd::Constant(n, s);
  return LcpProblem::FromFactors(problem.id(), J, std::move(inverse_mass), problem.b(), problem.bounds(),
                                 problem.facts());
}

LcpProblem Shifted(const LcpProblem& problem, double shift) {
  const double s = shift * problem.DiagonalA().cwiseAbs().maxCoeff();
  switch (problem.given_form()) {
    case MatrixForm::kFactors:
      return ShiftedFactors(problem, s);
    case MatrixForm::kSparse: {
      SparseMatrix A = problem.SparseA();  // has every diagonal entry
      for (Index row = 0; row < problem.size(); ++row) A.coeffRef(row, row) += s;
      return LcpProblem::FromSparse(problem.id(), A, problem.b(), problem.bounds(), problem.facts());
    }
    case MatrixForm::kDense:
      break;
  }
  Eigen::MatrixXd A = problem.DenseA();
  A.diagonal().array() += s;
  return LcpProblem::FromDense(problem.id(), std::move(A), problem.b(), problem.bounds(), problem.facts());
}

// Seconds that may be unknown, which is negative.
void Add(double seconds, double* sum) {
  if (seconds >= 0) *sum = std::max(0.0, *sum) + seconds;
}

}  // namespace

void CheckedSolver::DoPrepare(const LcpProblem& problem) { inner_->Prepare(problem); }

void CheckedSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  inner_->Solve(problem, options, result);
  if (result->status == LcpStatus::kUnsupported || result->status == LcpStatus::kInfeasible) return;
  double rho = ResidualEstimate(problem).Rho(result->f);
  if (!(rho <= options.tolerance) && !deadline.Expired()) {
    LcpOptions rest = options;
    rest.time_limit_s = deadline.Remaining();
    LcpResult again;
    if (rest.time_limit_s > 0) inner_->Solve(Shifted(problem, shift_), rest, &again);
    const double rho_again = again.f.size() == problem.size() ? ResidualEstimate(problem).Rho(again.f) : rho;
    Add(result->own_solve_s, &again.own_solve_s);
    Add(result->own_convert_s, &again.own_convert_s);
    if (rho_again < rho || !(rho == rho)) {
      rho = rho_again;
      *result = std::move(again);
    } else {
      result->own_solve_s = again.own_solve_s;
      result->own_convert_s = again.own_convert_s;
    }
  }
  if (rho <= options.tolerance) {
    result->status = LcpStatus::kSolved;
  } else if (result->status == LcpStatus::kSolved) {
    std::ostringstream detail;
    detail << "checked: rho is " << rho;
    result->status = LcpStatus::kNumericalFailure;
    result->detail = detail.str();
  }
}

}  // namespace lcpbench
