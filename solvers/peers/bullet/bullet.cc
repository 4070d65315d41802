// Bullet: btSolveDantzigLCP, btLemkeAlgorithm and sequential impulses, double precision.
//
// Bullet keeps an error flag in a global variable and its containers in its own allocator; both are its alone.
// Lemke gives up after a number of loops of its own choosing unless told (default of the class: 100); it takes
// unilateral rows only.

#include <BulletDynamics/MLCPSolvers/btDantzigLCP.h>
#include <BulletDynamics/MLCPSolvers/btLemkeAlgorithm.h>
#include <LinearMath/btScalar.h>

#include <algorithm>
#include <string>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/bullet/sequential_impulses.h"
#include "solvers/peers/dantzig_peer.h"
#include "solvers/peers/linked_peers.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

int NoPadding(int rows) { return rows; }

bool CallDantzig(const DantzigProblem& p) {
  // Kept between calls, as the engine does.
  static btDantzigScratchMemory scratch;
  return btSolveDantzigLCP(p.rows, p.A, p.x, p.b, p.w, 0, p.lower, p.upper, p.findex, scratch);
}

/// w = M z + q, as ours. One pivot is O(n^2) on a tableau of n (2n + 2).
class Lemke : public LcpSolver {
 public:
  std::string WhyUnsupported(const LcpProblem& problem) const override {
    return problem.bilateral_rows().empty() ? "" : "takes unilateral rows only";
  }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    RequireDenseMatrices(problem.size(), 3);  // M and the tableau
    const auto n = static_cast<int>(problem.size());
    M_.resize(n, n);
    AssembleDenseA(problem, M_.getBufferPointerWritable(), n);
  }
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    // Enough for every sequence of pivots that is not a cycle in practice; the class's own 100 ends most early.
    constexpr std::int64_t kPivotsPerRow = 20;
    constexpr std::int64_t kFewestPivots = 1000;
    const std::int64_t usual = std::max<std::int64_t>(kFewestPivots, kPivotsPerRow * problem.size());
    const int most = IterationLimit(options, static_cast<double>(usual));
    q_.resize(static_cast<int>(problem.size()));
    std::copy(problem.b().begin(), problem.b().end(), q_.getBufferPointerWritable());
    btLemkeAlgorithm lemke(M_, q_);
    btVectorXu z;
    TimeLibraryCall(options, result, [&] { z = lemke.solve(static_cast<unsigned int>(most)); });
    const bool solved = lemke.getInfo() == 0;
    // (w, z, z0): our f is its z, the second part.
    const auto n = static_cast<int>(problem.size());
    if (z.size() >= 2 * n) {
      for (int i = 0; i < n; ++i) result->f[i] = z[n + i];
    }
    result->iterations = lemke.getSteps();
    result->status = solved ? LcpStatus::kSolved : LcpStatus::kNumericalFailure;
    if (!solved) result->detail = "the code returned failure";
  }

 private:
  btMatrixXu M_;
  btVectorXu q_;
};

std::unique_ptr<LcpSolver> Make(std::string_view key, SettingsReader* reader) {
  if (key == "bullet-lemke") return std::make_unique<Lemke>();
  if (key.starts_with("bullet-si")) return MakeSequentialImpulses(key, reader);
  return std::make_unique<DantzigPeer>(key, reader, DantzigPeer::Code{&NoPadding, &CallDantzig});
}

}  // namespace

PeerLibrary BulletLibrary() {
  // 324 is 3.24.
  constexpr int kHundred = 100;
  return {std::to_string(btGetVersion() / kHundred) + "." + std::to_string(btGetVersion() % kHundred), &Make};
}

}  // namespace lcpbench
