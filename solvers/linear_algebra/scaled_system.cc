#include "solvers/linear_algebra/scaled_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "solvers/lcp/in_sequence.h"
#include "solvers/lcp/memory_budget.h"

namespace lcpbench {
namespace {

// Beyond this many entries A is not formed where the factors can do without it
// (12 bytes an entry).
constexpr double kAffordableEntries = 3e7;
// Body space is taken where sum (column count of J)^2, which is about three times the entries of A for contacts of
// rigid bodies, exceeds this multiple of the entries of J. Measured at 3e3 to 1e5 rows: up to 6 (discs) contact space
// is factorised 1.5 to 3 times faster, from 9 on (boxes, walls, bearings) body space is 1.4 to 4 times faster.
constexpr double kBodySpaceRatio = 7;

// Union by smaller root, so that a component's representative is its first row whatever the order of the unions.
class DisjointSets {
 public:
  explicit DisjointSets(Index n) : parent_(static_cast<size_t>(n)) { std::iota(parent_.begin(), parent_.end(), 0); }
  int Find(int i) {
    while (Parent(i) != i) {
      Parent(i) = Parent(Parent(i));
      i = Parent(i);
    }
    return i;
  }
  void Unite(int i, int j) {
    i = Find(i);
    j = Find(j);
    if (i != j) Parent(std::max(i, j)) = std::min(i, j);
  }

 private:
  int& Parent(int i) { return parent_[static_cast<size_t>(i)]; }
  std::vector<int> parent_;
};

}  // namespace

double MaxAbs(const Eigen::VectorXd& x) {
  double largest = 0;
  for (const double value : x) {
    if (!(std::abs(value) <= largest)) largest = std::abs(value);
    if (std::isnan(largest)) return largest;
  }
  return largest;
}

void ScaledSystem::Prepare(const LcpProblem& problem, Space space) {
  problem_ = problem;
  analyses_ = 0;
  double contact_entries = 0;
  if (problem.has_factors()) {
    Eigen::VectorXd counts = Eigen::VectorXd::Zero(problem.J().cols());
    for (Index i = 0; i < problem.size(); ++i) {
      for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) counts[it.col()] += 1;
    }
    for (Index k = 0; k < counts.size(); ++k) {
      if (problem.inverse_mass()[k] > 0) contact_entries += counts[k] * counts[k];
    }
  }
  a_is_affordable_ = contact_entries <= kAffordableEntries;
  ScaleRows();
  FindComponents();
  body_space_ = ChooseBodySpace(space, contact_entries);
  if (body_space_) {
    BuildBodySpace();
  } else {
    BuildContactSpace();
  }
  extended_.Reset(problem, Residual<long double>::Rows::kGivenWhenNeeded);
  extended_w_.resize(problem.size());
}

bool ScaledSystem::ChooseBodySpace(Space space, double contact_entries) {
  if (space == Space::kContact || !BodySpace::Suits(*problem_)) return false;
  if (space == Space::kBody || !a_is_affordable_) return true;
  return contact_entries > kBodySpaceRatio * static_cast<double>(problem_->J().nonZeros());
}

void ScaledSystem::ScaleRows() {
  const LcpProblem& problem = *problem_;
  const Index n = problem.size();
  diagonal_ = problem.DiagonalA();
  root_.resize(n);
  for (Index i = 0; i < n; ++i) root_[i] = diagonal_[i] > 0 ? std::sqrt(diagonal_[i]) : 1.0;
  bilateral_row_.assign(static_cast<size_t>(n), 0);
  for (const Index i : problem.bilateral_rows()) bilateral_row_[static_cast<size_t>(i)] = 1;
}

void ScaledSystem::FindComponents() {
  const LcpProblem& problem = *problem_;
  const Index n = problem.size();
  DisjointSets sets(n);
  if (problem.has_factors()) {
    std::vector<int> first_row(static_cast<size_t>(problem.J().cols()), -1);
    for (Index i = 0; i < n; ++i) {
      for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
        if (it.value() == 0 || problem.inverse_mass()[it.col()] == 0) continue;
        int& first = first_row[static_cast<size_t>(it.col())];
        if (first < 0) first = static_cast<int>(i);
        sets.Unite(first, static_cast<int>(i));
      }
    }
  } else {
    const SparseMatrix& A = problem.SparseA();
    for (Index i = 0; i < n; ++i) {
      for (SparseMatrix::InnerIterator it(A, i); it; ++it) {
        if (it.value() != 0) sets.Unite(static_cast<int>(i), static_cast<int>(it.col()));
      }
    }
  }

  std::vector<int> number(static_cast<size_t>(n), -1);
  component_.assign(static_cast<size_t>(n), 0);
  component_count_ = 0;
  for (Index i = 0; i < n; ++i) {
    int& c = number[static_cast<size_t>(sets.Find(static_cast<int>(i)))];
    if (c < 0) c = component_count_++;
    component_[static_cast<size_t>(i)] = c;
  }
}

void ScaledSystem::SetB(const LcpProblem& problem) {
  problem_ = problem;
  extended_.SetB(problem);
  estimate_ready_ = false;
  const Index n = size();
  double sum = 0;
  component_b_.assign(static_cast<size_t>(component_count_), 0);
  component_is_live_.assign(static_cast<size_t>(component_count_), 0);  // where f = 0 is no solution
  for (Index i = 0; i < n; ++i) {
    const double scaled = problem.b()[i] / root_[i];
    sum += scaled * scaled;
    const auto k = static_cast<size_t>(component(i));
    component_b_[k] = std::max(component_b_[k], std::abs(scaled));
    const bool is_joint = bilateral_row_[static_cast<size_t>(i)] != 0;
    if (is_joint ? problem.b()[i] != 0 : problem.b()[i] < 0) component_is_live_[k] = 1;
  }
  b_norm_ = sum > 0 ? std::sqrt(sum) : 1.0;
  kind_.assign(static_cast<size_t>(n), RowKind::kIdle);
  b_.resize(n);
  force_unit_.resize(n);
  gap_unit_.resize(n);
  for (Index i = 0; i < n; ++i) {
    const auto c = static_cast<size_t>(component(i));
    const double unit = component_b_[c] > 0 ? component_b_[c] : 1.0;
    if (component_is_live_[c] != 0 && diagonal_[i] > 0) {
      kind_[static_cast<size_t>(i)] =
          bilateral_row_[static_cast<size_t>(i)] != 0 ? RowKind::kBilateral : RowKind::kUnilateral;
    }
    force_unit_[i] = unit / root_[i];
    gap_unit_[i] = unit * root_[i];
    b_[i] = problem.b()[i] / gap_unit_[i];
  }
}

void ScaledSystem::BuildContactSpace() {
  const LcpProblem& problem = *problem_;
  const Index n = problem.size();
  scaled_A_ = problem.SparseA();
  for (Index i = 0; i < n; ++i) {
    for (SparseMatrix::InnerIterator it(scaled_A_, i); it; ++it) {
      it.valueRef() = it.col() == i ? (diagonal_[i] > 0 ? 1.0 : 0.0) : it.value() / root_[i] / root_[it.col()];
    }
  }
  // Row-major upper triangle = column-major lower triangle of the symmetric matrix.
  const SparseMatrix upper = scaled_A_.triangularView<Eigen::Upper>();
  const Eigen::Map<const CholmodFactor::ColumnMatrix> lower(n, n, upper.nonZeros(), upper.outerIndexPtr(),
                                                            upper.innerIndexPtr(), upper.valuePtr());
  if (!InSequence::on() || !factor_.TakeValues(lower)) AnalyzeContactSpace(lower);
}

// Contacts come and go from problem to problem; the others keep their order while it serves.
void ScaledSystem::AnalyzeContactSpace(const CholmodFactor::ColumnMatrix& lower) {
  constexpr auto kDefinite = CholmodFactor::Definiteness::kPositiveDefinite;
  std::vector<KeptOrder::Name> names;
  if (InSequence::on()) names = NamesOfRows(*problem_);
  const Eigen::VectorXi order = kept_.Find(names, lower.outerIndexPtr(), lower.innerIndexPtr());
  if (order.size() > 0) {
    ++analyses_;
    try {
      factor_.Analyze(kDefinite, lower, order);
      if (kept_.Serves(factor_.flops())) return;
    } catch (const MemoryRefusal&) {  // an order anew may need less
    }
  }
  kept_.Clear();
  ++analyses_;
  factor_.Analyze(kDefinite, lower);
  kept_.Keep(names, factor_.order(), factor_.flops());
}

void ScaledSystem::BuildBodySpace() {
  std::vector<char> can_act(static_cast<size_t>(size()));
  for (Index i = 0; i < size(); ++i) can_act[static_cast<size_t>(i)] = diagonal_[i] > 0 ? 1 : 0;
  bodies_.Prepare(*problem_, can_act, /*will_update=*/false);
  bodies_.Load(*problem_, root_);
  analyses_ += bodies_.analyses();
}

void ScaledSystem::Multiply(const Eigen::VectorXd& x, Eigen::VectorXd* y) const {
  if (body_space_) {
    y->resize(size());
    bodies_.Multiply(x.data(), y->data());
  } else {
    y->noalias() = scaled_A_ * x;
  }
}

void ScaledSystem::GapsExtended(const Eigen::VectorXd& f, bool with_b, Eigen::VectorXd* w) {
  extended_.ComputeW(f, &extended_w_);
  if (!with_b) extended_w_ -= problem_->b().cast<long double>();
  *w = extended_w_.cast<double>();
}

bool ScaledSystem::Factorize(const Eigen::VectorXd& theta) {
  if (body_space_) {
    pivots_ = theta;
    for (Index i = 0; i < size(); ++i) {
      if (idle(i)) pivots_[i] = kOut;
    }
    return bodies_.Factorize(pivots_);
  }
  for (Index i = 0; i < size(); ++i) factor_.SetDiagonal(i, 1.0 + (idle(i) ? kOut : theta[i]));
  return factor_.Factorize();
}

void ScaledSystem::Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x) {
  if (body_space_) {
    bodies_.Solve(r, x);
  } else {
    factor_.Solve(r, x);
  }
}

double ScaledSystem::Rho(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
  double sum = 0;
  for (Index i = 0; i < size(); ++i) {
    const double q = w[i] / root_[i];
    const double residual = bilateral_row_[static_cast<size_t>(i)] != 0 ? q : std::min(root_[i] * f[i], q);
    sum += residual * residual;
  }
  return std::sqrt(sum) / b_norm_;
}

double ScaledSystem::BackwardErrorBound(const Eigen::VectorXd& f, const Eigen::VectorXd& w, Index i) const {
  const double force = diagonal_[i] * f[i];
  const double defect = std::abs(bilateral_row_[static_cast<size_t>(i)] != 0 ? w[i] : std::min(force, w[i]));
  if (defect == 0) return 0;
  const double b = problem_->b()[i];
  return defect / (std::abs(b) + std::max(std::abs(force), std::abs(w[i] - b)));
}

bool ScaledSystem::Meets(double tolerance, const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
  if (!(Rho(f, w) <= tolerance)) return false;
  double worst = 0;
  for (Index i = 0; i < size(); ++i) {
    const double bound = BackwardErrorBound(f, w, i);
    if (!(bound <= worst)) worst = bound;
  }
  if (worst <= std::sqrt(tolerance)) return true;
  if (!a_is_affordable_ || !std::isfinite(worst)) return false;
  if (!estimate_ready_) {
    using Rows = ResidualEstimate::Rows;
    estimate_.Reset(*problem_, problem_->given_form() == MatrixForm::kDense ? Rows::kDense : Rows::kSparse);
    estimate_.SetB(*problem_);
    estimate_ready_ = true;
  }
  return estimate_.Meets(tolerance, f, w);
}

}  // namespace lcpbench
