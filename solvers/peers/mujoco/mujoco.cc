// MuJoCo 2.2: its Newton and conjugate gradient solvers in accelerations, and projected Gauss-Seidel in forces.
//
// They solve w = (A + R) f + b with a diagonal R > 0: over the accelerations a that f makes, with v = J a + b, the cost
// is a'M a / 2 and v_i^2 / (2 R_i) for each bilateral row and each unilateral one with v_i < 0, and f_i = -v_i / R_i.
// The engine has R_i = A_ii (1 - d) / d with d = 0.9 (solimp at contact); so have the keys that end in "-default". The
// others have R_i = A_ii 1e-12, setting `regularization`.
//
// What a step of the engine does with its tree of bodies before that is not ours, and compiling a model takes far
// longer than a solve. So the smallest model is compiled when the worker starts, and the arrays that the solvers read
// are those of this class: degrees of freedom without a tree, one for each column of J with an inverse mass (M
// diagonal), and one row of efc_J per row, bilateral ones (equality) before unilateral ones (limit). mj_factorM,
// mj_projectConstraint and mj_fwdConstraint are the library's. b is what the library subtracts as `efc_aref`. Rows that
// move nothing are left out. O(nnz of J) memory, but the library's stack: (columns)^2, or of Gauss-Seidel rows (rows +
// columns).
//
// A warm start is the acceleration that f makes. It is used with the engine's own R only: with a small one v is the
// difference of numbers that are far larger, and the solvers stop there.
//
// For keys that follow the tier b is scaled by a power of two to about 1, since the library's tolerance has a unit.
// Iterations are the library's; the clock is read by nobody, and the host's time limit ends a solve.

#include <mujoco/mujoco.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

[[noreturn]] void ThrowError(const char* message) { throw std::runtime_error(std::string("MuJoCo: ") + message); }
void IgnoreWarning(const char* /*message*/) {}

const mjModel* CompileModel() {
  const std::string text =
      "<mujoco><size njmax='1' nconmax='1'/><worldbody><body><inertial pos='0 0 0' mass='1' diaginertia='1 1 1'/>"
      "<joint type='slide'/></body></worldbody></mujoco>";
  const auto files = std::make_unique<mjVFS>();
  mj_defaultVFS(files.get());
  constexpr const char* kName = "model.xml";
  std::array<char, 1000> message{};
  if (mj_makeEmptyFileVFS(files.get(), kName, static_cast<int>(text.size())) != 0) ThrowError("no room for the model");
  std::memcpy(files->filedata[0], text.data(), text.size());
  const mjModel* model = mj_loadXML(kName, files.get(), message.data(), static_cast<int>(message.size()));
  mj_deleteVFS(files.get());
  if (model == nullptr) ThrowError(message.data());
  return model;
}

/// The smallest model there is, with the library's default options. Compiled once, and never deleted.
const mjModel& SmallestModel() {
  static const mjModel* const model = CompileModel();
  return *model;
}

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
      : model_(std::make_unique<mjModel>(SmallestModel())),
        tier_(key, reader),
        options_(model_->opt),
        data_(std::make_unique<mjData>()) {  // of zeros
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
    Allocate(rows, columns);
    FillJacobian(problem);
    for (std::size_t i = 0; i < rows; ++i) {
      R_[i] = std::max(mjMINVAL, regularization_ * problem.DiagonalA()[order_[i]]);
      D_[i] = 1 / R_[i];
    }
    PointAtArrays();
    mj_factorM(model_.get(), data_.get());
    mj_projectConstraint(model_.get(), data_.get());
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
        model_->opt.iterations = tier_.Iterations(options);
      }
      model_->opt.iterations = IterationLimit(options, model_->opt.iterations);
      data_->pstack = 0;  // an error of the solve before may have left it anywhere
    });
    TimeLibraryCall(options, result, [&] { mj_fwdConstraint(model_.get(), data_.get()); });
    TimeConversion(options, result, [&] {
      for (std::size_t i = 0; i < order_.size(); ++i) result->f[order_[i]] = force_[i] * scale;
    });
    result->iterations = data_->solver_iter;
    result->status = data_->solver_iter >= model_->opt.iterations ? LcpStatus::kIterationLimit : LcpStatus::kSolved;
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

  bool IsSparse() const {
    constexpr std::size_t kFewest = 60;  // the library's own rule
    return options_.jacobian == mjJAC_SPARSE || (options_.jacobian == mjJAC_AUTO && mass_.size() >= kFewest);
  }

  void Allocate(std::size_t rows, std::size_t columns) {
    const bool is_dual = options_.solver == mjSOL_PGS;
    // What the library takes of its stack, from its code, and a reserve for vectors.
    constexpr std::size_t kVectors = 40;
    const std::size_t matrices = is_dual ? 4 * rows * columns : 3 * columns * columns;
    const std::size_t stack = matrices + kVectors * (rows + columns + 1);
    const std::size_t forces = is_dual ? rows * rows : 0;
    const std::size_t dense = IsSparse() ? 0 : rows * columns;
    if (std::max({stack, forces, dense}) > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      throw MemoryRefusal("the library counts its memory by an int, and would need " + std::to_string(stack) +
                          " numbers");
    }
    RequireMemory(static_cast<double>(sizeof(double) * (stack + forces + dense) + sizeof(int) * forces),
                  "the library's stack");
    if (stack > stack_size_) {
      stack_.reset(new double[stack]);  // not cleared: most of it is never touched
      stack_size_ = stack;
    }
    if (forces > forces_size_) {
      AR_.reset(new double[forces]);
      AR_column_.reset(new int[forces]);
      forces_size_ = forces;
    }
    for (auto* values : {&R_, &D_, &reference_, &row_b_, &force_, &none_}) values->assign(rows, 0);
    for (auto* values :
         {&LD_, &inverse_, &inverse_root_, &acceleration_, &start_, &smooth_, &smooth_force_, &row_force_}) {
      values->assign(columns, 0);
    }
    for (auto* values : {&AR_count_, &AR_start_, &state_, &number_}) values->assign(rows, 0);
    type_.assign(rows, mjCNSTR_LIMIT_TENDON);
    std::fill_n(type_.begin(), equalities_, mjCNSTR_EQUALITY);
    parent_.assign(columns, -1);
    diagonal_.resize(columns);
    simple_.resize(columns);
    for (std::size_t i = 0; i < columns; ++i) {
      diagonal_[i] = static_cast<int>(i);
      simple_[i] = static_cast<int>(columns - i);
    }
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
    if (!IsSparse()) {
      dense_J_ = J;
      return;
    }
    JT_.matrix = J.transpose();
    J_.Count();
    JT_.Count();
  }

  void PointAtArrays() {
    mjModel& model = *model_;
    mjData& data = *data_;
    model.opt = options_;
    model.nv = model.nq = model.nM = static_cast<int>(mass_.size());
    model.njmax = static_cast<int>(order_.size());
    model.dof_Madr = diagonal_.data();
    model.dof_parentid = parent_.data();
    model.dof_simplenum = simple_.data();
    double sum = 0;
    for (const double mass : mass_) sum += mass;
    model.stat.meaninertia = sum / static_cast<double>(mass_.size());
    data.nstack = static_cast<int>(stack_size_);
    data.stack = stack_.get();
    data.ne = equalities_;
    data.nefc = model.njmax;
    data.qM = mass_.data();
    data.qLD = LD_.data();
    data.qLDiagInv = inverse_.data();
    data.qLDiagSqrtInv = inverse_root_.data();
    data.qacc = acceleration_.data();
    data.qacc_warmstart = start_.data();
    data.qacc_smooth = smooth_.data();
    data.qfrc_smooth = smooth_force_.data();
    data.qfrc_constraint = row_force_.data();
    data.efc_type = type_.data();
    data.efc_id = number_.data();
    data.efc_state = state_.data();
    data.efc_J = IsSparse() ? J_.matrix.valuePtr() : dense_J_.data();
    data.efc_J_rownnz = J_.count.data();
    data.efc_J_rowadr = J_.matrix.outerIndexPtr();
    data.efc_J_rowsuper = J_.same.data();
    data.efc_J_colind = J_.matrix.innerIndexPtr();
    data.efc_JT = JT_.matrix.valuePtr();
    data.efc_JT_rownnz = JT_.count.data();
    data.efc_JT_rowadr = JT_.matrix.outerIndexPtr();
    data.efc_JT_rowsuper = JT_.same.data();
    data.efc_JT_colind = JT_.matrix.innerIndexPtr();
    data.efc_frictionloss = none_.data();
    data.efc_R = R_.data();
    data.efc_D = D_.data();
    data.efc_AR = AR_.get();
    data.efc_AR_rownnz = AR_count_.data();
    data.efc_AR_rowadr = AR_start_.data();
    data.efc_AR_colind = AR_column_.get();
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

  std::unique_ptr<mjModel> model_;  // the smallest one with our arrays, which it does not own
  PeerTier tier_;
  mjOption options_;
  double regularization_ = kOwnRegularization;  // of A_ii
  std::unique_ptr<mjData> data_;                // of our arrays only
  std::vector<Index> order_;                    // rows as the library has them
  int equalities_ = 0;
  std::vector<int> place_;  // of J's columns, -1: none
  // By columns.
  std::vector<double> mass_, LD_, inverse_, inverse_root_, acceleration_, start_, smooth_, smooth_force_, row_force_;
  std::vector<int> diagonal_, parent_, simple_;
  // By rows.
  std::vector<double> R_, D_, reference_, row_b_, force_, none_;
  std::vector<int> type_, number_, state_, AR_count_, AR_start_;
  Rows J_, JT_;
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> dense_J_;
  std::unique_ptr<double[]> stack_, AR_;  // NOLINT(modernize-avoid-c-arrays): not to be cleared
  std::unique_ptr<int[]> AR_column_;      // NOLINT(modernize-avoid-c-arrays)
  std::size_t stack_size_ = 0;
  std::size_t forces_size_ = 0;
};

std::unique_ptr<LcpSolver> Make(std::string_view key, SettingsReader* reader) {
  const mjtSolver solver = key.starts_with("mujoco-newton") ? mjSOL_NEWTON
                           : key.starts_with("mujoco-cg")   ? mjSOL_CG
                                                            : mjSOL_PGS;
  return std::make_unique<MuJoCo>(key, solver, reader);
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  mju_user_error = &ThrowError;
  mju_user_warning = &IgnoreWarning;
  SmallestModel();
  return {mj_versionString(), &Make};
}

}  // namespace lcpbench
