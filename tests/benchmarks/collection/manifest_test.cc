#include "benchmarks/collection/manifest.h"

#include "benchmarks/collection/build.h"
#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/plan.h"
#include "benchmarks/collection/properties.h"
#include "benchmarks/collection/recorded_islands.h"
#include "benchmarks/collection/references.h"
#include "benchmarks/collection/sequence_problems.h"
#include "model/scenes/scene.h"
#include "solvers/exact/modes/mode_search.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/json_lines.h"
#include "solvers/io/matrix_market.h"
#include "solvers/lcp/verify.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

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

// Every number of friction and bounded rows counts; lists without any have the hash of the plain problem.
TEST(ContentHash, IsOfFrictionAndBounds) {
  const SparseMatrix J = Eigen::MatrixXd::Identity(4, 4).sparseView();
  const LcpProblem plain = LcpProblem::FromFactors("p", J, Eigen::VectorXd::Ones(4), Eigen::VectorXd::Ones(4));
  const std::vector<RowBounds> kinds = {{},
                                        {{}, {{1, 0, 0.5}}, {}},
                                        {{}, {{1, 0, 0.25}}, {}},
                                        {{}, {{1, 2, 0.5}}, {}},
                                        {{}, {{2, 0, 0.5}}, {}},
                                        {{}, {{1, 0, 0.5, 1}}, {}},
                                        {{}, {{1, 0, 0.5}}, {{3, 0, 1}}},
                                        {{}, {}, {{3, 0, 1}}},
                                        {{}, {}, {{3, 0, std::numeric_limits<double>::infinity()}}},
                                        {{}, {}, {{3, -1, 1}}},
                                        {{}, {}, {{2, 0, 1}}}};
  std::set<std::string> hashes;
  for (const RowBounds& bounds : kinds) {
    const LcpProblem problem = plain.WithBounds(bounds);
    EXPECT_TRUE(hashes.insert(ContentHash(problem)).second);
    EXPECT_EQ(ContentHash(ParseLcpRecord(FormatLcpRecord(problem), "line").problem), ContentHash(problem));
    EXPECT_EQ(ContentHash(problem) == ContentHash(plain), problem.is_plain());
  }
}

// ----- manifests

Manifest ExpectReadAsWritten(const Manifest& manifest) {
  const std::string text = FormatManifest(manifest);
  Manifest read = ReadManifest(WriteTemporary("round.json", text));
  EXPECT_EQ(FormatManifest(read), text);
  return read;
}

TEST(Manifest, IsReadAsItWasWritten) {
  Tier tier = PlanTier("smoke");
  tier.problems.resize(6);
  tier.problems[1].recipe.changes = {{"mass-ratio", 1e4}, {"slack", 0.25}};
  tier.problems[1].grid = "mass ratio";
  tier.problems[2].purpose = "Nothing.";
  tier.sequences.push_back({{"rockers", 5, 3, {}}, 100});
  const Manifest built = BuildTier(tier, {}, nullptr, [](int, int, const std::string&) {}).manifest;
  const Manifest read = ExpectReadAsWritten(built);
  ASSERT_EQ(read.problems.size(), 6U);
  ProblemSource source("");
  for (const ManifestEntry& entry : read.problems) EXPECT_EQ(ContentHash(source.Get(entry)), entry.sha256);
  ASSERT_EQ(read.sequences.size(), 1U);
  EXPECT_EQ(read.sequences[0].sha256, MeasureSequence(std::get<Recipe>(read.sequences[0].source), 100).sha256);
}

// Two steps of a motion, three fill-ups and a sequence.
Manifest OneOfEach() {
  const std::string hash(64, 'a');
  Manifest manifest;
  manifest.name = "each";
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
    entry.properties.rows = 45;
    entry.sha256 = hash;
  }
  manifest.fill_classes = {{"4-6", 3, {}, hash}};
  for (const Recipe& recipe : {Recipe{"rockers", 4, 7, {}}, Recipe{"rockers", 4, 9, {}}, Recipe{"rockers", 6, 7, {}}}) {
    manifest.fill.push_back(FillEntry(recipe));
  }
  SequenceEntry& sequence = manifest.sequences.emplace_back();
  sequence.id = "sequence";
  sequence.family = "rockers";
  sequence.source = Recipe{"rockers", 5, 3, {}};
  sequence.steps = 2;
  sequence.problems = 2;
  sequence.most_rows = 3;
  sequence.sha256 = hash;
  return manifest;
}

TEST(Manifest, HasStepsOfMotionsAndFillUpsAsTheyWereWritten) {
  const Manifest manifest = OneOfEach();
  EXPECT_EQ(manifest.problems[0].id, "disc-pile-n45-s1-motion-step60");
  const Manifest read = ExpectReadAsWritten(manifest);
  EXPECT_EQ(read.problems.at(1).remake, manifest.problems[1].remake);
  ASSERT_EQ(read.fill.size(), 3U);
  for (const ManifestEntry& entry : read.fill) EXPECT_TRUE(entry.fill && entry.base == entry.id);
}

TEST(Manifest, OfAnotherFormIsRefusedInOneLine) {
  const auto good = nlohmann::json::parse(FormatManifest(OneOfEach()));
  const auto with = [&](const char* place, const nlohmann::json& value) {
    nlohmann::json other = good;
    other[nlohmann::json::json_pointer(place)] = value;
    return std::pair<std::string, std::string>(other.dump(), place);
  };
  const std::pair<std::string, std::string> kBad[] = {
      {"", ""},
      {"[]", ""},
      with("/lcpbench_manifest", 2),
      with("/problems/0/id", 7),
      with("/problems/0/recipe/seed", -1),
      with("/problems/0/recipe/seed", 0.5),
      with("/problems/0/recipe/rows", 0),
      with("/problems/0/sha256", "beef"),
      with("/problems/1/id", good["problems"][0]["id"]),
      with("/problems/0/recipe/seed", 9007199254740994),
      with("/problems/0/fraction_active", 1.5),
      with("/fill/0/problems", 4),
      with("/sequences/0/steps", 0),
      with("/sequences/0/problems", 0),
      with("/sequences/0/rows/most", 0),
  };
  for (const auto& [text, place] : kBad) {
    const std::string path = WriteTemporary("bad.json", text);
    ExpectRefused([&] { ReadManifest(path); }, place, path);
  }
  EXPECT_THROW(ReadManifest("no/such/file.json"), InputError);
}

// ----- the collection

const std::string kData = LCPBENCH_SOURCE_DIR "/data/";

class CollectionTier : public testing::TestWithParam<std::string> {
 protected:
  const Tier tier_ = PlanTier(GetParam());
  const Manifest manifest_ = ReadManifest(kData + GetParam() + ".json");
  ProblemSource source_{kData};
};
INSTANTIATE_TEST_SUITE_P(Tiers, CollectionTier, testing::ValuesIn(AllTiers()), [](const auto& test) {
  std::string name = test.param;
  std::ranges::replace(name, '-', '_');
  return name;
});

// Up to a size that takes seconds; `lcpbench collection check` makes all of them.
TEST_P(CollectionTier, IsWhatItsHashesSay) {
  constexpr Index kMostRows = 2000;
  EXPECT_EQ(manifest_.name, GetParam());
  EXPECT_EQ(manifest_.version, tier_.version);
  for (const ManifestEntry& entry : manifest_.problems) {
    if (entry.properties.rows > kMostRows) continue;
    EXPECT_EQ(ContentHash(source_.Get(entry)), entry.sha256) << entry.id;
  }
  int left = 4;
  const Index most = GetParam() == "friction-sequences" ? 40 : 20;  // sweeps drive these, the others exact arithmetic
  for (const SequenceEntry& entry : manifest_.sequences) {
    if (SizeOf(entry) > most || left == 0) continue;
    --left;
    SequenceHash hash;
    ForEachProblemOf(entry, kData, [&hash](const SequenceProblem& met) { hash.Add(met.problem); });
    EXPECT_EQ(hash.Result(), entry.sha256) << entry.id;
  }
}

// The files are for those who do not generate: the same problems, in the same order, steps of motions in another file.
// Literal problems stand there alone, with those that were refused among them.
TEST_P(CollectionTier, HasFilesOfTheSameProblems) {
  const std::string path = kData + "problems/" + GetParam() + ".jsonl.gz";
  const bool is_on_demand = tier_.has_friction && !tier_.has_literals;
  const bool is_expected = tier_.has_files && !tier_.recordings && !is_on_demand;
  ASSERT_EQ(std::filesystem::exists(path), is_expected);
  if (!is_expected) return;
  std::vector<const ManifestEntry*> placed;
  for (const ManifestEntry& entry : manifest_.problems) {
    const bool is_literal = std::holds_alternative<FileSource>(entry.source);
    if (tier_.has_literals ? is_literal : entry.origin == "placed") placed.push_back(&entry);
  }
  size_t k = 0;
  size_t number = 0;
  ReadEachLine(path, [&](const std::string& line, const std::string& where) {
    ++number;
    if (tier_.has_literals && (k == placed.size() || std::get<FileSource>(placed[k]->source).line != number)) return;
    ASSERT_LT(k, placed.size());
    const ManifestEntry& entry = *placed[k++];
    const LcpProblem problem = ParseLcpRecord(line, where).problem;
    EXPECT_EQ(problem.id(), entry.id);
    EXPECT_EQ(ContentHash(problem), entry.sha256);
  });
  EXPECT_EQ(k, placed.size());
}

TEST_P(CollectionTier, FillsStreamsUpWithProblemsThatItsHashesSay) {
  const References references(manifest_, kData);
  size_t next = 0;
  for (const FillClass& fill : manifest_.fill_classes) {
    SequenceHash hash;
    for (size_t k = 0; k < fill.problems; ++k) {
      const ManifestEntry& entry = manifest_.fill[next++];
      const LcpProblem problem = source_.Get(entry);
      hash.Add(problem);
      EXPECT_EQ(SizeClassOf(problem.size()).key, fill.size_class) << entry.id;
      EXPECT_EQ(problem.size(), entry.properties.rows) << entry.id;
      EXPECT_TRUE(references.Find(problem).has_value()) << entry.id;
    }
    EXPECT_EQ(hash.Result(), fill.sha256) << fill.size_class;
  }
  EXPECT_EQ(next, manifest_.fill.size());
  for (const FillPlan& plan : tier_.fill) {
    const auto count = [&](const std::vector<ManifestEntry>& entries) {
      return std::count_if(entries.begin(), entries.end(), [&](const ManifestEntry& entry) {
        return SizeClassOf(entry.properties.rows).key == plan.size_class.key;
      });
    };
    EXPECT_GE(count(manifest_.problems) + count(manifest_.fill), plan.size_class.stream) << plan.size_class.key;
  }
}

TEST_P(CollectionTier, IsWhatIsPlanned) {
  // But for seeds, and for what was refused with every seed, in the planned order.
  size_t next = 0;
  const auto follow = [&](const Recipe& planned, int most) {
    for (int taken = 0; taken < most && next < manifest_.problems.size(); ++taken) {
      const ManifestEntry& entry = manifest_.problems[next];
      if (tier_.has_literals && std::holds_alternative<FileSource>(entry.source)) return;
      Recipe recipe = entry.remake ? *entry.remake : std::get<Recipe>(entry.source);
      const bool tried = recipe.seed >= planned.seed && (recipe.seed - planned.seed) % kSeedStep == 0;
      recipe.seed = planned.seed;
      recipe.motion_step = 0;
      if (!tried || !(recipe == planned)) return;
      ++next;
    }
  };
  for (const Candidate& candidate : tier_.problems) follow(candidate.recipe, 1);
  for (const MotionCandidate& candidate : tier_.motions) follow(candidate.start, candidate.steps);
  while (tier_.has_literals && next < manifest_.problems.size() &&
         std::holds_alternative<FileSource>(manifest_.problems[next].source)) {
    ++next;
  }
  if (tier_.recordings) {
    for (const ManifestEntry& entry : manifest_.problems) {
      EXPECT_TRUE(std::holds_alternative<RecordingSource>(entry.source)) << entry.id;
    }
    // What the collection promises of engines.
    EXPECT_GE(manifest_.problems.size(), 400U);
    EXPECT_GE(manifest_.sequences.size(), tier_.has_friction ? 0U : 40U);
    for (const SequenceEntry& entry : manifest_.sequences) EXPECT_EQ(entry.problems, 100) << entry.id;
    for (const SizeClass& size_class : kSizeClasses) {
      std::set<std::string> bases, engines;
      for (const ManifestEntry& entry : manifest_.problems) {
        if (SizeClassOf(entry.properties.rows).key != size_class.key) continue;
        bases.insert(entry.base);
        engines.insert(entry.family.substr(0, entry.family.find(' ')));
      }
      // Friction needs two rows.
      if (size_class.most > kMostIslandRows || (tier_.has_friction && size_class.most == 1)) continue;
      EXPECT_GE(bases.size(), 30U) << size_class.key;
      EXPECT_GE(engines.size(), 4U) << size_class.key;
    }
    return;
  }
  EXPECT_EQ(next, manifest_.problems.size());
  ASSERT_EQ(manifest_.sequences.size(), tier_.sequences.size());
  for (size_t k = 0; k < tier_.sequences.size(); ++k)
    EXPECT_EQ(std::get<Recipe>(manifest_.sequences[k].source), tier_.sequences[k].start);
}

// ----- the committed answers, judged as any solver's are

Eigen::VectorXd Numbers(const nlohmann::json& values) {
  const auto numbers = values.get<std::vector<double>>();
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(), static_cast<Index>(numbers.size()));
}

// What one friction row, and one number of b, make of a contact: the rule by which problems are refused.
TEST(Triviality, IsToldOfProblemsWithFriction) {
  const auto told = [](double normal_load, double tangential_load) {
    RowBounds bounds;
    bounds.friction = {{1, 0, 0.5}};
    const Eigen::Vector2d b(normal_load, tangential_load);
    const auto problem = LcpProblem::FromDense("contact", Eigen::Matrix2d::Identity(), b).WithBounds(std::move(bounds));
    // The law of the one contact, whose rows do not depend on each other.
    const double normal = std::max(0.0, -normal_load);
    const Eigen::Vector2d f(normal, std::clamp(-tangential_load, -0.5 * normal, 0.5 * normal));
    const AnswerProperties answer = MeasureAnswer(problem, f, f + b, 0);
    EXPECT_EQ(*answer.open + *answer.stick + *answer.slip, 1);
    EXPECT_EQ(*answer.open, normal == 0 ? 1 : 0);
    EXPECT_EQ(*answer.slip, normal > 0 && std::abs(tangential_load) > 0.5 * normal ? 1 : 0);
    return Triviality(problem, answer);
  };
  for (const double tangential : {-2.0, -0.25, 0.0, 0.25, 2.0}) {
    EXPECT_EQ(told(0, tangential), "f = 0");
    EXPECT_EQ(told(3, tangential), "f = 0");
    EXPECT_EQ(told(-1, tangential), tangential == 0 ? "no friction force" : "");
  }
}

// Answers of problems with friction are judged by the verdict alone, for f and w need not be those of every solution:
// exact ones by what rounding leaves, others by the strictest tier.
void ExpectAnswered(const Tier& tier, const ManifestEntry& entry, const LcpProblem& problem, const KnownAnswer& known) {
  if (known.reference.status == LcpReference::Status::kInfeasible) {
    const ExactAnswer answer = SolveByModes(ExactFrom(problem), {});
    EXPECT_TRUE(answer.complete && answer.status == ExactAnswer::Status::kInfeasible) << entry.id;
    return;
  }
  const Metrics metrics = ComputeMetrics(problem, known.f, &known.reference);
  EXPECT_TRUE(PassesTier(metrics, 1e-9)) << entry.id;
  const double floor = *known.reference.floor;
  EXPECT_LE(metrics.rho, entry.reference.kind == "certified" ? 2 * floor + 1e-15 : 1e-9) << entry.id;
  // -1 where w is not that of every solution. w is compared unscaled: light bodies have large rows.
  const Eigen::VectorXd terms = problem.SparseA().cwiseAbs() * known.f.cwiseAbs();
  const double of_w = 4 * std::numeric_limits<double>::epsilon() * terms.maxCoeff();
  EXPECT_LE(metrics.w_error, 1e-12 + 2 * floor + of_w / (1 + problem.b().lpNorm<Eigen::Infinity>())) << entry.id;
  ASSERT_TRUE(entry.answer && entry.answer->open) << entry.id;
  EXPECT_NEAR(*entry.answer->open + *entry.answer->stick + *entry.answer->slip, 1, 2e-4) << entry.id;
  // Even forces of roundings are some: 0 is what a certified answer has, and the rule refuses.
  const std::string trivial = Triviality(problem, MeasureAnswer(problem, known.f, metrics.w, 0));
  EXPECT_EQ(tier.refuses ? trivial : "", "") << entry.id;
}

TEST_P(CollectionTier, HasAnswersThatSolveTheProblemsOrProveThatNothingDoes) {
  constexpr Index kMostRows = 1000;
  ASSERT_EQ(manifest_.references.empty(), !tier_.has_files);
  if (!tier_.has_files) return;
  std::map<std::string, nlohmann::json> records;
  ReadEachLine(kData + manifest_.references, [&](const std::string& line, const std::string& where) {
    nlohmann::json record = nlohmann::json::parse(line);
    const std::string id = record["id"];
    EXPECT_TRUE(records.emplace(id, std::move(record)).second) << where;
  });
  const References known(manifest_, kData);
  const auto check = [&](const ManifestEntry& entry, const nlohmann::json& record) {
    const std::string& id = entry.id;
    EXPECT_EQ(entry.reference.kind, record["kind"]) << id;
    if (entry.properties.rows > kMostRows) return;
    const LcpProblem problem = source_.Get(entry);
    if (!problem.is_plain()) {
      ExpectAnswered(tier_, entry, problem, *known.Find(problem));
      return;
    }
    if (record["status"] == "infeasible") {
      if (problem.Asymmetry() != 0) return;  // rays are proofs for symmetric A
      EXPECT_TRUE(VerifyFarkasRay(problem, Numbers(record["ray"])).accepted) << id;
      return;
    }
    const Eigen::VectorXd f = Numbers(record.contains("f_minnorm") ? record["f_minnorm"] : record["f"]);
    LcpReference reference;
    reference.status = LcpReference::Status::kSolved;
    reference.w = Numbers(record["w"]);
    const Metrics metrics = ComputeMetrics(problem, f, &reference);
    // Nothing but the rounding of f and w to doubles and, where rows contradict each other by their roundings, what the
    // proof says of the distance to the problem that has a solution.
    const double floor = RoundingFloor(problem, f);
    const Eigen::VectorXd D = problem.DiagonalA().unaryExpr([](double d) { return d > 0 ? d : 1.0; });
    const double loads = problem.b().cwiseQuotient(D.cwiseSqrt()).norm();
    const double shift = record.value("energy_shift", 0.0);
    // On rows that contradict each other f and w of the other problem need not be complementary to the last digit; and
    // of one settled wall the floor is estimated too low, by a factor of ten.
    const double rounding = entry.origin == "motion" ? 1e-12 : 1e-15;
    EXPECT_LE(metrics.rho, 2 * floor + rounding + 2 * shift / loads) << id;
    const Eigen::VectorXd error = (metrics.w - *reference.w).cwiseQuotient(D.cwiseSqrt());
    EXPECT_LE(error.norm(), (2 * floor + 1e-15) * loads + 2 * shift) << id;
  };
  // In the manifest's order, in which problems of a recording are side by side: it is read once.
  size_t count = 0;
  for (const auto* part : {&manifest_.problems, &manifest_.fill}) {
    for (const ManifestEntry& entry : *part) {
      const auto record = records.find(entry.id);
      if (record == records.end()) continue;
      ++count;
      check(entry, record->second);
    }
  }
  EXPECT_EQ(count, records.size());
  size_t expected = manifest_.fill.size();
  for (const ManifestEntry& entry : manifest_.problems) expected += entry.reference.kind == "none" ? 0 : 1;
  EXPECT_EQ(count, expected);
}

}  // namespace
}  // namespace lcpbench
