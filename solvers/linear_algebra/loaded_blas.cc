#include "solvers/linear_algebra/loaded_blas.h"

#include <dlfcn.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <string_view>

#include "solvers/lcp/memory_budget.h"

namespace lcpbench {
namespace {

// dlsym gives void*; the conversion to a function pointer is what POSIX prescribes.
template <typename Function>
Function Find(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
}

// Doubles in a register of the kernels of that name; others are of two.
int RegisterOf(std::string_view kernels) {
  for (const char* name : {"SkylakeX", "Cooperlake", "SapphireRapids"}) {
    if (kernels == name) return 8;
  }
  for (const char* name : {"Haswell", "Zen", "Excavator", "Steamroller", "Piledriver", "Bulldozer", "Sandybridge"}) {
    if (kernels == name) return 4;
  }
  return 2;
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

std::string BlasVersion() {
  if (const auto get_config = Find<char* (*)()>("openblas_get_config")) return get_config();
  void* symbol = dlsym(RTLD_DEFAULT, "dgemm_");
  Dl_info info;
  if (symbol != nullptr && dladdr(symbol, &info) != 0 && info.dli_fname != nullptr) return info.dli_fname;
  return "unknown";
}

std::vector<std::string> RunnableBlasKernels() {
  std::vector<std::string> names;
  if (__builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 &&
      __builtin_cpu_supports("avx512bw") != 0 && __builtin_cpu_supports("avx512vl") != 0) {
    names.emplace_back("SkylakeX");
  }
  if (__builtin_cpu_supports("avx2") != 0 && __builtin_cpu_supports("fma") != 0) names.emplace_back("Haswell");
  return names;
}

bool HasNarrowBlasKernels() {
  const std::vector<std::string> runnable = RunnableBlasKernels();
  const auto chosen = Find<char* (*)()>("openblas_get_corename");
  return chosen != nullptr && !runnable.empty() && RegisterOf(chosen()) < RegisterOf(runnable.front());
}

void RequireBlasMemory() {
  // Once it has its buffer, it keeps it.
  static const bool there = [] {
    if (Find<int (*)()>("openblas_get_num_threads") != nullptr) RequireMemory(kBlasBuffer, "OpenBLAS");
    return true;
  }();
  static_cast<void>(there);
}

bool BlasIsRight() {
  RequireBlasMemory();
  using Product = void (*)(const char*, const char*, const int*, const int*, const int*, const double*, const double*,
                           const int*, const double*, const int*, const double*, double*, const int*);
  using Factorization = void (*)(const char*, const int*, double*, const int*, int*);
  const auto product = Find<Product>("dgemm_");
  const auto factorize = Find<Factorization>("dpotrf_");
  if (product == nullptr || factorize == nullptr) return true;
  using Eigen::MatrixXd;
  // Odd sizes around those of the kernels' blocks; numbers that a mistake in one place changes.
  for (const int n : {7, 33, 130}) {
    const MatrixXd a = MatrixXd::NullaryExpr(n, n, [](auto i, auto j) { return std::sin(1 + 3 * i + 7 * j + i * j); });
    const double one = 1;
    MatrixXd c = MatrixXd::Identity(n, n);
    product("N", "T", &n, &n, &n, &one, a.data(), &n, a.data(), &n, &one, c.data(), &n);
    const MatrixXd plain = MatrixXd::Identity(n, n) + a.lazyProduct(a.transpose());
    const double rounding = n * n * std::numeric_limits<double>::epsilon();
    if (!((c - plain).cwiseAbs().maxCoeff() <= rounding)) return false;
    int info = 0;
    factorize("L", &n, c.data(), &n, &info);
    const MatrixXd lower = c.triangularView<Eigen::Lower>();
    if (info != 0 || !((lower.lazyProduct(lower.transpose()) - plain).cwiseAbs().maxCoeff() <= n * rounding))
      return false;
  }
  return true;
}

}  // namespace lcpbench
