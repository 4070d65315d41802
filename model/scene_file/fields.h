#pragma once

#include <algorithm>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <type_traits>
#include <utility>

#include "model/contact/system.h"
#include "model/motion/impact.h"
#include "model/motion/motion.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {

// What the readers of scene files ask of single values, and how the writer writes them. Readers throw InputError naming
// the JSON path.

using OrderedJson = nlohmann::ordered_json;

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

/// The names of an enumeration's values, for JsonField::Choice and the writer.
template <class E>
using Names = std::initializer_list<std::pair<const char*, E>>;
template <class E>
constexpr Names<E> kNames = {};
template <>
inline constexpr Names<Side> kNames<Side> = {{"left", Side::kConvex}, {"right", Side::kConcave}};
template <>
inline constexpr Names<ConstraintType> kNames<ConstraintType> = {{"pin", ConstraintType::kPin},
                                                                 {"path", ConstraintType::kPathJoint},
                                                                 {"rod", ConstraintType::kRod},
                                                                 {"rope", ConstraintType::kRope}};
template <>
inline constexpr Names<MotionLevel> kNames<MotionLevel> = {{"acceleration", MotionLevel::kAcceleration},
                                                           {"velocity", MotionLevel::kVelocity}};
template <>
inline constexpr Names<ImpactLaw> kNames<ImpactLaw> = {{"newton", ImpactLaw::kNewton},
                                                       {"poisson", ImpactLaw::kPoisson}};

/// What the library calls to make a point JSON.
inline void to_json(OrderedJson& json, const Vec2& p) { json = {p.x, p.y}; }  // NOLINT(readability-identifier-naming)
/// Null for what is absent.
template <class T>
OrderedJson ToJson(const T& value) {
  if constexpr (std::is_enum_v<T>) {
    return std::ranges::find(kNames<T>, value, &std::pair<const char*, T>::second)->first;
  } else if constexpr (requires { value.has_value(); }) {
    return value ? ToJson(*value) : OrderedJson();
  } else {
    return value;
  }
}
/// +0, or two of them: exactly what the reader takes for an absent number.
bool IsDefault(const OrderedJson& json);

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
