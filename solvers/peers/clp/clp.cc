// COIN-OR Clp: a linear programming simplex code whose primal simplex was extended to convex quadratic objectives. The
// LCP of a symmetric positive semidefinite A is the optimality of min 1/2 f'A f + b'f over f_C >= 0, a problem with
// bounds and no rows.
//
// Known limits, of Clp 1.17: the extension is a reduced-gradient method that its authors meant for few nonlinear
// columns. It stops by absolute tolerances, in the units of f and b, so that badly scaled rows end it early. An
// unbounded objective (an LCP without solution) it seldom notices: it then claims "optimal" at forces of 1e16 and more,
// or never returns, without reading its own time limit; the host's ends it. Below about 1e-12 an assertion of the
// library fails. Its claims are passed on as they are; where it says "unbounded", its ray is passed on as the Farkas
// ray. Iterations are Clp's.
//
// Settings of `clp` other than `tolerance`, the first is the library's own. pivot: switching, exact-devex, steepest,
// partial-devex, partial-dantzig (modes 3, 0, 1, 2, 4 of ClpPrimalColumnSteepest), dantzig; perturbation: late (100),
// yes (50), no (102). Presolve and scaling work on constraints, of which this problem has none.

#include <ClpConfig.h>

#include <ClpPrimalColumnDantzig.hpp>
#include <ClpPrimalColumnSteepest.hpp>
#include <ClpSimplex.hpp>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

class Clp : public LcpSolver {
 public:
  static constexpr int kSwitching = 3;
  static constexpr int kDantzig = -1;
  struct Options {
    bool as_the_library_has_it = false;
    PeerTolerance tolerance;
    int pivot = kSwitching;  // a mode of ClpPrimalColumnSteepest, or kDantzig
    int perturbation = 100;
  };

  explicit Clp(Options options) : options_(std::move(options)) {}

  std::string WhyUnsupported(const LcpProblem& problem) const override {
    return problem.IsNumericallySymmetric() ? "" : "A is not symmetric, so the LCP is not the optimality of a QP";
  }

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
    // One triangle: an entry off the diagonal stands for both.
    std::vector<CoinBigIndex> start{0};
    std::vector<int> column;
    std::vector<double> value;
    const SparseMatrix& A = problem.SparseA();
    for (int i = 0; i < n; ++i) {
      for (SparseMatrix::InnerIterator entry(A, i); entry; ++entry) {
        if (entry.col() > i) break;
        column.push_back(static_cast<int>(entry.col()));
        value.push_back(entry.value());
      }
      start.push_back(static_cast<CoinBigIndex>(column.size()));
    }
    model_->loadQuadraticObjective(n, start.data(), column.data(), value.data());
    if (options_.as_the_library_has_it) return;
    if (options_.pivot != kDantzig) {
      ClpPrimalColumnSteepest steepest(options_.pivot);
      model_->setPrimalColumnPivotAlgorithm(steepest);
    } else {
      ClpPrimalColumnDantzig dantzig;
      model_->setPrimalColumnPivotAlgorithm(dantzig);
    }
    model_->setPerturbation(options_.perturbation);
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    const Deadline deadline(options);
    std::unique_ptr<ClpSimplex> work;
    TimeConversion(options, result, [&] {
      // A model that has been solved is left as that solve ended it.
      if (model_ == nullptr) DoPrepare(problem);
      work = std::move(model_);
      for (int i = 0; i < work->numberColumns(); ++i) work->setObjectiveCoefficient(i, problem.b()[i]);
      if (!options_.as_the_library_has_it) {
        const double tolerance = options_.tolerance.For(options);
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

  Options options_;
  std::unique_ptr<ClpSimplex> model_;
};

std::unique_ptr<LcpSolver> Make(std::string_view key, const Settings& settings) {
  SettingsReader reader(key, settings);
  Clp::Options options;
  options.as_the_library_has_it = key == "clp-default";
  if (!options.as_the_library_has_it) {
    options.tolerance = PeerTolerance(key, &reader);
    options.pivot = Choose<int>(&reader, "pivot",
                                {{"switching", Clp::kSwitching},
                                 {"exact-devex", 0},
                                 {"steepest", 1},
                                 {"partial-devex", 2},
                                 {"partial-dantzig", 4},
                                 {"dantzig", Clp::kDantzig}});
    options.perturbation = Choose<int>(&reader, "perturbation", {{"late", 100}, {"yes", 50}, {"no", 102}});
  }
  reader.Finish();
  return std::make_unique<Clp>(options);
}

}  // namespace

PeerLibrary ThisPeerLibrary() { return {CLP_VERSION, &Make}; }

}  // namespace lcpbench
