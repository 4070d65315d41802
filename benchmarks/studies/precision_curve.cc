#include "benchmarks/studies/precision_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "benchmarks/measure/quantile.h"
#include "solvers/lcp/verify.h"
#include "solvers/rows/two_body_copy.h"
#include "solvers/step/step_solver.h"
#include "support/clock.h"

namespace lcpbench {
namespace {

constexpr int kSweeps[] = {1, 3, 10, 30, 100, 300, 1000, 3000, 10000};
constexpr int kTimedSolves = 21;

double RhoOf(const LcpProblem& problem, const Eigen::VectorXd& f) {
  const double rho = ComputeMetrics(problem, f).rho;
  return std::isnan(rho) ? std::numeric_limits<double>::infinity() : rho;
}

/// One problem in the precision of `Real`, and its forces and velocities.
template <typename Real>
class GaussSeidel {
 public:
  explicit GaussSeidel(const StepRows& rows)
      : rows_(rows),
        width_(rows.columns_per_body),
        J_(rows.J, rows.J + 2 * width_ * rows.rows),
        inverse_mass_(rows.inverse_mass, rows.inverse_mass + width_ * rows.bodies),
        b_(rows.b, rows.b + rows.rows),
        f_(static_cast<std::size_t>(rows.rows), 0),
        step_(f_.size()),
        velocity_(inverse_mass_.size(), 0) {
    for (Index i = 0; i < rows_.rows; ++i) {
      Real diagonal = 0;
      Visit(i,
            [&](std::size_t entry, std::size_t column) { diagonal += J_[entry] * J_[entry] * inverse_mass_[column]; });
      step_[static_cast<std::size_t>(i)] = diagonal > 0 ? 1 / diagonal : 0;
    }
  }

  void Sweep() {
    for (Index i = 0; i < rows_.rows; ++i) {
      const auto row = static_cast<std::size_t>(i);
      Real w = b_[row];
      Visit(i, [&](std::size_t entry, std::size_t column) { w += J_[entry] * velocity_[column]; });
      const bool is_free = rows_.bilateral != nullptr && rows_.bilateral[i] != 0;
      const Real wanted = f_[row] - w * step_[row];
      const Real next = is_free ? wanted : std::max<Real>(wanted, 0);
      const Real change = next - f_[row];
      f_[row] = next;
      Visit(i, [&](std::size_t entry, std::size_t column) {
        velocity_[column] += inverse_mass_[column] * J_[entry] * change;
      });
    }
  }

  Eigen::VectorXd Forces() const {
    return Eigen::Map<const Eigen::Array<Real, Eigen::Dynamic, 1>>(f_.data(), rows_.rows).template cast<double>();
  }

 private:
  // act(place in J, column of J) for each number of a row.
  template <typename Act>
  void Visit(Index row, const Act& act) const {
    for (Index side = 0; side < 2; ++side) {
      const Index body = rows_.body[2 * row + side];
      if (body < 0) continue;
      for (Index k = 0; k < width_; ++k) {
        act(static_cast<std::size_t>((2 * row + side) * width_ + k), static_cast<std::size_t>(body * width_ + k));
      }
    }
  }

  const StepRows& rows_;
  Index width_;
  std::vector<Real> J_, inverse_mass_, b_, f_, step_, velocity_;
};

template <typename Real>
void Sweep(const LcpProblem& problem, const StepRows& rows, bool is_single, std::vector<PrecisionPoint>* points) {
  GaussSeidel<Real> solver(rows);
  double seconds = 0;
  int done = 0;
  for (const int sweeps : kSweeps) {
    const double start = SteadyNow();
    for (; done < sweeps; ++done) solver.Sweep();
    seconds += SteadyNow() - start;
    points->push_back({"gauss-seidel", is_single, sweeps, RhoOf(problem, solver.Forces()), seconds});
  }
}

void Step(const LcpProblem& problem, const StepRows& rows, bool is_single, std::vector<PrecisionPoint>* points) {
  StepSolver solver;
  Eigen::VectorXd f(rows.rows);
  std::vector<double> seconds;
  for (int call = -1; call < kTimedSolves; ++call) {
    const double start = SteadyNow();
    solver.Solve(rows, nullptr, f.data());
    if (call >= 0) seconds.push_back(SteadyNow() - start);
  }
  points->push_back({"tableau", is_single, 0, RhoOf(problem, f), MedianOf(seconds)});
}

}  // namespace

std::vector<PrecisionPoint> ComparePrecisions(const LcpProblem& problem) {
  std::vector<PrecisionPoint> points;
  const ProblemArrays arrays = ProblemArrays::Of(problem);  // the copy points to them
  TwoBodyCopy copy;
  if (!problem.has_factors() || !copy.Take(arrays)) return points;
  const StepRows rows = copy.rows();
  Sweep<double>(problem, rows, false, &points);
  Sweep<float>(problem, rows, true, &points);
  Step(problem, rows, false, &points);
  const std::vector<float> J(rows.J, rows.J + Index{2} * rows.columns_per_body * rows.rows);
  StepRows single = rows;
  single.J = nullptr;
  single.J_single = J.data();
  Step(problem, single, true, &points);
  return points;
}

}  // namespace lcpbench
