// Simbody: its two impulse solvers, projected Gauss-Seidel (PGSImpulseSolver) and successive pruning
// (PLUSImpulseSolver), on A pi = verr with pi = -f and verr = b. Unilateral rows are contacts without friction,
// bilateral rows unconditional constraints. Dense: A is a copy, O(n^2) memory.
//
// Both start at zero, and stop by the norm of w on the rows that are enforced (Gauss-Seidel: its root mean square), in
// the unit of b; for keys that follow the tier b is scaled by a power of two to about 1. The host's time limit ends a
// solve. Iterations are sweeps, of pruning as the library counts.

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/loaded_blas.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/simbody/impulse_code.h"

namespace lcpbench {
namespace {

class Simbody : public LcpSolver {
 public:
  Simbody(std::string_view key, SettingsReader* reader)
      : tier_(key, reader), code_(MakeImpulseCode(key.starts_with("simbody-plus"))) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    const Index n = problem.size();
    RequireDenseMatrices(n, 3);  // ours, the library's, its factor
    A_.resize(static_cast<std::size_t>(n * n));
    AssembleDenseA(problem, A_.data(), n);
    const std::unique_ptr<bool[]> bilateral(new bool[static_cast<std::size_t>(n)]);  // NOLINT(modernize-avoid-c-arrays)
    for (Index row = 0; row < n; ++row) bilateral[static_cast<std::size_t>(row)] = problem.is_bilateral(row);
    code_->SetMatrix(static_cast<int>(n), A_.data(), bilateral.get());
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    double unit = 1;
    TimeConversion(options, result, [&] {
      ImpulseCode::Limits limits;
      limits.iterations = tier_.Iterations(options);
      if (!tier_.is_library_default()) {
        const double largest = problem.b().cwiseAbs().maxCoeff();
        if (largest > 0) unit = std::exp2(std::round(std::log2(largest)));
        limits.tolerance = tier_.Tolerance(options);
      }
      const Eigen::VectorXd b = problem.b() / unit;
      code_->Begin(b.data(), limits);
    });
    bool converged = false;
    SilenceLibrary();
    TimeLibraryCall(options, result, [&] { converged = code_->Solve(); });
    TimeConversion(options, result, [&] {
      for (Index row = 0; row < problem.size(); ++row) result->f[row] = code_->Force(static_cast<int>(row)) * unit;
    });
    result->iterations = code_->iterations();
    result->status = converged ? LcpStatus::kSolved : LcpStatus::kIterationLimit;
  }

 private:
  PeerTier tier_;
  std::unique_ptr<ImpulseCode> code_;
  std::vector<double> A_;
};

}  // namespace

PeerLibrary ThisPeerLibrary() {
  LimitLibraryThreads(1);
  return {SimbodyVersion(), &MakePeer<Simbody>};
}

}  // namespace lcpbench
