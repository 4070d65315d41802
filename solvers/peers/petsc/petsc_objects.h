#pragma once

#include <petscsnes.h>
#include <petsctao.h>

#include <string>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// PETSc has a name of its own for it since release 3.19 only.
inline constexpr PetscErrorCode kPetscSuccess{};

/// @throws std::runtime_error with PETSc's own words where `code` is an error
void CheckPetsc(PetscErrorCode code);

/// Starts PETSc, with MPI, for this process alone: no launcher, no options from files or the environment, no signal
/// handlers (a crash shall look like one), nothing printed. It ends with the process.
void StartPetsc();
/// "3.18.5", as the library says
std::string PetscVersion();

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

/// w = A x + b with bounds: lower 0, or minus infinity for bilateral rows, upper infinity. A is the problem's own in
/// compressed rows, which nobody writes to. Methods write into the matrix they are given, so that each evaluation of
/// the Jacobian copies A anew.
class PetscProblem {
 public:
  explicit PetscProblem(const LcpProblem& problem);
  /// b, of a problem with the same matrix.
  void SetB(const Eigen::VectorXd& b);

  Vec lower() const { return lower_.get(); }
  Vec upper() const { return upper_.get(); }
  /// Where methods put their iterate, their w, and their own copy of A.
  Vec x() const { return x_.get(); }
  Vec w() const { return w_.get(); }
  Mat jacobian() const { return jacobian_.get(); }

  /// w = A x + b
  PetscErrorCode EvaluateW(Vec x, Vec w) const;
  /// 1/2 x'A x + b'x, and its gradient w = A x + b
  PetscErrorCode EvaluateObjective(Vec x, PetscReal* value, Vec w) const;
  PetscErrorCode FillJacobian(Mat jacobian) const;

  /// f as it is, or zeros where there is none, within the bounds.
  void SetStart(const Eigen::VectorXd* f);
  void GetIterate(Eigen::VectorXd* f) const;

 private:
  LcpProblem problem_;  // keeps the entries of A_
  PetscMatrix A_;
  PetscMatrix jacobian_;
  PetscVector b_;
  PetscVector lower_;
  PetscVector upper_;
  PetscVector x_;
  PetscVector w_;
};

}  // namespace lcpbench
