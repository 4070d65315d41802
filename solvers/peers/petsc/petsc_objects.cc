#include "solvers/peers/petsc/petsc_objects.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <stdexcept>
#include <type_traits>

namespace lcpbench {
namespace {

PetscErrorCode PrintNothing(const char* /*format*/, ...) { return kPetscSuccess; }

void Fill(Vec vector, const Eigen::VectorXd& values) {
  PetscScalar* data = nullptr;
  CheckPetsc(VecGetArrayWrite(vector, &data));
  std::copy(values.begin(), values.end(), data);
  CheckPetsc(VecRestoreArrayWrite(vector, &data));
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

}  // namespace

void CheckPetsc(PetscErrorCode code) {
  if (code == kPetscSuccess) return;
  const char* text = nullptr;
  PetscErrorMessage(code, &text, nullptr);
  throw std::runtime_error("PETSc: error " + std::to_string(static_cast<int>(code)) + ", " +
                           (text != nullptr ? text : "unknown"));
}

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

PetscProblem::PetscProblem(const LcpProblem& problem) : problem_(problem) {
  const auto n = static_cast<PetscInt>(problem.size());
  const SparseMatrix& A = problem.SparseA();
  // PETSc takes arrays that it could write to.
  const auto writable = [](const auto* values) {
    return const_cast<std::remove_const_t<std::remove_pointer_t<decltype(values)>>*>(values);  // NOLINT
  };
  static_assert(std::is_same_v<PetscInt, int>);
  CheckPetsc(MatCreateSeqAIJWithArrays(PETSC_COMM_SELF, n, n, writable(A.outerIndexPtr()), writable(A.innerIndexPtr()),
                                       writable(A.valuePtr()), A_.out()));
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

void PetscProblem::SetB(const Eigen::VectorXd& b) { Fill(b_.get(), b); }

PetscErrorCode PetscProblem::EvaluateW(Vec x, Vec w) const {
  PetscFunctionBegin;
  PetscCall(MatMultAdd(A_.get(), x, b_.get(), w));
  PetscFunctionReturn(kPetscSuccess);
}

PetscErrorCode PetscProblem::EvaluateObjective(Vec x, PetscReal* value, Vec w) const {
  PetscFunctionBegin;
  PetscReal along_w = 0;
  PetscReal along_b = 0;
  constexpr PetscReal kHalf = 0.5;
  PetscCall(MatMultAdd(A_.get(), x, b_.get(), w));
  PetscCall(VecDot(w, x, &along_w));
  PetscCall(VecDot(b_.get(), x, &along_b));
  *value = kHalf * (along_w + along_b);
  PetscFunctionReturn(kPetscSuccess);
}

PetscErrorCode PetscProblem::FillJacobian(Mat jacobian) const {
  PetscFunctionBegin;
  PetscCall(MatCopy(A_.get(), jacobian, SAME_NONZERO_PATTERN));
  PetscFunctionReturn(kPetscSuccess);
}

void PetscProblem::SetStart(const Eigen::VectorXd* f) {
  if (f == nullptr) {
    CheckPetsc(VecZeroEntries(x_.get()));
    return;
  }
  Fill(x_.get(), *f);
  CheckPetsc(VecPointwiseMax(x_.get(), x_.get(), lower_.get()));
}

void PetscProblem::GetIterate(Eigen::VectorXd* f) const {
  const PetscScalar* data = nullptr;
  CheckPetsc(VecGetArrayRead(x_.get(), &data));
  std::copy(data, data + f->size(), f->begin());
  CheckPetsc(VecRestoreArrayRead(x_.get(), &data));
}

}  // namespace lcpbench
