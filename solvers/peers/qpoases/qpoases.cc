// qpOASES: an online active-set method (a homotopy from a problem with a known answer) on dense matrices, with its
// options for reliability or, as the library begins, its default ones. It stops at the end of the homotopy; a
// termination tolerance of 5e6 times machine epsilon is not meant to be loosened, so no tier is passed on. Iterations
// are changes of the working set. A warm start is the active set of the given forces, and the answer they are.

#include <algorithm>
#include <limits>
#include <optional>
#include <qpOASES.hpp>
#include <string>
#include <utility>

#include "solvers/peers/qp/quadratic_program.h"

namespace lcpbench {
namespace {

using qpOASES::int_t;
using qpOASES::returnValue;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

class QpOases : public QpPeer {
 public:
  QpOases(std::string_view key, SettingsReader* reader) : QpPeer(key, reader) {
    set_layout({.dense = true, .bounds_are_rows = false});
    set_ = Choose<Set>(reader, "options",
                       {{"default", &qpOASES::Options::setToDefault},
                        {"reliable", &qpOASES::Options::setToReliable},
                        {"mpc", &qpOASES::Options::setToMPC}});
    regularization_ = reader->YesOrNo("regularization", true);
  }

 protected:
  void Run(QuadraticProgram& qp, QpStart* start, const LcpOptions& options, const Deadline& deadline,
           LcpResult* result) override {
    qpOASES::Options library;
    (library.*set_)();
    library.printLevel = qpOASES::PL_NONE;
    library.enableRegularisation = regularization_ ? qpOASES::BT_TRUE : qpOASES::BT_FALSE;
    const auto n = static_cast<int_t>(qp.variables());
    const auto rows = static_cast<int_t>(qp.rows());
    RowMajor C;
    Eigen::MatrixXd H;
    TimeConversion(options, result, [&] {
      C = qp.dense_C;
      H = qp.dense_H;  // the library regularises the numbers it is given
      for (Eigen::VectorXd* bound : {&qp.x_lower, &qp.lower, &qp.upper}) {
        *bound = bound->cwiseMax(-qpOASES::INFTY).cwiseMin(qpOASES::INFTY);
      }
    });
    int_t changes = IterationLimit(options, kMostChanges);
    double seconds = deadline.Remaining();
    double* limit = seconds < std::numeric_limits<double>::infinity() ? &seconds : nullptr;
    Eigen::VectorXd y(n + rows);
    Eigen::VectorXd guess;
    qpOASES::Bounds bounds(n);
    qpOASES::Constraints constraints(std::max<int_t>(rows, 1));
    if (start != nullptr) {
      guess.resize(n + rows);
      guess << start->bound_y, start->y;
      for (int_t i = 0; i < n; ++i) {
        const bool holds = !qp.is_primal && qp.bilateral[static_cast<std::size_t>(i)] == 0 && start->x[i] <= 0;
        bounds.setupBound(i, holds ? qpOASES::ST_LOWER : qpOASES::ST_INACTIVE);
      }
      for (int_t i = 0; i < rows; ++i) {
        const bool holds = qp.bilateral[static_cast<std::size_t>(i)] != 0 || start->y[i] > 0;
        constraints.setupConstraint(i, holds ? qpOASES::ST_LOWER : qpOASES::ST_INACTIVE);
      }
    }
    const double* x_guess = start != nullptr ? start->x.data() : nullptr;
    const double* y_guess = start != nullptr ? guess.data() : nullptr;
    Eigen::VectorXd x(n);
    returnValue code{};
    TimeLibraryCall(options, result, [&] {
      if (qp.is_primal) {
        if (!primal_ || primal_->getNV() != n || primal_->getNC() != rows) {
          primal_.emplace(n, rows, qpOASES::HST_POSDEF);
        }
        qpOASES::QProblem& program = *primal_;
        program.reset();
        program.setOptions(library);
        program.setHessianType(qpOASES::HST_POSDEF);
        code = program.init(H.data(), qp.g.data(), C.data(), nullptr, nullptr, qp.lower.data(), qp.upper.data(),
                            changes, limit, x_guess, y_guess, start != nullptr ? &bounds : nullptr,
                            start != nullptr ? &constraints : nullptr);
        program.getPrimalSolution(x.data());
        program.getDualSolution(y.data());
      } else {
        if (!dual_ || dual_->getNV() != n) dual_.emplace(n, qpOASES::HST_SEMIDEF);
        qpOASES::QProblemB& program = *dual_;
        program.reset();
        program.setOptions(library);
        program.setHessianType(qpOASES::HST_SEMIDEF);
        code = program.init(H.data(), qp.g.data(), qp.x_lower.data(), nullptr, changes, limit, x_guess, y_guess,
                            start != nullptr ? &bounds : nullptr);
        program.getPrimalSolution(x.data());
      }
    });
    result->iterations = changes;
    Report(kEnds, code, std::string("qpOASES: ") + qpOASES::getGlobalMessageHandler()->getErrorCodeMessage(code),
           result);
    const bool in_time = result->status == LcpStatus::kIterationLimit && !deadline.Expired();
    if (result->status == LcpStatus::kSolved || in_time) {
      SetAnswer(qp, x.data(), y.data() + n, 1, result);
    }
  }

 private:
  using Set = returnValue (qpOASES::Options::*)();

  static constexpr std::pair<returnValue, LcpStatus> kEnds[] = {
      {qpOASES::SUCCESSFUL_RETURN, LcpStatus::kSolved},
      {qpOASES::RET_MAX_NWSR_REACHED, LcpStatus::kIterationLimit},
      {qpOASES::RET_INIT_FAILED_INFEASIBILITY, LcpStatus::kInfeasible},
      {qpOASES::RET_INIT_FAILED_UNBOUNDEDNESS, LcpStatus::kInfeasible},
      {qpOASES::RET_QP_INFEASIBLE, LcpStatus::kInfeasible},
      {qpOASES::RET_QP_UNBOUNDED, LcpStatus::kInfeasible}};

  static constexpr double kMostChanges = 1e9;  // the time limit decides

  Set set_ = nullptr;
  bool regularization_ = true;
  // Kept between problems of one size.
  std::optional<qpOASES::QProblem> primal_;
  std::optional<qpOASES::QProblemB> dual_;
};

}  // namespace

PeerLibrary ThisPeerLibrary() { return {LCPBENCH_QPOASES_VERSION, &MakePeer<QpOases>}; }

}  // namespace lcpbench
