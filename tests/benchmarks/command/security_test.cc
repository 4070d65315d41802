// What SECURITY.md says of files that others have made.

#include "solvers/io/gzip_file.h"
#include "solvers/registry.h"
#include "support/subprocess.h"
#include "tests/benchmarks/command/command_fixture.h"

namespace lcpbench {
namespace {

class Security : public CommandTest {
 protected:
  // Everything that is in the test's folder, which has the folder `in` that commands are given.
  std::size_t Outside() const {
    std::size_t count = 0;
    for (const auto& entry : fs::recursive_directory_iterator(folder_)) {
      const std::string name = entry.path().lexically_relative(folder_).string();
      count += name.starts_with("in/") || name.starts_with("std") ? 0 : 1;
    }
    return count;
  }
  Json Manifest(const Json& problem) const {
    return {{"lcpbench_manifest", 1}, {"name", "set"}, {"version", "1"}, {"problems", {problem}}};
  }
};

constexpr char kSmallProblem[] = R"({"id":"p","b":[1],"A":[[1]]})";
const std::string kHash(64, '0');

TEST_F(Security, AManifestNamesFilesOfItsOwnFolderOnly) {
  fs::create_directory(folder_ / "in");
  Write("outside.jsonl", std::string(kSmallProblem) + "\n");
  for (const std::string& path :
       {std::string("../outside.jsonl"), Path("outside.jsonl"), std::string("a/../../outside.jsonl")}) {
    const Json problem = {
        {"id", "p"}, {"family", "f"}, {"file", {{"path", path}, {"line", 1}}}, {"rows", 1}, {"sha256", kHash}};
    Write("in/m.json", Manifest(problem).dump());
    ExpectMistake("collection write " + Path("in/m.json"),
                  "/problems/0/file/path: expected a path within the manifest's folder");
    Json named = Manifest(problem);
    named["problems"] = Json::array();
    named["references"] = path;
    Write("in/m.json", named.dump());
    ExpectMistake("collection write " + Path("in/m.json"), "/references: expected a path within the manifest's folder");
  }
}

TEST_F(Security, TheIdOfASequenceCannotNameAFileElsewhere) {
  const Json source = ReadJson(LCPBENCH_SOURCE_DIR "/data/sequences.json");
  Json manifest = Manifest({});
  manifest["problems"] = Json::array();
  for (const std::string id : {"../../x", "/tmp/x", "a/b", ".x", "a\nb", ""}) {
    manifest["sequences"] = {source["sequences"][0]};
    manifest["sequences"][0]["id"] = id;
    Write("m.json", manifest.dump());
    ExpectMistake("run --benchmark_list_tests --suite " + Path("m.json"), "/sequences/0/id: expected ");
  }
}

TEST_F(Security, ACampaignsFolderHasNoLinks) {
  const std::string campaign =
      "run --suite " LCPBENCH_SOURCE_DIR
      "/data/smoke.json --tiers 1e-6 --launches 1 --no-fills --filter n8 --solvers dantzig -o " +
      Path("in");
  for (const std::string file : {"campaign.json", "streams.jsonl", "sequences", "campaign.lock"}) {
    fs::create_directory(folder_ / "in");
    fs::create_symlink(folder_ / "elsewhere", folder_ / "in" / file);
    ExpectMistake(campaign, file + ": is a symbolic link");
    EXPECT_EQ(Outside(), 1U);  // `in`
    fs::remove_all(folder_ / "in");
  }
}

TEST_F(Security, IdsNameFilesOfTheFolderThatIsGiven) {
  fs::create_directory(folder_ / "in");
  Write("stdproblems.jsonl", R"({"id":"../../../x","b":[1],"A":[[1]]})"
                             "\n"
                             R"({"id":"/tmp/x","b":[1],"A":[[1]]})"
                             "\n");
  for (const std::string format : {"mtx", "dat"}) {
    Succeed("convert " + Path("stdproblems.jsonl") + " --to " + format + " -o " + Path("in"));
  }
  EXPECT_EQ(Outside(), 1U);
  EXPECT_TRUE(fs::exists(folder_ / "in/_.._.._.._x.dat") && fs::exists(folder_ / "in/_tmp_x.dat"));
}

TEST_F(Security, ALineThatUnpacksToMoreThanTheMemoryIsRefused) {
  if (SanitizerReservesMemory()) GTEST_SKIP() << "their address space cannot be limited";
  WriteGzipFile(Path("bomb.jsonl.gz"), R"({"b":[)" + std::string(std::size_t{1} << 28U, '1') + "]}\n");
  EXPECT_LT(fs::file_size(folder_ / "bomb.jsonl.gz"), std::uintmax_t{1} << 20U);
  Write("small.sh", "ulimit -v 2000000\nexec " + program_ + " \"$@\"\n");
  program_ = "sh " + Path("small.sh");
  ExpectMistake("solve --solver pgs " + Path("bomb.jsonl.gz"), "bomb.jsonl.gz:1: a line of this length needs ");
  fs::copy(folder_ / "bomb.jsonl.gz", folder_ / "bomb_b.mtx.gz");
  ExpectMistake("solve --solver pgs " + Path("bomb.mtx.gz"), "bomb_b.mtx.gz:1: a line of this length needs ");
}

// OpenBLAS spins where it gets no memory, for its threads at load or for its buffer at its first product.
TEST_F(Security, CommandsEndWithLittleAddressSpace) {
  if (SanitizerReservesMemory()) GTEST_SKIP() << "their address space cannot be limited";
  Write("p.jsonl", R"({"id":"a","n":2,"A":[[4,1],[1,3]],"b":[-1,-2]})");
  Write("small.sh", "ulimit -v $1\nshift\nexec timeout 60 " + program_ + " \"$@\"\n");
  program_ = "sh " + Path("small.sh");
  for (const std::string kilobytes : {"150000 ", "200000 ", "300000 ", "400000 "}) {
    Succeed(kilobytes + "list rules");
    for (const char* solver : {"auto", "bpp", "pgs"}) {
      Succeed(kilobytes + "solve --solver " + solver + " " + Path("p.jsonl"));
    }
    if (!FindSolver("ipopt-qp").available) continue;
    const CommandOutcome run = Run(kilobytes + "solve --solver ipopt-qp " + Path("p.jsonl"));
    const bool refused = run.status == 2 && run.error.find("OpenBLAS needs ") != std::string::npos;
    EXPECT_TRUE(refused || run.status == 0) << kilobytes << run.status << run.error;
  }
}

}  // namespace
}  // namespace lcpbench
