#include "benchmarks/collection/recipes/recipe.h"

#include <algorithm>
#include <boost/algorithm/string/join.hpp>
#include <utility>
#include <variant>

#include "benchmarks/collection/recipes/changes.h"
#include "benchmarks/collection/recipes/hard_cases.h"
#include "benchmarks/collection/recipes/motion_steps.h"
#include "model/scenes/scene.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

// Half of the contacts, for changes whose number is not the share.
constexpr double kCrowdedShare = 0.5;

struct ChangeKind {
  const char* name;
  // Of the system, or else of its rows.
  void (*of_system)(ContactSystem* system, double amount, std::uint64_t seed);
  void (*of_rows)(Instance* instance, double amount, std::uint64_t seed);
};

constexpr ChangeKind kChanges[] = {
    // Radii of convex edges at contacts multiplied by random factors from 1 to 1 / amount.
    {"curvature-contrast", &ContrastCurvature, nullptr},
    // Convex arcs in concave ones with a radius smaller by the share `amount`.
    {"conformal", [](ContactSystem* s, double a, std::uint64_t) { MakeConformal(s, a); }, nullptr},
    // Masses multiplied by random factors from 1 to `amount`.
    {"mass-ratio", nullptr,
     [](Instance* i, double a, std::uint64_t seed) { i->problem = SpreadMasses(i->problem, a, seed); }},
    // The share `amount` of the unilateral rows once more.
    {"duplicate-rows", nullptr, &DuplicateRows},
    // Half of the contacts with a neighbour at `amount` radii of gyration.
    {"crowd-contacts", nullptr,
     [](Instance* i, double a, std::uint64_t seed) { CrowdContacts(i, kCrowdedShare, a, seed); }},
    // `amount` in units of the mean load added to b of every contact.
    {"slack", nullptr, [](Instance* i, double a, std::uint64_t) { AddSlack(i, a); }},
    // Rows multiplied by random powers of two, exponents up to +-amount.
    {"scale-rows", nullptr, &ScaleRows},
    // The share `amount` of the unilateral rows once more with the other sign.
    {"oppose-rows", nullptr, &OpposeRows},
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

Instance MakeInstance(const Recipe& recipe) {
  const std::string id = RecipeId(recipe);
  try {
    if (recipe.motion_step > 0) return MakeMotionStep(recipe);
    ContactSystem system = Generate(recipe);
    // Curvature first, wherever it stands in the list: rows are made from the edges.
    for (const auto& [name, amount] : recipe.changes) {
      if (Find(name).of_system != nullptr) Find(name).of_system(&system, amount, recipe.seed);
    }
    Instance instance = InstanceOf(std::move(system));
    for (const auto& [name, amount] : recipe.changes) {
      if (Find(name).of_rows != nullptr) Find(name).of_rows(&instance, amount, recipe.seed);
    }
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

}  // namespace lcpbench
