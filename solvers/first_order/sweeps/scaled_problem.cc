#include "solvers/first_order/sweeps/scaled_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lcpbench {

void ScaledProblem::Reset(const LcpProblem& problem, std::vector<Index> new_order) {
  size = problem.size();
  order = std::move(new_order);
  const Eigen::VectorXd& D = problem.DiagonalA();
  for (Array* array : {&b, &unit, &inverse_root}) array->resize(size);
  for (Index k = 0; k < size; ++k) inverse_root[k] = D[Given(k)] == 0 ? 1.0 : 1.0 / std::sqrt(D[Given(k)]);
  mixed = !problem.bilateral_rows().empty() || (D.array() == 0).any();
  if (!mixed) return;
  floor.resize(size);
  gain.resize(size);
  for (Index k = 0; k < size; ++k) {
    floor[k] = problem.is_bilateral(Given(k)) ? -std::numeric_limits<double>::infinity() : 0.0;
    gain[k] = D[Given(k)] == 0 ? 0.0 : 1.0;
  }
}

void ScaledProblem::SetB(const LcpProblem& problem) {
  long double b_squared = 0;  // its exponent range holds the square of every double
  for (Index k = 0; k < size; ++k) {
    b[k] = problem.b()[Given(k)] * inverse_root[k];
    b_squared += static_cast<long double>(b[k]) * b[k];
  }
  const long double norm = std::sqrt(b_squared);
  const double scale = norm > 0 ? std::ldexp(1.0, std::ilogb(norm)) : 1.0;
  b_norm = norm > 0 ? static_cast<double>(norm / scale) : 1.0;
  b /= scale;
  unit = inverse_root * scale;
}

void ScaledProblem::Start(const Eigen::VectorXd* given, Array* f) const {
  f->setZero(size);
  if (given == nullptr) return;
  for (Index k = 0; k < size; ++k) {
    if (mixed && gain[k] == 0) continue;
    const double start = (*given)[Given(k)] / unit[k];
    (*f)[k] = IsFree(k) ? start : std::max(start, 0.0);
  }
}

void ScaledProblem::ToGiven(const Array& f, Eigen::VectorXd* given) const {
  for (Index k = 0; k < size; ++k) (*given)[Given(k)] = f[k] * unit[k];
}

}  // namespace lcpbench
