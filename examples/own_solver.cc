// A solver outside the tree, admitted to campaigns as a program of its own: projected Gauss-Seidel on the dense A.
//     lcpbench run --suite quick --external mine=build/examples/own_solver --solvers auto mine -o results
// RunWorker speaks the protocol (docs/protocol.md), and takes the times from the caller's arrays to f; the verifier
// judges the answers like all others. external_solver.py is such a program without our library.

#include <algorithm>
#include <memory>

#include "solvers/lcp/residual.h"
#include "solvers/peers/protocol/worker.h"

namespace {

class OwnSolver : public lcpbench::LcpSolver {
 public:
  std::string WhyUnsupported(const lcpbench::LcpProblem& problem) const override {
    return problem.DiagonalA().minCoeff() > 0 ? "" : "a diagonal entry of A is not positive";
  }

 protected:
  // What depends on A alone.
  void DoPrepare(const lcpbench::LcpProblem& problem) override { problem.DenseA(); }

  void DoSolve(const lcpbench::LcpProblem& problem, const lcpbench::LcpOptions& options,
               lcpbench::LcpResult* result) override {
    const Eigen::MatrixXd& A = problem.DenseA();
    const std::int64_t most = options.max_iterations > 0 ? options.max_iterations : 1000;
    const lcpbench::Deadline deadline(options);
    lcpbench::Residual<double> residual(problem);
    Eigen::VectorXd& f = result->f;
    if (options.initial_f != nullptr) f = *options.initial_f;
    result->status = lcpbench::LcpStatus::kIterationLimit;
    for (; result->iterations < most; ++result->iterations) {
      if (residual.Rho(f) <= options.tolerance) {
        result->status = lcpbench::LcpStatus::kSolved;
        return;
      }
      if (deadline.Expired()) {
        result->status = lcpbench::LcpStatus::kTimeLimit;
        return;
      }
      for (Eigen::Index i = 0; i < f.size(); ++i) {
        f[i] -= (A.row(i).dot(f) + problem.b()[i]) / A(i, i);
        if (!problem.is_bilateral(i)) f[i] = std::max(f[i], 0.0);
      }
    }
  }
};

}  // namespace

int main() {
  lcpbench::Hello hello;
  hello.name = "projected Gauss-Seidel";
  hello.library_version = "1.0";
  hello.licence = "Apache-2.0";
  return lcpbench::RunWorker(hello, [] { return std::make_unique<OwnSolver>(); });
}
