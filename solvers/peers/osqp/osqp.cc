// OSQP: operator splitting (ADMM) on one factored matrix. It stops where the primal and dual residual are below
// eps_abs + eps_rel times the size of what they are made of, and the duality gap likewise; eps_rel is set to eps_abs.
// Iterations are those of ADMM. Bounds are rows, for it knows no others.

#include <osqp/osqp.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "solvers/peers/qp/quadratic_program.h"

namespace lcpbench {
namespace {

struct Cleanup {
  void operator()(OSQPSolver* solver) const { osqp_cleanup(solver); }
};

using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, OSQPInt>;

OSQPCscMatrix View(Matrix& matrix) {
  OSQPCscMatrix csc{};
  OSQPCscMatrix_set_data(&csc, matrix.rows(), matrix.cols(), matrix.nonZeros(), matrix.valuePtr(),
                         matrix.innerIndexPtr(), matrix.outerIndexPtr());
  return csc;
}

class Osqp : public QpPeer {
 public:
  Osqp(std::string_view key, SettingsReader* reader) : QpPeer(key, reader) {
    set_layout({.dense = false, .bounds_are_rows = true});
    if (tier().is_library_default()) return;
    polishing_ = reader->YesOrNo("polishing", false);
    rho_ = Choose<double>(reader, "rho", {{"0.1", 0.1}, {"1", 1}, {"10", 10}, {"1e-2", 1e-2}, {"1e-3", 1e-3}});
    scaling_ = Choose<int>(reader, "scaling", {{"10", 10}, {"0", 0}, {"30", 30}});
    interval_ = Choose<int>(reader, "adaptive_rho_interval", {{"50", 50}, {"25", 25}, {"100", 100}, {"0", 0}});
  }

 protected:
  void Run(QuadraticProgram& qp, QpStart* start, const LcpOptions& options, const Deadline& deadline,
           LcpResult* result) override {
    OSQPSettings settings;
    osqp_set_default_settings(&settings);
    settings.verbose = 0;
    settings.max_iter = tier().Iterations(options, static_cast<double>(settings.max_iter));
    if (!tier().is_library_default()) {
      settings.eps_abs = settings.eps_rel = tier().Tolerance(options);
      settings.polishing = polishing_ ? 1 : 0;
      settings.rho = rho_;
      settings.scaling = scaling_;
      settings.adaptive_rho = interval_ > 0 ? OSQP_ADAPTIVE_RHO_UPDATE_ITERATIONS : OSQP_ADAPTIVE_RHO_UPDATE_DISABLED;
      if (interval_ > 0) settings.adaptive_rho_interval = interval_;
    }
    Matrix P, A;
    OSQPCscMatrix P_view{}, A_view{};
    TimeConversion(options, result, [&] {
      P = Eigen::SparseMatrix<double>(qp.H.triangularView<Eigen::Upper>());
      A = qp.C;
      P_view = View(P);
      A_view = View(A);
      qp.lower = qp.lower.cwiseMax(-OSQP_INFTY);
      qp.upper = qp.upper.cwiseMin(OSQP_INFTY);
    });
    if (options.time_limit_s < std::numeric_limits<double>::infinity()) {
      settings.time_limit = std::max(kLeastTime, deadline.Remaining());
    }
    if (polishing_) SilenceLibrary();  // it tells what came of each polishing
    std::unique_ptr<OSQPSolver, Cleanup> solver;
    OSQPInt error = 0;
    TimeLibraryCall(options, result, [&] {
      OSQPSolver* made = nullptr;
      error = osqp_setup(&made, &P_view, qp.g.data(), &A_view, qp.lower.data(), qp.upper.data(), qp.rows(),
                         qp.variables(), &settings);
      solver.reset(made);
      if (error != 0) return;
      if (start != nullptr) {
        const Eigen::VectorXd y = -start->y;
        osqp_warm_start(made, start->x.data(), y.data());
      }
      error = osqp_solve(made);
    });
    if (error != 0) {
      result->detail = std::string("OSQP: ") + osqp_error_message(error);
      return;
    }
    result->iterations = solver->info->iter;
    // Where it finds no answer it writes NaN.
    const OSQPSolution& solution = *solver->solution;
    Report(kEnds, solver->info->status_val, std::string("OSQP: ") + solver->info->status, result);
    if (result->status == LcpStatus::kInfeasible) {
      SetRay(qp, solution.dual_inf_cert, solution.prim_inf_cert, -1, result);
    } else if (result->status != LcpStatus::kNumericalFailure) {
      SetAnswer(qp, solution.x, solution.y, -1, result);
    }
  }

 private:
  static constexpr std::pair<OSQPInt, LcpStatus> kEnds[] = {{OSQP_SOLVED, LcpStatus::kSolved},
                                                            {OSQP_MAX_ITER_REACHED, LcpStatus::kIterationLimit},
                                                            {OSQP_SOLVED_INACCURATE, LcpStatus::kIterationLimit},
                                                            {OSQP_TIME_LIMIT_REACHED, LcpStatus::kTimeLimit},
                                                            {OSQP_PRIMAL_INFEASIBLE, LcpStatus::kInfeasible},
                                                            {OSQP_DUAL_INFEASIBLE, LcpStatus::kInfeasible}};
  static constexpr double kLeastTime = 1e-6;  // s; 0 would be no limit

  bool polishing_ = false;
  double rho_ = 0;
  int scaling_ = 0;
  int interval_ = 0;
};

}  // namespace

PeerLibrary ThisPeerLibrary() { return {osqp_version(), &MakePeer<Osqp>}; }

}  // namespace lcpbench
