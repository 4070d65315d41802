#include "benchmarks/studies/step_arrays.h"

#include <algorithm>

#include "support/array_index.h"

namespace lcpbench {

StepArrays StepArrays::Of(const LcpProblem& problem) {
  StepArrays arrays;
  const Index p = arrays.columns_per_body = problem.columns_per_body();
  const Eigen::VectorXd& m = problem.inverse_mass();
  arrays.inverse_mass.assign(m.begin(), m.end());
  arrays.friction = problem.friction_rows();
  arrays.bounded = problem.bounded_rows();
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

void StepArrays::Append(const StepArrays& others) {
  const auto first = static_cast<std::int32_t>(bodies());
  const Index rows_before = rows();
  for (FrictionRow row : others.friction) {
    row.row += rows_before;
    row.normal += rows_before;
    friction.push_back(row);
  }
  for (BoundedRow row : others.bounded) {
    row.row += rows_before;
    bounded.push_back(row);
  }
  for (const std::int32_t of : others.body) body.push_back(of < 0 ? -1 : first + of);
  J.insert(J.end(), others.J.begin(), others.J.end());
  b.insert(b.end(), others.b.begin(), others.b.end());
  bilateral.insert(bilateral.end(), others.bilateral.begin(), others.bilateral.end());
  inverse_mass.insert(inverse_mass.end(), others.inverse_mass.begin(), others.inverse_mass.end());
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
  view.friction = friction;
  view.bounded = bounded;
  return view;
}

LcpProblem StepArrays::Problem(bool single) const { return ProblemOf(View(single)); }

}  // namespace lcpbench
