#pragma once

#include <initializer_list>
#include <string>

#include "model/contact/body.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {

// What the readers of scene files ask of single values. All throw InputError naming the JSON path.

/// Every number of a scene file lies within +-kLargestNumber, and one that must be positive above 1 / kLargestNumber:
/// products of a few of them stay within double's range.
inline constexpr double kLargestNumber = 1e30;
inline constexpr std::size_t kLongestName = 200;  ///< [bytes]

/// What a number may be.
struct Range {
  double least;
  double most;
  const char* text;              ///< what an error says of it
  const Range* wider = nullptr;  ///< one whose error comes first
  bool Holds(double value) const { return value >= least && value <= most; }
  bool Holds(Vec2 p) const { return Holds(p.x) && Holds(p.y); }
};
inline constexpr Range kAnyNumber = {-kLargestNumber, kLargestNumber, "a number within -1e30..1e30"};
inline constexpr Range kPositive = {1 / kLargestNumber, kLargestNumber, "a number > 0, within 1e-30..1e30"};
inline constexpr Range kNonNegative = {0, kLargestNumber, "a number >= 0, at most 1e30"};
inline constexpr Range kShare = {0, 1, "a number in 0..1"};
inline constexpr Range kCoefficient = {0, kMostFriction, "a number in 0..1e6", &kNonNegative};

double ReadNumber(const JsonField& field, const Range& range = kAnyNumber);
Vec2 ReadVector(const JsonField& field);

/// Member `key`, or the default where it is absent.
double ReadNumber(const JsonField& object, const char* key, double otherwise, const Range& range = kAnyNumber);

/// A name that can stand in one line of text: 1..kLongestName bytes, no control characters.
std::string ReadName(const JsonField& field);
void RequireName(const std::string& name, const JsonField& field);

/// The only key of an object that must have exactly one of the known ones.
const char* OnlyKey(const JsonField& object, std::initializer_list<const char*> known);

/// The same number as text: the shortest that reads back as it.
std::string Text(double value);
std::string Text(Vec2 p);

/// Calls `action`; what it throws as InputError is thrown as an error of `field`.
template <class Action>
auto AtField(const JsonField& field, const Action& action) {
  try {
    return action();
  } catch (const InputError& error) {
    field.Fail(error.what());
  }
}

}  // namespace lcpbench
