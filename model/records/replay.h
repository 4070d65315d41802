#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "model/contact/system.h"

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

/// Agreement with the paper's own software: its recorded contact problems, assembled again by this model.
///
/// The features are rebuilt from the recorded geometry (centres of curvature from U, radii without the gap that was
/// added to them, edges through the impact points), then found and assembled by AssembleContactLcp like any other
/// system. The software's b departs from the second derivative of the gap in the ways that Correction lists; with them,
/// recorded b - extra + corrections is what this model computes. A needs no correction.

/// What the mathematics demands and the software does otherwise; derived in docs/model.md section 13. Written with the
/// software's own quantities: dv = v1(U1) - v2(U2) the relative velocity at the ends of the centre arms, vn = n.dv, vt
/// = t.dv, t = Perp(n), rho the signed radius that it divides by.
enum class Correction {
  kNormalDerivative,   ///< its n' = dv/rho is not perpendicular to n:  -vn^2/rho
  kVertexAboveEdge,    ///< a vertex taken to be where its foot is:  -d (omega1 - omega2)^2
  kVertexAboveVertex,  ///< the same of two vertices:  2 omega1 vt
  kJointAxis,          ///< the arms of fixed axes with the term of turning ones:  -2 omega2 vt
  kRodLength,          ///< it divides by the rest length L; the distance is l = |p1 - p2|:  vt^2 (1/L - 1/l)
  kPathGap,            ///< n' of a path at distance d turns slower by 1 + kappa d:  kappa vt^2/(1 + kappa d) - n'.dv
};

inline constexpr std::size_t kCorrectionCount = 6;

/// One recorded row against this model's.
struct ReplayRow {
  std::string kind;     ///< as recorded; "_concave" where a radius is negative, "_world" for a joint with fixed axes
  double recorded = 0;  ///< b - extra [m/s^2]
  std::array<double, kCorrectionCount> added{};  ///< corrections, by Correction
  double ours = 0;                               ///< this model's b
  /// Largest difference of n, and of d and d' scaled as below, between the record and the rebuilt row.
  double geometry_deviation = 0;

  double corrected() const {
    double sum = recorded;
    for (const double term : added) sum += term;
    return sum;
  }
};

/// A record rebuilt by this model.
struct ReplayResult {
  std::vector<ReplayRow> rows;
  Eigen::MatrixXd A;  ///< this model's, rows as recorded
};

/// A record's contact as one constraint of this model, whose row or rows give the recorded one:
/// recorded row = sum_k weight[k] (row k of the constraint).
struct RebuiltContact {
  Constraint constraint;
  std::array<double, 2> weight{};                ///< a pin has two rows (world x, y), all others one
  double gap_offset = 0;                         ///< recorded gap - weighted d
  std::array<double, kCorrectionCount> added{};  ///< corrections of the recorded b, by Correction
};

/// Rods are recorded with n from attachment 1 to 2, hence weight -1. Vertex/vertex contacts, which this model refuses,
/// are rebuilt as the distance row they are away from d = 0, as a rod of the recorded length. A joint's axis is a
/// combination of the two rows of a pin.
RebuiltContact Rebuild(const RecordedContact& contact, const std::vector<Body>& bodies);

/// Rebuilds and assembles `record`.  O(n^2).
/// @throws InputError if the recorded geometry is not a contact system (AssembleContactLcp), naming body and feature
ReplayResult Replay(const ReplayRecord& record);

/// Two numbers agree when |x - reference| / (1 + |reference|) is at most this.
inline constexpr double kReplayTolerance = 1e-9;

/// What many replayed records amount to: agreement per contact kind and of A, the sizes of the corrections, and every
/// number that is left over.
class ReplaySummary {
 public:
  /// @param where  "file:line", for the list of what is left over
  void Add(const ReplayRecord& record, const ReplayResult& result, const std::string& where);

  std::size_t records() const { return A_.count; }
  /// A agrees on every record, and b, corrected, on every row.
  bool AllAgree() const { return left_over_.empty(); }

  /// For people: several lines, the first few of what is left over last.
  std::string Table() const;
  /// One JSON object on one line: {records, rows, tolerance, agrees, A {records, agree, largest, id}, kinds [{kind,
  /// rows, agree_before, largest_before, agree_after, largest_after, largest_geometry}], corrections [{key, formula,
  /// rows, largest}], left_over [{where, id, what, recorded, ours, deviation}]}.
  std::string Json() const;

 private:
  /// Numbers that were compared, or corrections of one kind.
  struct Tally {
    std::size_t count = 0;
    std::size_t agree = 0;
    double largest = 0;
    std::string id;  ///< of the record with the largest
    void Take(double value, const std::string& record_id);
  };
  struct KindTally {
    Tally before, after, geometry;
  };
  struct LeftOver {
    std::string where;
    std::string id;
    std::string what;
    double recorded = 0;  ///< corrected
    double ours = 0;
  };

  Tally A_;  ///< by record
  std::map<std::string, KindTally> kinds_;
  KindTally total_;
  std::array<Tally, kCorrectionCount> corrections_;  ///< [m/s^2], not scaled
  std::vector<LeftOver> left_over_;
};

}  // namespace lcpbench
