// MuJoCo 4.0: its Newton and conjugate gradient solvers in accelerations, and projected Gauss-Seidel in forces.
//
// They solve w = (A + R) f + b with a diagonal R > 0: over the accelerations a that f makes, with v = J a + b, the cost
// is a'M a / 2 and v_i^2 / (2 R_i) for each bilateral row and each unilateral one with v_i < 0, and f_i = -v_i / R_i.
// The engine has R_i = A_ii (1 - d) / d with d = 0.9 (solimp at contact); so have the keys that end in "-default". The
// others have R_i = A_ii 1e-12, setting `regularization`.
//
// What a step of the engine does with its tree of bodies before that is not ours, and compiling a model takes far
// longer than a solve. So model and data are not the library's, but have the arrays that its solvers read, filled by
// this class: for each column of J with an inverse mass a degree of freedom with a tree of its own (M diagonal), and
// one row of efc_J per row, bilateral ones (equality) before unilateral ones (limit). mj_factorM, mj_island,
// mj_projectConstraint and mj_fwdConstraint are the library's, in the order of a step. b is what the library subtracts
// as `efc_aref`. Rows that move nothing are left out. O(nnz of J) memory, but the library's arena: (columns)^2, or of
// Gauss-Seidel rows (rows + columns).
//
// A warm start is the acceleration that f makes. It is used with the engine's own R only: with a small one v is the
// difference of numbers that are far larger, and the solvers stop there.
//
// For keys that follow the tier b is scaled by a power of two to about 1, since the library's tolerance has a unit.
// Iterations are the library's; the clock is read by nobody, and the host's time limit ends a solve.

#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <stdexcept>
#include <string>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

// Errors are thrown through the library, which else ends the process; what it warns of shows in the answer.
void ThrowErrors(const mjLogMessage* message) {
  if (message->level == mjLOG_ERROR) throw std::runtime_error(std::string("MuJoCo: ") + message->subject);
}

struct FreeArena {
  void operator()(void* arena) const { mju_free(arena); }
};

/// Compressed rows as MuJoCo has them.
struct Rows {
  SparseMatrix matrix;
  std::vector<int> count, same;

  /// The lengths of rows, and for each how many rows right behind it have the same columns.
  void Count() {
    const auto rows = static_cast<std::size_t>(matrix.rows());
    const int *const start = matrix.outerIndexPtr(), *const column = matrix.innerIndexPtr();
    count.resize(rows);
    same.assign(rows, 0);
    for (std::size_t row = rows; row-- > 0;) {
      count[row] = start[row + 1] - start[row];
      if (row + 1 == rows || count[row] != count[row + 1]) continue;
      const int* const begin = column + start[row];
      if (std::equal(begin, begin + count[row], column + start[row + 1])) same[row] = same[row + 1] + 1;
    }
  }
};

class MuJoCo : public LcpSolver {
 public:
  MuJoCo(std::string_view key, mjtSolver solver, SettingsReader* reader)
      : model_(std::make_unique<mjModel>()), tier_(key, reader), data_(std::make_unique<mjData>()) {  // of zeros
    mj_defaultOption(&options_);
    options_.solver = solver;
    if (tier_.is_library_default()) return;
    regularization_ = reader->Number("regularization", kRegularization, 1e-16, 1);
    options_.jacobian =
        Choose<int>(reader, "jacobian", {{"auto", mjJAC_AUTO}, {"dense", mjJAC_DENSE}, {"sparse", mjJAC_SPARSE}});
  }

  std::string WhyUnsupported(const LcpProblem& problem) const override {
    return problem.has_factors() ? "" : "needs J and the inverse masses";
  }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    OrderColumnsAndRows(problem);
    const auto rows = order_.size();
    const auto columns = mass_.size();
    if (rows == 0) return;
    FillJacobian(problem);
    Allocate(rows, columns);
    if (mj_isSparse(model_.get()) == 0) dense_J_ = J_.matrix;
    for (std::size_t i = 0; i < rows; ++i) {
      R_[i] = std::max(mjMINVAL, regularization_ * problem.DiagonalA()[order_[i]]);
      D_[i] = 1 / R_[i];
    }
    PointAtArrays();
    mj_factorM(model_.get(), data_.get());
    mj_island(model_.get(), data_.get());
    mj_projectConstraint(model_.get(), data_.get());
    // Where its arena is too small, the library drops all rows.
    if (data_->nefc != static_cast<int>(rows)) throw std::runtime_error("MuJoCo: its arena is too small");
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    if (order_.empty()) {
      result->status = LcpStatus::kSolved;
      return;
    }
    double scale = 1;
    TimeConversion(options, result, [&] {
      const double largest = problem.b().cwiseAbs().maxCoeff();
      if (!tier_.is_library_default() && largest > 0) scale = std::exp2(std::round(std::log2(largest)));
      for (std::size_t i = 0; i < order_.size(); ++i) reference_[i] = -problem.b()[order_[i]] / scale;
      for (auto* values : {&acceleration_, &start_, &smooth_, &smooth_force_, &row_force_}) {
        std::fill(values->begin(), values->end(), 0);
      }
      std::fill(force_.begin(), force_.end(), 0);
      const bool is_warm = options.initial_f != nullptr && tier_.is_library_default();
      if (is_warm) SetStart(*options.initial_f, scale);
      model_->opt = options_;
      if (!is_warm) model_->opt.disableflags |= mjDSBL_WARMSTART;
      if (!tier_.is_library_default()) {
        // It bounds the fall of the cost. There an error of f counts as R_i / 2 times its square, or A_ii / 2 in
        // forces.
        const double weight = options_.solver == mjSOL_PGS ? 1 : regularization_;
        model_->opt.tolerance = weight * tier_.Tolerance(options) * tier_.Tolerance(options);
      }
      model_->opt.iterations = tier_.Iterations(options, model_->opt.iterations);
      data_->pstack = data_->pbase = 0;  // an error of the solve before may have left them anywhere
    });
    TimeLibraryCall(options, result, [&] { mj_fwdConstraint(model_.get(), data_.get()); });
    TimeConversion(options, result, [&] {
      for (std::size_t i = 0; i < order_.size(); ++i) result->f[order_[i]] = force_[i] * scale;
    });
    // The library counts for its first islands only.
    const int islands = std::clamp(data_->nisland, 1, mjNISLAND);
    result->iterations = *std::max_element(data_->solver_niter, data_->solver_niter + islands);
    result->status = result->iterations >= model_->opt.iterations ? LcpStatus::kIterationLimit : LcpStatus::kSolved;
  }

 private:
  static constexpr double kRegularization = 1e-12;
  // R/A by the default solimp at a contact or a limit: (1 - 0.9) / 0.9.
  static constexpr double kOwnRegularization = 0.1 / 0.9;

  void OrderColumnsAndRows(const LcpProblem& problem) {
    place_.assign(static_cast<std::size_t>(problem.J().cols()), -1);
    mass_.clear();
    for (Index column = 0; column < problem.J().cols(); ++column) {
      if (problem.inverse_mass()[column] == 0) continue;
      place_[static_cast<std::size_t>(column)] = static_cast<int>(mass_.size());
      mass_.push_back(1 / problem.inverse_mass()[column]);
    }
    order_.clear();
    const auto add = [&](bool bilateral) {
      for (Index row = 0; row < problem.size(); ++row) {
        if (problem.is_bilateral(row) == bilateral && problem.DiagonalA()[row] > 0) order_.push_back(row);
      }
    };
    add(true);
    equalities_ = static_cast<int>(order_.size());
    add(false);
  }

  void Allocate(std::size_t rows, std::size_t columns) {
    const bool is_dual = options_.solver == mjSOL_PGS;
    // What the library takes of its arena, from its code, and a reserve for vectors.
    constexpr std::size_t kVectors = 64;
    const std::size_t order = is_dual ? rows : columns;
    const std::size_t jacobian =
        mj_isSparse(model_.get()) != 0 ? static_cast<std::size_t>(J_.matrix.nonZeros()) : rows * columns;
    if (std::max(order * order, jacobian) > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw MemoryRefusal("the library counts the entries of a matrix by an int, and would need " +
                          std::to_string(std::max(order * order, jacobian)));
    }
    const std::size_t size =
        sizeof(double) * ((is_dual ? 2 : 3) * order * order + 3 * jacobian + kVectors * (rows + columns + 1));
    RequireMemory(static_cast<double>(size), "the library's arena");
    if (size > arena_size_) {
      arena_.reset(mju_malloc(size));  // not cleared: most of it is never touched
      arena_size_ = size;
    }
    for (auto* values : {&R_, &D_, &reference_, &row_b_, &force_, &none_}) values->assign(rows, 0);
    for (auto* values : {&LD_, &inverse_, &acceleration_, &start_, &smooth_, &smooth_force_, &row_force_}) {
      values->assign(columns, 0);
    }
    state_.assign(rows, 0);
    number_.resize(rows);  // a number of its own for each row: the library takes equal ones for one constraint
    std::iota(number_.begin(), number_.end(), 0);
    joints_.assign(rows, mjEQ_JOINT);
    type_.assign(rows, mjCNSTR_LIMIT_TENDON);
    std::fill_n(type_.begin(), equalities_, mjCNSTR_EQUALITY);
    parent_.assign(columns, -1);
    one_.assign(columns, 1);
    diagonal_.resize(columns);
    std::iota(diagonal_.begin(), diagonal_.end(), 0);
  }

  void FillJacobian(const LcpProblem& problem) {
    const auto rows = static_cast<Index>(order_.size()), columns = static_cast<Index>(mass_.size());
    SparseMatrix& J = J_.matrix;
    J.resize(rows, columns);
    for (Index i = 0; i < rows; ++i) {
      J.startVec(i);
      for (SparseMatrix::InnerIterator entry(problem.J(), order_[static_cast<std::size_t>(i)]); entry; ++entry) {
        const int column = place_[static_cast<std::size_t>(entry.col())];
        if (column >= 0) J.insertBack(i, column) = entry.value();
      }
    }
    J.finalize();
    model_->opt = options_;
    model_->nv = columns;
    if (mj_isSparse(model_.get()) != 0) J_.Count();
  }

  void PointAtArrays() {
    mjModel& model = *model_;
    mjData& data = *data_;
    const bool is_sparse = mj_isSparse(&model) != 0;
    model.nq = model.nM = model.nC = model.ntree = model.nv;
    model.M_rownnz = model.tree_dofnum = model.dof_simplenum = one_.data();
    model.M_rowadr = model.M_colind = model.dof_Madr = model.dof_treeid = model.tree_dofadr = diagonal_.data();
    model.dof_parentid = parent_.data();
    model.eq_type = joints_.data();
    model.stat.meaninertia = std::accumulate(mass_.begin(), mass_.end(), 0.0) / static_cast<double>(mass_.size());
    data.arena = arena_.get();
    data.narena = static_cast<mjtSize>(arena_size_);
    data.parena = data.pstack = data.pbase = 0;
    data.ne = equalities_;
    data.nefc = static_cast<int>(order_.size());
    data.nl = data.nefc - data.ne;
    data.nJ = static_cast<int>(is_sparse ? J_.matrix.nonZeros() : dense_J_.size());
    data.M = mass_.data();
    data.qLD = LD_.data();
    data.qLDiagInv = inverse_.data();
    data.qacc = acceleration_.data();
    data.qacc_warmstart = start_.data();
    data.qacc_smooth = smooth_.data();
    data.qfrc_smooth = smooth_force_.data();
    data.qfrc_constraint = row_force_.data();
    data.efc_type = type_.data();
    data.efc_id = number_.data();
    data.efc_state = state_.data();
    data.efc_J = is_sparse ? J_.matrix.valuePtr() : dense_J_.data();
    data.efc_J_rownnz = J_.count.data();
    data.efc_J_rowadr = J_.matrix.outerIndexPtr();
    data.efc_J_rowsuper = J_.same.data();
    data.efc_J_colind = J_.matrix.innerIndexPtr();
    data.efc_frictionloss = none_.data();
    data.efc_R = R_.data();
    data.efc_D = D_.data();
    data.efc_aref = reference_.data();
    data.efc_b = row_b_.data();
    data.efc_force = force_.data();
  }

  // The acceleration that f makes.
  void SetStart(const Eigen::VectorXd& f, double scale) {
    for (std::size_t i = 0; i < order_.size(); ++i) force_[i] = f[order_[i]] / scale;
    mj_mulJacTVec(model_.get(), data_.get(), start_.data(), force_.data());
    for (std::size_t i = 0; i < start_.size(); ++i) start_[i] *= inverse_[i];
  }

  std::unique_ptr<mjModel> model_;  // of our arrays only
  PeerTier tier_;
  mjOption options_{};
  double regularization_ = kOwnRegularization;  // of A_ii
  std::unique_ptr<mjData> data_;                // of our arrays and arena only
  std::vector<Index> order_;                    // rows as the library has them
  int equalities_ = 0;
  std::vector<int> place_;  // of J's columns, -1: none
  // By columns.
  std::vector<double> mass_, LD_, inverse_, acceleration_, start_, smooth_, smooth_force_, row_force_;
  std::vector<int> diagonal_, parent_, one_;
  // By rows.
  std::vector<double> R_, D_, reference_, row_b_, force_, none_;
  std::vector<int> type_, number_, state_, joints_;
  Rows J_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> dense_J_;
  std::unique_ptr<void, FreeArena> arena_;
  std::size_t arena_size_ = 0;
};

std::unique_ptr<LcpSolver> Make(std::string_view key, SettingsReader* reader) {
  const mjtSolver solver = key.starts_with("mujoco-newton") ? mjSOL_NEWTON
                           : key.starts_with("mujoco-cg")   ? mjSOL_CG
                                                            : mjSOL_PGS;
  return std::make_unique<MuJoCo>(key, solver, reader);
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  mju_setLogHandler(&ThrowErrors);
  return {mj_versionString(), &Make};
}

}  // namespace lcpbench
