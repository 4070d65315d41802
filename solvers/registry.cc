#include "solvers/registry.h"

#include <array>

#include "solvers/dantzig.h"
#include "solvers/lcp/input_error.h"
#include "solvers/pgs.h"
#ifdef LCPBENCH_WITH_IPOPT
#include "solvers/ipopt_ncp.h"
#include "solvers/ipopt_qp.h"
#endif
#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/suitesparse.h"
#endif

namespace lcpbench {
namespace {

#ifdef LCPBENCH_WITH_IPOPT
constexpr bool kHaveIpopt = true;
#else
constexpr bool kHaveIpopt = false;
#endif
#ifdef LCPBENCH_WITH_SUITESPARSE
constexpr bool kHaveSuitesparse = true;
#else
constexpr bool kHaveSuitesparse = false;
#endif

using Factory = std::unique_ptr<LcpSolver> (*)(const Settings&);

template <typename Solver, typename Options>
std::unique_ptr<LcpSolver> Make(const Settings& settings) {
  return std::make_unique<Solver>(Options::FromSettings(settings));
}

std::string NotPsd(const LcpProblem& problem) {
  const MatrixFacts& facts = problem.facts();
  if (!facts.symmetric || !facts.positive_semidefinite) return "A is not known to be symmetric positive semidefinite";
  return {};
}

std::string AnyPsd(const LcpProblem& problem, double /*tolerance*/) { return NotPsd(problem); }

std::string PsdAtMedium(const LcpProblem& problem, double tolerance) {
  if (tolerance < 1e-6) return "promised to 1e-6 only";
  return NotPsd(problem);
}

std::string Never(const LcpProblem& /*problem*/, double /*tolerance*/) {
  return "converges to every tolerance in the limit only; no bound on the number of sweeps";
}

std::string NcpLocal(const LcpProblem& /*problem*/, double /*tolerance*/) {
  return "a nonconvex formulation: local convergence only";
}

#ifdef LCPBENCH_WITH_IPOPT
constexpr Factory kMakeIpoptQp = &Make<IpoptQpSolver, IpoptQpOptions>;
constexpr Factory kMakeIpoptNcp = &Make<IpoptNcpSolver, IpoptNcpOptions>;
#else
constexpr Factory kMakeIpoptQp = nullptr;
constexpr Factory kMakeIpoptNcp = nullptr;
#endif
#ifdef LCPBENCH_WITH_SUITESPARSE
constexpr Factory kMakeSuitesparse = &Make<SuitesparseSolver, SuitesparseOptions>;
#else
constexpr Factory kMakeSuitesparse = nullptr;
#endif

constexpr std::array kSolvers{
    SolverEntry{"dantzig", "incremental pivoting on a dense updated factor, joints first", "Baraff 1994, sec. 4", true,
                false, &AnyPsd, &Make<DantzigSolver, DantzigOptions>},
    SolverEntry{"pgs", "projected Gauss-Seidel, assembled or matrix-free", "Cottle, Pang, Stone, ch. 5", true, true,
                &Never, &Make<PgsSolver, PgsOptions>},
    SolverEntry{"ipopt-qp", "interior point on the convex QP min 1/2 f.A f + b.f, f_C >= 0", "Ipopt (Waechter 2006)",
                kHaveIpopt, true, &PsdAtMedium, kMakeIpoptQp},
    SolverEntry{"ipopt-ncp", "interior point on min f.w subject to w = A f + b, f, w >= 0", "Ipopt (Waechter 2006)",
                kHaveIpopt, true, &NcpLocal, kMakeIpoptNcp},
    SolverEntry{"suitesparse", "interior point on sparse CHOLMOD, proximal, finished by an active set",
                "SuiteSparse CHOLMOD (Chen 2008)", kHaveSuitesparse, true, &AnyPsd, kMakeSuitesparse},
};

}  // namespace

std::span<const SolverEntry> AllSolvers() { return kSolvers; }

const SolverEntry& FindSolver(std::string_view key) {
  std::string known;
  for (const SolverEntry& entry : kSolvers) {
    if (entry.key == key) return entry;
    known += (known.empty() ? "" : ", ") + std::string(entry.key);
  }
  throw InputError("unknown solver '" + std::string(key) + "', expected one of " + known);
}

std::unique_ptr<LcpSolver> MakeSolver(std::string_view key, const Settings& settings) {
  const SolverEntry& entry = FindSolver(key);
  if (!entry.available) throw InputError("solver '" + std::string(key) + "' is not in this build");
  return entry.make(settings);
}

}  // namespace lcpbench
