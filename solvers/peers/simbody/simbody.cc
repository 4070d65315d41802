// Simbody: its two impulse solvers, projected Gauss-Seidel (PGSImpulseSolver) and successive pruning
// (PLUSImpulseSolver), on A pi = verr with pi = -f and verr = b. Unilateral rows are contacts, bilateral rows
// unconditional constraints. Both codes want two friction rows of a contact, for a cone in space: a planar contact gets
// a second one, which acts on nothing but itself and has no load. Dense: A is a copy, O(n^2) memory.
//
// Both start at zero, and stop by the norm of w on the rows that are enforced (Gauss-Seidel: its root mean square), in
// the unit of b; for keys that follow the tier b is scaled by a power of two to about 1. The host's time limit ends a
// solve. Iterations are sweeps, of pruning as the library counts.

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "solvers/friction/relaxed_rows.h"
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

  bool TakesFriction() const override { return true; }
  std::string WhyUnsupported(const LcpProblem& problem) const override { return WhyNotPlanar(problem); }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    const std::vector<FrictionRow>& tangents = problem.friction_rows();
    const Index n = problem.size(), m = n + static_cast<Index>(tangents.size());
    RequireDenseMatrices(m, 3);  // ours, the library's, its factor
    A_.assign(static_cast<std::size_t>(m * m), 0);
    AssembleDenseA(problem, A_.data(), m);
    const auto diagonal = [&](Index row) -> double& { return A_[static_cast<std::size_t>(row * (m + 1))]; };
    std::vector<ImpulseCode::Contact> of_row(static_cast<std::size_t>(n));
    for (Index k = 0; k < m - n; ++k) {
      const FrictionRow& row = tangents[static_cast<std::size_t>(k)];
      diagonal(n + k) = diagonal(row.row) > 0 ? diagonal(row.row) : 1;
      of_row[static_cast<std::size_t>(row.normal)] = {0, static_cast<int>(row.row), static_cast<int>(n + k), row.mu};
    }
    std::vector<int> joints;
    std::vector<ImpulseCode::Contact> contacts;
    for (Index row = 0; row < n; ++row) {
      if (problem.is_bilateral(row)) joints.push_back(static_cast<int>(row));
      if (problem.kind(row) != RowKind::kUnilateral) continue;
      contacts.push_back(of_row[static_cast<std::size_t>(row)]);
      contacts.back().normal = static_cast<int>(row);
    }
    code_->SetMatrix(static_cast<int>(m), A_.data(), joints, contacts);
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
      Eigen::VectorXd b = Eigen::VectorXd::Zero(problem.size() + static_cast<Index>(problem.friction_rows().size()));
      b.head(problem.size()) = problem.b() / unit;
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
