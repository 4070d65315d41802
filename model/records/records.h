#pragma once

#include <string>
#include <string_view>

#include "model/contact/system.h"
#include "support/input_error.h"

namespace lcpbench {

/// JSON-lines records of contact systems, read and answered, told apart by their fields:
///   system                 `bodies`, `contacts` (type unilateral, path, pin, rod or rope; body1, body2 indices)
///   pin, path, rod, rope   `kind` of that name, `body1`, `body2`, `feature1`, `feature2`
///   contact                any other or no `kind`, as above
/// Fields: body {mass, inertia, fixed, x, theta, v, omega, force, torque}; feature {type: vertex, p | straight, a, b |
/// arc, center, radius, side | ellipse, center, a, b, phi, side | superellipse, center, a, b, m, phi, side | bezier, P:
/// four points}, side convex or concave, as feature.h defines them, all in the body frame; start values s1, s2 (null or
/// absent: none) and nominal_gap where known; `length` of rods and ropes, which join two vertices. SI units. Everything
/// else is ignored; `expect`, the reference answer, is never read.

/// A feature of a type that this version does not know.
class UnsupportedFeatureError : public InputError {
 public:
  using InputError::InputError;
};

/// The system a record describes; its name is the record's `id`. A single contact or joint becomes a system of two
/// bodies and one constraint. Not validated: AssembleContactLcp does that.
/// @param where  "file:line", for error texts
/// @throws InputError naming where, the JSON path, what was expected and what was found, if the line is not JSON or a
///         field is missing or mistyped; UnsupportedFeatureError for an unknown feature type
ContactSystem ParseSystemRecord(std::string_view line, const std::string& where);

/// Reads one record, assembles it and returns one line of JSON, numbers printed so that they read back exactly:
///   contact, path, rod, rope  {"id", "rows": [{"n", "d", "d_dot", "J": [6], "gamma", "A", "b"}]}
///   pin           {"id", "rows": [{"axis", "g", "g_dot", "J": [6], "gamma", "A": [2], "b"} x 2], and, over both rows,
///                 "g", "g_dot", "J", "gamma", "A", "b"}
///   system        {"id", "rows": [{"contact", "axis", "bilateral", "n", "d", "d_dot"}], "J": [n][3N], "gamma",
///                 "A": [n][n], "b", "d", "d_dot"}
///   no such row   {"id", "error"}: singular or invalid geometry, masses, lengths or indices, unsupported features
/// O(n^2) for n rows, because A is printed in full.
/// @throws InputError only where the line is not a record at all, as ParseSystemRecord
std::string AssembleRecord(std::string_view line, const std::string& where);

}  // namespace lcpbench
