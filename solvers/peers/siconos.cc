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

#include <NonSmoothDrivers.h>
#include <SolverOptions.h>
#include <fcntl.h>
#include <lcp_cst.h>
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

#include "solvers/library_threads.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/siconos_problem.h"
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

class Siconos : public LcpSolver {
 public:
  Siconos(const Method& method, double tolerance) : method_(method), tolerance_(tolerance) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override { problem_.emplace(problem, method_.storage); }

  void DoSolve(const LcpProblem& /*problem*/, const LcpOptions& options, LcpResult* result) override {
    OptionsPointer own(nullptr, &solver_options_delete);
    Eigen::VectorXd z;
    Eigen::VectorXd w;
    TimeConversion(result, [&] {
      own = MakeOptions(options);
      z = options.initial_f != nullptr ? problem_->VariablesOf(*options.initial_f)
                                       : Eigen::VectorXd(Eigen::VectorXd::Zero(problem_->size()));
      w.setZero(problem_->size());
    });
    const Deadline deadline(options);
    {
      const Silence silence;
      TimeLibraryCall(result, [&] { Run(*own, deadline, &z, &w, result); });
    }
    TimeConversion(result, [&] { problem_->SetForces(z, &result->f); });
  }

 private:
  // About 20 ms of work: short beside any time limit, long beside what a call costs of itself.
  static constexpr double kPortion = 2e7;      // products
  static constexpr double kPerRow = 500;       // products that take as long as a row's solve without them
  static constexpr std::int64_t kFewest = 16;  // sweeps, of a method that does not tell how many it made

  OptionsPointer MakeOptions(const LcpOptions& options) const {
    OptionsPointer own(solver_options_create(method_.solver), &solver_options_delete);
    if (method_.solver == SICONOS_LCP_NSGS_SBM) solver_options_update_internal(own.get(), 0, SICONOS_LCP_PGS);
    std::int64_t most = own->iparam[SICONOS_IPARAM_MAX_ITER];
    if (!method_.as_the_library_has_it && method_.cost_power > 0) {
      own->dparam[SICONOS_DPARAM_TOL] =
          tolerance_ > 0 ? tolerance_ : TierValue(method_.key, "tolerance", options.tolerance);
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
  double tolerance_;  // 0: by the table of tier_settings.cc
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

template <const Method& kMethod>
std::unique_ptr<LcpSolver> Make(const Settings& settings) {
  SettingsReader reader(kMethod.key, settings);
  double tolerance = 0;
  if (!kMethod.as_the_library_has_it && kMethod.cost_power > 0) tolerance = reader.Number("tolerance", 0, 0, 1);
  reader.Finish();
  return std::make_unique<Siconos>(kMethod, tolerance);
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
