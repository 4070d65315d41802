#pragma once

#include <string>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// SHA-256 of what a problem is, in hexadecimal digits: of its given form, b and kinds of rows, not of its id, and the
/// same from whatever file it was read. Hashed are, all little-endian, integers of 64 bits and IEEE doubles:
///     "lcpbench problem 1\n", then n, the form (0 dense, 1 sparse, 2 factors),
///     dense:    A by rows
///     sparse:   matrix(A)
///     factors:  matrix(J), its columns many inverse masses
///     b, the number of bilateral rows, their indices, ascending from 0
///     where there are friction, sliding or bounded rows: the number of the first two; row, normal row, slip and mu of
///               each; the number of the last; row, lower and upper of each
///     matrix:   rows, columns, entries of every row, then column and value of every entry by rows
/// Stored zeros are entries. Two numbers that are equal but for the sign of zero hash differently.  O(entries)
std::string ContentHash(const LcpProblem& problem);

/// SHA-256 of the hashes of a sequence's problems, each followed by a line feed.
class SequenceHash {
 public:
  void Add(const LcpProblem& problem) { text_ += ContentHash(problem) + '\n'; }
  std::string Result() const;

 private:
  std::string text_;
};

/// SHA-256 of a text, in hexadecimal digits.
std::string TextHash(const std::string& text);

}  // namespace lcpbench
