#include "solvers/exact/enumeration.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "solvers/exact/flint_matrix.h"

namespace lcpbench {
namespace {

using DenseRow = std::vector<Rational>;

// x of A_FF x = -b_F; nothing where A_FF is singular.
std::optional<DenseRow> SolveActive(const std::vector<DenseRow>& A, const Eigen::VectorXd& b,
                                    const std::vector<Index>& active) {
  const auto m = static_cast<Index>(active.size());
  RationalMatrix block(m, m), right(m, 1), x(m, 1);
  for (Index i = 0; i < m; ++i) {
    for (Index j = 0; j < m; ++j) Assign(block.at(i, j), A[At(active[At(i)])][At(active[At(j)])]);
    Assign(right.at(i, 0), -Rational(b[active[At(i)]]));
  }
  if (m > 0 && fmpq_mat_solve(x.get(), block.get(), right.get()) == 0) return std::nullopt;
  DenseRow values;
  for (Index i = 0; i < m; ++i) values.push_back(ToRational(x.at(i, 0)));
  return values;
}

// One SolveByEnumeration.
class Enumeration {
 public:
  explicit Enumeration(const LcpProblem& problem) : problem_(problem) {
    for (const auto& row : problem.DenseA().rowwise()) A_.emplace_back(row.begin(), row.end());
  }

  void Try(const std::vector<Index>& active) {
    const std::optional<DenseRow> x = SolveActive(A_, problem_.b(), active);
    if (!x) {
      any_singular_ = true;
      return;
    }
    for (size_t k = 0; k < active.size(); ++k) {
      if ((*x)[k] < 0 && !problem_.is_bilateral(active[k])) return;
    }
    DenseRow f(At(problem_.size()));
    for (size_t k = 0; k < active.size(); ++k) f[At(active[k])] = (*x)[k];
    std::optional<DenseRow> w = GapsOfAnswer(problem_, f);
    if (!w) return;
    if (answer_.status == LcpReference::Status::kSolved) {
      any_other_ = any_other_ || f != answer_.f;
      return;
    }
    answer_.status = LcpReference::Status::kSolved;
    answer_.f = std::move(f);
    answer_.w = *std::move(w);
  }

  // -1 where there is none.
  Index HopelessRow() const {
    if (!problem_.bilateral_rows().empty()) return -1;
    for (Index i = 0; i < problem_.size(); ++i) {
      const DenseRow& row = A_[At(i)];
      if (problem_.b()[i] < 0 && std::none_of(row.begin(), row.end(), [](const Rational& a) { return a > 0; })) {
        return i;
      }
    }
    return -1;
  }

  EnumeratedAnswer Answer(bool tried_all) && {
    const bool solved = answer_.status == LcpReference::Status::kSolved;
    if (any_other_) answer_.f_unique = false;
    if (tried_all && !any_singular_) {
      if (solved) answer_.f_unique = !any_other_;
      if (!solved) {
        answer_.status = LcpReference::Status::kInfeasible;
        answer_.detail = "by enumeration of all active sets";
      }
    } else if (!solved) {
      answer_.detail = tried_all ? "no nonsingular active set has an answer" : "no answer was guessed";
    }
    return std::move(answer_);
  }

 private:
  const LcpProblem& problem_;
  std::vector<DenseRow> A_;
  EnumeratedAnswer answer_;
  bool any_singular_ = false;
  bool any_other_ = false;
};

}  // namespace

std::optional<std::vector<Rational>> GapsOfAnswer(const LcpProblem& problem, const std::vector<Rational>& f) {
  std::vector<Rational> w(At(problem.size()));
  for (Index i = 0; i < problem.size(); ++i) {
    Rational& gap = w[At(i)];
    gap = problem.b()[i];
    for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
      if (f[At(it.col())] != 0) gap += Rational(it.value()) * f[At(it.col())];
    }
    const bool solves = problem.is_bilateral(i) ? gap == 0 : gap >= 0 && f[At(i)] >= 0 && (gap == 0 || f[At(i)] == 0);
    if (!solves) return std::nullopt;
  }
  return w;
}

EnumeratedAnswer SolveByEnumeration(const LcpProblem& problem, const std::vector<Eigen::VectorXd>& guesses) {
  const Index n = problem.size();
  Enumeration enumeration(problem);
  if (const Index row = enumeration.HopelessRow(); row >= 0) {
    EnumeratedAnswer answer;
    answer.status = LcpReference::Status::kInfeasible;
    answer.detail = "w < 0 on row " + std::to_string(row) + " whatever f >= 0";
    return answer;
  }
  for (const Eigen::VectorXd& guess : guesses) {
    if (n > kMostGuessedRows || guess.size() != n || !guess.allFinite()) continue;
    Eigen::VectorXd w;
    problem.ComputeW(guess, &w);
    std::vector<Index> active;
    for (Index i = 0; i < n; ++i) {
      if (problem.is_bilateral(i) || guess[i] > w[i]) active.push_back(i);
    }
    enumeration.Try(active);
  }
  if (n > kMostEnumeratedRows) return std::move(enumeration).Answer(false);
  for (std::uint64_t set = 0; set < std::uint64_t{1} << static_cast<unsigned>(n); ++set) {
    std::vector<Index> active;
    bool has_bilateral = true;
    for (Index i = 0; i < n; ++i) {
      const bool is_active = (set >> static_cast<unsigned>(i) & 1U) != 0;
      if (is_active) active.push_back(i);
      if (!is_active && problem.is_bilateral(i)) has_bilateral = false;
    }
    if (has_bilateral) enumeration.Try(active);
  }
  return std::move(enumeration).Answer(true);
}

}  // namespace lcpbench
