// Problems of known status at extreme scales, by all own solvers: nothing false may be claimed, no solve may outlast
// its limit, and `auto` must be right. Exit status 1 where that does not hold.
//
//     attack [--friction | --nearly-dependent] [--problems N] [--first SEED] [--threads N] [--each-tier]
//     [--solvers KEY,KEY] [--limit SECONDS]
//
// --friction: with friction, sliding and bounded rows, by the solvers that take some of them. Whether there is a
// solution cannot be told of every such problem, so that `auto` may fail on them.
//
// --nearly-dependent: other problems, with two or three nearly dependent rows (nearly_dependent.h). "of a solvable"
// counts solvable ones of these that are called infeasible within rounding.
//
// Problem k has the seed SEED + k; without --each-tier it is solved at one tier, which changes from problem to problem.

#include <time.h>

#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <mutex>
#include <sstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "solvers/rows/row_input.h"
#include "solvers/step/step_solver.h"
#include "tests/attack/attack_problem.h"
#include "tests/attack/nearly_dependent.h"
#include "tests/solvers/solve_with.h"

namespace lcpbench {
namespace {

struct Plan {
  unsigned first = 1;
  unsigned problems = 100;
  unsigned threads = 1;
  bool each_tier = false;
  bool friction = false;
  bool nearly_dependent = false;
  double limit_s = 2;
  std::string solvers;  // "": all
};

struct Solver {
  std::string key;
  std::function<LcpResult(const LcpProblem&, const LcpOptions&)> solve;  // by an object of its own
};

// By StepSolver::SolveBatch where rows act on at most two bodies, else by `auto`. Its answers carry no ray: that of
// `auto` stands for it.
LcpResult SolveInLanes(const LcpProblem& problem, const LcpOptions& options) {
  LcpOptions cold = options;
  cold.initial_f = nullptr;
  if (problem.has_factors()) {
    const ProblemArrays arrays = ProblemArrays::Of(problem);
    TwoBodyCopy copy;
    if (copy.Take(arrays)) {
      LcpResult result;
      result.f.resize(problem.size());
      StepSolver solver({.tolerance = options.tolerance, .time_limit_s = options.time_limit_s});
      const std::array<std::int32_t, 2> start{0, static_cast<std::int32_t>(problem.size())};
      StepAnswer answer;
      solver.SolveBatch(copy.rows(), start, result.f.data(), {&answer, 1});
      result.status = answer.status;
      if (result.status != LcpStatus::kInfeasible) return result;
    }
  }
  return SolveWith(MakeSolver("auto").get(), problem, cold);
}

std::vector<Solver> SolversOf(const Plan& plan) {
  std::vector<Solver> solvers;
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.origin != SolverOrigin::kOwn || !entry.available) continue;
    if (!plan.friction && !entry.takes_plain) continue;
    if (plan.friction && !entry.takes_friction && !entry.takes_bounded) continue;
    solvers.push_back({entry.key, [make = entry.make](const LcpProblem& problem, const LcpOptions& options) {
                         return SolveWith(make({}).get(), problem, options);
                       }});
  }
  if (!plan.friction) solvers.push_back({"batch", &SolveInLanes});
  if (!plan.solvers.empty()) {
    const std::string wanted = "," + plan.solvers + ",";
    std::erase_if(solvers,
                  [&](const Solver& solver) { return wanted.find("," + solver.key + ",") == std::string::npos; });
  }
  return solvers;
}

enum Outcome {
  kSolved,
  kProved,
  kWithinRounding,
  kOfSolvable,
  kHonestFailure,
  kRefused,
  kFalseSuccess,
  kWrongInfeasible,
  kOverLimit,
  kNotRight,
  kOutcomes
};
constexpr std::array<const char*, kOutcomes> kNames{"solved",         "proved",   "within rounding", "of a solvable",
                                                    "honest failure", "refused",  "false success",   "wrong infeasible",
                                                    "over the limit", "not right"};

// Processor time of this thread, for the limit too: what else runs on the machine does not count.
double CpuSeconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Outcome Judge(const AttackProblem& attack, const Solver& solver, const LcpResult& result, double tier) {
  const Verdict verdict = Verify(attack.test.problem, result, tier, &attack.test.reference);
  if (verdict.false_success) return kFalseSuccess;
  if (result.status == LcpStatus::kSolved) return kSolved;
  if (result.status == LcpStatus::kInfeasible) {
    if (!verdict.farkas || !verdict.farkas->accepted) return kWrongInfeasible;
    if (verdict.farkas->proved) return verdict.false_infeasible ? kWrongInfeasible : kProved;
    if (!verdict.false_infeasible) return kWithinRounding;
    return attack.is_nearly_infeasible ? kOfSolvable : kWrongInfeasible;
  }
  const bool is_known =
      attack.test.problem.is_plain() && attack.test.reference.status != LcpReference::Status::kUnknown;
  const bool must_be_right = is_known && (solver.key == "auto" || solver.key == "batch");
  if (result.status == LcpStatus::kUnsupported && !must_be_right) return kRefused;
  const bool may_fail = !must_be_right || (attack.may_fail && result.status == LcpStatus::kNumericalFailure);
  return may_fail ? kHonestFailure : kNotRight;
}

class Attack {
 public:
  explicit Attack(const Plan& plan) : plan_(plan), solvers_(SolversOf(plan)), counts_(solvers_.size()) {}

  bool Run() {
    std::vector<std::thread> threads;
    for (unsigned t = 0; t < plan_.threads; ++t) {
      threads.emplace_back([this] {
        for (unsigned k = next_++; k < plan_.problems; k = next_++) AttackWith(plan_.first + k);
      });
    }
    for (std::thread& thread : threads) thread.join();
    return Print();
  }

 private:
  void AttackWith(unsigned seed) {
    const AttackProblem attack =
        plan_.nearly_dependent ? MakeNearlyDependentProblem(seed) : MakeAttackProblem(seed, plan_.friction);
    std::vector<double> tiers(std::begin(kTiers), std::end(kTiers));
    if (!plan_.each_tier) tiers = {kTiers[seed % std::size(kTiers)]};
    LcpOptions options{.time_limit_s = plan_.limit_s};
    options.now = &CpuSeconds;
    if (attack.start) options.initial_f = &*attack.start;
    for (size_t s = 0; s < solvers_.size(); ++s) {
      for (const double tier : tiers) {
        // Not the forms that another solver has asked for.
        const LcpProblem problem = attack.test.problem.CopyOfGivenForm();
        options.tolerance = tier;
        const double start = CpuSeconds();
        const LcpResult result = solvers_[s].solve(problem, options);
        const double seconds = CpuSeconds() - start;
        // A look at the clock may come late, but not for long.
        const Outcome outcome = seconds > 2 * plan_.limit_s + 1 ? kOverLimit : Judge(attack, solvers_[s], result, tier);
        Count(s, outcome, seconds);
        if (outcome < kFalseSuccess) continue;
        std::ostringstream text;
        text << kNames[outcome] << " at " << tier << ": " << result.status << " after " << seconds << " s; "
             << result.detail << "; " << Verify(attack.test.problem, result, tier, &attack.test.reference).reason;
        Tell(attack, solvers_[s].key, text.str());
      }
    }
  }

  void Count(size_t solver, Outcome outcome, double seconds) {
    const std::lock_guard lock(mutex_);
    ++counts_[solver].of[outcome];
    counts_[solver].seconds += seconds;
  }

  void Tell(const AttackProblem& attack, const std::string& who, const std::string& what) {
    const std::lock_guard lock(mutex_);
    ++findings_;
    std::printf("%s (n = %td): %s: %s\n", attack.test.problem.id().c_str(), attack.test.problem.size(), who.c_str(),
                what.c_str());
    std::fflush(stdout);
  }

  bool Print() const {
    std::printf("%-18s", "solver");
    for (const char* name : kNames) std::printf(" %16s", name);
    std::printf(" %10s\n", "seconds");
    for (size_t s = 0; s < solvers_.size(); ++s) {
      std::printf("%-18s", solvers_[s].key.c_str());
      for (const long count : counts_[s].of) std::printf(" %16ld", count);
      std::printf(" %10.1f\n", counts_[s].seconds);
    }
    std::printf("%u problems from seed %u: %ld findings\n", plan_.problems, plan_.first, findings_);
    return findings_ == 0;
  }

  struct Tally {
    std::array<long, kOutcomes> of{};
    double seconds = 0;
  };
  const Plan plan_;
  const std::vector<Solver> solvers_;
  std::atomic<unsigned> next_ = 0;
  std::mutex mutex_;
  std::vector<Tally> counts_;
  long findings_ = 0;
};

int Main(int argc, char** argv) {
  Plan plan;
  const auto number = [](const char* text) { return static_cast<unsigned>(std::strtoul(text, nullptr, 10)); };
  for (int i = 1; i < argc; ++i) {
    const std::string_view option = argv[i];
    if (option == "--each-tier") {
      plan.each_tier = true;
      continue;
    }
    if (option == "--friction") {
      plan.friction = true;
      continue;
    }
    if (option == "--nearly-dependent") {
      plan.nearly_dependent = true;
      continue;
    }
    if (i + 1 == argc) return std::fprintf(stderr, "attack: unknown option %s\n", argv[i]), 2;
    const char* value = argv[++i];
    if (option == "--problems") {
      plan.problems = number(value);
    } else if (option == "--first") {
      plan.first = number(value);
    } else if (option == "--threads") {
      plan.threads = number(value);
    } else if (option == "--solvers") {
      plan.solvers = value;
    } else if (option == "--limit") {
      plan.limit_s = std::strtod(value, nullptr);
    } else {
      return std::fprintf(stderr, "attack: unknown option %s\n", argv[i - 1]), 2;
    }
  }
  return Attack(plan).Run() ? 0 : 1;
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) { return lcpbench::Main(argc, argv); }
