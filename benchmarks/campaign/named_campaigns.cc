#include "benchmarks/campaign/named_campaigns.h"

#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace lcpbench {
namespace {

// A first look, in two minutes on two processors with our solvers, ODE and Bullet: one seed of all families from 2 to
// 160 rows, of some with 400, problems of a few kinds that are meant to break something, and a short motion.
constexpr const char* kQuickProblems =
    "^solve/[a-z-]+-n(2|10|25|64|160)-s1/|"
    "^solve/(disc-pile|tall-stacks|chain-of-links|ovals-in-bowl)-n400-s1/|"
    "^solve/(squeezed-row|barely-squeezed-row|idle-line|fixed-pairs|overpinned-beam)-n40-s1/|"
    "^solve/(tall-stacks-n40-s1-mass-ratio-1e[+]08|disc-track-n40-s1-conformal-1e-06|gear-train-n60-s1-scale-rows-60|"
    "disc-pile-n30-s1-duplicate-rows-1|disc-pile-n30-s1-oppose-rows-0.2|ovals-in-bowl-n60-s1-crowd-contacts-1e-07)/|"
    "^steps/boxes-and-discs-n40-s1-motion/"
    "(?!ipopt|siconos|petsc|tao|cgal|clp|alglib|simbody|drake|pinocchio|[a-z]+-(dual|primal))";

// The better of the default and the tuned settings of each method, and the best codes of each library for these
// problems. Methods that nobody would choose are left to `survey`.
constexpr const char* kCoreSolvers =
    "auto dantzig lemke-tuned semismooth-newton bpp active-set pgs psor nncg apgd ipopt-qp ipopt-ncp ipm hybrid "
    "bullet-dantzig bullet-dantzig-cfm bullet-dantzig-native bullet-si ode-dantzig ode-dantzig-cfm "
    "ode-dantzig-native dart-dantzig-cfm siconos-lexicolemke petsc-rsls-tuned petsc-ssls-direct tao-tron-tuned "
    "clp-default mujoco-newton alglib-quickqp proxqp-primal piqp-dual daqp-primal osqp-dual-tuned "
    "clarabel-dual highs-dual-tuned qpoases-dual-tuned qpalm-primal quadprog-primal pinocchio-pgs daqp-avi";

// Our solvers that take friction, and 24 keys of peers, some for every law and project. Left to `lcpbench run
// --solvers`: Bullet's and DART's copies of ODE's pivoting code, MuJoCo's second method for the same program,
// PETSc's third for the same equations, and what is a worse setting of a code that is here.
constexpr const char* kFrictionSolvers =
    "auto lemke pgs psor relaxation shift mode-newton lagged-bounds "
    "siconos-fc2d-nsgs siconos-fc2d-cpg siconos-fc2d-lemke siconos-fc2d-enum "
    "siconos-lexicolemke-friction siconos-avi-friction petsc-ssls-direct-friction tao-asfls-friction "
    "siconos-fc3d-nsgs siconos-fc3d-nsn-ac siconos-fc3d-admm pinocchio-admm pinocchio-pgs simbody-pgs "
    "bullet-pgs bullet-si dart-pgs ode-dantzig ode-dantzig-loop "
    "mujoco-newton-relaxed daqp-relaxed proxqp-relaxed osqp-relaxed piqp-relaxed";

// Methods on sparse matrices, and matrix-free ones.
constexpr const char* kLargeSolvers =
    "auto hybrid ipm active-set semismooth-newton bpp nncg apgd psor petsc-rsls petsc-ssls-direct tao-tron-default "
    "mujoco-newton osqp-dual clarabel-dual scs-dual alglib-sparse-ipm";

// Own solvers that start from a guess, and those of peers that do, or that engines run.
constexpr const char* kSequenceSolvers =
    "auto dantzig lemke bpp active-set pgs psor nncg ode-dantzig bullet-dantzig bullet-si siconos-pgs mujoco-newton "
    "osqp-dual qpoases-dual";

std::vector<std::string> Words(const char* text) {
  std::istringstream words(text);
  return {std::istream_iterator<std::string>(words), {}};
}

}  // namespace

const std::vector<CampaignPlan>& NamedCampaigns() {
  // Problems of a side in the large classes, where a solve may take its whole limit.
  static const std::map<std::string, int> few_large = {{"101-300", 75}, {"301-1000", 48}, {"1001-1e4", 31}};
  static const std::vector<CampaignPlan> campaigns{
      {.name = "quick",
       .manifests = {"engine", "standard", "pathological", "sequences"},
       .tiers = {1e-6, 1e-9},
       .filter = kQuickProblems,
       .fills = false,
       .launches = {.near = 4, .repeats = 0},
       .rounds = 2,
       .limits = {.most_s = 0.2}},
      // The numbers in README.md and docs/, and comparisons between commits: every class to 10^4 rows, with all
      // problems of the collection and all that fill up its streams, of every origin; of large ones a fair few, and
      // none of the published ones with 10^4 rows, which are in no mean. --external and --variant add solvers.
      {.name = "core",
       .manifests = {"engine", "standard", "recorded", "literature"},
       .solvers = Words(kCoreSolvers),
       .filter = "^solve/(?!(obstacle|torsion|journal-bearing|block-tridiagonal|biggsb1|chen-harker)-n10000-)",
       .most_rows = 10'000,
       .most_of_side = few_large,
       .tuning = {"tuned"}},
      // The same problems by all solvers in all settings, a few times each.
      {.name = "survey",
       .manifests = {"engine", "standard", "recorded", "literature"},
       .filter = "^solve/",
       .most_rows = 10'000,
       .most_of_side = few_large,
       .launches = {.near = 2},
       .tuning = {"tuned"}},
      {.name = "engine", .manifests = {"engine"}},
      {.name = "smoke", .manifests = {"smoke"}},
      {.name = "standard", .manifests = {"engine", "standard"}, .tuning = {"tuned"}},
      // Many solves end at their limits. With all peers it takes eight minutes on two processors.
      {.name = "pathological",
       .manifests = {"pathological"},
       .launches = {.near = 3, .others = 1},
       .limits = {.most_s = 0.2}},
      {.name = "large",
       .manifests = {"large"},
       .solvers = Words(kLargeSolvers),
       .tiers = {1e-6},
       .most_rows = 100'000,
       .launches = {.near = 3, .others = 1, .parts = false}},
      {.name = "recorded", .manifests = {"recorded"}, .filter = "^solve/"},
      {.name = "literature", .manifests = {"literature"}, .most_rows = 10'000},
      {.name = "friction-engine", .manifests = {"friction-engine"}},
      // What `core` is without friction: every law, on problems of every origin.
      {.name = "friction",
       .manifests = {"friction-engine", "friction", "friction-recorded", "friction-literature"},
       .solvers = Words(kFrictionSolvers),
       .filter = "^solve/",
       .most_rows = 10'000,
       .most_of_side = {{"101-300", 75}, {"301-1000", 48}, {"1001-1e4", 40}}},
      {.name = "friction-pathological",
       .manifests = {"friction-pathological"},
       .launches = {.near = 3, .others = 1},
       .limits = {.most_s = 0.2}},
      {.name = "painleve", .manifests = {"painleve"}, .launches = {.near = 3, .others = 1}, .limits = {.most_s = 0.2}},
      {.name = "friction-sequences", .manifests = {"friction-sequences"}, .rounds = 6},
      {.name = "nonsymmetric", .manifests = {"nonsymmetric"}, .launches = {.near = 3}},
      {
          .name = "sequences",
          .manifests = {"sequences", "recorded"},
          .solvers = Words(kSequenceSolvers),
          .tiers = {1e-6},
          .filter = "^steps/",
          .rounds = 1,
          .pass_budget_s = 4,
      },
  };
  return campaigns;
}

}  // namespace lcpbench
