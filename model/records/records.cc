#include "model/records/records.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/assembly.h"
#include "support/json_field.h"

namespace lcpbench {
namespace {

using OrderedJson = nlohmann::ordered_json;

Body ParseBody(const JsonField& field) {
  Body body;
  body.mass = field["mass"].Number();
  body.inertia = field["inertia"].Number();
  body.fixed = field["fixed"].Boolean();
  body.x = field["x"].Pair<Vec2>();
  body.theta = field["theta"].Number();
  body.v = field["v"].Pair<Vec2>();
  body.omega = field["omega"].Number();
  body.force = field["force"].Pair<Vec2>();
  body.torque = field["torque"].Number();
  return body;
}

void Read(const JsonField& field, Vec2* p) { *p = field.Pair<Vec2>(); }
void Read(const JsonField& field, double* number) { *number = field.Number(); }
void Read(const JsonField& field, int* number) { *number = field.Integer(); }
void Read(const JsonField& field, Side* side) {
  *side = field.Choice<Side>({{"convex", Side::kConvex}, {"concave", Side::kConcave}});
}
void Read(const JsonField& field, std::array<Vec2, 4>* points) {
  const std::vector<JsonField> items = field.Items();
  if (items.size() != points->size()) field.Mismatch("an array of four points");
  for (size_t i = 0; i < items.size(); ++i) Read(items[i], &(*points)[i]);
}

// The kind of feature that `type` names, from number `kind` on.
template <size_t kind = 0>
Feature ParseFeature(const JsonField& field, const std::string& type, const std::string& known = "") {
  if constexpr (kind == std::variant_size_v<Feature>) {
    throw UnsupportedFeatureError("unsupported feature '" + type + "' at " + field.Path() + ": expected one of" +
                                  known);
  } else {
    std::variant_alternative_t<kind, Feature> feature;
    if (type != feature.kName) return ParseFeature<kind + 1>(field, type, known + " " + feature.kName);
    ForEachField(feature, [&](const char* name, auto& value) { Read(field[name], &value); });
    return feature;
  }
}

// What single constraints and those of a system share, once the type is known.
void ParseFeatures(const JsonField& field, Constraint* constraint) {
  constraint->feature1 = ParseFeature(field["feature1"], field["feature1"]["type"].String());
  constraint->feature2 = ParseFeature(field["feature2"], field["feature2"]["type"].String());
  if (field.Has("s1")) constraint->s1 = field["s1"].NumberOrNull();
  if (field.Has("s2")) constraint->s2 = field["s2"].NumberOrNull();
  if (field.Has("nominal_gap")) constraint->nominal_gap = field["nominal_gap"].Number();
  const bool has_length = constraint->type == ConstraintType::kRod || constraint->type == ConstraintType::kRope;
  if (has_length) constraint->length = field["length"].Number();
}

constexpr std::initializer_list<std::pair<const char*, ConstraintType>> kJoints = {
    {"unilateral", ConstraintType::kContact},
    {"path", ConstraintType::kPathJoint},
    {"pin", ConstraintType::kPin},
    {"rod", ConstraintType::kRod},
    {"rope", ConstraintType::kRope}};

Constraint ParseConstraint(const JsonField& field) {
  Constraint constraint;
  constraint.type = field["type"].Choice<ConstraintType>(kJoints);
  constraint.body1 = field["body1"].Integer();
  constraint.body2 = field["body2"].Integer();
  ParseFeatures(field, &constraint);
  return constraint;
}

// Contacts carry the names of their two features, if any, as their kind.
ConstraintType TypeOfSingle(const JsonField& record) {
  if (!record.Has("kind")) return ConstraintType::kContact;
  const std::string kind = record["kind"].String();
  const auto* joint = std::find_if(kJoints.begin(), kJoints.end(), [&](const auto& j) { return kind == j.first; });
  return joint == kJoints.end() ? ConstraintType::kContact : joint->second;
}

bool IsSystem(const JsonField& record) { return record.Has("bodies") || record.Has("contacts"); }

ContactSystem ParseSystem(const JsonField& record) {
  ContactSystem system;
  system.name = record["id"].String();
  if (IsSystem(record)) {
    for (const JsonField& body : record["bodies"].Items()) system.bodies.push_back(ParseBody(body));
    for (const JsonField& contact : record["contacts"].Items()) system.constraints.push_back(ParseConstraint(contact));
    return system;
  }
  Constraint constraint;
  constraint.type = TypeOfSingle(record);
  system.bodies = {ParseBody(record["body1"]), ParseBody(record["body2"])};
  system.bodies[0].name = "body1";
  system.bodies[1].name = "body2";
  ParseFeatures(record, &constraint);
  system.constraints = {constraint};
  return system;
}

OrderedJson ToJson(Vec2 a) { return OrderedJson::array({a.x, a.y}); }

OrderedJson ToJson(const Eigen::VectorXd& v) { return std::vector<double>(v.begin(), v.end()); }

OrderedJson DenseRow(const SparseMatrix& J, Index row) {
  std::vector<double> values(static_cast<size_t>(J.cols()), 0.0);
  for (SparseMatrix::InnerIterator it(J, row); it; ++it) values[static_cast<size_t>(it.col())] = it.value();
  return values;
}

// One value per row, taken from the rows' geometry.
OrderedJson Column(const std::vector<RowInfo>& rows, double RowInfo::*member) {
  OrderedJson column = OrderedJson::array();
  for (const RowInfo& row : rows) column.push_back(row.*member);
  return column;
}

void AddMatrices(const AssembledLcp& lcp, OrderedJson* out) {
  const Eigen::MatrixXd& A = lcp.problem.DenseA();
  OrderedJson J_rows = OrderedJson::array();
  OrderedJson A_rows = OrderedJson::array();
  for (Index i = 0; i < lcp.problem.size(); ++i) {
    J_rows.push_back(DenseRow(lcp.problem.J(), i));
    A_rows.push_back(ToJson(Eigen::VectorXd(A.row(i))));
  }
  (*out)["J"] = std::move(J_rows);
  (*out)["gamma"] = Column(lcp.rows, &RowInfo::gamma);
  (*out)["A"] = std::move(A_rows);
  (*out)["b"] = ToJson(lcp.problem.b());
}

// Row i of a single contact or joint. A pin has two, so that A is a row of its matrix.
OrderedJson SingleRow(const AssembledLcp& lcp, size_t i, bool pin) {
  const RowInfo& row = lcp.rows[i];
  const auto index = static_cast<Index>(i);
  const Eigen::MatrixXd& A = lcp.problem.DenseA();
  OrderedJson out = pin ? OrderedJson{{"axis", std::string(1, row.axis)}} : OrderedJson{{"n", ToJson(row.n)}};
  out[pin ? "g" : "d"] = row.d;
  out[pin ? "g_dot" : "d_dot"] = row.d_dot;
  out["J"] = DenseRow(lcp.problem.J(), index);
  out["gamma"] = row.gamma;
  out["A"] = pin ? ToJson(Eigen::VectorXd(A.row(index))) : OrderedJson(A(index, index));
  out["b"] = lcp.problem.b()[index];
  return out;
}

OrderedJson SystemRow(const RowInfo& row) {
  return {{"contact", row.constraint},
          {"axis", std::string(1, row.axis)},
          {"bilateral", row.bilateral},
          {"n", ToJson(row.n)},
          {"d", row.d},
          {"d_dot", row.d_dot}};
}

void AddSystem(const AssembledLcp& lcp, OrderedJson* out) {
  OrderedJson rows = OrderedJson::array();
  for (const RowInfo& row : lcp.rows) rows.push_back(SystemRow(row));
  (*out)["rows"] = std::move(rows);
  AddMatrices(lcp, out);
  (*out)["d"] = Column(lcp.rows, &RowInfo::d);
  (*out)["d_dot"] = Column(lcp.rows, &RowInfo::d_dot);
}

void AddPin(const AssembledLcp& lcp, OrderedJson* out) {
  (*out)["rows"] = OrderedJson::array({SingleRow(lcp, 0, true), SingleRow(lcp, 1, true)});
  (*out)["g"] = Column(lcp.rows, &RowInfo::d);
  (*out)["g_dot"] = Column(lcp.rows, &RowInfo::d_dot);
  AddMatrices(lcp, out);
}

}  // namespace

ContactSystem ParseSystemRecord(std::string_view line, const std::string& where) {
  const nlohmann::json json = ParseJsonObject(line, where);
  return ParseSystem(JsonField(json, where));
}

std::string AssembleRecord(std::string_view line, const std::string& where) {
  const nlohmann::json json = ParseJsonObject(line, where);
  const JsonField record(json, where);
  OrderedJson out = {{"id", record["id"].String()}};
  ContactSystem system;
  try {
    system = ParseSystem(record);
  } catch (const UnsupportedFeatureError& error) {
    out["error"] = error.what();
    return out.dump();
  }
  // From here on every InputError is about the model, not about the file.
  try {
    const AssembledLcp lcp = AssembleContactLcp(system);
    if (IsSystem(record)) {
      AddSystem(lcp, &out);
    } else if (system.constraints[0].type == ConstraintType::kPin) {
      AddPin(lcp, &out);
    } else {
      out["rows"] = OrderedJson::array({SingleRow(lcp, 0, false)});
    }
  } catch (const InputError& error) {
    out["error"] = error.what();
  }
  return out.dump();
}

}  // namespace lcpbench
