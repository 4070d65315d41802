#include "benchmarks/collection/recipes/recipe.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "benchmarks/collection/recipes/formulas.h"
#include "benchmarks/collection/recipes/hard_cases.h"
#include "benchmarks/collection/recipes/motion_steps.h"
#include "model/contact/assembly.h"
#include "model/geometry/vec2.h"
#include "model/scenes/random.h"
#include "model/scenes/scene.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

// The curve scaled about a point of the body frame; vertices, straight edges and Bezier curves stay themselves.
void Scale(Vec2 fixed, double factor, Feature* feature) {
  const auto scale = [&](std::string_view name, auto& value) {
    if constexpr (requires { value.x; }) value = fixed + factor * (value - fixed);
    if constexpr (std::is_same_v<decltype(value), double&>) value *= name == "phi" ? 1 : factor;
  };
  std::visit(
      [&](auto& edge) {
        if constexpr (requires { edge.side; }) ForEachField(edge, scale);
      },
      *feature);
}

bool IsConvexCurve(const Feature& feature) {
  return std::visit(
      [](const auto& edge) {
        if constexpr (requires { edge.side; }) return edge.side == Side::kConvex;
        return false;
      },
      feature);
}

/// Calls `change` with both features of every contact, the one that it touches, and the contact point in its body's
/// frame.
void ForEachFeature(ContactSystem* system, const auto& change) {
  const AssembledLcp assembled = AssembleContactLcp(*system);
  for (const RowInfo& row : assembled.rows) {
    Constraint& contact = system->constraints[static_cast<size_t>(row.constraint)];
    if (contact.type != ConstraintType::kContact) continue;
    const auto& bodies = system->bodies;
    change(&contact.feature1, contact.feature2, BodyPoint(bodies[static_cast<size_t>(contact.body1)], row.p1));
    change(&contact.feature2, contact.feature1, BodyPoint(bodies[static_cast<size_t>(contact.body2)], row.p2));
  }
}

void Require(bool holds, const char* expected, double found) {
  if (!holds) throw InputError(std::string("expected ") + expected + ", found " + std::to_string(found));
}

using Entry = Eigen::Triplet<double, int>;

constexpr int kPerBody = 3;

// ----- parts of a problem by factors

std::vector<Entry> EntriesOf(const SparseMatrix& J) {
  std::vector<Entry> entries;
  entries.reserve(static_cast<size_t>(J.nonZeros()));
  for (Index i = 0; i < J.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      entries.emplace_back(static_cast<int>(i), static_cast<int>(it.col()), it.value());
    }
  }
  return entries;
}

LcpProblem WithRows(const LcpProblem& given, const std::vector<Entry>& entries, Eigen::VectorXd b,
                    std::vector<FrictionRow> friction) {
  SparseMatrix J(b.size(), given.J().cols());
  J.setFromTriplets(entries.begin(), entries.end());
  // What was proved of the given rows need not hold of these.
  RowBounds bounds = RowBounds::WithBilateralRows(b.size(), given.bilateral_rows());
  bounds.friction = std::move(friction);
  return LcpProblem::FromFactors(given.id(), J, given.inverse_mass(), std::move(b), std::move(bounds));
}

// ----- choosing rows

// So many of the candidates, ascending: a random permutation's first ones [Fisher, Yates].
std::vector<Index> Choose(std::vector<Index> candidates, double share, std::uint64_t seed) {
  Require(share >= 0 && share <= 1, "a share in [0, 1]", share);
  const auto count = static_cast<size_t>(std::floor(share * static_cast<double>(candidates.size()) + 0.5));
  Random random(seed);
  for (size_t k = 0; k < count; ++k) {
    const auto other = k + static_cast<size_t>(random.Integer(static_cast<int>(candidates.size() - k)));
    std::swap(candidates[k], candidates[other]);
  }
  candidates.resize(count);
  std::sort(candidates.begin(), candidates.end());
  return candidates;
}

std::vector<Index> UnilateralRows(const LcpProblem& problem) {
  std::vector<Index> rows;
  for (Index i = 0; i < problem.size(); ++i) {
    if (problem.kind(i) == RowKind::kUnilateral) rows.push_back(i);
  }
  return rows;
}

// ----- rows made from rows

// The given rows, and after them the chosen ones times `sign`. `change(row, copy, entries, b)` adds to the copy.
using ChangeOfCopy = std::function<void(Index row, int copy, std::vector<Entry>* entries, double* b)>;
void Append(Instance* instance, const std::vector<Index>& chosen, double sign, const ChangeOfCopy& change = {}) {
  const LcpProblem& given = instance->problem;
  const Index n = given.size();
  std::vector<Entry> entries = EntriesOf(given.J());
  Eigen::VectorXd b(n + static_cast<Index>(chosen.size()));
  b.head(n) = given.b();
  auto next = static_cast<int>(n);
  for (const Index i : chosen) {
    for (SparseMatrix::InnerIterator it(given.J(), i); it; ++it) {
      entries.emplace_back(next, static_cast<int>(it.col()), sign * it.value());
    }
    b[next] = sign * given.b()[i];
    if (change) change(i, next, &entries, &b[next]);
    instance->rows.push_back(instance->rows[static_cast<size_t>(i)]);
    ++next;
  }
  instance->problem = WithRows(given, entries, std::move(b), given.friction_rows());
}

// The spin that a body gains without contacts [rad/s^2].
double FreeSpin(const Body& body) { return body.fixed ? body.alpha : body.torque / body.inertia; }

double GyrationRadius(const Body& body) { return std::sqrt(body.inertia / body.mass); }

// ----- changes of how edges are curved at the contacts of a system

// Every edge is scaled about its own contact point: point, normal, gap, J and A stay (but for rounding), and b changes
// by the velocity-product terms alone.

// Radii of curvature of the convex edges at contacts are multiplied by contrast^-u, u uniform in [0, 1]: convex edges
// get smaller, so that they still fit where they lie in concave ones.
void ContrastCurvature(ContactSystem* system, double contrast, std::uint64_t seed) {
  Require(contrast >= 1 && std::isfinite(contrast), "a contrast >= 1", contrast);
  Random random(seed);
  ForEachFeature(system, [&](Feature* feature, const Feature& /*other*/, Vec2 point) {
    if (IsConvexCurve(*feature)) Scale(point, 1 / PortablePower(contrast, random.Uniform()), feature);
  });
}

// Every convex arc that lies in a concave one gets the radius (1 - clearance) R of that one: the contact is nearly
// conformal, and gamma grows as 1 / clearance.
void MakeConformal(ContactSystem* system, double clearance, std::uint64_t /*seed*/) {
  Require(clearance > 0 && clearance < 1, "a clearance in (0, 1)", clearance);
  bool any = false;
  ForEachFeature(system, [&](Feature* feature, const Feature& other, Vec2 point) {
    const auto* inner = std::get_if<ArcEdge>(feature);
    const auto* outer = std::get_if<ArcEdge>(&other);
    if (inner == nullptr || outer == nullptr) return;
    if (inner->side != Side::kConvex || outer->side != Side::kConcave) return;
    any = true;
    Scale(point, (1 - clearance) * outer->radius / inner->radius, feature);
  });
  if (!any) throw InputError("expected a convex arc in a concave one, found none in '" + system->name + "'");
}

// ----- friction

// Every contact gets this coefficient of friction and with it a tangent row. The problem is a time step then, which has
// a solution for every mu where all fixed bodies rest: b is J (v + h M^-1 F) + d / h, with loads and velocities as they
// were.
void AddFriction(ContactSystem* system, double mu, std::uint64_t /*seed*/) {
  Require(mu >= 0 && mu <= kMostFriction, "a coefficient of friction from 0 to 1e6", mu);
  for (Body& body : system->bodies) body.friction = mu;
  for (Constraint& constraint : system->constraints) {
    if (constraint.type == ConstraintType::kContact) constraint.friction = mu;
  }
}

// ----- changes of one property of an assembled problem

// Shares are of the unilateral rows, rounded to whole rows, chosen at random by the seed; what is added stands after
// all given rows. With + - * / and sqrt only: the same bits on every machine.

// Redundancy: rows of `share` once more, bit for bit, as where two features report one contact. Solvable if it was; the
// rank of A stays, f is not unique any more, w is as it was. With sign -1 opposed rows: the two leave w_i = 0 as the
// only way, by forces of either sign: bilateral rows in disguise. Always solvable for nonsingular A.
template <int sign>
void RepeatRows(Instance* instance, double share, std::uint64_t seed) {
  Append(instance, Choose(UnilateralRows(instance->problem), share, seed), sign);
}

// Condition: half of the contacts get a neighbour at `distance` along the tangent, in units of the radius of gyration
// of the body that turns more easily, as where a curve is given by polygons. J changes in the two spins, b by the
// spins' acceleration without contacts. The smallest eigenvalue of A falls as distance^2.
void CrowdContacts(Instance* instance, double distance, std::uint64_t seed) {
  Require(distance > 0 && std::isfinite(distance), "a distance > 0", distance);
  constexpr double kCrowdedShare = 0.5;
  const ContactSystem& system = instance->system;
  const auto constraint_of = [instance, &system](Index i) -> const Constraint& {
    return system.constraints[static_cast<size_t>(instance->rows[static_cast<size_t>(i)].constraint)];
  };
  std::vector<Index> contacts = UnilateralRows(instance->problem);
  std::erase_if(contacts, [&](Index i) { return constraint_of(i).type != ConstraintType::kContact; });
  const auto change = [&](Index i, int copy, std::vector<Entry>* entries, double* b) {
    const Constraint& constraint = constraint_of(i);
    const Body& body1 = system.bodies[static_cast<size_t>(constraint.body1)];
    const Body& body2 = system.bodies[static_cast<size_t>(constraint.body2)];
    const bool first = body2.fixed || (!body1.fixed && body1.inertia <= body2.inertia);
    const double shift = distance * GyrationRadius(first ? body1 : body2);
    // p + shift t, t = Perp(n): R x n becomes R x n + shift t x n = R x n - shift. Entries of one place add up.
    entries->emplace_back(copy, kPerBody * constraint.body1 + 2, -shift);
    entries->emplace_back(copy, kPerBody * constraint.body2 + 2, shift);
    *b -= shift * (FreeSpin(body1) - FreeSpin(body2));
  };
  Append(instance, Choose(std::move(contacts), kCrowdedShare, seed), 1, change);
}

// Share of active rows: `slack` sqrt(A_ii) s is added to b of every contact, s the root mean square of A_ii^-1/2 b_i,
// as by gaps in a time step. Solvable if it was, for slack >= 0; below 0 for nonsingular A.
void AddSlack(Instance* instance, double slack, std::uint64_t /*seed*/) {
  if (!std::isfinite(slack)) throw InputError("expected a finite slack");
  const LcpProblem& given = instance->problem;
  const Eigen::VectorXd& diagonal = given.DiagonalA();
  double squared = 0;
  for (Index i = 0; i < given.size(); ++i) {
    if (diagonal[i] > 0) squared += given.b()[i] * given.b()[i] / diagonal[i];
  }
  if (given.size() == 0) return;
  const double mean = std::sqrt(squared / static_cast<double>(given.size()));
  Eigen::VectorXd b = given.b();
  for (const Index i : UnilateralRows(given)) b[i] += slack * mean * std::sqrt(diagonal[i]);
  instance->problem = WithRows(given, EntriesOf(given.J()), std::move(b), given.friction_rows());
}

// Units: row i of J and b is multiplied by 2^k, k integer and uniform in [-binades, binades]. f_i is divided by it and
// w_i multiplied, exactly: whatever is relative to A_ii stays.
void ScaleRows(Instance* instance, double binades, std::uint64_t seed) {
  constexpr double kMost = 100;
  Require(binades >= 0 && binades <= kMost && binades == std::floor(binades), "whole binades from 0 to 100", binades);
  const LcpProblem& given = instance->problem;
  const int range = static_cast<int>(binades);
  Random random(seed);
  std::vector<int> exponents(static_cast<size_t>(given.size()));
  for (int& exponent : exponents) exponent = random.Integer(2 * range + 1) - range;
  std::vector<Entry> entries;
  for (const Entry& entry : EntriesOf(given.J())) {
    entries.emplace_back(entry.row(), entry.col(),
                         std::ldexp(entry.value(), exponents[static_cast<size_t>(entry.row())]));
  }
  Eigen::VectorXd b = given.b();
  for (Index i = 0; i < b.size(); ++i) b[i] = std::ldexp(b[i], exponents[static_cast<size_t>(i)]);
  std::vector<FrictionRow> friction = given.friction_rows();
  for (FrictionRow& row : friction) {
    row.mu = std::ldexp(row.mu, exponents[static_cast<size_t>(row.normal)] - exponents[static_cast<size_t>(row.row)]);
  }
  instance->problem = WithRows(given, entries, std::move(b), std::move(friction));
}

// The same contacts between bodies of very different masses: mass and inertia of every body that can move are
// multiplied by ratio^u, u uniform in [0, 1] and stretched so that the least factor is 1 and the largest is `ratio`
// where two bodies can move. b stays: b = J M^-1 F + gamma holds for the new masses under loads that grow with them, as
// gravity does. J and b stay, so a solvable problem stays solvable (J^T y = 0 and b.y are the same).
void SpreadMasses(Instance* instance, double ratio, std::uint64_t seed) {
  Require(ratio >= 1 && std::isfinite(ratio), "a finite mass ratio of at least 1", ratio);
  const LcpProblem& given = instance->problem;
  Eigen::VectorXd inverse_mass = given.inverse_mass();
  std::vector<Index> movable;
  for (Index body = 0; body < inverse_mass.size() / kPerBody; ++body) {
    if (inverse_mass.segment(kPerBody * body, kPerBody).maxCoeff() > 0) movable.push_back(body);
  }
  Random random(seed);
  std::vector<double> u(movable.size());
  for (double& value : u) value = random.Uniform();
  if (u.size() > 1) {
    const auto [least, most] = std::minmax_element(u.begin(), u.end());
    const double from = *least;
    const double range = *most - *least;
    for (double& value : u) value = (value - from) / range;
  }
  for (std::size_t k = 0; k < movable.size(); ++k) {
    inverse_mass.segment(kPerBody * movable[k], kPerBody) /= PortablePower(ratio, u[k]);
  }
  // What was proved of the rank and of unique forces depends on which masses are zero only.
  instance->problem =
      LcpProblem::FromFactors(given.id(), given.J(), inverse_mass, given.b(), given.bounds(), given.facts());
}

struct ChangeKind {
  const char* name;
  // The change of the system, or else of its rows.
  void (*of_system)(ContactSystem* system, double amount, std::uint64_t seed);
  void (*of_rows)(Instance* instance, double amount, std::uint64_t seed);
};

constexpr ChangeKind kChanges[] = {
    {"curvature-contrast", &ContrastCurvature, nullptr},
    {"conformal", &MakeConformal, nullptr},
    {"friction", &AddFriction, nullptr},
    {"mass-ratio", nullptr, &SpreadMasses},
    {"duplicate-rows", nullptr, &RepeatRows<1>},
    {"crowd-contacts", nullptr, &CrowdContacts},
    {"slack", nullptr, &AddSlack},
    {"scale-rows", nullptr, &ScaleRows},
    {"oppose-rows", nullptr, &RepeatRows<-1>},
};

const ChangeKind& Find(const std::string& name) {
  for (const ChangeKind& kind : kChanges) {
    if (name == kind.name) return kind;
  }
  throw InputError("unknown change '" + name + "', expected one of " + boost::algorithm::join(AllChanges(), ", "));
}

ContactSystem Generate(const Recipe& recipe) {
  if (recipe.rows < 1) throw InputError("expected rows >= 1, found " + std::to_string(recipe.rows));
  for (const HardCase& hard : AllHardCases()) {
    if (hard.key == recipe.scene) return hard.generate(recipe.rows, recipe.seed);
  }
  return GenerateScene(recipe.scene, recipe.rows, recipe.seed);
}

std::string KindOf(const Feature& feature) {
  return std::visit(
      [](const auto& edge) {
        std::string name = edge.kName;
        if constexpr (requires { edge.side; }) name = (edge.side == Side::kConcave ? "concave " : "") + name;
        return name;
      },
      feature);
}

std::string KindOf(const Constraint& constraint) {
  switch (constraint.type) {
    case ConstraintType::kContact:
      break;
    case ConstraintType::kPathJoint:
      return "path joint";
    case ConstraintType::kPin:
      return "pin";
    case ConstraintType::kRod:
      return "rod";
    case ConstraintType::kRope:
      return "rope";
  }
  const auto [first, second] = std::minmax({KindOf(constraint.feature1), KindOf(constraint.feature2)});
  return first + " on " + second;
}

}  // namespace

std::vector<std::string> AllChanges() {
  std::vector<std::string> names;
  for (const ChangeKind& kind : kChanges) names.emplace_back(kind.name);
  return names;
}

std::string RecipeId(const Recipe& recipe) {
  std::string id = BaseOf(recipe);
  if (recipe.motion_step > 0) id += "-step" + std::to_string(recipe.motion_step);
  for (const Change& change : recipe.changes) id += "-" + change.name + "-" + NumberText(change.amount);
  return id;
}

std::string BaseOf(const Recipe& recipe) {
  return recipe.scene + "-n" + std::to_string(recipe.rows) + "-s" + std::to_string(recipe.seed) +
         (recipe.motion_step > 0 ? "-motion" : "");
}

Instance Changed(ContactSystem system, const std::vector<Change>& changes, std::uint64_t seed) {
  for (const auto& [name, amount] : changes) {
    if (Find(name).of_system != nullptr) Find(name).of_system(&system, amount, seed);
  }
  AssembledLcp assembled = AssembleInstant(system, kInstantStep);
  Instance instance{std::move(system), std::move(assembled.rows), std::move(assembled.problem)};
  for (const auto& [name, amount] : changes) {
    if (Find(name).of_rows != nullptr) Find(name).of_rows(&instance, amount, seed);
  }
  return instance;
}

Instance MakeInstance(const Recipe& recipe) {
  const std::string id = RecipeId(recipe);
  try {
    if (recipe.motion_step > 0) return MakeMotionStep(recipe);
    if (const Formula* formula = FindFormula(recipe.scene)) {
      FormulaProblem made = MakeFormula(*formula, recipe);
      return {{}, {}, WithId(made.problem, id), std::move(made.f)};
    }
    Instance instance = Changed(Generate(recipe), recipe.changes, recipe.seed);
    instance.problem = WithId(instance.problem, id);
    return instance;
  } catch (const InputError& error) {
    throw InputError(id + ": " + error.what());
  }
}

std::map<std::string, int> CountKinds(const ContactSystem& system) {
  std::map<std::string, int> counts;
  for (const Constraint& constraint : system.constraints) ++counts[KindOf(constraint)];
  return counts;
}

LcpProblem WithId(const LcpProblem& given, std::string id) {
  switch (given.given_form()) {
    case MatrixForm::kDense:
      return LcpProblem::FromDense(std::move(id), given.DenseA(), given.b(), given.bounds(), given.facts());
    case MatrixForm::kSparse:
      return LcpProblem::FromSparse(std::move(id), given.SparseA(), given.b(), given.bounds(), given.facts());
    case MatrixForm::kFactors:
      break;
  }
  return LcpProblem::FromFactors(std::move(id), given.J(), given.inverse_mass(), given.b(), given.bounds(),
                                 given.facts());
}

double PortablePower(double ratio, double u) {
  if (u >= 1) return ratio;
  constexpr int kDigits = 53;
  double power = 1;
  double root = ratio;
  for (int digit = 0; digit < kDigits && u > 0; ++digit) {
    root = std::sqrt(root);
    u *= 2;
    if (u < 1) continue;
    u -= 1;
    power *= root;
  }
  return power;
}

Eigen::VectorXd AnotherB(const LcpProblem& problem, std::uint64_t seed) {
  constexpr double kShare = 0.1;
  const Eigen::VectorXd& D = problem.DiagonalA();
  const Eigen::VectorXd& b = problem.b();
  double load = 0;
  for (Index i = 0; i < problem.size(); ++i) {
    if (D[i] > 0) load = std::max(load, std::abs(b[i]) / std::sqrt(D[i]));
  }
  Random random(seed);
  Eigen::VectorXd d = Eigen::VectorXd::Zero(problem.size());
  for (Index i = 0; i < problem.size(); ++i) {
    const double u = random.Uniform(problem.is_bilateral(i) ? -1 : 0, 1);
    if (D[i] > 0 && problem.kind(i) != RowKind::kFriction) d[i] = kShare * load / std::sqrt(D[i]) * u;
  }
  Eigen::VectorXd w;
  problem.ComputeW(d, &w);  // A d + b
  return b - (w - b);
}

}  // namespace lcpbench
