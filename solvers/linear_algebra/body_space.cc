#include "solvers/linear_algebra/body_space.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace lcpbench {
namespace {

constexpr Index kAxes = BodySpace::kAxes;

// x_body += j value, and j.x_body.
void Add(const double* j, double value, double* x, int body) {
  for (Index a = 0; a < kAxes; ++a) x[kAxes * body + a] += j[a] * value;
}
double Dot(const double* j, const double* x, int body) {
  double sum = 0;
  for (Index a = 0; a < kAxes; ++a) sum += j[a] * x[kAxes * body + a];
  return sum;
}

}  // namespace

void BodySpace::Prepare(const LcpProblem& problem, const std::vector<char>& taking_part, bool will_update) {
  graph_.Prepare(problem, taking_part, will_update, &factor_);
  rows_.clear();
  for (const BodyGraph::Ends& ends : graph_.ends()) rows_.push_back({ends});
  for (Eigen::VectorXd* v : {&weight_, &product_}) v->setZero(rows());
  for (Eigen::VectorXd* v : {&body_, &image_}) v->setZero(kAxes * bodies());
}

void BodySpace::Load(const LcpProblem& problem, const Eigen::VectorXd& root) {
  const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
  for (Index i = 0; i < rows(); ++i) {
    Row& row = rows_[static_cast<size_t>(i)];
    if (row.first < 0) continue;
    for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
      if (it.value() == 0 || inverse_mass[it.col()] == 0) continue;
      const bool is_first = graph_.place(it.col()) == row.first;
      // Not the choice of arrays itself: with -fsanitize=undefined GCC 12 writes into a copy of it.
      double* entries = is_first ? row.first_j : row.second_j;
      entries[it.col() % kAxes] = it.value() * std::sqrt(inverse_mass[it.col()]) / root[i];
    }
  }
}

void BodySpace::ToBodies(const double* f, Eigen::VectorXd* x) const {
  x->setZero();
  for (const Row& row : rows_) {
    const double value = *f++;
    if (row.first < 0) continue;
    Add(row.first_j, value, x->data(), row.first);
    if (row.second >= 0) Add(row.second_j, value, x->data(), row.second);
  }
}

void BodySpace::ToRows(const Eigen::VectorXd& x, double* w) const {
  for (const Row& row : rows_) {
    double sum = 0;
    if (row.first >= 0) sum += Dot(row.first_j, x.data(), row.first);
    if (row.second >= 0) sum += Dot(row.second_j, x.data(), row.second);
    *w++ = sum;
  }
}

void BodySpace::Multiply(const double* f, double* y) const {
  ToBodies(f, &image_);
  ToRows(image_, y);
}

bool BodySpace::Factorize(const Eigen::VectorXd& theta) {
  double* values = factor_.values();
  const int* starts = factor_.column_starts();
  const Index columns = kAxes * bodies();
  std::fill(values, values + starts[columns], 0.0);
  for (Index j = 0; j < columns; ++j) values[starts[j]] = 1;
  // The lower triangle of the block of one body.
  const auto add_block = [&](int body, const double* j, double t) {
    for (Index a = 0; a < kAxes; ++a) {
      double* column = values + starts[kAxes * body + a];
      for (Index r = a; r < kAxes; ++r) column[r - a] += t * j[a] * j[r];
    }
  };
  for (Index i = 0; i < rows(); ++i) {
    const Row& row = rows_[static_cast<size_t>(i)];
    const double t = weight_[i] = row.first >= 0 && theta[i] < kOut ? 1 / theta[i] : 0.0;
    if (t == 0) continue;
    add_block(row.first, row.first_j, t);
    if (row.second < 0) continue;
    add_block(row.second, row.second_j, t);
    for (Index a = 0; a < kAxes; ++a) {
      double* block = values + starts[kAxes * row.first + a] + (kAxes - a) + row.below;
      for (Index r = 0; r < kAxes; ++r) block[r] += t * row.first_j[a] * row.second_j[r];
    }
  }
  return factor_.Factorize();
}

bool BodySpace::Update(std::vector<int>* rows, const Eigen::VectorXd& theta, bool join) {
  if (rows->empty()) return true;
  // Rows with much of their way in common follow each other: CHOLMOD takes up to eight together.
  std::sort(rows->begin(), rows->end(),
            [&](int i, int j) { return std::pair(row(i).first, i) < std::pair(row(j).first, j); });
  CholmodFactor::ColumnMatrix columns(kAxes * bodies(), static_cast<int>(rows->size()));
  columns.reserve(Index{2} * kAxes * static_cast<Index>(rows->size()));
  int k = 0;
  for (const int i : *rows) {
    const double t = join ? 1 / theta[i] : weight_[i];
    weight_[i] = join ? t : 0.0;
    const double root = std::sqrt(t);
    columns.startVec(k);
    for (Index a = 0; a < kAxes; ++a) columns.insertBack(kAxes * row(i).first + a, k) = root * row(i).first_j[a];
    for (Index a = 0; a < kAxes && row(i).second >= 0; ++a) {
      columns.insertBack(kAxes * row(i).second + a, k) = root * row(i).second_j[a];
    }
    ++k;
  }
  columns.finalize();
  return factor_.Update(columns, join);
}

void BodySpace::Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x) {
  product_ = weight_.cwiseProduct(r);
  ToBodies(product_.data(), &body_);
  factor_.Solve(body_, &body_);
  ToRows(body_, product_.data());
  *x = weight_.cwiseProduct(r - product_);
}

}  // namespace lcpbench
