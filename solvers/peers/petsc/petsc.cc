// PETSc: SNES's two solvers for variational inequalities (reduced space, semismooth) on w = A f + b, and TAO's two
// trust-region methods on its quadratic program min 1/2 f'A f + b'f, all with bounds, so that bilateral rows are
// variables without a lower bound. A is sparse.
//
// Known of release 3.18. The semismooth method overwrites the Jacobian, so each evaluation copies A anew. Linear
// systems are solved by the library's own choice of Krylov method and preconditioner, which fails where A is singular
// and gives up after few failures. TAO's interior point method is left out: with infinite upper bounds it reports
// convergence falsely. Where TAO's objective falls below its bound (an LCP without solution), no ray is told: no claim
// of infeasibility is made of that.
//
// Time is read at every outer and every Krylov iteration. Iterations are outer ones. TAO asks for a symmetric A.
//
// Settings, other than `tolerance` and of keys that do not end in -default; "library" is the library's own choice.
//   SNES  linear-solver: library, lu, gmres-jacobi, bcgs-ilu, and for petsc-rsls, with symmetric systems, cholesky,
//         cg-jacobi, cg-icc, minres-jacobi; shift: what the factorization (lu, cholesky, ilu, icc) adds to a pivot that
//         is too small, as a share of the largest diagonal entry of A, 0 for none (-pc_factor_shift_type nonzero);
//         line-search: library, bt, basic, l2, cp
//   TAO   krylov: library, stcg, nash, gltr; preconditioner: library, none, jacobi, icc; and for tao-bntr first-radius:
//         interpolation, constant, direction (-tao_bnk_init_type), radius: reduction, interpolation
//         (-tao_bnk_update_type), active-set: bertsekas, none (-tao_bnk_as_type), for tao-tron projections: gradient
//         projections an iteration (-tao_tron_maxgpits)

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "solvers/linear_algebra/library_threads.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/petsc/petsc_objects.h"
#include "solvers/peers/tier_settings.h"

namespace lcpbench {
namespace {

struct Method {
  std::string_view key;
  const char* type = nullptr;
  bool as_the_library_has_it = false;
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

int IterationLimit(const LcpOptions& options, double usual) {
  const double most = options.max_iterations > 0 ? static_cast<double>(options.max_iterations) : usual;
  return static_cast<int>(std::min<double>(most, std::numeric_limits<int>::max()));
}

struct Tuning {
  double tolerance = 0;  // 0: by the table of tier_settings.cc
  // Empty: the library's own choice.
  std::string krylov;
  std::string preconditioner;
  std::string line_search;
  double shift = 0;
  bool factors = false;  // the preconditioner is a factorization, with pivots to shift
};

/// What both families share: conversion, limits, and what a claim is worth.
class PetscPeer : public LcpSolver {
 public:
  PetscPeer(const Method& method, Tuning tuning) : method_(method), tuning_(std::move(tuning)) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    problem_.emplace(problem);
    if (tuning_.shift > 0) largest_diagonal_ = problem.DiagonalA().cwiseAbs().maxCoeff();
  }

  double Tolerance(const LcpOptions& options) const {
    return tuning_.tolerance > 0 ? tuning_.tolerance : TierValue(method_.key, "tolerance", options.tolerance);
  }

  void SetUpLinearSolver(KSP krylov) const {
    if (!tuning_.krylov.empty()) CheckPetsc(KSPSetType(krylov, tuning_.krylov.c_str()));
    PC preconditioner = nullptr;
    CheckPetsc(KSPGetPC(krylov, &preconditioner));
    if (!tuning_.preconditioner.empty()) CheckPetsc(PCSetType(preconditioner, tuning_.preconditioner.c_str()));
    if (tuning_.shift > 0 && tuning_.factors) {
      CheckPetsc(PCFactorSetShiftType(preconditioner, MAT_SHIFT_NONZERO));
      CheckPetsc(PCFactorSetShiftAmount(preconditioner, tuning_.shift * largest_diagonal_));
    }
  }

  Method method_;
  Tuning tuning_;
  double largest_diagonal_ = 0;
  std::optional<PetscProblem> problem_;
};

class Snes : public PetscPeer {
 public:
  using PetscPeer::PetscPeer;

 protected:
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    const Deadline deadline(options);
    Run run{*problem_, deadline};
    PetscHandle<SNES, &SNESDestroy> snes;
    TimeConversion(options, result, [&] {
      SetUp(options, &run, &snes);
      problem_->SetB(problem.b());
      problem_->SetStart(options.initial_f);
    });
    PetscErrorCode code = kPetscSuccess;
    TimeLibraryCall(options, result, [&] { code = SNESSolve(snes.get(), nullptr, problem_->x()); });
    CheckPetsc(code);
    TimeConversion(options, result, [&] { problem_->GetIterate(&result->f); });
    PetscInt iterations = 0;
    SNESConvergedReason reason = SNES_CONVERGED_ITERATING;
    CheckPetsc(SNESGetIterationNumber(snes.get(), &iterations));
    CheckPetsc(SNESGetConvergedReason(snes.get(), &reason));
    result->iterations = iterations;
    if (reason > 0 && reason != SNES_CONVERGED_ITS) {
      result->status = LcpStatus::kSolved;
    } else if (run.expired) {
      result->status = LcpStatus::kTimeLimit;
    } else if (reason == SNES_DIVERGED_MAX_IT || reason == SNES_CONVERGED_ITS) {
      result->status = LcpStatus::kIterationLimit;
    } else {
      result->detail = std::string("PETSc: ") + SNESConvergedReasons[reason];
    }
  }

 private:
  static PetscErrorCode EvaluateW(SNES /*snes*/, Vec x, Vec w, void* context) {
    return static_cast<Run*>(context)->problem.EvaluateW(x, w);
  }
  static PetscErrorCode FillJacobian(SNES /*snes*/, Vec /*x*/, Mat jacobian, Mat /*same*/, void* context) {
    return static_cast<Run*>(context)->problem.FillJacobian(jacobian);
  }
  static PetscErrorCode Test(SNES snes, PetscInt iteration, PetscReal x_norm, PetscReal step_norm, PetscReal f_norm,
                             SNESConvergedReason* reason, void* context) {
    PetscFunctionBegin;
    PetscCall(SNESConvergedDefault(snes, iteration, x_norm, step_norm, f_norm, reason, nullptr));
    if (*reason == SNES_CONVERGED_ITERATING && static_cast<Run*>(context)->Expired()) *reason = SNES_DIVERGED_MAX_IT;
    PetscFunctionReturn(kPetscSuccess);
  }

  void SetUp(const LcpOptions& options, Run* run, PetscHandle<SNES, &SNESDestroy>* snes) const {
    CheckPetsc(SNESCreate(PETSC_COMM_SELF, snes->out()));
    const SNES made = snes->get();
    CheckPetsc(SNESSetType(made, method_.type));
    CheckPetsc(SNESSetFunction(made, problem_->w(), &EvaluateW, run));
    CheckPetsc(SNESSetJacobian(made, problem_->jacobian(), problem_->jacobian(), &FillJacobian, run));
    CheckPetsc(SNESVISetVariableBounds(made, problem_->lower(), problem_->upper()));
    CheckPetsc(SNESSetFromOptions(made));
    CheckPetsc(SNESSetConvergenceTest(made, &Test, run, nullptr));
    KSP krylov = nullptr;
    CheckPetsc(SNESGetKSP(made, &krylov));
    SetUpLinearSolver(krylov);
    WatchTime(krylov, run);
    if (!tuning_.line_search.empty()) {
      SNESLineSearch search = nullptr;
      CheckPetsc(SNESGetLineSearch(made, &search));
      CheckPetsc(SNESLineSearchSetType(search, tuning_.line_search.c_str()));
    }
    if (!method_.as_the_library_has_it) {
      const int most = IterationLimit(options, TierValue(method_.key, "iterations", options.tolerance));
      CheckPetsc(SNESSetTolerances(made, PETSC_DEFAULT, Tolerance(options), PETSC_DEFAULT, most,
                                   std::numeric_limits<int>::max()));
    } else if (options.max_iterations > 0) {
      CheckPetsc(SNESSetTolerances(made, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, IterationLimit(options, 0),
                                   PETSC_DEFAULT));
    }
  }
};

class TaoPeer : public PetscPeer {
 public:
  using PetscPeer::PetscPeer;

  std::string WhyUnsupported(const LcpProblem& problem) const override {
    return problem.IsNumericallySymmetric() ? "" : "A is not symmetric, so the LCP is not the optimality of a QP";
  }

 protected:
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    const Deadline deadline(options);
    Run run{*problem_, deadline};
    PetscHandle<Tao, &TaoDestroy> tao;
    TimeConversion(options, result, [&] {
      SetUp(options, &run, &tao);
      problem_->SetB(problem.b());
      problem_->SetStart(options.initial_f);
    });
    PetscErrorCode code = kPetscSuccess;
    TimeLibraryCall(options, result, [&] { code = TaoSolve(tao.get()); });
    CheckPetsc(code);
    TimeConversion(options, result, [&] { problem_->GetIterate(&result->f); });
    PetscInt iterations = 0;
    TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
    CheckPetsc(TaoGetIterationNumber(tao.get(), &iterations));
    CheckPetsc(TaoGetConvergedReason(tao.get(), &reason));
    result->iterations = iterations;
    if (reason > 0 && reason != TAO_CONVERGED_MINF) {
      result->status = LcpStatus::kSolved;
    } else if (run.expired) {
      result->status = LcpStatus::kTimeLimit;
    } else if (reason == TAO_DIVERGED_MAXITS || reason == TAO_DIVERGED_MAXFCN) {
      result->status = LcpStatus::kIterationLimit;
    } else {
      result->detail = std::string("PETSc: ") + TaoConvergedReasons[reason];
    }
  }

 private:
  static PetscErrorCode Evaluate(Tao /*tao*/, Vec x, PetscReal* value, Vec w, void* context) {
    return static_cast<Run*>(context)->problem.EvaluateObjective(x, value, w);
  }
  static PetscErrorCode FillHessian(Tao /*tao*/, Vec /*x*/, Mat hessian, Mat /*same*/, void* context) {
    return static_cast<Run*>(context)->problem.FillJacobian(hessian);
  }
  static PetscErrorCode Test(Tao tao, void* context) {
    PetscFunctionBegin;
    PetscCall(TaoDefaultConvergenceTest(tao, nullptr));
    TaoConvergedReason reason = TAO_CONTINUE_ITERATING;
    PetscCall(TaoGetConvergedReason(tao, &reason));
    if (reason == TAO_CONTINUE_ITERATING && static_cast<Run*>(context)->Expired()) {
      PetscCall(TaoSetConvergedReason(tao, TAO_DIVERGED_USER));
    }
    PetscFunctionReturn(kPetscSuccess);
  }

  void SetUp(const LcpOptions& options, Run* run, PetscHandle<Tao, &TaoDestroy>* tao) const {
    CheckPetsc(TaoCreate(PETSC_COMM_SELF, tao->out()));
    const Tao made = tao->get();
    CheckPetsc(TaoSetType(made, method_.type));
    CheckPetsc(TaoSetSolution(made, problem_->x()));
    CheckPetsc(TaoSetObjectiveAndGradient(made, nullptr, &Evaluate, run));
    CheckPetsc(TaoSetHessian(made, problem_->jacobian(), problem_->jacobian(), &FillHessian, run));
    CheckPetsc(TaoSetVariableBounds(made, problem_->lower(), problem_->upper()));
    CheckPetsc(TaoSetFromOptions(made));
    CheckPetsc(TaoSetConvergenceTest(made, &Test, run));
    KSP krylov = nullptr;
    CheckPetsc(TaoGetKSP(made, &krylov));
    if (krylov != nullptr) {
      SetUpLinearSolver(krylov);
      WatchTime(krylov, run);
    }
    if (!method_.as_the_library_has_it) {
      // Nothing that has the unit of w or of the objective: only the gradient relative to that at the start.
      CheckPetsc(TaoSetTolerances(made, 0, 0, Tolerance(options)));
      CheckPetsc(TaoSetMaximumIterations(
          made, IterationLimit(options, TierValue(method_.key, "iterations", options.tolerance))));
      CheckPetsc(TaoSetMaximumFunctionEvaluations(made, std::numeric_limits<int>::max()));
    } else if (options.max_iterations > 0) {
      CheckPetsc(TaoSetMaximumIterations(made, IterationLimit(options, 0)));
    }
  }
};

constexpr Method kRsls{"petsc-rsls", SNESVINEWTONRSLS};
constexpr Method kRslsDefault{"petsc-rsls-default", SNESVINEWTONRSLS, true};
constexpr Method kSsls{"petsc-ssls", SNESVINEWTONSSLS};
constexpr Method kSslsDefault{"petsc-ssls-default", SNESVINEWTONSSLS, true};
constexpr Method kBntr{"tao-bntr", TAOBNTR};
constexpr Method kBntrDefault{"tao-bntr-default", TAOBNTR, true};
constexpr Method kTron{"tao-tron", TAOTRON};
constexpr Method kTronDefault{"tao-tron-default", TAOTRON, true};

// "cg-icc" is conjugate gradients with incomplete Cholesky; a factorization alone needs no Krylov method.
void SetLinearSolver(const std::string& choice, Tuning* tuning) {
  tuning->factors = true;  // the library's own ILU(0), too
  if (choice == "library") return;
  const auto dash = choice.find('-');
  tuning->krylov = dash == std::string::npos ? KSPPREONLY : choice.substr(0, dash);
  tuning->preconditioner = dash == std::string::npos ? choice : choice.substr(dash + 1);
  tuning->factors = tuning->preconditioner != PCJACOBI;
}

std::string OrEmpty(std::string choice) { return choice == "library" ? std::string() : std::move(choice); }

// Some options of TAO have no function, only a name, once for the process.
void SetByName(const Settings& settings, const std::string& setting, const char* option, const std::string& value) {
  if (settings.contains(setting)) CheckPetsc(PetscOptionsSetValue(nullptr, option, value.c_str()));
}

void ReadSettings(const Method& method, const Settings& settings, SettingsReader* reader, Tuning* tuning) {
  tuning->tolerance = reader->Number("tolerance", 0, 0, 1);
  const std::string_view type = method.type;
  if (type == SNESVINEWTONRSLS || type == SNESVINEWTONSSLS) {
    SetLinearSolver(type == SNESVINEWTONRSLS
                        ? reader->Choice("linear-solver", "library",
                                         {"library", "lu", "gmres-jacobi", "bcgs-ilu", "cholesky", "cg-jacobi",
                                          "cg-icc", "minres-jacobi"})
                        : reader->Choice("linear-solver", "library", {"library", "lu", "gmres-jacobi", "bcgs-ilu"}),
                    tuning);
    tuning->shift = reader->Number("shift", 0, 0, 1);
    if (tuning->shift > 0 && tuning->preconditioner.empty()) tuning->preconditioner = PCILU;  // the library's own
    tuning->line_search = OrEmpty(reader->Choice("line-search", "library", {"library", "bt", "basic", "l2", "cp"}));
    return;
  }
  tuning->krylov = OrEmpty(reader->Choice("krylov", "library", {"library", "stcg", "nash", "gltr"}));
  tuning->preconditioner = OrEmpty(reader->Choice("preconditioner", "library", {"library", "none", "jacobi", "icc"}));
  if (type == TAOBNTR) {
    const std::string first =
        reader->Choice("first-radius", "interpolation", {"interpolation", "constant", "direction"});
    SetByName(settings, "first-radius", "-tao_bnk_init_type", first);
    const std::string radius = reader->Choice("radius", "reduction", {"reduction", "interpolation"});
    SetByName(settings, "radius", "-tao_bnk_update_type", radius);
    const std::string active_set = reader->Choice("active-set", "bertsekas", {"bertsekas", "none"});
    SetByName(settings, "active-set", "-tao_bnk_as_type", active_set);
  } else {
    const int projections = static_cast<int>(reader->Number("projections", 3, 1, 1000));
    SetByName(settings, "projections", "-tao_tron_maxgpits", std::to_string(projections));
  }
}

template <typename Solver, const Method& kMethod>
std::unique_ptr<LcpSolver> Make(const Settings& settings) {
  SettingsReader reader(kMethod.key, settings);
  Tuning tuning;
  if (!kMethod.as_the_library_has_it) ReadSettings(kMethod, settings, &reader, &tuning);
  reader.Finish();
  return std::make_unique<Solver>(kMethod, std::move(tuning));
}

template <typename Solver, const Method& kMethod>
constexpr PeerSolver Entry() {
  return {kMethod.key, &Make<Solver, kMethod>};
}

constexpr std::array kSolvers{
    Entry<Snes, kRsls>(),    Entry<Snes, kRslsDefault>(),    Entry<Snes, kSsls>(),    Entry<Snes, kSslsDefault>(),
    Entry<TaoPeer, kBntr>(), Entry<TaoPeer, kBntrDefault>(), Entry<TaoPeer, kTron>(), Entry<TaoPeer, kTronDefault>()};

}  // namespace

PeerLibrary ThisPeerLibrary() {
  LimitLibraryThreads(1);
  StartPetsc();
  return {PetscVersion(), "BSD-2-Clause", kSolvers};
}

}  // namespace lcpbench
