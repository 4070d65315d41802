#include "solvers/peers/peer_table.h"

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

constexpr MethodClass kAny = MethodClass::kAnySize;
constexpr std::string_view kWithCfm = "the same with the diagonal shift that engines use (cfm)";
constexpr std::string_view kAsItIs = "the same with the library's own options";

constexpr PeerEntry kPeers[] = {
    {kBullet, "bullet-dantzig", "Dantzig pivoting of the physics engine"},
    {kBullet, "bullet-dantzig-cfm", kWithCfm},
    {kBullet, "bullet-lemke", "Lemke's complementary pivoting"},
    {kOde, "ode-dantzig", "Dantzig pivoting of the physics engine, LDL^T updated"},
    {kOde, "ode-dantzig-cfm", kWithCfm},
    {kDart, "dart-dantzig", "Dantzig pivoting, after ODE's"},
    {kDart, "dart-dantzig-cfm", kWithCfm},
    {kDart, "dart-pgs", "projected Gauss-Seidel", true},
    {kDart, "dart-pgs-default", kAsItIs},
    {kSiconos, "siconos-lexicolemke", "lexicographic Lemke pivoting"},
    {kSiconos, "siconos-newton-fb", "semismooth Newton on the Fischer-Burmeister function", true},
    {kSiconos, "siconos-newton-fb-default", kAsItIs},
    {kSiconos, "siconos-pgs", "projected Gauss-Seidel", true},
    {kSiconos, "siconos-pgs-default", kAsItIs},
    {kSiconos, "siconos-nsgs-sbm", "block Gauss-Seidel on a sparse block matrix", true, kAny},
    {kSiconos, "siconos-avi", "pivoting on the affine variational inequality (Cao, Ferris)"},
    {kPetsc, "petsc-rsls", "SNES reduced-space active-set Newton with line search", true, kAny},
    {kPetsc, "petsc-rsls-default", kAsItIs, false, kAny},
    {kPetsc, "petsc-ssls", "SNES semismooth Newton with line search", true, kAny},
    {kPetsc, "petsc-ssls-default", kAsItIs, false, kAny},
    {kPetsc, "tao-bntr", "TAO bounded Newton trust region on the QP", true, kAny},
    {kPetsc, "tao-bntr-default", kAsItIs, false, kAny},
    {kPetsc, "tao-tron", "TAO trust-region Newton (TRON) on the QP", true, kAny},
    {kPetsc, "tao-tron-default", kAsItIs, false, kAny},
    {kCgal, "cgal-qp", "exact rational QP simplex: a reference for small n", false, MethodClass::kExactArithmetic},
    {kClp, "clp", "COIN-OR simplex code with its QP extension", true, kAny},
    {kClp, "clp-default", kAsItIs, false, kAny},
};

}  // namespace

std::span<const PeerEntry> AllPeers() { return kPeers; }

}  // namespace lcpbench
