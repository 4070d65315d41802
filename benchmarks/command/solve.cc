#include <iostream>
#include <string>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "benchmarks/measure/reference_solves.h"
#include "solvers/io/json_lines.h"
#include "solvers/lcp/verify.h"
#include "solvers/peers/protocol/external_solver.h"
#include "solvers/pivoting/least_norm.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

struct Solve {
  std::string key;
  LcpOptions options;
  bool relative_to_floor = false;
  bool least_norm = false;
  bool summary = false;
  std::vector<std::string> settings;
  NamedSolvers named;
  std::vector<std::string> files;
  ReadingOptions reading;

  void Declare(CLI::App& app) {
    app.add_option("--solver", key, "Solver key (lcpbench list solvers)")->required();
    AddToleranceOption(app, &options.tolerance);
    AddTimeLimitOption(app, &options.time_limit_s);
    app.add_option("--max-iterations", options.max_iterations, "In the solver's unit; 0 = its default")
        ->check(AtLeast(0));
    app.add_flag("--floor", relative_to_floor,
                 "Judge by the larger of tolerance and the problem's rounding floor, which a reference solve finds");
    app.add_flag("--least-norm", least_norm,
                 "Of all solutions the one of least norm, where the solver's answer passes; up to " +
                     std::to_string(kMostRowsOfLeastNorm) + " rows");
    app.add_flag("--summary", summary, "How many answers pass, fail and are refused, instead of the answers");
    AddSettingsOption(app, &settings);
    app.add_option(
           "FILE", files,
           "JSON lines, - for standard input; name.mtx with name_b.mtx beside it; Siconos' name.dat; a quadratic "
           "program's name.qps (or .mps); all of them also with .gz; name.npz of qpsolvers; FCLib's name.hdf5 (or .h5)")
        ->required();
    AddReadingOptions(app, &reading);
    named.Declare(app);
  }

  int Run() const {
    named.Register();
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key, ParseSettings(settings));
    if (auto* external = dynamic_cast<ExternalSolver*>(solver.get())) external->Greet();
    Counts counts;
    const int status = ForEachProblem(files, reading, [&](const LcpRecord& record) {
      LcpResult result;
      const double start = SteadyNow();
      solver->Prepare(record.problem);
      const double prepared = SteadyNow();
      solver->Solve(record.problem, options, &result);
      const double wall = SteadyNow() - prepared;
      const double solve_s = result.own_solve_s >= 0 ? result.own_solve_s : wall;
      LcpReference reference = record.reference;
      if (relative_to_floor) {
        reference.floor = FindReferenceFloor(record.problem, options.tolerance, options.time_limit_s);
      }
      SolveNotes notes;
      notes.setup_s = prepared - start;
      notes.time_s = solve_s;
      if (least_norm) {
        const LeastNormOptions of_least_norm{.tolerance = options.tolerance, .time_limit_s = options.time_limit_s};
        const auto found = TakeLeastNorm(record.problem, of_least_norm, &result);
        if (found.has_value()) notes.least_norm = {found->nullity, found->rank_tolerance};
      }
      const Verdict verdict = Verify(record.problem, result, options.tolerance, &reference);
      if (summary) return counts.Add(result, verdict, reference);
      if (verdict.passes) notes.f_unique = IsOnlyAnswer(record.problem, result.f, options.tolerance);
      std::cout << FormatSolveRecord(record, key, result, verdict, notes) << std::endl;
    });
    if (summary) {
      std::cout << key << " at " << options.tolerance << ": " << counts.right << " right of " << counts.taken
                << " that may have a solution, " << counts.false_success << " false successes, "
                << counts.false_infeasible << " false claims of none; " << counts.refused << " refused" << std::endl;
    }
    return status;
  }

 private:
  struct Counts {
    int taken = 0, right = 0, refused = 0, false_success = 0, false_infeasible = 0;

    void Add(const LcpResult& result, const Verdict& verdict, const LcpReference& reference) {
      if (result.status == LcpStatus::kUnsupported) {
        ++refused;
        return;
      }
      if (reference.status != LcpReference::Status::kInfeasible) ++taken;
      if (verdict.passes) ++right;
      if (verdict.false_success) ++false_success;
      if (verdict.false_infeasible) ++false_infeasible;
    }
  };
};

}  // namespace

void AddSolveCommand(CLI::App& app, CommandRun& run) {
  AddCommand<Solve>(app, run, "solve", "Solves LCPs from files and judges every answer");
}

}  // namespace lcpbench
