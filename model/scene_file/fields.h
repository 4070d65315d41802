#pragma once

#include <initializer_list>
#include <string>
#include <utility>

#include "model/contact/system.h"
#include "model/motion/impact.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {

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
/// A motion's "impact_law".
inline constexpr std::initializer_list<std::pair<const char*, ImpactLaw>> kImpactLaws = {
    {"newton", ImpactLaw::kNewton}, {"poisson", ImpactLaw::kPoisson}};

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
