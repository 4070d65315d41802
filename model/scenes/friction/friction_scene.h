#pragma once

#include <string>
#include <utility>

#include "model/contact/system.h"
#include "model/contact/world.h"
#include "model/scenes/random.h"
#include "model/scenes/scene_builder.h"

namespace lcpbench {

/// A scene with friction that is being built by a function of its numbers. Built as if gravity pointed down; a slope is
/// the whole scene turned.
class FrictionScene final : public SceneBuilder {
 public:
  FrictionScene() : SceneBuilder("", 0, 0) {}
  using SceneBuilder::Add;
  using SceneBuilder::AddFixed;
  using SceneBuilder::Corner;
  using SceneBuilder::Floor;
  using SceneBuilder::Get;
  using SceneBuilder::Join;
  using SceneBuilder::Piece;
  using SceneBuilder::Stand;
  using SceneBuilder::Touch;

  /// A floor at y = 0 from x = low to high.
  int AddFloor(double low, double high) { return AddFixed("floor", {WholeEdge({high, 0}, {low, 0})}); }
  /// A force at a point of the world.
  void Push(int body, Vec2 point, Vec2 force);
  /// The scene: friction mu on every body and contact, weights, all turned clockwise by `slope` [rad] against gravity.
  ContactSystem Finish(double mu, double slope = 0, double gravity = kGravity);

 private:
  void Build() override {}
  void Load() override {}
};

/// The builder of a family whose scenes a function draws. They move under the loads that they stand under.
/// @tparam draw  a scene of at most `rows` rows, tangents among them, or of the least size there is
template <ContactSystem (*draw)(int rows, Random* random)>
class DrawnScene : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    const std::string name = std::move(system_.name);
    system_ = draw(rows_, &random_);
    system_.name = name;
    drawn_ = WorldOf(system_);
  }
  void Load() override {}
  void Launch(World* world) override { *world = drawn_; }

 private:
  World drawn_;
};

/// The time step of a family with friction [s].
inline constexpr double kFrictionStep = 0.01;

}  // namespace lcpbench
