#pragma once

#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "model/contact/system.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {

/// Arrays and objects in each other beyond this are refused: no file of ours is half as deep.
inline constexpr std::size_t kMaxJsonDepth = 32;

/// A JSON document [RFC 8259] written by hand: unlike the plain parser it refuses a key that stands twice in one object
/// (one of the two would be lost unseen). Time and memory proportional to the text, recursion none.
/// @throws InputError, one line: where, then line and column of what is not JSON, or the JSON pointer of a repeated
///         key, of a value nested deeper than kMaxJsonDepth, of a number beyond the range of double
nlohmann::json ParseJsonDocument(std::string_view text, const std::string& where);

// What the readers of scene files ask of single values. All throw InputError naming the JSON path.

/// Every number of a scene file lies within +-kLargestNumber, and one that must be positive above 1 / kLargestNumber:
/// products of a few of them stay within double's range.
inline constexpr double kLargestNumber = 1e30;
inline constexpr std::size_t kLongestName = 200;  ///< [bytes]
/// A joint's "type".
inline constexpr std::initializer_list<std::pair<const char*, ConstraintType>> kJointTypes = {
    {"pin", ConstraintType::kPin},
    {"path", ConstraintType::kPathJoint},
    {"rod", ConstraintType::kRod},
    {"rope", ConstraintType::kRope}};

double ReadNumber(const JsonField& field);
double ReadPositive(const JsonField& field);
double ReadNonNegative(const JsonField& field);
Vec2 ReadVector(const JsonField& field);

/// Member `key`, or the default where it is absent.
double ReadNumber(const JsonField& object, const char* key, double otherwise);
Vec2 ReadVector(const JsonField& object, const char* key, Vec2 otherwise);

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
