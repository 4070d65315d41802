#include "solvers/first_order/sweeps/scaled_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lcpbench {

void ScaledProblem::Reset(const LcpProblem& problem, std::vector<Index> new_order) {
  size = problem.size();
  order = std::move(new_order);
  const auto n = static_cast<size_t>(size);
  const Eigen::VectorXd& D = problem.DiagonalA();
  b.resize(n);
  unit.resize(n);
  inverse_root.resize(n);
  mixed = !problem.bilateral_rows().empty();
  for (size_t k = 0; k < n; ++k) {
    const Index row = Given(static_cast<Index>(k));
    mixed = mixed || D[row] == 0;
    inverse_root[k] = D[row] == 0 ? 1.0 : 1.0 / std::sqrt(D[row]);
  }
  floor.clear();
  gain.clear();
  if (!mixed) return;
  floor.assign(n, 0.0);
  gain.assign(n, 1.0);
  for (size_t k = 0; k < n; ++k) {
    const Index row = Given(static_cast<Index>(k));
    if (problem.is_bilateral(row)) floor[k] = -std::numeric_limits<double>::infinity();
    if (D[row] == 0) gain[k] = 0;
  }
}

void ScaledProblem::SetB(const LcpProblem& problem) {
  const auto n = static_cast<size_t>(size);
  long double b_squared = 0;  // its exponent range holds the square of every double
  for (size_t k = 0; k < n; ++k) {
    b[k] = problem.b()[Given(static_cast<Index>(k))] * inverse_root[k];
    b_squared += static_cast<long double>(b[k]) * b[k];
  }
  const long double norm = std::sqrt(b_squared);
  const double scale = norm > 0 ? std::ldexp(1.0, std::ilogb(norm)) : 1.0;
  b_norm = norm > 0 ? static_cast<double>(norm / scale) : 1.0;
  for (size_t k = 0; k < n; ++k) {
    b[k] /= scale;
    unit[k] = inverse_root[k] * scale;
  }
}

void ScaledProblem::Start(const Eigen::VectorXd* given, Array* f) const {
  const auto n = static_cast<size_t>(size);
  f->assign(n, 0.0);
  if (given == nullptr) return;
  for (size_t k = 0; k < n; ++k) {
    if (mixed && gain[k] == 0) continue;
    const double start = (*given)[Given(static_cast<Index>(k))] / unit[k];
    (*f)[k] = IsFree(static_cast<Index>(k)) ? start : std::max(start, 0.0);
  }
}

void ScaledProblem::ToGiven(const Array& f, Eigen::VectorXd* given) const {
  for (Index k = 0; k < size; ++k) {
    const auto at = static_cast<size_t>(k);
    (*given)[Given(k)] = f[at] * unit[at];
  }
}

}  // namespace lcpbench
