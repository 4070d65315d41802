#include "tests/solvers/step/step_arrays.h"

#include <algorithm>
#include <random>

#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

std::size_t At(Index i) { return static_cast<std::size_t>(i); }

}  // namespace

StepArrays StepArrays::Of(const LcpProblem& problem) {
  StepArrays arrays;
  const int p = arrays.columns_per_body = problem.columns_per_body();
  const Eigen::VectorXd& m = problem.inverse_mass();
  arrays.inverse_mass.assign(m.begin(), m.end());
  for (Index i = 0; i < problem.size(); ++i) {
    std::int32_t body[2] = {-1, -1};
    std::vector<double> numbers(At(2 * p), 0);
    for (SparseMatrix::InnerIterator entry(problem.J(), i); entry; ++entry) {
      const auto of = static_cast<std::int32_t>(entry.col() / p);
      if (m.segment(of * p, p).maxCoeff() == 0) continue;
      const int side = body[0] < 0 || body[0] == of ? 0 : 1;
      body[side] = of;
      numbers[At(side * p + entry.col() % p)] = entry.value();
    }
    arrays.Add(body[0], body[1], numbers, problem.b()[i], problem.is_bilateral(i));
  }
  return arrays;
}

void StepArrays::Add(std::int32_t first, std::int32_t second, const std::vector<double>& numbers, double b_of_row,
                     bool is_bilateral) {
  body.insert(body.end(), {first, second});
  J.insert(J.end(), numbers.begin(), numbers.end());
  b.push_back(b_of_row);
  bilateral.push_back(is_bilateral ? 1 : 0);
}

void StepArrays::Round() {
  J_single.resize(J.size());
  std::transform(J.begin(), J.end(), J_single.begin(), [](double number) { return static_cast<float>(number); });
}

StepRows StepArrays::View(bool single) const {
  StepRows view;
  view.columns_per_body = columns_per_body;
  view.rows = rows();
  view.bodies = bodies();
  view.body = body.data();
  view.J = single ? nullptr : J.data();
  view.J_single = single ? J_single.data() : nullptr;
  view.b = b.data();
  const bool has_joints = std::any_of(bilateral.begin(), bilateral.end(), [](unsigned char is) { return is != 0; });
  view.bilateral = has_joints ? bilateral.data() : nullptr;
  view.inverse_mass = inverse_mass.data();
  return view;
}

LcpProblem StepArrays::Problem(bool single) const {
  const Index p = columns_per_body;
  Triplets entries;
  for (Index i = 0; i < rows(); ++i) {
    for (Index side = 0; side < 2; ++side) {
      const std::int32_t of = body[At(2 * i + side)];
      for (Index c = 0; c < p && of >= 0; ++c) {
        const std::size_t at = At((2 * i + side) * p + c);
        entries.emplace_back(static_cast<int>(i), static_cast<int>(of * p + c),
                             single ? static_cast<double>(J_single[at]) : J[at]);
      }
    }
  }
  MatrixFacts facts;
  facts.columns_per_body = columns_per_body;
  return LcpProblem::FromFactors("step", MatrixOf(rows(), p * bodies(), entries),
                                 Eigen::Map<const Eigen::VectorXd>(inverse_mass.data(), p * bodies()),
                                 Eigen::Map<const Eigen::VectorXd>(b.data(), rows()), {bilateral}, facts);
}

StepArrays RandomStep(Index n, Index bodies, int columns_per_body, unsigned seed) {
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
      numbers.push_back(is_copy ? sign * arrays.J[At(2 * p * of + c)] : Uniform(&random, -1, 1));
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
