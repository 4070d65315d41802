#include "model/records.h"

#include <Eigen/Core>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "model/assembly.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

enum class RecordKind { kSystem, kPin, kPath, kContact };

// A value with the way to it, so that every error can say where it is.
class Field {
 public:
  Field(const Json& value, const std::string& where, std::string path)
      : value_(value), where_(where), path_(std::move(path)) {}

  bool Has(const char* key) const { return value_.is_object() && value_.contains(key); }

  Field operator[](const char* key) const {
    if (!value_.is_object()) Mismatch("an object");
    const auto it = value_.find(key);
    if (it == value_.end()) {
      throw InputError(where_ + ": " + path_ + "/" + key + ": missing field, expected " + Expected(key));
    }
    return {*it, where_, path_ + "/" + key};
  }

  std::vector<Field> Items() const {
    if (!value_.is_array()) Mismatch("an array");
    std::vector<Field> items;
    items.reserve(value_.size());
    for (size_t i = 0; i < value_.size(); ++i) items.emplace_back(value_[i], where_, path_ + "/" + std::to_string(i));
    return items;
  }

  double Number() const {
    if (!value_.is_number()) Mismatch("a number");
    return value_.get<double>();
  }

  bool Boolean() const {
    if (!value_.is_boolean()) Mismatch("true or false");
    return value_.get<bool>();
  }

  std::string String() const {
    if (!value_.is_string()) Mismatch("a string");
    return value_.get<std::string>();
  }

  int Integer() const {
    if (value_.is_number_unsigned()) {
      const auto number = value_.get<unsigned long long>();
      if (number <= static_cast<unsigned long long>(std::numeric_limits<int>::max())) return static_cast<int>(number);
    } else if (value_.is_number_integer()) {
      const auto number = value_.get<long long>();
      if (number >= std::numeric_limits<int>::min()) return static_cast<int>(number);
    }
    Mismatch("an integer");
  }

  Vec2 Vector() const {
    if (!value_.is_array() || value_.size() != 2) Mismatch("an array of two numbers");
    const std::vector<Field> items = Items();
    return {items[0].Number(), items[1].Number()};
  }

  std::optional<double> NumberOrNull() const {
    if (value_.is_null()) return std::nullopt;
    if (!value_.is_number()) Mismatch("a number or null");
    return value_.get<double>();
  }

  [[noreturn]] void Mismatch(const std::string& expected) const {
    constexpr size_t kLongestExcerpt = 60;
    // A nested value is only named: printing it could be long, and as deep as its author liked.
    std::string found = value_.is_structured()
                            ? std::string("an ") + value_.type_name() + " of " + std::to_string(value_.size())
                            : value_.dump(-1, ' ', /*ensure_ascii=*/true);
    if (found.size() > kLongestExcerpt) found = found.substr(0, kLongestExcerpt) + "...";
    throw InputError(where_ + ": " + (path_.empty() ? "/" : path_) + ": expected " + expected + ", found " + found);
  }

  [[noreturn]] void Unsupported(const std::string& type) const {
    throw UnsupportedFeatureError("unsupported feature '" + type + "' at " + path_ +
                                  ": expected vertex, straight, arc, ellipse, superellipse or bezier");
  }

 private:
  // What a field that is missing should have held.
  static std::string Expected(const std::string& key) {
    if (key == "id" || key == "type" || key == "side") return "a string";
    if (key == "fixed") return "true or false";
    if (key == "body1" || key == "body2") return "a body (of a system: its index)";
    if (key == "feature1" || key == "feature2") return "a feature";
    if (key == "bodies" || key == "contacts") return "an array";
    if (key == "mass" || key == "inertia" || key == "theta" || key == "omega" || key == "torque" || key == "radius" ||
        key == "phi") {
      return "a number";
    }
    if (key == "a" || key == "b") return "a number (of a straight edge, an array of two)";
    if (key == "m") return "an integer";
    if (key == "P") return "an array of four points";
    return "an array of two numbers";
  }

  const Json& value_;
  const std::string& where_;
  std::string path_;
};

Body ParseBody(const Field& field) {
  Body body;
  body.mass = field["mass"].Number();
  body.inertia = field["inertia"].Number();
  body.fixed = field["fixed"].Boolean();
  body.x = field["x"].Vector();
  body.theta = field["theta"].Number();
  body.v = field["v"].Vector();
  body.omega = field["omega"].Number();
  body.force = field["force"].Vector();
  body.torque = field["torque"].Number();
  return body;
}

Side ParseSide(const Field& field) {
  const std::string side = field.String();
  if (side == "convex") return Side::kConvex;
  if (side == "concave") return Side::kConcave;
  field.Mismatch("\"convex\" or \"concave\"");
}

Feature ParseFeature(const Field& field) {
  const std::string type = field["type"].String();
  if (type == "vertex") return Vertex{field["p"].Vector()};
  if (type == "straight") return StraightEdge{field["a"].Vector(), field["b"].Vector()};
  if (type == "arc") return ArcEdge{field["center"].Vector(), field["radius"].Number(), ParseSide(field["side"])};
  if (type == "ellipse") {
    return EllipseEdge{field["center"].Vector(), field["a"].Number(), field["b"].Number(), field["phi"].Number(),
                       ParseSide(field["side"])};
  }
  if (type == "superellipse") {
    return SuperellipseEdge{field["center"].Vector(), field["a"].Number(),   field["b"].Number(),
                            field["m"].Integer(),     field["phi"].Number(), ParseSide(field["side"])};
  }
  if (type == "bezier") {
    const std::vector<Field> points = field["P"].Items();
    BezierEdge edge;
    if (points.size() != edge.P.size()) field["P"].Mismatch("an array of four points");
    for (size_t i = 0; i < points.size(); ++i) edge.P[i] = points[i].Vector();
    return edge;
  }
  field.Unsupported(type);
}

// The features and the search's start, which single contacts and the contacts of a system share.
void ParseFeatures(const Field& field, Constraint* constraint) {
  constraint->feature1 = ParseFeature(field["feature1"]);
  constraint->feature2 = ParseFeature(field["feature2"]);
  if (field.Has("s1")) constraint->s1 = field["s1"].NumberOrNull();
  if (field.Has("s2")) constraint->s2 = field["s2"].NumberOrNull();
  if (field.Has("nominal_gap")) constraint->nominal_gap = field["nominal_gap"].Number();
}

ConstraintType ParseConstraintType(const Field& field) {
  const std::string type = field.String();
  if (type == "unilateral") return ConstraintType::kContact;
  if (type == "path") return ConstraintType::kPathJoint;
  if (type == "pin") return ConstraintType::kPin;
  field.Mismatch("\"unilateral\", \"path\" or \"pin\"");
}

RecordKind KindOf(const Field& record) {
  if (record.Has("bodies") || record.Has("contacts")) return RecordKind::kSystem;
  if (!record.Has("kind")) return RecordKind::kContact;
  const std::string kind = record["kind"].String();
  if (kind == "pin") return RecordKind::kPin;
  return kind == "path" ? RecordKind::kPath : RecordKind::kContact;
}

ContactSystem ParseSystem(const Field& record, RecordKind kind) {
  ContactSystem system;
  system.name = record["id"].String();
  if (kind == RecordKind::kSystem) {
    for (const Field& body : record["bodies"].Items()) system.bodies.push_back(ParseBody(body));
    for (const Field& contact : record["contacts"].Items()) {
      Constraint constraint;
      constraint.type = ParseConstraintType(contact["type"]);
      constraint.body1 = contact["body1"].Integer();
      constraint.body2 = contact["body2"].Integer();
      ParseFeatures(contact, &constraint);
      system.constraints.push_back(constraint);
    }
    return system;
  }
  Constraint constraint;
  constraint.type = kind == RecordKind::kPin    ? ConstraintType::kPin
                    : kind == RecordKind::kPath ? ConstraintType::kPathJoint
                                                : ConstraintType::kContact;
  system.bodies = {ParseBody(record["body1"]), ParseBody(record["body2"])};
  system.bodies[0].name = "body1";
  system.bodies[1].name = "body2";
  ParseFeatures(record, &constraint);
  system.constraints = {constraint};
  return system;
}

Json ParseJson(std::string_view line, const std::string& where) {
  try {
    Json json = Json::parse(line);
    if (!json.is_object()) Field(json, where, "").Mismatch("an object");
    return json;
  } catch (const Json::parse_error& error) {
    throw InputError(where + ": not valid JSON, at byte " + std::to_string(error.byte));
  } catch (const Json::out_of_range&) {
    throw InputError(where + ": not valid JSON, a number is out of the range of double");
  }
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

OrderedJson NormalRow(const AssembledLcp& lcp) {
  const RowInfo& row = lcp.rows[0];
  return {{"n", ToJson(row.n)},     {"d", row.d},
          {"d_dot", row.d_dot},     {"J", DenseRow(lcp.problem.J(), 0)},
          {"gamma", row.gamma},     {"A", lcp.problem.DiagonalA()[0]},
          {"b", lcp.problem.b()[0]}};
}

OrderedJson PinRow(const AssembledLcp& lcp, size_t i) {
  const RowInfo& row = lcp.rows[i];
  const auto index = static_cast<Index>(i);
  return {{"axis", std::string(1, row.axis)},
          {"g", row.d},
          {"g_dot", row.d_dot},
          {"J", DenseRow(lcp.problem.J(), index)},
          {"gamma", row.gamma},
          {"A", ToJson(Eigen::VectorXd(lcp.problem.DenseA().row(index)))},
          {"b", lcp.problem.b()[index]}};
}

OrderedJson SystemRow(const RowInfo& row) {
  return {{"contact", row.constraint},
          {"axis", std::string(1, row.axis)},
          {"bilateral", row.bilateral},
          {"n", ToJson(row.n)},
          {"d", row.d},
          {"d_dot", row.d_dot}};
}

void AddAnswer(const ContactSystem& system, RecordKind kind, OrderedJson* out) {
  const AssembledLcp lcp = AssembleContactLcp(system);
  OrderedJson rows = OrderedJson::array();
  switch (kind) {
    case RecordKind::kContact:
    case RecordKind::kPath:
      rows.push_back(NormalRow(lcp));
      (*out)["rows"] = std::move(rows);
      return;
    case RecordKind::kPin:
      for (size_t i = 0; i < lcp.rows.size(); ++i) rows.push_back(PinRow(lcp, i));
      (*out)["rows"] = std::move(rows);
      (*out)["g"] = Column(lcp.rows, &RowInfo::d);
      (*out)["g_dot"] = Column(lcp.rows, &RowInfo::d_dot);
      AddMatrices(lcp, out);
      return;
    case RecordKind::kSystem:
      for (const RowInfo& row : lcp.rows) rows.push_back(SystemRow(row));
      (*out)["rows"] = std::move(rows);
      AddMatrices(lcp, out);
      (*out)["d"] = Column(lcp.rows, &RowInfo::d);
      (*out)["d_dot"] = Column(lcp.rows, &RowInfo::d_dot);
      return;
  }
}

}  // namespace

ContactSystem ParseSystemRecord(std::string_view line, const std::string& where) {
  const Json json = ParseJson(line, where);
  const Field record(json, where, "");
  return ParseSystem(record, KindOf(record));
}

std::string AssembleRecord(std::string_view line, const std::string& where) {
  const Json json = ParseJson(line, where);
  const Field record(json, where, "");
  OrderedJson out = {{"id", record["id"].String()}};
  const RecordKind kind = KindOf(record);
  ContactSystem system;
  try {
    system = ParseSystem(record, kind);
  } catch (const UnsupportedFeatureError& error) {
    out["error"] = error.what();
    return out.dump();
  }
  // From here on every InputError is about the model, not about the file.
  try {
    AddAnswer(system, kind, &out);
  } catch (const InputError& error) {
    out["error"] = error.what();
  }
  return out.dump();
}

}  // namespace lcpbench
