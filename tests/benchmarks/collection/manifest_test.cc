#include "benchmarks/collection/manifest.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "benchmarks/collection/build.h"
#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/plan.h"
#include "benchmarks/collection/sequences.h"
#include "benchmarks/gzip_input.h"
#include "model/scenes/scene.h"
#include "solvers/lcp/input_error.h"
#include "solvers/lcp/json_lines.h"
#include "solvers/lcp/matrix_market.h"

namespace lcpbench {
namespace {

std::string TierPath(const std::string& tier) { return LCPBENCH_SOURCE_DIR "/data/" + tier + ".json"; }

std::string WriteTemporary(const std::string& name, const std::string& text) {
  const std::string path = (std::filesystem::path(testing::TempDir()) / name).string();
  std::ofstream(path) << text;
  return path;
}

// ----- hashes

// Hashes made from the bytes of content_hash.h by Python's hashlib.
TEST(ContentHash, IsOfTheDocumentedBytes) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(2, 6);
  J(0, 1) = 1.5;
  J(0, 3) = -1;
  J(1, 2) = 0.25;
  Eigen::VectorXd inverse_mass(6);
  inverse_mass << 0, 1, 2, 0.5, 0.5, 4;
  const Eigen::Vector2d b(-1, 3);
  const auto factors = LcpProblem::FromFactors("any", SparseMatrix(J.sparseView()), inverse_mass, b,
                                               RowBounds::WithBilateralRows(2, {1}));
  EXPECT_EQ(ContentHash(factors), "7be6e26d6389a6421161f2c941be133e54499fd1d792bb44d41a33c597c26436");
  Eigen::MatrixXd A(2, 2);
  A << 2, 1, 1, 3;
  EXPECT_EQ(ContentHash(LcpProblem::FromDense("any", A, b)),
            "f1853315b004ece9cfaa026ad5413347c71640d81f92c8d44a8d41ce87730587");
  EXPECT_EQ(ContentHash(LcpProblem::FromSparse("any", SparseMatrix(A.sparseView()), b)),
            "cd374aa5c0e7126fff99a322a7890355945b99ab75e3913f776eb91cc31fb61a");
}

TEST(ContentHash, IsOfTheContentWhateverItsNameAndFile) {
  std::set<std::string> hashes;
  for (const SceneFamily& scene : AllScenes()) {
    const LcpProblem problem = MakeInstance({std::string(scene.key), 14, 1, {}}).problem;
    const std::string hash = ContentHash(problem);
    EXPECT_TRUE(hashes.insert(hash).second);
    const LcpProblem line = ParseLcpRecord(FormatLcpRecord(problem), "line").problem;
    EXPECT_EQ(ContentHash(line), hash);
    const std::string path = (std::filesystem::path(testing::TempDir()) / "hashed.mtx").string();
    WriteMarketProblem(problem, path);
    EXPECT_EQ(ContentHash(ReadMarketProblem(path).problem), hash);
    // One bit of one number.
    Eigen::VectorXd b = problem.b();
    b[3] = std::nextafter(b[3], 1e300);
    const auto bounds = RowBounds::WithBilateralRows(problem.size(), problem.bilateral_rows());
    EXPECT_NE(ContentHash(LcpProblem::FromFactors("", problem.J(), problem.inverse_mass(), b, bounds)), hash);
  }
}

// ----- manifests

TEST(Manifest, IsReadAsItWasWritten) {
  Tier tier = PlanTier("smoke");
  tier.problems.resize(6);
  tier.problems[1].recipe.changes = {{"mass-ratio", 1e4}, {"slack", 0.25}};
  tier.problems[1].grid = "mass ratio";
  tier.problems[2].purpose = "Nothing.";
  tier.sequences.push_back({{"rockers", 5, 3, {}}, 100});
  const BuiltTier built = BuildTier(tier, {}, nullptr, [](int, int, const std::string&) {});
  ASSERT_EQ(built.manifest.problems.size(), 6U);
  const Manifest read = ReadManifest(WriteTemporary("round.json", FormatManifest(built.manifest)));
  EXPECT_EQ(read.name, "smoke");
  EXPECT_EQ(read.version, kCollectionVersion);
  ASSERT_EQ(read.problems.size(), 6U);
  ProblemSource source("");
  for (size_t k = 0; k < read.problems.size(); ++k) {
    const ManifestEntry& a = built.manifest.problems[k];
    const ManifestEntry& b = read.problems[k];
    EXPECT_EQ(b.id, a.id);
    EXPECT_EQ(b.grid, a.grid);
    EXPECT_EQ(b.purpose, a.purpose);
    EXPECT_EQ(std::get<Recipe>(b.source), std::get<Recipe>(a.source));
    EXPECT_EQ(b.sha256, a.sha256);
    EXPECT_EQ(ContentHash(source.Get(b)), b.sha256);
  }
  ASSERT_EQ(read.sequences.size(), 1U);
  EXPECT_EQ(read.sequences[0].start, built.manifest.sequences[0].start);
  EXPECT_EQ(read.sequences[0].sha256, MeasureSequence(read.sequences[0].start, 100).sha256);
}

TEST(Manifest, OfAnotherFormIsRefusedInOneLine) {
  const std::string hash(64, '0');
  const std::string problem =
      R"({"id":"a","family":"f","recipe":{"scene":"rockers","rows":3,"seed":1},"rows":3,"sha256":")" + hash + "\"}";
  const auto with = [](const std::string& problems) {
    return R"({"lcpbench_manifest":1,"name":"n","version":"1","problems":[)" + problems + "]}";
  };
  EXPECT_EQ(ReadManifest(WriteTemporary("good.json", with(problem))).problems.size(), 1U);
  const auto replaced = [&](const std::string& from, const std::string& to) {
    std::string text = with(problem);
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const std::pair<std::string, std::string> kBad[] = {
      {"", ""},
      {"[]", ""},
      {replaced("manifest\":1", "manifest\":2"), "/lcpbench_manifest"},
      {replaced("\"id\":\"a\"", "\"id\":7"), "/problems/0/id"},
      {replaced("\"seed\":1", "\"seed\":-1"), "/problems/0/recipe/seed"},
      {replaced("\"seed\":1", "\"seed\":0.5"), "/problems/0/recipe/seed"},
      {replaced("\"rows\":3,\"seed\"", "\"rows\":0,\"seed\""), "/problems/0/recipe/rows"},
      {replaced(hash, "beef"), "/problems/0/sha256"},
      {with(problem + "," + problem), "/problems/1/id"},
  };
  for (const auto& [text, place] : kBad) {
    const std::string path = WriteTemporary("bad.json", text);
    try {
      ReadManifest(path);
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      const std::string what = error.what();
      EXPECT_EQ(what.rfind(path, 0), 0U) << what;
      EXPECT_NE(what.find(place), std::string::npos) << what;
      EXPECT_EQ(what.find('\n'), std::string::npos) << what;
    }
  }
  EXPECT_THROW(ReadManifest("no/such/file.json"), InputError);
}

// ----- the collection

class CollectionTier : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Tiers, CollectionTier, testing::ValuesIn(AllTiers()),
                         [](const auto& test) { return test.param; });

// Up to a size that takes seconds; `lcpbench collection check` makes all of them.
TEST_P(CollectionTier, IsWhatItsHashesSay) {
  constexpr Index kMostRows = 2000;
  const Manifest manifest = ReadManifest(TierPath(GetParam()));
  EXPECT_EQ(manifest.name, GetParam());
  EXPECT_EQ(manifest.version, kCollectionVersion);
  ProblemSource source(LCPBENCH_SOURCE_DIR "/data");
  for (const ManifestEntry& entry : manifest.problems) {
    if (entry.properties.rows > kMostRows) continue;
    EXPECT_EQ(ContentHash(source.Get(entry)), entry.sha256) << entry.id;
  }
  int left = 4;
  for (const SequenceEntry& entry : manifest.sequences) {
    if (entry.start.rows > 20 || left == 0) continue;
    --left;
    EXPECT_EQ(MeasureSequence(entry.start, entry.steps).sha256, entry.sha256) << entry.id;
  }
}

// The files are for those who do not generate: the same problems, in the same order.
TEST_P(CollectionTier, HasFilesOfTheSameProblems) {
  const std::string path = LCPBENCH_SOURCE_DIR "/data/problems/" + GetParam() + ".jsonl.gz";
  ASSERT_EQ(std::filesystem::exists(path), PlanTier(GetParam()).has_files);
  if (!PlanTier(GetParam()).has_files) return;
  const Manifest manifest = ReadManifest(TierPath(GetParam()));
  std::ifstream file(path, std::ios::binary);
  GzipBuffer gzip(file);
  std::istream lines(&gzip);
  std::string line;
  size_t k = 0;
  while (std::getline(lines, line)) {
    ASSERT_LT(k, manifest.problems.size());
    const ManifestEntry& entry = manifest.problems[k++];
    const LcpProblem problem = ParseLcpRecord(line, entry.id).problem;
    EXPECT_EQ(problem.id(), entry.id);
    EXPECT_EQ(ContentHash(problem), entry.sha256);
  }
  EXPECT_EQ(k, manifest.problems.size());
}

TEST_P(CollectionTier, IsWhatIsPlanned) {
  const Tier tier = PlanTier(GetParam());
  const Manifest manifest = ReadManifest(TierPath(GetParam()));
  EXPECT_LE(manifest.problems.size(), tier.problems.size());
  // But for seeds, and for what was refused with every seed, in the planned order.
  size_t next = 0;
  for (const Candidate& candidate : tier.problems) {
    if (next == manifest.problems.size()) break;
    Recipe recipe = std::get<Recipe>(manifest.problems[next].source);
    const bool tried = recipe.seed >= candidate.recipe.seed && (recipe.seed - candidate.recipe.seed) % kSeedStep == 0;
    recipe.seed = candidate.recipe.seed;
    if (tried && recipe == candidate.recipe) ++next;
  }
  EXPECT_EQ(next, manifest.problems.size());
  ASSERT_EQ(manifest.sequences.size(), tier.sequences.size());
  for (size_t k = 0; k < tier.sequences.size(); ++k) EXPECT_EQ(manifest.sequences[k].start, tier.sequences[k].start);
}

}  // namespace
}  // namespace lcpbench
