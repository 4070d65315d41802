// PETSc: SNES's two solvers for variational inequalities (reduced space, semismooth) and TAO's semismooth one (active
// set, feasible) on w = A f + b, and TAO's two trust-region methods on its quadratic program min 1/2 f'A f + b'f, all
// with bounds, so that bilateral rows are variables without a lower bound. A is sparse; the QP asks for a symmetric
// one. Time is read at every outer and every Krylov iteration. Iterations are outer ones. docs/peers.md has what is
// known of release 3.18.

#include <fcntl.h>
#include <petscsnes.h>
#include <petsctao.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <initializer_list>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/loaded_blas.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

// PETSc has a name of its own for it since release 3.19 only.
constexpr PetscErrorCode kPetscSuccess{};

PetscErrorCode PrintNothing(const char* /*format*/, ...) { return kPetscSuccess; }

/// @throws std::runtime_error with PETSc's own words where `code` is an error
void CheckPetsc(PetscErrorCode code) {
  if (code == kPetscSuccess) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw std::runtime_error("PETSc: error " + std::to_string(static_cast<int>(code)) + ", " +
                           (text != nullptr ? text : "unknown"));
}

// Without a launcher every process takes the same folder in /tmp, makes it at its start and removes it at its end:
// workers do so one at a time. The lock is on the program's own file, and ends with the process.
class StartLock {
 public:
  StartLock() : file_(open("/proc/self/exe", O_RDONLY | O_CLOEXEC)) { flock(file_, LOCK_EX); }
  ~StartLock() { close(file_); }
  StartLock(const StartLock&) = delete;
  StartLock& operator=(const StartLock&) = delete;

 private:
  int file_;
};

struct Ending {
  ~Ending() {
    const StartLock lock;
    PetscFinalize();
  }
};

// Starts PETSc, with MPI, for this process alone: no launcher, no options from files or the environment, no signal
// handlers (a crash shall look like one), nothing printed. It ends with the process.
void StartPetsc() {
  // Without a launcher, OpenMPI would start a daemon of its own to talk to, and look for networks (0.3 s).
  setenv("OMPI_MCA_ess_singleton_isolated", "1", 1);
  setenv("OMPI_MCA_pml", "ob1", 1);
  setenv("OMPI_MCA_btl", "self", 1);
  unsetenv("PETSC_OPTIONS");
  // Standard output belongs to the protocol.
  const int out = dup(STDOUT_FILENO);
  dup2(STDERR_FILENO, STDOUT_FILENO);
  std::array<std::string, 3> words{"worker", "-skip_petscrc", "-no_signal_handler"};
  std::array<char*, 4> arguments{words[0].data(), words[1].data(), words[2].data(), nullptr};
  int count = static_cast<int>(words.size());
  char** list = arguments.data();
  PetscErrorPrintf = &PrintNothing;
  const PetscErrorCode code = [&] {
    const StartLock lock;
    return PetscInitialize(&count, &list, nullptr, nullptr);
  }();
  dup2(out, STDOUT_FILENO);
  close(out);
  CheckPetsc(code);
  static const Ending ending;
  CheckPetsc(PetscPushErrorHandler(&PetscReturnErrorHandler, nullptr));
}

std::string PetscVersion() {
  PetscInt major = 0;
  PetscInt minor = 0;
  PetscInt subminor = 0;
  CheckPetsc(PetscGetVersionNumber(&major, &minor, &subminor, nullptr));
  return std::to_string(major) + "." + std::to_string(minor) + "." + std::to_string(subminor);
}

/// Owns a PETSc object.
template <typename Object, PetscErrorCode (*kDestroy)(Object*)>
class PetscHandle {
 public:
  PetscHandle() = default;
  ~PetscHandle() { kDestroy(&object_); }
  PetscHandle(const PetscHandle&) = delete;
  PetscHandle& operator=(const PetscHandle&) = delete;
  Object get() const { return object_; }
  /// For PETSc's functions that make an object.
  Object* out() {
    kDestroy(&object_);
    return &object_;
  }

 private:
  Object object_ = nullptr;
};
using PetscMatrix = PetscHandle<Mat, &MatDestroy>;
using PetscVector = PetscHandle<Vec, &VecDestroy>;

void Fill(Vec vector, const Eigen::VectorXd& values) {
  PetscScalar* data = nullptr;
  CheckPetsc(VecGetArrayWrite(vector, &data));
  std::copy(values.begin(), values.end(), data);
  CheckPetsc(VecRestoreArrayWrite(vector, &data));
}

/// w = A x + b with bounds: lower 0, or minus infinity for bilateral rows, upper infinity. A is the problem's own in
/// compressed rows, which nobody writes to. Methods write into the matrix they are given, so that each evaluation of
/// the Jacobian copies A anew.
class PetscProblem {
 public:
  explicit PetscProblem(const LcpProblem& problem) : problem_(problem) {
    const auto n = static_cast<PetscInt>(problem.size());
    const SparseMatrix& A = problem.SparseA();
    // The Jacobian, and what methods make of it: the part of the free rows, its factor.
    RequireSparseMatrices(n, static_cast<double>(A.nonZeros()), 4);
    // PETSc takes arrays that it could write to.
    const auto writable = [](const auto* values) {
      return const_cast<std::remove_const_t<std::remove_pointer_t<decltype(values)>>*>(values);  // NOLINT
    };
    static_assert(std::is_same_v<PetscInt, int>);
    CheckPetsc(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, writable(A.outerIndexPtr()),
                                         writable(A.innerIndexPtr()), writable(A.valuePtr()), A_.out()));
    if (problem.IsNumericallySymmetric()) CheckPetsc(MatSetOption(A_.get(), MAT_SYMMETRIC, PETSC_TRUE));
    CheckPetsc(MatDuplicate(A_.get(), MAT_COPY_VALUES, jacobian_.out()));
    for (PetscVector* vector : {&b_, &lower_, &upper_, &x_, &w_}) {
      CheckPetsc(VecCreateSeq(PETSC_COMM_SELF, n, vector->out()));
    }
    Eigen::VectorXd lower = Eigen::VectorXd::Zero(n);
    for (const Index row : problem.bilateral_rows()) lower[row] = PETSC_NINFINITY;
    Fill(lower_.get(), lower);
    CheckPetsc(VecSet(upper_.get(), PETSC_INFINITY));
  }

  /// b, of a problem with the same matrix.
  void SetB(const Eigen::VectorXd& b) { Fill(b_.get(), b); }

  Vec lower() const { return lower_.get(); }
  Vec upper() const { return upper_.get(); }
  /// Where methods put their iterate, their w, and their own copy of A.
  Vec x() const { return x_.get(); }
  Vec w() const { return w_.get(); }
  Mat jacobian() const { return jacobian_.get(); }

  /// w = A x + b
  PetscErrorCode EvaluateW(Vec x, Vec w) const { return MatMultAdd(A_.get(), x, b_.get(), w); }

  /// 1/2 x'A x + b'x, and its gradient w = A x + b
  PetscErrorCode EvaluateObjective(Vec x, PetscReal* value, Vec w) const {
    PetscFunctionBegin;
    PetscReal along_w = 0;
    PetscReal along_b = 0;
    constexpr PetscReal kHalf = 0.5;
    PetscCall(EvaluateW(x, w));
    PetscCall(VecDot(w, x, &along_w));
    PetscCall(VecDot(b_.get(), x, &along_b));
    *value = kHalf * (along_w + along_b);
    PetscFunctionReturn(kPetscSuccess);
  }

  PetscErrorCode FillJacobian(Mat jacobian) const { return MatCopy(A_.get(), jacobian, SAME_NONZERO_PATTERN); }

  /// f as it is, or zeros where there is none, within the bounds.
  void SetStart(const Eigen::VectorXd* f) {
    if (f == nullptr) {
      CheckPetsc(VecZeroEntries(x_.get()));
      return;
    }
    Fill(x_.get(), *f);
    CheckPetsc(VecPointwiseMax(x_.get(), x_.get(), lower_.get()));
  }

  void GetIterate(Eigen::VectorXd* f) const {
    const PetscScalar* data = nullptr;
    CheckPetsc(VecGetArrayRead(x_.get(), &data));
    std::copy(data, data + f->size(), f->begin());
    CheckPetsc(VecRestoreArrayRead(x_.get(), &data));
  }

 private:
  LcpProblem problem_;  // keeps the entries of A_
  PetscMatrix A_, jacobian_;
  PetscVector b_, lower_, upper_, x_, w_;
};

// What the callbacks of one solve see.
struct Run {
  const PetscProblem& problem;
  const Deadline& deadline;
  bool expired = false;

  bool Expired() {
    expired = expired || deadline.Expired();
    return expired;
  }
  static Run& Of(void* context) { return *static_cast<Run*>(context); }
};

PetscErrorCode TestKrylov(KSP krylov, PetscInt iteration, PetscReal norm, KSPConvergedReason* reason, void* context) {
  auto& [run, usual] = *static_cast<std::pair<Run*, void*>*>(context);
  PetscFunctionBegin;
  PetscCall(KSPConvergedDefault(krylov, iteration, norm, reason, usual));
  if (*reason == KSP_CONVERGED_ITERATING && run->Expired()) *reason = KSP_DIVERGED_ITS;
  PetscFunctionReturn(kPetscSuccess);
}

PetscErrorCode ForgetKrylov(void* context) {
  const std::unique_ptr<std::pair<Run*, void*>> own(static_cast<std::pair<Run*, void*>*>(context));
  return KSPConvergedDefaultDestroy(own->second);
}

void WatchTime(KSP krylov, Run* run) {
  auto context = std::make_unique<std::pair<Run*, void*>>(run, nullptr);
  CheckPetsc(KSPConvergedDefaultCreate(&context->second));
  CheckPetsc(KSPSetConvergenceTest(krylov, &TestKrylov, context.release(), &ForgetKrylov));
}

std::string OrEmpty(std::string choice) { return choice == "library" ? std::string() : std::move(choice); }

/// What both families share: conversion, limits, and what a claim is worth.
class PetscPeer : public LcpSolver {
 public:
  PetscPeer(std::string_view key, const char* type, SettingsReader* reader) : type_(type), tier_(key, reader) {}

 protected:
  // How the library's call ended.
  struct Outcome {
    PetscInt iterations = 0;
    bool solved = false;
    bool iteration_limit = false;
    const char* reason = "";
  };

  virtual void SetUp(const LcpOptions& options, Run* run) = 0;
  virtual PetscErrorCode Call() = 0;
  virtual Outcome ReadAndRelease() = 0;

  void DoPrepare(const LcpProblem& problem) override {
    problem_.emplace(problem);
    if (shift_ > 0) largest_diagonal_ = problem.DiagonalA().cwiseAbs().maxCoeff();
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    const Deadline deadline(options);
    Run run{*problem_, deadline};
    TimeConversion(options, result, [&] {
      norm_b_ = problem.b().norm();
      SetUp(options, &run);
      problem_->SetB(problem.b());
      problem_->SetStart(options.initial_f);
    });
    PetscErrorCode code = kPetscSuccess;
    TimeLibraryCall(options, result, [&] { code = Call(); });
    CheckPetsc(code);
    TimeConversion(options, result, [&] { problem_->GetIterate(&result->f); });
    const Outcome outcome = ReadAndRelease();
    result->iterations = outcome.iterations;
    if (outcome.solved) {
      result->status = LcpStatus::kSolved;
    } else if (run.expired) {
      result->status = LcpStatus::kTimeLimit;
    } else if (outcome.iteration_limit) {
      result->status = LcpStatus::kIterationLimit;
    } else {
      result->detail = std::string("PETSc: ") + outcome.reason;
    }
  }

  void SetUpLinearSolver(KSP krylov, Run* run) const {
    if (!krylov_.empty()) CheckPetsc(KSPSetType(krylov, krylov_.c_str()));
    PC preconditioner = nullptr;
    CheckPetsc(KSPGetPC(krylov, &preconditioner));
    if (!preconditioner_.empty()) CheckPetsc(PCSetType(preconditioner, preconditioner_.c_str()));
    if (shift_ > 0) {
      CheckPetsc(PCFactorSetShiftType(preconditioner, MAT_SHIFT_NONZERO));
      CheckPetsc(PCFactorSetShiftAmount(preconditioner, shift_ * largest_diagonal_));
    }
    WatchTime(krylov, run);
  }

  const char* type_;  // of PETSc
  PeerTier tier_;
  // Empty: the library's own choice.
  std::string krylov_;
  std::string preconditioner_;
  double shift_ = 0;  // of the pivots of a preconditioner that is a factorization
  double largest_diagonal_ = 0;
  double norm_b_ = 0;
  std::optional<PetscProblem> problem_;
};

// For keys that end in "-direct": the value with the most passes among the tuning problems.
constexpr double kDirectShift = 1e-8;

class Snes : public PetscPeer {
 public:
  Snes(std::string_view key, const char* type, SettingsReader* reader) : PetscPeer(key, type, reader) {
    if (tier_.is_library_default()) return;
    // "cg-icc" is conjugate gradients with incomplete Cholesky; a factorization alone needs no Krylov method.
    const bool is_direct = key.ends_with("-direct");
    const bool is_symmetric = key.starts_with("petsc-rsls");  // its linear systems
    std::string choice;
    if (is_direct) {
      choice = is_symmetric ? reader->Choice("linear_solver", "lu", {"lu", "cholesky"}) : "lu";
    } else if (is_symmetric) {
      choice = reader->Choice(
          "linear_solver", "library",
          {"library", "lu", "gmres-jacobi", "bcgs-ilu", "cholesky", "cg-jacobi", "cg-icc", "minres-jacobi"});
    } else {
      choice = reader->Choice("linear_solver", "library", {"library", "lu", "gmres-jacobi", "bcgs-ilu"});
    }
    const auto dash = choice.find('-');
    if (choice != "library") {
      krylov_ = dash == std::string::npos ? KSPPREONLY : choice.substr(0, dash);
      preconditioner_ = dash == std::string::npos ? choice : choice.substr(dash + 1);
    }
    shift_ = reader->Number("shift", is_direct ? kDirectShift : 0, 0, 1);
    if (preconditioner_ == PCJACOBI) shift_ = 0;
    if (shift_ > 0 && preconditioner_.empty()) preconditioner_ = PCILU;  // the library's own
    line_search_ = OrEmpty(reader->Choice("line_search", "library", {"library", "bt", "basic", "l2", "cp"}));
  }

 protected:
  void SetUp(const LcpOptions& options, Run* run) override {
    CheckPetsc(SNESCreate(PETSC_COMM_SELF, snes_.out()));
    const SNES made = snes_.get();
    const auto evaluate = [](SNES, Vec x, Vec w, void* context) { return Run::Of(context).problem.EvaluateW(x, w); };
    const auto fill = [](SNES, Vec, Mat jacobian, Mat, void* context) {
      return Run::Of(context).problem.FillJacobian(jacobian);
    };
    CheckPetsc(SNESSetType(made, type_));
    CheckPetsc(SNESSetFunction(made, problem_->w(), evaluate, run));
    CheckPetsc(SNESSetJacobian(made, problem_->jacobian(), problem_->jacobian(), fill, run));
    CheckPetsc(SNESVISetVariableBounds(made, problem_->lower(), problem_->upper()));
    CheckPetsc(SNESSetFromOptions(made));
    CheckPetsc(SNESSetConvergenceTest(made, &Test, run, nullptr));
    KSP krylov = nullptr;
    CheckPetsc(SNESGetKSP(made, &krylov));
    SetUpLinearSolver(krylov, run);
    if (!line_search_.empty()) {
      SNESLineSearch search = nullptr;
      CheckPetsc(SNESGetLineSearch(made, &search));
      CheckPetsc(SNESLineSearchSetType(search, line_search_.c_str()));
    }
    if (!tier_.is_library_default()) {
      CheckPetsc(SNESSetTolerances(made, PETSC_DEFAULT, tier_.Tolerance(options), PETSC_DEFAULT,
                                   tier_.Iterations(options), std::numeric_limits<int>::max()));
    } else if (options.max_iterations > 0) {
      CheckPetsc(SNESSetTolerances(made, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, IterationLimit(options, 0),
                                   PETSC_DEFAULT));
    }
  }
  PetscErrorCode Call() override { return SNESSolve(snes_.get(), nullptr, problem_->x()); }
  Outcome ReadAndRelease() override {
    Outcome outcome;
    SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
    CheckPetsc(SNESGetIterationNumber(snes_.get(), &outcome.iterations));
    CheckPetsc(SNESGetConvergedReason(snes_.get(), &reason));
    outcome.solved = reason > 0 && reason != SNES_CONVERGED_ITS;
    outcome.iteration_limit = reason == SNES_DIVERGED_MAX_IT || reason == SNES_CONVERGED_ITS;
    outcome.reason = SNESConvergedReasons[reason];
    snes_.out();
    return outcome;
  }

 private:
  static PetscErrorCode Test(SNES snes, PetscInt iteration, PetscReal x_norm, PetscReal step_norm, PetscReal f_norm,
                             SNESConvergedReason* reason, void* context) {
    PetscFunctionBegin;
    PetscCall(SNESConvergedDefault(snes, iteration, x_norm, step_norm, f_norm, reason, nullptr));
    if (*reason == SNES_CONVERGED_ITERATING && Run::Of(context).Expired()) *reason = SNES_DIVERGED_MAX_IT;
    PetscFunctionReturn(kPetscSuccess);
  }

  std::string line_search_;
  PetscHandle<SNES, &SNESDestroy> snes_;
};

class TaoPeer : public PetscPeer {
 public:
  TaoPeer(std::string_view key, const char* type, SettingsReader* reader)
      : PetscPeer(key, type, reader), is_program_(!key.starts_with("tao-asfls")) {
    if (tier_.is_library_default()) return;
    if (!is_program_) {
      krylov_ = KSPPREONLY;
      preconditioner_ = PCLU;
      shift_ = kDirectShift;
      return;
    }
    krylov_ = OrEmpty(reader->Choice("krylov", "library", {"library", "stcg", "nash", "gltr"}));
    preconditioner_ = OrEmpty(reader->Choice("preconditioner", "library", {"library", "none", "jacobi", "icc"}));
    // Some options have no function, only a name, once for the process.
    const auto set = [](const char* option, const std::string& value, std::string_view usual) {
      if (value != usual) CheckPetsc(PetscOptionsSetValue(nullptr, option, value.c_str()));
    };
    const auto choose = [&](const char* name, const char* option, std::initializer_list<std::string_view> choices) {
      set(option, reader->Choice(name, *choices.begin(), choices), *choices.begin());
    };
    if (key == "tao-bntr") {
      choose("first_radius", "-tao_bnk_init_type", {"interpolation", "constant", "direction"});
      choose("radius", "-tao_bnk_update_type", {"reduction", "interpolation"});
      choose("active_set", "-tao_bnk_as_type", {"bertsekas", "none"});
    } else {
      const int projections = static_cast<int>(reader->Number("projections", 3, 1, 1000));
      set("-tao_tron_maxgpits", std::to_string(projections), "3");
    }
  }

  std::string WhyUnsupported(const LcpProblem& problem) const override {
    return is_program_ ? WhyNotQuadraticProgram(problem) : "";
  }

 protected:
  void SetUp(const LcpOptions& options, Run* run) override {
    CheckPetsc(TaoCreate(PETSC_COMM_SELF, tao_.out()));
    const Tao made = tao_.get();
    const auto evaluate = [](Tao, Vec x, PetscReal* value, Vec w, void* context) {
      return Run::Of(context).problem.EvaluateObjective(x, value, w);
    };
    const auto fill = [](Tao, Vec, Mat hessian, Mat, void* context) {
      return Run::Of(context).problem.FillJacobian(hessian);
    };
    CheckPetsc(TaoSetType(made, type_));
    CheckPetsc(TaoSetSolution(made, problem_->x()));
    if (is_program_) {
      CheckPetsc(TaoSetObjectiveAndGradient(made, nullptr, evaluate, run));
      CheckPetsc(TaoSetHessian(made, problem_->jacobian(), problem_->jacobian(), fill, run));
    } else {
      const auto gaps = [](Tao, Vec x, Vec w, void* context) { return Run::Of(context).problem.EvaluateW(x, w); };
      CheckPetsc(TaoSetConstraintsRoutine(made, problem_->w(), gaps, run));
      CheckPetsc(TaoSetJacobianRoutine(made, problem_->jacobian(), problem_->jacobian(), fill, run));
    }
    CheckPetsc(TaoSetVariableBounds(made, problem_->lower(), problem_->upper()));
    CheckPetsc(TaoSetFromOptions(made));
    CheckPetsc(TaoSetConvergenceTest(made, &Test, run));
    KSP krylov = nullptr;
    CheckPetsc(TaoGetKSP(made, &krylov));
    if (krylov != nullptr) SetUpLinearSolver(krylov, run);
    if (!tier_.is_library_default()) {
      // Nothing that has the unit of w or of the objective: only the gradient relative to that at the start, or what a
      // complementarity problem has for an objective.
      CheckPetsc(TaoSetTolerances(made, 0, 0, is_program_ ? tier_.Tolerance(options) : 0));
      if (!is_program_) CheckPetsc(TaoSetFunctionLowerBound(made, tier_.Tolerance(options) * norm_b_));
      CheckPetsc(TaoSetMaximumIterations(made, tier_.Iterations(options)));
      CheckPetsc(TaoSetMaximumFunctionEvaluations(made, std::numeric_limits<int>::max()));
    } else if (options.max_iterations > 0) {
      CheckPetsc(TaoSetMaximumIterations(made, IterationLimit(options, 0)));
    }
  }
  PetscErrorCode Call() override { return TaoSolve(tao_.get()); }
  Outcome ReadAndRelease() override {
    Outcome outcome;
    TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
    CheckPetsc(TaoGetIterationNumber(tao_.get(), &outcome.iterations));
    CheckPetsc(TaoGetConvergedReason(tao_.get(), &reason));
    outcome.solved = reason > 0 && (reason == TAO_CONVERGED_MINF) != is_program_;
    outcome.iteration_limit = reason == TAO_DIVERGED_MAXITS || reason == TAO_DIVERGED_MAXFCN;
    outcome.reason = TaoConvergedReasons[reason];
    tao_.out();
    return outcome;
  }

 private:
  static PetscErrorCode Test(Tao tao, void* context) {
    PetscFunctionBegin;
    PetscCall(TaoDefaultConvergenceTest(tao, nullptr));
    TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
    PetscCall(TaoGetConvergedReason(tao, &reason));
    if (reason == TAO_CONTINUE_ITERATING && Run::Of(context).Expired()) {
      PetscCall(TaoSetConvergedReason(tao, TAO_DIVERGED_USER));
    }
    PetscFunctionReturn(kPetscSuccess);
  }

  const bool is_program_;  // quadratic; else a complementarity problem
  PetscHandle<Tao, &TaoDestroy> tao_;
};

std::unique_ptr<LcpSolver> Make(std::string_view key, SettingsReader* reader) {
  if (key.starts_with("petsc-rsls")) return std::make_unique<Snes>(key, SNESVINEWTONRSLS, reader);
  if (key.starts_with("petsc-ssls")) return std::make_unique<Snes>(key, SNESVINEWTONSSLS, reader);
  if (key.starts_with("tao-asfls")) return std::make_unique<TaoPeer>(key, TAOASFLS, reader);
  return std::make_unique<TaoPeer>(key, key.starts_with("tao-bntr") ? TAOBNTR : TAOTRON, reader);
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  LimitLibraryThreads(1);
  StartPetsc();
  return {PetscVersion(), &Make};
}

}  // namespace lcpbench
