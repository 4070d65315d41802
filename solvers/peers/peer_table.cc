#include "solvers/peers/peer_table.h"

#include <algorithm>
#include <stdexcept>
#include <string>

namespace lcpbench {
namespace {

constexpr PeerProject kBullet{"bullet", "Bullet", "Zlib"};
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
// Of PyPI. The headers of some are in another project's wheel (requirements-peers.txt).
constexpr PeerProject kOsqp{"osqp", "OSQP", "Apache-2.0"};
constexpr PeerProject kDaqp{"daqp", "DAQP", "MIT"};
constexpr PeerProject kQpOases{"qpoases", "qpOASES", "LGPL-2.1-or-later"};
constexpr PeerProject kHighs{"highs", "HiGHS", "MIT"};
constexpr PeerProject kProxQp{"proxqp", "ProxQP", "BSD-2-Clause"};
constexpr PeerProject kProxQpBaseline{"proxqp-baseline", "ProxQP", "BSD-2-Clause"};
constexpr PeerProject kPiqp{"piqp", "PIQP", "BSD-2-Clause"};
constexpr PeerProject kClarabel{"clarabel", "Clarabel", "Apache-2.0"};
constexpr PeerProject kQpalm{"qpalm", "QPALM", "LGPL-3.0-only"};
constexpr PeerProject kScs{"scs", "SCS", "MIT"};
constexpr PeerProject kQuadprog{"quadprog", "quadprog", "GPL-2.0-or-later"};
constexpr PeerProject kDrake{"drake", "Drake", "BSD-3-Clause"};
constexpr PeerProject kPinocchio{"pinocchio", "Pinocchio", "BSD-2-Clause"};

constexpr MethodClass kAny = MethodClass::kAnySize;
constexpr std::string_view kWithCfm = "the same with the diagonal shift that engines use (cfm)";
constexpr std::string_view kForBaseline = "the same, compiled for any x86-64";
constexpr std::string_view kAsItIs = "the same with the library's own options";

// Tolerances bound: of bullet-si the largest velocity that a sweep corrects, relative to the largest of b; of DART the
// largest relative change of a force in one sweep; of Siconos ||min(f, w)|| over ||b||; of petsc-rsls the norm of w on
// the free rows and of petsc-ssls that of the Fischer-Burmeister function, of TAO the projected gradient, all relative
// to the start; of Clp and HiGHS both primal and dual infeasibility; of ProxQP the largest residual of the program; of
// DAQP the violation of a bound; of PIQP, OSQP, Clarabel, QPALM and SCS residuals and gap, absolute and relative; of
// Pinocchio feasibility and complementarity. With b scaled to about 1: of MuJoCo the error of f that the fall of its
// cost in an iteration stands for; of ALGLIB the scaled projected gradient (QuickQP, BLEIC) or infeasibilities and gap
// (interior point); of Simbody the norm of w on the enforced rows.
constexpr PeerEntry kPeers[] = {
    {kBullet, "bullet-dantzig", "Dantzig pivoting of the physics engine"},
    {kBullet, "bullet-dantzig-cfm", kWithCfm},
    {kBullet, "bullet-lemke", "Lemke's complementary pivoting"},
    {kBullet, "bullet-si", "sequential impulses", TierSettings{{1e-3, 1e-6, 1e-9}, 1e9}, kAny},
    {kBullet, "bullet-si-4", "sequential impulses, 4 sweeps", {}, kAny, true},
    {kBullet, "bullet-si-10", "sequential impulses, the engine's own 10 sweeps", {}, kAny, true},
    {kBullet, "bullet-si-50", "sequential impulses, 50 sweeps", {}, kAny, true},
    {kBullet, "bullet-si-1000", "sequential impulses, 1000 sweeps", {}, kAny, true},
    {kOde, "ode-dantzig", "Dantzig pivoting of the physics engine, LDL^T updated"},
    {kOde, "ode-dantzig-cfm", kWithCfm},
    {kDart, "dart-dantzig", "Dantzig pivoting, after ODE's"},
    {kDart, "dart-dantzig-cfm", kWithCfm},
    {kDart, "dart-pgs", "projected Gauss-Seidel", TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}},
    {kDart, "dart-pgs-default", kAsItIs},
    {kSiconos, "siconos-lexicolemke", "lexicographic Lemke pivoting"},
    {kSiconos, "siconos-newton-fb", "semismooth Newton on the Fischer-Burmeister function",
     TierSettings{{1e-5, 1e-8, 1e-10}, 1e6}},
    {kSiconos, "siconos-newton-fb-default", kAsItIs},
    {kSiconos, "siconos-pgs", "projected Gauss-Seidel", TierSettings{{1e-4, 1e-7, 1e-10}, 1e9}},
    {kSiconos, "siconos-pgs-default", kAsItIs},
    {kSiconos, "siconos-nsgs-sbm", "block Gauss-Seidel on a sparse block matrix",
     TierSettings{{1e-4, 1e-7, 1e-10}, 1e9}, kAny},
    {kSiconos, "siconos-avi", "pivoting on the affine variational inequality (Cao, Ferris)"},
    {kSiconos, "siconos-pivot", "Lemke pivoting"},
    {kSiconos, "siconos-pathsearch", "pivoting along PATH's piecewise linear path"},
    {kSiconos, "siconos-newton-min", "Newton on min(f, w) without line search", TierSettings{{1e-5, 1e-6, 1e-9}, 1e6}},
    {kSiconos, "siconos-newton-min-default", kAsItIs},
    {kSiconos, "siconos-cpg", "conjugate projected gradients", TierSettings{{1e-4, 1e-7, 1e-10}, 1e9}},
    {kSiconos, "siconos-cpg-default", kAsItIs},
    {kSiconos, "siconos-convexqp-pg", "projected gradients on the QP", TierSettings{{1e-4, 1e-7, 1e-10}, 1e9}},
    {kSiconos, "siconos-convexqp-pg-default", kAsItIs},
    {kPetsc, "petsc-rsls", "SNES reduced-space active-set Newton with line search",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}, kAny},
    {kPetsc, "petsc-rsls-default", kAsItIs, {}, kAny},
    {kPetsc, "petsc-rsls-direct", "the same with LU and a shift of pivots that are too small",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}, kAny},
    {kPetsc, "petsc-ssls", "SNES semismooth Newton with line search", TierSettings{{1e-6, 1e-8, 1e-11}, 1e6}, kAny},
    {kPetsc, "petsc-ssls-default", kAsItIs, {}, kAny},
    {kPetsc, "petsc-ssls-direct", "the same with LU and a shift of pivots that are too small",
     TierSettings{{1e-5, 1e-7, 1e-11}, 1e6}, kAny},
    {kPetsc, "tao-bntr", "TAO bounded Newton trust region on the QP", TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}, kAny},
    {kPetsc, "tao-bntr-default", kAsItIs, {}, kAny},
    {kPetsc, "tao-tron", "TAO trust-region Newton (TRON) on the QP", TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}, kAny},
    {kPetsc, "tao-tron-default", kAsItIs, {}, kAny},
    {kCgal, "cgal-qp", "exact rational QP simplex: a reference for small n", {}, MethodClass::kExactArithmetic},
    {kClp, "clp", "COIN-OR simplex code with its QP extension", TierSettings{{1e-3, 1e-6, 1e-9}, 0}, kAny},
    {kClp, "clp-default", kAsItIs, {}, kAny},
    {kMujoco, "mujoco-newton", "Newton in accelerations, exact line search, R/A = 1e-12",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e9}},
    {kMujoco, "mujoco-newton-default", kAsItIs},
    {kMujoco, "mujoco-cg", "nonlinear conjugate gradients in accelerations, R/A = 1e-12",
     TierSettings{{1e-4, 1e-6, 1e-9}, 1e9}},
    {kMujoco, "mujoco-cg-default", kAsItIs},
    {kMujoco, "mujoco-pgs", "projected Gauss-Seidel, R/A = 1e-12", TierSettings{{1e-5, 1e-8, 1e-11}, 1e9}},
    {kMujoco, "mujoco-pgs-default", kAsItIs},
    {kAlglib, "alglib-quickqp", "constrained conjugate gradients and Newton steps on the QP (QuickQP)",
     TierSettings{{1e-3, 1e-6, 1e-9}, 0}},
    {kAlglib, "alglib-quickqp-default", kAsItIs},
    {kAlglib, "alglib-dense-ipm", "interior point on the QP, dense", TierSettings{{1e-7, 1e-10, 1e-13}, 0}},
    {kAlglib, "alglib-dense-ipm-default", kAsItIs},
    {kAlglib, "alglib-sparse-ipm", "interior point on the QP, sparse", TierSettings{{1e-7, 1e-10, 1e-13}, 0}, kAny},
    {kAlglib, "alglib-sparse-ipm-default", kAsItIs, {}, kAny},
    {kAlglib, "alglib-bleic", "active set with L-BFGS on the QP (BLEIC)", TierSettings{{1e-3, 1e-6, 1e-9}, 0}},
    {kAlglib, "alglib-bleic-default", kAsItIs},
    {kSimbody, "simbody-pgs", "projected Gauss-Seidel, overrelaxed", TierSettings{{1e-4, 1e-7, 1e-10}, 1e9}},
    {kSimbody, "simbody-pgs-default", kAsItIs},
    {kSimbody, "simbody-plus", "successive pruning of the active set", TierSettings{{1e-3, 1e-6, 1e-9}, 20}},
    {kSimbody, "simbody-plus-default", kAsItIs},
    {kProxQp, "proxqp-dual", "proximal augmented Lagrangian; QP in forces", TierSettings{{1e-6, 1e-6, 1e-9}, 1e6}},
    {kProxQp, "proxqp-dual-default", kAsItIs},
    {kProxQp, "proxqp-primal", "proximal augmented Lagrangian; QP in velocities",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}},
    {kProxQp, "proxqp-primal-default", kAsItIs},
    {kProxQpBaseline, "proxqp-dual-baseline", kForBaseline, TierSettings{{1e-6, 1e-6, 1e-9}, 1e6}},
    {kProxQpBaseline, "proxqp-primal-baseline", kForBaseline, TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}},
    {kPiqp, "piqp-dual", "proximal interior point; QP in forces; Python worker",
     TierSettings{{1e-7, 1e-10, 1e-13}, 1e6}, kAny},
    {kPiqp, "piqp-dual-default", kAsItIs, {}, kAny},
    {kPiqp, "piqp-primal", "proximal interior point; QP in velocities; Python worker",
     TierSettings{{1e-7, 1e-10, 1e-13}, 1e6}, kAny},
    {kPiqp, "piqp-primal-default", kAsItIs, {}, kAny},
    {kDaqp, "daqp-dual", "dual active set; QP in forces", TierSettings{{1e-4, 1e-6, 1e-9}, 1e6}},
    {kDaqp, "daqp-dual-default", kAsItIs},
    {kDaqp, "daqp-primal", "dual active set; QP in velocities", TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}},
    {kDaqp, "daqp-primal-default", kAsItIs},
    {kOsqp, "osqp-dual", "operator splitting (ADMM); QP in forces", TierSettings{{1e-3, 1e-7, 1e-10}, 1e6}, kAny},
    {kOsqp, "osqp-dual-default", kAsItIs, {}, kAny},
    {kOsqp, "osqp-primal", "operator splitting (ADMM); QP in velocities", TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}, kAny},
    {kOsqp, "osqp-primal-default", kAsItIs, {}, kAny},
    {kClarabel, "clarabel-dual", "homogeneous interior point; QP in forces; Python worker",
     TierSettings{{1e-6, 1e-10, 1e-11}, 1e6}, kAny},
    {kClarabel, "clarabel-dual-default", kAsItIs, {}, kAny},
    {kClarabel, "clarabel-primal", "homogeneous interior point; QP in velocities; Python worker",
     TierSettings{{1e-7, 1e-10, 1e-12}, 1e6}, kAny},
    {kClarabel, "clarabel-primal-default", kAsItIs, {}, kAny},
    {kHighs, "highs-dual", "active set or interior point; QP in forces", TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}, kAny},
    {kHighs, "highs-dual-default", kAsItIs, {}, kAny},
    {kHighs, "highs-primal", "active set or interior point; QP in velocities", TierSettings{{1e-3, 1e-6, 1e-9}, 1e6},
     kAny},
    {kHighs, "highs-primal-default", kAsItIs, {}, kAny},
    {kQpOases, "qpoases-dual", "online active set; QP in forces"},
    {kQpOases, "qpoases-primal", "online active set; QP in velocities"},
    {kQpalm, "qpalm-dual", "proximal augmented Lagrangian; QP in forces; Python worker",
     TierSettings{{1e-3, 1e-6, 1e-10}, 1e6}, kAny},
    {kQpalm, "qpalm-dual-default", kAsItIs, {}, kAny},
    {kQpalm, "qpalm-primal", "proximal augmented Lagrangian; QP in velocities; Python worker",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}, kAny},
    {kQpalm, "qpalm-primal-default", kAsItIs, {}, kAny},
    {kScs, "scs-dual", "operator splitting on an embedding; QP in forces; Python worker",
     TierSettings{{1e-3, 1e-7, 1e-9}, 1e6}, kAny},
    {kScs, "scs-dual-default", kAsItIs, {}, kAny},
    {kScs, "scs-primal", "operator splitting on an embedding; QP in velocities; Python worker",
     TierSettings{{1e-3, 1e-6, 1e-9}, 1e6}, kAny},
    {kScs, "scs-primal-default", kAsItIs, {}, kAny},
    {kQuadprog, "quadprog-dual", "dual active set (Goldfarb, Idnani); QP in forces; Python worker"},
    {kQuadprog, "quadprog-primal", "dual active set (Goldfarb, Idnani); QP in velocities; Python worker"},
    {kDrake, "drake-moby", "Lemke's method with growing shifts (MobyLcpSolver); Python worker"},
    {kPinocchio, "pinocchio-admm", "ADMM of its contact solvers; Python worker",
     TierSettings{{1e-4, 1e-7, 1e-10}, 2e4}},
    {kPinocchio, "pinocchio-admm-default", kAsItIs},
    {kPinocchio, "pinocchio-pgs", "projected Gauss-Seidel of its contact solvers; Python worker",
     TierSettings{{1e-4, 1e-7, 1e-10}, 1e6}},
    {kPinocchio, "pinocchio-pgs-default", kAsItIs},
};

constexpr std::array kTableTiers{1e-3, 1e-6, 1e-9};
// A requested 1e-6 may arrive with the last digit off.
constexpr double kSlack = 1 + 1e-9;

const TierSettings& TiersOf(std::string_view key) {
  const auto* peer = std::find_if(std::begin(kPeers), std::end(kPeers), [key](const auto& p) { return p.key == key; });
  if (peer == std::end(kPeers) || !peer->tiers) throw std::logic_error("no tier settings for " + std::string(key));
  return *peer->tiers;
}

}  // namespace

std::span<const PeerEntry> AllPeers() { return kPeers; }

double TierTolerance(std::string_view key, double tolerance) {
  std::size_t tier = 0;
  while (tier + 1 < kTableTiers.size() && kTableTiers[tier] > tolerance * kSlack) ++tier;
  return TiersOf(key).tolerances[tier];
}

double TierIterations(std::string_view key) { return TiersOf(key).most_iterations; }

}  // namespace lcpbench
