#include "solvers/lcp/problem.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <utility>

#include "solvers/lcp/input_error.h"
#include "solvers/lcp/memory_budget.h"
#include "solvers/lcp/problem_arrays.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

[[noreturn]] void Reject(const std::string& id, const std::string& what) {
  throw InputError("problem '" + id + "': " + what);
}

void RequireFinite(const std::string& id, const char* name, const double* values, Index count) {
  for (Index i = 0; i < count; ++i) {
    if (!std::isfinite(values[i])) {
      Reject(id,
             std::string(name) + " must be finite, entry " + std::to_string(i) + " is " + std::to_string(values[i]));
    }
  }
}

void RequireShape(const std::string& id, const char* name, Index rows, Index cols, Index want_rows, Index want_cols) {
  if (rows != want_rows || cols != want_cols) {
    Reject(id, std::string(name) + " must be " + std::to_string(want_rows) + " x " + std::to_string(want_cols) +
                   ", found " + std::to_string(rows) + " x " + std::to_string(cols));
  }
}

}  // namespace

struct LcpProblem::State {
  std::string id;
  MatrixForm form = MatrixForm::kDense;
  Eigen::VectorXd b;
  MatrixFacts facts;

  Eigen::MatrixXd given_dense;
  SparseMatrix given_sparse;
  SparseMatrix J;
  Eigen::VectorXd inverse_mass;
  bool two_body_rows = false;

  Eigen::VectorXd lower;  // empty when every row is unilateral
  Eigen::VectorXd upper;
  std::vector<Index> bilateral;
  bool standard_bounds = true;

  // Derived on request, once; the flags make that safe from several threads.
  std::once_flag dense_once, sparse_once, diagonal_once, asymmetry_once;
  Eigen::MatrixXd derived_dense;
  SparseMatrix derived_sparse;
  Eigen::VectorXd diagonal;
  double asymmetry = 0;

  void SetBounds(RowBounds bounds) {
    const Index n = b.size();
    if (bounds.lower.size() == 0 && bounds.upper.size() == 0) return;
    RequireShape(id, "lower", bounds.lower.size(), 1, n, 1);
    RequireShape(id, "upper", bounds.upper.size(), 1, n, 1);
    lower = std::move(bounds.lower);
    upper = std::move(bounds.upper);
    for (Index i = 0; i < n; ++i) {
      const double lo = lower[i];
      const double hi = upper[i];
      if (!(lo <= hi) || lo == kInfinity || hi == -kInfinity) {
        Reject(id, "row " + std::to_string(i) + " has bounds [" + std::to_string(lo) + ", " + std::to_string(hi) +
                       "], expected lower <= upper");
      }
      if (lo == -kInfinity && hi == kInfinity) {
        bilateral.push_back(i);
      } else if (lo != 0 || hi != kInfinity) {
        standard_bounds = false;
      }
    }
  }

  void DetectTwoBodyRows() {
    two_body_rows = inverse_mass.size() % 3 == 0;
    for (Index i = 0; i < J.rows() && two_body_rows; ++i) {
      std::array<int, 2> blocks = {-1, -1};
      for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
        const int block = static_cast<int>(it.col() / 3);
        if (inverse_mass[it.col()] == 0 || it.value() == 0 || block == blocks[0] || block == blocks[1]) continue;
        if (blocks[0] < 0) {
          blocks[0] = block;
        } else if (blocks[1] < 0) {
          blocks[1] = block;
        } else {
          two_body_rows = false;
          break;
        }
      }
    }
  }

  // A = J M^-1 J^T row by row. Every entry sums m_k (J_ik J_jk) over ascending k, so (i, j) and (j, i) round alike.
  void FormSparseFromFactors() {
    const Index n = J.rows();
    const Eigen::SparseMatrix<double, Eigen::ColMajor, int> columns = J;
    std::vector<double> sums(static_cast<size_t>(n), 0.0);
    std::vector<Index> last_row(static_cast<size_t>(n), -1);
    std::vector<int> pattern;
    std::vector<int> outer(static_cast<size_t>(n) + 1, 0);
    std::vector<int> inner;
    std::vector<double> values;
    for (Index i = 0; i < n; ++i) {
      pattern.assign(1, static_cast<int>(i));
      last_row[static_cast<size_t>(i)] = i;
      for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
        const double m = inverse_mass[it.col()];
        if (m == 0) continue;
        for (decltype(columns)::InnerIterator jt(columns, it.col()); jt; ++jt) {
          const auto j = static_cast<size_t>(jt.row());
          if (last_row[j] != i) {
            last_row[j] = i;
            pattern.push_back(static_cast<int>(j));
          }
          sums[j] += m * (it.value() * jt.value());
        }
      }
      std::sort(pattern.begin(), pattern.end());
      if (inner.size() + pattern.size() > static_cast<size_t>(std::numeric_limits<int>::max())) {
        throw std::length_error("A has more than 2^31 - 1 stored entries");
      }
      for (const int j : pattern) {
        inner.push_back(j);
        values.push_back(sums[static_cast<size_t>(j)]);
        sums[static_cast<size_t>(j)] = 0;
      }
      outer[static_cast<size_t>(i) + 1] = static_cast<int>(inner.size());
    }
    derived_sparse = Eigen::Map<const SparseMatrix>(n, n, static_cast<Index>(inner.size()), outer.data(), inner.data(),
                                                    values.data());
  }

  // Copies `source` with every diagonal entry stored.
  void FormSparseWithDiagonal(const SparseMatrix& source) {
    const Index n = source.rows();
    std::vector<Eigen::Triplet<double, int>> entries;
    entries.reserve(static_cast<size_t>(source.nonZeros() + n));
    for (Index i = 0; i < n; ++i) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 0.0);
      for (SparseMatrix::InnerIterator it(source, i); it; ++it) {
        entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()), it.value());
      }
    }
    derived_sparse.resize(n, n);
    derived_sparse.setFromTriplets(entries.begin(), entries.end());
  }
};

RowBounds RowBounds::WithBilateralRows(Index n, const std::vector<Index>& bilateral) {
  RowBounds bounds;
  if (bilateral.empty()) return bounds;
  bounds.lower = Eigen::VectorXd::Zero(n);
  bounds.upper = Eigen::VectorXd::Constant(n, kInfinity);
  for (const Index row : bilateral) {
    if (row < 0 || row >= n) {
      throw InputError("bilateral: row index " + std::to_string(row) + " is outside [0, " + std::to_string(n) + ")");
    }
    if (bounds.lower[row] != 0) throw InputError("bilateral: row index " + std::to_string(row) + " is listed twice");
    bounds.lower[row] = -kInfinity;
  }
  return bounds;
}

LcpProblem LcpProblem::FromDense(std::string id, Eigen::MatrixXd A, Eigen::VectorXd b, RowBounds bounds,
                                 MatrixFacts facts) {
  auto state = std::make_shared<State>();
  state->id = std::move(id);
  state->form = MatrixForm::kDense;
  const Index n = b.size();
  RequireShape(state->id, "A", A.rows(), A.cols(), n, n);
  RequireFinite(state->id, "A", A.data(), A.size());
  RequireFinite(state->id, "b", b.data(), n);
  state->given_dense = std::move(A);
  state->b = std::move(b);
  state->facts = facts;
  state->SetBounds(std::move(bounds));
  return LcpProblem(std::move(state));
}

LcpProblem LcpProblem::FromSparse(std::string id, SparseMatrix A, Eigen::VectorXd b, RowBounds bounds,
                                  MatrixFacts facts) {
  auto state = std::make_shared<State>();
  state->id = std::move(id);
  state->form = MatrixForm::kSparse;
  const Index n = b.size();
  RequireShape(state->id, "A", A.rows(), A.cols(), n, n);
  A.makeCompressed();
  RequireFinite(state->id, "A", A.valuePtr(), A.nonZeros());
  RequireFinite(state->id, "b", b.data(), n);
  state->given_sparse.swap(A);  // Eigen's sparse matrices cannot be moved
  state->b = std::move(b);
  state->facts = facts;
  state->SetBounds(std::move(bounds));
  return LcpProblem(std::move(state));
}

LcpProblem LcpProblem::FromFactors(std::string id, SparseMatrix J, Eigen::VectorXd inverse_mass, Eigen::VectorXd b,
                                   RowBounds bounds, MatrixFacts facts) {
  auto state = std::make_shared<State>();
  state->id = std::move(id);
  state->form = MatrixForm::kFactors;
  RequireShape(state->id, "J", J.rows(), J.cols(), b.size(), inverse_mass.size());
  J.makeCompressed();
  RequireFinite(state->id, "J", J.valuePtr(), J.nonZeros());
  RequireFinite(state->id, "inverse mass", inverse_mass.data(), inverse_mass.size());
  RequireFinite(state->id, "b", b.data(), b.size());
  for (Index k = 0; k < inverse_mass.size(); ++k) {
    if (inverse_mass[k] < 0) {
      Reject(state->id,
             "inverse mass must be >= 0, entry " + std::to_string(k) + " is " + std::to_string(inverse_mass[k]));
    }
  }
  facts.symmetric = true;
  facts.positive_semidefinite = true;
  state->J.swap(J);  // Eigen's sparse matrices cannot be moved
  state->inverse_mass = std::move(inverse_mass);
  state->b = std::move(b);
  state->facts = facts;
  state->SetBounds(std::move(bounds));
  state->DetectTwoBodyRows();
  return LcpProblem(std::move(state));
}

ProblemArrays ProblemArrays::Of(const LcpProblem& problem) {
  if (!problem.has_standard_bounds()) throw InputError("problem '" + problem.id() + "': bounds are not standard");
  ProblemArrays arrays;
  arrays.id = problem.id();
  arrays.form = problem.given_form();
  arrays.rows = arrays.columns = problem.size();
  const auto take_rows = [&arrays](const SparseMatrix& matrix) {
    arrays.columns = matrix.cols();
    arrays.row_start.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.rows() + 1);
    arrays.column.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
    arrays.value.assign(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros());
  };
  switch (arrays.form) {
    case MatrixForm::kFactors:
      take_rows(problem.J());
      arrays.inverse_mass.assign(problem.inverse_mass().begin(), problem.inverse_mass().end());
      break;
    case MatrixForm::kSparse:
      take_rows(problem.SparseA());
      break;
    case MatrixForm::kDense:
      for (Index i = 0; i < arrays.rows; ++i) {
        const auto row = problem.DenseA().row(i);
        arrays.value.insert(arrays.value.end(), row.begin(), row.end());
      }
      break;
  }
  arrays.b.assign(problem.b().begin(), problem.b().end());
  if (!problem.bilateral_rows().empty()) arrays.bilateral.assign(arrays.b.size(), 0);
  for (const Index row : problem.bilateral_rows()) arrays.bilateral[static_cast<size_t>(row)] = 1;
  arrays.facts = problem.facts();
  return arrays;
}

LcpProblem LcpProblem::FromArrays(const ProblemArrays& arrays) {
  const Index n = arrays.rows;
  Eigen::VectorXd b = Eigen::Map<const Eigen::VectorXd>(arrays.b.data(), static_cast<Index>(arrays.b.size()));
  std::vector<Index> bilateral;
  for (size_t i = 0; i < arrays.bilateral.size(); ++i) {
    if (arrays.bilateral[i] != 0) bilateral.push_back(static_cast<Index>(i));
  }
  RowBounds bounds = RowBounds::WithBilateralRows(n, bilateral);
  if (arrays.form == MatrixForm::kDense) {
    using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
    return FromDense(arrays.id, Eigen::Map<const RowMajor>(arrays.value.data(), n, n), std::move(b), std::move(bounds),
                     arrays.facts);
  }
  SparseMatrix matrix =
      Eigen::Map<const SparseMatrix>(n, arrays.columns, static_cast<Index>(arrays.value.size()),
                                     arrays.row_start.data(), arrays.column.data(), arrays.value.data());
  if (arrays.form == MatrixForm::kSparse) {
    return FromSparse(arrays.id, std::move(matrix), std::move(b), std::move(bounds), arrays.facts);
  }
  Eigen::VectorXd inverse_mass =
      Eigen::Map<const Eigen::VectorXd>(arrays.inverse_mass.data(), static_cast<Index>(arrays.inverse_mass.size()));
  return FromFactors(arrays.id, std::move(matrix), std::move(inverse_mass), std::move(b), std::move(bounds),
                     arrays.facts);
}

LcpProblem LcpProblem::WithB(Eigen::VectorXd b) const {
  RowBounds bounds{state_->lower, state_->upper};
  switch (state_->form) {
    case MatrixForm::kSparse:
      return FromSparse(state_->id, state_->given_sparse, std::move(b), std::move(bounds), state_->facts);
    case MatrixForm::kFactors:
      return FromFactors(state_->id, state_->J, state_->inverse_mass, std::move(b), std::move(bounds), state_->facts);
    case MatrixForm::kDense:
      break;
  }
  return FromDense(state_->id, state_->given_dense, std::move(b), std::move(bounds), state_->facts);
}

bool LcpProblem::SharesMatrixWith(const LcpProblem& other) const { return state_ == other.state_; }

LcpProblem LcpProblem::CopyOfGivenForm() const {
  RowBounds bounds{state_->lower, state_->upper};
  switch (state_->form) {
    case MatrixForm::kSparse:
      return FromSparse(state_->id, state_->given_sparse, state_->b, std::move(bounds), state_->facts);
    case MatrixForm::kFactors:
      return FromFactors(state_->id, state_->J, state_->inverse_mass, state_->b, std::move(bounds), state_->facts);
    case MatrixForm::kDense:
      break;
  }
  return FromDense(state_->id, state_->given_dense, state_->b, std::move(bounds), state_->facts);
}

const std::string& LcpProblem::id() const { return state_->id; }
Index LcpProblem::size() const { return state_->b.size(); }
MatrixForm LcpProblem::given_form() const { return state_->form; }
const MatrixFacts& LcpProblem::facts() const { return state_->facts; }
const Eigen::VectorXd& LcpProblem::b() const { return state_->b; }
bool LcpProblem::has_two_body_rows() const { return state_->two_body_rows; }

const SparseMatrix& LcpProblem::J() const {
  if (!has_factors()) throw std::logic_error("LcpProblem::J: the problem has no factors");
  return state_->J;
}

const Eigen::VectorXd& LcpProblem::inverse_mass() const {
  if (!has_factors()) throw std::logic_error("LcpProblem::inverse_mass: the problem has no factors");
  return state_->inverse_mass;
}

const Eigen::MatrixXd& LcpProblem::DenseA() const {
  State& s = *state_;
  if (s.form == MatrixForm::kDense) return s.given_dense;
  std::call_once(s.dense_once, [&] {
    const auto n = static_cast<double>(size());
    RequireMemory(n * n * sizeof(double), "the dense A");
    const SparseMatrix& sparse = s.form == MatrixForm::kSparse ? s.given_sparse : SparseA();
    s.derived_dense = Eigen::MatrixXd(sparse);
  });
  return s.derived_dense;
}

const SparseMatrix& LcpProblem::SparseA() const {
  State& s = *state_;
  std::call_once(s.sparse_once, [&] {
    switch (s.form) {
      case MatrixForm::kFactors:
        s.FormSparseFromFactors();
        break;
      case MatrixForm::kSparse:
        s.FormSparseWithDiagonal(s.given_sparse);
        break;
      case MatrixForm::kDense:
        s.FormSparseWithDiagonal(s.given_dense.sparseView(1.0, 0.0));
        break;
    }
  });
  return s.derived_sparse;
}

const Eigen::VectorXd& LcpProblem::DiagonalA() const {
  State& s = *state_;
  std::call_once(s.diagonal_once, [&] {
    switch (s.form) {
      case MatrixForm::kFactors:
        s.diagonal = Eigen::VectorXd::Zero(size());
        for (Index i = 0; i < size(); ++i) {
          double sum = 0;
          for (SparseMatrix::InnerIterator it(s.J, i); it; ++it) {
            sum += s.inverse_mass[it.col()] * (it.value() * it.value());
          }
          s.diagonal[i] = sum;
        }
        break;
      case MatrixForm::kSparse:
        s.diagonal = s.given_sparse.diagonal();
        break;
      case MatrixForm::kDense:
        s.diagonal = s.given_dense.diagonal();
        break;
    }
  });
  return s.diagonal;
}

double LcpProblem::Asymmetry() const {
  State& s = *state_;
  if (s.form == MatrixForm::kFactors) return 0;
  std::call_once(s.asymmetry_once, [&] {
    const Eigen::VectorXd& d = DiagonalA();
    const auto relative = [&](Index i, Index j, double difference) {
      const double scale = std::sqrt(std::abs(d[i]) * std::abs(d[j]));
      return std::abs(difference) / (scale > 0 ? scale : 1.0);
    };
    double worst = 0;
    if (s.form == MatrixForm::kDense) {
      for (Index j = 0; j < size(); ++j) {
        for (Index i = j + 1; i < size(); ++i) {
          worst = std::max(worst, relative(i, j, s.given_dense(i, j) - s.given_dense(j, i)));
        }
      }
    } else {
      const SparseMatrix transpose = s.given_sparse.transpose();
      const SparseMatrix difference = s.given_sparse - transpose;
      for (Index i = 0; i < difference.outerSize(); ++i) {
        for (SparseMatrix::InnerIterator it(difference, i); it; ++it) {
          worst = std::max(worst, relative(i, it.col(), it.value()));
        }
      }
    }
    s.asymmetry = worst;
  });
  return s.asymmetry;
}

void LcpProblem::ComputeW(const Eigen::VectorXd& f, Eigen::VectorXd* w) const {
  const State& s = *state_;
  *w = s.b;
  switch (s.form) {
    case MatrixForm::kDense:
      w->noalias() += s.given_dense * f;
      break;
    case MatrixForm::kSparse:
      w->noalias() += s.given_sparse * f;
      break;
    case MatrixForm::kFactors: {
      const Eigen::VectorXd body = s.inverse_mass.cwiseProduct(s.J.transpose() * f);
      w->noalias() += s.J * body;
      break;
    }
  }
}

double LcpProblem::lower(Index row) const {
  if (state_->lower.size() == 0) return 0.0;
  return state_->lower[row];
}

double LcpProblem::upper(Index row) const {
  if (state_->upper.size() == 0) return kInfinity;
  return state_->upper[row];
}

bool LcpProblem::is_bilateral(Index row) const { return lower(row) == -kInfinity && upper(row) == kInfinity; }
const std::vector<Index>& LcpProblem::bilateral_rows() const { return state_->bilateral; }
bool LcpProblem::has_standard_bounds() const { return state_->standard_bounds; }

}  // namespace lcpbench
