#include "model/contact/assembly.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/closest_points.h"
#include "model/contact/contact_row.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {

const char* ToString(ConstraintType type) {
  return std::array{"contact", "path joint", "pin", "rod", "rope"}[static_cast<size_t>(type)];
}

namespace {

std::string SystemText(const ContactSystem& system) {
  return system.name.empty() ? "" : "system '" + system.name + "', ";
}

class Assembler {
 public:
  /// @param step  h [s] of a time step's problem; 0: the acceleration level
  Assembler(const ContactSystem& system, Friction friction, double step)
      : system_(system), friction_(friction), step_(step) {
    RequireValid(system.bodies, SystemText(system));
    const size_t bodies = system.bodies.size();
    rotation_.resize(bodies);
    inverse_mass_ = Eigen::VectorXd::Zero(static_cast<Index>(3 * bodies));
    change_ = step > 0 ? FreeVelocity(system.bodies, step) : Eigen::VectorXd(inverse_mass_.size());
    for (size_t i = 0; i < bodies; ++i) {
      const Body& body = system.bodies[i];
      rotation_[i] = SinCos(body.theta);
      const auto k = static_cast<Index>(3 * i);
      if (!body.fixed) inverse_mass_.segment<3>(k) << 1 / body.mass, 1 / body.mass, 1 / body.inertia;
      if (step > 0) continue;
      if (body.fixed) {
        change_.segment<3>(k) << body.acceleration.x, body.acceleration.y, body.alpha;
      } else {
        change_.segment<3>(k) << inverse_mass_[k] * body.force.x, inverse_mass_[k] * body.force.y,
            inverse_mass_[k + 2] * body.torque;
      }
    }
    Index rows = 0;
    for (const Constraint& constraint : system.constraints) {
      rows += constraint.type == ConstraintType::kPin || HasTangentRow(constraint) ? 2 : 1;
      if (HasTorqueRow(constraint)) ++rows;
    }
    rows_.reserve(static_cast<size_t>(rows));
    J_.resize(rows, inverse_mass_.size());
    J_.reserve(6 * rows);
    b_.resize(rows);
  }

  AssembledLcp Run() {
    for (size_t i = 0; i < system_.constraints.size(); ++i) AddConstraint(i);
    const auto n = static_cast<Index>(rows_.size());
    J_.finalize();
    RowBounds bounds = RowBounds::WithBilateralRows(n, bilateral_);
    bounds.friction = std::move(tangents_);
    bounds.bounded = std::move(torques_);
    return {std::move(rows_),
            LcpProblem::FromFactors(system_.name, J_, std::move(inverse_mass_), std::move(b_), std::move(bounds))};
  }

 private:
  bool HasTangentRow(const Constraint& constraint) const {
    return friction_ == Friction::kRows && constraint.type == ConstraintType::kContact && constraint.friction != 0;
  }

  bool HasTorqueRow(const Constraint& constraint) const {
    return friction_ == Friction::kRows && constraint.type == ConstraintType::kPin && constraint.torque_limit != 0;
  }

  void AddConstraint(size_t i) {
    const Constraint& constraint = system_.constraints[i];
    RequireBodies(i);
    try {
      switch (constraint.type) {
        case ConstraintType::kContact:
          AddNormalRow(i, Regularity::kLocalMinimum);
          break;
        case ConstraintType::kPathJoint:
          if (IsVertex(constraint.feature1) == IsVertex(constraint.feature2)) {
            throw InputError("a path joint needs one vertex and one edge; feature 1: " + Describe(constraint.feature1) +
                             "; feature 2: " + Describe(constraint.feature2));
          }
          AddNormalRow(i, Regularity::kNonzeroD);
          break;
        case ConstraintType::kPin:
          AddPinRows(i);
          break;
        case ConstraintType::kRod:
        case ConstraintType::kRope:
          AddConnectorRow(i);
          break;
      }
    } catch (const InputError& error) {
      throw InputError(ConstraintText(i) + " between " + BodyText(system_.bodies, Body1(i)) + " and " +
                       BodyText(system_.bodies, Body2(i)) + ": " + error.what());
    }
  }

  void RequireBodies(size_t i) const {
    const Constraint& constraint = system_.constraints[i];
    const auto count = static_cast<std::ptrdiff_t>(system_.bodies.size());
    for (const int body : {constraint.body1, constraint.body2}) {
      if (body < 0 || body >= count) {
        throw InputError(ConstraintText(i) + ": body index " + std::to_string(body) + " is outside [0, " +
                         std::to_string(count) + ")");
      }
    }
    if (constraint.body1 == constraint.body2) {
      throw InputError(ConstraintText(i) + ": the two bodies must differ, both are " +
                       BodyText(system_.bodies, Body1(i)));
    }
  }

  void AddNormalRow(size_t i, Regularity required) {
    const Constraint& constraint = system_.constraints[i];
    const Body& body1 = system_.bodies[Body1(i)];
    const Body& body2 = system_.bodies[Body2(i)];
    const ClosestPoints closest = FindClosestPoints({constraint.feature1, body1.x, rotation_[Body1(i)], body1.theta},
                                                    {constraint.feature2, body2.x, rotation_[Body2(i)], body2.theta},
                                                    StartOf(constraint), required);
    const ContactRow row = ComputeContactRow(closest, body1, body2);
    AddRow({static_cast<int>(i), 'n', constraint.type != ConstraintType::kContact, body1.x + closest.R1,
            body2.x + closest.R2, closest.n, closest.d, row.d_dot, row.gamma},
           row.J);
    if (!HasTangentRow(constraint)) return;
    if (!(constraint.friction > 0 && constraint.friction <= kMostFriction)) {
      throw InputError("its friction must lie within 0..1e6, found " + NumberText(constraint.friction));
    }
    const auto normal = static_cast<Index>(rows_.size()) - 1;
    tangents_.push_back({normal + 1, normal, constraint.friction});
    RowInfo info = rows_.back();
    const TangentRow tangent = ComputeTangentRow(closest, body1, body2, row);
    info.axis = 't';
    info.n = Perp(closest.n);
    info.d = 0;
    info.drive = 0 - body1.surface_speed - body2.surface_speed;
    info.d_dot = tangent.slip + info.drive;
    info.gamma = tangent.gamma;
    AddRow(info, tangent.J);
  }

  // The attachment points of a constraint between two vertices.
  std::array<Vec2, 2> RequireVertices(const Constraint& constraint) const {
    const auto* vertex1 = std::get_if<Vertex>(&constraint.feature1);
    const auto* vertex2 = std::get_if<Vertex>(&constraint.feature2);
    if (vertex1 == nullptr || vertex2 == nullptr) {
      throw InputError("a " + std::string(ToString(constraint.type)) + " needs two vertices; feature 1: " +
                       Describe(constraint.feature1) + "; feature 2: " + Describe(constraint.feature2));
    }
    RequireValid(constraint.feature1);
    RequireValid(constraint.feature2);
    return {vertex1->p, vertex2->p};
  }

  // A rope's gap is L - |p1 - p2|, so its whole row is that of a rod negated.
  void AddConnectorRow(size_t i) {
    const Constraint& constraint = system_.constraints[i];
    const auto [vertex1, vertex2] = RequireVertices(constraint);
    const Body& body1 = system_.bodies[Body1(i)];
    const Body& body2 = system_.bodies[Body2(i)];
    const auto [points, row] = ComputeConnectorRow(vertex1, rotation_[Body1(i)], body1, vertex2, rotation_[Body2(i)],
                                                   body2, constraint.length);
    const bool rod = constraint.type == ConstraintType::kRod;
    const double sign = rod ? 1 : -1;
    std::array<double, 6> J = row.J;
    for (double& entry : J) entry *= sign;
    AddRow({static_cast<int>(i), 'n', rod, body1.x + points.R1, body2.x + points.R2, sign * points.n,
            sign * (points.d - constraint.length), sign * row.d_dot, sign * row.gamma},
           J);
  }

  void AddPinRows(size_t i) {
    const Constraint& constraint = system_.constraints[i];
    const auto [vertex1, vertex2] = RequireVertices(constraint);
    const Body& body1 = system_.bodies[Body1(i)];
    const Body& body2 = system_.bodies[Body2(i)];
    const PinRows pin = ComputePinRows(vertex1, rotation_[Body1(i)], body1, vertex2, rotation_[Body2(i)], body2);
    for (const size_t axis : {size_t{0}, size_t{1}}) {
      const bool x = axis == 0;
      AddRow({static_cast<int>(i), x ? 'x' : 'y', true, body1.x + pin.R1, body2.x + pin.R2, x ? Vec2{1, 0} : Vec2{0, 1},
              pin.g[axis], pin.g_dot[axis], pin.gamma[axis]},
             pin.J[axis]);
    }
    if (!HasTorqueRow(constraint)) return;
    const double limit = constraint.torque_limit * (step_ > 0 ? step_ : 1);
    torques_.push_back(
        {static_cast<Index>(rows_.size()), constraint.slip < 0 ? limit : -limit, constraint.slip > 0 ? -limit : limit});
    RowInfo info = rows_.back();
    info.axis = 'r';
    info.bilateral = false;
    info.n = {};
    info.d = info.gamma = 0;
    info.d_dot = TurningSlip(constraint, system_.bodies);
    info.drive = 0 - constraint.speed;
    AddRow(info, {0, 0, 1, 0, 0, -1});
  }

  void AddRow(const RowInfo& info, const std::array<double, 6>& J) {
    const auto i = static_cast<size_t>(info.constraint);
    const double* const a1 = change_.data() + 3 * Body1(i);
    const double* const a2 = change_.data() + 3 * Body2(i);
    double b = 0;
    for (size_t k = 0; k < 3; ++k) b += J[k] * a1[k] + J[k + 3] * a2[k];
    if (step_ == 0) {
      b += info.gamma;
    } else if (!info.bilateral) {
      b += std::max(info.d, 0.0) / step_ + info.drive;
    }
    // Finite inputs leave only overflow. J's other entries are components of n.
    if (!(std::isfinite(b) && std::isfinite(info.gamma) && std::isfinite(info.d) && std::isfinite(info.d_dot) &&
          std::isfinite(J[2]) && std::isfinite(J[5]) && IsFinite(info.n) && IsFinite(info.p1) && IsFinite(info.p2))) {
      const Constraint& constraint = system_.constraints[i];
      throw InputError("the numbers overflow: the row is not finite; feature 1: " + Describe(constraint.feature1) +
                       "; feature 2: " + Describe(constraint.feature2));
    }
    const auto row = static_cast<Index>(rows_.size());
    if (info.bilateral) bilateral_.push_back(row);
    rows_.push_back(info);
    b_[row] = b;
    // Six entries whatever their values, in the order of the columns.
    const std::array<size_t, 2> bodies = {Body1(i), Body2(i)};
    const size_t first = bodies[0] < bodies[1] ? 0 : 1;
    J_.startVec(row);
    for (const size_t side : {first, 1 - first}) {
      for (size_t k = 0; k < 3; ++k) J_.insertBack(row, static_cast<Index>(3 * bodies[side] + k)) = J[3 * side + k];
    }
  }

  size_t Body1(size_t i) const { return static_cast<size_t>(system_.constraints[i].body1); }
  size_t Body2(size_t i) const { return static_cast<size_t>(system_.constraints[i].body2); }
  std::string ConstraintText(size_t i) const {
    return SystemText(system_) + ToString(system_.constraints[i].type) + " " + std::to_string(i);
  }

  const ContactSystem& system_;
  std::vector<Rotation> rotation_;
  Eigen::VectorXd inverse_mass_;
  Friction friction_;
  double step_;
  Eigen::VectorXd change_;  // without constraints: accelerations, or velocities at the step's end
  std::vector<RowInfo> rows_;
  SparseMatrix J_;
  Eigen::VectorXd b_;
  std::vector<Index> bilateral_;
  std::vector<FrictionRow> tangents_;
  std::vector<BoundedRow> torques_;
};

}  // namespace

AssembledLcp AssembleContactLcp(const ContactSystem& system, Friction friction) {
  return Assembler(system, friction, 0).Run();
}

AssembledLcp AssembleStepLcp(const ContactSystem& system, double h) {
  return Assembler(system, Friction::kRows, h).Run();
}

AssembledLcp AssembleInstant(const ContactSystem& system, double h) {
  for (const Constraint& constraint : system.constraints) {
    const bool has_friction = constraint.type == ConstraintType::kContact && constraint.friction != 0;
    if (has_friction || constraint.torque_limit != 0) return AssembleStepLcp(system, h);
  }
  return AssembleContactLcp(system);
}

Eigen::VectorXd FreeVelocity(std::span<const Body> bodies, double h) {
  Eigen::VectorXd v(static_cast<Index>(3 * bodies.size()));
  for (size_t i = 0; i < bodies.size(); ++i) {
    const Body& body = bodies[i];
    const Vec2 change = body.fixed ? (h / 2) * body.acceleration : (h / body.mass) * body.force;
    const double spin = body.fixed ? h / 2 * body.alpha : h / body.inertia * body.torque;
    v.segment<3>(static_cast<Index>(3 * i)) << body.v.x + change.x, body.v.y + change.y, body.omega + spin;
  }
  return v;
}

}  // namespace lcpbench
