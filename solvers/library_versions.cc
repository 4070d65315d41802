#include "solvers/library_versions.h"

#include <Eigen/Core>

#ifdef LCPBENCH_WITH_SUITESPARSE
#include <cholmod.h>
#include <klu.h>
#endif
#ifdef LCPBENCH_WITH_IPOPT
#include <IpoptConfig.h>
#endif

#include "solvers/linear_algebra/loaded_blas.h"

namespace lcpbench {

std::vector<std::pair<std::string, std::string>> LibraryVersions() {
  std::vector<std::pair<std::string, std::string>> versions;
  versions.emplace_back("Eigen", std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
                                     std::to_string(EIGEN_MINOR_VERSION));
#ifdef LCPBENCH_WITH_SUITESPARSE
  versions.emplace_back("CHOLMOD", std::to_string(CHOLMOD_MAIN_VERSION) + "." + std::to_string(CHOLMOD_SUB_VERSION) +
                                       "." + std::to_string(CHOLMOD_SUBSUB_VERSION));
  versions.emplace_back("KLU", std::to_string(KLU_MAIN_VERSION) + "." + std::to_string(KLU_SUB_VERSION) + "." +
                                   std::to_string(KLU_SUBSUB_VERSION));
#endif
#ifdef LCPBENCH_WITH_IPOPT
  versions.emplace_back("Ipopt", IPOPT_VERSION);
#endif
  versions.emplace_back("BLAS", BlasVersion());
  return versions;
}

}  // namespace lcpbench
