#pragma once

#include <Eigen/Dense>

#include "model/contact/assembly.h"
#include "model/contact/system.h"
#include "model/detection/detection.h"
#include "model/geometry/feature.h"
#include "model/scenes/scene.h"
#include "model/shape/outline.h"
#include "solvers/io/json_lines.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/verify.h"
#include "tests/support/test.h"

namespace lcpbench {

/// The key alone: test listings would show raw bytes.
inline void PrintTo(const SceneFamily& scene, std::ostream* out) { *out << scene.key; }

}  // namespace lcpbench

namespace lcpbench::testing {

/// A key as part of a test's name.
inline std::string TestNameOf(std::string_view key) {
  std::string name(key);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

/// The smallest radius or half-width of any body in any scene family [m]: what gaps are compared with.
inline constexpr double kSceneSize = 0.02;

/// A body's outline in the world as polygons of points along it, holes included: for asking whether points lie in it,
/// up to the bulges between its points. It shares nothing with contact detection but the curves' points.
class Solid {
 public:
  /// @param least  points of a piece
  explicit Solid(const Body& body, int least = 1) : x_(body.x) {
    for (const OutlineLoop& loop : OutlineOf(body).loops) {
      std::vector<Vec2>& polygon = polygons_.emplace_back();
      for (const OutlinePiece& piece : loop) {
        // Long walls and floors have points so close that nothing which lies in them can miss all.
        const bool is_angle = std::visit([](const auto& e) { return e.kIsAngle; }, piece.edge);
        const double per_parameter = is_angle ? 20 : body.fixed ? 120 : 4;
        const int samples =
            std::max(least, 1 + static_cast<int>(per_parameter * std::abs(piece.s_end - piece.s_begin)));
        for (int k = 0; k <= samples; ++k) {
          const Vec2 p = CurvePoint(piece.edge, piece.s_begin + (piece.s_end - piece.s_begin) * k / samples);
          reach_ = std::max(reach_, Norm(p));
          polygon.push_back(body.x + Rotate(SinCos(body.theta), p));
        }
      }
    }
  }

  const std::vector<std::vector<Vec2>>& polygons() const { return polygons_; }
  /// The largest distance of the outline's points from the centre of mass [m].
  double reach() const { return reach_; }

  /// By the number of edges that a ray to the right crosses.
  bool Contains(Vec2 p) const {
    if (Norm(p - x_) > reach_) return false;
    bool inside = false;
    for (const std::vector<Vec2>& polygon : polygons_) {
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        const Vec2 a = polygon[k];
        const Vec2 b = polygon[(k + 1) % polygon.size()];
        if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) inside = !inside;
      }
    }
    return inside;
  }
  /// The distance to the polygons, < 0 outside.
  double Depth(Vec2 p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const std::vector<Vec2>& polygon : polygons_) {
      for (std::size_t k = 0; k < polygon.size(); ++k) {
        least = std::min(least, DistanceToSegment(p, polygon[k], polygon[(k + 1) % polygon.size()]));
      }
    }
    return Contains(p) ? least : -least;
  }
  /// Whether p and all points at that distance from it lie inside.
  bool ContainsAround(Vec2 p, double distance) const {
    constexpr int kDirections = 8;
    for (int k = 0; k < kDirections; ++k) {
      const Vec2 u = LiftRotation<double>(SinCos(2 * std::numbers::pi * k / kDirections));
      if (!Contains(p + distance * u)) return false;
    }
    return true;
  }

 private:
  Vec2 x_;
  std::vector<std::vector<Vec2>> polygons_;
  double reach_ = 0;
};

/// How many contacts every pair of bodies has (first < second).
inline std::map<std::pair<int, int>, int> ContactsOfPairs(const std::vector<Constraint>& constraints) {
  std::map<std::pair<int, int>, int> pairs;
  for (const Constraint& c : constraints) {
    if (c.type == ConstraintType::kContact) ++pairs[std::minmax(c.body1, c.body2)];
  }
  return pairs;
}

/// The share of unilateral rows that separate at the solution: w_i / sqrt(A_ii) above 1e-7 of its root mean square at
/// zero force.
inline double SeparatingShare(const ContactSystem& system, LcpSolver* solver) {
  const AssembledLcp lcp = AssembleContactLcp(system);
  LcpResult result;
  solver->Solve(lcp.problem, {}, &result);
  const Verdict verdict = Verify(lcp.problem, result, 1e-9);
  EXPECT_TRUE(verdict.passes) << system.name << ": " << result.detail << ' ' << verdict.reason;
  const Eigen::ArrayXd root = lcp.problem.DiagonalA().array().sqrt();
  const double scale = std::sqrt((lcp.problem.b().array() / root).square().mean());
  int unilateral = 0;
  int separating = 0;
  for (std::size_t i = 0; i < lcp.rows.size(); ++i) {
    if (lcp.rows[i].bilateral) continue;
    const auto k = static_cast<Index>(i);
    ++unilateral;
    separating += verdict.metrics.w[k] / root[k] > 1e-7 * scale ? 1 : 0;
  }
  return static_cast<double>(separating) / unilateral;
}

/// d'' = J a + gamma of every row where all bodies turn about the origin as one, a = alpha z x x - omega^2 x.
inline Eigen::VectorXd GapAccelerationInRotation(const ContactSystem& system, double omega, double alpha) {
  const AssembledLcp lcp = AssembleContactLcp(system);
  Eigen::VectorXd a(lcp.problem.J().cols());
  for (std::size_t i = 0; i < system.bodies.size(); ++i) {
    const Vec2 x = system.bodies[i].x;
    const Vec2 linear = alpha * Perp(x) - (omega * omega) * x;
    a.segment<3>(static_cast<Index>(3 * i)) << linear.x, linear.y, alpha;
  }
  Eigen::VectorXd result = lcp.problem.J() * a;
  for (std::size_t i = 0; i < lcp.rows.size(); ++i) result[static_cast<Index>(i)] += lcp.rows[i].gamma;
  return result;
}

/// Eigenvalues of the Jacobi-scaled A, ascending.
inline Eigen::VectorXd ScaledEigenvalues(const LcpProblem& problem) {
  const Eigen::VectorXd root = problem.DiagonalA().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = root.asDiagonal() * problem.DenseA() * root.asDiagonal();
  return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(scaled, Eigen::EigenvaluesOnly).eigenvalues();
}

}  // namespace lcpbench::testing
