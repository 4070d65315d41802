#include "benchmarks/collection/recipes/changes.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "model/contact/assembly.h"
#include "model/geometry/trig.h"
#include "model/scenes/random.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

Vec2 ScaledAbout(Vec2 fixed, Vec2 point, double factor) { return fixed + factor * (point - fixed); }

// The edge scaled about a point of the body frame; vertices and straight edges stay themselves.
void Scale(Vec2 fixed, double factor, Feature* feature) {
  if (auto* arc = std::get_if<ArcEdge>(feature)) {
    arc->center = ScaledAbout(fixed, arc->center, factor);
    arc->radius *= factor;
  } else if (auto* ellipse = std::get_if<EllipseEdge>(feature)) {
    ellipse->center = ScaledAbout(fixed, ellipse->center, factor);
    ellipse->a *= factor;
    ellipse->b *= factor;
  } else if (auto* oval = std::get_if<SuperellipseEdge>(feature)) {
    oval->center = ScaledAbout(fixed, oval->center, factor);
    oval->a *= factor;
    oval->b *= factor;
  }
}

bool IsConvexCurve(const Feature& feature) {
  if (const auto* arc = std::get_if<ArcEdge>(&feature)) return arc->side == Side::kConvex;
  if (const auto* ellipse = std::get_if<EllipseEdge>(&feature)) return ellipse->side == Side::kConvex;
  if (const auto* oval = std::get_if<SuperellipseEdge>(&feature)) return oval->side == Side::kConvex;
  return false;
}

Vec2 InBodyFrame(const Body& body, Vec2 world) {
  const Rotation rotation = SinCos(body.theta);
  const Vec2 d = world - body.x;
  return {rotation.cos * d.x + rotation.sin * d.y, -rotation.sin * d.x + rotation.cos * d.y};
}

using Entry = Eigen::Triplet<double, int>;

constexpr Index kPerBody = 3;

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

void RequireShare(double share) {
  if (!(share >= 0 && share <= 1)) throw InputError("expected a share in [0, 1], found " + std::to_string(share));
}

// ----- choosing rows

// So many of the candidates, ascending: a random permutation's first ones [Fisher, Yates].
std::vector<Index> Choose(std::vector<Index> candidates, double share, std::uint64_t seed) {
  RequireShare(share);
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

struct NewRow {
  std::vector<std::pair<Index, double>> J;
  double b = 0;
};

NewRow RowOf(const LcpProblem& problem, Index i) {
  NewRow row;
  for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) row.J.emplace_back(it.col(), it.value());
  row.b = problem.b()[i];
  return row;
}

// The given rows, and after them what `change` makes of copies of the chosen ones.
void Append(Instance* instance, const std::vector<Index>& chosen,
            const std::function<void(Index row, NewRow* copy)>& change) {
  const LcpProblem& given = instance->problem;
  const Index n = given.size();
  std::vector<Entry> entries = EntriesOf(given.J());
  Eigen::VectorXd b(n + static_cast<Index>(chosen.size()));
  b.head(n) = given.b();
  Index next = n;
  for (const Index i : chosen) {
    NewRow row = RowOf(given, i);
    change(i, &row);
    for (const auto& [column, value] : row.J) {
      entries.emplace_back(static_cast<int>(next), static_cast<int>(column), value);
    }
    b[next] = row.b;
    instance->rows.push_back(instance->rows[static_cast<size_t>(i)]);
    ++next;
  }
  instance->problem = WithRows(given, entries, std::move(b));
}

// The spin that a body gains without contacts [rad/s^2].
double FreeSpin(const Body& body) { return body.fixed ? body.alpha : body.torque / body.inertia; }

double GyrationRadius(const Body& body) { return std::sqrt(body.inertia / body.mass); }

}  // namespace

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
  if (!(contrast >= 1 && std::isfinite(contrast))) {
    throw InputError("expected a contrast >= 1, found " + std::to_string(contrast));
  }
  const AssembledLcp assembled = AssembleContactLcp(*system);
  Random random(seed);
  for (const RowInfo& row : assembled.rows) {
    Constraint& constraint = system->constraints[static_cast<size_t>(row.constraint)];
    if (constraint.type != ConstraintType::kContact) continue;
    const auto shrink = [&](int body, Vec2 point, Feature* feature) {
      if (!IsConvexCurve(*feature)) return;
      const double factor = 1 / PortablePower(contrast, random.Uniform());
      Scale(InBodyFrame(system->bodies[static_cast<size_t>(body)], point), factor, feature);
    };
    shrink(constraint.body1, row.p1, &constraint.feature1);
    shrink(constraint.body2, row.p2, &constraint.feature2);
  }
}

void MakeConformal(ContactSystem* system, double clearance) {
  if (!(clearance > 0 && clearance < 1)) {
    throw InputError("expected a clearance in (0, 1), found " + std::to_string(clearance));
  }
  const AssembledLcp assembled = AssembleContactLcp(*system);
  bool any = false;
  for (const RowInfo& row : assembled.rows) {
    Constraint& constraint = system->constraints[static_cast<size_t>(row.constraint)];
    if (constraint.type != ConstraintType::kContact) continue;
    const auto fit = [&](int body, Vec2 point, Feature* feature, const Feature& other) {
      const auto* inner = std::get_if<ArcEdge>(feature);
      const auto* outer = std::get_if<ArcEdge>(&other);
      if (inner == nullptr || outer == nullptr) return;
      if (inner->side != Side::kConvex || outer->side != Side::kConcave) return;
      any = true;
      Scale(InBodyFrame(system->bodies[static_cast<size_t>(body)], point),
            (1 - clearance) * outer->radius / inner->radius, feature);
    };
    fit(constraint.body1, row.p1, &constraint.feature1, constraint.feature2);
    fit(constraint.body2, row.p2, &constraint.feature2, constraint.feature1);
  }
  if (!any) throw InputError("expected a convex arc in a concave one, found none in '" + system->name + "'");
}

void DuplicateRows(Instance* instance, double share, std::uint64_t seed) {
  Append(instance, Choose(UnilateralRows(instance->problem), share, seed), [](Index, NewRow*) {});
}

void OpposeRows(Instance* instance, double share, std::uint64_t seed) {
  Append(instance, Choose(UnilateralRows(instance->problem), share, seed), [](Index, NewRow* row) {
    for (auto& [column, value] : row->J) value = -value;
    row->b = -row->b;
  });
}

void CrowdContacts(Instance* instance, double share, double distance, std::uint64_t seed) {
  if (!(distance > 0 && std::isfinite(distance))) {
    throw InputError("expected a distance > 0, found " + std::to_string(distance));
  }
  const ContactSystem& system = instance->system;
  const auto constraint_of = [instance, &system](Index i) -> const Constraint& {
    return system.constraints[static_cast<size_t>(instance->rows[static_cast<size_t>(i)].constraint)];
  };
  std::vector<Index> contacts;
  for (const Index i : UnilateralRows(instance->problem)) {
    if (constraint_of(i).type == ConstraintType::kContact) contacts.push_back(i);
  }
  Append(instance, Choose(contacts, share, seed), [&](Index i, NewRow* row) {
    const Constraint& constraint = constraint_of(i);
    const Body& body1 = system.bodies[static_cast<size_t>(constraint.body1)];
    const Body& body2 = system.bodies[static_cast<size_t>(constraint.body2)];
    const bool first = body2.fixed || (!body1.fixed && body1.inertia <= body2.inertia);
    const double shift = distance * GyrationRadius(first ? body1 : body2);
    // p + shift t, t = Perp(n): R x n becomes R x n + shift t x n = R x n - shift.
    const auto add = [row](Index column, double value) {
      for (auto& [at, old] : row->J) {
        if (at == column) {
          old += value;
          return;
        }
      }
      row->J.emplace_back(column, value);
    };
    add(kPerBody * constraint.body1 + 2, -shift);
    add(kPerBody * constraint.body2 + 2, shift);
    row->b -= shift * (FreeSpin(body1) - FreeSpin(body2));
  });
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
  if (!(binades >= 0 && binades <= kMost && binades == std::floor(binades))) {
    throw InputError("expected whole binades from 0 to 100, found " + std::to_string(binades));
  }
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
  if (!(ratio >= 1 && std::isfinite(ratio))) {
    throw InputError("mass ratio must be at least 1 and finite, found " + std::to_string(ratio));
  }
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

}  // namespace lcpbench
