#include "solvers/library_versions.h"

#include <dlfcn.h>

#include <Eigen/Core>

#ifdef LCPBENCH_WITH_SUITESPARSE
#include <cholmod.h>
#endif
#ifdef LCPBENCH_WITH_IPOPT
#include <IpoptConfig.h>
#endif

namespace lcpbench {
namespace {

// The BLAS behind CHOLMOD and MUMPS is the system's choice (Debian alternatives), known only once loaded.
std::string LoadedBlas() {
  using GetConfig = char* (*)();
  // dlsym gives void*; the conversion to a function pointer is what POSIX prescribes.
  if (const auto get_config = reinterpret_cast<GetConfig>(dlsym(RTLD_DEFAULT, "openblas_get_config"))) {
    return get_config();
  }
  void* symbol = dlsym(RTLD_DEFAULT, "dgemm_");
  Dl_info info;
  if (symbol != nullptr && dladdr(symbol, &info) != 0 && info.dli_fname != nullptr) return info.dli_fname;
  return "unknown";
}

}  // namespace

std::vector<std::pair<std::string, std::string>> LibraryVersions() {
  std::vector<std::pair<std::string, std::string>> versions;
  versions.emplace_back("Eigen", std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
                                     std::to_string(EIGEN_MINOR_VERSION));
#ifdef LCPBENCH_WITH_SUITESPARSE
  versions.emplace_back("CHOLMOD", std::to_string(CHOLMOD_MAIN_VERSION) + "." + std::to_string(CHOLMOD_SUB_VERSION) +
                                       "." + std::to_string(CHOLMOD_SUBSUB_VERSION));
#endif
#ifdef LCPBENCH_WITH_IPOPT
  versions.emplace_back("Ipopt", IPOPT_VERSION);
#endif
  versions.emplace_back("BLAS", LoadedBlas());
  return versions;
}

}  // namespace lcpbench
