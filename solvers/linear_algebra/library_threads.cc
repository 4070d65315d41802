#include "solvers/linear_algebra/library_threads.h"

#include <dlfcn.h>

#include <initializer_list>

namespace lcpbench {
namespace {

// Which BLAS is loaded is the system's choice, so its functions are looked up at run time. dlsym gives void*; the
// conversion to a function pointer is what POSIX prescribes.
template <typename Function>
Function Find(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
}

}  // namespace

int LimitLibraryThreads(int threads) {
  using Set = void (*)(int);
  using Get = int (*)();
  for (const char* name : {"openblas_set_num_threads", "omp_set_num_threads"}) {
    if (const auto set = Find<Set>(name)) set(threads);
  }
  const auto get = Find<Get>("openblas_get_num_threads");
  return get == nullptr ? 0 : get();
}

}  // namespace lcpbench
