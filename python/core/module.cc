// The extension lcpbench._core: what Python calls.
#include "python/core/arrays.h"
#include "python/core/derivative.h"
#include "python/core/exact.h"
#include "python/core/functions.h"
#include "python/core/long_work.h"
#include "python/core/problem.h"
#include "python/core/problem_views.h"
#include "python/core/result.h"
#include "python/core/scenes.h"
#include "python/core/solver.h"
#include "python/core/step.h"
#include "solvers/lcp/memory_budget.h"
#include "support/input_error.h"

namespace lcpbench::python {
namespace {

// A caller's mistake is a ValueError, more memory than there is a MemoryError.
void Translate(const std::exception_ptr& thrown, void* /*unused*/) {
  try {
    std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    PyErr_SetString(PyExc_ValueError, error.what());
  } catch (const MemoryRefusal& error) {
    PyErr_SetString(PyExc_MemoryError, error.what());
  }
}

}  // namespace
}  // namespace lcpbench::python

NB_MODULE(_core, module) {
  using namespace lcpbench::python;
  ImportNumpy();
  IsMainThread();
  nb::register_exception_translator(&Translate);
  module.attr("__version__") = LCPBENCH_VERSION;
  module.def(
      "limit_library_threads", &LimitThreads, nb::arg("threads"),
      "Limits the threads of BLAS and OpenMP below the solvers, for the whole process, as the command does: to 1. "
      "Returns how many BLAS reports.");
  BindProblem(module);
  BindProblemViews(module);
  BindScenes(module);
  BindFunctions(module);
  BindResult(module);
  BindSolvers(module);
  BindStep(module);
  BindExact(module);
  BindDerivative(module);
}
