// DART 6.12: its own step of scenes of its examples.
//
// DART detects contacts at the start of a step and adds loads before it solves. So bodies are read before
// World::step(), contacts after it, from the last collision result. Contacts are those of DART's own detector; it keeps
// none from step to step, their identities are those of ContactNames within a tenth of the smaller body's size. DART
// has joint coordinates: rows of joints are ours, of the joint's anchor and axis. The torque has -omega x I omega.
//
// The scenes are built anew from what the examples' sources state: shapes, masses, places. Where an example sets no
// inertia, it is DART's default: 1 kg and 1 kg m^2 about every axis.

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <dart/collision/CollisionObject.hpp>
#include <dart/collision/CollisionResult.hpp>
#include <dart/collision/dart/DARTCollisionDetector.hpp>
#include <dart/constraint/ConstraintSolver.hpp>
#include <dart/dynamics/BallJoint.hpp>
#include <dart/dynamics/BodyNode.hpp>
#include <dart/dynamics/BoxShape.hpp>
#include <dart/dynamics/FreeJoint.hpp>
#include <dart/dynamics/RevoluteJoint.hpp>
#include <dart/dynamics/ShapeNode.hpp>
#include <dart/dynamics/Skeleton.hpp>
#include <dart/dynamics/WeldJoint.hpp>
#include <dart/simulation/World.hpp>
#include <functional>
#include <map>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/recorders/contact_names.h"
#include "benchmarks/recorders/recording.h"

namespace lcpbench::recorders {
namespace {

namespace dynamics = dart::dynamics;
using Eigen::Isometry3d;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Isometry3d At(const Vector3d& x, const Matrix3d& R = Matrix3d::Identity()) {
  Isometry3d place = Isometry3d::Identity();
  place.translation() = x;
  place.linear() = R;
  return place;
}

/// A world with what is in it.
class Stage {
 public:
  Stage() { world->getConstraintSolver()->setCollisionDetector(dart::collision::DARTCollisionDetector::create()); }

  /// A box that moves freely.
  /// @param mass  nullopt: DART's default inertia
  dynamics::BodyNode* Box(std::optional<double> mass, const Vector3d& sides, const Isometry3d& place) {
    const dynamics::SkeletonPtr skeleton = NewSkeleton();
    const auto [joint, body] = skeleton->createJointAndBodyNodePair<dynamics::FreeJoint>();
    const auto shape = std::make_shared<dynamics::BoxShape>(sides);
    if (mass) body->setInertia(dynamics::Inertia(*mass, Vector3d::Zero(), shape->computeInertia(*mass)));
    AddShape(body, shape, sides);
    joint->setTransformFromParentBodyNode(place);
    return Keep(skeleton, body);
  }

  /// A box that never moves.
  dynamics::ShapeNode* Fixed(const Vector3d& sides, const Vector3d& x) {
    const dynamics::SkeletonPtr skeleton = NewSkeleton();
    const auto [joint, body] = skeleton->createJointAndBodyNodePair<dynamics::WeldJoint>();
    joint->setTransformFromParentBodyNode(At(x));
    dynamics::ShapeNode* const shape = AddShape(body, std::make_shared<dynamics::BoxShape>(sides), sides);
    world->addSkeleton(skeleton);
    return shape;
  }

  dynamics::SkeletonPtr NewSkeleton() {
    return dynamics::Skeleton::create("skeleton " + std::to_string(world->getNumSkeletons()));
  }
  dynamics::ShapeNode* AddShape(dynamics::BodyNode* body, const dynamics::ShapePtr& shape, const Vector3d& sides) {
    auto* const node = body->createShapeNodeWith<dynamics::CollisionAspect, dynamics::DynamicsAspect>(shape);
    shapes_[node] = {static_cast<int>(shapes_.size()), sides.minCoeff()};
    return node;
  }
  /// Bodies of a skeleton are numbered in the order in which they are kept; the last one adds the skeleton.
  dynamics::BodyNode* Keep(const dynamics::SkeletonPtr& skeleton, dynamics::BodyNode* body) {
    index_[body] = static_cast<int>(bodies.size());
    bodies.push_back(body);
    if (!world->hasSkeleton(skeleton)) world->addSkeleton(skeleton);
    return body;
  }

  void Advance(int number, Step* step) {
    if (drive) drive(number);
    if (step != nullptr) WriteState(step);
    std::vector<Isometry3d, Eigen::aligned_allocator<Isometry3d>> places;
    for (const dynamics::BodyNode* body : bodies) places.push_back(body->getTransform());
    world->step();
    const std::vector<dart::collision::Contact>& contacts = world->getLastCollisionResult().getContacts();
    std::vector<ContactNames::Contact> asked;
    for (const dart::collision::Contact& contact : contacts) {
      const Shape& first = ShapeOf(contact.collisionObject1);
      const Shape& second = ShapeOf(contact.collisionObject2);
      const int body = std::max(BodyOf(contact.collisionObject1), BodyOf(contact.collisionObject2));
      const Vector3d place =
          body < 0 ? contact.point : Vector3d(places[static_cast<std::size_t>(body)].inverse() * contact.point);
      asked.push_back({std::minmax(first.number, second.number),
                       {place.x(), place.y(), place.z()},
                       0.1 * std::min(first.size, second.size)});
    }
    const std::vector<int> numbers = names_.Number(asked);
    for (std::size_t k = 0; step != nullptr && k < contacts.size(); ++k) {
      const dart::collision::Contact& contact = contacts[k];
      // DART's normal points from its second body to its first.
      const int i = BodyOf(contact.collisionObject2);
      const int j = BodyOf(contact.collisionObject1);
      if (i == j) continue;
      step->Contact(i, j, Vector(contact.point), Vector(contact.normal.normalized()), -contact.penetrationDepth,
                    std::min(Friction(contact.collisionObject1), Friction(contact.collisionObject2)),
                    ContactId(asked[k].pair.first, asked[k].pair.second, numbers[k]), {"box", "box"}, {0, 0});
    }
  }

  Json Gravity() const { return Vector(world->getGravity()); }
  double TimeStep() const { return world->getTimeStep(); }
  Json Bodies() const {
    Json list = Json::array();
    for (const dynamics::BodyNode* body : bodies) {
      const Matrix3d moment = body->getInertia().getMoment();
      if (!moment.isDiagonal(1e-12)) {
        std::fprintf(stderr, "recorder: a body's axes are not principal\n");
        std::exit(1);
      }
      list.push_back(recorders::BodyOf(1 / body->getMass(), Vector(moment.diagonal().cwiseInverse())));
    }
    return list;
  }

  dart::simulation::WorldPtr world = dart::simulation::World::create();
  std::vector<dynamics::BodyNode*> bodies;
  std::function<void(int step)> drive;

 private:
  struct Shape {
    int number = 0;
    double size = 0;
  };

  static const dynamics::ShapeNode* NodeOf(const dart::collision::CollisionObject* object) {
    return object->getShapeFrame()->asShapeNode();
  }
  const Shape& ShapeOf(const dart::collision::CollisionObject* object) const { return shapes_.at(NodeOf(object)); }
  int BodyOf(const dart::collision::CollisionObject* object) const {
    return IndexOf(index_, NodeOf(object)->getBodyNodePtr());
  }
  static double Friction(const dart::collision::CollisionObject* object) {
    return NodeOf(object)->getDynamicsAspect()->getFrictionCoeff();
  }

  void WriteState(Step* step) const {
    for (const dynamics::BodyNode* body : bodies) {
      const Matrix3d R = body->getTransform().linear();
      const Vector3d x = body->getCOM();
      const Vector3d omega = body->getAngularVelocity();
      const Eigen::Matrix<double, 6, 1> load = body->getExternalForceGlobal();  // torque about the origin, force
      const Vector3d force = load.tail<3>();
      const Vector3d gyroscopic = -omega.cross(R * body->getInertia().getMoment() * R.transpose() * omega);
      step->Body(Vector(x), Quaternion(Eigen::Quaterniond(R)), Vector(body->getCOMLinearVelocity()), Vector(omega),
                 Vector(force + body->getMass() * world->getGravity()),
                 Vector(load.head<3>() - x.cross(force) + gyroscopic));
    }
    std::size_t number = 0;
    for (const dynamics::BodyNode* body : bodies) {
      const dynamics::Joint* const joint = body->getParentJoint();
      const auto* const hinge = dynamic_cast<const dynamics::RevoluteJoint*>(joint);
      if (hinge == nullptr && dynamic_cast<const dynamics::BallJoint*>(joint) == nullptr) continue;
      const dynamics::BodyNode* const parent = body->getParentBodyNode();
      const Isometry3d frame = body->getTransform() * joint->getTransformFromChildBodyNode();
      std::vector<JointRow> rows;
      const auto add = [&](const Vector3d& d, bool is_turning) {
        JointRow row;
        for (const auto& [end, sign] : {std::pair{parent, -1.0}, {body, 1.0}}) {
          const Vector3d lever = end == nullptr ? Vector3d::Zero() : Vector3d(frame.translation() - end->getCOM());
          const Vector3d linear = is_turning ? Vector3d::Zero() : Vector3d(sign * d);
          const Vector3d angular = sign * (is_turning ? d : Vector3d(lever.cross(d)));
          row.J.insert(row.J.end(), linear.begin(), linear.end());
          row.J.insert(row.J.end(), angular.begin(), angular.end());
        }
        rows.push_back(std::move(row));
      };
      for (int k = 0; k < 3; ++k) add(Vector3d::Unit(k), false);
      if (hinge != nullptr) {
        const Vector3d axis = frame.linear() * hinge->getAxis();
        const Vector3d across = axis.unitOrthogonal();
        add(across, true);
        add(axis.cross(across), true);
      }
      step->Joint(IndexOf(index_, parent), index_.at(body), hinge == nullptr ? "ball" : "hinge", number++, rows);
    }
  }

  std::map<const dynamics::BodyNode*, int> index_;
  std::map<const dynamics::ShapeNode*, Shape> shapes_;
  ContactNames names_;
};

void BoxStacking(Stage& stage) {
  stage.Fixed(Vector3d(10, 10, 0.01), Vector3d(0, 0, -0.005));
  for (int i = 0; i < 5; ++i) stage.Box({}, Vector3d(1, 1, 0.5), At(Vector3d(0, 0, 0.75 + 0.5 * i)));
}

void Boxes(Stage& stage) {
  for (int i = -2; i <= 2; ++i)
    for (int j = -2; j <= 2; ++j)
      for (int k = 0; k < 5; ++k)
        stage.Box({}, Vector3d::Constant(0.9), At(Vector3d(i, j, k + 1)))
            ->getShapeNode(0)
            ->getDynamicsAspect()
            ->setRestitutionCoeff(0.9);
  stage.Fixed(Vector3d(25, 25, 0.1), Vector3d::Zero())->getDynamicsAspect()->setRestitutionCoeff(0.9);
}

void RigidCubes(Stage& stage) {
  stage.world->setGravity(Vector3d(0, -9.81, 0));
  stage.Fixed(Vector3d(2.5, 0.05, 2.5), Vector3d(0, -0.375, 0));
  stage.Box(1, Vector3d(0.1, 0.05, 0.1), At(Vector3d(0, -0.325, 0)));
  stage.Box(1, Vector3d::Constant(0.05), At(Vector3d(0, -0.275, 0)));
  stage.Box(1, Vector3d::Constant(0.05), At(Vector3d(0.05, -0.195, 0)));
}

/// Boxes as a key adds them: sides of 0.05 to 0.25 m, 10 kg, moments of 1 kg m^2.
void RigidShapes(Stage& stage) {
  Uniform uniform;
  stage.world->setGravity(Vector3d(0, -9.81, 0));
  stage.Fixed(Vector3d(10, 0.01, 10), Vector3d(0, -0.38, 0));
  for (int k = 0; k < 80; ++k) {
    const auto draw = [&](double low, double high) {
      const double x = uniform(low, high), y = uniform(low, high), z = uniform(low, high);
      return Vector3d(x, y, z);
    };
    const Vector3d sides = draw(0.05, 0.25);
    const Vector3d turn = draw(-std::numbers::pi, std::numbers::pi);
    const Vector3d jitter = draw(-0.05, 0.05);
    const Vector3d x =
        0.3 * Vector3d(k % 4 - 1.5, std::floor(k / 16.0), std::floor(k / 4.0) - 4 * std::floor(k / 16.0) - 1.5) +
        jitter;
    const Matrix3d R = Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix();
    stage.Box({}, sides, At(x, R))->setMass(10);
  }
}

/// 25 dominoes, of which the first is pushed; three of its bends of 20 degrees follow each other.
void Dominoes(Stage& stage) {
  const double height = 0.3, width = 0.4 * height, depth = width / 5;
  const double mass = 2.6e3 * height * width * depth;
  stage.Fixed(Vector3d(10, 10, 0.01), Vector3d(0, 0, -0.005));
  double heading = 0;
  Vector3d x(0, 0, height / 2);
  for (int k = 0; k < 25; ++k) {
    const double bend = k >= 8 && k < 11 ? std::numbers::pi / 9 : 0;
    stage.Box(mass, Vector3d(depth, width, height),
              At(x, Eigen::AngleAxisd(heading + bend, Vector3d::UnitZ()).toRotationMatrix()));
    heading += bend;
    x += height / 2 * Vector3d(std::cos(heading), std::sin(heading), 0);
  }
  stage.drive = [first = stage.bodies[0], height](int step) {
    if (step < 200) first->addExtForce(8 * Vector3d::UnitX(), height / 2 * Vector3d::UnitZ());
  };
}

/// Five rods on a ball joint and hinges, that meet a floor.
void MultiPendulum(Stage& stage) {
  const Vector3d sides = {0.2, 0.2, 1};
  stage.Fixed(Vector3d(20, 20, 0.1), Vector3d(0, 0, -3.05));
  const dynamics::SkeletonPtr skeleton = stage.NewSkeleton();
  dynamics::BodyNode* parent = nullptr;
  for (int k = 0; k < 5; ++k) {
    dynamics::BodyNode* body = nullptr;
    if (parent == nullptr) {
      body = skeleton->createJointAndBodyNodePair<dynamics::BallJoint>().second;
    } else {
      dynamics::RevoluteJoint::Properties hinge;
      hinge.mName = "hinge " + std::to_string(k);
      hinge.mAxis = Vector3d::UnitY();
      hinge.mT_ParentBodyToJoint = At(Vector3d::UnitZ());
      dynamics::BodyNode::Properties properties;
      properties.mName = "rod " + std::to_string(k);
      body = skeleton->createJointAndBodyNodePair<dynamics::RevoluteJoint>(parent, hinge, properties).second;
    }
    stage.AddShape(body, std::make_shared<dynamics::BoxShape>(sides), sides)
        ->setRelativeTransform(At(0.5 * Vector3d::UnitZ()));
    body->setLocalCOM(0.5 * Vector3d::UnitZ());
    parent = body;
  }
  for (std::size_t k = 0; k < skeleton->getNumBodyNodes(); ++k) stage.Keep(skeleton, skeleton->getBodyNode(k));
  skeleton->getDof(1)->setPosition(2 * std::numbers::pi / 3);
}

constexpr SceneEntry<Stage> kScenes[] = {
    {"box-stacking", "examples/box_stacking/main.cpp", "", BoxStacking},
    {"boxes", "examples/boxes/main.cpp", "boxes 4 m lower; DART's own collision detector in place of Bullet's", Boxes},
    {"rigid-cubes", "data/skel/cubes.skel", "", RigidCubes},
    {"rigid-shapes", "examples/rigid_shapes/main.cpp",
     "80 of its random boxes, dropped at once from a lattice; without its other shapes", RigidShapes},
    {"dominoes", "tutorials/tutorial_dominoes_finished/main.cpp",
     "25 dominoes in a line with three bends, without the manipulator", Dominoes},
    {"multi-pendulum", "tutorials/tutorial_multi_pendulum_finished/main.cpp",
     "with a floor 3 m below its joint, without damping", MultiPendulum},
};

const Engine kEngine = {
    .name = "dart",
    .version = "6.12.1",
    .licence = "BSD-2-Clause",
    .folder = "",
    .rebuilt = " of DART's source, rebuilt and stepped by Debian's libdart 6.12.1+dfsg4-12",
    .left_out = "friction, restitution; the torque has -omega x I omega; joints, coordinates in DART, stand as rows",
    .dimension = 3};

}  // namespace
}  // namespace lcpbench::recorders

int main(int argc, char** argv) {
  using namespace lcpbench::recorders;
  return RunRecorder<Stage>(argc, argv, kEngine, kScenes);
}
