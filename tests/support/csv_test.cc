#include "support/csv.h"

#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

TEST(CsvWriter, QuotesWhatNeedsQuotesAndFlushesEveryRow) {
  const std::string path = testing::TempDir() + "lcpbench_csv_test.csv";
  CsvWriter writer(path, {"a", "b"});
  writer.Row({"x,y", "say \"no\""});
  writer.Row({"", CsvWriter::Cell(0.1)});
  // While the writer is still open.
  EXPECT_EQ(ReadFile(path), "a,b\n\"x,y\",\"say \"\"no\"\"\"\n,0.1\n");
  EXPECT_THROW(writer.Row({"one cell"}), std::logic_error);
  std::filesystem::remove(path);
}

TEST(CsvWriter, NumbersReadBackToTheSameDouble) {
  for (const double value : {1.0 / 3.0, 1e-300, -2.5, 0x1.fffffffffffffp+1023}) {
    EXPECT_EQ(std::stod(CsvWriter::Cell(value)), value);
  }
  EXPECT_EQ(CsvWriter::Cell(std::numeric_limits<double>::infinity()), "inf");
}

TEST(CsvWriter, AnUnwritablePathIsTheUsersMistake) {
  EXPECT_THROW(CsvWriter("/no/such/folder/x.csv", {"a"}), InputError);
}

}  // namespace
}  // namespace lcpbench
