#include "benchmarks/collection/manifest.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "benchmarks/collection/build.h"
#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/gzip_file.h"
#include "benchmarks/collection/plan.h"
#include "benchmarks/collection/references.h"
#include "benchmarks/collection/properties.h"
#include "model/scenes/scene.h"
#include "solvers/io/json_lines.h"
#include "solvers/io/matrix_market.h"
#include "support/input_error.h"

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
  Manifest built = BuildTier(tier, {}, nullptr, [](int, int, const std::string&) {}).manifest;
  built.refused.clear();  // which is not read
  const std::string text = FormatManifest(built);
  const Manifest read = ReadManifest(WriteTemporary("round.json", text));
  EXPECT_EQ(FormatManifest(read), text);
  ASSERT_EQ(read.problems.size(), 6U);
  ProblemSource source("");
  for (const ManifestEntry& entry : read.problems) EXPECT_EQ(ContentHash(source.Get(entry)), entry.sha256);
  ASSERT_EQ(read.sequences.size(), 1U);
  EXPECT_EQ(read.sequences[0].sha256, MeasureSequence(read.sequences[0].start, 100).sha256);
}

TEST(Manifest, HasStepsOfMotionsAndFillUpsAsTheyWereWritten) {
  const std::string hash(64, 'a');
  Manifest manifest;
  manifest.name = "n";
  manifest.version = "1";
  Recipe step{"disc-pile", 45, 1, {}, 60};
  for (const int number : {60, 100}) {
    ManifestEntry& entry = manifest.problems.emplace_back();
    step.motion_step = number;
    entry.id = RecipeId(step);
    entry.family = step.scene;
    entry.remake = step;
    entry.source = FileSource{"problems/motion.jsonl.gz", static_cast<size_t>(number)};
    entry.base = BaseOf(step);
    entry.origin = "motion";
    entry.sha256 = hash;
  }
  EXPECT_EQ(manifest.problems[0].id, "disc-pile-n45-s1-motion-step60");
  manifest.fill_classes = {{"4-6", 3, {}, hash}};
  for (const Recipe& recipe : {Recipe{"rockers", 4, 7, {}}, Recipe{"rockers", 4, 9, {}}, Recipe{"rockers", 6, 7, {}}}) {
    manifest.fill.push_back(FillEntry(recipe));
  }
  const std::string text = FormatManifest(manifest);
  const Manifest read = ReadManifest(WriteTemporary("steps.json", text));
  EXPECT_EQ(FormatManifest(read), text);
  EXPECT_EQ(read.problems.at(1).remake, manifest.problems[1].remake);
  ASSERT_EQ(read.fill.size(), 3U);
  for (const ManifestEntry& entry : read.fill) EXPECT_TRUE(entry.fill && entry.base == entry.id);
  const std::map<std::string, double> weights = WeightsByBase(read.problems);
  EXPECT_EQ(weights.size(), 1U);
  EXPECT_EQ(weights.at("disc-pile-n45-s1-motion"), 0.5);
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

// The files are for those who do not generate: the same problems, in the same order, steps of motions in another file.
TEST_P(CollectionTier, HasFilesOfTheSameProblems) {
  const std::string path = LCPBENCH_SOURCE_DIR "/data/problems/" + GetParam() + ".jsonl.gz";
  ASSERT_EQ(std::filesystem::exists(path), PlanTier(GetParam()).has_files);
  if (!PlanTier(GetParam()).has_files) return;
  const Manifest manifest = ReadManifest(TierPath(GetParam()));
  std::vector<const ManifestEntry*> placed;
  for (const ManifestEntry& entry : manifest.problems) {
    if (entry.origin == "placed") placed.push_back(&entry);
  }
  LineReader lines(path);
  std::string line;
  size_t k = 0;
  while (lines.Next(&line)) {
    ASSERT_LT(k, placed.size());
    const ManifestEntry& entry = *placed[k++];
    const LcpProblem problem = ParseLcpRecord(line, entry.id).problem;
    EXPECT_EQ(problem.id(), entry.id);
    EXPECT_EQ(ContentHash(problem), entry.sha256);
  }
  EXPECT_EQ(k, placed.size());
}

TEST_P(CollectionTier, FillsStreamsUpWithProblemsThatItsHashesSay) {
  const Manifest manifest = ReadManifest(TierPath(GetParam()));
  const References references(manifest, LCPBENCH_SOURCE_DIR "/data");
  ProblemSource source("");
  size_t next = 0;
  for (const FillClass& fill : manifest.fill_classes) {
    SequenceHash hash;
    for (size_t k = 0; k < fill.problems; ++k) {
      const ManifestEntry& entry = manifest.fill[next++];
      const LcpProblem problem = source.Get(entry);
      hash.Add(problem);
      EXPECT_EQ(SizeClassOf(problem.size()).key, fill.size_class) << entry.id;
      EXPECT_EQ(problem.size(), entry.properties.rows) << entry.id;
      EXPECT_TRUE(references.Find(problem).has_value()) << entry.id;
    }
    EXPECT_EQ(hash.Result(), fill.sha256) << fill.size_class;
  }
  EXPECT_EQ(next, manifest.fill.size());
  for (const FillPlan& plan : PlanTier(GetParam()).fill) {
    const auto count = [&](const std::vector<ManifestEntry>& entries) {
      return std::count_if(entries.begin(), entries.end(), [&](const ManifestEntry& entry) {
        return SizeClassOf(entry.properties.rows).key == plan.size_class.key;
      });
    };
    EXPECT_GE(count(manifest.problems) + count(manifest.fill), plan.size_class.stream) << plan.size_class.key;
  }
}

TEST_P(CollectionTier, IsWhatIsPlanned) {
  const Tier tier = PlanTier(GetParam());
  const Manifest manifest = ReadManifest(TierPath(GetParam()));
  // But for seeds, and for what was refused with every seed, in the planned order.
  size_t next = 0;
  const auto follow = [&](const Recipe& planned, int most) {
    for (int taken = 0; taken < most && next < manifest.problems.size(); ++taken) {
      const ManifestEntry& entry = manifest.problems[next];
      Recipe recipe = entry.remake ? *entry.remake : std::get<Recipe>(entry.source);
      const bool tried = recipe.seed >= planned.seed && (recipe.seed - planned.seed) % kSeedStep == 0;
      recipe.seed = planned.seed;
      recipe.motion_step = 0;
      if (!tried || !(recipe == planned)) return;
      ++next;
    }
  };
  for (const Candidate& candidate : tier.problems) follow(candidate.recipe, 1);
  for (const MotionCandidate& candidate : tier.motions) follow(candidate.start, candidate.steps);
  EXPECT_EQ(next, manifest.problems.size());
  ASSERT_EQ(manifest.sequences.size(), tier.sequences.size());
  for (size_t k = 0; k < tier.sequences.size(); ++k) EXPECT_EQ(manifest.sequences[k].start, tier.sequences[k].start);
}

}  // namespace
}  // namespace lcpbench
