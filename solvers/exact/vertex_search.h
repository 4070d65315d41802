#pragma once

#include <vector>

#include "solvers/exact/dyadic_lcp.h"

namespace lcpbench {

/// Where rows depend on others to the rounding of doubles, the problem as its doubles say it still tells which of them
/// are active: at the last digits of b, forces being moved along each other by any amount. This finds out, by pivots as
/// of the primal simplex method. Internal to solvers/exact/.
///
/// Dependent rows are first brought to f = 0, each by the ray of forces that leaves the gaps of a basis G of
/// independent rows alone, up to the first force of G that becomes 0, whose place it takes. Then, with gaps in
/// integers, the row of the most negative gap enters G in the same way, until there is none.
class VertexSearch {
 public:
  /// All but f_start must outlive this.
  VertexSearch(const LcpProblem& problem, const DyadicLcp& lcp, const DyadicScale& scale, const Deadline& deadline)
      : problem_(problem), lcp_(lcp), scale_(scale), deadline_(deadline) {}

  /// @param f  in: forces >= 0 with small gaps on all rows with f > 0
  /// O(fill) of a sparse factor a pivot, some hundred pivots per hundred dependent rows
  /// @return whether no sign is wrong any more; f and basis() are then the answer's. Where not, the problem may have no
  ///         solution, or pivots have come to no end.
  bool Run(const std::vector<Index>& independent, const std::vector<Index>& dependent, std::vector<BigInteger>* f);

  /// G, ascending.
  const std::vector<Index>& basis() const { return basis_; }
  int pivots() const { return pivots_; }

 private:
  struct Ray {
    Eigen::VectorXd d;  // A_GG^-1 A_Gk
    double stiffness;   // A_kk - A_kG d, as a part of A_kk
  };
  Ray FindRay(Index k) const;
  void Factorise();
  void Replace(Index leaving, Index entering);
  bool BringToZero(Index k);
  bool Enter(Index k);
  // The row of G that bounds f_G + t d >= 0 first, and the bound; -1 for none.
  Index Bound(const Eigen::VectorXd& d, double* t) const;
  void Move(const Eigen::VectorXd& d, double t);
  bool DropNegative();
  Index MostNegativeGap() const;

  const LcpProblem& problem_;
  const DyadicLcp& lcp_;
  const DyadicScale& scale_;
  const Deadline& deadline_;
  std::vector<Index> basis_;
  std::vector<char> in_basis_;
  std::optional<ProximalFactor> factor_;
  std::vector<BigInteger>* f_ = nullptr;
  std::vector<BigInteger> w_;
  int pivots_ = 0;
};

}  // namespace lcpbench
