#include "python/core/long_work.h"

#include <dlfcn.h>

#include "solvers/linear_algebra/loaded_blas.h"

namespace lcpbench::python {
namespace nb = nanobind;

namespace {
std::atomic<int> most_threads = 0;  // 0: not limited
}  // namespace

int LimitThreads(int threads) {
  most_threads = threads;
  return LimitLibraryThreads(threads);
}

void LimitThreadsAgain() {
  // Not that of BLAS, which is of the process and may not change while others are in it.
  static const auto set = reinterpret_cast<void (*)(int)>(dlsym(RTLD_DEFAULT, "omp_set_num_threads"));
  if (most_threads > 0 && set != nullptr) set(most_threads);
}

bool IsMainThread() {
  static const auto main =
      nb::cast<unsigned long>(nb::module_::import_("threading").attr("main_thread")().attr("ident"));
  return PyThread_get_thread_ident() == main;
}

bool HasSignalRaised(void* /*unused*/) {
  const nb::gil_scoped_acquire gil;
  return PyErr_CheckSignals() != 0;
}

}  // namespace lcpbench::python
