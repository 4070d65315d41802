#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <functional>
#include <memory>
#include <string_view>
#include <vector>

#include "solvers/lcp/problem.h"

/// Ipopt behind a plain interface. Internal to solvers/: no Ipopt header is seen from here, and none is installed.
namespace lcpbench::ipopt {

/// Coordinates of a sparse matrix, each position at most once.
struct Entries {
  std::vector<int> row;
  std::vector<int> column;
  std::vector<double> value;

  void Add(Index i, Index j, double x) {
    row.push_back(static_cast<int>(i));
    column.push_back(static_cast<int>(j));
    value.push_back(x);
  }
  size_t size() const { return value.size(); }
};

/// min 1/2 x.H x + c.x  subject to  G x = d,  x_j >= 0 where nonnegative[j].
/// H and G are constant, so that all derivatives are exact: the gradient is H x + c.
struct QuadraticProgram {
  Eigen::VectorXd c;              ///< one entry per variable
  Eigen::VectorXd d;              ///< one entry per constraint
  std::vector<bool> nonnegative;  ///< one entry per variable
  Entries hessian;                ///< lower triangle of H
  Entries jacobian;               ///< G

  double Objective(const double* x) const {
    double sum = 0;
    for (Index j = 0; j < c.size(); ++j) sum += c[j] * x[j];
    for (size_t k = 0; k < hessian.size(); ++k) {
      const int i = hessian.row[k];
      const int j = hessian.column[k];
      sum += (i == j ? 0.5 : 1.0) * hessian.value[k] * x[i] * x[j];
    }
    return sum;
  }
  /// gradient: one entry per variable
  void Gradient(const double* x, double* gradient) const {
    std::copy_n(c.data(), c.size(), gradient);
    for (size_t k = 0; k < hessian.size(); ++k) {
      const int i = hessian.row[k];
      const int j = hessian.column[k];
      gradient[i] += hessian.value[k] * x[j];
      if (i != j) gradient[j] += hessian.value[k] * x[i];
    }
  }
  /// values = G x: one entry per constraint
  void Constraints(const double* x, double* values) const {
    std::fill_n(values, d.size(), 0.0);
    for (size_t k = 0; k < jacobian.size(); ++k) values[jacobian.row[k]] += jacobian.value[k] * x[jacobian.column[k]];
  }
};

/// A starting point. Multipliers have Ipopt's signs: H x + c + G^T y - z = 0.
struct Start {
  Eigen::VectorXd x;
  Eigen::VectorXd z;  ///< of the bounds x >= 0, one per variable
  Eigen::VectorXd y;  ///< of the constraints

  static Start Zero(const QuadraticProgram& program) {
    const Index n = program.c.size();
    return {Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(program.d.size())};
  }
};

/// Called with every iterate, which is empty in the restoration phase, where it belongs to another program. True stops
/// Ipopt. Must not use an engine.
using OnIterate = std::function<bool(const Eigen::VectorXd&)>;

/// Ipopt made ready for one program: silent, without an options file; ipopt_engine.cc has every option and its reason.
///
/// The objects of the algorithm are built once, by a run of no iterations, and serve every Optimize after it; nothing
/// else carries over. MUMPS, Ipopt's linear solver here, keeps state in the modules of its process and is not
/// thread-safe: distinct engines may be used from distinct threads, but take turns, a whole Optimize at a time (the
/// wait counts as time of the solve).
class Engine {
 public:
  struct Ending {
    std::string_view status;  ///< Ipopt's own name
    bool iteration_limit = false;
    bool converged = false;  ///< by Ipopt's own tests
    std::int64_t iterations = 0;
  };

  /// @param program  not owned
  /// @throws std::runtime_error where Ipopt does not know one of the options
  explicit Engine(const QuadraticProgram& program);
  ~Engine();

  static constexpr double kNever = 1e-40;  ///< a tolerance that Ipopt does not reach, so that on_iterate stops it

  /// @param tolerance  Ipopt's `tol`
  /// @param warm  `start` is used as it is; else Ipopt moves x off its bounds and sets all multipliers
  Ending Optimize(const Start& start, bool warm, std::int64_t max_iterations, double tolerance,
                  const OnIterate& on_iterate);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace lcpbench::ipopt
