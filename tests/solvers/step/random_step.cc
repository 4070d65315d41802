#include "tests/solvers/step/random_step.h"

#include <random>
#include <vector>

#include "support/array_index.h"
#include "tests/solvers/test_problems.h"

namespace lcpbench {

StepArrays RandomStep(Index n, Index bodies, int columns_per_body, unsigned seed, bool is_exact_in_single) {
  std::mt19937_64 random(seed);
  StepArrays arrays;
  const int p = arrays.columns_per_body = columns_per_body;
  for (Index k = 0; k < bodies; ++k) {
    const double mass = k == 0 ? 0 : Uniform(&random, 0.1, 10);  // the first one cannot move
    for (int c = 0; c < p; ++c) arrays.inverse_mass.push_back(mass * (c < p / 2 + 1 ? 1 : Uniform(&random, 1, 5)));
  }
  const auto chance = [&](double part) { return Uniform(&random, 0, 1) < part; };
  const auto pick = [&] {
    return static_cast<std::int32_t>(Uniform(&random, 0, 1) * static_cast<double>(bodies + 1)) - 1;
  };
  Eigen::VectorXd f(n);
  Eigen::VectorXd w(n);
  for (Index i = 0; i < n; ++i) {
    const bool is_copy = i > 0 && chance(0.15);
    const auto of = is_copy ? static_cast<Index>(Uniform(&random, 0, static_cast<double>(i))) : 0;
    std::vector<double> numbers;
    const double sign = chance(0.5) ? 1 : -1;
    for (Index c = 0; c < 2 * p; ++c) {
      const double number = is_copy ? sign * arrays.J[At(2 * p * of + c)] : Uniform(&random, -1, 1);
      numbers.push_back(is_exact_in_single ? static_cast<double>(static_cast<float>(number)) : number);
    }
    const std::int32_t first = is_copy ? arrays.body[At(2 * of)] : pick();
    const std::int32_t second = is_copy ? arrays.body[At(2 * of + 1)] : chance(0.05) ? first : pick();
    const bool is_joint = chance(0.1);
    const double load = Uniform(&random, -1, 1);
    f[i] = is_joint || load > 0 ? load : 0;
    w[i] = is_joint || load > 0 ? 0 : chance(0.2) ? 0 : -load;
    arrays.Add(first, second, numbers, 0, is_joint);
  }
  Eigen::VectorXd moved;
  arrays.Problem().ComputeW(f, &moved);
  for (Index i = 0; i < n; ++i) arrays.b[At(i)] = w[i] - moved[i];
  return arrays;
}

}  // namespace lcpbench
