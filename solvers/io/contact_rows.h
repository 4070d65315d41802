#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"

namespace lcpbench {

/// What is read of the tangents of FCLib's and Siconos' contacts, which have one (in the plane) or two (in space).
enum class TangentRows {
  kOne,   ///< of contacts with one tangent a friction row; two are refused, whose forces those formats bound by a disc
  kBox,   ///< of those with two also, a friction row each: a square in the place of the disc
  kNone,  ///< nothing: normal rows alone, as if all coefficients were 0
};

/// The rows of our problem that are read of such contacts: of each its normal and, where its coefficient is not 0, its
/// tangents.
struct ContactRows {
  std::vector<int> row;               ///< by row of the file, `dimension` a contact; -1: not read
  std::vector<FrictionRow> friction;  ///< by ascending row
  int count = 0;                      ///< of the rows that are read
};

/// @param dimension  rows of a contact, 2 or 3
/// @param mu         a coefficient a contact
/// @param reject     throws: what was expected and what was found
ContactRows RowsOfContacts(int dimension, std::span<const double> mu, TangentRows tangents,
                           const std::function<void(const std::string& expected, const std::string& found)>& reject);

/// What writers call whose format has no place for some kinds of rows.
/// @param takes_bounded  whether the format has bounds; none but FCLib, which asks for itself, has friction
/// @throws InputError naming the kind
void RequireNoFriction(const LcpProblem& problem, bool takes_bounded);

}  // namespace lcpbench
