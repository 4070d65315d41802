#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "solvers/first_order/sweeps/first_order_options.h"
#include "solvers/first_order/sweeps/lanes.h"
#include "solvers/first_order/sweeps/scaled_rows.h"
#include "solvers/lcp/problem.h"
#include "solvers/linear_algebra/instruction_set.h"
#include "support/array_index.h"

/// Internal to solvers/: the passes over rows that all first-order solvers are made of.
namespace lcpbench {

/// A vector over the rows and its image (RowKernel), each of as many numbers as needed or more.
struct Point {
  Array f;
  Array image;
};

/// What a pass over rows adds up as it goes.
struct StepSums {
  double residual = 0;  ///< of r_k^2, r_k the natural residual of row k at the moment of its step
  double change = 0;    ///< of (change of f_k)^2
  /// The sum of the changes of the energy f.A f / 2 + b.f (sweeps only): exact to rounding of the change, where the
  /// difference of two energies would be exact to rounding of the energy.
  double energy = 0;
};

/// The rows of a ScaledProblem in one layout. Every pass takes a range [begin, end) of rows, so that a caller can read
/// a clock in between; cutting a pass into ranges does not change its result.
///
/// The *image* of a vector f is what a layout keeps of A f, linear in f. Layouts over bodies keep y = S^T f with A = S
/// S^T (body velocities) and the passes keep the image of f up to date as they change f. The assembled layout keeps A
/// f; its sweeps neither need nor update it. Rounding makes an image drift over many sweeps: StartImage and AddToImage
/// make it afresh.
class RowKernel {
 public:
  virtual ~RowKernel();

  /// The rows have changed.
  virtual void SetRows();
  /// Takes the scaled problem's b, which has changed; to be called before any pass.
  virtual void SetB();

  /// True: image(d).image(e) = d.A e, and passes keep images. False: d.image(e) = d.A e, and they do not.
  virtual bool ImageIsRoot() const = 0;
  /// Multiply-adds per row of a sweep, for pacing; >= 1.
  virtual Index EntriesPerRow() const = 0;
  /// Numbers of an image.
  virtual Index ImageSize() const = 0;

  /// image = that of f = 0. (Not all zeros: a layout may keep constants in it, which cancel in differences of images.)
  virtual void StartImage(Array* image) const = 0;
  /// After StartImage and AddToImage over all rows, x->image is that of x->f.
  virtual void AddToImage(Index begin, Index end, Point* x) const = 0;
  /// x->image = that of x->f, of `size` rows.
  void MakeImage(Index size, Point* x) const {
    StartImage(&x->image);
    AddToImage(0, size, x);
  }
  /// image += change of the image when f_row grows by `df`; A must be symmetric.
  virtual void AddRowToImage(Index row, double df, Array* image) const = 0;

  /// w_row = (A f + b)_row; needs the image where ImageIsRoot.
  virtual double W(Index row, const Point& x) const = 0;
  /// Gauss-Seidel: for every row in turn, f_k <- max(floor, f_k - omega w_k) with the newest f.
  virtual void Sweep(Index begin, Index end, bool backward, double omega, Point* x, StepSums* sums) const = 0;
  /// Projected gradient: next_k = max(floor, y_k - step w_k(y)); needs the image of y. Where ImageIsRoot, next->image
  /// (from StartImage on) becomes that of next->f.
  virtual void GradientStep(Index begin, Index end, double step, const Point& y, Point* next, StepSums* sums) const = 0;
  /// Sum of r_k^2; needs the image.
  /// @param w  nullptr, or where w_k goes
  virtual double ResidualSquares(Index begin, Index end, const Point& x, Array* w) const = 0;
};

/// The layouts; `scaled` is not owned. The rows of D^-1/2 A D^-1/2: 12 bytes and one multiply-add per entry.
std::unique_ptr<RowKernel> MakeAssembledRows(const LcpProblem& problem, const ScaledProblem& scaled);
/// Rows on any number of bodies: S = D^-1/2 J M^-1/2, one copy for the product and the update.
std::unique_ptr<RowKernel> MakeFactorRows(const LcpProblem& problem, const ScaledProblem& scaled);
/// Rows on at most two bodies each, of three or six columns.
/// @param p        columns per body, of all rows that it will have
/// @param in_sets  rows that follow each other and share no body are stepped many at once: SetRows finds them, O(n)
/// @param rows     not owned either; takes the scaled problem's b
/// @throws InputError if this machine lacks the instructions
std::unique_ptr<RowKernel> MakeTwoBodyRows(const ScaledProblem& scaled, Index p, bool in_sets, ScaledRows* rows,
                                           InstructionSet instructions = InstructionSet::kBest);
/// The same as it is compiled for each instruction set; the caller owns it.
RowKernel* NewTwoBodyRowsSse2(const ScaledProblem& scaled, Index p, bool in_sets, ScaledRows* rows);
RowKernel* NewTwoBodyRowsAvx2(const ScaledProblem& scaled, Index p, bool in_sets, ScaledRows* rows);
RowKernel* NewTwoBodyRowsAvx512(const ScaledProblem& scaled, Index p, bool in_sets, ScaledRows* rows);

/// Rows per block of a coloured order. Colours span a block and not the whole problem, so that the bodies that a block
/// works on stay in the first-level cache from colour to colour. Measured: 512 to 4096 rows are alike, 128 make the
/// sets of independent rows so small that a sweep takes a sixth longer.
inline constexpr Index kColourBlock = 512;

/// Colours of a block's rows: as many as it has rows always suffice.
class ColourSet {
 public:
  void Insert(Index colour) { words_[At(colour / kBits)] |= std::uint64_t{1} << (colour % kBits); }
  void Insert(const ColourSet& other) {
    for (size_t word = 0; word < words_.size(); ++word) words_[word] |= other.words_[word];
  }
  Index FirstAbsent() const {
    size_t word = 0;
    while (words_[word] == ~std::uint64_t{0}) ++word;
    return static_cast<Index>(word) * kBits + std::countr_one(words_[word]);
  }

 private:
  static constexpr Index kBits = 64;
  std::array<std::uint64_t, At(kColourBlock / kBits)> words_{};
};

/// What every first-order solver works on: the scaled problem, its rows in one layout, and the iterate.
///
/// Rows on two bodies and assembled ones may be in a coloured order: blocks of kColourBlock rows follow each other as
/// given, and within a block rows of one colour stand together, in the given order; no two rows of a colour touch the
/// same movable body (assembled: have A_ij != 0; the pattern of A must be symmetric). Each row takes the first colour
/// that is free (greedy).  O(nnz) and a word per 64 colours
struct RowWork {
  ScaledProblem scaled;
  ScaledRows two_body_rows;  ///< of the layout that has them
  const RowKernel* rows = nullptr;
  Point x;  ///< in space for as many rows as were ever met

  /// All but b.
  /// @param step  the same problem as rows on two bodies, read here only; nullptr: it has none
  void Prepare(const LcpProblem& problem, RowForm form, bool coloured, const StepRows* step);
  /// All but b, of a step; allocates where it has met none as large. False if a row acts on no body that can move.
  bool Take(const StepRows& step, bool coloured);
  /// A solve with this b: f as ScaledProblem::Start, without its image.
  void Start(const double* given_b, const Eigen::VectorXd* initial_f);

 private:
  void SetRows(RowKernel* kernel);

  std::unique_ptr<RowKernel> of_problem_, in_plane_, in_space_;
  RowKernel* rows_ = nullptr;  // the same as `rows`
  // Workspace of Take, by body: its number, and the colours of its rows (none between calls).
  std::vector<std::int32_t> all_bodies_;
  std::vector<ColourSet> on_body_;
};

/// "" if the rows can be laid out in this form, else the reason in words.
std::string WhyNoRows(const LcpProblem& problem, RowForm form);

}  // namespace lcpbench
