// HiGHS: its active-set method for convex quadratic programs (its interior point methods take none in this release:
// the option `solver` changes nothing). It stops where infeasibilities, primal and dual, are below absolute tolerances,
// both set to the same value, at least 1e-10. It adds qp_regularization_value (1e-7) to the diagonal of H, which bounds
// the accuracy as a tolerance does: 0 where the tier is followed. Iterations are its own. By the C interface, because
// the wheel was built with another ABI of strings.

#include <interfaces/highs_c_api.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "solvers/peers/qp/quadratic_program.h"

namespace lcpbench {
namespace {

struct Destroy {
  void operator()(void* highs) const { Highs_destroy(highs); }
};

class HighsQp : public QpPeer {
 public:
  HighsQp(std::string_view key, SettingsReader* reader) : QpPeer(key, reader) {
    Highs_setBoolOptionValue(highs_.get(), "output_flag", 0);
    Highs_setIntOptionValue(highs_.get(), "threads", 1);
    Highs_setStringOptionValue(highs_.get(), "parallel", "off");
    if (tier().is_library_default()) return;
    regularization_ =
        Choose<double>(reader, "regularization",
                       {{"0", 0}, {"1e-12", 1e-12}, {"1e-10", 1e-10}, {"1e-9", 1e-9}, {"1e-8", 1e-8}, {"1e-7", 1e-7}});
  }

 protected:
  void Run(QuadraticProgram& qp, QpStart* /*start*/, const LcpOptions& options, const Deadline& deadline,
           LcpResult* result) override {
    const auto n = static_cast<HighsInt>(qp.variables());
    const auto rows = static_cast<HighsInt>(qp.rows());
    Eigen::SparseMatrix<double> H;
    const Eigen::VectorXd x_upper = Eigen::VectorXd::Constant(n, std::numeric_limits<double>::infinity());
    TimeConversion(options, result, [&] {
      H = qp.H.triangularView<Eigen::Lower>();
      if (rows == 0) qp.C = Eigen::SparseMatrix<double>(0, n);
    });
    Eigen::VectorXd x(n), x_dual(n), row_value(rows), y(rows);
    HighsInt status = kHighsStatusError;
    TimeLibraryCall(options, result, [&] {
      void* h = highs_.get();
      Highs_zeroAllClocks(h);
      if (!tier().is_library_default()) {
        const double tolerance = std::max(kLeastTolerance, tier().Tolerance(options));
        Highs_setDoubleOptionValue(h, "qp_regularization_value", regularization_);
        for (const char* name : {"kkt_tolerance", "primal_feasibility_tolerance", "dual_feasibility_tolerance"}) {
          Highs_setDoubleOptionValue(h, name, tolerance);
        }
      }
      Highs_setIntOptionValue(h, "qp_iteration_limit", IterationLimit(options, std::numeric_limits<HighsInt>::max()));
      Highs_setDoubleOptionValue(h, "time_limit", deadline.Remaining());
      status = Highs_passModel(h, n, rows, static_cast<HighsInt>(qp.C.nonZeros()), static_cast<HighsInt>(H.nonZeros()),
                               kHighsMatrixFormatColwise, kHighsHessianFormatTriangular, kHighsObjSenseMinimize, 0,
                               qp.g.data(), qp.x_lower.data(), x_upper.data(), qp.lower.data(), qp.upper.data(),
                               qp.C.outerIndexPtr(), qp.C.innerIndexPtr(), qp.C.valuePtr(), H.outerIndexPtr(),
                               H.innerIndexPtr(), H.valuePtr(), nullptr);
      if (status != kHighsStatusError) status = Highs_run(h);
      if (status != kHighsStatusError) Highs_getSolution(h, x.data(), x_dual.data(), row_value.data(), y.data());
    });
    if (status == kHighsStatusError) {
      result->detail = "HiGHS: error";
      return;
    }
    HighsInt iterations = 0;
    Highs_getIntInfoValue(highs_.get(), "qp_iteration_count", &iterations);
    result->iterations = std::max<HighsInt>(0, iterations);
    const HighsInt end = Highs_getModelStatus(highs_.get());
    result->detail = "HiGHS: model status " + std::to_string(end);
    if (end == kHighsModelStatusOptimal) {
      result->status = LcpStatus::kSolved;
      result->detail.clear();
    } else if (end == kHighsModelStatusTimeLimit) {
      result->status = LcpStatus::kTimeLimit;
    } else if (end == kHighsModelStatusIterationLimit) {
      result->status = LcpStatus::kIterationLimit;
    } else if (end == kHighsModelStatusInfeasible || end == kHighsModelStatusUnbounded) {
      result->status = LcpStatus::kInfeasible;
      return;
    }
    SetAnswer(qp, x.data(), y.data(), 1, result);
  }

 private:
  static constexpr double kLeastTolerance = 1e-10;  // that the library takes

  double regularization_ = 0;
  std::unique_ptr<void, Destroy> highs_{Highs_create()};
};

}  // namespace

PeerLibrary ThisPeerLibrary() { return {Highs_version(), &MakePeer<HighsQp>}; }

}  // namespace lcpbench
