#pragma once

#include <cstdint>
#include <memory>
#include <string_view>

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
  /// One contact, one row.
  void Touch(int body1, const Feature& feature1, int body2, const Feature& feature2) {
    AddContact(&system_, body1, feature1, body2, feature2);
    --left_;
  }
  /// The upper side of a floor at y = 0, as contact needs it.
  static StraightEdge Floor() { return {{1, 0}, {}}; }

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
