#include "solvers/exact/exact_lcp.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "solvers/exact/exact_pivoting.h"
#include "solvers/exact/flint_matrix.h"
#include "solvers/exact/least_norm.h"
#include "solvers/exact/lemke_path.h"
#include "solvers/exact/mode_system.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {
namespace {

// Forces of a guess up to this part of the largest, both in D^1/2 f, are zero.
constexpr double kGuessedZero = 1e-12;
// Exact solves from the first guess, before a better one is worth its time; without any guess only f = 0 is tried.
constexpr std::int64_t kSolvesOfFirstGuess = 2;
constexpr std::int64_t kSolvesOfNoGuess = 1;

// Upper bounds as measured, by bit of the entries: of a solve by rows^3, of a characteristic polynomial by rows^4.
constexpr double kSecondsOfSolve = 2e-9;
constexpr double kSecondsOfPolynomial = 1e-10;

// One SolveExactly. A' = a A and b' = c b are integers; f = (a / c) f', w = w' / c.
class ExactSolve {
 public:
  ExactSolve(const ExactLcp& problem, const ExactOptions& options)
      : problem_(problem),
        options_(options),
        a_(CommonDenominator(problem.A)),
        c_(CommonDenominator(problem.b)),
        A_(Scaled(problem.A, problem.size, a_)),
        b_(Scaled(problem.b, problem.size, c_)),
        deadline_(LcpOptions{.time_limit_s = options.time_limit_s - LongestStep(), .now = options.now}) {}

  ExactAnswer Solve() {
    const Index n = problem_.size;
    answer_.rank = 0;
    if (!problem_.has_factors && !deadline_.Expired() &&
        (n > options_.most_rows_of_proofs || !IsPositiveSemidefinite(A_))) {
      answer_.status = ExactAnswer::Status::kNotSemidefinite;
      if (n > options_.most_rows_of_proofs) {
        answer_.detail = "a matrix of more than " + std::to_string(options_.most_rows_of_proofs) +
                         " rows is not proved to be positive semidefinite; give J and invM instead";
      }
      return answer_;
    }
    if (!options_.answer_only) FindRank();
    std::vector<char> start(At(n), 0);
    std::vector<char> support(At(n), 0);
    Guess(&start, &support);
    ExactPivoting pivoting(A_, b_, problem_.bilateral);
    const ExactPivoting::End end = Pivot(start, support, &pivoting);
    answer_.steps = pivoting.solves();
    switch (end) {
      case ExactPivoting::End::kSolved:
        answer_.status = ExactAnswer::Status::kSolved;
        answer_.w_unique = true;
        SetForces(pivoting);
        if (!options_.answer_only) Describe();
        break;
      case ExactPivoting::End::kRay:
        answer_.status = ExactAnswer::Status::kInfeasible;
        SetRay(pivoting.ray());
        break;
      case ExactPivoting::End::kNotSemidefinite:
        answer_.status = ExactAnswer::Status::kNotSemidefinite;
        break;
      case ExactPivoting::End::kTimeLimit:
      case ExactPivoting::End::kSolveLimit:
        answer_.status = ExactAnswer::Status::kTimeLimit;
        answer_.detail = "out of time after " + std::to_string(answer_.steps) + " exact solves";
        break;
    }
    return answer_;
  }

 private:
  // What may go by without a look at the deadline [s]: a solve, or the characteristic polynomial.
  double LongestStep() const {
    const auto n = static_cast<double>(problem_.size);
    const auto bits = static_cast<double>(std::abs(fmpz_mat_max_bits(A_.get())));
    return bits * n * n * n * std::max(kSecondsOfSolve, problem_.has_factors ? 0 : kSecondsOfPolynomial * n);
  }

  // From the guess in doubles; where that is not right almost at once, from one in more digits.
  ExactPivoting::End Pivot(const std::vector<char>& start, const std::vector<char>& support, ExactPivoting* pivoting) {
    const auto any = [](const std::vector<char>& marks) {
      return std::find(marks.begin(), marks.end(), 1) != marks.end();
    };
    if (any(support) && pivoting->TryRay(support)) return ExactPivoting::End::kRay;
    const ExactPivoting::End end =
        pivoting->Pivot(start, deadline_, options_.guess ? kSolvesOfFirstGuess : kSolvesOfNoGuess);
    if (end != ExactPivoting::End::kSolveLimit) return end;
    const LemkeEnd lemke = FollowLemke(problem_, A_, b_, 0, deadline_);
    if (lemke.kind == LemkeEnd::Kind::kLimit) return pivoting->Pivot(start, deadline_);
    if (any(lemke.support) && pivoting->TryRay(lemke.support)) return ExactPivoting::End::kRay;
    std::vector<char> active(lemke.modes.size());
    std::ranges::transform(lemke.modes, active.begin(), [](char mode) { return mode == 'C' ? 1 : 0; });
    return pivoting->Pivot(active, deadline_);
  }

  // The other rows are proved to depend on these by Schur complements of 0.
  void FindRank() {
    const Index n = problem_.size;
    const std::vector<Index> independent = IndependentRows(A_, AllRows(n));
    answer_.rank = static_cast<Index>(independent.size());
    answer_.rank_is_proved = n <= options_.most_rows_of_proofs || answer_.rank == n;
    if (!answer_.rank_is_proved) return;
    answer_.rank_is_proved = AllDepend(A_, independent, OtherRows(n, independent));
  }

  void Guess(std::vector<char>* start, std::vector<char>* support) const {
    if (!options_.guess) return;
    const Index n = problem_.size;
    Eigen::MatrixXd A(n, n);
    Eigen::VectorXd b(n);
    for (Index i = 0; i < n; ++i) {
      b[i] = problem_.b[At(i)].convert_to<double>();
      for (Index j = 0; j < n; ++j) A(i, j) = problem_.A[At(i * n + j)].convert_to<double>();
    }
    if (!A.allFinite() || !b.allFinite()) return;
    const ExactGuess guess = options_.guess(
        LcpProblem::FromDense(problem_.id, A, b, {{problem_.bilateral.begin(), problem_.bilateral.end()}}));
    const auto mark = [&](const Eigen::VectorXd& values, std::vector<char>* marks) {
      if (values.size() != n || !values.allFinite()) return;
      double largest = 0;
      for (Index i = 0; i < n; ++i) largest = std::max(largest, std::sqrt(A(i, i)) * std::abs(values[i]));
      for (Index i = 0; i < n; ++i) {
        (*marks)[At(i)] = std::sqrt(A(i, i)) * std::abs(values[i]) > kGuessedZero * largest ? 1 : 0;
      }
    };
    mark(guess.f, start);
    mark(guess.ray, support);
  }

  void SetRay(RationalVector y) {
    Rational b_dot_y = 0;
    for (Index i = 0; i < problem_.size; ++i) b_dot_y += problem_.b[At(i)] * y[At(i)];
    for (Rational& value : y) value /= -b_dot_y;
    answer_.ray = std::move(y);
  }

  void SetForces(const ExactPivoting& pivoting) {
    const Index n = problem_.size;
    const Rational force_unit(a_, c_);
    answer_.f.resize(At(n));
    answer_.w.resize(At(n));
    for (Index i = 0; i < n; ++i) {
      answer_.f[At(i)] = ToRational(pivoting.f().at(i, 0), pivoting.denominator().get()) * force_unit;
      answer_.w[At(i)] = ToRational(pivoting.w().at(i, 0), pivoting.denominator().get()) / c_;
    }
  }

  // All that is known beyond f and w.
  void Describe() {
    const Index n = problem_.size;
    const Rational force_unit(a_, c_);
    std::vector<Index> active;
    for (Index i = 0; i < n; ++i) {
      if (answer_.w[At(i)] == 0) active.push_back(i);
    }
    SolutionSet set{Block(A_, active, active), Block(b_, active, {0}), {}, {}, {}};
    for (const Index i : active) {
      set.bilateral.push_back(problem_.bilateral[At(i)]);
      set.f.push_back(answer_.f[At(i)] / force_unit);
    }
    const auto rows = static_cast<Index>(active.size());
    set.independent = IndependentRows(set.A, AllRows(rows));
    answer_.nullity_on_active = rows - static_cast<Index>(set.independent.size());
    if (answer_.nullity_on_active == 0) {
      answer_.f_least_norm = answer_.f;
      answer_.f_unique = true;
    } else {
      const std::optional<LeastNorm> least = FindLeastNorm(set, deadline_);
      if (!least.has_value()) {
        answer_.detail = "out of time for the f of least norm";
        return;
      }
      answer_.f_least_norm.assign(At(n), 0);
      answer_.multipliers.assign(At(n), 0);
      for (size_t k = 0; k < active.size(); ++k) {
        answer_.f_least_norm[At(active[k])] = least->f[k] * force_unit;
        // f - A l >= 0 in the problem's own units: A' l' = a A l', so that l = (a^2 / c) l'.
        answer_.multipliers[At(active[k])] = least->multipliers[k] * force_unit * a_;
      }
      if (answer_.f_least_norm != answer_.f) {
        answer_.f_unique = false;
      } else if (rows <= options_.most_rows_of_proofs) {
        answer_.f_unique = IsOnlySolution(set, least->f, deadline_);
        if (!answer_.f_unique.has_value()) answer_.detail = "out of time for the uniqueness of f";
      } else {
        answer_.detail =
            "uniqueness of f is decided up to " + std::to_string(options_.most_rows_of_proofs) + " active rows";
      }
    }
    for (const Index i : active) {
      if (problem_.bilateral[At(i)] == 0 && answer_.f_least_norm[At(i)] == 0) answer_.degenerate.push_back(i);
    }
  }

  const ExactLcp& problem_;
  const ExactOptions& options_;
  BigInteger a_, c_;
  IntegerMatrix A_, b_;
  Deadline deadline_;
  ExactAnswer answer_;
};

std::string AtRow(const char* what, Index i) { return what + std::string(" at row ") + std::to_string(i); }

// The modes of an answer to a plain problem.
std::string ModesOf(const ExactLcp& problem, const RationalVector& f) {
  std::string modes(f.size(), 'O');
  for (size_t i = 0; i < std::min(f.size(), problem.bilateral.size()); ++i) {
    if (f[i] != 0) modes[i] = 'C';
    if (problem.bilateral[i] != 0) modes[i] = 'B';
  }
  return modes;
}

std::string FaultOfRay(const ExactLcp& problem, const RationalVector& y) {
  if (y.size() != At(problem.size)) return "the ray has another size than the problem";
  Rational b_dot_y = 0;
  const RationalVector product = GapsOf(problem, y, true);
  for (Index i = 0; i < problem.size; ++i) {
    if (product[At(i)] != 0) return AtRow("A y is not 0", i);
    if (problem.bilateral[At(i)] == 0 && y[At(i)] < 0) return AtRow("y < 0", i);
    b_dot_y += problem.b[At(i)] * y[At(i)];
  }
  return b_dot_y == -1 ? "" : "b.y is not -1";
}

}  // namespace

const char* ToString(ExactAnswer::Status status) {
  constexpr const char* kNames[] = {"solved", "infeasible", "not positive semidefinite", "time limit", "unknown"};
  return kNames[static_cast<int>(status)];
}

ExactAnswer SolveExactly(const ExactLcp& problem, const ExactOptions& options) {
  return ExactSolve(problem, options).Solve();
}

std::string FindFaultOfModes(const ExactLcp& problem, const std::string& modes, const RationalVector& f,
                             const RationalVector* claimed_w) {
  if (f.size() != At(problem.size) || modes.size() != f.size()) return "f or modes have another size than the problem";
  const RationalVector w = GapsOf(problem, f);
  if (claimed_w != nullptr && *claimed_w != w) return "w is not A f + b";
  for (const Law& law : LawsOf(problem, modes)) {
    const Rational value = ValueOf(law, f, w);
    if (law.is_equation ? value == 0 : value >= 0) continue;
    const LawTerm& term = law.terms.front();
    return std::string(term.is_gap ? "w" : "f") + " of row " + std::to_string(term.row) + " does not obey mode " +
           modes[At(term.row)];
  }
  return {};
}

std::string FindFault(const ExactLcp& problem, const ExactAnswer& answer) {
  const bool is_plain = problem.is_plain();
  if (answer.status == ExactAnswer::Status::kInfeasible) return is_plain ? FaultOfRay(problem, answer.ray) : "";
  if (!answer.is_solved()) return {};
  const auto fault_of = [&](const RationalVector& f) {
    return FindFaultOfModes(problem, is_plain ? ModesOf(problem, f) : answer.modes, f, &answer.w);
  };
  std::string fault = fault_of(answer.f);
  if (!fault.empty() || answer.f_least_norm.empty()) return fault;
  if (answer.nullity_on_active == 0)
    return answer.f_least_norm == answer.f ? "" : "f is unique, but two different ones are given";
  fault = fault_of(answer.f_least_norm);
  if (!fault.empty()) return "of least norm: " + fault;
  if (answer.multipliers.size() != answer.f.size()) return "no multipliers";
  const RationalVector product = GapsOf(problem, answer.multipliers, true);
  for (Index i = 0; i < problem.size; ++i) {
    const Rational& f = answer.f_least_norm[At(i)];
    if (answer.w[At(i)] != 0) {
      if (answer.multipliers[At(i)] != 0) return AtRow("a multiplier where w > 0", i);
      continue;
    }
    const Rational slack = f - product[At(i)];
    const bool holds = problem.bilateral[At(i)] != 0 || f != 0 ? slack == 0 : slack >= 0;
    if (!holds) return AtRow("f is not of least norm", i);
  }
  return {};
}

std::string ModesOf(const LcpProblem& problem, const Eigen::VectorXd& f) {
  Eigen::VectorXd omega, root = problem.DiagonalA().unaryExpr([](double d) { return d > 0 ? std::sqrt(d) : 1.0; });
  problem.ComputeW(f, &omega);
  omega = omega.cwiseQuotient(root);
  const Eigen::VectorXd trial = root.cwiseProduct(f) - omega;
  std::vector<FrictionRow> friction = problem.friction_rows();
  std::vector<BoundedRow> bounded = problem.bounded_rows();
  for (FrictionRow& row : friction) row.mu *= root[row.row] / root[row.normal];
  for (BoundedRow& row : bounded) {
    row.lower *= root[row.row];
    row.upper *= root[row.row];
  }
  std::vector<Index> normals;
  for (Index i = 0; i < problem.size(); ++i) {
    if (problem.kind(i) == RowKind::kUnilateral) normals.push_back(i);
  }
  std::vector<RangeSide> sides(At(problem.size()));
  Laws{problem.bilateral_rows(), normals, friction, bounded}.VisitRanges(
      trial, [&](Index i, const auto& range) { sides[At(i)] = SideOf(range, trial[i]); });
  std::string modes(At(problem.size()), 'O');
  for (Index i = 0; i < problem.size(); ++i) {
    if (sides[At(i)] == RangeSide::kInside) modes[At(i)] = problem.is_bilateral(i) ? 'B' : 'C';
  }
  const auto mode_of = [](RangeSide side) {
    return side == RangeSide::kInside ? 'S' : side == RangeSide::kLower ? '+' : '-';
  };
  for (const FrictionRow& row : problem.friction_rows()) {
    const bool is_open = sides[At(row.normal)] == RangeSide::kLower;
    const RangeSide slip = row.mu > 0 || omega[row.row] >= 0 ? sides[At(row.row)] : RangeSide::kUpper;
    modes[At(row.row)] = is_open ? 'o' : row.slip != 0 ? 'k' : mode_of(slip);
  }
  for (const BoundedRow& row : problem.bounded_rows()) {
    const bool is_upper = row.lower == row.upper && omega[row.row] < 0;
    modes[At(row.row)] = is_upper ? '-' : mode_of(sides[At(row.row)]);
  }
  return modes;
}

}  // namespace lcpbench
