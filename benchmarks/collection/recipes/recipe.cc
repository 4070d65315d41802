#include "benchmarks/collection/recipes/recipe.h"

#include <algorithm>
#include <utility>
#include <variant>

#include "benchmarks/collection/recipes/changes.h"
#include "benchmarks/collection/recipes/hard_cases.h"
#include "benchmarks/collection/recipes/motion_steps.h"
#include "model/geometry/overloaded.h"
#include "model/scenes/scene.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

using SystemChange = void (*)(ContactSystem* system, double amount, std::uint64_t seed);
using RowChange = void (*)(Instance* instance, double amount, std::uint64_t seed);

// Half of the contacts, for changes whose number is not the share.
constexpr double kCrowdedShare = 0.5;

struct Entry {
  ChangeKind kind;
  std::variant<SystemChange, RowChange> apply;
};

const Entry kChanges[] = {
    {{"curvature-contrast", "radii of convex edges at contacts multiplied by random factors from 1 to 1 / amount"},
     SystemChange{[](ContactSystem* s, double a, std::uint64_t seed) { ContrastCurvature(s, a, seed); }}},
    {{"conformal", "convex arcs in concave ones with a radius smaller by the share `amount`"},
     SystemChange{[](ContactSystem* s, double a, std::uint64_t) { MakeConformal(s, a); }}},
    {{"mass-ratio", "masses multiplied by random factors from 1 to `amount`"},
     RowChange{[](Instance* i, double a, std::uint64_t seed) { i->problem = SpreadMasses(i->problem, a, seed); }}},
    {{"duplicate-rows", "the share `amount` of the unilateral rows once more"}, RowChange{&DuplicateRows}},
    {{"crowd-contacts", "half of the contacts with a neighbour at `amount` radii of gyration"},
     RowChange{[](Instance* i, double a, std::uint64_t seed) { CrowdContacts(i, kCrowdedShare, a, seed); }}},
    {{"slack", "`amount` in units of the mean load added to b of every contact"},
     RowChange{[](Instance* i, double a, std::uint64_t) { AddSlack(i, a); }}},
    {{"scale-rows", "rows multiplied by random powers of two, exponents up to +-amount"}, RowChange{&ScaleRows}},
    {{"oppose-rows", "the share `amount` of the unilateral rows once more with the other sign"},
     RowChange{&OpposeRows}},
};

const Entry& Find(const std::string& name) {
  std::string known;
  for (const Entry& entry : kChanges) {
    if (name == entry.kind.name) return entry;
    known += (known.empty() ? "" : ", ") + std::string(entry.kind.name);
  }
  throw InputError("unknown change '" + name + "', expected one of " + known);
}

ContactSystem Generate(const Recipe& recipe) {
  if (recipe.rows < 1) throw InputError("expected rows >= 1, found " + std::to_string(recipe.rows));
  for (const HardCase& hard : AllHardCases()) {
    if (hard.key == recipe.scene) return hard.generate(recipe.rows, recipe.seed);
  }
  return GenerateScene(recipe.scene, recipe.rows, recipe.seed);
}

std::string KindOf(const Feature& feature) {
  const auto curved = [](Side side, const char* name) {
    return (side == Side::kConcave ? "concave " : "") + std::string(name);
  };
  return std::visit(Overloaded{[](const Vertex&) { return std::string("vertex"); },
                               [](const StraightEdge&) { return std::string("straight"); },
                               [&](const ArcEdge& edge) { return curved(edge.side, "arc"); },
                               [&](const EllipseEdge& edge) { return curved(edge.side, "ellipse"); },
                               [&](const SuperellipseEdge& edge) { return curved(edge.side, "superellipse"); },
                               [](const BezierEdge&) { return std::string("bezier"); }},
                    feature);
}

}  // namespace

const std::vector<ChangeKind>& AllChanges() {
  static const std::vector<ChangeKind> kinds = [] {
    std::vector<ChangeKind> all;
    for (const Entry& entry : kChanges) all.push_back(entry.kind);
    return all;
  }();
  return kinds;
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

Instance MakeInstance(const Recipe& recipe) {
  const std::string id = RecipeId(recipe);
  try {
    if (recipe.motion_step > 0) return MakeMotionStep(recipe);
    ContactSystem system = Generate(recipe);
    // Curvature first, wherever it stands in the list: rows are made from the edges.
    for (const Change& change : recipe.changes) {
      if (const auto* apply = std::get_if<SystemChange>(&Find(change.name).apply)) {
        (*apply)(&system, change.amount, recipe.seed);
      }
    }
    Instance instance = InstanceOf(std::move(system));
    for (const Change& change : recipe.changes) {
      if (const auto* apply = std::get_if<RowChange>(&Find(change.name).apply)) {
        (*apply)(&instance, change.amount, recipe.seed);
      }
    }
    instance.problem = WithId(instance.problem, id);
    return instance;
  } catch (const InputError& error) {
    throw InputError(id + ": " + error.what());
  }
}

std::map<std::string, int> CountKinds(const ContactSystem& system) {
  std::map<std::string, int> counts;
  for (const Constraint& constraint : system.constraints) {
    switch (constraint.type) {
      case ConstraintType::kContact: {
        std::string first = KindOf(constraint.feature1);
        std::string second = KindOf(constraint.feature2);
        if (second < first) std::swap(first, second);
        ++counts[first + " on " + second];
        break;
      }
      case ConstraintType::kPathJoint:
        ++counts["path joint"];
        break;
      case ConstraintType::kPin:
        ++counts["pin"];
        break;
      case ConstraintType::kRod:
        ++counts["rod"];
        break;
      case ConstraintType::kRope:
        ++counts["rope"];
        break;
    }
  }
  return counts;
}

}  // namespace lcpbench
