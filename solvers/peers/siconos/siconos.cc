// Siconos's solvers for linear complementarity problems, behind linearComplementarity_driver.
//
// Known of release 4.4. The driver answers "no row pulls" (q >= 0) itself, and in the end recomputes w and accepts an
// answer when ||min(z, w)|| <= tolerance ||q||, whatever units z and w have: that is every method's claim of success. A
// residual that is not a number passes. The pivoting codes test with the tolerance that their options begin with (1e-6,
// and 1e-12 for the variational inequality). Where Lemke's method meets a column without positive entry, it gives up
// and does not say whether the problem has no solution: no claim of infeasibility is made of that.
//
// Sweeps and Newton steps are asked for in portions, with the clock read in between: all that the next depends on is z,
// so that this changes nothing. Pivoting cannot be interrupted; the host's time limit ends it.
//
// The block method solves each diagonal block by Gauss-Seidel. Its default, projected relaxation, prints a warning at
// each call; with the library's pivoting codes it passed fewer of the tuning problems, because they fail on blocks that
// redundant rows make singular, and a block that fails ends the sweep. Iterations are pivots, sweeps or Newton steps;
// the block method does not tell its sweeps: those asked for are counted, at most twice as many and kFewest as made.
//
// Settings, other than `tolerance` and of keys that do not end in -default, as the library's documentation of its LCP
// solvers has them; the first is the library's own.
//   siconos-lexicolemke  rule: lexico, lemke, bard, murty: the pivoting code (SICONOS_LCP_LEMKE, _PIVOT, _BARD, _MURTY)
//   siconos-newton-fb    direction: fischer-burmeister, min; search: armijo, goldstein; reference: monotone, max, mean
//                        (of the last ten merit values)
//   siconos-pgs          regularization: 0, or as a share of the largest diagonal entry: the regularized code (_RPGS)
//   siconos-nsgs-sbm     local: pgs, rpgs, lemke, newton-fb, the solver of a block; local-iterations: 0, its own limit,
//                        or another; block-rows: rows of a block at most

#include <Newton_methods.h>
#include <NonSmoothDrivers.h>
#include <SolverOptions.h>
#include <fcntl.h>
#include <lcp_cst.h>
#include <line_search.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <string>

#include "solvers/linear_algebra/library_threads.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/siconos/siconos_problem.h"
#include "solvers/peers/tier_settings.h"

namespace lcpbench {
namespace {

// The library prints each failed block, each sweep: nobody reads that, and a campaign's terminal would drown in it.
class Silence {
 public:
  Silence() {
    std::fflush(nullptr);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);  // NOLINT(cppcoreguidelines-pro-type-vararg)
    for (std::size_t i = 0; i < kStreams.size(); ++i) {
      kept_[i] = dup(kStreams[i]);
      if (nowhere >= 0) dup2(nowhere, kStreams[i]);
    }
    if (nowhere >= 0) close(nowhere);
  }
  ~Silence() {
    std::fflush(nullptr);
    for (std::size_t i = 0; i < kStreams.size(); ++i) {
      dup2(kept_[i], kStreams[i]);
      close(kept_[i]);
    }
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  static constexpr std::array kStreams{STDOUT_FILENO, STDERR_FILENO};
  std::array<int, kStreams.size()> kept_{};
};

using OptionsPointer = std::unique_ptr<SolverOptions, void (*)(SolverOptions*)>;

struct Method {
  std::string_view key;
  LCP_SOLVER solver = SICONOS_LCP_LEMKE;
  SiconosProblem::Storage storage = SiconosProblem::Storage::kDense;
  /// What one sweep or step costs, as a power of n of a dense problem; 0 for a method that cannot be asked in portions.
  int cost_power = 0;
  bool as_the_library_has_it = false;
};

// What the settings make of a method.
struct Tuning {
  LCP_SOLVER solver = SICONOS_LCP_LEMKE;
  double tolerance = 0;  // 0: by the table of tier_settings.cc
  // Newton.
  LSA_ALGO search = SICONOS_LSA_ARMIJO;
  int reference = NM_LS_DISABLE;
  // Sweeps.
  double regularization = 0;
  // Blocks.
  LCP_SOLVER local = SICONOS_LCP_PGS;
  int local_iterations = 0;
  std::size_t block_rows = SiconosProblem::kLargestBlock;
};

class Siconos : public LcpSolver {
 public:
  Siconos(const Method& method, const Tuning& tuning) : method_(method), tuning_(tuning) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    problem_.emplace(problem, method_.storage, tuning_.block_rows);
    if (tuning_.regularization > 0) largest_diagonal_ = problem.DiagonalA().cwiseAbs().maxCoeff();
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    OptionsPointer own(nullptr, &solver_options_delete);
    Eigen::VectorXd z;
    Eigen::VectorXd w;
    TimeConversion(options, result, [&] {
      own = MakeOptions(options);
      problem_->SetB(problem.b());
      z = options.initial_f != nullptr ? problem_->VariablesOf(*options.initial_f)
                                       : Eigen::VectorXd(Eigen::VectorXd::Zero(problem_->size()));
      w.setZero(problem_->size());
    });
    const Deadline deadline(options);
    {
      const Silence silence;
      TimeLibraryCall(options, result, [&] { Run(*own, deadline, &z, &w, result); });
    }
    TimeConversion(options, result, [&] { problem_->SetForces(z, &result->f); });
  }

 private:
  // About 20 ms of work: short beside any time limit, long beside what a call costs of itself.
  static constexpr double kPortion = 2e7;      // products
  static constexpr double kPerRow = 500;       // products that take as long as a row's solve without them
  static constexpr std::int64_t kFewest = 16;  // sweeps, of a method that does not tell how many it made

  OptionsPointer MakeOptions(const LcpOptions& options) const {
    OptionsPointer own(solver_options_create(tuning_.solver), &solver_options_delete);
    if (method_.solver == SICONOS_LCP_NSGS_SBM) {
      solver_options_update_internal(own.get(), 0, tuning_.local);
      SolverOptions& local = *own->internalSolvers[0];
      if (tuning_.local_iterations > 0) local.iparam[SICONOS_IPARAM_MAX_ITER] = tuning_.local_iterations;
    }
    if (method_.solver == SICONOS_LCP_NEWTON_FB_FBLSA) {
      constexpr int kRemembered = 10;
      own->iparam[SICONOS_IPARAM_LSA_SEARCH_CRITERION] = tuning_.search;
      own->iparam[SICONOS_IPARAM_LSA_NONMONOTONE_LS] = tuning_.reference;
      own->iparam[SICONOS_IPARAM_LSA_NONMONOTONE_LS_M] = tuning_.reference == NM_LS_DISABLE ? 0 : kRemembered;
    }
    if (tuning_.regularization > 0) own->dparam[SICONOS_LCP_DPARAM_RHO] = tuning_.regularization * largest_diagonal_;
    std::int64_t most = own->iparam[SICONOS_IPARAM_MAX_ITER];
    if (!method_.as_the_library_has_it && method_.cost_power > 0) {
      own->dparam[SICONOS_DPARAM_TOL] =
          tuning_.tolerance > 0 ? tuning_.tolerance : TierValue(method_.key, "tolerance", options.tolerance);
      most = static_cast<std::int64_t>(TierValue(method_.key, "iterations", options.tolerance));
    }
    if (options.max_iterations > 0) most = options.max_iterations;
    own->iparam[SICONOS_IPARAM_MAX_ITER] =
        static_cast<int>(std::min<std::int64_t>(most, std::numeric_limits<int>::max()));
    return own;
  }

  /// The most sweeps or steps between two readings of the clock.
  std::int64_t LargestPortion(std::int64_t most) const {
    if (method_.cost_power == 0) return most;
    const auto n = static_cast<double>(problem_->size());
    const double products =
        (static_cast<double>(problem_->entries()) + kPerRow * n) * std::pow(n, method_.cost_power - 2);
    return std::max<std::int64_t>(1, static_cast<std::int64_t>(kPortion / products));
  }

  void Run(SolverOptions& own, const Deadline& deadline, Eigen::VectorXd* z, Eigen::VectorXd* w, LcpResult* result) {
    // The block method overwrites its count of sweeps with its residual: it has made all that were asked for, or fewer
    // and solved.
    const bool counts = method_.solver != SICONOS_LCP_NSGS_SBM;
    const std::int64_t most = own.iparam[SICONOS_IPARAM_MAX_ITER];
    const std::int64_t largest = LargestPortion(most);
    std::int64_t portion = counts ? largest : std::min(kFewest, largest);
    Eigen::VectorXd before;
    result->iterations = 0;
    for (;;) {
      const int asked = static_cast<int>(std::min(portion, most - result->iterations));
      own.iparam[SICONOS_IPARAM_MAX_ITER] = asked;
      own.iparam[SICONOS_IPARAM_ITER_DONE] = 0;
      before = *z;
      const int info = linearComplementarity_driver(problem_->get(), z->data(), w->data(), &own);
      const int done = counts ? own.iparam[SICONOS_IPARAM_ITER_DONE] : asked;
      result->iterations += done;
      if (info == 0) {
        result->status = LcpStatus::kSolved;
        return;
      }
      if (done == asked && result->iterations >= most) {
        result->status = LcpStatus::kIterationLimit;
        return;
      }
      if (done < asked || *z == before) {
        std::ostringstream detail;
        detail << "Siconos: gave up, its residual " << own.dparam[SICONOS_DPARAM_RESIDU];
        result->detail = detail.str();
        return;
      }
      if (deadline.Expired()) {
        result->status = LcpStatus::kTimeLimit;
        return;
      }
      portion = std::min(2 * portion, largest);
    }
  }

  Method method_;
  Tuning tuning_;
  double largest_diagonal_ = 0;
  std::optional<SiconosProblem> problem_;
};

constexpr auto kBlocks = SiconosProblem::Storage::kBlocks;
constexpr auto kDense = SiconosProblem::Storage::kDense;
constexpr Method kLemke{"siconos-lexicolemke", SICONOS_LCP_LEMKE};
constexpr Method kNewton{"siconos-newton-fb", SICONOS_LCP_NEWTON_FB_FBLSA, kDense, 3};
constexpr Method kNewtonDefault{"siconos-newton-fb-default", SICONOS_LCP_NEWTON_FB_FBLSA, kDense, 3, true};
constexpr Method kPgs{"siconos-pgs", SICONOS_LCP_PGS, kDense, 2};
constexpr Method kPgsDefault{"siconos-pgs-default", SICONOS_LCP_PGS, kDense, 2, true};
constexpr Method kBlockGaussSeidel{"siconos-nsgs-sbm", SICONOS_LCP_NSGS_SBM, kBlocks, 2};
constexpr Method kAvi{"siconos-avi", SICONOS_LCP_AVI_CAOFERRIS};

void ReadPivoting(SettingsReader* reader, Tuning* tuning) {
  const std::string rule = reader->Choice("rule", "lexico", {"lexico", "lemke", "bard", "murty"});
  if (rule == "lemke") tuning->solver = SICONOS_LCP_PIVOT;
  if (rule == "bard") tuning->solver = SICONOS_LCP_BARD;
  if (rule == "murty") tuning->solver = SICONOS_LCP_MURTY;
}

void ReadNewton(SettingsReader* reader, Tuning* tuning) {
  const std::string direction = reader->Choice("direction", "fischer-burmeister", {"fischer-burmeister", "min"});
  const std::string search = reader->Choice("search", "armijo", {"armijo", "goldstein"});
  const std::string reference = reader->Choice("reference", "monotone", {"monotone", "max", "mean"});
  if (direction == "min") tuning->solver = SICONOS_LCP_NEWTON_MIN_FBLSA;
  if (search == "goldstein") tuning->search = SICONOS_LSA_GOLDSTEIN;
  if (reference == "max") tuning->reference = NM_LS_MAX;
  if (reference == "mean") tuning->reference = NM_LS_MEAN;
}

void ReadSweeps(SettingsReader* reader, Tuning* tuning) {
  tuning->regularization = reader->Number("regularization", 0, 0, 10);
  if (tuning->regularization > 0) tuning->solver = SICONOS_LCP_RPGS;
}

void ReadBlocks(SettingsReader* reader, Tuning* tuning) {
  const std::string local = reader->Choice("local", "pgs", {"pgs", "rpgs", "lemke", "newton-fb"});
  if (local == "rpgs") tuning->local = SICONOS_LCP_RPGS;
  if (local == "lemke") tuning->local = SICONOS_LCP_LEMKE;
  if (local == "newton-fb") tuning->local = SICONOS_LCP_NEWTON_FB_FBLSA;
  tuning->local_iterations = static_cast<int>(reader->Number("local-iterations", 0, 0, 1e6));
  tuning->block_rows =
      static_cast<std::size_t>(reader->Number("block-rows", static_cast<double>(tuning->block_rows), 1, 1000));
}

template <const Method& kMethod>
std::unique_ptr<LcpSolver> Make(const Settings& settings) {
  SettingsReader reader(kMethod.key, settings);
  Tuning tuning;
  tuning.solver = kMethod.solver;
  if (!kMethod.as_the_library_has_it) {
    if (kMethod.cost_power > 0) tuning.tolerance = reader.Number("tolerance", 0, 0, 1);
    switch (kMethod.solver) {
      case SICONOS_LCP_LEMKE:
        ReadPivoting(&reader, &tuning);
        break;
      case SICONOS_LCP_NEWTON_FB_FBLSA:
        ReadNewton(&reader, &tuning);
        break;
      case SICONOS_LCP_PGS:
        ReadSweeps(&reader, &tuning);
        break;
      case SICONOS_LCP_NSGS_SBM:
        ReadBlocks(&reader, &tuning);
        break;
      default:
        break;
    }
  }
  reader.Finish();
  return std::make_unique<Siconos>(kMethod, tuning);
}

template <const Method& kMethod>
constexpr PeerSolver Entry() {
  return {kMethod.key, &Make<kMethod>};
}

constexpr std::array kSolvers{Entry<kLemke>(), Entry<kNewton>(),     Entry<kNewtonDefault>(),
                              Entry<kPgs>(),   Entry<kPgsDefault>(), Entry<kBlockGaussSeidel>(),
                              Entry<kAvi>()};

}  // namespace

PeerLibrary ThisPeerLibrary() {
  LimitLibraryThreads(1);
  return {LCPBENCH_SICONOS_VERSION, "Apache-2.0", kSolvers};
}

}  // namespace lcpbench
