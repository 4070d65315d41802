#include "solvers/linear_algebra/cholmod_factor.h"

#include <cholmod.h>
#include <dlfcn.h>

#include <algorithm>
#include <map>
#include <mutex>
#include <stdexcept>

#include "solvers/lcp/factor_clock.h"
#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/loaded_blas.h"

namespace lcpbench {
namespace {

// A setting of the libraries below CHOLMOD, for the whole process, found at run time: which BLAS is loaded is the
// system's choice.
class LibrarySetting {
 public:
  // `single`: the value that means one thread.
  LibrarySetting(const char* setter, const char* getter, int single)
      : set_(reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, setter))),
        get_(reinterpret_cast<int (*)()>(dlsym(RTLD_DEFAULT, getter))),
        single_(single) {}
  void Hold() {
    before_ = set_ != nullptr && get_ != nullptr ? get_() : single_;
    if (before_ > single_) set_(single_);
  }
  void Release() const {
    if (before_ > single_) set_(before_);
  }

 private:
  void (*set_)(int);
  int (*get_)();
  int single_;
  int before_ = 0;
};

// One thread for its lifetime. With no active parallel level allowed, OpenMP makes every team a team of one, also where
// the code asks for a number of threads. The settings are the process's, so lifetimes on several threads are counted:
// the first one changes them and the last one puts them back.
class SingleThread {
 public:
  explicit SingleThread(bool needed) : needed_(needed) {
    if (!needed_) return;
    Shared& shared = Shared::Get();
    const std::lock_guard<std::mutex> lock(shared.mutex);
    if (shared.users++ > 0) return;
    shared.blas.Hold();
    shared.openmp.Hold();
  }
  ~SingleThread() {
    if (!needed_) return;
    Shared& shared = Shared::Get();
    const std::lock_guard<std::mutex> lock(shared.mutex);
    if (--shared.users > 0) return;
    shared.blas.Release();
    shared.openmp.Release();
  }
  SingleThread(const SingleThread&) = delete;
  SingleThread& operator=(const SingleThread&) = delete;

 private:
  struct Shared {
    std::mutex mutex;
    int users = 0;
    LibrarySetting blas{"openblas_set_num_threads", "openblas_get_num_threads", 1};
    LibrarySetting openmp{"omp_set_max_active_levels", "omp_get_max_active_levels", 0};

    static Shared& Get() {
      static Shared shared;
      return shared;
    }
  };

  const bool needed_;
};

std::string StatusText(int status) {
  static const std::map<int, const char*> texts = {
      {CHOLMOD_OK, "no error"},
      {CHOLMOD_NOT_POSDEF, "a pivot is not positive"},
      {CHOLMOD_DSMALL, "a pivot is tiny"},
      {CHOLMOD_OUT_OF_MEMORY, "out of memory"},
      {CHOLMOD_TOO_LARGE, "the factor has more entries than an int can count"},
      {CHOLMOD_INVALID, "invalid input"},
      {CHOLMOD_NOT_INSTALLED, "the method is not in this CHOLMOD"},
  };
  const auto found = texts.find(status);
  return (found == texts.end() ? "unknown error" : found->second) +
         std::string(" (CHOLMOD status " + std::to_string(status) + ")");
}

// A matrix as CHOLMOD sees it, which takes what it only reads as non-const. values: CHOLMOD_REAL or CHOLMOD_PATTERN;
// storage: -1: the lower triangle of a symmetric matrix, 0: all of it.
cholmod_sparse ViewOf(const CholmodFactor::ColumnMatrix& matrix, int values, int storage) {
  cholmod_sparse view{};
  view.nrow = static_cast<size_t>(matrix.rows());
  view.ncol = static_cast<size_t>(matrix.cols());
  view.nzmax = static_cast<size_t>(matrix.nonZeros());
  view.p = const_cast<int*>(matrix.outerIndexPtr());
  view.i = const_cast<int*>(matrix.innerIndexPtr());
  if (values == CHOLMOD_REAL) view.x = const_cast<double*>(matrix.valuePtr());
  view.stype = storage;
  view.itype = CHOLMOD_INT;
  view.xtype = values;
  view.dtype = CHOLMOD_DOUBLE;
  view.sorted = 1;
  view.packed = 1;
  return view;
}

// Silent, and freed with the scope.
struct Common {
  cholmod_common common{};
  Common() {
    cholmod_start(&common);
    common.print = 0;
  }
  ~Common() { cholmod_finish(&common); }
  Common(const Common&) = delete;
  Common& operator=(const Common&) = delete;
};

// The elimination tree of a matrix whose lower triangle it is; empty where there is no memory for it.
Eigen::VectorXi EliminationTree(cholmod_sparse lower, int* order, cholmod_common* common) {
  Eigen::VectorXi parent(static_cast<Eigen::Index>(lower.ncol));
  cholmod_sparse* upper = cholmod_ptranspose(&lower, 0, order, nullptr, 0, common);
  if (upper == nullptr || cholmod_etree(upper, parent.data(), common) == 0) parent.resize(0);
  cholmod_free_sparse(&upper, common);
  return parent;
}

cholmod_dense Wrap(Eigen::Index n, double* values) {
  cholmod_dense dense{};
  dense.nrow = static_cast<size_t>(n);
  dense.ncol = 1;
  dense.nzmax = dense.nrow;
  dense.d = dense.nrow;
  dense.x = values;
  dense.xtype = CHOLMOD_REAL;
  dense.dtype = CHOLMOD_DOUBLE;
  return dense;
}

}  // namespace

struct CholmodFactor::State {
  cholmod_common common{};
  ColumnMatrix lower;
  cholmod_sparse view{};  // of `lower`
  Eigen::VectorXi diagonal;
  cholmod_factor* factor = nullptr;
  cholmod_dense* solution = nullptr;
  cholmod_dense* y_workspace = nullptr;
  cholmod_dense* e_workspace = nullptr;
  Eigen::VectorXd right_side;
  double flops = 0;
  double fill = 0;
  bool positive_definite = true;
  std::string why;

  State() { cholmod_start(&common); }
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    Free();
    cholmod_finish(&common);
  }
  void Free() {
    cholmod_free_dense(&solution, &common);
    cholmod_free_dense(&y_workspace, &common);
    cholmod_free_dense(&e_workspace, &common);
    cholmod_free_factor(&factor, &common);
  }
};

CholmodFactor::CholmodFactor() : state_(std::make_unique<State>()) {
  cholmod_common& common = state_->common;
  common.print = 0;  // an error is a status, never a line on the terminal
  common.error_handler = nullptr;
  // One ordering method, which Analyze chooses, keeps the set-up cheap and independent of how CHOLMOD was built (METIS
  // or not).
  common.nmethods = 1;
  common.quick_return_if_not_posdef = 1;
  // Supernodes of up to these columns may take in zeros: twice CHOLMOD's own numbers, as the factors of contact
  // problems in the plane have narrow supernodes. 10 to 25 % less time at 10^5 rows.
  common.nrelax[0] = 8;
  common.nrelax[1] = 32;
  common.nrelax[2] = 96;
}

CholmodFactor::~CholmodFactor() = default;

void CholmodFactor::Analyze(Definiteness definiteness, const ColumnMatrix& lower, const Eigen::VectorXi& order) {
  if (order.size() == 0) return AnalyzeBy(definiteness, lower, CHOLMOD_AMD, nullptr);
  if (order.size() != lower.cols()) throw std::runtime_error("symbolic analysis: " + StatusText(CHOLMOD_INVALID));
  AnalyzeBy(definiteness, lower, CHOLMOD_GIVEN, order.data());
}

void CholmodFactor::AnalyzeAsOrdered(const ColumnMatrix& lower) {
  AnalyzeBy(Definiteness::kPositiveDefinite, lower, CHOLMOD_NATURAL, nullptr);
}

void CholmodFactor::AnalyzeBy(Definiteness definiteness, const ColumnMatrix& lower, int ordering, const int* order) {
  ++WorkCounts::OfThread().analyses;
  State& s = *state_;
  const SingleThread one(true);
  s.Free();
  s.lower = lower;
  s.lower.makeCompressed();
  const Eigen::Index n = s.lower.cols();
  s.diagonal.resize(n);
  for (Eigen::Index j = 0; j < n; ++j) s.diagonal[j] = s.lower.outerIndexPtr()[j];
  s.view = ViewOf(s.lower, CHOLMOD_REAL, -1);
  s.positive_definite = definiteness == Definiteness::kPositiveDefinite;
  s.common.supernodal = s.positive_definite ? CHOLMOD_AUTO : CHOLMOD_SIMPLICIAL;
  s.common.method[0].ordering = ordering;
  s.common.postorder = ordering == CHOLMOD_NATURAL ? 0 : 1;
  // CHOLMOD takes the order as non-const and only reads it.
  s.factor = cholmod_analyze_p(&s.view, const_cast<int*>(order), nullptr, 0, &s.common);
  if (s.factor == nullptr || s.common.status < CHOLMOD_OK) {
    throw std::runtime_error("symbolic analysis: " + StatusText(s.common.status));
  }
  s.flops = s.common.fl;
  s.fill = s.common.lnz;
  // Supernodes hold numbers only, a factor by columns has an index beside each. Factorize holds no more for long.
  const double entry = s.factor->is_super != 0 ? sizeof(double) : sizeof(double) + sizeof(int);
  const double entries = s.factor->is_super != 0 ? static_cast<double>(s.factor->xsize) : s.fill;
  try {
    RequireMemory(entries * entry, "the factor");
  } catch (const MemoryRefusal&) {
    s.Free();  // TakeValues must not take it for one that may be filled
    throw;
  }
  s.right_side.resize(n);
}

bool CholmodFactor::TakeValues(const ColumnMatrix& lower) {
  State& s = *state_;
  const Eigen::Index columns = lower.cols();
  if (s.factor == nullptr || !lower.isCompressed() || columns != s.lower.cols() ||
      lower.nonZeros() != s.lower.nonZeros() ||
      !std::equal(lower.outerIndexPtr(), lower.outerIndexPtr() + columns + 1, s.lower.outerIndexPtr()) ||
      !std::equal(lower.innerIndexPtr(), lower.innerIndexPtr() + lower.nonZeros(), s.lower.innerIndexPtr())) {
    return false;
  }
  std::copy(lower.valuePtr(), lower.valuePtr() + lower.nonZeros(), s.lower.valuePtr());
  return true;
}

Eigen::Index CholmodFactor::size() const { return state_->lower.cols(); }
double CholmodFactor::flops() const { return state_->flops; }
double CholmodFactor::fill() const { return state_->fill; }
const std::string& CholmodFactor::why() const { return state_->why; }

void CholmodFactor::SetDiagonal(Eigen::Index i, double value) { state_->lower.valuePtr()[state_->diagonal[i]] = value; }

const int* CholmodFactor::column_starts() const { return state_->lower.outerIndexPtr(); }
const int* CholmodFactor::row_indices() const { return state_->lower.innerIndexPtr(); }
double* CholmodFactor::values() { return state_->lower.valuePtr(); }

bool CholmodFactor::Factorize() {
  const FactorClock::Scope clock;
  State& s = *state_;
  if (s.factor->is_super != 0) RequireBlasMemory();
  const SingleThread one(s.factor->is_super != 0);
  s.common.status = CHOLMOD_OK;
  const int done = cholmod_factorize(&s.view, s.factor, &s.common);
  if (done != 0 && s.common.status == CHOLMOD_OK && s.factor->minor == s.factor->n) return true;
  s.why = "numeric factorization: " + StatusText(s.common.status);
  return false;
}

void CholmodFactor::Solve(const Eigen::VectorXd& r, Eigen::VectorXd* x) {
  State& s = *state_;
  const SingleThread one(s.factor->is_super != 0);
  s.right_side = r;
  cholmod_dense right_side = Wrap(s.right_side.size(), s.right_side.data());
  const int done = cholmod_solve2(CHOLMOD_A, s.factor, &right_side, nullptr, &s.solution, nullptr, &s.y_workspace,
                                  &s.e_workspace, &s.common);
  if (done == 0) throw std::runtime_error("triangular solve: " + StatusText(s.common.status));
  *x = Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(s.solution->x), s.right_side.size());
}

Eigen::VectorXi OrderGraph(const CholmodFactor::ColumnMatrix& graph, GraphOrder order) {
  const Eigen::Index n = graph.cols();
  Eigen::VectorXi nodes(n);
  if (n == 0) return nodes;
  Common c;
  cholmod_sparse pattern = ViewOf(graph, CHOLMOD_PATTERN, -1);
  const int ordered = order == GraphOrder::kMinimumDegree
                          ? cholmod_amd(&pattern, nullptr, 0, nodes.data(), &c.common)
                          : cholmod_metis(&pattern, nullptr, 0, /*postorder=*/0, nodes.data(), &c.common);
  if (ordered == 0) return {};
  const Eigen::VectorXi parent = EliminationTree(pattern, nodes.data(), &c.common);
  Eigen::VectorXi post(n);
  if (parent.size() != n || cholmod_postorder(const_cast<int*>(parent.data()), static_cast<size_t>(n), nullptr,
                                              post.data(), &c.common) != n) {
    return {};
  }
  return nodes(post);
}

}  // namespace lcpbench
