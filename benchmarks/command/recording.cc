#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/collection/recording.h"
#include "benchmarks/command/commands.h"
#include "benchmarks/command/options.h"
#include "solvers/io/json_lines.h"

namespace lcpbench {
namespace {

struct RecordingProblems {
  std::vector<std::string> files;
  std::string level = "velocity";
  Index island_rows = 0;
  std::string output = "-";

  void Declare(CLI::App& app) {
    app.add_option("FILE", files, "Recordings, plain or gzip; - for standard input")->required();
    app.add_option("--level", level,
                   "velocity: the engine's time step without friction; friction: with it; acceleration: without it, "
                   "where all contacts are of circles")
        ->check(CLI::IsMember({"velocity", "friction", "acceleration"}))
        ->capture_default_str();
    app.add_option("--island-rows", island_rows, "Islands of at least so many rows, each a problem; 0: whole scenes")
        ->check(AtLeast(0))
        ->capture_default_str();
    app.add_option("-o,--output", output, "File of JSON lines")->capture_default_str();
    app.footer("Steps without a row, and at the acceleration level those with other contacts or joints, are left out.");
  }

  int Run() const {
    TextOrGzipOutput lines(output);
    const RecordedLevel wanted =
        std::ranges::find_if(kRecordedLevels, [&](const auto& named) { return named.first == level; })->second;
    std::optional<RecordingHeader> header;
    bool is_first = true;
    const auto write = [&lines](const RecordedProblem& made) {
      if (made.problem.size() > 0) lines.stream() << FormatLcpRecord(made.problem, false) << '\n';
    };
    int status = 0;
    for (const std::string& file : files) {
      header.reset();
      is_first = true;
      status = std::max(status, ForEachLine({file}, [&](const std::string& line, const std::string& where) {
                          if (std::exchange(is_first, false)) {
                            header = ParseRecordingHeader(line, where);
                            return;
                          }
                          // Without a header, which was reported, steps cannot be read.
                          if (!header.has_value()) return;
                          const RecordedStep step = ParseRecordedStep(line, *header, where);
                          const std::optional<RecordedProblem> whole = MakeRecorded(*header, step, wanted);
                          if (!whole.has_value()) return;
                          if (island_rows == 0) return write(*whole);
                          for (const RecordedProblem& island : IslandsOf(*whole, island_rows)) write(island);
                        }));
    }
    lines.Close();
    return status;
  }
};

}  // namespace

void AddRecordingCommand(CLI::App& app, CommandRun& run) {
  AddCommand<RecordingProblems>(app, run, "recording", "Makes problems from recordings of other engines' scenes");
}

}  // namespace lcpbench
