// COIN-OR Clp: a linear programming simplex code whose primal simplex was extended to convex quadratic objectives. The
// LCP of a symmetric positive semidefinite A is the optimality of min 1/2 f'A f + b'f over f_C >= 0, a problem with
// bounds and no rows. Its claims are passed on as they are; where it says "unbounded", its ray is passed on as the
// Farkas ray. Iterations are Clp's. docs/peers.md has the known limits of Clp 1.17.

#include <ClpConfig.h>

#include <ClpPrimalColumnDantzig.hpp>
#include <ClpPrimalColumnSteepest.hpp>
#include <ClpSimplex.hpp>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

class Clp : public LcpSolver {
 public:
  Clp(std::string_view key, SettingsReader* reader) : tier_(key, reader) {
    if (tier_.is_library_default()) return;
    pivot_ = Choose<int>(reader, "pivot",
                         {{"switching", 3},
                          {"exact-devex", 0},
                          {"steepest", 1},
                          {"partial-devex", 2},
                          {"partial-dantzig", 4},
                          {"dantzig", kDantzig}});
    perturbation_ = Choose<int>(reader, "perturbation", {{"late", 100}, {"yes", 50}, {"no", 102}});
  }

  std::string WhyUnsupported(const LcpProblem& problem) const override { return WhyNotQuadraticProgram(problem); }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    const auto n = static_cast<int>(problem.size());
    const double infinity = COIN_DBL_MAX;
    std::vector<double> lower(static_cast<std::size_t>(n), 0);
    const std::vector<double> upper(static_cast<std::size_t>(n), infinity);
    for (const Index row : problem.bilateral_rows()) lower[static_cast<std::size_t>(row)] = -infinity;
    const std::vector<CoinBigIndex> no_entries(static_cast<std::size_t>(n) + 1, 0);
    model_ = std::make_unique<ClpSimplex>();
    model_->setLogLevel(0);
    model_->loadProblem(n, 0, no_entries.data(), nullptr, nullptr, lower.data(), upper.data(), problem.b().data(),
                        nullptr, nullptr);
    // The triangle, Clp's copy of it, and that of the model that is solved.
    RequireSparseMatrices(n, static_cast<double>(problem.SparseA().nonZeros()), 2);
    // One triangle: an entry off the diagonal stands for both.
    const SparseMatrix A = problem.SparseA().triangularView<Eigen::Lower>();
    model_->loadQuadraticObjective(n, A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr());
    if (tier_.is_library_default()) return;
    if (pivot_ != kDantzig) {
      ClpPrimalColumnSteepest steepest(pivot_);
      model_->setPrimalColumnPivotAlgorithm(steepest);
    } else {
      ClpPrimalColumnDantzig dantzig;
      model_->setPrimalColumnPivotAlgorithm(dantzig);
    }
    model_->setPerturbation(perturbation_);
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    const Deadline deadline(options);
    std::unique_ptr<ClpSimplex> work;
    TimeConversion(options, result, [&] {
      // A model that has been solved is left as that solve ended it.
      if (model_ == nullptr) DoPrepare(problem);
      work = std::move(model_);
      for (int i = 0; i < work->numberColumns(); ++i) work->setObjectiveCoefficient(i, problem.b()[i]);
      if (!tier_.is_library_default()) {
        const double tolerance = tier_.Tolerance(options);
        work->setPrimalTolerance(tolerance);
        work->setDualTolerance(tolerance);
      }
      if (options.max_iterations > 0) work->setMaximumIterations(IterationLimit(options, 0));
      if (options.time_limit_s < std::numeric_limits<double>::infinity()) {
        work->setMaximumSeconds(deadline.Remaining());
      }
    });
    TimeLibraryCall(options, result, [&] { work->primal(); });
    const Eigen::Map<const Eigen::VectorXd> f(work->primalColumnSolution(), problem.size());
    result->f = f;
    result->iterations = work->numberIterations();
    Report(*work, deadline, result);
  }

 private:
  static void Report(const ClpSimplex& work, const Deadline& deadline, LcpResult* result) {
    enum { kOptimal, kPrimalInfeasible, kDualInfeasible, kStopped };  // as Clp numbers them
    switch (work.status()) {
      case kOptimal:
        result->status = LcpStatus::kSolved;
        return;
      case kDualInfeasible: {
        result->status = LcpStatus::kInfeasible;
        result->detail = "Clp: unbounded";
        const std::unique_ptr<double[]> ray(work.unboundedRay());
        if (ray) result->farkas_ray = Eigen::Map<const Eigen::VectorXd>(ray.get(), result->f.size());
        return;
      }
      case kStopped:
        result->status = deadline.Expired() ? LcpStatus::kTimeLimit : LcpStatus::kIterationLimit;
        return;
      default:
        result->status = LcpStatus::kNumericalFailure;
        result->detail =
            "Clp: status " + std::to_string(work.status()) + ", secondary " + std::to_string(work.secondaryStatus());
    }
  }

  static constexpr int kDantzig = -1;

  PeerTier tier_;
  int pivot_ = 0;  // a mode of ClpPrimalColumnSteepest, or kDantzig
  int perturbation_ = 0;
  std::unique_ptr<ClpSimplex> model_;
};

}  // namespace

PeerLibrary ThisPeerLibrary() { return {CLP_VERSION, &MakePeer<Clp>}; }

}  // namespace lcpbench
