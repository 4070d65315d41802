// ProxQP of ProxSuite: a proximal augmented Lagrangian method, with a dense and a sparse backend; header-only, so it is
// compiled here. It stops where the largest primal and the largest dual residual are below eps_abs (absolute, in the
// units of the program; eps_rel is 0). Iterations are its inner ones, of Newton. The sparse backend knows no bounds of
// variables. The warm start are x and all multipliers.

#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <proxsuite/config.hpp>
#include <proxsuite/proxqp/dense/dense.hpp>
#include <proxsuite/proxqp/sparse/sparse.hpp>
#include <string>
#include <utility>
#include <vector>

#include "solvers/peers/qp/quadratic_program.h"

namespace lcpbench {
namespace {

namespace proxqp = proxsuite::proxqp;
using proxqp::InitialGuessStatus;
using proxsuite::nullopt;

constexpr double kHuge = 1e20;  // what the library takes for infinite

class ProxQp : public QpPeer {
 public:
  ProxQp(std::string_view key, SettingsReader* reader) : QpPeer(key, reader) {
    is_sparse_ = tier().is_library_default()
                     ? is_primal()
                     : reader->Choice("backend", is_primal() ? "sparse" : "dense", {"dense", "sparse"}) == "sparse";
    set_layout({.dense = !is_sparse_, .bounds_are_rows = is_sparse_});
    if (tier().is_library_default()) return;
    guess_ = Choose<InitialGuessStatus>(reader, "initial_guess",
                                        {{"equality", InitialGuessStatus::EQUALITY_CONSTRAINED_INITIAL_GUESS},
                                         {"none", InitialGuessStatus::NO_INITIAL_GUESS}});
    rho_ = Choose<double>(reader, "rho", {{"1e-6", 1e-6}, {"1e-8", 1e-8}, {"1e-7", 1e-7}, {"1e-5", 1e-5}});
  }

 protected:
  void Run(QuadraticProgram& qp, QpStart* start, const LcpOptions& options, const Deadline& /*deadline*/,
           LcpResult* result) override {
    if (is_sparse_) {
      RunSparse(qp, start, options, result);
    } else {
      RunDense(qp, start, options, result);
    }
  }

 private:
  template <typename Program>
  void SetOptions(const LcpOptions& options, bool warm, Program* program) const {
    auto& settings = program->settings;
    settings.verbose = false;
    settings.compute_timings = false;
    settings.max_iter = tier().Iterations(options, static_cast<double>(settings.max_iter));
    if (!tier().is_library_default()) {
      settings.eps_abs = tier().Tolerance(options);
      settings.eps_rel = 0;
      settings.initial_guess = guess_;
    }
    if (warm) settings.initial_guess = InitialGuessStatus::WARM_START;
  }

  // Rows whose bounds meet are equations for this library.
  struct Split {
    explicit Split(const QuadraticProgram& qp) {
      for (Index row = 0; row < qp.rows(); ++row) (qp.lower[row] == qp.upper[row] ? equal : unequal).push_back(row);
      b = qp.lower(equal);
      l = qp.lower(unequal);
      u = qp.upper(unequal).cwiseMin(kHuge);
    }
    std::vector<Index> equal, unequal;
    Eigen::VectorXd b, l, u;
  };

  // From the start, or from the guess of the options.
  template <typename Program>
  static void Solve(const Split& split, const QpStart* start, Program* program) {
    if (start == nullptr) return program->solve();
    const Eigen::VectorXd y = -start->y(split.equal);
    const Eigen::VectorXd z = -start->y(split.unequal);
    program->solve(start->x, y, z);
  }

  void RunDense(QuadraticProgram& qp, const QpStart* start, const LcpOptions& options, LcpResult* result) const {
    const Index n = qp.variables();
    std::optional<Split> split;
    Eigen::MatrixXd A, C;
    Eigen::VectorXd x_upper;
    TimeConversion(options, result, [&] {
      split.emplace(qp);
      A.resize(static_cast<Index>(split->equal.size()), n);
      C.resize(static_cast<Index>(split->unequal.size()), n);
      if (A.rows() > 0) A = qp.dense_C(split->equal, Eigen::all);
      if (C.rows() > 0) C = qp.dense_C(split->unequal, Eigen::all);
      qp.x_lower = qp.x_lower.cwiseMax(-kHuge);
      x_upper.setConstant(n, kHuge);
    });
    const bool boxes = !qp.is_primal;
    const auto hessian = qp.is_primal ? proxqp::HessianType::Diagonal : proxqp::HessianType::Dense;
    std::unique_ptr<proxqp::dense::QP<double>> program;
    TimeLibraryCall(options, result, [&] {
      program = std::make_unique<proxqp::dense::QP<double>>(n, A.rows(), C.rows(), boxes, hessian,
                                                            proxqp::DenseBackend::Automatic);
      SetOptions(options, start != nullptr, program.get());
      if (boxes) {
        program->init(qp.dense_H, qp.g, nullopt, nullopt, nullopt, nullopt, nullopt, qp.x_lower, x_upper, true, rho_);
      } else {
        program->init(qp.dense_H, qp.g, A, split->b, C, split->l, split->u, true, rho_);
      }
      if (start != nullptr && boxes) {
        // Put where the library keeps a warm start: its `solve` with one refuses multipliers of bounds.
        program->results.x = start->x;
        program->results.z = -start->bound_y;
        program->solve();
      } else {
        Solve(*split, start, program.get());
      }
    });
    Take(qp, *split, program->results, result);
  }

  void RunSparse(QuadraticProgram& qp, const QpStart* start, const LcpOptions& options, LcpResult* result) const {
    using Matrix = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
    const Index n = qp.variables();
    std::optional<Split> split;
    Matrix H, A, C;
    TimeConversion(options, result, [&] {
      split.emplace(qp);
      H = qp.H.triangularView<Eigen::Upper>();
      const auto take = [&](const std::vector<Index>& rows) {
        Matrix pick(static_cast<Index>(rows.size()), qp.rows());
        for (Index i = 0; i < pick.rows(); ++i) pick.insert(i, rows[static_cast<std::size_t>(i)]) = 1;
        return Matrix(pick * qp.C);
      };
      A = take(split->equal);
      C = take(split->unequal);
    });
    std::unique_ptr<proxqp::sparse::QP<double, int>> program;
    TimeLibraryCall(options, result, [&] {
      program = std::make_unique<proxqp::sparse::QP<double, int>>(n, A.rows(), C.rows());
      SetOptions(options, start != nullptr, program.get());
      program->init(H, qp.g, A, split->b, C, split->l, split->u, true, rho_);
      Solve(*split, start, program.get());
    });
    Take(qp, *split, program->results, result);
  }

  template <typename Results>
  void Take(const QuadraticProgram& qp, const Split& split, const Results& results, LcpResult* result) const {
    Eigen::VectorXd y;
    y.setZero(qp.rows());
    for (std::size_t i = 0; i < split.equal.size(); ++i) y[split.equal[i]] = results.y[static_cast<Index>(i)];
    for (std::size_t i = 0; i < split.unequal.size(); ++i) y[split.unequal[i]] = results.z[static_cast<Index>(i)];
    result->iterations = results.info.iter;
    using Output = proxqp::QPSolverOutput;
    constexpr std::pair<Output, LcpStatus> kEnds[] = {{Output::PROXQP_SOLVED, LcpStatus::kSolved},
                                                      {Output::PROXQP_MAX_ITER_REACHED, LcpStatus::kIterationLimit},
                                                      {Output::PROXQP_PRIMAL_INFEASIBLE, LcpStatus::kInfeasible},
                                                      {Output::PROXQP_DUAL_INFEASIBLE, LcpStatus::kInfeasible}};
    Report(kEnds, results.info.status, "ProxQP: no answer", result);
    if (result->status == LcpStatus::kInfeasible) {
      result->detail = "ProxQP: primal or dual infeasible";
      return;
    }
    SetAnswer(qp, results.x.data(), y.data(), -1, result);
  }

  bool is_sparse_ = false;
  InitialGuessStatus guess_ = InitialGuessStatus::EQUALITY_CONSTRAINED_INITIAL_GUESS;
  proxsuite::optional<double> rho_;  // none: the library's own
};

}  // namespace

// The library takes its workspace from malloc, wherever that is, and the order of vectorised sums depends on where:
// blocks of one alignment, so that the same program gives the same bits each time.
#ifdef __clang__
#pragma clang diagnostic ignored "-Wreserved-identifier"  // the linker's names
#endif
extern "C" void* __wrap_malloc(std::size_t size) {  // NOLINT
  constexpr std::size_t kAlignment = 64;
  return std::aligned_alloc(kAlignment, (size + kAlignment) / kAlignment * kAlignment);
}

extern "C" void* __wrap_realloc(void* block, std::size_t size) {  // NOLINT
  void* other = __wrap_malloc(size);
  if (other == nullptr || block == nullptr) return other;
  std::memcpy(other, block, std::min(size, malloc_usable_size(block)));
  std::free(block);
  return other;
}

PeerLibrary ThisPeerLibrary() { return {PROXSUITE_VERSION, &MakePeer<ProxQp>}; }

}  // namespace lcpbench
