// Bullet 3.24: its own step of scenes of its example browser.
//
// A recorded step is what btDiscreteDynamicsWorld::solveConstraints() is given: after collision detection and damping,
// before gravity and other loads are added. Contacts are the points of the persistent manifolds, and their identities
// the engine's: a point keeps its user data while the manifold holds it to be the same. Rows of joints are those that
// the joint itself hands to the solver; a row that bounds its impulse on both sides is a motor and left out. Torques
// are those that the solver adds, its implicit gyroscopic one included.
//
// The scenes are built anew from what the examples' sources state: shapes, masses, places, limits.

#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/recorders/recording.h"

#ifndef BT_USE_DOUBLE_PRECISION
#error "Bullet's double precision is wanted (pkg-config bullet-float64)"
#endif

namespace lcpbench::recorders {
namespace {

constexpr double kTimeStep = 1.0 / 60;
constexpr double kPi = std::numbers::pi;

/// Bodies of the recording are the dynamic ones, numbered by their user index; all others are the world.
int BodyIndex(const btCollisionObject& object) {
  return object.isStaticOrKinematicObject() ? -1 : object.getUserIndex();
}

std::string ShapeName(const btCollisionShape& shape) {
  return NameOf(shape.getShapeType(),
                {{BOX_SHAPE_PROXYTYPE, "box"},
                 {SPHERE_SHAPE_PROXYTYPE, "sphere"},
                 {CAPSULE_SHAPE_PROXYTYPE, "capsule"},
                 {CYLINDER_SHAPE_PROXYTYPE, "cylinder"},
                 {CONE_SHAPE_PROXYTYPE, "cone"},
                 {STATIC_PLANE_PROXYTYPE, "plane"}},
                "compound");
}

double Radius(const btCollisionShape& shape) {
  return shape.getShapeType() == SPHERE_SHAPE_PROXYTYPE ? static_cast<const btSphereShape&>(shape).getRadius() : 0;
}

std::string JointName(const btTypedConstraint& joint) {
  return NameOf(joint.getConstraintType(),
                {{POINT2POINT_CONSTRAINT_TYPE, "ball"},
                 {HINGE_CONSTRAINT_TYPE, "hinge"},
                 {CONETWIST_CONSTRAINT_TYPE, "cone twist"},
                 {SLIDER_CONSTRAINT_TYPE, "slider"}},
                "joint");
}

btMatrix3x3 WorldInertia(const btRigidBody& body) {
  const btMatrix3x3& R = body.getWorldTransform().getBasis();
  return R.scaled(body.getLocalInertia()) * R.transpose();
}

/// The torque that the solver adds for the turning of the body's axes [N m].
btVector3 GyroscopicTorque(const btRigidBody& body, const btContactSolverInfo& info) {
  btVector3 torque(0, 0, 0);
  if (body.getFlags() & BT_ENABLE_GYROSCOPIC_FORCE_EXPLICIT)
    torque -= body.computeGyroscopicForceExplicit(info.m_maxGyroscopicForce);
  btVector3 change(0, 0, 0);  // of the angular velocity
  if (body.getFlags() & BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_WORLD)
    change += body.computeGyroscopicImpulseImplicit_World(info.m_timeStep);
  if (body.getFlags() & BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY)
    change += body.computeGyroscopicImpulseImplicit_Body(info.m_timeStep);
  return torque + WorldInertia(body) * change / info.m_timeStep;
}

/// What a joint hands to the solver, one record a row; btVector3 because joints write through that type.
struct EngineRow {
  btVector3 linear_a, angular_a, linear_b, angular_b;
  btScalar error, cfm, lower, upper;
};

/// Asks the joint for its rows while the bodies rest, so that no bounce at a limit enters the error.
std::vector<JointRow> JointRows(btTypedConstraint* joint, int iterations) {
  btRigidBody& a = joint->getRigidBodyA();
  btRigidBody& b = joint->getRigidBodyB();
  std::array<btVector3, 4> velocities = {a.getLinearVelocity(), a.getAngularVelocity(), b.getLinearVelocity(),
                                         b.getAngularVelocity()};
  for (btRigidBody* body : {&a, &b}) {
    body->setLinearVelocity(btVector3(0, 0, 0));
    body->setAngularVelocity(btVector3(0, 0, 0));
  }
  btTypedConstraint::btConstraintInfo1 count;
  joint->getInfo1(&count);
  const btVector3 zero(0, 0, 0);
  std::vector<EngineRow> rows(static_cast<std::size_t>(count.m_numConstraintRows),
                              {zero, zero, zero, zero, 0, 0, -SIMD_INFINITY, SIMD_INFINITY});
  if (!rows.empty()) {
    btTypedConstraint::btConstraintInfo2 info = {};
    info.fps = 1;
    info.erp = 1;
    info.m_J1linearAxis = rows[0].linear_a;
    info.m_J1angularAxis = rows[0].angular_a;
    info.m_J2linearAxis = rows[0].linear_b;
    info.m_J2angularAxis = rows[0].angular_b;
    info.rowskip = sizeof(EngineRow) / sizeof(btScalar);
    info.m_constraintError = &rows[0].error;
    info.cfm = &rows[0].cfm;
    info.m_lowerLimit = &rows[0].lower;
    info.m_upperLimit = &rows[0].upper;
    info.m_numIterations = iterations;
    info.m_damping = 1;
    joint->getInfo2(&info);
  }
  a.setLinearVelocity(velocities[0]);
  a.setAngularVelocity(velocities[1]);
  b.setLinearVelocity(velocities[2]);
  b.setAngularVelocity(velocities[3]);

  std::vector<JointRow> result;
  for (const EngineRow& row : rows) {
    const bool is_bounded_below = row.lower > -SIMD_INFINITY;  // the impulse
    const bool is_bounded_above = row.upper < SIMD_INFINITY;
    if (is_bounded_below && is_bounded_above) continue;  // a motor
    const double sign = is_bounded_above ? -1 : 1;
    JointRow written{.J = {}, .error = -sign * row.error, .is_limit = is_bounded_below || is_bounded_above};
    const auto append = [&](const btVector3& v, const btRigidBody& body) {
      for (int k = 0; k < 3; ++k) written.J.push_back(BodyIndex(body) < 0 ? 0 : sign * v[k]);
    };
    append(row.linear_a, a);
    append(row.angular_a, a);
    append(row.linear_b, b);
    append(row.angular_b, b);
    if (std::ranges::any_of(written.J, [](double x) { return x != 0; })) result.push_back(std::move(written));
  }
  return result;
}

class RecordedWorld : public btDiscreteDynamicsWorld {
 public:
  using btDiscreteDynamicsWorld::btDiscreteDynamicsWorld;

  void Advance(Step* step) {
    step_ = step;
    stepSimulation(kTimeStep, 0);
  }

  void solveConstraints(btContactSolverInfo& info) override {
    const std::vector<Contact> contacts = NameContacts();
    if (step_ != nullptr) Write(contacts, info, step_);
    btDiscreteDynamicsWorld::solveConstraints(info);
  }

 private:
  struct Contact {
    const btPersistentManifold* manifold;
    const btManifoldPoint* point;
    std::string id;
  };

  /// The contacts in the order of bodies. A point's user data is its number within the pair, from 1.
  std::vector<Contact> NameContacts() {
    std::vector<Contact> contacts;
    btDispatcher& dispatcher = *getDispatcher();
    for (int m = 0; m < dispatcher.getNumManifolds(); ++m) {
      btPersistentManifold* const manifold = dispatcher.getManifoldByIndexInternal(m);
      const btCollisionObject& a = *manifold->getBody0();
      const btCollisionObject& b = *manifold->getBody1();
      if (BodyIndex(a) < 0 && BodyIndex(b) < 0) continue;
      const std::pair<int, int> pair = std::minmax(a.getWorldArrayIndex(), b.getWorldArrayIndex());
      for (int k = 0; k < manifold->getNumContacts(); ++k) {
        btManifoldPoint& point = manifold->getContactPoint(k);
        if (point.getDistance() > manifold->getContactProcessingThreshold()) continue;
        auto number = reinterpret_cast<std::uintptr_t>(point.m_userPersistentData);
        if (number == 0) {
          // Between two spheres the engine forgets its only point in every step.
          number = Radius(*a.getCollisionShape()) > 0 && Radius(*b.getCollisionShape()) > 0 ? 1 : ++last_number_[pair];
          point.m_userPersistentData = reinterpret_cast<void*>(number);  // NOLINT(performance-no-int-to-ptr)
        }
        contacts.push_back({manifold, &point, ContactId(pair.first, pair.second, number)});
      }
    }
    return contacts;
  }

  void Write(const std::vector<Contact>& contacts, const btContactSolverInfo& info, Step* step) {
    for (int k = 0; k < getNumCollisionObjects(); ++k) {
      const btRigidBody& body = *btRigidBody::upcast(getCollisionObjectArray()[k]);
      if (BodyIndex(body) < 0) continue;
      step->Body(Vector(body.getCenterOfMassPosition()), Quaternion(body.getOrientation()),
                 Vector(body.getLinearVelocity()), Vector(body.getAngularVelocity()), Vector(body.getTotalForce()),
                 Vector(body.getTotalTorque() + GyroscopicTorque(body, info)));
    }
    for (const Contact& contact : contacts) {
      // Bullet's normal points from its second body to its first.
      const btCollisionObject& i = *contact.manifold->getBody1();
      const btCollisionObject& j = *contact.manifold->getBody0();
      const btManifoldPoint& point = *contact.point;
      const btVector3 middle = (point.getPositionWorldOnA() + point.getPositionWorldOnB()) / 2;
      step->Contact(BodyIndex(i), BodyIndex(j), Vector(middle), Vector(point.m_normalWorldOnB), point.getDistance(),
                    point.m_combinedFriction, contact.id,
                    {ShapeName(*i.getCollisionShape()), ShapeName(*j.getCollisionShape())},
                    {Radius(*i.getCollisionShape()), Radius(*j.getCollisionShape())});
    }
    for (int k = 0; k < getNumConstraints(); ++k) {
      btTypedConstraint* const joint = getConstraint(k);
      step->Joint(BodyIndex(joint->getRigidBodyA()), BodyIndex(joint->getRigidBodyB()), JointName(*joint),
                  static_cast<std::size_t>(k), JointRows(joint, info.m_numIterations));
    }
  }

  std::map<std::pair<int, int>, std::uintptr_t> last_number_;
  Step* step_ = nullptr;  // to fill
};

btTransform At(double x, double y, double z, const btQuaternion& rotation = btQuaternion::getIdentity()) {
  return btTransform(rotation, btVector3(x, y, z));
}
btQuaternion AboutY(double angle) { return btQuaternion(btVector3(0, 1, 0), angle); }
btQuaternion AboutZ(double angle) { return btQuaternion(btVector3(0, 0, 1), angle); }

/// A world with what is in it. y is up where the scene does not say otherwise.
class Stage {
 public:
  Stage() : dispatcher_(&configuration_), world(&dispatcher_, &broadphase_, &solver_, &configuration_) {
    world.setGravity(btVector3(0, -10, 0));
  }
  ~Stage() {
    for (const auto& joint : joints_) world.removeConstraint(joint.get());
    for (const auto& body : bodies) world.removeRigidBody(body.get());
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  template <class Shape, class... Arguments>
  Shape* Make(Arguments&&... arguments) {
    auto shape = std::make_unique<Shape>(std::forward<Arguments>(arguments)...);
    Shape* const result = shape.get();
    shapes_.push_back(std::move(shape));
    return result;
  }
  btBoxShape* Box(double x, double y, double z) { return Make<btBoxShape>(btVector3(x, y, z)); }

  /// @param inertia  nullptr: that of the shape
  btRigidBody* Add(double mass, const btTransform& place, btCollisionShape* shape, const btVector3* inertia = nullptr) {
    btVector3 diagonal(0, 0, 0);
    if (inertia != nullptr)
      diagonal = *inertia;
    else if (mass > 0)
      shape->calculateLocalInertia(mass, diagonal);
    btRigidBody::btRigidBodyConstructionInfo info(mass, nullptr, shape, diagonal);
    info.m_startWorldTransform = place;
    bodies.push_back(std::make_unique<btRigidBody>(info));
    btRigidBody* const body = bodies.back().get();
    if (mass > 0) {
      body->setUserIndex(dynamic_bodies_++);
      body->setActivationState(DISABLE_DEACTIVATION);
    }
    world.addRigidBody(body);
    return body;
  }
  void Ground() { Add(0, At(0, -50, 0), Box(50, 50, 50)); }

  void Advance(int /*number*/, Step* step) { world.Advance(step); }
  Json Gravity() const { return Vector(world.getGravity()); }
  static double TimeStep() { return kTimeStep; }
  Json Bodies() const {
    Json list = Json::array();
    for (const auto& body : bodies)
      if (BodyIndex(*body) >= 0) list.push_back(BodyOf(body->getInvMass(), Vector(body->getInvInertiaDiagLocal())));
    return list;
  }

  template <class Joint, class... Arguments>
  Joint* Connect(bool excludes_contact, Arguments&&... arguments) {
    auto joint = std::make_unique<Joint>(std::forward<Arguments>(arguments)...);
    Joint* const result = joint.get();
    joints_.push_back(std::move(joint));
    world.addConstraint(result, excludes_contact);
    return result;
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broadphase_;
  btSequentialImpulseConstraintSolver solver_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btTypedConstraint>> joints_;
  int dynamic_bodies_ = 0;

 public:
  RecordedWorld world;
  std::vector<std::unique_ptr<btRigidBody>> bodies;
};

/// A lattice of 5 x 5 x 5 bodies that just touch, 2 m above the ground.
void Basic(Stage& stage, btCollisionShape* shape) {
  stage.Ground();
  for (int k = 0; k < 5; ++k)
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) stage.Add(1, At(0.2 * i, 2 + 0.2 * k, 0.2 * j), shape);
}

void MultipleBoxes(Stage& stage) {
  stage.Ground();
  btBoxShape* const box = stage.Box(1, 1, 1);
  for (int i = 0; i < 10; ++i) stage.Add(1, At(0, 20 + 2 * i, 0), box);
}

/// Its frame moved to the centre of mass and turned to the principal axes.
btCompoundShape* PrincipalCompound(Stage& stage, const std::vector<std::pair<btCollisionShape*, btTransform>>& parts,
                                   std::vector<double> masses, btVector3* inertia) {
  btCompoundShape raw;
  for (const auto& [shape, place] : parts) raw.addChildShape(place, shape);
  btTransform principal;
  raw.calculatePrincipalAxisTransform(masses.data(), principal, *inertia);
  auto* const compound = stage.Make<btCompoundShape>();
  for (const auto& [shape, place] : parts) compound->addChildShape(principal.inverse() * place, shape);
  return compound;
}

void CompoundBoxes(Stage& stage) {
  stage.Ground();
  btBoxShape* const cube = stage.Box(0.5, 0.5, 0.5);
  btVector3 inertia;
  btCompoundShape* const angle =
      PrincipalCompound(stage, {{cube, At(0, 0, 0)}, {cube, At(0, -1, 0)}, {cube, At(0, 0, 1)}}, {1, 1, 1}, &inertia);
  for (int k = 0; k < 4; ++k)
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) stage.Add(1, At(2.2 * i + 0.3 * k, 3 + 2.5 * k, 2.2 * j), angle);
}

void BenchmarkGround(Stage& stage) {
  stage.world.getSolverInfo().m_solverMode |= SOLVER_ENABLE_FRICTION_DIRECTION_CACHING;
  stage.world.getSolverInfo().m_numIterations = 5;
  stage.Add(0, At(0, -50, 0), stage.Box(250, 50, 250));
}

/// Benchmark 1: sparse columns of cubes, each layer shifted, that fall into a heap.
void Boxes3000(Stage& stage) {
  constexpr int kSize = 8, kLayers = 8;
  BenchmarkGround(stage);
  btBoxShape* const cube = stage.Box(1, 1, 1);
  double offset = -kSize * 3 * 0.5;
  for (int k = 0; k < kLayers; ++k) {
    for (int j = 0; j < kSize; ++j)
      for (int i = 0; i < kSize; ++i) stage.Add(2, At(offset + 3 * i, 2 + 3 * k, offset + 3 * j), cube);
    offset -= 0.05 * (kSize - 1);
  }
}

/// Benchmark 2 is a pyramid, three walls and a tower: recorded one by one.
void Wall(Stage& stage) {
  BenchmarkGround(stage);
  btBoxShape* const cube = stage.Box(1, 1, 1);
  for (int size = 12; size > 0; --size)
    for (int i = 0; i < size; ++i) stage.Add(1, At(0, 1 + 2 * (12 - size), -size + 2 * i), cube);
}

void Pyramid(Stage& stage) {
  constexpr int kSize = 8;
  BenchmarkGround(stage);
  btBoxShape* const cube = stage.Box(1, 1, 1);
  const double pitch = 2 * 1.02 + 0.0001;
  double y = 1;
  for (int size = kSize; size > 0; --size) {
    const double corner = -kSize * pitch / 2 + 1.02 * (kSize - size);
    for (int j = 0; j < size; ++j)
      for (int i = 0; i < size; ++i) stage.Add(1, At(corner + pitch * i, y, corner + pitch * j), cube);
    y += pitch;
  }
}

void Tower(Stage& stage) {
  constexpr int kLayers = 8, kAround = 24;
  BenchmarkGround(stage);
  btBoxShape* const cube = stage.Box(1, 1, 1);
  const double radius = 1.3 * kAround / kPi;
  double angle = kPi;
  for (int k = 0; k < kLayers; ++k) {
    for (int j = 0; j < kAround; ++j) {
      const btQuaternion rotation = AboutY(angle);
      stage.Add(1, btTransform(rotation, quatRotate(rotation, btVector3(0, 1 + 2 * k, radius))), cube);
      angle += 2 * kPi / kAround;
    }
    angle += kPi / kAround;
  }
}

/// Eleven capsules, joints with limits at hips, knees, shoulders, elbows, waist and neck.
void AddRagdoll(Stage& stage, const btVector3& origin, double scale) {
  enum Part { kPelvis, kSpine, kHead, kThighL, kShinL, kThighR, kShinR, kArmL, kForearmL, kArmR, kForearmR };
  struct PartSize {
    double radius, height, x, y, roll;
  };
  constexpr PartSize kParts[] = {{0.15, 0.20, 0, 1, 0},
                                 {0.15, 0.28, 0, 1.2, 0},
                                 {0.10, 0.05, 0, 1.6, 0},
                                 {0.07, 0.45, -0.18, 0.65, 0},
                                 {0.05, 0.37, -0.18, 0.2, 0},
                                 {0.07, 0.45, 0.18, 0.65, 0},
                                 {0.05, 0.37, 0.18, 0.2, 0},
                                 {0.05, 0.33, -0.35, 1.45, kPi / 2},
                                 {0.04, 0.25, -0.7, 1.45, kPi / 2},
                                 {0.05, 0.33, 0.35, 1.45, -kPi / 2},
                                 {0.04, 0.25, 0.7, 1.45, -kPi / 2}};
  std::vector<btRigidBody*> parts;
  for (const PartSize& part : kParts) {
    btTransform place = At(scale * part.x, scale * part.y, 0, AboutZ(part.roll));
    place.getOrigin() += origin;
    parts.push_back(stage.Add(1, place, stage.Make<btCapsuleShape>(scale * part.radius, scale * part.height)));
    parts.back()->setDamping(0.05, 0.85);
  }

  struct Hinge {
    Part a, b;
    double y_a, y_b, low, high;
  };
  constexpr Hinge kHinges[] = {{kPelvis, kSpine, 0.15, -0.15, -kPi / 4, kPi / 2},
                               {kThighL, kShinL, -0.225, 0.185, 0, kPi / 2},
                               {kThighR, kShinR, -0.225, 0.185, 0, kPi / 2},
                               {kArmL, kForearmL, 0.18, -0.14, -kPi / 2, 0},
                               {kArmR, kForearmR, 0.18, -0.14, -kPi / 2, 0}};
  for (const Hinge& h : kHinges) {
    auto* const joint =
        stage.Connect<btHingeConstraint>(true, *parts[h.a], *parts[h.b], At(0, scale * h.y_a, 0, AboutY(kPi / 2)),
                                         At(0, scale * h.y_b, 0, AboutY(kPi / 2)));
    joint->setLimit(h.low, h.high);
  }
  struct Cone {
    Part a, b;
    double roll_a, x_a, y_a, roll_b, y_b, swing, twist;
  };
  constexpr Cone kCones[] = {{kSpine, kHead, kPi / 2, 0, 0.30, kPi / 2, -0.14, kPi / 4, kPi / 2},
                             {kPelvis, kThighL, -1.25 * kPi, -0.18, -0.10, -1.25 * kPi, 0.225, kPi / 4, 0},
                             {kPelvis, kThighR, kPi / 4, 0.18, -0.10, kPi / 4, 0.225, kPi / 4, 0},
                             {kSpine, kArmL, kPi, -0.2, 0.15, kPi / 2, -0.18, kPi / 2, 0},
                             {kSpine, kArmR, 0, 0.2, 0.15, kPi / 2, -0.18, kPi / 2, 0}};
  for (const Cone& c : kCones) {
    auto* const joint = stage.Connect<btConeTwistConstraint>(true, *parts[c.a], *parts[c.b],
                                                             At(scale * c.x_a, scale * c.y_a, 0, AboutZ(c.roll_a)),
                                                             At(0, scale * c.y_b, 0, AboutZ(c.roll_b)));
    joint->setLimit(c.swing, c.swing, c.twist);
  }
}

void Ragdoll(Stage& stage) {
  BenchmarkGround(stage);
  AddRagdoll(stage, btVector3(0, 1, 0), 3.5);
}

void Ragdolls(Stage& stage) {
  constexpr int kSize = 5;
  BenchmarkGround(stage);
  for (int size = kSize; size > 0; --size)
    for (int i = 0; i < size; ++i)
      AddRagdoll(stage, btVector3(-3 * size + 6 * i, 1 + 7 * (kSize - size), -2 * (kSize - size)), 3.5);
}

void Chain(Stage& stage) {
  stage.Ground();
  btBoxShape* const box = stage.Box(1, 1, 0.25);
  btRigidBody* below = nullptr;
  for (int i = 0; i < 10; ++i) {
    btRigidBody* const link = stage.Add(i == 9 ? 0 : 1, At(0, 5 + 2 * i, 0), box);
    if (below == nullptr) link->setLinearVelocity(btVector3(0, 0, 5));
    if (below != nullptr)
      for (const double x : {-0.5, 0.5})
        stage.Connect<btPoint2PointConstraint>(false, *below, *link, btVector3(x, 1, 0), btVector3(x, -1, 0));
    below = link;
  }
}

void Bridge(Stage& stage) {
  constexpr int kPlanks = 10;
  stage.Ground();
  btBoxShape* const plank = stage.Box(0.4, 0.2, 1);
  const double width = 0.4 * kPlanks + 0.4 * (kPlanks - 1);
  btRigidBody* previous = nullptr;
  for (int i = 0; i < kPlanks; ++i) {
    const double x = -(2.0 * i / (kPlanks - 1) - 1) * width / 2;
    btRigidBody* const body = stage.Add(i == 0 || i == kPlanks - 1 ? 0 : 1, At(x, 5, 0), plank);
    if (previous != nullptr)
      for (const double z : {-0.5, 0.5})
        stage.Connect<btPoint2PointConstraint>(false, *previous, *body, btVector3(-0.5, 0, z), btVector3(0.5, 0, z));
    previous = body;
  }
  for (int i = 0; i < 4; ++i) stage.Add(1, At(-1.8 + 1.2 * i, 6.5, 0.1 * i), stage.Box(0.4, 0.4, 0.4));
}

/// Tops of a pin and a bar, one for each way in which Bullet treats the gyroscopic torque.
void Gyroscopic(Stage& stage) {
  auto* const plane = stage.Make<btStaticPlaneShape>(btVector3(0, 1, 0), 0);
  auto* const pin = stage.Make<btCylinderShapeZ>(btVector3(0.1, 0.1, 0.2));
  btBoxShape* const bar = stage.Box(1, 0.1, 0.1);
  pin->setMargin(0.01);
  bar->setMargin(0.01);
  btVector3 inertia;
  btCompoundShape* const top =
      PrincipalCompound(stage, {{pin, At(0, 0, 0)}, {bar, At(0, 0, 0.2)}}, {0.3, 0.1}, &inertia);
  stage.Add(0, At(0, 0, 0), plane)->setFriction(std::sqrt(2.0));
  for (int i = 0; i < 4; ++i) {
    btRigidBody* const body = stage.Add(1, At(-10 + 5 * i, 2, 4), top, &inertia);
    body->setAngularVelocity(btVector3(0, 0.1, 10));
    body->setFriction(1);
    body->setFlags(i == 0 ? 0 : 1 << i);
  }
  stage.world.getSolverInfo().m_maxGyroscopicForce = 10;
}

/// Joints as in the engine's example: a door on a hinge, two boxes on a hinge, a slider, a cone, all with limits, and a
/// ball.
void Constraints(Stage& stage) {
  stage.Add(0, At(0, -56, 0), stage.Make<btStaticPlaneShape>(btVector3(0, 1, 0), 40));
  btBoxShape* const cube = stage.Box(1, 1, 1);

  btRigidBody* const hanging = stage.Add(1, At(0, 0, -5), cube);
  stage.Connect<btPoint2PointConstraint>(false, *hanging, btVector3(1, -1, -1));

  btRigidBody* const slider_a = stage.Add(1, At(-20, 0, 30), cube);
  btRigidBody* const slider_b = stage.Add(1, At(-30, 0, 30), cube);
  auto* const slider = stage.Connect<btSliderConstraint>(true, *slider_a, *slider_b, btTransform::getIdentity(),
                                                         btTransform::getIdentity(), true);
  slider->setLowerLinLimit(-15);
  slider->setUpperLinLimit(-5);
  slider->setLowerAngLimit(-kPi / 3);
  slider->setUpperAngLimit(kPi / 3);
  slider_b->setLinearVelocity(btVector3(-3, 0, 0));

  btRigidBody* const door = stage.Add(1, At(-5, -2, 0), stage.Box(2, 5, 0.2));
  auto* const door_hinge = stage.Connect<btHingeConstraint>(false, *door, btVector3(12.1, -2, 0), btVector3(0, 1, 0));
  door_hinge->setLimit(-kPi / 4, kPi / 4);
  door->setLinearVelocity(btVector3(0, 0, 12.1));
  door->setAngularVelocity(btVector3(0, 1, 0));

  btRigidBody* const foot = stage.Add(0, At(-10, -5, 0), cube);
  btRigidBody* const head = stage.Add(1, At(-10, 5, 0), cube);
  auto* const cone = stage.Connect<btConeTwistConstraint>(true, *head, *foot, At(0, -5, 0, AboutZ(kPi / 2)),
                                                          At(0, 5, 0, AboutZ(kPi / 2)));
  cone->setLimit(0.6 * kPi / 4, kPi / 4, 0.8 * kPi, 0.5);

  btRigidBody* const wing_a = stage.Add(1, At(-20, -2, 0), cube);
  btRigidBody* const wing_b = stage.Add(10, At(-30, -2, 0), cube);
  auto* const wings = stage.Connect<btHingeConstraint>(true, *wing_a, *wing_b, btVector3(-5, 0, 0), btVector3(5, 0, 0),
                                                       btVector3(0, 1, 0), btVector3(0, 1, 0));
  wings->setLimit(-kPi / 4, kPi / 4);
  wing_a->setLinearVelocity(btVector3(0, 0, 8));
}

/// Round bodies of ten kinds on a turned slab; z is up.
void RollingFriction(Stage& stage) {
  stage.world.setGravity(btVector3(0, 0, -10));
  stage.Add(0, At(0, 0, -28, AboutY(0.03 * kPi)), stage.Box(10, 5, 25))->setFriction(0.5);
  stage.Add(0, At(0, 0, -54), stage.Box(100, 100, 50))->setFriction(0.1);
  const std::array<btCollisionShape*, 10> shapes = {stage.Make<btSphereShape>(0.5),
                                                    stage.Make<btCapsuleShape>(0.25, 0.5),
                                                    stage.Make<btCapsuleShapeX>(0.25, 0.5),
                                                    stage.Make<btCapsuleShapeZ>(0.25, 0.5),
                                                    stage.Make<btConeShape>(0.25, 0.5),
                                                    stage.Make<btConeShapeX>(0.25, 0.5),
                                                    stage.Make<btConeShapeZ>(0.25, 0.5),
                                                    stage.Make<btCylinderShape>(btVector3(0.25, 0.5, 0.25)),
                                                    stage.Make<btCylinderShapeX>(btVector3(0.5, 0.25, 0.25)),
                                                    stage.Make<btCylinderShapeZ>(btVector3(0.25, 0.25, 0.5))};
  std::size_t kind = 0;
  for (int k = 0; k < 5; ++k)
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) {
        btCollisionShape* const shape = shapes[++kind % shapes.size()];
        btRigidBody* const body = stage.Add(1, At(2 * i - 5, 2 * j - 5, 2 * k), shape);
        body->setFriction(1);
        body->setRollingFriction(0.1);
        body->setSpinningFriction(0.1);
        body->setAnisotropicFriction(shape->getAnisotropicRollingFrictionDirection(),
                                     btCollisionObject::CF_ANISOTROPIC_ROLLING_FRICTION);
      }
}

constexpr SceneEntry<Stage> kScenes[] = {
    {"basic", "examples/BasicDemo/BasicExample.cpp", "", [](Stage& stage) { Basic(stage, stage.Box(0.1, 0.1, 0.1)); }},
    {"basic-spheres", "examples/BasicDemo/BasicExample.cpp", "spheres of radius 0.1 in place of the boxes",
     [](Stage& stage) { Basic(stage, stage.Make<btSphereShape>(0.1)); }},
    {"multiple-boxes", "examples/ExtendedTutorials/MultipleBoxes.cpp", "", MultipleBoxes},
    {"compound-boxes", "examples/ExtendedTutorials/CompoundBoxes.cpp",
     "36 bodies in place of one, their frames in the centre of mass", CompoundBoxes},
    {"boxes-3000", "examples/Benchmarks/BenchmarkDemo.cpp (test 1)", "8 layers of 64 in place of 47", Boxes3000},
    {"wall", "examples/Benchmarks/BenchmarkDemo.cpp (test 2)", "one of its walls alone", Wall},
    {"pyramid", "examples/Benchmarks/BenchmarkDemo.cpp (test 2)", "its pyramid alone; base 8 x 8 in place of 12 x 12",
     Pyramid},
    {"tower", "examples/Benchmarks/BenchmarkDemo.cpp (test 2)", "its round tower alone", Tower},
    {"ragdoll", "examples/Benchmarks/BenchmarkDemo.cpp (test 3)", "one ragdoll in place of 136", Ragdoll},
    {"ragdolls", "examples/Benchmarks/BenchmarkDemo.cpp (test 3)", "15 ragdolls in place of 136", Ragdolls},
    {"chain", "examples/ExtendedTutorials/Chain.cpp", "the lowest link starts at 5 m/s", Chain},
    {"bridge", "examples/ExtendedTutorials/Bridge.cpp", "four boxes dropped on it", Bridge},
    {"gyroscopic", "examples/GyroscopicDemo/GyroscopicSetup.cpp",
     "with gravity and 2 m above the plane in place of 8, frame moved to the centre of mass", Gyroscopic},
    {"constraints", "examples/Constraints/ConstraintDemo.cpp",
     "its ball, slider, door, cone and two-body hinge; door, slider and hinge start with a velocity", Constraints},
    {"rolling-friction", "examples/RollingFrictionDemo/RollingFrictionDemo.cpp",
     "5 x 5 x 5 bodies, the lowest 5 m lower", RollingFriction},
};

const Engine kEngine = {.name = "bullet",
                        .version = "3.24",
                        .licence = "Zlib",
                        .folder = "",
                        .rebuilt = " of Bullet's source 3.24, rebuilt and stepped by Debian's libbullet 3.24+dfsg-2",
                        .left_out =
                            "friction, restitution, softness, motors; damping is in the velocities, the torque "
                            "has the engine's gyroscopic part; sleeping is off",
                        .dimension = 3};

}  // namespace
}  // namespace lcpbench::recorders

int main(int argc, char** argv) {
  using namespace lcpbench::recorders;
  return RunRecorder<Stage>(argc, argv, kEngine, kScenes);
}
