#pragma once

#include <string>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// A problem as a caller's arrays hold it: what an engine has in memory before any solver is asked, and where the time
/// that a user pays begins (fresh_pass.h). Nothing here has been checked; LcpProblem::FromArrays does that.
///
/// By form: kDense has `value` with n n numbers of A, row after row; kSparse the compressed rows of A, both triangles;
/// kFactors those of J and the inverse masses, A = J M^-1 J^T. Compressed rows: row_start has n + 1 numbers, `column`
/// and `value` row_start[n], columns ascending within a row.
struct ProblemArrays {
  /// A name for files and error texts.
  std::string id;
  /// Which of the arrays below are used.
  MatrixForm form = MatrixForm::kFactors;
  Index rows = 0;     ///< n
  Index columns = 0;  ///< of J; n in the other forms
  /// n + 1 numbers.
  std::vector<int> row_start;
  /// Ascending within a row.
  std::vector<int> column;
  /// Of J, or of A.
  std::vector<double> value;
  std::vector<double> inverse_mass;      ///< of kFactors, a number per column of J, >= 0
  std::vector<double> b;                 ///< n
  std::vector<unsigned char> bilateral;  ///< n; 1: w = 0 and f free (a joint). Empty: every row is unilateral
  MatrixFacts facts;                     ///< what the caller has proved about A

  /// The arrays of a problem's given form. @throws InputError unless its bounds are standard
  static ProblemArrays Of(const LcpProblem& problem);
};

}  // namespace lcpbench
