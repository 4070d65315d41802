#include "benchmarks/collection/singular_values.h"

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <vector>

extern "C" {
// Fortran; the last argument is the length of `job`. NOLINTNEXTLINE(readability-identifier-naming)
void dgesdd_(const char* job, const int* m, const int* n, double* a, const int* lda, double* s, double* u,
             const int* ldu, double* vt, const int* ldvt, double* work, const int* lwork, int* iwork, int* info,
             std::size_t job_length);
}

namespace lcpbench {

Eigen::VectorXd SingularValues(Eigen::MatrixXd* matrix) {
  const int m = static_cast<int>(matrix->rows());
  const int n = static_cast<int>(matrix->cols());
  const int least = std::min(m, n);
  Eigen::VectorXd values(least);
  if (least == 0) return values;
  std::vector<int> integers(8 * static_cast<size_t>(least));
  const int one = 1;
  int info = 0;
  double unused = 0;
  // The first call asks for the length of the workspace.
  double length = 0;
  int words = -1;
  dgesdd_("N", &m, &n, matrix->data(), &m, values.data(), &unused, &one, &unused, &one, &length, &words,
          integers.data(), &info, 1);
  words = static_cast<int>(length);
  std::vector<double> work(static_cast<size_t>(words));
  dgesdd_("N", &m, &n, matrix->data(), &m, values.data(), &unused, &one, &unused, &one, work.data(), &words,
          integers.data(), &info, 1);
  if (info != 0) throw std::runtime_error("singular values: dgesdd returned " + std::to_string(info));
  return values;
}

}  // namespace lcpbench
