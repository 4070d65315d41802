// CGAL's quadratic programming simplex in exact arithmetic: a reference, not a competitor.
//
// The LCP of a symmetric positive semidefinite A is the optimality of min 1/2 f'A f + b'f over f_C >= 0. Every double
// is taken exactly, and A = J M^-1 J' of factors is multiplied out without rounding, so that A is semidefinite beyond
// doubt and the answer is that of the problem as given, rounded once, at the end. Given as a dense or sparse matrix, A
// is taken as it stands: one that is semidefinite but for rounding can mislead the method.
//
// An LCP without solution is an unbounded QP; CGAL's certificate, a direction y with A y = 0, b'y < 0, y_C >= 0, is the
// Farkas ray. There is no tolerance, no iteration limit and no clock: the host's time limit ends it. An iteration is a
// pivot.

#include <CGAL/Gmpzf.h>
#include <CGAL/QP_functions.h>
#include <CGAL/QP_models.h>
#include <CGAL/version_macros.h>
#include <mpfr.h>

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

using Exact = CGAL::Gmpzf;
using Program = CGAL::Quadratic_program<Exact>;
using Solution = CGAL::Quadratic_program_solution<Exact>;

// A quotient rounded to double: to far more than 53 bits, then once more.
double Round(const Exact& numerator, const Exact& denominator) {
  constexpr mpfr_prec_t kBits = 160;
  mpfr_t quotient;
  mpfr_t divisor;
  mpfr_inits2(kBits, quotient, divisor, nullptr);
  mpfr_set_z_2exp(quotient, numerator.man(), numerator.exp(), MPFR_RNDN);
  mpfr_set_z_2exp(divisor, denominator.man(), denominator.exp(), MPFR_RNDN);
  mpfr_div(quotient, quotient, divisor, MPFR_RNDN);
  const double rounded = mpfr_get_d(quotient, MPFR_RNDN);
  mpfr_clears(quotient, divisor, nullptr);
  return rounded;
}

// The lower triangle of A.
std::map<std::pair<int, int>, Exact> EntriesOfA(const LcpProblem& problem) {
  // An exact number with its place in a tree, here and in CGAL's program; of one triangle.
  constexpr double kBytesPerEntry = 2 * 150;
  RequireMemory(kBytesPerEntry * static_cast<double>(problem.SparseA().nonZeros()) / 2, "A in exact numbers");
  std::map<std::pair<int, int>, Exact> entries;
  const auto add = [&](Index i, Index j, const Exact& value) {
    if (j <= i) entries[{static_cast<int>(i), static_cast<int>(j)}] += value;
  };
  if (problem.has_factors()) {
    using ByColumns = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
    const ByColumns J = problem.J();
    for (Index k = 0; k < J.cols(); ++k) {
      for (ByColumns::InnerIterator left(J, k); left; ++left) {
        const Exact scaled = Exact(left.value()) * Exact(problem.inverse_mass()[k]);
        for (ByColumns::InnerIterator right(J, k); right; ++right)
          add(left.row(), right.row(), scaled * Exact(right.value()));
      }
    }
    return entries;
  }
  for (Index i = 0; i < problem.size(); ++i) {
    for (SparseMatrix::InnerIterator entry(problem.SparseA(), i); entry; ++entry)
      add(i, entry.col(), Exact(entry.value()));
  }
  return entries;
}

class ExactQp : public LcpSolver {
 public:
  explicit ExactQp(CGAL::Quadratic_program_pricing_strategy pricing) { options_.set_pricing_strategy(pricing); }

  std::string WhyUnsupported(const LcpProblem& problem) const override { return WhyNotQuadraticProgram(problem); }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    program_ = Program(CGAL::SMALLER, true, Exact(0), false, Exact(0));
    for (const Index row : problem.bilateral_rows()) program_.set_l(static_cast<int>(row), false);
    // CGAL takes the entries of twice the matrix of x'D x, which is A, and of them the lower triangle.
    for (const auto& [place, value] : EntriesOfA(problem)) {
      if (value != Exact(0)) program_.set_d(place.first, place.second, value);
    }
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    TimeConversion(options, result, [&] {
      for (int i = 0; i < static_cast<int>(problem.size()); ++i) program_.set_c(i, Exact(problem.b()[i]));
    });
    Solution solution;
    TimeLibraryCall(options, result, [&] { solution = CGAL::solve_quadratic_program(program_, Exact(), options_); });
    result->iterations = solution.number_of_iterations();
    TimeConversion(options, result, [&] { Take(solution, result); });
  }

 private:
  static void Take(const Solution& solution, LcpResult* result) {
    if (solution.is_optimal()) {
      result->status = LcpStatus::kSolved;
      auto numerator = solution.variable_numerators_begin();
      const Exact& denominator = solution.variables_common_denominator();
      for (double& f : result->f) f = Round(*numerator++, denominator);
    } else if (solution.is_unbounded()) {
      result->status = LcpStatus::kInfeasible;
      result->farkas_ray = Direction(solution, result->f.size());
    } else {
      result->detail = "CGAL: infeasible, which a problem without rows cannot be";
    }
  }

  // Its length is arbitrary: scaled to a largest entry of 1, so that no entry overflows.
  static Eigen::VectorXd Direction(const Solution& solution, Index n) {
    std::vector<Exact> direction;
    Exact largest(0);
    auto entry = solution.unboundedness_certificate_begin();
    for (Index i = 0; i < n; ++i) {
      direction.push_back(*entry++);
      const Exact size = direction.back() < Exact(0) ? -direction.back() : direction.back();
      if (largest < size) largest = size;
    }
    Eigen::VectorXd ray(n);
    for (Index i = 0; i < n; ++i) ray[i] = Round(direction[static_cast<std::size_t>(i)], largest);
    return ray;
  }

  CGAL::Quadratic_program_options options_;
  Program program_;
};

std::unique_ptr<LcpSolver> Make(std::string_view /*key*/, SettingsReader* reader) {
  return std::make_unique<ExactQp>(
      Choose<CGAL::Quadratic_program_pricing_strategy>(reader, "pricing",
                                                       {{"library", CGAL::QP_CHOOSE_DEFAULT},
                                                        {"dantzig", CGAL::QP_DANTZIG},
                                                        {"filtered-dantzig", CGAL::QP_FILTERED_DANTZIG},
                                                        {"partial-dantzig", CGAL::QP_PARTIAL_DANTZIG},
                                                        {"partial-filtered-dantzig", CGAL::QP_PARTIAL_FILTERED_DANTZIG},
                                                        {"bland", CGAL::QP_BLAND}}));
}

}  // namespace

PeerLibrary ThisPeerLibrary() { return {CGAL_VERSION_STR, &Make}; }

}  // namespace lcpbench
