#pragma once

#include <array>
#include <vector>

#include "solvers/first_order/sweeps/row_kernel.h"
#include "solvers/first_order/sweeps/scaled_problem.h"
#include "solvers/first_order/sweeps/vector_ops.h"

/// Internal to solvers/.
namespace lcpbench {

/// Matrix-free rows on at most two bodies each (LcpProblem::has_two_body_rows): S = D^-1/2 J M^-1/2 in blocks of three.
/// Image: the velocities S^T f, four numbers per body.
///
/// A row is one cache line with everything it needs but f: its two blocks, b, and where its bodies are. The fourth
/// number of a body is the constant 1, the factor of b. One copy of S serves the product and the update, so that no
/// inverse mass is read. Sets of consecutive rows that share no body are found when the rows are laid out, and stepped
/// by eights, a register a row, with the eight dot products added up in one transposition; by fours, half a row a
/// register, where there is no AVX-512; what is left of a set by fours and one by one. All give the same bits.
///
/// Cost of a row of a coloured order against the bandwidth floor (benchmarks/studies/sweep_benchmark.cc): in cache 1.5
/// ns at 3.9 GHz, 2.2 times the floor (the second-level cache's; three times where all fits the first); 1.2 to 2 times
/// between 10^5 and 10^6 rows. What bounds it in cache is the two loads and two stores of bodies at places of their
/// own: a loop of nothing but those stores takes as long as the floor. Tried as well: products of a whole set before
/// its updates, or of the next eight before the updates of these (a fifth slower: rows and bodies are read twice);
/// short sets padded to eights (no gain; costs memory); eights that begin at cache lines of f (no gain).
class TwoBodyRows final : public RowKernel {
 public:
  /// @param scaled  not owned
  TwoBodyRows(const LcpProblem& problem, const ScaledProblem& scaled);

  void SetB() override;
  std::size_t ImageSize() const override { return image_size_; }
  bool ImageIsRoot() const override { return true; }
  Index EntriesPerRow() const override;
  void StartImage(Array* image) const override;
  void AddToImage(Index begin, Index end, const Array& f, Array* image) const override;
  void AddRowToImage(Index row, double df, Array* image) const override;
  double W(Index row, const Array& f, const Array& image) const override;
  void Sweep(Index begin, Index end, bool backward, double omega, Array* f, Array* image,
             StepSums* sums) const override;
  void GradientStep(Index begin, Index end, double step, const Array& y, const Array& y_image, Array* next,
                    Array* next_image, StepSums* sums) const override;
  double ResidualSquares(Index begin, Index end, const Array& f, const Array& image) const override;

 private:
  struct alignas(kCacheLine) Row {
    std::array<double, 8> s{};  ///< first block, b, second block, offsets of the bodies (two int)
  };

  enum class Pass {
    kRead,     ///< products only
    kInPlace,  ///< what the products read is what the steps change
    kAcross,   ///< read one image, change another
  };
  void FindSets();
  template <bool kBackward, Index kRows>
  void FetchAhead(Index k, const double* in) const;
  template <Pass kPass, typename Step>
  void Visit(Index begin, Index end, bool backward, const double* in, double* out, Step* step) const;
  template <Pass kPass, typename Step>
  static void VisitOne(const Row& row, Index k, const double* in, double* out, Step* step);
  template <Pass kPass, HalfOfEight kHalf, typename Step>
  static void VisitFour(const Row* row, Index k, const double* in, double* out, Step* step);

  template <Pass kPass, bool kBackward, typename Step>
  static void VisitEight(const Row* row, Index k, const double* in, double* out, Step* step);
  template <Pass kPass, bool kBackward, typename Step>
  void VisitRows(Index begin, Index end, const double* in, double* out, Step* step) const;

  const ScaledProblem& scaled_;
  AlignedVector<Row> rows_;
  std::vector<Index> set_end_;  ///< of each set of independent rows; empty where there is little to gain
  std::size_t image_size_ = 0;
};

}  // namespace lcpbench
