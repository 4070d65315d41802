#include "solvers/peers/peer_table.h"

#include <unistd.h>

#include <array>
#include <cstdlib>
#include <utility>

#include "solvers/peers/protocol/external_solver.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

#ifdef LCPBENCH_WITH_BULLET
constexpr bool kHaveBullet = true;
#else
constexpr bool kHaveBullet = false;
#endif
#ifdef LCPBENCH_WITH_ODE
constexpr bool kHaveOde = true;
#else
constexpr bool kHaveOde = false;
#endif
#ifdef LCPBENCH_WITH_DART
constexpr bool kHaveDart = true;
#else
constexpr bool kHaveDart = false;
#endif
#ifdef LCPBENCH_WITH_SICONOS
constexpr bool kHaveSiconos = true;
#else
constexpr bool kHaveSiconos = false;
#endif
#ifdef LCPBENCH_WITH_PETSC
constexpr bool kHavePetsc = true;
#else
constexpr bool kHavePetsc = false;
#endif
#ifdef LCPBENCH_WITH_CGAL
constexpr bool kHaveCgal = true;
#else
constexpr bool kHaveCgal = false;
#endif
#ifdef LCPBENCH_WITH_CLP
constexpr bool kHaveClp = true;
#else
constexpr bool kHaveClp = false;
#endif

constexpr MethodClass kDense = MethodClass::kDenseMatrix;

constexpr PeerEntry Bullet(std::string_view key, std::string_view method) {
  return {key, method, "Bullet", "Zlib", "lcpbench-worker-bullet", kHaveBullet, false, kDense};
}
constexpr PeerEntry Ode(std::string_view key, std::string_view method) {
  return {key, method, "ODE", "LGPL-2.1-or-later OR BSD-3-Clause", "lcpbench-worker-ode", kHaveOde, false, kDense};
}
constexpr PeerEntry Dart(std::string_view key, std::string_view method, bool uses_tolerance) {
  // Its Dantzig code is ODE's, with ODE's licence.
  constexpr std::string_view kLicence = "BSD-2-Clause AND (LGPL-2.1-or-later OR BSD-3-Clause)";
  return {key, method, "DART", kLicence, "lcpbench-worker-dart", kHaveDart, uses_tolerance, kDense};
}
constexpr PeerEntry Siconos(std::string_view key, std::string_view method, bool uses_tolerance,
                            MethodClass method_class = kDense) {
  return {key, method, "Siconos", "Apache-2.0", "lcpbench-worker-siconos", kHaveSiconos, uses_tolerance, method_class};
}
constexpr PeerEntry Petsc(std::string_view key, std::string_view method, bool uses_tolerance) {
  return {
      key, method, "PETSc", "BSD-2-Clause", "lcpbench-worker-petsc", kHavePetsc, uses_tolerance, MethodClass::kAnySize};
}
constexpr PeerEntry Clp(std::string_view key, std::string_view method, bool uses_tolerance) {
  return {key, method, "Clp", "EPL-1.0", "lcpbench-worker-clp", kHaveClp, uses_tolerance, MethodClass::kAnySize};
}

constexpr std::array kPeers{
    Bullet("bullet-dantzig", "Dantzig pivoting of the physics engine"),
    Bullet("bullet-dantzig-cfm", "the same with the diagonal shift that engines use (cfm)"),
    Bullet("bullet-lemke", "Lemke's complementary pivoting"),
    Ode("ode-dantzig", "Dantzig pivoting of the physics engine, LDL^T updated"),
    Ode("ode-dantzig-cfm", "the same with the diagonal shift that engines use (cfm)"),
    Dart("dart-dantzig", "Dantzig pivoting, after ODE's", false),
    Dart("dart-dantzig-cfm", "the same with the diagonal shift that engines use (cfm)", false),
    Dart("dart-pgs", "projected Gauss-Seidel", true),
    Dart("dart-pgs-default", "the same with the library's own options", false),
    Siconos("siconos-lexicolemke", "lexicographic Lemke pivoting", false),
    Siconos("siconos-newton-fb", "semismooth Newton on the Fischer-Burmeister function", true),
    Siconos("siconos-newton-fb-default", "the same with the library's own options", false),
    Siconos("siconos-pgs", "projected Gauss-Seidel", true),
    Siconos("siconos-pgs-default", "the same with the library's own options", false),
    Siconos("siconos-nsgs-sbm", "block Gauss-Seidel on a sparse block matrix", true, MethodClass::kAnySize),
    Siconos("siconos-avi", "pivoting on the affine variational inequality (Cao, Ferris)", false),
    Petsc("petsc-rsls", "SNES reduced-space active-set Newton with line search", true),
    Petsc("petsc-rsls-default", "the same with the library's own options", false),
    Petsc("petsc-ssls", "SNES semismooth Newton with line search", true),
    Petsc("petsc-ssls-default", "the same with the library's own options", false),
    Petsc("tao-bntr", "TAO bounded Newton trust region on the QP", true),
    Petsc("tao-bntr-default", "the same with the library's own options", false),
    Petsc("tao-tron", "TAO trust-region Newton (TRON) on the QP", true),
    Petsc("tao-tron-default", "the same with the library's own options", false),
    PeerEntry{"cgal-qp", "exact rational QP simplex: a reference for small n", "CGAL", "GPL-3.0-or-later",
              "lcpbench-worker-cgal", kHaveCgal, false, MethodClass::kExactArithmetic},
    Clp("clp", "COIN-OR simplex code with its QP extension", true),
    Clp("clp-default", "the same with the library's own options", false),
};

}  // namespace

std::span<const PeerEntry> AllPeers() { return kPeers; }

std::string WorkerPath(std::string_view worker) {
  std::string path;
  const char* chosen = std::getenv("LCPBENCH_WORKER_DIR");
  for (const char* folder : {chosen, LCPBENCH_BUILD_WORKER_DIR, LCPBENCH_INSTALL_WORKER_DIR}) {
    if (folder == nullptr) continue;
    path = std::string(folder) + "/" + std::string(worker);
    if (access(path.c_str(), X_OK) == 0) break;
  }
  return path;
}

std::unique_ptr<LcpSolver> MakePeer(const PeerEntry& peer, const Settings& settings) {
  if (!peer.available) throw InputError("solver '" + std::string(peer.key) + "' is not in this build");
  ExternalSolverOptions options;
  options.command = {WorkerPath(peer.worker), std::string(peer.key)};
  for (const auto& [name, value] : settings) options.command.push_back(name + "=" + value);
  auto solver = std::make_unique<ExternalSolver>(std::move(options));
  // Only the worker knows its settings: a wrong one is the user's mistake, and told before any problem is read.
  if (!settings.empty()) solver->Greet();
  return solver;
}

}  // namespace lcpbench
