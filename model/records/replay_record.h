#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "model/contact/body.h"

namespace lcpbench {

/// Contact problems recorded from the paper's own software (myPhysicsLab, engine2D): states, contacts, and the A and b
/// that it computed from them.

enum class RecordedKind {
  kVertexStraight,
  kVertexCurved,
  kStraightCurved,
  kCurvedCurved,
  kVertexVertex,
  kJoint,      ///< one axis of a pin: bilateral along n, which turns with body 2 or is fixed in the world
  kPathJoint,  ///< a point of body 1 kept on a curve of body 2
  kRod,
  kRope,
};

/// As recorded, such as "vertex_straight".
const char* Name(RecordedKind kind);

/// One row as recorded, world frame, SI units. Body 1 gets +f n; n points from body 2 to body 1, but for rods and ropes
/// from attachment 1 to attachment 2, which is the direction of their pull.
struct RecordedContact {
  RecordedKind kind = RecordedKind::kVertexStraight;
  int body1 = 0;
  int body2 = 1;
  Vec2 n;
  bool fixed_normal = false;  ///< n is constant in the world (joints)
  Vec2 R1, R2;                ///< centres of mass to the impact point (joints, rods, ropes: to the attachments)
  Vec2 U1, U2;                ///< centres of mass to the centres of curvature; R where there is none
  /// Signed radii (concave < 0) with the gap already added: half of it to each of two curved edges, else all of it.
  /// 0 where the kind has none. A rod's or rope's radius2 is minus the length that the software divides by.
  double radius1 = 0;
  double radius2 = 0;
  double distance = 0;  ///< gap [m]
  double vn = 0;        ///< n.(v1 - v2) [m/s]
  double extra = 0;     ///< stabilisation term contained in b [m/s^2]
  Vec2 normal_dt;       ///< n' of a path joint
};

/// A contact problem as the paper's software recorded it.
struct ReplayRecord {
  std::string id;
  std::vector<Body> bodies;  ///< forces and torques are mass times the recorded accelerations
  std::vector<RecordedContact> contacts;
  Eigen::MatrixXd A;  ///< n x n as the software computed it
  Eigen::VectorXd b;  ///< n, with the stabilisation terms
};

/// Reads one JSON line: id, n, bodies[] {name, fixed, m, I, x, y, angle, vx, vy, omega, ax, ay, alpha}, contacts[]
/// {kind, p, q, n, normalFixed, R1, R2, U1, U2, radius1, radius2, distance, vn, extra, normal_dt}, A (flat, row-major)
/// and b; everything else is ignored. A fixed body's velocity and acceleration are 0, whatever is recorded.
/// @param where  "file:line", the start of every error text
/// @throws InputError naming where, the field, what was expected and what was found
ReplayRecord ParseReplayRecord(std::string_view line, const std::string& where);

}  // namespace lcpbench
