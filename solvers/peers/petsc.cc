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

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "solvers/library_threads.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/petsc_objects.h"
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

/// What both families share: conversion, limits, and what a claim is worth.
class PetscPeer : public LcpSolver {
 public:
  PetscPeer(const Method& method, double tolerance) : method_(method), tolerance_(tolerance) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override { problem_.emplace(problem); }

  double Tolerance(const LcpOptions& options) const {
    return tolerance_ > 0 ? tolerance_ : TierValue(method_.key, "tolerance", options.tolerance);
  }

  Method method_;
  double tolerance_;  // 0: by the table of tier_settings.cc
  std::optional<PetscProblem> problem_;
};

class Snes : public PetscPeer {
 public:
  using PetscPeer::PetscPeer;

 protected:
  void DoSolve(const LcpProblem& /*problem*/, const LcpOptions& options, LcpResult* result) override {
    const Deadline deadline(options);
    Run run{*problem_, deadline};
    PetscHandle<SNES, &SNESDestroy> snes;
    TimeConversion(result, [&] {
      SetUp(options, &run, &snes);
      problem_->SetStart(options.initial_f);
    });
    PetscErrorCode code = kPetscSuccess;
    TimeLibraryCall(result, [&] { code = SNESSolve(snes.get(), nullptr, problem_->x()); });
    CheckPetsc(code);
    TimeConversion(result, [&] { problem_->GetIterate(&result->f); });
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
    WatchTime(krylov, run);
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
  void DoSolve(const LcpProblem& /*problem*/, const LcpOptions& options, LcpResult* result) override {
    const Deadline deadline(options);
    Run run{*problem_, deadline};
    PetscHandle<Tao, &TaoDestroy> tao;
    TimeConversion(result, [&] {
      SetUp(options, &run, &tao);
      problem_->SetStart(options.initial_f);
    });
    PetscErrorCode code = kPetscSuccess;
    TimeLibraryCall(result, [&] { code = TaoSolve(tao.get()); });
    CheckPetsc(code);
    TimeConversion(result, [&] { problem_->GetIterate(&result->f); });
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
    if (krylov != nullptr) WatchTime(krylov, run);
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

template <typename Solver, const Method& kMethod>
std::unique_ptr<LcpSolver> Make(const Settings& settings) {
  SettingsReader reader(kMethod.key, settings);
  const double tolerance = kMethod.as_the_library_has_it ? 0 : reader.Number("tolerance", 0, 0, 1);
  reader.Finish();
  return std::make_unique<Solver>(kMethod, tolerance);
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
