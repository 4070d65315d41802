#include "solvers/peers/peer_table.h"

#include <algorithm>
#include <deque>
#include <iterator>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace lcpbench {
namespace {

constexpr PeerProject kBullet{"bullet", "Bullet", "Zlib"};
// The LCP sources of the two engines' Debian packages, compiled here (cmake/packages/sources-peers.txt).
constexpr PeerProject kBulletNative{"bullet-native", "Bullet", "Zlib"};
constexpr PeerProject kOdeNative{"ode-native", "ODE", "LGPL-2.1-or-later OR BSD-3-Clause"};
constexpr PeerProject kOde{"ode", "ODE", "LGPL-2.1-or-later OR BSD-3-Clause"};
// Its Dantzig code is ODE's, with ODE's licence.
constexpr PeerProject kDart{"dart", "DART", "BSD-2-Clause AND (LGPL-2.1-or-later OR BSD-3-Clause)"};
constexpr PeerProject kSiconos{"siconos", "Siconos", "Apache-2.0"};
constexpr PeerProject kPetsc{"petsc", "PETSc", "BSD-2-Clause"};
constexpr PeerProject kCgal{"cgal", "CGAL", "GPL-3.0-or-later"};
constexpr PeerProject kClp{"clp", "Clp", "EPL-1.0"};
constexpr PeerProject kMujoco{"mujoco", "MuJoCo", "Apache-2.0"};
constexpr PeerProject kAlglib{"alglib", "ALGLIB", "GPL-2.0-or-later"};
constexpr PeerProject kSimbody{"simbody", "Simbody", "Apache-2.0"};
// These come from PyPI. The headers of some are in another project's wheel (cmake/packages/requirements-peers.txt).
constexpr PeerProject kOsqp{"osqp", "OSQP", "Apache-2.0"};
constexpr PeerProject kDaqp{"daqp", "DAQP", "MIT"};
constexpr PeerProject kDaqpAvi{"daqp-avi", "DAQP", "MIT", PeerRoute::kPython};
constexpr PeerProject kQpOases{"qpoases", "qpOASES", "LGPL-2.1-or-later"};
constexpr PeerProject kHighs{"highs", "HiGHS", "MIT"};
constexpr PeerProject kProxQp{"proxqp", "ProxQP", "BSD-2-Clause"};
constexpr PeerProject kProxQpBaseline{"proxqp-baseline", "ProxQP", "BSD-2-Clause"};
constexpr PeerProject kPiqp{"piqp", "PIQP", "BSD-2-Clause", PeerRoute::kPython};
constexpr PeerProject kClarabel{"clarabel", "Clarabel", "Apache-2.0", PeerRoute::kPython};
constexpr PeerProject kQpalm{"qpalm", "QPALM", "LGPL-3.0-only", PeerRoute::kPython};
constexpr PeerProject kScs{"scs", "SCS", "MIT", PeerRoute::kPython};
constexpr PeerProject kQuadprog{"quadprog", "quadprog", "GPL-2.0-or-later", PeerRoute::kPython};
constexpr PeerProject kDrake{"drake", "Drake", "BSD-3-Clause", PeerRoute::kPython};
constexpr PeerProject kPinocchio{"pinocchio", "Pinocchio", "BSD-2-Clause", PeerRoute::kPython};

constexpr MethodClass kAny = MethodClass::kAnySize;
constexpr std::string_view kWithCfm = "the same with the diagonal shift that engines use (cfm)";
constexpr std::string_view kForMachine = "the same, compiled as our own solvers are";
constexpr std::string_view kForBaseline = "the same, compiled for any x86-64";
constexpr std::string_view kAsItIs = "the same with the library's own options";

// What tolerances bound.
constexpr std::string_view kSequentialImpulses = "the largest velocity that a sweep corrects, over the largest of b";
constexpr std::string_view kChangeInSweep = "the norm of the change of f in a sweep, over that of b_i / A_ii";
constexpr std::string_view kRelativeChange = "the largest relative change of a force in a sweep";
constexpr std::string_view kNaturalResidual = "the norm of min(f, w), over that of b";
constexpr std::string_view kFrictionResidual =
    "how far w is from that of each contact's own solve, over b; in blocks the natural map, over the largest of f, w, "
    "b";
constexpr std::string_view kNaturalMap = "the natural map of Coulomb's law, over the largest of f, w, b";
constexpr std::string_view kResidualChange = "the change of w in a step, over the norm of w";
constexpr std::string_view kFreeRows = "the norm of w on the free rows, over that at the start";
constexpr std::string_view kFischerBurmeister = "the norm of the Fischer-Burmeister function, over that at the start";
constexpr std::string_view kFischerBurmeisterOverB = "the norm of the Fischer-Burmeister function, over that of b";
constexpr std::string_view kProjectedGradient = "the norm of the projected gradient, over that at the start";
constexpr std::string_view kInfeasibilities = "primal and dual infeasibility, absolute";
constexpr std::string_view kInfeasibilitiesOfHighs = "primal and dual infeasibility, absolute; never below 1e-10";
constexpr std::string_view kFallOfCost = "the fall of the cost in an iteration, as an error of f";
constexpr std::string_view kScaledGradient = "the scaled projected gradient, absolute";
constexpr std::string_view kInfeasibilitiesAndGap = "infeasibilities and duality gap, absolute";
constexpr std::string_view kMeanSquare = "the root mean square of w on the rows with a force";
constexpr std::string_view kEnforcedRows = "the norm of w on the enforced rows";
constexpr std::string_view kLargestResidual = "the largest primal and dual residual, absolute; no duality gap";
constexpr std::string_view kResidualsAndGap = "residuals and duality gap, absolute and relative to their terms";
constexpr std::string_view kRelativeResiduals = "residuals, relative, and the duality gap, absolute or relative";
constexpr std::string_view kResiduals = "residuals, absolute and relative to their terms";
constexpr std::string_view kViolationOnly = "the largest violation of a constraint, absolute";
constexpr std::string_view kViolation =
    "the largest violation of a constraint, absolute; for a singular matrix proximal steps, too";
constexpr std::string_view kFeasibility = "feasibility and complementarity, absolute";

// The values for both builds of ProxQP.
constexpr TierSettings kProxQpDual{{1e-6, 1e-6, 1e-9}, 1e6, kLargestResidual};
constexpr TierSettings kProxQpPrimal{{1e-3, 1e-6, 1e-9}, 1e6, kLargestResidual};

constexpr PeerEntry WithFriction(FrictionLaw law, PeerEntry entry) {
  entry.law = law;
  return entry;
}

// Each key with tiers stands for KEY-default as well, see AllPeers.

constexpr PeerEntry kPeers[] = {
    WithFriction(FrictionLaw::kFrozenBounds, {kBullet, "bullet-dantzig", "Dantzig pivoting of the physics engine"}),
    WithFriction(FrictionLaw::kFrozenBounds, {kBullet, "bullet-dantzig-cfm", kWithCfm}),
    WithFriction(FrictionLaw::kFrozenBounds, {kBulletNative, "bullet-dantzig-native", kForMachine}),
    {kBullet, "bullet-lemke", "Lemke's complementary pivoting"},
    WithFriction(FrictionLaw::kSweptBounds, {kBullet, "bullet-pgs", "projected Gauss-Seidel on the assembled matrix",
                                             TierSettings{{1e-4, 1e-7, 1e-10}, 1e9, kChangeInSweep}}),
    WithFriction(FrictionLaw::kSweptBounds, {kBullet, "bullet-si", "sequential impulses",
                                             TierSettings{{1e-3, 1e-6, 1e-9}, 1e9, kSequentialImpulses}, kAny}),
    WithFriction(FrictionLaw::kSweptBounds, {kBullet, "bullet-si-4", "sequential impulses, 4 sweeps", {}, kAny, true}),
    WithFriction(FrictionLaw::kSweptBounds,
                 {kBullet, "bullet-si-10", "sequential impulses, the engine's own 10 sweeps", {}, kAny, true}),
    WithFriction(FrictionLaw::kSweptBounds,
                 {kBullet, "bullet-si-50", "sequential impulses, 50 sweeps", {}, kAny, true}),
    WithFriction(FrictionLaw::kSweptBounds,
                 {kBullet, "bullet-si-1000", "sequential impulses, 1000 sweeps", {}, kAny, true}),
    WithFriction(FrictionLaw::kFrozenBounds,
                 {kOde, "ode-dantzig", "Dantzig pivoting of the physics engine, LDL^T updated"}),
    WithFriction(FrictionLaw::kFrozenBounds, {kOde, "ode-dantzig-cfm", kWithCfm}),
    WithFriction(FrictionLaw::kFrozenBounds, {kOdeNative, "ode-dantzig-native", kForMachine}),
    WithFriction(FrictionLaw::kFrozenBounds, {kDart, "dart-dantzig", "Dantzig pivoting, after ODE's"}),
    WithFriction(FrictionLaw::kFrozenBounds, {kDart, "dart-dantzig-cfm", kWithCfm}),
    WithFriction(FrictionLaw::kSweptBounds,
                 {kDart, "dart-pgs", "projected Gauss-Seidel", TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kRelativeChange}}),
    {kSiconos, "siconos-lexicolemke", "lexicographic Lemke pivoting"},
    {kSiconos, "siconos-newton-fb", "semismooth Newton on the Fischer-Burmeister function",
     TierSettings{{1e-5, 1e-8, 1e-10}, 1e6, kNaturalResidual}},
    {kSiconos, "siconos-pgs", "projected Gauss-Seidel", TierSettings{{1e-4, 1e-7, 1e-10}, 1e9, kNaturalResidual}},
    {kSiconos, "siconos-nsgs-sbm", "block Gauss-Seidel on a sparse block matrix",
     TierSettings{{1e-4, 1e-7, 1e-10}, 1e9, kNaturalResidual}, kAny},
    {kSiconos, "siconos-avi", "pivoting on the affine variational inequality (Cao, Ferris)"},
    {kSiconos, "siconos-pivot", "Lemke pivoting"},
    {kSiconos, "siconos-pathsearch", "pivoting along PATH's piecewise linear path"},
    {kSiconos, "siconos-newton-min", "Newton on min(f, w) without line search",
     TierSettings{{1e-5, 1e-6, 1e-9}, 1e6, kNaturalResidual}},
    {kSiconos, "siconos-cpg", "conjugate projected gradients",
     TierSettings{{1e-4, 1e-7, 1e-10}, 1e9, kNaturalResidual}},
    {kSiconos, "siconos-convexqp-pg", "projected gradients on the QP",
     TierSettings{{1e-4, 1e-7, 1e-10}, 1e9, kNaturalResidual}},
    WithFriction(FrictionLaw::kCoulomb,
                 {kSiconos, "siconos-fc2d-nsgs", "friction in the plane, Gauss-Seidel by contacts",
                  TierSettings{{1e-4, 1e-7, 1e-10}, 1e9, kFrictionResidual}, kAny}),
    WithFriction(FrictionLaw::kCoulomb,
                 {kSiconos, "siconos-fc2d-cpg", "friction in the plane, conjugate projected gradients",
                  TierSettings{{1e-5, 1e-7, 1e-10}, 1e9, kResidualChange}}),
    WithFriction(FrictionLaw::kCoulomb,
                 {kSiconos, "siconos-fc2d-lemke", "friction in the plane, Lemke on three rows a contact"}),
    WithFriction(FrictionLaw::kCoulomb,
                 {kSiconos, "siconos-fc2d-enum", "friction in the plane, all sets of three rows a contact in turn"}),
    WithFriction(FrictionLaw::kSpatial, {kSiconos, "siconos-fc3d-nsgs", "friction in space, Gauss-Seidel by contacts",
                                         TierSettings{{1e-4, 1e-7, 1e-10}, 1e9, kNaturalMap}, kAny}),
    WithFriction(FrictionLaw::kSpatial,
                 {kSiconos, "siconos-fc3d-nsn-ac", "friction in space, semismooth Newton of Alart and Curnier",
                  TierSettings{{1e-4, 1e-7, 1e-10}, 1e6, kNaturalMap}, kAny}),
    WithFriction(FrictionLaw::kSpatial, {kSiconos, "siconos-fc3d-admm", "friction in space, ADMM",
                                         TierSettings{{1e-4, 1e-8, 1e-10}, 1e9, kNaturalMap}, kAny}),
    {kPetsc, "petsc-rsls", "SNES reduced-space active-set Newton with line search",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kFreeRows}, kAny},
    {kPetsc, "petsc-rsls-direct", "the same with LU and a shift of pivots that are too small",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kFreeRows}, kAny},
    {kPetsc, "petsc-ssls", "SNES semismooth Newton with line search",
     TierSettings{{1e-6, 1e-8, 1e-11}, 1e6, kFischerBurmeister}, kAny},
    {kPetsc, "petsc-ssls-direct", "the same with LU and a shift of pivots that are too small",
     TierSettings{{1e-5, 1e-7, 1e-11}, 1e6, kFischerBurmeister}, kAny},
    {kPetsc, "tao-bntr", "TAO bounded Newton trust region on the QP",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kProjectedGradient}, kAny},
    {kPetsc, "tao-tron", "TAO trust-region Newton (TRON) on the QP",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kProjectedGradient}, kAny},
    {kPetsc, "tao-asfls", "TAO semismooth Newton, active set, feasible, LU with a shift of small pivots",
     TierSettings{{1e-4, 1e-7, 1e-10}, 1e6, kFischerBurmeisterOverB}, kAny},
    {kCgal, "cgal-qp", "exact rational QP simplex: a reference for small n", {}, MethodClass::kExactArithmetic},
    {kClp, "clp", "COIN-OR simplex code with its QP extension", TierSettings{{1e-3, 1e-6, 1e-9}, 0, kInfeasibilities},
     kAny},
    {kMujoco, "mujoco-newton", "Newton in accelerations, exact line search, R/A = 1e-12",
     TierSettings{{1e-3, 1e-10, 1e-10}, 1e9, kFallOfCost}},
    {kMujoco, "mujoco-cg", "nonlinear conjugate gradients in accelerations, R/A = 1e-12",
     TierSettings{{1e-4, 1e-6, 1e-9}, 1e9, kFallOfCost}},
    {kMujoco, "mujoco-pgs", "projected Gauss-Seidel, R/A = 1e-12", TierSettings{{1e-5, 1e-8, 1e-11}, 1e9, kFallOfCost}},
    {kAlglib, "alglib-quickqp", "constrained conjugate gradients and Newton steps on the QP (QuickQP)",
     TierSettings{{1e-3, 1e-6, 1e-9}, 0, kScaledGradient}},
    {kAlglib, "alglib-dense-ipm", "interior point on the QP, dense",
     TierSettings{{1e-7, 1e-10, 1e-13}, 0, kInfeasibilitiesAndGap}},
    {kAlglib, "alglib-sparse-ipm", "interior point on the QP, sparse",
     TierSettings{{1e-7, 1e-10, 1e-13}, 0, kInfeasibilitiesAndGap}, kAny},
    {kAlglib, "alglib-bleic", "active set with L-BFGS on the QP (BLEIC)",
     TierSettings{{1e-3, 1e-6, 1e-9}, 0, kScaledGradient}},
    WithFriction(FrictionLaw::kSpatial, {kSimbody, "simbody-pgs", "projected Gauss-Seidel, overrelaxed",
                                         TierSettings{{1e-4, 1e-7, 1e-10}, 1e9, kMeanSquare}}),
    WithFriction(FrictionLaw::kSpatial, {kSimbody, "simbody-plus", "successive pruning of the active set",
                                         TierSettings{{1e-3, 1e-6, 1e-9}, 20, kEnforcedRows}}),
    {kProxQp, "proxqp-dual", "proximal augmented Lagrangian; QP in forces", kProxQpDual},
    {kProxQp, "proxqp-primal", "proximal augmented Lagrangian; QP in velocities", kProxQpPrimal},
    {kProxQpBaseline, "proxqp-dual-baseline", kForBaseline, kProxQpDual},
    {kProxQpBaseline, "proxqp-primal-baseline", kForBaseline, kProxQpPrimal},
    {kPiqp, "piqp-dual", "proximal interior point; QP in forces",
     TierSettings{{1e-7, 1e-10, 1e-13}, 1e6, kResidualsAndGap}, kAny},
    {kPiqp, "piqp-primal", "proximal interior point; QP in velocities",
     TierSettings{{1e-7, 1e-10, 1e-13}, 1e6, kResidualsAndGap}, kAny},
    {kDaqp, "daqp-dual", "dual active set; QP in forces", TierSettings{{1e-4, 1e-6, 1e-9}, 1e6, kViolation}},
    {kDaqp, "daqp-primal", "dual active set; QP in velocities", TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kViolation}},
    {kDaqpAvi, "daqp-avi", "affine variational inequality by dual active sets; A need not be symmetric",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kViolationOnly}},
    {kOsqp, "osqp-dual", "operator splitting (ADMM); QP in forces",
     TierSettings{{1e-3, 1e-7, 1e-10}, 1e6, kResidualsAndGap}, kAny},
    {kOsqp, "osqp-primal", "operator splitting (ADMM); QP in velocities",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kResidualsAndGap}, kAny},
    {kClarabel, "clarabel-dual", "homogeneous interior point; QP in forces",
     TierSettings{{1e-6, 1e-10, 1e-11}, 1e6, kRelativeResiduals}, kAny},
    {kClarabel, "clarabel-primal", "homogeneous interior point; QP in velocities",
     TierSettings{{1e-7, 1e-10, 1e-12}, 1e6, kRelativeResiduals}, kAny},
    {kHighs, "highs-dual", "active set or interior point; QP in forces",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kInfeasibilitiesOfHighs}, kAny},
    {kHighs, "highs-primal", "active set or interior point; QP in velocities",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kInfeasibilitiesOfHighs}, kAny},
    {kQpOases, "qpoases-dual", "online active set; QP in forces"},
    {kQpOases, "qpoases-primal", "online active set; QP in velocities"},
    {kQpalm, "qpalm-dual", "proximal augmented Lagrangian; QP in forces",
     TierSettings{{1e-3, 1e-6, 1e-10}, 1e6, kResiduals}, kAny},
    {kQpalm, "qpalm-primal", "proximal augmented Lagrangian; QP in velocities",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kResiduals}, kAny},
    {kScs, "scs-dual", "operator splitting on an embedding; QP in forces",
     TierSettings{{1e-3, 1e-7, 1e-9}, 1e6, kResidualsAndGap}, kAny},
    {kScs, "scs-primal", "operator splitting on an embedding; QP in velocities",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6, kResidualsAndGap}, kAny},
    {kQuadprog, "quadprog-dual", "dual active set (Goldfarb, Idnani); QP in forces"},
    {kQuadprog, "quadprog-primal", "dual active set (Goldfarb, Idnani); QP in velocities"},
    {kDrake, "drake-moby", "Lemke's method with growing shifts (MobyLcpSolver)"},
    WithFriction(FrictionLaw::kSpatial, {kPinocchio, "pinocchio-admm", "ADMM of its contact solvers",
                                         TierSettings{{1e-4, 1e-7, 1e-10}, 2e4, kFeasibility}}),
    WithFriction(FrictionLaw::kSpatial, {kPinocchio, "pinocchio-pgs", "projected Gauss-Seidel of its contact solvers",
                                         TierSettings{{1e-4, 1e-7, 1e-10}, 1e6, kFeasibility}}),
};

// Keys with tiers that have no KEY-default: the library's own options are those of another key.
constexpr std::string_view kTunedOnly[] = {
    "bullet-si",         "bullet-pgs",           "siconos-nsgs-sbm",      "petsc-rsls-direct",
    "petsc-ssls-direct", "proxqp-dual-baseline", "proxqp-primal-baseline"};

// Solvers that know no friction, with a transformation: all else is as of `within`, its tolerances, too.
struct TransformedPeer {
  std::string_view key, within;
  Transformation transformation;
};
constexpr TransformedPeer kTransformed[] = {
    {"siconos-lexicolemke-friction", "siconos-lexicolemke", Transformation::kFourRows},
    {"siconos-avi-friction", "siconos-avi", Transformation::kFourRows},
    {"petsc-rsls-direct-friction", "petsc-rsls-direct", Transformation::kFourRows},
    {"petsc-ssls-direct-friction", "petsc-ssls-direct", Transformation::kFourRows},
    {"tao-asfls-friction", "tao-asfls", Transformation::kFourRows},
    {"ode-dantzig-loop", "ode-dantzig", Transformation::kLaggedBounds},
    {"bullet-dantzig-loop", "bullet-dantzig", Transformation::kLaggedBounds},
    {"dart-dantzig-loop", "dart-dantzig", Transformation::kLaggedBounds},
    {"mujoco-newton-relaxed", "mujoco-newton", Transformation::kRelaxation},
    {"mujoco-cg-relaxed", "mujoco-cg", Transformation::kRelaxation},
    {"proxqp-relaxed", "proxqp-dual", Transformation::kRelaxation},
    {"piqp-relaxed", "piqp-dual", Transformation::kRelaxation},
    {"daqp-relaxed", "daqp-primal", Transformation::kRelaxation},
    {"osqp-relaxed", "osqp-primal", Transformation::kRelaxation},
};

constexpr LeftOutSolver kLeftOut[] = {
    {"PATH", "closed; free for up to 300 variables, beyond that under a licence"},
    {"MOSEK", "closed, under a licence"},
    {"Gurobi", "closed, under a licence"},
    {"PhysX", "a library of worlds: its solvers take bodies and contacts, and no J, M and b"},
    {"Jolt", "a library of worlds: its solvers take bodies and contacts, and no J, M and b"},
    {"Box2D 3", "a library of worlds: its solver takes bodies and contacts, and no J, M and b"},
    {"Rapier", "a library of worlds: its solvers take bodies and contacts, and no J, M and b"},
};

constexpr std::array kTableTiers{1e-3, 1e-6, 1e-9};
// A requested 1e-6 may arrive with the last digit off.
constexpr double kSlack = 1 + 1e-9;

// What is said of a transformation, and the law that its answers obey.
std::pair<std::string_view, FrictionLaw> FactsOf(Transformation transformation) {
  if (transformation == Transformation::kRelaxation) return {" on the relaxed law", FrictionLaw::kRelaxation};
  const bool is_by_rows = transformation == Transformation::kFourRows;
  return {is_by_rows ? " on four rows a contact" : " on bounds that are set until they settle", FrictionLaw::kCoulomb};
}

PeerEntry EntryOf(const TransformedPeer& transformed) {
  static std::deque<std::string> methods;  // whose places do not change
  const auto [how, law] = FactsOf(transformed.transformation);
  PeerEntry entry = *std::ranges::find(kPeers, transformed.within, &PeerEntry::key);
  entry.key = transformed.key;
  entry.method = methods.emplace_back(std::string(transformed.within) += how);
  entry.law = law;
  entry.transformation = transformed.transformation;
  entry.within = transformed.within;
  return entry;
}

std::vector<PeerEntry> WithDefaults() {
  static std::deque<std::string> keys;  // whose places do not change
  std::vector<PeerEntry> all;
  for (const PeerEntry& peer : kPeers) {
    all.push_back(peer);
    if (!peer.tiers || std::ranges::find(kTunedOnly, peer.key) != std::end(kTunedOnly)) continue;
    keys.push_back(std::string(peer.key) + "-default");
    all.push_back({peer.project, keys.back(), kAsItIs, std::nullopt, peer.method_class, false, peer.law});
  }
  std::ranges::transform(kTransformed, std::back_inserter(all), EntryOf);
  return all;
}

const TierSettings& TiersOf(std::string_view key) {
  const auto* peer = std::find_if(std::begin(kPeers), std::end(kPeers), [key](const auto& p) { return p.key == key; });
  if (peer == std::end(kPeers) || !peer->tiers) throw std::logic_error("no tier settings for " + std::string(key));
  return *peer->tiers;
}

}  // namespace

std::string_view ToString(FrictionLaw law) {
  // In the order of FrictionLaw.
  constexpr std::array<std::string_view, 6> kLaws = {
      "", "Coulomb", "Coulomb, in space", "swept bounds", "frozen bounds", "relaxed"};
  return kLaws.at(static_cast<std::size_t>(law));
}

std::span<const PeerEntry> AllPeers() {
  static const std::vector<PeerEntry> peers = WithDefaults();
  return peers;
}

std::span<const LeftOutSolver> SolversLeftOut() { return kLeftOut; }

double TierTolerance(std::string_view key, double tolerance) {
  std::size_t tier = 0;
  while (tier + 1 < kTableTiers.size() && kTableTiers[tier] > tolerance * kSlack) ++tier;
  return TiersOf(key).tolerances[tier];
}

double TierIterations(std::string_view key) { return TiersOf(key).most_iterations; }

}  // namespace lcpbench
