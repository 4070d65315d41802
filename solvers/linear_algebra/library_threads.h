#pragma once

namespace lcpbench {

/// Limits the threads of the BLAS and OpenMP libraries below the solvers, for the whole process, so that every backend
/// is measured on the same number of cores. (Debian's CHOLMOD ignores OMP_NUM_THREADS, and an environment variable
/// would come too late: libraries read it when they are loaded.)
/// @return the number of threads that BLAS reports afterwards; 0 when it cannot tell
int LimitLibraryThreads(int threads);

}  // namespace lcpbench
