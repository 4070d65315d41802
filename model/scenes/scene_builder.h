#pragma once

#include <cstdint>
#include <memory>
#include <string_view>
#include <utility>

#include "model/contact/loads.h"
#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/scenes/parts.h"
#include "model/scenes/random.h"
#include "model/scenes/scene.h"

namespace lcpbench {

/// A scene that is being built. Every family derives a class from it, and names Make<that class> in its SceneFamily.
/// The one problem is Build, then Load; the sequence form is BuildMoving, then Launch: the same bodies and joints under
/// other loads than the unbalanced ones of the one problem, which would blow them apart.
class SceneBuilder {
 public:
  SceneBuilder(std::string_view family, int rows, std::uint64_t seed)
      : system_(EmptyScene(family, rows, seed)), rows_(rows), left_(rows), seed_(seed), random_(seed) {}
  virtual ~SceneBuilder() = default;
  SceneBuilder(const SceneBuilder&) = delete;
  SceneBuilder& operator=(const SceneBuilder&) = delete;

  /// Adds bodies and constraints, `rows_` rows in all.
  virtual void Build() = 0;
  /// Sets the forces and torques of the one problem.
  virtual void Load() = 0;
  /// Build, where a motion needs other bodies.
  virtual void BuildMoving() { Build(); }
  /// Changes the world that starts to move, which stands upright in gravity without any other load. The bodies are the
  /// world's now: system_ is empty.
  virtual void Launch(World* /*world*/) {}

  ContactSystem& system() { return system_; }

 protected:
  Body& Get(int body) { return system_.bodies[static_cast<std::size_t>(body)]; }
  const Body& Get(int body) const { return system_.bodies[static_cast<std::size_t>(body)]; }
  int Add(std::string_view kind, Body body) { return AddBody(&system_, kind, std::move(body)); }
  int AddFixed(std::string name, std::vector<OutlineEdge> outline = {}) {
    return Add("", MakeFixed(std::move(name), std::move(outline)));
  }

  /// Piece k of a body's outline as a feature: of a disc, ring or oval its rim, of a box its bottom, right, top, left.
  Feature Piece(int body, std::size_t k = 0) const { return ToFeature(Get(body).outline[k].edge); }
  /// The point at which that piece begins, of a polygon: of a box the lower left corner, and on counter-clockwise.
  Vertex Corner(int body, std::size_t k) const { return {std::get<StraightEdge>(Get(body).outline[k].edge).a}; }
  /// Radius of a body whose outline begins with an arc [m].
  double Radius(int body) const { return std::get<ArcEdge>(Get(body).outline[0].edge).radius; }

  /// One contact, one row.
  Constraint& Touch(int body1, const Feature& feature1, int body2, const Feature& feature2) {
    --left_;
    return AddContact(&system_, body1, feature1, body2, feature2);
  }
  /// The same of the first pieces of their outlines.
  Constraint& Touch(int body1, int body2, const Feature& feature2) {
    return Touch(body1, Piece(body1), body2, feature2);
  }
  Constraint& Touch(int body1, int body2) { return Touch(body1, body2, Piece(body2)); }
  /// A box's lower corners on an edge of another body: two rows.
  void Stand(int box, int on, const Feature& edge) {
    for (const std::size_t k : {0U, 1U}) Touch(box, Corner(box, k), on, edge);
  }
  /// A joint between two body-frame points, or a point and an edge.
  Constraint& Join(ConstraintType type, int body1, Vec2 p1, int body2, const Feature& feature2) {
    return AddConstraint(&system_, type, body1, Vertex{p1}, body2, feature2);
  }
  /// The upper side of a floor at y = 0, as contact needs it.
  static StraightEdge Floor() { return {{1, 0}, {}}; }

  Vec2 RandomDirection() { return Direction(random_.Uniform(0, 2 * kPi)); }
  /// Weight and independent random forces and torques on every movable body, in body order.
  void Apply(const LoadLevel& level);

  ContactSystem system_;
  int rows_;
  int left_;  ///< rows that are still to be made, where all of them are contacts
  std::uint64_t seed_;
  Random random_;
};

template <class Builder>
std::unique_ptr<SceneBuilder> Make(std::string_view family, int rows, std::uint64_t seed) {
  return std::make_unique<Builder>(family, rows, seed);
}

/// The world of which `system` is one instant, under gravity [m/s^2] alone.
World WorldUnderGravity(ContactSystem system, Vec2 gravity);

/// Random velocities of bodies that lie still otherwise [m/s]: of centres of mass, and of points one radius of gyration
/// away by spin. Small against the speeds of falling by a body's size (1 to 2 m/s), so that contacts last.
inline constexpr double kStir = 0.1;

/// Adds a random velocity of up to `speed` in a random direction, and a spin of up to speed / sqrt(I / m), to every
/// movable body, in body order. The same seed gives the same bits.
void Stir(World* world, double speed, std::uint64_t seed);

}  // namespace lcpbench
