// Measures solvers on large problems in units of K, what an oracle would pay that is told the active set: order +
// analyse + factor + solve of the body-space matrix M + J_F^T W J_F, the cheapest of several ways (oracle.h). All scene
// families at 10^3 to 10^5 rows unless told otherwise, one row per solver and problem, summary tables at the end.
//
// Every solve and every K runs in a process of its own, on one thread: this program again, with one cell. What crashes,
// hangs or exhausts memory is a row that says so, and peak memory belongs to the one solve. Short solves are repeated
// and the fastest counts; long ones run once.
//
// --mass-ratio=1e6: 8000 rows and six seeds unless told otherwise, every problem with its own masses and with masses
// spread over that ratio (mass_spread.h).

#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "benchmarks/csv.h"
#include "benchmarks/large_study.h"
#include "benchmarks/large_tables.h"
#include "benchmarks/solver_study.h"
#include "model/scenes/scene.h"

namespace lcpbench {
namespace {

constexpr int kSmallest = 1'000;
constexpr int kLargestOfAll = 1'000'000;
constexpr int kMassStudyRows = 8'000;
constexpr std::uint64_t kMassStudySeeds = 6;

struct Arguments {
  LargeStudy study;
  std::vector<std::string> peers;
  bool all_peers = false;
  int largest = 100'000;
  double mass_ratio = 1;
  std::string csv;
  std::string markdown;
  std::string solve_cell;
  std::string oracle_cell;
};

// Standard output, and a file besides.
class Output {
 public:
  explicit Output(const std::string& path) : path_(path) {
    if (path.empty()) return;
    file_.open(path);
    if (!file_) throw InputError(path + ": cannot be opened for writing");
  }
  void Write(const std::string& text) {
    std::fputs(text.c_str(), stdout);
    std::fflush(stdout);
    if (path_.empty()) return;
    file_ << text << std::flush;
    if (!file_) throw InputError(path_ + ": writing failed");
  }

 private:
  std::string path_;
  std::ofstream file_;
};

void FillDefaults(Arguments* arguments) {
  LargeStudy& study = arguments->study;
  const bool masses = arguments->mass_ratio != 1;
  if (masses) study.mass_ratios = {1, arguments->mass_ratio};
  if (study.families.empty()) {
    for (const SceneFamily& scene : AllScenes()) study.families.emplace_back(scene.key);
  }
  if (study.sizes.empty() && masses) study.sizes = {kMassStudyRows};
  if (study.sizes.empty()) {
    if (arguments->largest < kSmallest || arguments->largest > kLargestOfAll) {
      throw InputError("--largest=" + std::to_string(arguments->largest) + ": expected " + std::to_string(kSmallest) +
                       " to " + std::to_string(kLargestOfAll) + " rows");
    }
    for (int size = kSmallest; size <= arguments->largest; size *= 10) study.sizes.push_back(size);
  }
  std::sort(study.sizes.begin(), study.sizes.end());
  if (study.seeds.empty()) {
    for (std::uint64_t seed = 1; seed <= (masses ? kMassStudySeeds : 1); ++seed) study.seeds.push_back(seed);
  }
  if (study.solvers.empty()) study.solvers = LargeOwnSolvers();
  if (arguments->all_peers && !study.sizes.empty()) arguments->peers = LargePeers(study.sizes.front());
}

void Run(Arguments arguments) {
  if (!arguments.solve_cell.empty()) return PrintSolveCell(arguments.solve_cell);
  if (!arguments.oracle_cell.empty()) return PrintOracleCell(arguments.oracle_cell);
  FillDefaults(&arguments);
  const std::vector<std::string> own = arguments.study.solvers;
  arguments.study.solvers.insert(arguments.study.solvers.end(), arguments.peers.begin(), arguments.peers.end());
  ValidateStudy(arguments.study);
  Output output(arguments.markdown);
  std::unique_ptr<CsvWriter> csv;
  if (!arguments.csv.empty()) csv = std::make_unique<CsvWriter>(arguments.csv, CsvColumns());

  output.Write(MarkdownHead());
  const bool terminal = isatty(STDERR_FILENO) != 0;
  const auto begin = [terminal](const std::string& what) {
    constexpr int kWidth = 72;  // covers what stood there
    if (terminal) std::fprintf(stderr, "%-*s\r", kWidth, what.c_str());
  };
  const auto done = [&](const std::vector<LargeRow>& rows) {
    for (const LargeRow& row : rows) {
      output.Write(MarkdownRow(row));
      if (csv != nullptr) csv->Row(CsvCells(row));
    }
  };
  const std::vector<LargeRow> rows = RunLargeStudy(arguments.study, begin, done);
  output.Write(VerifiedTable(rows, arguments.study.solvers));
  const auto counts = [](int size) { return size >= kLeastForExponent; };
  if (std::count_if(arguments.study.sizes.begin(), arguments.study.sizes.end(), counts) > 1) {
    output.Write(ExponentTable(rows, arguments.study.solvers));
  }
  if (!arguments.peers.empty()) output.Write(PeerTable(rows, own, arguments.peers));
  if (arguments.mass_ratio != 1) {
    output.Write(MassTable(rows, arguments.study.solvers, arguments.study.tolerance));
  }
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  lcpbench::Arguments arguments;
  lcpbench::LargeStudy& study = arguments.study;
  CLI::App app("Measures solvers on large problems in units of one factorisation");
  app.add_option("--solvers", study.solvers, "Solver keys [default: own ones meant for large problems]")
      ->delimiter(',');
  auto* peers = app.add_option("--peers", arguments.peers, "Keys of peers to run besides")->delimiter(',');
  app.add_flag("--all-peers", arguments.all_peers, "All peers of the build that no rule stops at the least size")
      ->excludes(peers);
  app.add_option("--scenes", study.families, "Scene keys [default: all]")->delimiter(',');
  auto* sizes = app.add_option("--sizes", study.sizes, "Numbers of rows [default: powers of ten]")->delimiter(',');
  app.add_option("--largest", arguments.largest, "Powers of ten from 1000 up to this")
      ->capture_default_str()
      ->excludes(sizes);
  app.add_option("--seeds", study.seeds, "Seeds [default: 1]")->delimiter(',');
  app.add_option("--tolerance", study.tolerance, "Bound on rho")->capture_default_str();
  app.add_option("--time-limit", study.time_limit_s,
                 "Of a solve of 10^5 rows [s]; others in proportion, at least 2 s, at most three times")
      ->capture_default_str();
  app.add_option("--memory-limit", study.memory_limit_gb, "Address space of a solve [GB]")->capture_default_str();
  app.add_flag("--cpu-time", study.cpu_time,
               "Processor time of solves and K, for a machine that does other things; peers still take wall time");
  app.add_option("--mass-ratio", arguments.mass_ratio, "Spread masses over this ratio, and compare");
  app.add_option("--csv", arguments.csv, "Write all rows to this file");
  app.add_option("--markdown", arguments.markdown, "Write the tables to this file");
  app.add_option(lcpbench::kSolveCellOption, arguments.solve_cell)->group("");
  app.add_option(lcpbench::kOracleCellOption, arguments.oracle_cell)->group("");
  return lcpbench::RunStudy(&app, argc, argv, [&] { lcpbench::Run(arguments); });
}
