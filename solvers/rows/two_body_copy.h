#pragma once

#include <cstdint>
#include <vector>

#include "solvers/lcp/step_rows.h"

namespace lcpbench {

/// Arrays in compressed rows, as two-body rows: the entries of J on bodies that move, copied to their places, and all
/// numbers of A and b checked on the way. Lists of friction and bounded rows are those of the arrays, unchecked.
class TwoBodyCopy {
 public:
  /// False if a row acts on more than two bodies that can move, a number is extreme, or the arrays are wrong, which
  /// LcpProblem::FromArrays tells with its words.  O(entries); allocates where it has met no problem as large
  bool Take(const ProblemArrays& arrays);
  /// The same of a problem with factors, which must outlive this; b is neither checked nor kept.
  bool Take(const LcpProblem& problem);
  const StepRows& rows() const { return rows_; }

 private:
  // J and the inverse masses, of arrays that fit together.
  struct Factors {
    Index rows, columns, entries;
    const int* start;
    const int* column;
    const double* value;
    const double* mass;
  };
  bool TakeFactors(const Factors& factors, int columns_per_body);
  template <Index p>
  bool TakeRows(const Factors& factors);
  StepRows rows_;
  std::vector<std::int32_t> body_;
  std::vector<double> J_;
  std::vector<unsigned char> moves_;  // by body
};

}  // namespace lcpbench
