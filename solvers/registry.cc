#include "solvers/registry.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "solvers/active_set/bpp.h"
#include "solvers/active_set/semismooth_newton.h"
#include "solvers/auto/auto_rules.h"
#include "solvers/auto/auto_solver.h"
#include "solvers/auto/hybrid.h"
#include "solvers/first_order/apgd.h"
#include "solvers/first_order/nncg.h"
#include "solvers/first_order/pgs.h"
#include "solvers/friction/lagged_bounds.h"
#include "solvers/friction/mode_newton.h"
#include "solvers/friction/normal_map_path.h"
#include "solvers/friction/relaxation.h"
#include "solvers/friction/shift.h"
#include "solvers/peers/peer_table.h"
#include "solvers/pivoting/dantzig.h"
#include "solvers/pivoting/lemke.h"
#include "support/input_error.h"
#include "support/program_folder.h"
#ifdef LCPBENCH_WITH_IPOPT
#include "solvers/ipopt/ipopt_solver.h"
#endif
#ifdef LCPBENCH_WITH_SUITESPARSE
#include "solvers/interior_point/ipm.h"
#endif

namespace lcpbench {
namespace {

using Factory = std::function<std::unique_ptr<LcpSolver>(const Settings&)>;

// With the options `start`, and what settings make of them.
// @param key  for error texts
template <typename Solver>
Factory Make(const char* key, const typename Solver::Options& start = {}) {
  return [key, start](const Settings& settings) -> std::unique_ptr<LcpSolver> {
    SettingsReader reader(key, settings);
    typename Solver::Options options = start;
    if constexpr (requires { options.Read(&reader); }) options.Read(&reader);
    reader.Finish();
    return std::make_unique<Solver>(options);
  };
}

std::string NotPsd(const LcpProblem& problem) {
  const MatrixFacts& facts = problem.facts();
  if (!facts.symmetric || !facts.positive_semidefinite) return "A is not known to be symmetric positive semidefinite";
  return {};
}

std::string AnyPsd(const LcpProblem& problem, double /*tolerance*/) {
  if (!problem.is_plain()) return "with friction a solution is known to exist for some time steps only";
  return NotPsd(problem);
}

std::string PsdAtMedium(const LcpProblem& problem, double tolerance) {
  if (tolerance < 1e-6) return "promised to 1e-6 only";
  return NotPsd(problem);
}

// These methods promise nothing.
template <const char* why>
std::string Because(const LcpProblem& /*problem*/, double /*tolerance*/) {
  return why;
}
constexpr char kInTheLimit[] = "converges to every tolerance in the limit only; no bound on the number of sweeps";
constexpr char kNoBoundOnBlocks[] = "blocks may cycle, and single exchanges have no polynomial bound";
constexpr char kLeavesHardOnes[] = "what it finds hard it leaves to the methods that auto asks next";
constexpr char kModesMayCycle[] = "modes of contacts may cycle, and so may sweeps";
constexpr char kNoContraction[] = "bounds may fail to settle where friction moves normal forces much";
constexpr char kLocal[] = "a nonconvex formulation: local convergence only";
constexpr char kNotOurs[] = "another project's solver: we promise nothing for it";

template <AutoMethod method>
SolverEntry MethodOfAuto(const std::string& text, const std::string& source) {
  return {.key = std::string(KeyOf(method)),
          .method = text + "; a method of auto alone",
          .source = source,
          .uses_tolerance = true,
          .why_not_guaranteed = &Because<kLeavesHardOnes>,
          .make = [](const Settings& settings) -> std::unique_ptr<LcpSolver> {
            return std::make_unique<AutoSolver>(AutoOptions::Only(method, settings));
          }};
}

#ifdef LCPBENCH_WITH_IPOPT
const Factory kMakeIpoptQp = Make<IpoptSolver>("ipopt-qp", {.program = IpoptOptions::Program::kQp});
const Factory kMakeIpoptNcp = Make<IpoptSolver>("ipopt-ncp", {.program = IpoptOptions::Program::kNcp});
#else
const Factory kMakeIpoptQp = nullptr;
const Factory kMakeIpoptNcp = nullptr;
#endif
#ifdef LCPBENCH_WITH_SUITESPARSE
const Factory kMakeIpm = Make<IpmSolver>("ipm");
const Factory kMakeHybrid = Make<HybridSolver>("hybrid");
#else
const Factory kMakeHybrid = nullptr;
const Factory kMakeIpm = nullptr;
#endif

std::vector<SolverEntry> ActiveSetSolvers() {
  LemkeOptions lemke;
  lemke.make_other = [] { return std::make_unique<ModeLemkeSolver>(ModeLemkeOptions{}); };
  return {
      {.key = "dantzig",
       .method = "incremental pivoting on a dense updated factor, joints first",
       .source = "Baraff 1994, sec. 4",
       .why_not_guaranteed = &AnyPsd,
       .make = Make<DantzigSolver>("dantzig"),
       .method_class = MethodClass::kDenseMatrix},
      {.key = "auto",
       .method = "chooses among our own backends, checks the answer, asks the next",
       .source = "see solvers/auto/auto_solver.h",
       .uses_tolerance = true,
       .why_not_guaranteed = &AnyPsd,
       .make = [](const Settings& settings) -> std::unique_ptr<LcpSolver> {
         return std::make_unique<AutoSolver>(AutoOptions::FromSettings(settings));
       },
       .takes_friction = true,
       .takes_bounded = true},
      MethodOfAuto<AutoMethod::kFixedSizeBpp>("block principal pivoting in registers, islands of up to 6 rows",
                                              "Judice, Pires 1994; Keller 1973"),
      MethodOfAuto<AutoMethod::kPrincipalPivoting>("principal pivoting on a dense tableau, islands of up to 128 rows",
                                                   "Tucker 1963; Keller 1973; Murty 1974"),
      MethodOfAuto<AutoMethod::kProfilePivoting>("conjugate gradients, then block pivoting on a profile factor",
                                                 "Silcowitz, Niebe, Erleben 2010; Judice, Pires 1994; Jennings 1966"),
      MethodOfAuto<AutoMethod::kBandPivoting>("sweeps, then block pivoting on a banded factor of a given A",
                                              "Kostreva 1978; Portugal, Judice, Vicente 1994"),
      {.key = "semismooth-newton",
       .method = "proximal semismooth Newton with exact line search on a sparse factor",
       .source = "Rockafellar 1976; Qi, Sun 1999",
       .why_not_guaranteed = &AnyPsd,
       .make = Make<SemismoothNewtonSolver>("semismooth-newton"),
       .takes_bounded = true},
      {.key = "lemke",
       .method = "lexicographic Lemke on a dense updated factor, joints first",
       .source = "Lemke 1965; Cottle, Pang, Stone, sec. 4.4, 4.9",
       .why_not_guaranteed = &AnyPsd,
       .make = Make<LemkeSolver>("lemke", lemke),
       .takes_friction = true,
       .takes_bounded = true,
       .method_class = MethodClass::kDenseMatrix},
      {.key = "bpp",
       .method = "block principal pivoting, proximal, on sparse or dense factors",
       .source = "Portugal, Judice, Vicente 1994",
       .why_not_guaranteed = &Because<kNoBoundOnBlocks>,
       .make = Make<BppSolver>("bpp"),
       .takes_bounded = true},
      {.key = "active-set",
       .method = "primal-dual active set on an updated sparse factor",
       .source = "Portugal, Judice, Vicente 1994; Davis 2006",
       .why_not_guaranteed = &Because<kNoBoundOnBlocks>,
       .make = Make<BppSolver>("active-set", {.continuation_rows = SemismoothNewtonOptions().continuation_rows}),
       .takes_bounded = true},
  };
}

std::vector<SolverEntry> FirstOrderSolvers() {
  return {
      {.key = "pgs",
       .method = "projected Gauss-Seidel, assembled or matrix-free",
       .source = "Cottle, Pang, Stone, ch. 5",
       .why_not_guaranteed = &Because<kInTheLimit>,
       .make = Make<PgsSolver>("pgs"),
       .takes_friction = true,
       .takes_bounded = true},
      {.key = "psor",
       .method = "projected SOR, relaxation adapted to the measured rate",
       .source = "Cryer 1971; Young 1971",
       .why_not_guaranteed = &Because<kInTheLimit>,
       .make = Make<PgsSolver>("psor", {.relaxation = PgsOptions::kFirstOfAdaptive, .adaptive = true}),
       .takes_friction = true,
       .takes_bounded = true},
      {.key = "nncg",
       .method = "nonsmooth conjugate gradients on symmetric Gauss-Seidel sweeps",
       .source = "Silcowitz, Niebe, Erleben 2010",
       .why_not_guaranteed = &Because<kInTheLimit>,
       .make = Make<NncgSolver>("nncg"),
       .takes_bounded = true},
      {.key = "apgd",
       .method = "accelerated projected gradients, adaptive step and restart",
       .source = "Mazhar, Heyn, Negrut, Tasora 2015",
       .why_not_guaranteed = &Because<kInTheLimit>,
       .make = Make<ApgdSolver>("apgd"),
       .takes_bounded = true},
  };
}

std::vector<SolverEntry> FrictionSolvers() {
  const WithinOptions on_auto{[] { return std::make_unique<AutoSolver>(); }};
  return {{.key = "relaxation",
           .method = "friction relaxed to two rows a contact, solved by auto: a model of its own",
           .source = "Anitescu 2006; Todorov 2014",
           .why_not_guaranteed = &AnyPsd,
           .make = Make<RelaxationSolver>("relaxation", on_auto),
           .takes_friction = true,
           .takes_plain = false},
          {.key = "shift",
           .method = "relaxations of friction with shifted gaps, a few Newton steps on modes after each",
           .source = "De Saxce, Feng 1991; Acary et al. 2011",
           .why_not_guaranteed = &Because<kModesMayCycle>,
           .make = Make<ShiftSolver>("shift", on_auto),
           .takes_friction = true,
           .takes_plain = false},
          {.key = "mode-newton",
           .method = "Newton's method on the modes of contacts, proximal, with sweeps where it stalls",
           .source = "Alart, Curnier 1991",
           .why_not_guaranteed = &Because<kModesMayCycle>,
           .make = Make<ModeNewtonSolver>("mode-newton"),
           .takes_friction = true,
           .takes_bounded = true,
           .takes_plain = false},
          {.key = "lagged-bounds",
           .method = "friction bounded by the normal forces of the last of a row of box programs",
           .source = "Haslinger 1983; Panagiotopoulos 1985",
           .why_not_guaranteed = &Because<kNoContraction>,
           .make = Make<LaggedBoundsSolver>("lagged-bounds", on_auto),
           .takes_friction = true,
           .takes_bounded = true,
           .takes_plain = false}};
}

// What is not in this build has no `make`, and stays in the table.
std::vector<SolverEntry> InteriorPointSolvers() {
  return {
      {.key = "ipopt-qp",
       .method = "interior point on the convex QP min 1/2 f.A f + b.f, f_C >= 0",
       .source = "Ipopt (Waechter 2006)",
       .why_not_guaranteed = &PsdAtMedium,
       .make = kMakeIpoptQp},
      {.key = "ipopt-ncp",
       .method = "interior point on min f.w subject to w = A f + b, f, w >= 0",
       .source = "Ipopt (Waechter 2006)",
       .why_not_guaranteed = &Because<kLocal>,
       .make = kMakeIpoptNcp},
      {.key = "ipm",
       .method = "interior point on sparse CHOLMOD, proximal, finished by an active set",
       .source = "SuiteSparse CHOLMOD (Chen 2008)",
       .why_not_guaranteed = &AnyPsd,
       .make = kMakeIpm,
       .takes_bounded = true},
      {.key = "hybrid",
       .method = "nonsmooth conjugate gradients while their rate promises an answer, then ipm",
       .source = "see solvers/auto/hybrid.h",
       .why_not_guaranteed = &AnyPsd,
       .make = kMakeHybrid},
  };
}

std::vector<SolverEntry> OwnSolvers() {
  std::vector<SolverEntry> own = ActiveSetSolvers();
  for (const auto& that_follow_it : {FirstOrderSolvers(), InteriorPointSolvers(), FrictionSolvers()}) {
    for (const SolverEntry& entry : that_follow_it) own.emplace_back(entry).uses_tolerance = true;
  }
  for (SolverEntry& entry : own) entry.available = static_cast<bool>(entry.make);
  return own;
}

// Where worker programs are: the environment variable LCPBENCH_WORKER_DIR, else the folder that an installation has for
// them beside that of this program, else the folder of the build, else that of the installation as it was configured.
// The first that holds the peer's; the last one's path if none does.
std::string WorkerPath(const PeerEntry& peer) {
  std::string path;
  const char* chosen = std::getenv("LCPBENCH_WORKER_DIR");
  for (const std::string& folder :
       {std::string(chosen == nullptr ? "" : chosen), ProgramFolder() + "/" LCPBENCH_WORKER_DIR_FROM_PROGRAM,
        std::string(LCPBENCH_BUILD_WORKER_DIR), std::string(LCPBENCH_INSTALL_WORKER_DIR)}) {
    if (folder.empty()) continue;
    path = folder + "/lcpbench-worker-" + std::string(peer.project.folder);
    if (access(path.c_str(), X_OK) == 0) break;
  }
  return path;
}

std::unique_ptr<ExternalSolver> MakeExternal(ExternalSolverOptions options, const Settings& settings) {
  for (const auto& [name, value] : settings) options.command.push_back(name + "=" + value);
  return std::make_unique<ExternalSolver>(std::move(options));
}

SolverEntry EntryOf(const PeerEntry& peer) {
  constexpr std::string_view built = " " LCPBENCH_PEERS " ";
  SolverEntry entry;
  entry.key = peer.key;
  entry.method = peer.method;
  entry.source = peer.project.library;
  entry.available = built.find(" " + std::string(peer.project.folder) + " ") != std::string_view::npos;
  entry.uses_tolerance = peer.tiers.has_value();
  entry.why_not_guaranteed = &Because<kNotOurs>;
  entry.origin = SolverOrigin::kPeer;
  entry.licence = peer.project.licence;
  entry.method_class = peer.method_class;
  entry.library_defaults = peer.has_library_defaults();
  entry.shifted = peer.is_shifted();
  entry.takes_friction = peer.takes_friction();
  entry.takes_bounded = peer.takes_bounded();
  entry.law = ToString(peer.law);
  entry.takes_plain = peer.transformation == Transformation::kNone;
  if (!entry.available) return entry;
  entry.make = [&peer](const Settings& settings) {
    auto solver = MakeExternal({.command = {WorkerPath(peer), std::string(peer.key)}}, settings);
    // Only the worker knows its settings: a wrong one is the user's mistake, and reported before any problem is read.
    if (!settings.empty()) solver->Greet();
    return solver;
  };
  return entry;
}

// Keys that result files and scripts of earlier versions name, and short ones.
std::string_view PresentKey(std::string_view key) {
  if (key == "suitesparse") return "ipm";
  return key == "ssn" ? "semismooth-newton" : key;
}

// Filled on the first use, so that no order of static initialisers matters.
std::vector<SolverEntry>& Solvers() {
  static std::vector<SolverEntry> solvers = [] {
    std::vector<SolverEntry> all = OwnSolvers();
    for (SolverEntry& own : all) {
      if (own.takes_friction) {
        own.law = ToString(own.key == "relaxation" ? FrictionLaw::kRelaxation : FrictionLaw::kCoulomb);
      }
    }
    for (const PeerEntry& peer : AllPeers()) all.push_back(EntryOf(peer));
    return all;
  }();
  return solvers;
}

}  // namespace

std::string_view SolverEntry::tolerance() const {
  if (library_defaults) return "default";
  return uses_tolerance ? "follows" : "direct";
}

std::string SizeRefusal(const SolverEntry& solver, Index rows) {
  const std::optional<SizeLimit> limit = SizeLimitOf(solver.method_class);
  if (!limit || rows <= limit->largest) return {};
  return "not above n = " + std::to_string(limit->largest) + ": " + std::string(limit->reason);
}

std::span<const SolverEntry> AllSolvers() { return Solvers(); }

const SolverEntry& FindSolver(std::string_view key) {
  const std::string_view present = PresentKey(key);
  for (const SolverEntry& entry : Solvers()) {
    if (entry.key == present) return entry;
  }
  std::string own;
  int peers = 0;
  for (const SolverEntry& entry : Solvers()) {
    if (entry.origin == SolverOrigin::kOwn) own += entry.key + ", ";
    if (entry.origin != SolverOrigin::kOwn) ++peers;
  }
  throw InputError("unknown solver '" + std::string(key) + "', expected one of " + own + "or of the " +
                   std::to_string(peers) + " peers that `lcpbench list solvers` names");
}

std::unique_ptr<LcpSolver> MakeSolver(std::string_view key, const Settings& settings) {
  const SolverEntry& entry = FindSolver(key);
  if (!entry.available) throw InputError("solver '" + std::string(key) + "' is not in this build");
  return entry.make(settings);
}

std::string WorkerVersion(std::string_view key) {
  static std::map<std::string, std::string, std::less<>> known;
  const SolverEntry& entry = FindSolver(key);
  if (entry.origin == SolverOrigin::kOwn || !entry.available) return {};
  const auto found = known.find(key);
  if (found != known.end()) return found->second;
  std::string version;
  try {
    const std::unique_ptr<LcpSolver> solver = entry.make({});
    if (auto* external = dynamic_cast<ExternalSolver*>(solver.get())) version = external->Greet().library_version;
  } catch (const InputError&) {
    if (entry.origin == SolverOrigin::kExternal) throw;
    // The solve will say what is wrong.
  }
  return known.emplace(key, version).first->second;
}

void RegisterSolver(SolverEntry entry) {
  const auto is_allowed = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-' || c == '_';
  };
  if (entry.key.empty() || !std::all_of(entry.key.begin(), entry.key.end(), is_allowed)) {
    throw InputError("solver '" + entry.key + "': expected a key of a-z, 0-9, '-', '_'");
  }
  std::vector<SolverEntry>& solvers = Solvers();
  const bool taken = std::any_of(solvers.begin(), solvers.end(),
                                 [&](const SolverEntry& other) { return other.key == PresentKey(entry.key); });
  if (taken) throw InputError("solver '" + entry.key + "': the key is taken");
  solvers.push_back(std::move(entry));
}

void RegisterSolverVariant(const std::string& key, const std::string& base, const Settings& settings) {
  SolverEntry entry = FindSolver(base);
  // What is wrong with the settings is said now.
  MakeSolver(base, settings);
  entry.base = entry.base.empty() ? entry.key : entry.base;
  entry.key = key;
  for (const auto& [name, value] : settings) entry.settings[name] = value;
  entry.make = [make = entry.make, settings](const Settings& more) {
    Settings all = more;
    all.insert(settings.begin(), settings.end());
    return make(all);
  };
  RegisterSolver(std::move(entry));
}

void RegisterSolverBySize(const std::string& key, const std::string& base,
                          const std::map<Index, std::string>& by_rows) {
  SolverEntry entry = FindSolver(base);
  entry.base = entry.base.empty() ? entry.key : entry.base;
  entry.key = key;
  for (const auto& [rows, variant] : by_rows) {
    std::string words;
    for (const auto& [name, value] : FindSolver(variant).settings)
      words += (words.empty() ? "" : ",") + name + "=" + value;
    entry.settings[std::to_string(rows) + " rows"] = words;
  }
  entry.by_rows = by_rows;
  RegisterSolver(std::move(entry));
}

const std::string& KeyForRows(const SolverEntry& solver, Index rows) {
  const auto distance = [rows](const auto& meant_for) {
    return std::abs(std::log(static_cast<double>(meant_for.first) / static_cast<double>(rows)));
  };
  const auto nearest = std::min_element(solver.by_rows.begin(), solver.by_rows.end(),
                                        [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
  return nearest == solver.by_rows.end() ? solver.key : nearest->second;
}

void RegisterExternalSolver(const std::string& key, const std::vector<std::string>& command, double start_limit_s) {
  if (command.empty()) throw InputError("external solver '" + key + "': expected a command");
  SolverEntry entry;
  entry.key = key;
  entry.method = "external command";
  entry.source = command.front();
  entry.available = true;
  entry.uses_tolerance = true;
  entry.why_not_guaranteed = &Because<kNotOurs>;
  entry.origin = SolverOrigin::kExternal;
  entry.licence = "unknown";
  entry.takes_friction = entry.takes_bounded = true;  // its worker says what it refuses
  constexpr std::string_view kBaseline = "-baseline";
  if (key.ends_with(kBaseline)) {
    const std::string_view base = std::string_view(key).substr(0, key.size() - kBaseline.size());
    const auto found = std::find_if(AllSolvers().begin(), AllSolvers().end(), [&](const SolverEntry& other) {
      return other.key == base && other.origin == SolverOrigin::kOwn;
    });
    if (found != AllSolvers().end()) {
      entry.method = found->method + ", of another build";
      entry.uses_tolerance = found->uses_tolerance;
      entry.takes_friction = found->takes_friction;
      entry.takes_bounded = found->takes_bounded;
      entry.law = found->law;
      entry.takes_plain = found->takes_plain;
      entry.method_class = found->method_class;
      entry.base = found->key;
    }
  }
  entry.make = [=](const Settings& settings) {
    return MakeExternal({.command = command, .name = key, .start_limit_s = start_limit_s}, settings);
  };
  RegisterSolver(std::move(entry));
}

}  // namespace lcpbench
