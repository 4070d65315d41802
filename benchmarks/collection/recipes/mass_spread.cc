#include "benchmarks/collection/recipes/mass_spread.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "benchmarks/collection/recipes/portable_power.h"
#include "model/scenes/random.h"
#include "support/input_error.h"

namespace lcpbench {

LcpProblem SpreadMasses(const LcpProblem& given, double ratio, std::uint64_t seed) {
  if (!(ratio >= 1 && std::isfinite(ratio))) {
    throw InputError("mass ratio must be at least 1 and finite, found " + std::to_string(ratio));
  }
  constexpr Index kPerBody = 3;
  Eigen::VectorXd inverse_mass = given.inverse_mass();
  std::vector<Index> movable;
  for (Index body = 0; body < inverse_mass.size() / kPerBody; ++body) {
    if (inverse_mass.segment(kPerBody * body, kPerBody).maxCoeff() > 0) movable.push_back(body);
  }
  Random random(seed);
  std::vector<double> u(movable.size());
  for (double& value : u) value = random.Uniform();
  if (u.size() > 1) {
    const auto [least, most] = std::minmax_element(u.begin(), u.end());
    const double from = *least;
    const double range = *most - *least;
    for (double& value : u) value = (value - from) / range;
  }
  for (std::size_t k = 0; k < movable.size(); ++k) {
    inverse_mass.segment(kPerBody * movable[k], kPerBody) /= PortablePower(ratio, u[k]);
  }
  // What was proved of the rank and of unique forces depends on which masses are zero only.
  return LcpProblem::FromFactors(given.id() + "-spread", given.J(), inverse_mass, given.b(),
                                 RowBounds::WithBilateralRows(given.size(), given.bilateral_rows()), given.facts());
}

}  // namespace lcpbench
