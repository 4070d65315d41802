#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <algorithm>
#include <vector>

#include "solvers/lcp/problem.h"

/// Internal to solvers/.
namespace lcpbench::ipopt {

using Entry = Eigen::Triplet<double, int>;  ///< row, column, value; each position at most once

/// min 1/2 x.H x + c.x  subject to  G x = d,  x_j >= 0 where nonnegative[j].
/// H and G are constant, so that all derivatives are exact: the gradient is H x + c.
struct QuadraticProgram {
  Eigen::VectorXd c;              ///< one entry per variable
  Eigen::VectorXd d;              ///< one entry per constraint
  std::vector<bool> nonnegative;  ///< one entry per variable
  std::vector<Entry> hessian;     ///< lower triangle of H
  std::vector<Entry> jacobian;    ///< G

  double Objective(const double* x) const {
    double sum = 0;
    for (Index j = 0; j < c.size(); ++j) sum += c[j] * x[j];
    for (const Entry& h : hessian) sum += (h.row() == h.col() ? 0.5 : 1.0) * h.value() * x[h.row()] * x[h.col()];
    return sum;
  }
  /// gradient: one entry per variable
  void Gradient(const double* x, double* gradient) const {
    std::copy_n(c.data(), c.size(), gradient);
    for (const Entry& h : hessian) {
      gradient[h.row()] += h.value() * x[h.col()];
      if (h.row() != h.col()) gradient[h.col()] += h.value() * x[h.row()];
    }
  }
  /// values = G x: one entry per constraint
  void Constraints(const double* x, double* values) const {
    std::fill_n(values, d.size(), 0.0);
    for (const Entry& g : jacobian) values[g.row()] += g.value() * x[g.col()];
  }
};

}  // namespace lcpbench::ipopt
