#include "solvers/exact/enumeration.h"

#include <algorithm>
#include <cstdint>
#include <utility>

namespace lcpbench {
namespace {

using Row = std::vector<Rational>;

// Row i of A.
Row RowOf(const LcpProblem& problem, Index i) {
  Row row(At(problem.size()));
  if (problem.given_form() == MatrixForm::kDense) {
    for (Index j = 0; j < problem.size(); ++j) row[At(j)] = problem.DenseA()(i, j);
    return row;
  }
  for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) row[At(it.col())] = it.value();
  return row;
}

// x of A_FF x = -b_F; nothing where A_FF is singular.
std::optional<Row> SolveActive(const std::vector<Row>& A, const Eigen::VectorXd& b, const std::vector<Index>& active) {
  const size_t m = active.size();
  std::vector<Row> system(m, Row(m + 1));
  for (size_t i = 0; i < m; ++i) {
    for (size_t j = 0; j < m; ++j) system[i][j] = A[At(active[i])][At(active[j])];
    system[i][m] = -Rational(b[active[i]]);
  }
  for (size_t k = 0; k < m; ++k) {
    size_t pivot = k;
    while (pivot < m && system[pivot][k] == 0) ++pivot;
    if (pivot == m) return std::nullopt;
    std::swap(system[k], system[pivot]);
    for (size_t i = 0; i < m; ++i) {
      if (i == k || system[i][k] == 0) continue;
      const Rational factor = system[i][k] / system[k][k];
      for (size_t j = k; j <= m; ++j) system[i][j] -= factor * system[k][j];
    }
  }
  Row x(m);
  for (size_t k = 0; k < m; ++k) x[k] = system[k][m] / system[k][k];
  return x;
}

// One SolveByEnumeration.
class Enumeration {
 public:
  explicit Enumeration(const LcpProblem& problem) : problem_(problem) {
    for (Index i = 0; i < problem.size(); ++i) A_.push_back(RowOf(problem, i));
  }

  void Try(const std::vector<Index>& active) {
    const std::optional<Row> x = SolveActive(A_, problem_.b(), active);
    if (!x) {
      any_singular_ = true;
      return;
    }
    for (size_t k = 0; k < active.size(); ++k) {
      if ((*x)[k] < 0 && !problem_.is_bilateral(active[k])) return;
    }
    Row f(At(problem_.size()));
    for (size_t k = 0; k < active.size(); ++k) f[At(active[k])] = (*x)[k];
    std::optional<Row> w = GapsOfAnswer(problem_, f);
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
      const Row& row = A_[At(i)];
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
  std::vector<Row> A_;
  EnumeratedAnswer answer_;
  bool any_singular_ = false;
  bool any_other_ = false;
};

}  // namespace

std::optional<std::vector<Rational>> GapsOfAnswer(const LcpProblem& problem, const std::vector<Rational>& f) {
  std::vector<Rational> w(At(problem.size()));
  const bool is_dense = problem.given_form() == MatrixForm::kDense;
  for (Index i = 0; i < problem.size(); ++i) {
    Rational& gap = w[At(i)];
    gap = problem.b()[i];
    const auto add = [&](Index j, double value) {
      if (f[At(j)] != 0) gap += Rational(value) * f[At(j)];
    };
    if (is_dense) {
      for (Index j = 0; j < problem.size(); ++j) add(j, problem.DenseA()(i, j));
    } else {
      for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) add(it.col(), it.value());
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
