#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "model/contact/system.h"
#include "model/records/replay_record.h"

namespace lcpbench {

/// Agreement with the paper's own software: its recorded contact problems, assembled again by this model.
///
/// The features are rebuilt from the recorded geometry (centres of curvature from U, radii without the gap that was
/// added to them, edges through the impact points), then found and assembled by AssembleContactLcp like any other
/// system. The software's b departs from the second derivative of the gap in the ways that Correction lists; with them,
/// recorded b - extra + corrections is what this model computes. A needs no correction.

/// What the mathematics demands and the software does otherwise. Written with the software's own quantities:
/// dv = v1(U1) - v2(U2) the relative velocity at the ends of the centre arms, vn = n.dv, u = t.dv, t = Perp(n), rho the
/// signed radius that it divides by.
enum class Correction {
  /// It sets n' = dv/rho, whose part along n is not perpendicular to n: n is a unit vector, so n' = (u/rho) t.
  /// Where q = n'.dv is used (curved edge 2, vertex/vertex, rods, ropes):  -vn^2/rho.
  kNormalDerivative,
  /// A vertex of body 1 above a straight edge is taken to be where its foot is (R1 leads to p2). The vertex is at
  /// p1 = p2 + d n, where t.v1 differs by omega1 d and n.a1 by -omega1^2 d; and the edge point below it adds -omega2^2
  /// d:
  /// 2 omega2 (u + omega1 d) - omega1^2 d - omega2^2 d - 2 omega2 u = -d (omega1 - omega2)^2.
  kVertexAboveEdge,
  /// The same of two vertices:  (u + omega1 d)^2/d - omega1^2 d - u^2/d = 2 omega1 u.
  kVertexAboveVertex,
  /// A joint's pair of rows says p1 = p2, along two axes. Its A has the arms of axes that are fixed in the world (an
  /// axis turning with body 2 would have t.(p1 - p2) added to its arm), its b the term 2 omega2 u of turning ones:
  /// -2 omega2 u.
  kJointAxis,
  /// It divides by a rod's rest length L; the distance is l = |p1 - p2|:  u^2 (1/L - 1/l).
  kRodLength,
  /// A point at distance d from a path of curvature kappa = n'.t/u on a fixed body: n' turns slower by 1 + kappa d:
  /// kappa u^2/(1 + kappa d) - n'.dv.
  kPathGap,
};

inline constexpr size_t kCorrectionCount = 6;

/// A correction for readers.
struct CorrectionText {
  const char* key;
  const char* formula;
};
CorrectionText Text(Correction correction);

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
  std::array<double, 2> weight{};  ///< a pin has two rows (world x, y), all others one
  double gap_offset = 0;           ///< recorded gap - weighted d
};

/// Rods are recorded with n from attachment 1 to 2, hence weight -1. Vertex/vertex contacts, which this model refuses,
/// are rebuilt as the distance row they are away from d = 0, as a rod of the recorded length. A joint's axis is a
/// combination of the two rows of a pin.
RebuiltContact Rebuild(const RecordedContact& contact, const std::vector<Body>& bodies);

/// Rebuilds and assembles `record`.  O(n^2).
/// @throws InputError if the recorded geometry is no contact system (AssembleContactLcp), naming body and feature
ReplayResult Replay(const ReplayRecord& record);

/// |x - reference| / (1 + |reference|): how deviations are measured here.
double ScaledDeviation(double x, double reference);

}  // namespace lcpbench
