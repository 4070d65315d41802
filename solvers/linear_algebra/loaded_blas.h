#pragma once

#include <string>
#include <vector>

/// The BLAS below CHOLMOD and Ipopt is the system's choice and known only once it is loaded: its functions are looked
/// up at run time.
namespace lcpbench {

/// Limits the threads of the BLAS and OpenMP libraries below the solvers, for the whole process, so that every backend
/// is measured on the same number of cores. (Debian's CHOLMOD ignores OMP_NUM_THREADS, and an environment variable
/// would come too late: libraries read it when they are loaded.)
/// @return the number of threads that BLAS reports afterwards; 0 when it cannot tell
int LimitLibraryThreads(int threads);

/// OpenBLAS with its version and the kernels that it chose, the file of another BLAS, or "unknown".
std::string BlasVersion();

/// Kernels of OpenBLAS that this processor can run, as its variable OPENBLAS_CORETYPE names them, those with the widest
/// registers first. Not all are listed: one of a width.
std::vector<std::string> RunnableBlasKernels();

/// Whether OpenBLAS is loaded and chose kernels with narrower registers than the first one of RunnableBlasKernels: it
/// runs its oldest kernels (Prescott, SSE3) on processors that are newer than itself.
bool HasNarrowBlasKernels();

/// To be called before the first use of BLAS. OpenBLAS takes a buffer of kBlasBuffer then, and where it gets none asks
/// again for ever.
/// @throws MemoryRefusal
void RequireBlasMemory();
inline constexpr double kBlasBuffer = 1 << 27;  ///< bytes of addresses (Debian's builds)

/// Whether a product and a Cholesky factorization by the loaded BLAS agree with plain loops.
/// @throws MemoryRefusal
bool BlasIsRight();

}  // namespace lcpbench
