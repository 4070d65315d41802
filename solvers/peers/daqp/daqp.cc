// DAQP: a dual active-set method on dense matrices. It stops at the first active set whose constraints are met within
// primal_tol (absolute) and whose multipliers are >= -dual_tol; where H is not positive definite it adds eps_prox to
// the diagonal and repeats (proximal point) until x moves by less than eta_prox. Iterations are changes of the set. A
// warm start is the active set of the given forces.

#include <daqp/api.h>
#include <daqp/constants.h>

#include <algorithm>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solvers/peers/qp/quadratic_program.h"

namespace lcpbench {
namespace {

struct Workspace {
  DAQPWorkspace work{};
  Workspace() { allocate_daqp_settings(&work); }
  ~Workspace() {
    free_daqp_workspace(&work);
    free_daqp_ldp(&work);
  }
  Workspace(const Workspace&) = delete;
  Workspace& operator=(const Workspace&) = delete;
};

class Daqp : public QpPeer {
 public:
  Daqp(std::string_view key, SettingsReader* reader) : QpPeer(key, reader) {
    set_layout({.dense = true, .bounds_are_rows = false});
    if (tier().is_library_default()) return;
    // In the primal form H are the masses: nothing has to be added.
    proximal_ = is_primal() ? Choose<double>(reader, "proximal", {{"0", 0}, {"1e-8", 1e-8}, {"1e-6", 1e-6}})
                            : Choose<double>(reader, "proximal",
                                             {{"1e-6", 1e-6},
                                              {"0", 0},
                                              {"1e-10", 1e-10},
                                              {"1e-8", 1e-8},
                                              {"1e-4", 1e-4},
                                              {"1e-3", 1e-3},
                                              {"1e-2", 1e-2}});
  }

 protected:
  void Run(QuadraticProgram& qp, QpStart* start, const LcpOptions& options, const Deadline& /*deadline*/,
           LcpResult* result) override {
    const auto n = static_cast<int>(qp.variables());
    const auto rows = static_cast<int>(qp.rows());
    const int bounds = qp.is_primal ? 0 : n;
    const int m = bounds + rows;
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> C;
    Eigen::VectorXd lower(m), upper(m);
    std::vector<int> sense(static_cast<std::size_t>(m), 0);
    TimeConversion(options, result, [&] {
      if (qp.is_primal) C = qp.dense_C;
      lower << qp.x_lower.head(bounds), qp.lower;
      upper << Eigen::VectorXd::Constant(bounds, DAQP_INF), qp.upper;
      lower = lower.cwiseMax(-DAQP_INF);
      upper = upper.cwiseMin(DAQP_INF);
      for (std::size_t i = 0; i < sense.size(); ++i) {
        const auto row = static_cast<Index>(i);
        if (qp.is_primal && qp.bilateral[i] != 0) continue;  // bounds that meet are seen by the library
        if (start == nullptr) continue;
        const bool holds = qp.is_primal ? start->y[row] > 0 : start->x[row] <= 0 && qp.bilateral[i] == 0;
        if (holds) sense[i] = ACTIVE | LOWER;
      }
    });
    DAQPProblem problem{};
    problem.n = n;
    problem.m = m;
    problem.ms = bounds;
    problem.H = qp.dense_H.data();
    problem.f = qp.g.data();
    problem.A = C.data();
    problem.bupper = upper.data();
    problem.blower = lower.data();
    problem.sense = sense.data();
    Workspace workspace;
    DAQPSettings& settings = *workspace.work.settings;
    settings.iter_limit = tier().Iterations(options, settings.iter_limit);
    if (!tier().is_library_default()) {
      settings.primal_tol = settings.eta_prox = tier().Tolerance(options);
      settings.eps_prox = proximal_ * qp.dense_H.diagonal().maxCoeff();
    }
    Eigen::VectorXd x(n), y(m);
    x.setZero();
    y.setZero();
    DAQPResult answer{};
    answer.x = x.data();
    answer.lam = y.data();
    TimeLibraryCall(options, result, [&] {
      answer.exitflag = setup_daqp(&problem, &workspace.work, nullptr);
      if (answer.exitflag > 0) daqp_solve(&answer, &workspace.work);
    });
    result->iterations = answer.iter;
    Report(kEnds, answer.exitflag, "DAQP: exit flag " + std::to_string(answer.exitflag), result);
    // Multipliers of a lower bound are negative.
    if (result->status != LcpStatus::kInfeasible) SetAnswer(qp, x.data(), y.data() + bounds, -1, result);
  }

 private:
  static constexpr std::pair<int, LcpStatus> kEnds[] = {{EXIT_OPTIMAL, LcpStatus::kSolved},
                                                        {EXIT_ITERLIMIT, LcpStatus::kIterationLimit},
                                                        {EXIT_INFEASIBLE, LcpStatus::kInfeasible},
                                                        {EXIT_UNBOUNDED, LcpStatus::kInfeasible}};

  double proximal_ = 0;  // a share of the largest diagonal entry of H
};

}  // namespace

PeerLibrary ThisPeerLibrary() { return {LCPBENCH_DAQP_VERSION, &MakePeer<Daqp>}; }

}  // namespace lcpbench
