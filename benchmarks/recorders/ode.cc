// The Open Dynamics Engine 0.16: its own step of scenes of its demos.
//
// A recorded step is what dWorldStep() or dWorldQuickStep() is given: after collision detection, before loads are
// added. Contacts are those that dCollide() returns; ODE keeps none from step to step, their identities are those of
// ContactNames within a tenth of the smaller geometry's size. Rows of joints follow the definition in ODE's manual;
// motors are left out, and a soft row (a suspension) stands as a rigid one. The torque has ODE's implicit gyroscopic
// part.
//
// The scenes are built anew from what the demos' sources state: shapes, masses, places, surfaces, drives.

#include <ode/ode.h>

#include <Eigen/Dense>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/recorders/contact_names.h"
#include "benchmarks/recorders/recording.h"

namespace lcpbench::recorders {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kInfiniteFriction = 1e9;  // stands for dInfinity in the recording

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Vector3d FromOde(const dReal* v) { return {v[0], v[1], v[2]}; }
Matrix3d MatrixFromOde(const dReal* m) {
  Matrix3d result;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) result(i, k) = m[4 * i + k];
  return result;
}
void ToOde(const Matrix3d& R, dMatrix3 result) {
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 4; ++k) result[4 * i + k] = k < 3 ? R(i, k) : 0;
}
Matrix3d Rotation(const Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
}
Matrix3d CrossMatrix(const Vector3d& v) {
  return (Matrix3d() << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0).finished();
}
/// Two unit vectors across a unit vector.
std::array<Vector3d, 2> Across(const Vector3d& axis) {
  const Vector3d first = axis.unitOrthogonal();
  return {first, axis.cross(first)};
}

/// Mass and inertia about the centre of mass. `axes` turns principal axes to the body's.
struct Inertia {
  double mass;
  Matrix3d tensor, axes;
  Vector3d principal;
};

Inertia InertiaOf(dBodyID body) {
  dMass mass;
  dBodyGetMass(body, &mass);
  Inertia result{mass.mass, MatrixFromOde(mass.I), Matrix3d::Identity(), Vector3d::Zero()};
  result.principal = result.tensor.diagonal();
  if (!result.tensor.isDiagonal(1e-14)) {
    const Eigen::SelfAdjointEigenSolver<Matrix3d> solver(result.tensor);
    result.principal = solver.eigenvalues();
    result.axes = solver.eigenvectors();
    if (result.axes.determinant() < 0) result.axes.col(2) *= -1;
  }
  return result;
}

/// A body of a joint, or the world.
struct End {
  int index = -1;
  Vector3d x = Vector3d::Zero();
  Matrix3d R = Matrix3d::Identity();
};

/// Collects the rows of one joint; w is the velocity of i against that of j.
class RowWriter {
 public:
  RowWriter(const End& i, const End& j) : i_(i), j_(j) {}

  /// The points of both bodies may not part along d.
  void Points(const Vector3d& d, const Vector3d& p_i, const Vector3d& p_j, double error) {
    Add(d, (p_i - i_.x).cross(d), -d, -(p_j - j_.x).cross(d), error);
  }
  void Points(const Vector3d& d, const Vector3d& p_i, const Vector3d& p_j) { Points(d, p_i, p_j, d.dot(p_i - p_j)); }
  void Turning(const Vector3d& d, double error) { Add(Vector3d::Zero(), d, Vector3d::Zero(), -d, error); }

  /// A row, once added, as a stop: nothing if it is not reached, bilateral where both stops are one.
  void Stop(double position, double low, double high) {
    const bool is_used = low <= high && (position <= low || position >= high);
    JointRow row = std::move(rows_.back());
    rows_.pop_back();
    if (!is_used) return;
    row.is_limit = low < high;
    const double sign = position > low ? -1 : 1;
    row.error = sign * (position - (position > low ? high : low));
    for (double& value : row.J) value *= sign;
    rows_.push_back(std::move(row));
  }

  std::vector<JointRow> Take() { return std::move(rows_); }

 private:
  void Add(const Vector3d& linear_i, const Vector3d& angular_i, const Vector3d& linear_j, const Vector3d& angular_j,
           double error) {
    JointRow row{.J = {}, .error = error, .is_limit = false};
    for (const Vector3d& part : {linear_i, angular_i, linear_j, angular_j})
      for (int k = 0; k < 3; ++k) row.J.push_back(part[k]);
    rows_.push_back(std::move(row));
  }

  End i_, j_;
  std::vector<JointRow> rows_;
};

/// A world with what is in it and how its demo steps it. z is up.
class Stage {
 public:
  Stage() {
    dInitODE2(0);
    world = dWorldCreate();
    space = dHashSpaceCreate(nullptr);
    group_ = dJointGroupCreate(0);
    dWorldSetAutoDisableFlag(world, 0);
  }
  ~Stage() {
    dJointGroupDestroy(group_);
    dSpaceDestroy(space);
    dWorldDestroy(world);
    dCloseODE();
  }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  dBodyID Body(const dMass& mass, const Vector3d& x, const Matrix3d& R = Matrix3d::Identity()) {
    const dBodyID body = dBodyCreate(world);
    dBodySetMass(body, &mass);
    dBodySetPosition(body, x.x(), x.y(), x.z());
    dMatrix3 rotation;
    ToOde(R, rotation);
    dBodySetRotation(body, rotation);
    index_[body] = static_cast<int>(bodies.size());
    bodies.push_back(body);
    return body;
  }
  dGeomID Geom(dGeomID geom, dBodyID body) {
    dGeomSetBody(geom, body);
    return geom;
  }
  /// @param mass  in all [kg]
  dBodyID Box(double mass, const Vector3d& sides, const Vector3d& x, const Matrix3d& R = Matrix3d::Identity()) {
    dMass m;
    dMassSetBoxTotal(&m, mass, sides.x(), sides.y(), sides.z());
    const dBodyID body = Body(m, x, R);
    Geom(dCreateBox(space, sides.x(), sides.y(), sides.z()), body);
    return body;
  }
  dBodyID Sphere(double mass, double radius, const Vector3d& x, const Matrix3d& R = Matrix3d::Identity()) {
    dMass m;
    dMassSetSphereTotal(&m, mass, radius);
    const dBodyID body = Body(m, x, R);
    Geom(dCreateSphere(space, radius), body);
    return body;
  }
  void Ground() { dCreatePlane(space, 0, 0, 1, 0); }

  /// `set_up` sets anchors and axes: what rows and their errors are measured against is taken then.
  template <class SetUp>
  dJointID Join(dJointID joint, dBodyID a, dBodyID b, const SetUp& set_up) {
    dJointAttach(joint, a, b);
    set_up(joint);
    const End i = EndOf(joint, 0);
    const End j = EndOf(joint, 1);
    dVector3 axis = {0, 0, 0, 0};
    if (dJointGetType(joint) == dJointTypeHinge) dJointGetHingeAxis(joint, axis);
    joints_.push_back({joint, j.R.transpose() * FromOde(axis), j.R.transpose() * (i.x - j.x), j.R.transpose() * i.R});
    return joint;
  }
  dJointID Ball(dBodyID a, dBodyID b, const Vector3d& anchor) {
    return Join(dJointCreateBall(world, nullptr), a, b,
                [&](dJointID joint) { dJointSetBallAnchor(joint, anchor.x(), anchor.y(), anchor.z()); });
  }
  dJointID Hinge(dBodyID a, dBodyID b, const Vector3d& anchor, const Vector3d& axis) {
    return Join(dJointCreateHinge(world, nullptr), a, b, [&](dJointID joint) {
      dJointSetHingeAnchor(joint, anchor.x(), anchor.y(), anchor.z());
      dJointSetHingeAxis(joint, axis.x(), axis.y(), axis.z());
    });
  }
  /// A wheel b at its centre: steering about the first axis, rolling about the second.
  dJointID Hinge2(dBodyID a, dBodyID b, const Vector3d& steering, const Vector3d& rolling) {
    return Join(dJointCreateHinge2(world, nullptr), a, b, [&](dJointID joint) {
      const dReal* const x = dBodyGetPosition(b);
      dJointSetHinge2Anchor(joint, x[0], x[1], x[2]);
      dJointSetHinge2Axes(joint, steering.data(), rolling.data());
    });
  }
  void Fix(dBodyID a, dBodyID b) { Join(dJointCreateFixed(world, nullptr), a, b, dJointSetFixed); }

  void Advance(int number, Step* step) {
    if (number == 0) {
      for (int k = 0; k < dSpaceGetNumGeoms(space); ++k) number_[dSpaceGetGeom(space, k)] = k;
    }
    if (drive) drive(number);
    dSpaceCollide(space, this, &Stage::Meet);
    NameContacts();
    if (step != nullptr) Write(step);
    if (is_quick)
      dWorldQuickStep(world, time_step);
    else
      dWorldStep(world, time_step);
    dJointGroupEmpty(group_);
    contacts_.clear();
  }

  Json Bodies() const {
    Json list = Json::array();
    for (const dBodyID body : bodies) {
      const Inertia inertia = InertiaOf(body);
      list.push_back(BodyOf(1 / inertia.mass, Vector(inertia.principal.cwiseInverse())));
    }
    return list;
  }
  Json Gravity() const { return Vector(GravityVector()); }
  double TimeStep() const { return time_step; }

  dWorldID world;
  dSpaceID space;
  std::vector<dBodyID> bodies;
  double time_step = 0.05;
  bool is_quick = false;
  int contacts_per_pair = 4;
  dSurfaceParameters surface = {};
  bool joined_bodies_meet = true;
  std::function<void(int step)> drive;                             ///< loads of a step, as the demo adds them
  std::function<bool(dGeomID, dGeomID)> meet;                      ///< none: all
  std::function<void(dGeomID, dGeomID, dSurfaceParameters*)> rub;  ///< where surfaces differ

 private:
  struct Joint {
    dJointID id;
    Vector3d axis, offset;  ///< in j's frame, at the start
    Matrix3d turn;          ///< from i's frame to j's, at the start
  };
  struct Contact {
    dContactGeom geom;
    double friction;
    int number;  ///< within the pair
  };

  static void Meet(void* data, dGeomID a, dGeomID b) {
    if (dGeomIsSpace(a) || dGeomIsSpace(b)) {
      dSpaceCollide2(a, b, data, &Stage::Meet);
      return;
    }
    Stage& stage = *static_cast<Stage*>(data);
    const dBodyID body_a = dGeomGetBody(a);
    const dBodyID body_b = dGeomGetBody(b);
    if (body_a == body_b) return;
    if (!stage.joined_bodies_meet && body_a != nullptr && body_b != nullptr && dAreConnected(body_a, body_b)) return;
    if (stage.meet && !stage.meet(a, b)) return;
    std::vector<dContact> contacts(static_cast<std::size_t>(stage.contacts_per_pair));
    const int count = dCollide(a, b, stage.contacts_per_pair, &contacts[0].geom, sizeof(dContact));
    for (int k = 0; k < count; ++k) {
      dContact& contact = contacts[static_cast<std::size_t>(k)];
      contact.surface = stage.surface;
      if (stage.rub) stage.rub(a, b, &contact.surface);
      dJointAttach(dJointCreateContact(stage.world, stage.group_, &contact), dGeomGetBody(contact.geom.g1),
                   dGeomGetBody(contact.geom.g2));
      dContactGeom geom = contact.geom;
      if (stage.number_.at(geom.g1) > stage.number_.at(geom.g2)) {  // the order of a space's geometries changes
        std::swap(geom.g1, geom.g2);
        for (int axis = 0; axis < 3; ++axis) geom.normal[axis] *= -1;
      }
      stage.contacts_.push_back({geom, std::min(contact.surface.mu, kInfiniteFriction), 0});
    }
  }

  static double Size(dGeomID geom) {
    if (dGeomGetClass(geom) == dPlaneClass || dGeomGetClass(geom) == dHeightfieldClass) return dInfinity;
    dReal box[6];
    dGeomGetAABB(geom, box);
    return std::min({box[1] - box[0], box[3] - box[2], box[5] - box[4]});
  }

  void NameContacts() {
    std::vector<ContactNames::Contact> asked;
    for (const Contact& contact : contacts_) {
      const dBodyID first = dGeomGetBody(contact.geom.g1);
      const dBodyID body = first != nullptr ? first : dGeomGetBody(contact.geom.g2);
      const Vector3d place = MatrixFromOde(dBodyGetRotation(body)).transpose() *
                             (FromOde(contact.geom.pos) - FromOde(dBodyGetPosition(body)));
      asked.push_back({{number_.at(contact.geom.g1), number_.at(contact.geom.g2)},
                       {place.x(), place.y(), place.z()},
                       0.1 * std::min(Size(contact.geom.g1), Size(contact.geom.g2))});
    }
    const std::vector<int> numbers = names_.Number(asked);
    for (std::size_t k = 0; k < numbers.size(); ++k) contacts_[k].number = numbers[k];
  }

  Vector3d GravityVector() const {
    dVector3 g;
    dWorldGetGravity(world, g);
    return FromOde(g);
  }

  End EndOf(dJointID joint, int end) const {
    const dBodyID body = dJointGetBody(joint, end);
    if (body == nullptr) return {};
    return {IndexOf(index_, body), FromOde(dBodyGetPosition(body)), MatrixFromOde(dBodyGetRotation(body))};
  }

  std::pair<std::string, std::vector<JointRow>> Rows(const Joint& joint) const {
    const End i = EndOf(joint.id, 0);
    const End j = EndOf(joint.id, 1);
    RowWriter rows(i, j);
    dVector3 first, second, axis_i, axis_j;
    const auto add_points = [&] {
      for (int k = 0; k < 3; ++k) rows.Points(Vector3d::Unit(k), FromOde(first), FromOde(second));
    };
    const auto add_no_turning = [&] {
      const Matrix3d error = i.R * (j.R * joint.turn).transpose();
      for (int k = 0; k < 3; ++k)
        rows.Turning(Vector3d::Unit(k), 0.5 * (error((k + 2) % 3, (k + 1) % 3) - error((k + 1) % 3, (k + 2) % 3)));
    };
    switch (dJointGetType(joint.id)) {
      case dJointTypeBall:
        dJointGetBallAnchor(joint.id, first);
        dJointGetBallAnchor2(joint.id, second);
        add_points();
        return {"ball", rows.Take()};
      case dJointTypeHinge:
        dJointGetHingeAnchor(joint.id, first);
        dJointGetHingeAnchor2(joint.id, second);
        dJointGetHingeAxis(joint.id, axis_i);
        add_points();
        for (const Vector3d& d : Across(FromOde(axis_i)))
          rows.Turning(d, d.dot((j.R * joint.axis).cross(FromOde(axis_i))));
        return {"hinge", rows.Take()};
      case dJointTypeHinge2: {
        dJointGetHinge2Anchor(joint.id, first);
        dJointGetHinge2Anchor2(joint.id, second);
        dJointGetHinge2Axis1(joint.id, axis_i);
        dJointGetHinge2Axis2(joint.id, axis_j);
        add_points();
        const Vector3d steering = FromOde(axis_i);
        const Vector3d rolling = FromOde(axis_j);
        rows.Turning(steering.cross(rolling).normalized(), steering.dot(rolling));
        rows.Turning(steering, 0);
        rows.Stop(dJointGetHinge2Angle1(joint.id), dJointGetHinge2Param(joint.id, dParamLoStop),
                  dJointGetHinge2Param(joint.id, dParamHiStop));
        return {"hinge2", rows.Take()};
      }
      case dJointTypeSlider: {
        dJointGetSliderAxis(joint.id, axis_i);
        const Vector3d axis = FromOde(axis_i);
        const Vector3d middle = j.index < 0 ? i.x : Vector3d((i.x + j.x) / 2);
        const Vector3d error = i.x - j.x - j.R * joint.offset;
        add_no_turning();
        for (const Vector3d& d : Across(axis)) rows.Points(d, middle, middle, d.dot(error));
        rows.Points(axis, middle, middle, 0);
        rows.Stop(dJointGetSliderPosition(joint.id), dJointGetSliderParam(joint.id, dParamLoStop),
                  dJointGetSliderParam(joint.id, dParamHiStop));
        return {"slider", rows.Take()};
      }
      default: {  // fixed
        const Vector3d place = j.x + j.R * joint.offset;
        add_no_turning();
        for (int k = 0; k < 3; ++k) rows.Points(Vector3d::Unit(k), i.x, i.x, (i.x - place)[k]);
        return {"fixed", rows.Take()};
      }
    }
  }

  static std::string ShapeName(dGeomID geom) {
    return NameOf(dGeomGetClass(geom),
                  {{dSphereClass, "sphere"},
                   {dBoxClass, "box"},
                   {dCapsuleClass, "capsule"},
                   {dCylinderClass, "cylinder"},
                   {dPlaneClass, "plane"}},
                  "heightfield");
  }
  static double Radius(dGeomID geom) { return dGeomGetClass(geom) == dSphereClass ? dGeomSphereGetRadius(geom) : 0; }

  /// ODE solves (I - h [L]x) omega' = L for L = I omega and applies the torque that changes L to I omega'.
  Vector3d GyroscopicTorque(dBodyID body, const Matrix3d& world_inertia) const {
    if (!dBodyGetGyroscopicMode(body)) return Vector3d::Zero();
    const Vector3d L = world_inertia * FromOde(dBodyGetAngularVel(body));
    const Matrix3d turned = world_inertia - time_step * CrossMatrix(L);
    return (world_inertia * turned.partialPivLu().solve(L) - L) / time_step;
  }

  void Write(Step* step) {
    const Vector3d gravity = GravityVector();
    for (const dBodyID body : bodies) {
      const Inertia inertia = InertiaOf(body);
      const dReal* const turn = dBodyGetQuaternion(body);
      const Quaterniond rotation(turn[0], turn[1], turn[2], turn[3]);
      const Quaterniond q = (rotation * Quaterniond(inertia.axes)).normalized();
      const Matrix3d R = MatrixFromOde(dBodyGetRotation(body));
      const Vector3d weight = dBodyGetGravityMode(body) ? Vector3d(inertia.mass * gravity) : Vector3d::Zero();
      step->Body(Vector(FromOde(dBodyGetPosition(body))), Quaternion(q), Vector(FromOde(dBodyGetLinearVel(body))),
                 Vector(FromOde(dBodyGetAngularVel(body))), Vector(FromOde(dBodyGetForce(body)) + weight),
                 Vector(FromOde(dBodyGetTorque(body)) + GyroscopicTorque(body, R * inertia.tensor * R.transpose())));
    }
    for (const Contact& contact : contacts_) {
      // ODE's normal points into its first geometry.
      const dGeomID i = contact.geom.g2;
      const dGeomID j = contact.geom.g1;
      step->Contact(IndexOf(index_, dGeomGetBody(i)), IndexOf(index_, dGeomGetBody(j)),
                    Vector(FromOde(contact.geom.pos)), Vector(FromOde(contact.geom.normal).normalized()),
                    -contact.geom.depth, contact.friction, ContactId(number_.at(i), number_.at(j), contact.number),
                    {ShapeName(i), ShapeName(j)}, {Radius(i), Radius(j)});
    }
    for (std::size_t k = 0; k < joints_.size(); ++k) {
      auto [kind, rows] = Rows(joints_[k]);
      step->Joint(EndOf(joints_[k].id, 0).index, EndOf(joints_[k].id, 1).index, kind, k, std::move(rows));
    }
  }

  dJointGroupID group_;
  std::map<dBodyID, int> index_;
  std::map<dGeomID, int> number_;
  std::vector<Joint> joints_;
  std::vector<Contact> contacts_;
  ContactNames names_;
};

dSurfaceParameters Surface(int mode, double mu) {
  dSurfaceParameters surface = {};
  surface.mode = mode;
  surface.mu = mu;
  return surface;
}

/// Parameters of a wheel's joint.
void Set(dJointID wheel, std::initializer_list<std::pair<int, double>> parameters) {
  for (const auto& [parameter, value] : parameters) dJointSetHinge2Param(wheel, parameter, value);
}

/// Ten bodies joined by balls, drawn up at one end by a force that swings.
template <bool has_spheres>
void Chain(Stage& stage) {
  dWorldSetGravity(stage.world, 0, 0, -0.5);
  if (!has_spheres) dWorldSetCFM(stage.world, 1e-5);
  stage.contacts_per_pair = 1;
  stage.surface = Surface(0, has_spheres ? 0.1 : dInfinity);
  stage.joined_bodies_meet = false;
  stage.Ground();
  for (int i = 0; i < 10; ++i) {
    dMass mass;
    dMassSetBoxTotal(&mass, 1, 0.2, 0.2, 0.2);
    const dBodyID body = stage.Body(mass, Vector3d(0.2 * i, 0.2 * i, 0.2 * i + 0.4));
    stage.Geom(has_spheres ? dCreateSphere(stage.space, 0.1732) : dCreateBox(stage.space, 0.2, 0.2, 0.2), body);
  }
  for (int i = 0; i < 9; ++i) {
    const double k = (i + 0.5) * 0.2;
    stage.Ball(stage.bodies[static_cast<std::size_t>(i)], stage.bodies[static_cast<std::size_t>(i) + 1],
               Vector3d(k, k, k + 0.4));
  }
  stage.drive = [last = stage.bodies.back()](int step) {
    dBodyAddForce(last, 0, 0, 1.5 * (std::sin(0.05 * (step + 1)) + 1));
  };
}

const Matrix3d kWheelTurn = Rotation(Vector3d::UnitX(), kPi / 2);

void Buggy(Stage& stage) {
  const double length = 0.7, width = 0.5, height = 0.2, start = 0.5;
  dWorldSetGravity(stage.world, 0, 0, -0.5);
  stage.contacts_per_pair = 10;
  stage.surface =
      Surface(dContactSlip1 | dContactSlip2 | dContactSoftERP | dContactSoftCFM | dContactApprox1, dInfinity);
  stage.surface.slip1 = stage.surface.slip2 = 0.1;
  stage.surface.soft_erp = 0.5;
  stage.surface.soft_cfm = 0.3;
  stage.meet = [](dGeomID a, dGeomID b) { return dGeomGetBody(a) == nullptr || dGeomGetBody(b) == nullptr; };
  stage.Ground();
  const dGeomID ramp = dCreateBox(stage.space, 2, 1.5, 1);
  dMatrix3 slope;
  dRFromAxisAndAngle(slope, 0, 1, 0, -0.15);
  dGeomSetPosition(ramp, 2, 0, -0.34);
  dGeomSetRotation(ramp, slope);
  const dBodyID chassis = stage.Box(1, Vector3d(length, width, height), Vector3d(0, 0, start));
  std::vector<dJointID> wheels;
  for (const auto& [x, y] : {std::pair{0.5, 0.0}, {-0.5, 0.5}, {-0.5, -0.5}}) {
    const dBodyID wheel = stage.Sphere(0.2, 0.18, Vector3d(x * length, y * width, start - height / 2), kWheelTurn);
    wheels.push_back(stage.Hinge2(chassis, wheel, Vector3d::UnitZ(), Vector3d::UnitY()));
    Set(wheels.back(), {{dParamSuspensionERP, 0.4}, {dParamSuspensionCFM, 0.8}});
    const double stop = wheels.size() == 1 ? 0.75 : 0;
    Set(wheels.back(), {{dParamLoStop, -stop}, {dParamHiStop, stop}});
  }
  stage.drive = [front = wheels[0]](int) {
    Set(front, {{dParamVel2, -1.5},
                {dParamFMax2, 0.1},
                {dParamVel, 10 * std::clamp(0.5 - dJointGetHinge2Angle1(front), -0.1, 0.1)},
                {dParamFMax, 0.2},
                {dParamFudgeFactor, 0.1}});
  };
}

void CrashWorld(Stage& stage) {
  dWorldSetGravity(stage.world, 0, 0, -1.5);
  dWorldSetCFM(stage.world, 1e-5);
  dWorldSetERP(stage.world, 0.8);
  dWorldSetQuickStepNumIterations(stage.world, 20);
  stage.is_quick = true;
  stage.joined_bodies_meet = false;
  stage.surface = Surface(dContactSlip1 | dContactSlip2 | dContactSoftERP | dContactSoftCFM | dContactApprox1, 0.5);
  stage.surface.soft_erp = 0.8;
  stage.surface.soft_cfm = 0.01;
  stage.rub = [](dGeomID a, dGeomID b, dSurfaceParameters* surface) {
    if (dGeomGetClass(a) == dSphereClass || dGeomGetClass(b) == dSphereClass) surface->mu = 20;
  };
  stage.Ground();
}

void AddWall(Stage& stage, int width, int height) {
  for (double z = 0.5; z <= height; z += 1)
    for (double y = (-width + z) / 2; y <= (width - z) / 2; y += 1) stage.Box(1, Vector3d::Ones(), Vector3d(-20, y, z));
}

constexpr double kEngineForce = 25;

/// Its four wheels on hinges with steering; half of its mass hangs 5 m below it, fixed to it.
std::vector<dJointID> AddCar(Stage& stage) {
  const double length = 3.5, width = 2.5, height = 1, radius = 0.5, start = 1;
  const dBodyID chassis = stage.Box(0.5, Vector3d(length, width, height), Vector3d(0, 0, start));
  std::vector<dJointID> wheels;
  for (const double x : {0.4 * length - 0.5 * radius, -0.4 * length + 0.5 * radius})
    for (const double y : {0.5 * width, -0.5 * width}) {
      const dBodyID wheel = stage.Sphere(1, radius, Vector3d(x, y, start - height / 2), kWheelTurn);
      wheels.push_back(
          stage.Hinge2(chassis, wheel, x > 0 ? Vector3d::UnitZ() : Vector3d(-Vector3d::UnitZ()), Vector3d::UnitY()));
      Set(wheels.back(), {{dParamSuspensionERP, 0.8}, {dParamSuspensionCFM, 1e-5}});
    }
  dMass mass;
  dMassSetBoxTotal(&mass, 0.5, length, width, height);
  stage.Fix(chassis, stage.Body(mass, Vector3d(0, 0, start - 5)));
  return wheels;
}

void Crash(Stage& stage) {
  CrashWorld(stage);
  const std::vector<dJointID> wheels = AddCar(stage);
  AddWall(stage, 12, 10);
  const dBodyID ball = stage.Sphere(10, 0.5, Vector3d(-10, 5, 0.5));
  stage.drive = [wheels, ball](int step) {
    for (const dJointID wheel : wheels) {
      Set(wheel, {{dParamVel, -dJointGetHinge2Angle1(wheel)},
                  {dParamFMax, dInfinity},
                  {dParamVel2, 6},
                  {dParamFMax2, kEngineForce}});
    }
    if (step == 40) {
      const Vector3d direction = Rotation(Vector3d::UnitY(), -1.2) * Vector3d::UnitZ();
      const Vector3d muzzle = Vector3d(-10, 5, 1) + 3 * direction;
      dBodySetPosition(ball, muzzle.x(), muzzle.y(), muzzle.z());
      dBodySetLinearVel(ball, 10 * direction.x(), 10 * direction.y(), 10 * direction.z());
      dBodySetAngularVel(ball, 0, 0, 0);
    }
  };
}

void CrashWall(Stage& stage) {
  CrashWorld(stage);
  AddWall(stage, 24, 20);
}

void CrashBalls(Stage& stage) {
  CrashWorld(stage);
  for (int x = -7; x <= -4; ++x)
    for (double y = -1.5; y <= 1.5; y += 1)
      for (int z = 1; z <= 4; ++z) stage.Sphere(1, 0.5, Vector3d(x, y, z));
}

/// Boxes in a row, fixed to each other, with three driven wheels on either side.
void Centipede(Stage& stage) {
  CrashWorld(stage);
  const double length = 3.5, width = 2.5, height = 1;
  dBodyID before = nullptr;
  for (double y = 0; y < 10 * length; y += length + 0.1) {
    const dBodyID segment = stage.Box(1, Vector3d(width, length, height), Vector3d(-15, y, 1));
    for (const double side : {-1.0, 1.0}) {
      dBodyID inner = segment;
      for (int k = 0; k < 3; ++k) {
        const dBodyID wheel = stage.Sphere(1, 0.5, Vector3d(-15 + side * (2 + k), y, 1));
        const dJointID joint = stage.Hinge2(inner, wheel, Vector3d::UnitZ(), Vector3d::UnitX());
        Set(joint, {{dParamSuspensionERP, 1},
                    {dParamSuspensionCFM, 1e-5},
                    {dParamLoStop, 0},
                    {dParamHiStop, 0},
                    {dParamVel2, side * 10},
                    {dParamFMax2, kEngineForce}});
        inner = wheel;
      }
    }
    if (before != nullptr) stage.Fix(segment, before);
    before = segment;
  }
}

void Friction(Stage& stage) {
  dWorldSetGravity(stage.world, 0, 0, -0.5);
  stage.contacts_per_pair = 3;
  stage.surface = Surface(dContactSoftCFM | dContactApprox1, 0.5);
  stage.surface.soft_cfm = 0.01;
  stage.meet = [](dGeomID a, dGeomID b) { return dGeomGetBody(a) == nullptr || dGeomGetBody(b) == nullptr; };
  stage.Ground();
  for (int i = 0; i < 10; ++i)
    for (int j = 0; j < 10; ++j) stage.Box(0.2 * (j + 1), Vector3d(0.2, 0.2, 0.05), Vector3d(0.4 * i, 0.4 * j, 0.025));
  stage.drive = [&stage](int) {
    for (std::size_t k = 0; k < stage.bodies.size(); ++k)
      dBodyAddForce(stage.bodies[k], 0.05 * (std::floor(static_cast<double>(k) / 10) + 1), 0, 0);
  };
}

Vector3d RandomVector() { return {2 * dRandReal() - 1, 2 * dRandReal() - 1, 2 * dRandReal() - 1}; }
Matrix3d RandomTurn() {
  const Vector3d axis = RandomVector();
  return Rotation(axis, 10 * dRandReal() - 5);
}

enum class Kind { kBox, kSphere, kCapsule, kCylinder, kComposite };

/// An object as demo_boxstack drops it: random in size, density 5.
void AddObject(Stage& stage, Kind kind, const Vector3d& x) {
  constexpr double kDensity = 5;
  Vector3d sides = {0.5 * dRandReal() + 0.1, 0.5 * dRandReal() + 0.1, 0.5 * dRandReal() + 0.1};
  const Matrix3d R = RandomTurn();
  dMass mass;
  const auto capsule = [&](double radius, double length) {
    dMassSetCapsule(&mass, kDensity, 3, radius, length);
    return dCreateCapsule(stage.space, radius, length);
  };
  const auto sphere = [&](double radius) {
    dMassSetSphere(&mass, kDensity, radius);
    return dCreateSphere(stage.space, radius);
  };
  const auto box = [&] {
    dMassSetBox(&mass, kDensity, sides.x(), sides.y(), sides.z());
    return dCreateBox(stage.space, sides.x(), sides.y(), sides.z());
  };
  const auto cylinder = [&] {
    dMassSetCylinder(&mass, kDensity, 3, sides.x(), sides.y());
    return dCreateCylinder(stage.space, sides.x(), sides.y());
  };
  if (kind != Kind::kComposite) {
    const dGeomID geom = kind == Kind::kBox       ? box()
                         : kind == Kind::kSphere  ? sphere(sides.x() / 2)
                         : kind == Kind::kCapsule ? capsule(sides.x() / 2, sides.y())
                                                  : cylinder();
    stage.Geom(geom, stage.Body(mass, x, R));
    return;
  }
  dMass total;
  dMassSetZero(&total);
  struct Part {
    dGeomID geom;
    Vector3d offset;
    Matrix3d turn;
  };
  std::vector<Part> parts;
  for (int k = 0; k < 3; ++k) {
    const double a = dRandReal(), b = dRandReal();
    const dGeomID geom = k == 0 ? sphere(0.25 * a + 0.05) : k == 1 ? box() : capsule(0.1 * a + 0.05, b + 0.1);
    parts.push_back({geom, 0.15 * RandomVector(), RandomTurn()});
    dMatrix3 turn;
    ToOde(parts.back().turn, turn);
    dMassRotate(&mass, turn);
    dMassTranslate(&mass, parts.back().offset.x(), parts.back().offset.y(), parts.back().offset.z());
    dMassAdd(&total, &mass);
  }
  const Vector3d centre = FromOde(total.c);
  dMassTranslate(&total, -centre.x(), -centre.y(), -centre.z());
  const dBodyID body = stage.Body(total, x, R);
  for (const Part& part : parts) {
    stage.Geom(part.geom, body);
    const Vector3d offset = part.offset - centre;
    dGeomSetOffsetPosition(part.geom, offset.x(), offset.y(), offset.z());
    dMatrix3 turn;
    ToOde(part.turn, turn);
    dGeomSetOffsetRotation(part.geom, turn);
  }
}

void BoxstackWorld(Stage& stage, double gravity) {
  dWorldSetGravity(stage.world, 0, 0, -gravity);
  dWorldSetCFM(stage.world, 1e-5);
  dWorldSetContactMaxCorrectingVel(stage.world, 0.1);
  dWorldSetContactSurfaceLayer(stage.world, 0.001);
  stage.is_quick = true;
  stage.surface = Surface(dContactBounce | dContactSoftCFM, dInfinity);
  stage.surface.bounce = 0.1;
  stage.surface.bounce_vel = 0.1;
  stage.surface.soft_cfm = 0.01;
  stage.Ground();
  dRandSetSeed(1);
}

/// Four objects at every 0.7 m of height, over an area of 2 m by 2 m.
template <int count, bool has_boxes_only>
void Boxstack(Stage& stage) {
  BoxstackWorld(stage, 0.5);
  stage.time_step = 0.02;
  stage.contacts_per_pair = 8;
  dWorldSetLinearDamping(stage.world, 0.00001);
  dWorldSetAngularDamping(stage.world, 0.005);
  dWorldSetMaxAngularSpeed(stage.world, 200);
  for (int k = 0; k < count; ++k) {
    const Vector3d corner = {k % 2 == 0 ? -0.5 : 0.5, k % 4 < 2 ? -0.5 : 0.5, 0.6 + 0.7 * std::floor(k / 4.0)};
    AddObject(stage, has_boxes_only ? Kind::kBox : static_cast<Kind>(k % 5), corner + 0.15 * RandomVector());
  }
}

dReal HeightOfField(void*, int x, int z) {
  const double u = (x - 7) / 14.0, v = (z - 15) / 30.0;
  return 1 - 16 * (u * u * u + v * v * v);
}

void Heightfield(Stage& stage) {
  BoxstackWorld(stage, 0.5);
  stage.contacts_per_pair = 64;
  const dHeightfieldDataID data = dGeomHeightfieldDataCreate();
  dGeomHeightfieldDataBuildCallback(data, nullptr, HeightOfField, 4, 8, 15, 31, 1, 0, 0, 0);
  dGeomHeightfieldDataSetBounds(data, -4, 6);
  const dGeomID field = dCreateHeightfield(stage.space, data, 1);
  dMatrix3 upright;
  ToOde(Rotation(Vector3d::UnitX(), kPi / 2), upright);
  dGeomSetRotation(field, upright);
  for (int k = 0; k < 30; ++k) {
    const double x = 3 * (dRandReal() - 0.5), y = 6 * (dRandReal() - 0.5);
    AddObject(stage, static_cast<Kind>(k % 5), Vector3d(x, y, 4.5 + 0.15 * k));
  }
}

/// A house of cards of five levels.
void Cards(Stage& stage) {
  constexpr int kLevels = 5;
  const double angle = kPi / 9;
  const double up = std::cos(angle) + 0.05, across = std::sin(angle) + 0.05;
  dWorldSetGravity(stage.world, 0, 0, -0.5);
  dWorldSetQuickStepNumIterations(stage.world, 50);
  stage.is_quick = true;
  stage.time_step = 0.01;
  stage.contacts_per_pair = 8;
  stage.surface = Surface(dContactApprox1, 5);
  stage.Ground();
  const Vector3d sides = {0.5, 0.02, 1};
  const auto card = [&](double y, double z, double turn) {
    stage.Box(sides.prod(), sides, Vector3d(0, y, z), Rotation(Vector3d::UnitX(), turn));
  };
  for (int level = 0; level < kLevels; ++level) {
    const int n = kLevels - level;
    const double height = (level + 0.5) * up;
    for (int i = 0; i < 2 * n; ++i) card((i - n) * across, height, i % 2 == 0 ? -angle : angle);
    for (int i = 0; i < n - 1; ++i)
      card(-(n - 1 - (1 - across) / 2) * across + 2 * across * i, height + up / 2, 91 * kPi / 180);
  }
}

/// A bridge of 16 planks on hinges, held by sliders with stops, on which ten slabs fall.
void BridgeFeedback(Stage& stage) {
  constexpr int kPlanks = 16;
  constexpr double kMiddle = kPlanks / 2.0;
  dWorldSetGravity(stage.world, 0, 0, -9.8);
  dWorldSetQuickStepNumIterations(stage.world, 20);
  stage.is_quick = true;
  stage.time_step = 0.002;
  stage.contacts_per_pair = 32;
  stage.surface = Surface(dContactSoftERP | dContactSoftCFM | dContactApprox1, 100);
  stage.surface.soft_erp = 0.96;
  stage.surface.soft_cfm = 0.02;
  const Vector3d sides = {0.9, 4, 0.1}, slab = {2, 2, 0.6};
  for (int i = 0; i < kPlanks; ++i) stage.Box(sides.prod(), sides, Vector3d(i - kMiddle, 0, 5));
  const std::vector<dBodyID> planks = stage.bodies;
  for (std::size_t i = 0; i + 1 < planks.size(); ++i) {
    const dJointID hinge = stage.Hinge(planks[i], planks[i + 1], Vector3d(static_cast<double>(i) + 0.5 - kMiddle, 0, 5),
                                       Vector3d::UnitY());
    dJointSetHingeParam(hinge, dParamFMax, 8000);
  }
  for (int i = 0; i < 10; ++i) stage.Box(2 * slab.prod(), slab, Vector3d(0, 0, 8 + 2 * i));
  for (const auto& [plank, high] : {std::pair{planks.front(), 0.2}, {planks.back(), -0.2}}) {
    stage.Join(dJointCreateSlider(stage.world, nullptr), plank, nullptr, [high = high](dJointID slider) {
      dJointSetSliderAxis(slider, 1, 0, 0);
      dJointSetSliderParam(slider, dParamFMax, 4000);
      dJointSetSliderParam(slider, dParamLoStop, 0);
      dJointSetSliderParam(slider, dParamHiStop, high);
    });
  }
  stage.Ground();
}

constexpr SceneEntry<Stage> kScenes[] = {
    {"chain1", "demo_chain1.c", "", Chain<true>},
    {"chain2", "demo_chain2.cpp", "", Chain<false>},
    {"buggy", "demo_buggy.cpp", "driven at a speed of 1.5 and steered by 0.5 from the start", Buggy},
    {"crash", "demo_crash.cpp", "car driven at a speed of 6 from the start, cannon fired in step 40", Crash},
    {"crash-wall", "demo_crash.cpp", "its wall alone, 24 wide and 20 high in place of 12 and 10", CrashWall},
    {"crash-balls", "demo_crash.cpp", "with BALLS alone", CrashBalls},
    {"centipede", "demo_crash.cpp", "with CENTIPEDE alone", Centipede},
    {"friction", "demo_friction.cpp", "", Friction},
    {"boxstack", "demo_boxstack.cpp", "100 boxes dropped at once from a lattice", Boxstack<100, true>},
    {"boxstack-mixed", "demo_boxstack.cpp",
     "60 boxes, spheres, capsules, cylinders and composites dropped at once from a lattice", Boxstack<60, false>},
    {"boxstack-few", "demo_boxstack.cpp", "16 objects of five kinds dropped at once from a lattice",
     Boxstack<16, false>},
    {"heightfield", "demo_heightfield.cpp", "30 objects dropped at once, gravity 0.5 in place of 0.05", Heightfield},
    {"cards", "demo_cards.cpp", "", Cards},
    {"bridge", "demo_feedback.cpp", "hinges do not break", BridgeFeedback},
};

const Engine kEngine = {.name = "ode",
                        .version = "0.16.2",
                        .licence = "BSD-3-Clause OR LGPL-2.1-or-later",
                        .folder = "ode/demo/",
                        .rebuilt = " of Debian's source package ode 2:0.16.2-1, rebuilt",
                        .left_out =
                            "friction (1e9 stands for an infinite coefficient), restitution, softness, motors; "
                            "the torque has the engine's gyroscopic part; sleeping is off",
                        .dimension = 3};

}  // namespace
}  // namespace lcpbench::recorders

int main(int argc, char** argv) {
  using namespace lcpbench::recorders;
  return RunRecorder<Stage>(argc, argv, kEngine, kScenes);
}
