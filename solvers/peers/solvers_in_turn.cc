#include "solvers/peers/solvers_in_turn.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include "solvers/lcp/law.h"
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

void SolveTurn(const SolversInTurn::Turn& turn, const LcpProblem& problem, const LcpOptions& options,
               LcpResult* result) {
  turn.solver->Solve(turn.shift > 0 ? Shifted(problem, turn.shift) : problem, options, result);
}

void SolveTurn(const SolversInTurn::Turn& turn, const ProblemArrays& arrays, const LcpOptions& options,
               LcpResult* result) {
  if (turn.shift > 0) return SolveTurn(turn, LcpProblem::FromArrays(arrays), options, result);
  turn.solver->SolveArrays(arrays, options, result);
}

// Seconds that may be unknown, which is negative.
void Add(double seconds, double* sum) {
  if (seconds >= 0) *sum = std::max(0.0, *sum) + seconds;
}

}  // namespace

bool SolversInTurn::Passes(const LcpProblem& problem, double tolerance, const Eigen::VectorXd& f, double* rho) {
  ResidualEstimate residual(problem);
  *rho = residual.Rho(f);
  return *rho <= tolerance && residual.Meets(tolerance, f);
}

// From factors by the arrays alone, unless a row's backward error is not small at once: of a small problem an
// LcpProblem takes longer than the solve.
bool SolversInTurn::Passes(const ProblemArrays& arrays, double tolerance, const Eigen::VectorXd& f, double* rho) {
  if (arrays.form != MatrixForm::kFactors) return Passes(LcpProblem::FromArrays(arrays), tolerance, f, rho);
  const auto columns = static_cast<Index>(arrays.inverse_mass.size());
  const Eigen::Map<const SparseMatrix> J(arrays.rows, columns, arrays.row_start.back(), arrays.row_start.data(),
                                         arrays.column.data(), arrays.value.data());
  const Eigen::Map<const Eigen::VectorXd> inverse_mass(arrays.inverse_mass.data(), columns);
  velocity_.setZero(columns);
  for (Index i = 0; i < arrays.rows; ++i) {
    if (f[i] == 0) continue;
    for (decltype(J)::InnerIterator it(J, i); it; ++it) velocity_[it.col()] += it.value() * f[i];
  }
  velocity_.array() *= inverse_mass.array();
  LawSums<double> sums(std::sqrt(tolerance));
  for (Index i = 0; i < arrays.rows; ++i) {
    double diagonal = 0;
    double sum = 0;
    for (decltype(J)::InnerIterator it(J, i); it; ++it) {
      diagonal += inverse_mass[it.col()] * (it.value() * it.value());
      sum += it.value() * velocity_[it.col()];
    }
    const auto row = static_cast<std::size_t>(i);
    const double b = arrays.b[row];
    const bool is_joint = !arrays.bilateral.empty() && arrays.bilateral[row] != 0;
    // (|A| |f|)_i is at least that.
    const double magnitude = std::max(std::abs(sum), diagonal * std::abs(f[i])) + std::abs(b);
    sums.Add(diagonal, b, sum + b, f[i], is_joint, magnitude);
  }
  using Sums = LawSums<double>;
  if (sums.Judge(tolerance, 0, rho) == Sums::Known::kRight) return true;
  return *rho <= tolerance && Passes(LcpProblem::FromArrays(arrays), tolerance, f, rho);
}

// @param given  a problem, or its arrays
template <typename Given>
void SolversInTurn::SolveInTurn(const Given& given, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  SolveTurn(turns_.front(), given, options, result);
  LcpStatus last = result->status;
  if (last == LcpStatus::kUnsupported || last == LcpStatus::kInfeasible) return;
  double rho = 0;
  const auto judge = [&](const Eigen::VectorXd& f, double* of_f) {
    *of_f = std::numeric_limits<double>::infinity();
    return f.allFinite() && Passes(given, options.tolerance, f, of_f);
  };
  bool passes = judge(result->f, &rho);
  for (std::size_t turn = 1; turn < turns_.size() && !passes; ++turn) {
    LcpOptions rest = options;
    rest.time_limit_s = deadline.Remaining();
    if (last == LcpStatus::kTimeLimit || rest.time_limit_s <= 0) break;
    LcpResult other;
    SolveTurn(turns_[turn], given, rest, &other);
    last = other.status;
    if (last == LcpStatus::kUnsupported) continue;
    // What a later solver, or one of another problem, says of solutions is not passed on.
    if (last == LcpStatus::kInfeasible) other.status = LcpStatus::kNumericalFailure;
    double rho_of_other = 0;
    passes = judge(other.f, &rho_of_other);
    if (passes || rho_of_other < rho) {
      rho = rho_of_other;
      std::swap(*result, other);
    }
    Add(other.own_solve_s, &result->own_solve_s);
    Add(other.own_convert_s, &result->own_convert_s);
  }
  if (passes) {
    result->status = LcpStatus::kSolved;
  } else if (result->status == LcpStatus::kSolved) {
    std::ostringstream detail;
    detail << "checked: rho is " << rho;
    result->status = LcpStatus::kNumericalFailure;
    result->detail = detail.str();
  }
}

void SolversInTurn::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  SolveInTurn(problem, options, result);
}

bool SolversInTurn::DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) {
  SolveInTurn(arrays, options, result);
  return true;
}

}  // namespace lcpbench
