#include "solvers/exact/exact_solver.h"

#include <flint/fmpz_lll.h>
#include <mpfr.h>

#include <cmath>
#include <limits>
#include <utility>

#include "solvers/exact/flint_matrix.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

ExactOptions AnswerOnly(const LcpOptions& options, double elapsed_s) {
  ExactOptions exact;
  exact.answer_only = true;
  exact.time_limit_s = options.time_limit_s - elapsed_s;
  exact.now = options.now;
  return exact;
}

// LLL takes less than kSecondsOfLattice for so many active rows.
constexpr Index kMostRowsTogether = 24;
constexpr double kSecondsOfLattice = 0.1;
// Gaps are kept to so many bits below the largest one that rounding causes, because A_FF of nearly parallel rows is
// nearly singular.
constexpr long kBitsOfLattice = 160;

// Doubles near f whose gaps are nearer to those of f: units in the last place of the forces, z, such that the sum of
// z_i ulp_i A e_i is nearly what rounding has taken, by Babai's rounding off in a basis reduced by LLL. Where an angle
// between rows is theta, errors of such rows cancel to about a part theta.
Eigen::VectorXd RoundedTogether(const ExactLcp& problem, const std::vector<Rational>& f) {
  Eigen::VectorXd together = Rounded(f);
  std::vector<Index> active = AllRows(problem.size);
  std::erase_if(active, [&](Index i) { return together[i] == 0; });
  const auto k = static_cast<Index>(active.size());
  if (k > kMostRowsTogether || !together.allFinite()) return together;
  std::vector<Rational> products, taken(At(k));
  std::vector<long> ulp;
  Rational largest = 0;
  for (const Index i : active) ulp.push_back(std::ilogb(together[i]) - std::numeric_limits<double>::digits + 1);
  for (Index c = 0; c < k; ++c) {
    const double diagonal = problem.A[At(active[At(c)] * (problem.size + 1))].convert_to<double>();
    const long unit = diagonal > 0 ? -std::ilogb(diagonal) / 2 : 0;
    for (Index r = 0; r < k; ++r) {
      const Index i = active[At(r)];
      products.push_back(Shifted(problem.A[At(active[At(c)] * problem.size + i)], unit));
      taken[At(c)] += products.back() * (f[At(i)] - Rational(together[i]));
      products.back() = Shifted(products.back(), ulp[At(r)]);
    }
    largest = std::max(largest, Rational(abs(taken[At(c)])));
  }
  if (!(largest.convert_to<double>() > 0)) return together;
  const long bits = kBitsOfLattice - std::ilogb(largest.convert_to<double>());
  IntegerMatrix lattice(k, k), transform(k, k), sums(k, 1), steps(1, k);
  const auto set = [bits](fmpz* to, const Rational& from) {
    const Rational scaled = Shifted(from, bits);
    fmpz_set_mpz(to, BigInteger(numerator(scaled) / denominator(scaled)).backend().data());
  };
  for (Index c = 0; c < k; ++c) {
    for (Index r = 0; r < k; ++r) set(lattice.at(r, c), products[At(c * k + r)]);
    set(sums.at(c, 0), taken[At(c)]);
  }
  fmpz_mat_one(transform.get());
  fmpz_lll_t options;
  fmpz_lll_context_init_default(options);
  fmpz_lll(lattice.get(), transform.get(), options);
  if (fmpz_mat_rank(lattice.get()) < k) return together;
  const RationalMatrix x = Solve(Transposed(lattice), sums);
  for (Index r = 0; r < k; ++r) {
    const Rational value = ToRational(x.at(r, 0)) + Rational(1, 2);
    const BigInteger whole = numerator(value) / denominator(value);
    fmpz_set_mpz(steps.at(0, r), BigInteger(value < whole ? whole - 1 : whole).backend().data());
  }
  const IntegerMatrix z = Product(steps, transform);
  for (Index r = 0; r < k; ++r) {
    double& force = together[active[At(r)]];
    force = RoundToNearest(Rational(force) + Shifted(ToRational(z.at(0, r)), ulp[At(r)]));
  }
  return together;
}

}  // namespace

double RoundToNearest(const Rational& value) {
  mpfr_t rounded;
  mpfr_init2(rounded, std::numeric_limits<double>::digits);
  // Subnormal results have fewer digits: rounded once, to what they have.
  const mpfr_exp_t least = mpfr_get_emin();
  const mpfr_exp_t largest = mpfr_get_emax();
  mpfr_set_emin(std::numeric_limits<double>::min_exponent - std::numeric_limits<double>::digits + 1);
  mpfr_set_emax(std::numeric_limits<double>::max_exponent);
  const int direction = mpfr_set_q(rounded, value.backend().data(), MPFR_RNDN);
  mpfr_subnormalize(rounded, direction, MPFR_RNDN);
  const double result = mpfr_get_d(rounded, MPFR_RNDN);
  mpfr_set_emin(least);
  mpfr_set_emax(largest);
  mpfr_clear(rounded);
  return result;
}

Eigen::VectorXd Rounded(const std::vector<Rational>& values) {
  Eigen::VectorXd rounded(static_cast<Index>(values.size()));
  for (Index i = 0; i < rounded.size(); ++i) rounded[i] = RoundToNearest(values[static_cast<size_t>(i)]);
  return rounded;
}

std::string ExactSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (problem.size() > kMostExactRows) {
    return "more than " + std::to_string(kMostExactRows) + " rows";
  }
  if (problem.has_factors()) return {};
  if (problem.Asymmetry() != 0) return "A is not symmetric to the last bit";
  const Index most = ExactOptions{}.most_rows_of_proofs;
  if (problem.size() > most) {
    return "a matrix of more than " + std::to_string(most) + " rows is not proved to be positive semidefinite";
  }
  return {};
}

void ExactSolver::DoPrepare(const LcpProblem& problem) { exact_ = ExactFrom(problem); }

// The nearly exact answer to a problem that one rounding makes unsolvable; false where it does not pass the tolerance.
bool ExactSolver::SolveContradiction(const LcpProblem& problem, const LcpOptions& options, double elapsed_s,
                                     LcpResult* result) {
  ExactLcp regular = *exact_;
  for (Index i = 0; i < regular.size; ++i) {
    regular.A[static_cast<size_t>(i * regular.size + i)] *= 1 + Rational(kProximal);
  }
  const ExactAnswer answer = SolveExactly(regular, AnswerOnly(options, elapsed_s));
  result->iterations += answer.steps;
  if (answer.status != ExactAnswer::Status::kSolved) return false;
  Eigen::VectorXd f = Rounded(answer.f);
  if (!PassesTier(ComputeMetrics(problem, f), options.tolerance)) return false;
  result->f = std::move(f);
  return true;
}

void ExactSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  const ExactAnswer answer = SolveExactly(*exact_, AnswerOnly(options, 0));
  result->iterations = answer.steps;
  result->detail = answer.detail;
  const auto passes = [&](const Eigen::VectorXd& f) {
    return PassesTier(ComputeMetrics(problem, f), options.tolerance);
  };
  switch (answer.status) {
    case ExactAnswer::Status::kSolved:
      result->f = Rounded(answer.f);
      result->status = LcpStatus::kSolved;
      if (rounds_together_ && deadline.Remaining() > kSecondsOfLattice && !passes(result->f)) {
        Eigen::VectorXd f = RoundedTogether(*exact_, answer.f);
        if (passes(f)) result->f = std::move(f);
      }
      if (result->f.allFinite()) break;
      result->status = LcpStatus::kNumericalFailure;
      result->detail = "a force is beyond the range of doubles";
      break;
    case ExactAnswer::Status::kInfeasible:
      if (SolveContradiction(problem, options, deadline.Elapsed(), result)) {
        result->status = LcpStatus::kSolved;
        result->detail = "contradicts itself by a rounding: solved to the tolerance";
        break;
      }
      result->status = LcpStatus::kInfeasible;
      result->farkas_ray = Rounded(answer.ray);
      break;
    case ExactAnswer::Status::kNotSemidefinite:
      result->status = LcpStatus::kUnsupported;
      if (result->detail.empty()) result->detail = "A is not positive semidefinite";
      break;
    case ExactAnswer::Status::kTimeLimit:
    case ExactAnswer::Status::kUnknown:
      result->status = LcpStatus::kTimeLimit;
      break;
  }
}

}  // namespace lcpbench
