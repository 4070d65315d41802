#include "solvers/linear_algebra/body_active_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

namespace lcpbench {
namespace {

constexpr int kAxes = 3;
constexpr int kNone = -1;

// Nanoseconds, measured on scenes of 10^3 to 10^5 rows; only their ratios matter, and only to time, not to answers.
constexpr double kFlopBySupernodes = 0.08;
constexpr double kFlopByColumns = 0.5;
constexpr double kFactorEntry = 4;    // of L, besides its flop
constexpr double kSolveEntry = 8;     // of L, a solve and its refinement
constexpr double kRow = 15;           // of setting up K
constexpr double kConvertEntry = 3;   // of a factor by supernodes into one by columns
constexpr double kUpdateEntry = 0.8;  // of L, for each row that changes
constexpr double kUpdateRow = 300;

// Refinement ends when the residual is rounding, (|r| + |x|) times this, or falls by less than kSlow.
constexpr double kRounding = 16 * std::numeric_limits<double>::epsilon();
constexpr double kSlow = 0.25;
constexpr int kMaxRefinements = 4;
// A residual above this is not what rounding of a good factor leaves.
constexpr double kWornOut = 1e-11;

size_t At(Index i) { return static_cast<size_t>(i); }
// The first freedom of a body.
Index First(int body) { return Index{kAxes} * body; }

}  // namespace

// The elimination tree of bodies [Liu 1986], and what a change of a body's columns touches.
void BodyActiveBlock::FindPaths() {
  const int* starts = factor_.column_starts();
  const int* indices = factor_.row_indices();
  std::vector<std::vector<int>> before(At(bodies_));
  for (int k = 0; k < bodies_; ++k) {
    for (int p = starts[First(k)] + kAxes; p < starts[First(k) + 1]; p += kAxes) {
      before[At(indices[p] / kAxes)].push_back(k);
    }
  }
  std::vector<int> parent(At(bodies_), kNone);
  std::vector<int> ancestor(At(bodies_), kNone);
  for (int k = 0; k < bodies_; ++k) {
    for (int j : before[At(k)]) {
      while (j != kNone && j < k) {
        const int next = ancestor[At(j)];
        ancestor[At(j)] = k;
        if (next == kNone) parent[At(j)] = k;
        j = next;
      }
    }
  }
  path_.assign(At(bodies_), 0);
  const int* counts = factor_.column_counts();
  for (int k = bodies_ - 1; k >= 0; --k) {
    for (int a = 0; a < kAxes; ++a) path_[At(k)] += counts[First(k) + a];
    if (parent[At(k)] != kNone) path_[At(k)] += path_[At(parent[At(k)])];
  }
}

void BodyActiveBlock::Analyze(const LcpProblem& problem) {
  n_ = problem.size();
  graph_.Prepare(problem, {}, /*will_update=*/true, &factor_);
  bodies_ = graph_.bodies();
  rows_.assign(At(n_), {});
  for (Index i = 0; i < n_; ++i) {
    const BodyGraph::Ends& ends = graph_.ends()[At(i)];
    rows_[At(i)].first = ends.first;
    rows_[At(i)].second = ends.second;
    rows_[At(i)].below = ends.below;
  }
  if (graph_.analyses() > 0) {
    by_supernodes_ = factor_.is_supernodal();
    flop_time_ = by_supernodes_ ? kFlopBySupernodes : kFlopByColumns;
    FindPaths();
  }
  for (Eigen::VectorXd* v : {&diagonal_, &right_, &residual_, &x_, &step_}) v->setZero(n_);
  for (Eigen::VectorXd* v : {&body_, &image_}) v->setZero(freedoms());
  active_.assign(At(n_), 0);
  entering_.reserve(At(n_));
  leaving_.reserve(At(n_));
  valid_ = false;
}

double BodyActiveBlock::factor_time() const { return NewFactorTime() + kSolveEntry * factor_.fill(); }

double BodyActiveBlock::NewFactorTime() const {
  return flop_time_ * factor_.flops() + kFactorEntry * factor_.fill() + kRow * static_cast<double>(n_);
}

Index BodyActiveBlock::CountDependentRows() const {
  std::vector<char> touched(At(bodies_), 0);
  Index rows = 0;
  Index freedoms = 0;
  for (Index i = 0; i < n_; ++i) {
    if (active_[At(i)] == 0) continue;
    ++rows;
    for (const int body : {rows_[At(i)].first, rows_[At(i)].second}) {
      if (body == kNone || touched[At(body)] != 0) continue;
      touched[At(body)] = 1;
      freedoms += kAxes;
    }
  }
  return std::max<Index>(0, rows - freedoms);
}

void BodyActiveBlock::Load(const LcpProblem& problem, const Eigen::VectorXd& scale) {
  const SparseMatrix& J = problem.J();
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  for (Index i = 0; i < n_; ++i) {
    Row& row = rows_[At(i)];
    diagonal_[i] = (problem.DiagonalA()[i] * scale[i]) * scale[i];
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      if (it.value() == 0 || inverse_mass[it.col()] == 0) continue;
      const bool is_first = graph_.place(it.col()) == row.first;
      // Not the choice of arrays itself: with -fsanitize=undefined GCC 12 writes into a copy of it.
      double* entries = is_first ? row.first_j : row.second_j;
      entries[it.col() % kAxes] = it.value() * std::sqrt(inverse_mass[it.col()]) * scale[i];
    }
  }
  valid_ = false;
  factorisations_ = 0;
  updates_ = 0;
}

void BodyActiveBlock::FactorAnew() {
  double* values = factor_.values();
  const int* starts = factor_.column_starts();
  std::fill(values, values + starts[freedoms()], 0.0);
  for (Index j = 0; j < freedoms(); ++j) values[starts[j]] = 1;
  for (Index i = 0; i < n_; ++i) {
    const Row& row = rows_[At(i)];
    if (active_[At(i)] == 0 || row.first == kNone) continue;
    const double t = 1 / (shift_ * diagonal_[i]);
    for (int a = 0; a < kAxes; ++a) {
      double* column = values + starts[First(row.first) + a];
      const double scaled = t * row.first_j[a];
      for (int r = a; r < kAxes; ++r) column[r - a] += scaled * row.first_j[r];
      if (row.second == kNone) continue;
      double* block = column + (kAxes - a) + row.below;
      for (int r = 0; r < kAxes; ++r) block[r] += scaled * row.second_j[r];
    }
    if (row.second == kNone) continue;
    for (int a = 0; a < kAxes; ++a) {
      double* column = values + starts[First(row.second) + a];
      const double scaled = t * row.second_j[a];
      for (int r = a; r < kAxes; ++r) column[r - a] += scaled * row.second_j[r];
    }
  }
  ++factorisations_;
  updated_ = false;
  // Every pivot of K is at least 1 but for rounding.
  valid_ = factor_.Factorize();
  if (!valid_) throw std::runtime_error(factor_.why());
}

double BodyActiveBlock::UpdateTime() const {
  double time = updated_ || !by_supernodes_ ? 0.0 : kConvertEntry * factor_.fill();
  for (const std::vector<int>* rows : {&entering_, &leaving_}) {
    for (const int i : *rows) time += kUpdateRow + kUpdateEntry * path_[At(rows_[At(i)].first)];
  }
  return time;
}

// Rows enter before others leave, so that K stays well away from being indefinite.
bool BodyActiveBlock::Update() {
  ++updates_;
  updated_ = true;
  for (std::vector<int>* rows : {&entering_, &leaving_}) {
    if (rows->empty()) continue;
    // Rows with much of their way in common follow each other: CHOLMOD takes up to eight together.
    std::sort(rows->begin(), rows->end(),
              [&](int i, int j) { return std::pair(rows_[At(i)].first, i) < std::pair(rows_[At(j)].first, j); });
    CholmodFactor::ColumnMatrix columns(freedoms(), static_cast<int>(rows->size()));
    columns.reserve(Index{2} * kAxes * static_cast<Index>(rows->size()));
    int k = 0;
    for (const int i : *rows) {
      const Row& row = rows_[At(i)];
      const double root = 1 / std::sqrt(shift_ * diagonal_[i]);
      columns.startVec(k);
      for (int a = 0; a < kAxes; ++a) columns.insertBack(kAxes * row.first + a, k) = root * row.first_j[a];
      for (int a = 0; a < kAxes && row.second != kNone; ++a) {
        columns.insertBack(kAxes * row.second + a, k) = root * row.second_j[a];
      }
      ++k;
    }
    columns.finalize();
    if (!factor_.Update(columns, rows == &entering_)) return false;
  }
  return true;
}

bool BodyActiveBlock::Factor(const std::vector<char>& active, double shift, const Deadline* deadline) {
  const bool fresh = !valid_ || shift != shift_;
  entering_.clear();
  leaving_.clear();
  for (Index i = 0; i < n_; ++i) {
    if (active[At(i)] == active_[At(i)]) continue;
    active_[At(i)] = active[At(i)];
    if (rows_[At(i)].first != kNone) (active[At(i)] != 0 ? entering_ : leaving_).push_back(static_cast<int>(i));
  }
  shift_ = shift;
  if (!fresh && entering_.empty() && leaving_.empty()) return true;
  valid_ = false;
  if (deadline != nullptr && deadline->Expired()) return false;
  if (fresh || !may_update_ || UpdateTime() >= NewFactorTime() || !Update()) FactorAnew();
  valid_ = deadline == nullptr || !deadline->Expired();
  return valid_;
}

// step_ = what the factor makes of r, on F.
void BodyActiveBlock::SolveOnce(const Eigen::VectorXd& r) {
  body_.setZero();
  double* body = body_.data();
  for (Index i = 0; i < n_; ++i) {
    const Row& row = rows_[At(i)];
    if (active_[At(i)] == 0 || row.first == kNone) continue;
    const double value = r[i] / (shift_ * diagonal_[i]);
    for (int a = 0; a < kAxes; ++a) body[First(row.first) + a] += row.first_j[a] * value;
    if (row.second == kNone) continue;
    for (int a = 0; a < kAxes; ++a) body[First(row.second) + a] += row.second_j[a] * value;
  }
  factor_.Solve(body_, &body_);
  body = body_.data();
  for (Index i = 0; i < n_; ++i) {
    const Row& row = rows_[At(i)];
    if (active_[At(i)] == 0) {
      step_[i] = 0;
      continue;
    }
    double sum = 0;
    for (int a = 0; a < kAxes && row.first != kNone; ++a) sum += row.first_j[a] * body[First(row.first) + a];
    for (int a = 0; a < kAxes && row.second != kNone; ++a) sum += row.second_j[a] * body[First(row.second) + a];
    step_[i] = (r[i] - sum) / (shift_ * diagonal_[i]);
  }
}

// residual_ = right_ - K_FF x_ on F. Returns its largest entry as a part of the largest ones of right_ and x_.
double BodyActiveBlock::Residual() {
  Multiply(x_.data(), residual_.data());
  double largest = 0;
  double size = 0;
  for (Index i = 0; i < n_; ++i) {
    residual_[i] = active_[At(i)] != 0 ? right_[i] - residual_[i] - shift_ * diagonal_[i] * x_[i] : 0.0;
    largest = std::max(largest, std::abs(residual_[i]));
    size = std::max(size, std::max(std::abs(right_[i]), std::abs(x_[i])));
  }
  return size == 0 ? 0.0 : largest / size;
}

void BodyActiveBlock::Solve(double* x) {
  for (Index i = 0; i < n_; ++i) right_[i] = active_[At(i)] != 0 ? x[i] : 0.0;
  for (;;) {
    SolveOnce(right_);
    x_ = step_;
    double residual = Residual();
    for (int k = 0; k < kMaxRefinements && residual > kRounding; ++k) {
      SolveOnce(residual_);
      x_ += step_;
      const double before = residual;
      residual = Residual();
      if (residual < before) {
        if (residual > kSlow * before) break;
        continue;
      }
      x_ -= step_;
      residual = before;
      break;
    }
    if (residual <= kWornOut || !updated_) break;
    FactorAnew();
  }
  std::copy(x_.data(), x_.data() + n_, x);
}

void BodyActiveBlock::Multiply(const double* x, double* y) const {
  image_.setZero();
  double* image = image_.data();
  for (Index i = 0; i < n_; ++i) {
    const Row& row = rows_[At(i)];
    if (x[i] == 0 || row.first == kNone) continue;
    for (int a = 0; a < kAxes; ++a) image[First(row.first) + a] += row.first_j[a] * x[i];
    if (row.second == kNone) continue;
    for (int a = 0; a < kAxes; ++a) image[First(row.second) + a] += row.second_j[a] * x[i];
  }
  for (Index i = 0; i < n_; ++i) {
    const Row& row = rows_[At(i)];
    double sum = 0;
    for (int a = 0; a < kAxes && row.first != kNone; ++a) sum += row.first_j[a] * image[First(row.first) + a];
    for (int a = 0; a < kAxes && row.second != kNone; ++a) sum += row.second_j[a] * image[First(row.second) + a];
    y[i] = sum;
  }
}

}  // namespace lcpbench
