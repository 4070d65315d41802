// By how much solvers exceed their time limit, on problems that take them several times as long: for every solver and
// limit the median and the largest overshoot over scene families and repetitions, and the share within what is allowed,
// 10 % of the limit or 20 us, whichever is more. The solvers' clock is the thread's CPU time here, so that what else
// the machine does meanwhile does not count (--wall-clock: it does).
//
// For each family the least number of rows is taken that keeps the solver busy for kLonger times the limit; where there
// is none, the family is left out.

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "model/contact/assembly.h"
#include "model/scenes/scene.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

constexpr double kLonger = 3;
// Of what a problem takes without a limit, no more is measured than this [s]: it is long enough for every limit.
constexpr double kLongEnough = 0.1;
constexpr double kTolerance = 1e-9;
constexpr double kAllowedPart = 0.1;
constexpr double kAllowedLeast = 20e-6;

struct Arguments {
  std::vector<std::string> solvers;
  // Isostatic, redundant, dense, and with joints.
  std::vector<std::string> scenes = {"disc-pile", "rounded-wall", "roller-bearing", "gear-train"};
  std::vector<int> sizes = {30, 100, 300, 1000, 3000, 10000};
  std::vector<double> limits_us = {20, 100, 1000, 10000};
  int repetitions = 20;
  bool wall_clock = false;
};

// Keys of the own solvers of this build, in the registry's order.
std::vector<std::string> AvailableOwnSolvers() {
  std::vector<std::string> keys;
  for (const SolverEntry& entry : AllSolvers()) {
    if (entry.available && entry.origin == SolverOrigin::kOwn) keys.push_back(entry.key);
  }
  return keys;
}

class Problems {
 public:
  const LcpProblem& Get(const std::string& scene, int size) {
    const auto [it, is_new] = problems_.try_emplace({scene, size});
    if (is_new) it->second = std::make_unique<LcpProblem>(AssembleContactLcp(GenerateScene(scene, size, 1)).problem);
    return *it->second;
  }

 private:
  std::map<std::pair<std::string, int>, std::unique_ptr<LcpProblem>> problems_;
};

double ThreadTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

double SolveFor(LcpSolver* solver, const LcpProblem& problem, double limit_s, double (*now)(), LcpResult* result) {
  LcpOptions options;
  options.now = now;
  options.tolerance = kTolerance;
  options.time_limit_s = limit_s;
  const double start = now();
  solver->Solve(problem, options, result);
  return now() - start;
}

// Seconds over the limit, ascending.
std::vector<double> Overshoots(const SolverEntry& entry, double limit_s, const Arguments& arguments,
                               Problems* problems) {
  double (*const now)() = arguments.wall_clock ? &SteadyNow : &ThreadTime;
  std::vector<double> over;
  for (const std::string& scene : arguments.scenes) {
    for (const int size : arguments.sizes) {
      const LcpProblem& problem = problems->Get(scene, size);
      const std::unique_ptr<LcpSolver> solver = entry.make({});
      solver->Prepare(problem);
      LcpResult result;
      if (SolveFor(solver.get(), problem, kLongEnough, now, &result) < kLonger * limit_s) continue;
      for (int k = 0; k < arguments.repetitions; ++k) {
        const double seconds = SolveFor(solver.get(), problem, limit_s, now, &result);
        if (result.status == LcpStatus::kTimeLimit) over.push_back(seconds - limit_s);
      }
      break;
    }
  }
  std::sort(over.begin(), over.end());
  return over;
}

void Run(Arguments arguments) {
  if (arguments.solvers.empty()) arguments.solvers = AvailableOwnSolvers();
  std::printf("Microseconds over the limit: median, largest, share within %g %% or %g us\n%-18s", 100 * kAllowedPart,
              1e6 * kAllowedLeast, "solver");
  for (const double limit : arguments.limits_us) std::printf("%18g us limit ", limit);
  std::printf("\n");
  Problems problems;
  for (const std::string& key : arguments.solvers) {
    std::printf("%-18s", key.c_str());
    for (const double limit : arguments.limits_us) {
      const std::vector<double> over = Overshoots(FindSolver(key), 1e-6 * limit, arguments, &problems);
      if (over.empty()) {
        std::printf("%28s", "-");
        continue;
      }
      const double allowed = std::max(kAllowedLeast, kAllowedPart * 1e-6 * limit);
      const auto within = std::upper_bound(over.begin(), over.end(), allowed) - over.begin();
      std::printf("%10.1f %10.1f %4.0f %% ", 1e6 * over[over.size() / 2], 1e6 * over.back(),
                  100 * static_cast<double>(within) / static_cast<double>(over.size()));
      std::fflush(stdout);
    }
    std::printf("\n");
  }
}

// Parses and runs. Exit status 2 and one line on standard error for a user's mistake, as the command does.
int RunStudy(CLI::App* app, int argc, char** argv, const std::function<void()>& run) {
  constexpr int kMisuse = 2;
  try {
    app->parse(argc, argv);
    run();
  } catch (const CLI::ParseError& error) {
    return app->exit(error) == 0 ? 0 : kMisuse;
  } catch (const InputError& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return kMisuse;
  }
  return 0;
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  lcpbench::Arguments arguments;
  CLI::App app("Measures by how much solvers exceed their time limit");
  app.add_option("--solvers", arguments.solvers, "Solver keys [default: all own]")->delimiter(',');
  app.add_option("--scenes", arguments.scenes, "Scene keys")->delimiter(',')->capture_default_str();
  app.add_option("--sizes", arguments.sizes, "Numbers of rows to choose from")->delimiter(',')->capture_default_str();
  app.add_option("--limits", arguments.limits_us, "Time limits [us]")->delimiter(',')->capture_default_str();
  app.add_option("--repetitions", arguments.repetitions, "Solves per scene and limit")->capture_default_str();
  app.add_flag("--wall-clock", arguments.wall_clock, "Wall-clock time instead of the thread's");
  return lcpbench::RunStudy(&app, argc, argv, [&] { lcpbench::Run(arguments); });
}
