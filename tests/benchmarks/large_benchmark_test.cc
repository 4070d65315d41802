// The driver of large problems, run on small ones: its files can be read, what fails is a row, mistakes are told.

#include <gtest/gtest.h>

#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "command_fixture.h"
#include "solvers/registry.h"

namespace lcpbench {
namespace {

using CsvRow = std::map<std::string, std::string>;

std::vector<std::string> Fields(const std::string& line) {
  std::vector<std::string> fields(1);
  bool quoted = false;
  for (const char c : line) {
    if (c == '"') {
      quoted = !quoted;
    } else if (c == ',' && !quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  return fields;
}

std::vector<CsvRow> ReadCsv(const std::string& path) {
  std::istringstream text(ReadFile(path));
  std::string line;
  std::getline(text, line);
  const std::vector<std::string> names = Fields(line);
  std::vector<CsvRow> rows;
  while (std::getline(text, line)) {
    const std::vector<std::string> fields = Fields(line);
    EXPECT_EQ(fields.size(), names.size()) << line;
    CsvRow& row = rows.emplace_back();
    for (std::size_t k = 0; k < std::min(names.size(), fields.size()); ++k) row[names[k]] = fields[k];
  }
  return rows;
}

double Number(const CsvRow& row, const std::string& column) { return std::strtod(row.at(column).c_str(), nullptr); }

class LargeBenchmark : public CommandTest {
 protected:
  LargeBenchmark() { program_ = LCPBENCH_LARGE_BENCHMARK; }
};

TEST_F(LargeBenchmark, WritesARowPerSolverAndProblemInUnitsOfK) {
  if (!FindSolver("suitesparse").available) GTEST_SKIP() << "K needs CHOLMOD, which is not in this build";
  const CommandOutcome outcome =
      Run("--scenes disc-pile,chain-of-links --sizes 300 --seeds 1,2 --solvers nncg,auto --csv " + Path("rows.csv") +
          " --markdown " + Path("tables.md"));
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  const std::vector<CsvRow> rows = ReadCsv(Path("rows.csv"));
  ASSERT_EQ(rows.size(), 8U);
  std::set<std::string> cells;
  for (const CsvRow& row : rows) {
    cells.insert(row.at("family") + row.at("solver") + row.at("seed"));
    EXPECT_EQ(row.at("n"), "300");
    EXPECT_EQ(row.at("verdict"), "verified");
    EXPECT_LE(Number(row, "rho"), 1e-9);
    EXPECT_GT(Number(row, "floor"), 0);
    EXPECT_GT(Number(row, "active"), 0);
    EXPECT_GT(Number(row, "bodies"), 0);
    EXPECT_GT(Number(row, "k_s"), 0);
    EXPECT_NEAR(
        Number(row, "k_order_s") + Number(row, "k_analyse_s") + Number(row, "k_factor_s") + Number(row, "k_solve_s"),
        Number(row, "k_s"), 1e-6 * Number(row, "k_s"));
    EXPECT_NEAR(Number(row, "in_k") * Number(row, "k_s"), Number(row, "setup_s") + Number(row, "solve_s"), 1e-9);
    EXPECT_GT(Number(row, "peak_bytes"), 1e6);
  }
  EXPECT_EQ(cells.size(), rows.size());
  EXPECT_EQ(ReadFile(Path("tables.md")), outcome.out);
}

TEST_F(LargeBenchmark, TakesProcessorTimeWhereAsked) {
  const CommandOutcome outcome =
      Run("--cpu-time --scenes disc-pile --sizes 300 --solvers dantzig --csv " + Path("rows.csv"));
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  const std::vector<CsvRow> rows = ReadCsv(Path("rows.csv"));
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_GT(Number(rows[0], "solve_s"), 0);
}

TEST_F(LargeBenchmark, ComparesMassesSpreadOverARatioWithTheirOwn) {
  const CommandOutcome outcome =
      Run("--mass-ratio 1e6 --scenes disc-pile --sizes 200 --seeds 1,2 --solvers dantzig --csv " + Path("rows.csv"));
  ASSERT_EQ(outcome.status, 0) << outcome.error;
  std::multiset<std::string> ratios;
  for (const CsvRow& row : ReadCsv(Path("rows.csv"))) ratios.insert(row.at("mass_ratio"));
  EXPECT_EQ(ratios, (std::multiset<std::string>{"1", "1", "1e+06", "1e+06"}));
  EXPECT_NE(outcome.out.find("| dantzig | disc-pile | 200 |"), std::string::npos) << outcome.out;
}

// Nothing is left out: not what a rule excludes, nor what dies.
TEST_F(LargeBenchmark, TellsInARowWhatARuleExcludes) {
  const CommandOutcome excluded = Run("--scenes disc-pile --sizes 6000 --solvers lemke --csv " + Path("excluded.csv"));
  ASSERT_EQ(excluded.status, 0) << excluded.error;
  const std::vector<CsvRow> rows = ReadCsv(Path("excluded.csv"));
  ASSERT_EQ(rows.size(), 1U);
  EXPECT_EQ(rows[0].at("verdict"), "excluded");
  EXPECT_EQ(rows[0].at("k_s"), "");
}

TEST_F(LargeBenchmark, TellsInARowWhatDies) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer reserves more than any limit";
#endif
  // Less memory than the program itself takes.
  const CommandOutcome killed =
      Run("--scenes disc-pile --sizes 100 --solvers nncg --memory-limit 0.001 --csv " + Path("killed.csv"));
  ASSERT_EQ(killed.status, 0) << killed.error;
  ASSERT_EQ(ReadCsv(Path("killed.csv")).size(), 1U);
  EXPECT_EQ(ReadCsv(Path("killed.csv"))[0].at("verdict"), "killed");
  EXPECT_NE(ReadCsv(Path("killed.csv"))[0].at("detail"), "");
}

TEST_F(LargeBenchmark, RefusesWhatItDoesNotKnow) {
  for (const char* arguments : {"--solvers nobody", "--scenes nowhere", "--sizes 0", "--largest 10", "--tolerance 2",
                                "--time-limit 0", "--mass-ratio 0.5", "--seeds x", "--unknown", "--peers nobody",
                                "--csv /nonexistent/rows.csv", "--solve-cell {}"}) {
    const CommandOutcome outcome = Run(arguments);
    EXPECT_EQ(outcome.status, 2) << arguments;
    EXPECT_FALSE(outcome.error.empty()) << arguments;
  }
}

}  // namespace
}  // namespace lcpbench
