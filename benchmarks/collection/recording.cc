#include "benchmarks/collection/recording.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <span>
#include <tuple>
#include <utility>

#include "benchmarks/collection/recipes/recipe.h"
#include "model/contact/assembly.h"
#include "solvers/linear_algebra/islands.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {
namespace {

using Vector = RecordedStep::Vector;

double Dot(const Vector& a, const Vector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
Vector Minus(const Vector& a, const Vector& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
Vector Cross(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

// Two or three numbers; in the plane the third is 0.
Vector ParseVector(const JsonField& field, int dimension) {
  const std::vector<double> numbers = field.Numbers(static_cast<std::size_t>(dimension));
  return {numbers[0], numbers[1], dimension == 3 ? numbers[2] : 0.0};
}

// A spin or torque: in the plane a number.
Vector ParseSpin(const JsonField& field, int dimension) {
  return dimension == 3 ? ParseVector(field, 3) : Vector{0, 0, field.Number()};
}

double ParseNonnegative(const JsonField& field) {
  const double number = field.Number();
  if (!(number >= 0)) field.Mismatch("a number >= 0");
  return number;
}

std::pair<int, int> ParsePair(const JsonField& field, std::size_t bodies) {
  const auto end = [&](std::size_t k) {
    const JsonField item = field.Item(k);
    return item.IsNumber() && item.Number() == -1 ? -1 : item.IndexBelow(bodies);
  };
  field.Size(2);
  const std::pair<int, int> pair = {end(0), end(1)};
  if (pair.first == pair.second) field.Mismatch("two different bodies");
  return pair;
}

// In the plane the normal turned by a right angle; in space one that is perpendicular to the axis that the normal is
// least along, and the one that completes them.
std::vector<Vector> TangentsOf(const Vector& n, int dimension) {
  if (dimension == 2) return {{-n[1], n[0], 0}};
  const auto least = std::min_element(n.begin(), n.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
  Vector axis = {0, 0, 0};
  axis[static_cast<std::size_t>(least - n.begin())] = 1;
  Vector first = Cross(axis, n);
  const double size = std::sqrt(Dot(first, first));
  for (double& component : first) component /= size;
  return {first, Cross(n, first)};
}

// The transpose of the matrix that turns principal axes to the world, row by row: its rows are the axes.
std::array<Vector, 3> AxesOf(const std::array<double, 4>& q) {
  const auto [w, x, y, z] = q;
  const double s = 2 / (w * w + x * x + y * y + z * z);
  return {{{1 - s * (y * y + z * z), s * (x * y + w * z), s * (x * z - w * y)},
           {s * (x * y - w * z), 1 - s * (x * x + z * z), s * (y * z + w * x)},
           {s * (x * z + w * y), s * (y * z - w * x), 1 - s * (x * x + y * y)}}};
}

// Rows of J by their two bodies' linear and angular parts in world axes, put together to a problem.
class RowBuilder {
 public:
  RowBuilder(const RecordingHeader& header, const RecordedStep& step)
      : header_(header),
        step_(step),
        width_(header.dimension == 3 ? 6 : 3),
        place_(header.bodies.size(), -1),
        axes_(header.bodies.size()) {
    for (std::size_t k = 0; k < axes_.size(); ++k) axes_[k] = AxesOf(step.bodies[k].turn);
  }

  struct Part {
    int body;
    Vector linear, angular;
  };

  // w = J v^+ + offset. False where no body of it can move.
  bool Add(const Part& first, const Part& second, double offset, bool bilateral, const std::string& identity) {
    double b = offset;
    bool moves = false;
    for (const Part* part : {&first, &second}) {
      if (part->body < 0) continue;
      b += Dot(part->linear, FreeVelocity(part->body)) + Dot(part->angular, FreeSpin(part->body));
      moves |= CanMove(header_, part->body);
    }
    if (!moves) return false;
    for (const Part* part : {&first, &second}) AddPart(*part);
    if (bilateral) bilateral_.push_back(rows_);
    b_.push_back(b);
    identity_.push_back(identity);
    ++rows_;
    return true;
  }

  // A row of friction on the row that was added last but `tangents`.
  void AddFriction(const Part& first, const Part& second, double mu, int tangents, const std::string& identity) {
    const Index normal = rows_ - 1 - tangents;
    if (Add(first, second, 0, false, identity)) friction_.push_back({rows_ - 1, normal, mu});
  }

  RecordedProblem Take(std::string id) && {
    Eigen::VectorXd inverse_mass(width_ * static_cast<Index>(columns_of_.size()));
    for (std::size_t k = 0; k < columns_of_.size(); ++k) {
      const RecordingHeader::Body& body = header_.bodies[static_cast<std::size_t>(columns_of_[k])];
      const auto place = width_ * static_cast<Index>(k);
      for (int a = 0; a < width_; ++a) {
        const bool linear = a < header_.dimension;
        inverse_mass[place + a] =
            linear ? body.inverse_mass : body.inverse_inertia[static_cast<std::size_t>(width_ == 3 ? 2 : a - 3)];
      }
    }
    SparseMatrix J(rows_, inverse_mass.size());
    J.setFromTriplets(entries_.begin(), entries_.end());
    MatrixFacts facts;
    facts.columns_per_body = width_;
    RowBounds bounds = RowBounds::WithBilateralRows(rows_, bilateral_);
    bounds.friction = std::move(friction_);
    return {LcpProblem::FromFactors(std::move(id), J, std::move(inverse_mass),
                                    Eigen::Map<const Eigen::VectorXd>(b_.data(), rows_), std::move(bounds), facts),
            std::move(identity_)};
  }

 private:
  void AddPart(const Part& part) {
    if (!CanMove(header_, part.body)) return;
    int& place = place_[static_cast<std::size_t>(part.body)];
    if (place < 0) {
      place = static_cast<int>(columns_of_.size());
      columns_of_.push_back(part.body);
    }
    const auto add = [&](int column, double value) {
      if (value != 0) entries_.emplace_back(static_cast<int>(rows_), width_ * place + column, value);
    };
    for (int a = 0; a < header_.dimension; ++a) add(a, part.linear[static_cast<std::size_t>(a)]);
    if (width_ == 3) return add(2, part.angular[2]);
    const auto& axes = axes_[static_cast<std::size_t>(part.body)];
    for (int a = 0; a < 3; ++a) add(3 + a, Dot(axes[static_cast<std::size_t>(a)], part.angular));
  }

  // v + h M^-1 F.
  Vector FreeVelocity(int body) const {
    const RecordedStep::Body& state = step_.bodies[static_cast<std::size_t>(body)];
    const double gain = header_.time_step * header_.bodies[static_cast<std::size_t>(body)].inverse_mass;
    return {state.v[0] + gain * state.force[0], state.v[1] + gain * state.force[1], state.v[2] + gain * state.force[2]};
  }

  Vector FreeSpin(int body) const {
    const RecordedStep::Body& state = step_.bodies[static_cast<std::size_t>(body)];
    const std::array<double, 3>& inverse = header_.bodies[static_cast<std::size_t>(body)].inverse_inertia;
    if (width_ == 3) return {0, 0, state.omega[2] + header_.time_step * (inverse[2] * state.torque[2])};
    Vector spin = state.omega;
    for (std::size_t a = 0; a < 3; ++a) {
      const Vector& axis = axes_[static_cast<std::size_t>(body)][a];
      const double gain = header_.time_step * (inverse[a] * Dot(axis, state.torque));
      for (std::size_t c = 0; c < 3; ++c) spin[c] += gain * axis[c];
    }
    return spin;
  }

  const RecordingHeader& header_;
  const RecordedStep& step_;
  const int width_;
  std::vector<int> place_;  // of a body among the columns, -1: it has none yet
  std::vector<std::array<Vector, 3>> axes_;
  std::vector<int> columns_of_;
  std::vector<Eigen::Triplet<double, int>> entries_;
  std::vector<double> b_;
  std::vector<Index> bilateral_;
  std::vector<FrictionRow> friction_;
  std::vector<std::string> identity_;
  Index rows_ = 0;
};

bool IsRound(const RecordedStep::Contact& contact, std::size_t end) { return contact.radius[end] != 0; }

// What curvature our model needs is known: of two circles, or of a circle on something flat.
bool IsOfCircles(const RecordedStep::Contact& contact) { return IsRound(contact, 0) || IsRound(contact, 1); }

// The feature at one end of a contact, in the body's frame: `outward` leaves the body there.
Feature FeatureAt(const Body& body, Vec2 point, Vec2 outward, double radius) {
  if (radius != 0) {
    return ArcEdge{BodyPoint(body, point - radius * outward), std::abs(radius),
                   radius > 0 ? Side::kConvex : Side::kConcave};
  }
  // The outward normal is on the right-hand side of a straight edge.
  const Vec2 along = Perp(outward);
  return StraightEdge{BodyPoint(body, point - along), BodyPoint(body, point + along)};
}

}  // namespace

bool CanMove(const RecordingHeader& header, int body) {
  if (body < 0) return false;
  const RecordingHeader::Body& given = header.bodies[static_cast<std::size_t>(body)];
  return given.inverse_mass > 0 || *std::max_element(given.inverse_inertia.begin(), given.inverse_inertia.end()) > 0;
}

RecordingHeader ParseRecordingHeader(std::string_view line, const std::string& where) {
  const auto json = ParseJsonObject(line, where);
  const JsonField field(json, where);
  if (!field.Has("lcpbench_recording") || json["lcpbench_recording"] != 1) {
    throw InputError(where + ": expected the header of a recording, a line with \"lcpbench_recording\":1");
  }
  RecordingHeader header;
  header.engine = field["engine"].String();
  header.engine_version = field["engine_version"].String();
  header.licence = field["licence"].String();
  header.scene = field["scene"].String();
  header.source = field["source"].String();
  header.dimension = field["dimension"].Integer();
  if (header.dimension != 2 && header.dimension != 3) field["dimension"].Mismatch("2 or 3");
  header.time_step = field["time_step"].Number();
  if (!(header.time_step > 0)) field["time_step"].Mismatch("a number > 0");
  for (const JsonField& item : field["bodies"].Items()) {
    RecordingHeader::Body& body = header.bodies.emplace_back();
    body.inverse_mass = ParseNonnegative(item["inverse_mass"]);
    const JsonField inertia = item["inverse_inertia"];
    if (header.dimension == 2) {
      body.inverse_inertia[2] = ParseNonnegative(inertia);
      continue;
    }
    inertia.Size(3);
    for (std::size_t a = 0; a < 3; ++a) body.inverse_inertia[a] = ParseNonnegative(inertia.Item(a));
  }
  return header;
}

RecordedStep ParseRecordedStep(std::string_view line, const RecordingHeader& header, const std::string& where) {
  const auto json = ParseJsonObject(line, where);
  const JsonField field(json, where);
  const int dimension = header.dimension;
  RecordedStep step;
  step.number = field["step"].Integer();
  const JsonField states = field["bodies"];
  for (const char* key : {"x", "q", "v", "omega", "force", "torque"}) states[key].Size(header.bodies.size());
  for (std::size_t k = 0; k < header.bodies.size(); ++k) {
    RecordedStep::Body& body = step.bodies.emplace_back();
    body.x = ParseVector(states["x"].Item(k), dimension);
    body.v = ParseVector(states["v"].Item(k), dimension);
    body.omega = ParseSpin(states["omega"].Item(k), dimension);
    body.force = ParseVector(states["force"].Item(k), dimension);
    body.torque = ParseSpin(states["torque"].Item(k), dimension);
    const JsonField turn = states["q"].Item(k);
    if (dimension == 2) {
      body.angle = turn.Number();
      continue;
    }
    const std::vector<double> numbers = turn.Numbers(4);
    std::copy(numbers.begin(), numbers.end(), body.turn.begin());
    const double size =
        numbers[0] * numbers[0] + Dot({numbers[1], numbers[2], numbers[3]}, {numbers[1], numbers[2], numbers[3]});
    if (!(std::abs(size - 1) <= 1e-6)) turn.Mismatch("a unit quaternion");
  }
  std::set<std::string> identities;
  const auto take_identity = [&](const JsonField& owner, const std::string& identity) {
    if (!identities.insert(identity).second) owner.Mismatch("an id that stands once in the step");
    return identity;
  };
  for (const JsonField& item : field["contacts"].Items()) {
    RecordedStep::Contact& contact = step.contacts.emplace_back();
    std::tie(contact.first, contact.second) = ParsePair(item["b"], header.bodies.size());
    contact.point = ParseVector(item["p"], dimension);
    contact.normal = ParseVector(item["n"], dimension);
    if (!(std::abs(Dot(contact.normal, contact.normal) - 1) <= 1e-6)) item["n"].Mismatch("a unit vector");
    contact.gap = item["gap"].Number();
    contact.friction = ParseNonnegative(item["mu"]);
    contact.identity = take_identity(item["id"], item["id"].String());
    item["shape"].Size(2);
    item["radius"].Size(2);
    for (std::size_t end = 0; end < 2; ++end) {
      contact.shape[end] = item["shape"].Item(end).String();
      contact.radius[end] = item["radius"].Item(end).NumberOrNull().value_or(0);
    }
  }
  for (const JsonField& item : field["joints"].Items()) {
    const std::pair<int, int> bodies = ParsePair(item["b"], header.bodies.size());
    const std::string joint = item["id"].String();
    item["kind"].String();
    const std::vector<JsonField> rows = item["rows"].Items();
    for (std::size_t k = 0; k < rows.size(); ++k) {
      RecordedStep::JointRow& row = step.joint_rows.emplace_back();
      std::tie(row.first, row.second) = bodies;
      row.J = rows[k]["J"].Numbers(dimension == 3 ? 12 : 6);
      rows[k]["error"].Number();
      row.is_limit = rows[k].Has("limit") && rows[k]["limit"].Boolean();
      row.identity = take_identity(item["id"], joint + ":" + std::to_string(k));
    }
  }
  return step;
}

std::string RecordedId(const RecordingHeader& header, const RecordedStep& step) {
  return header.engine + "-" + header.scene + "-step" + std::to_string(step.number);
}

RecordedProblem VelocityProblem(const RecordingHeader& header, const RecordedStep& step, bool with_friction) {
  RowBuilder rows(header, step);
  for (const RecordedStep::Contact& contact : step.contacts) {
    const auto part = [&](int body, double sign, const Vector& direction) -> RowBuilder::Part {
      if (body < 0) return {-1, {}, {}};
      const Vector arm = Minus(contact.point, step.bodies[static_cast<std::size_t>(body)].x);
      const Vector along = {sign * direction[0], sign * direction[1], sign * direction[2]};
      return {body, along, Cross(arm, along)};
    };
    const Vector& n = contact.normal;
    const bool is_row = rows.Add(part(contact.first, -1, n), part(contact.second, 1, n),
                                 std::max(contact.gap, 0.0) / header.time_step, false, contact.identity);
    if (!is_row || !with_friction || contact.friction == 0) continue;
    int tangents = 0;
    for (const Vector& t : TangentsOf(n, header.dimension)) {
      rows.AddFriction(part(contact.first, -1, t), part(contact.second, 1, t), contact.friction, tangents,
                       contact.identity + ":tangent" + std::to_string(tangents));
      ++tangents;
    }
  }
  for (const RecordedStep::JointRow& row : step.joint_rows) {
    const auto part = [&](int body, std::size_t begin) -> RowBuilder::Part {
      const double* j = row.J.data() + begin;
      if (header.dimension == 2) return {body, {j[0], j[1], 0}, {0, 0, j[2]}};
      return {body, {j[0], j[1], j[2]}, {j[3], j[4], j[5]}};
    };
    rows.Add(part(row.first, 0), part(row.second, row.J.size() / 2), 0, !row.is_limit, row.identity);
  }
  return std::move(rows).Take(RecordedId(header, step) + (with_friction ? "-friction" : ""));
}

std::optional<RecordedProblem> AccelerationProblem(const RecordingHeader& header, const RecordedStep& step) {
  if (header.dimension != 2 || !step.joint_rows.empty() || step.contacts.empty() ||
      !std::all_of(step.contacts.begin(), step.contacts.end(), IsOfCircles)) {
    return std::nullopt;
  }
  ContactSystem system;
  system.name = RecordedId(header, step) + "-acceleration";
  for (std::size_t k = 0; k < header.bodies.size(); ++k) {
    const RecordingHeader::Body& given = header.bodies[k];
    const RecordedStep::Body& state = step.bodies[k];
    Body& body = system.bodies.emplace_back();
    body.name = std::to_string(k);
    body.fixed = given.inverse_mass == 0 || given.inverse_inertia[2] == 0;
    if (body.fixed && CanMove(header, static_cast<int>(k)))
      return std::nullopt;  // it turns about a point, which our bodies do not
    if (!body.fixed) {
      body.mass = 1 / given.inverse_mass;
      body.inertia = 1 / given.inverse_inertia[2];
    }
    body.x = {state.x[0], state.x[1]};
    body.theta = state.angle;
    body.v = {state.v[0], state.v[1]};
    body.omega = state.omega[2];
    body.force = {state.force[0], state.force[1]};
    body.torque = state.torque[2];
  }
  const auto world = static_cast<int>(system.bodies.size());
  system.bodies.emplace_back().name = "world";
  system.bodies.back().fixed = true;
  RecordedProblem recorded{LcpProblem::FromDense("", {}, {}), {}};
  for (const RecordedStep::Contact& contact : step.contacts) {
    // Our normal points from body 2 to body 1.
    const auto index = [&](int body) { return body < 0 ? world : body; };
    Constraint constraint;
    constraint.body1 = index(contact.second);
    constraint.body2 = index(contact.first);
    const Body& body1 = system.bodies[static_cast<std::size_t>(constraint.body1)];
    const Body& body2 = system.bodies[static_cast<std::size_t>(constraint.body2)];
    if (body1.fixed && body2.fixed) continue;
    const Vec2 point{contact.point[0], contact.point[1]};
    const double size = std::sqrt(Dot(contact.normal, contact.normal));
    const Vec2 n{contact.normal[0] / size, contact.normal[1] / size};
    const Vec2 half = (0.5 * contact.gap) * n;
    constraint.feature1 = FeatureAt(body1, point + half, Vec2{} - n, contact.radius[1]);
    constraint.feature2 = FeatureAt(body2, point - half, n, contact.radius[0]);
    constraint.nominal_gap = contact.gap;
    system.constraints.push_back(constraint);
    recorded.identity.push_back(contact.identity);
  }
  if (system.constraints.empty()) return std::nullopt;
  recorded.problem = AssembleContactLcp(system).problem;
  return recorded;
}

std::optional<RecordedProblem> MakeRecorded(const RecordingHeader& header, const RecordedStep& step,
                                            RecordedLevel level) {
  if (level == RecordedLevel::kAcceleration) return AccelerationProblem(header, step);
  return VelocityProblem(header, step, level == RecordedLevel::kFriction);
}

RecordingReader::RecordingReader(const std::string& path) : lines_(path) {
  std::string line;
  if (!lines_.Next(&line)) throw InputError(path + ": expected the header of a recording, found an empty file");
  header_ = ParseRecordingHeader(line, path + ":1");
}

bool RecordingReader::Next(RecordedStep* step) {
  std::string line;
  if (!lines_.Next(&line)) return false;
  *step = ParseRecordedStep(line, header_, path() + ":" + std::to_string(lines_.number()));
  return true;
}

std::vector<RecordedProblem> IslandsOf(const RecordedProblem& whole, Index least_rows) {
  Islands islands;
  islands.Reserve(whole.problem.size());
  islands.FindByColumns(whole.problem.J(), whole.problem.inverse_mass(), whole.problem.friction_rows());
  std::vector<RecordedProblem> found;
  for (Index k = 0; k < islands.count(); ++k) {
    const std::span<const Index> rows = islands.rows(k);
    if (static_cast<Index>(rows.size()) < least_rows) continue;
    const LcpProblem part = Subproblem(whole.problem, rows);
    const std::string id = whole.problem.id() + "-island" + std::to_string(k + 1);
    RecordedProblem& island = found.emplace_back(RecordedProblem{WithId(part, id), {}});
    for (const Index row : rows) island.identity.push_back(whole.identity[static_cast<std::size_t>(row)]);
  }
  return found;
}

}  // namespace lcpbench
