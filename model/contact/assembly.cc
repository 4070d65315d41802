#include "model/contact/assembly.h"

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

namespace lcpbench {
namespace {

std::string SystemText(const ContactSystem& system) {
  return system.name.empty() ? "" : "system '" + system.name + "', ";
}

const char* TypeText(ConstraintType type) {
  return std::array{"contact", "path joint", "pin", "rod", "rope"}[static_cast<size_t>(type)];
}

class Assembler {
 public:
  explicit Assembler(const ContactSystem& system) : system_(system) {
    RequireValid(system.bodies, SystemText(system));
    const size_t bodies = system.bodies.size();
    rotation_.resize(bodies);
    inverse_mass_ = Eigen::VectorXd::Zero(static_cast<Index>(3 * bodies));
    acceleration_.resize(bodies);
    for (size_t i = 0; i < bodies; ++i) {
      const Body& body = system.bodies[i];
      rotation_[i] = SinCos(body.theta);
      if (body.fixed) {
        acceleration_[i] = {body.acceleration.x, body.acceleration.y, body.alpha};
        continue;
      }
      const double by_mass = 1 / body.mass;
      const double by_inertia = 1 / body.inertia;
      const auto k = static_cast<Index>(3 * i);
      inverse_mass_[k] = by_mass;
      inverse_mass_[k + 1] = by_mass;
      inverse_mass_[k + 2] = by_inertia;
      acceleration_[i] = {by_mass * body.force.x, by_mass * body.force.y, by_inertia * body.torque};
    }
    Index rows = 0;
    for (const Constraint& constraint : system.constraints) rows += constraint.type == ConstraintType::kPin ? 2 : 1;
    rows_.reserve(static_cast<size_t>(rows));
    J_.resize(rows, inverse_mass_.size());
    J_.reserve(6 * rows);
    b_.resize(rows);
  }

  AssembledLcp Run() {
    for (size_t i = 0; i < system_.constraints.size(); ++i) AddConstraint(i);
    const auto n = static_cast<Index>(rows_.size());
    J_.finalize();
    return {std::move(rows_), LcpProblem::FromFactors(system_.name, J_, std::move(inverse_mass_), std::move(b_),
                                                      RowBounds::WithBilateralRows(n, bilateral_))};
  }

 private:
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
  }

  // The attachment points of a constraint between two vertices.
  std::array<Vec2, 2> RequireVertices(const Constraint& constraint) const {
    const auto* vertex1 = std::get_if<Vertex>(&constraint.feature1);
    const auto* vertex2 = std::get_if<Vertex>(&constraint.feature2);
    if (vertex1 == nullptr || vertex2 == nullptr) {
      throw InputError("a " + std::string(TypeText(constraint.type)) + " needs two vertices; feature 1: " +
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
  }

  void AddRow(const RowInfo& info, const std::array<double, 6>& J) {
    const auto i = static_cast<size_t>(info.constraint);
    const std::array<double, 3>& a1 = acceleration_[Body1(i)];
    const std::array<double, 3>& a2 = acceleration_[Body2(i)];
    double b = 0;
    for (size_t k = 0; k < 3; ++k) b += J[k] * a1[k] + J[k + 3] * a2[k];
    b += info.gamma;
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
    return SystemText(system_) + TypeText(system_.constraints[i].type) + " " + std::to_string(i);
  }

  const ContactSystem& system_;
  std::vector<Rotation> rotation_;
  Eigen::VectorXd inverse_mass_;
  std::vector<std::array<double, 3>> acceleration_;
  std::vector<RowInfo> rows_;
  SparseMatrix J_;
  Eigen::VectorXd b_;
  std::vector<Index> bilateral_;
};

}  // namespace

AssembledLcp AssembleContactLcp(const ContactSystem& system) { return Assembler(system).Run(); }

}  // namespace lcpbench
