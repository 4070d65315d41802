#include "solvers/ordered_lcp.h"

#include <Eigen/OrderingMethods>
#include <algorithm>
#include <cmath>

#include "solvers/power_of_two.h"

namespace lcpbench {
namespace {

size_t At(Eigen::Index i) { return static_cast<size_t>(i); }

}  // namespace

void OrderedLcp::Analyse(const LcpProblem& problem) {
  const SparseMatrix& A = problem.SparseA();
  n = A.rows();
  row.resize(At(n));
  position.resize(At(n));
  // A is symmetric, so its rows serve as the columns that the ordering wants.
  const Eigen::Map<const Eigen::SparseMatrix<double, Eigen::ColMajor, int>> columns(
      n, n, A.nonZeros(), A.outerIndexPtr(), A.innerIndexPtr(), A.valuePtr());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> permutation;
  Eigen::SparseMatrix<double, Eigen::ColMajor, int> copy = columns;
  Eigen::AMDOrdering<int>()(copy, permutation);
  for (Index p = 0; p < n; ++p) row[At(p)] = permutation.indices()[p];
  for (Index p = 0; p < n; ++p) position[At(row[At(p)])] = static_cast<int>(p);

  const Index entries = A.nonZeros();
  begin.assign(At(n + 1), 0);
  diagonal_at.assign(At(n), 0);
  column.resize(At(entries));
  value.resize(At(entries));
  source_.resize(At(entries));
  std::vector<std::pair<int, int>> sorted;
  int count = 0;
  for (Index p = 0; p < n; ++p) {
    begin[At(p)] = count;
    sorted.clear();
    const int i = row[At(p)];
    for (int k = A.outerIndexPtr()[i]; k < A.outerIndexPtr()[i + 1]; ++k) {
      sorted.emplace_back(position[At(A.innerIndexPtr()[k])], k);
    }
    std::sort(sorted.begin(), sorted.end());
    for (const auto& [q, k] : sorted) {
      if (q == p) diagonal_at[At(p)] = count;
      column[At(count)] = q;
      source_[At(count)] = k;
      ++count;
    }
  }
  begin[At(n)] = count;
  for (Eigen::VectorXd* v : {&diagonal, &b, &scale}) v->resize(n);
  bilateral.assign(At(n), 0);
  dead.assign(At(n), 0);
  for (const Index i : problem.bilateral_rows()) bilateral[At(position[At(i)])] = 1;
}

bool OrderedLcp::Load(const LcpProblem& problem) {
  const double* given = problem.SparseA().valuePtr();
  double largest = 0;
  for (Index p = 0; p < n; ++p) {
    const double d = given[source_[At(diagonal_at[At(p)])]];
    if (d < 0) return false;
    dead[At(p)] = d == 0 ? 1 : 0;
    scale[p] = d == 0 ? 1.0 : ScaleOfDiagonal(d);
    b[p] = problem.b()[row[At(p)]] * scale[p];
    if (d != 0) largest = std::max(largest, std::abs(b[p]));
  }
  b_scale = ScaleOfLargest(largest);
  b *= b_scale;
  for (Index p = 0; p < n; ++p) {
    const double s = scale[p];
    for (int k = begin[At(p)]; k < begin[At(p + 1)]; ++k) {
      value[At(k)] = (given[source_[At(k)]] * s) * scale[column[At(k)]];
    }
    diagonal[p] = dead[At(p)] != 0 ? 1.0 : value[At(diagonal_at[At(p)])];
  }
  return true;
}

void OrderedLcp::Product(const double* x, double* out) const {
  for (Index p = 0; p < n; ++p) {
    double sum = 0;
    for (int k = begin[At(p)]; k < begin[At(p + 1)]; ++k) sum += value[At(k)] * x[column[At(k)]];
    out[p] = sum;
  }
}

}  // namespace lcpbench
