#include "solvers/linear_algebra/body_space.h"

#include <algorithm>
#include <cmath>

namespace lcpbench {
namespace {

constexpr int kAxes = 3;

// The first column of a body.
Index At(int body) { return Index{kAxes} * body; }

}  // namespace

void BodySpace::Prepare(const LcpProblem& problem, const Eigen::VectorXd& root, const std::vector<char>& taking_part) {
  graph_.Prepare(problem, taking_part, /*will_update=*/false, &factor_);
  bodies_ = graph_.bodies();
  const SparseMatrix& J = problem.J();
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  rows_.assign(static_cast<size_t>(problem.size()), {});
  for (Index i = 0; i < problem.size(); ++i) {
    const BodyGraph::Ends& ends = graph_.ends()[static_cast<size_t>(i)];
    if (ends.first < 0) continue;
    Row& row = rows_[static_cast<size_t>(i)];
    row.first = ends.first;
    row.second = ends.second;
    row.below = ends.below;
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      if (it.value() == 0 || inverse_mass[it.col()] == 0) continue;
      const bool is_first = graph_.place(it.col()) == row.first;
      // Not the choice of arrays itself: with -fsanitize=undefined GCC 12 writes into a copy of it.
      double* entries = is_first ? row.first_j : row.second_j;
      entries[it.col() % kAxes] = it.value() * std::sqrt(inverse_mass[it.col()]) / root[i];
    }
  }
  weight_.setZero(rows());
  product_.setZero(rows());
  body_.setZero(At(bodies_));
  image_.setZero(At(bodies_));
}

void BodySpace::ToBodies(const Eigen::VectorXd& f, Eigen::VectorXd* x) const {
  x->setZero(At(bodies_));
  double* out = x->data();
  const double* force = f.data();
  for (const Row& row : rows_) {
    const double value = *force++;
    if (row.first < 0) continue;
    double* first = out + At(row.first);
    for (int a = 0; a < kAxes; ++a) first[a] += row.first_j[a] * value;
    if (row.second < 0) continue;
    double* second = out + At(row.second);
    for (int a = 0; a < kAxes; ++a) second[a] += row.second_j[a] * value;
  }
}

void BodySpace::ToRows(const Eigen::VectorXd& x, Eigen::VectorXd* w) const {
  w->resize(rows());
  const double* in = x.data();
  double* out = w->data();
  for (const Row& row : rows_) {
    double sum = 0;
    if (row.first >= 0) {
      const double* first = in + At(row.first);
      for (int a = 0; a < kAxes; ++a) sum += row.first_j[a] * first[a];
    }
    if (row.second >= 0) {
      const double* second = in + At(row.second);
      for (int a = 0; a < kAxes; ++a) sum += row.second_j[a] * second[a];
    }
    *out++ = sum;
  }
}

void BodySpace::Multiply(const Eigen::VectorXd& f, Eigen::VectorXd* y) const {
  ToBodies(f, &image_);
  ToRows(image_, y);
}

bool BodySpace::Factorize(const Eigen::VectorXd& theta) {
  double* values = factor_.values();
  const int* starts = factor_.column_starts();
  std::fill(values, values + starts[At(bodies_)], 0.0);
  for (int j = 0; j < kAxes * bodies_; ++j) values[starts[j]] = 1;
  Index i = 0;
  for (const Row& row : rows_) {
    const double t = row.first >= 0 && theta[i] < kOut ? 1 / theta[i] : 0.0;
    weight_[i++] = t;
    if (t == 0) continue;
    const int p = row.first;
    for (int a = 0; a < kAxes; ++a) {
      double* column = values + starts[kAxes * p + a];
      const double scaled = t * row.first_j[a];
      for (int r = a; r < kAxes; ++r) column[r - a] += scaled * row.first_j[r];
      if (row.second < 0) continue;
      double* block = column + (kAxes - a) + row.below;
      for (int r = 0; r < kAxes; ++r) block[r] += scaled * row.second_j[r];
    }
    if (row.second < 0) continue;
    const int q = row.second;
    for (int a = 0; a < kAxes; ++a) {
      double* column = values + starts[kAxes * q + a];
      const double scaled = t * row.second_j[a];
      for (int r = a; r < kAxes; ++r) column[r - a] += scaled * row.second_j[r];
    }
  }
  return factor_.Factorize();
}

void BodySpace::Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x) {
  product_ = weight_.cwiseProduct(r);
  ToBodies(product_, &body_);
  factor_.Solve(body_, &body_);
  ToRows(body_, &product_);
  *x = weight_.cwiseProduct(r - product_);
}

}  // namespace lcpbench
