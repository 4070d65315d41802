#include "benchmarks/collection/recipes/changes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/assembly.h"
#include "model/scenes/random.h"
#include "support/input_error.h"

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

Vec2 InBodyFrame(const Body& body, Vec2 world) {
  const auto [cos, sin] = SinCos(body.theta);
  return Rotate({cos, -sin}, world - body.x);
}

/// Calls `change` with both features of every contact, the one that it touches, and the contact point in its body's
/// frame.
template <typename Change>
void ForEachFeature(ContactSystem* system, const Change& change) {
  const AssembledLcp assembled = AssembleContactLcp(*system);
  for (const RowInfo& row : assembled.rows) {
    Constraint& contact = system->constraints[static_cast<size_t>(row.constraint)];
    if (contact.type != ConstraintType::kContact) continue;
    const auto& bodies = system->bodies;
    change(&contact.feature1, contact.feature2, InBodyFrame(bodies[static_cast<size_t>(contact.body1)], row.p1));
    change(&contact.feature2, contact.feature1, InBodyFrame(bodies[static_cast<size_t>(contact.body2)], row.p2));
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

LcpProblem WithRows(const LcpProblem& given, const std::vector<Entry>& entries, Eigen::VectorXd b) {
  SparseMatrix J(b.size(), given.J().cols());
  J.setFromTriplets(entries.begin(), entries.end());
  // What was proved of the given rows need not hold of these.
  RowBounds bounds = RowBounds::WithBilateralRows(b.size(), given.bilateral_rows());
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
    if (!problem.is_bilateral(i)) rows.push_back(i);
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
  instance->problem = WithRows(given, entries, std::move(b));
}

// The spin that a body gains without contacts [rad/s^2].
double FreeSpin(const Body& body) { return body.fixed ? body.alpha : body.torque / body.inertia; }

double GyrationRadius(const Body& body) { return std::sqrt(body.inertia / body.mass); }

}  // namespace

Instance InstanceOf(ContactSystem system) {
  AssembledLcp assembled = AssembleContactLcp(system);
  return {std::move(system), std::move(assembled.rows), std::move(assembled.problem)};
}

LcpProblem WithId(const LcpProblem& given, std::string id) {
  return LcpProblem::FromFactors(std::move(id), given.J(), given.inverse_mass(), given.b(),
                                 RowBounds::WithBilateralRows(given.size(), given.bilateral_rows()), given.facts());
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

void ContrastCurvature(ContactSystem* system, double contrast, std::uint64_t seed) {
  Require(contrast >= 1 && std::isfinite(contrast), "a contrast >= 1", contrast);
  Random random(seed);
  ForEachFeature(system, [&](Feature* feature, const Feature& /*other*/, Vec2 point) {
    if (IsConvexCurve(*feature)) Scale(point, 1 / PortablePower(contrast, random.Uniform()), feature);
  });
}

void MakeConformal(ContactSystem* system, double clearance) {
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

void DuplicateRows(Instance* instance, double share, std::uint64_t seed) {
  Append(instance, Choose(UnilateralRows(instance->problem), share, seed), 1);
}

void OpposeRows(Instance* instance, double share, std::uint64_t seed) {
  Append(instance, Choose(UnilateralRows(instance->problem), share, seed), -1);
}

void CrowdContacts(Instance* instance, double share, double distance, std::uint64_t seed) {
  Require(distance > 0 && std::isfinite(distance), "a distance > 0", distance);
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
  Append(instance, Choose(std::move(contacts), share, seed), 1, change);
}

void AddSlack(Instance* instance, double slack) {
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
  instance->problem = WithRows(given, EntriesOf(given.J()), std::move(b));
}

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
  instance->problem = WithRows(given, entries, std::move(b));
}

LcpProblem SpreadMasses(const LcpProblem& given, double ratio, std::uint64_t seed) {
  Require(ratio >= 1 && std::isfinite(ratio), "a finite mass ratio of at least 1", ratio);
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
  return LcpProblem::FromFactors(given.id() + "-spread", given.J(), inverse_mass, given.b(),
                                 RowBounds::WithBilateralRows(given.size(), given.bilateral_rows()), given.facts());
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
    if (D[i] > 0) d[i] = kShare * load / std::sqrt(D[i]) * u;
  }
  Eigen::VectorXd w;
  problem.ComputeW(d, &w);  // A d + b
  return b - (w - b);
}

}  // namespace lcpbench
