// Which islands of a recording may become problems, and what they have in common.

#include "benchmarks/collection/recorded_islands.h"

#include "benchmarks/collection/content_hash.h"
#include "support/text_file.h"
#include "tests/model/shape/random_outlines.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;
using testing::Random;
using testing::RandomInteger;

constexpr int kBodies = 40;
constexpr int kFixed = 3;  // the first ones cannot move

// In the plane. Contacts of few neighbouring bodies, so that there are many islands; a contact's id names its bodies.
std::string RandomRecording(unsigned seed) {
  Random random(seed);
  Json header = {{"lcpbench_recording", 1}, {"engine", "e"},     {"engine_version", "1"},
                 {"licence", "CC0-1.0"},    {"scene", "s"},      {"source", "x"},
                 {"dimension", 2},          {"time_step", 0.01}, {"bodies", Json::array()}};
  for (int k = 0; k < kBodies; ++k) {
    const double inverse = k < kFixed ? 0 : random.Uniform(0.5, 2);
    header["bodies"].push_back({{"inverse_mass", inverse}, {"inverse_inertia", inverse}});
  }
  std::string text = header.dump() + "\n";
  for (int number = 1; number <= 6; ++number) {
    Json bodies, contacts = Json::array();
    for (int k = 0; k < kBodies; ++k) {
      for (const char* key : {"x", "v", "force"}) bodies[key].push_back({random.Uniform(-1, 1), random.Uniform(-1, 1)});
      for (const char* key : {"q", "omega", "torque"}) bodies[key].push_back(0);
    }
    for (int k = 0; k < 30; ++k) {
      const int first = RandomInteger(kBodies + 1, &random) - 1;
      const int second = kFixed + RandomInteger(kBodies - kFixed, &random);
      if (first == second || (first >= kFixed && std::abs(first - second) > 2)) continue;
      contacts.push_back({{"b", {first, second}},
                          {"p", {random.Uniform(-1, 1), random.Uniform(-1, 1)}},
                          {"n", {0, 1}},
                          {"gap", 0},
                          {"mu", k % 3 == 0 ? 0 : 0.5},
                          {"id", std::to_string(second) + " " + std::to_string(first) + " " + std::to_string(k)},
                          {"shape", {"a", "b"}},
                          {"radius", {nullptr, nullptr}}});
    }
    const Json step = {{"step", number}, {"bodies", bodies}, {"contacts", contacts}, {"joints", Json::array()}};
    text += step.dump() + "\n";
    // A step in which nothing changes has the same problems.
    if (number == 3)
      text += Json{{"step", 100}, {"bodies", bodies}, {"contacts", contacts}, {"joints", Json::array()}}.dump() + "\n";
  }
  return text;
}

// The bodies that can move which a row's id names.
std::vector<int> BodiesOf(const std::string& identity) {
  const int second = std::stoi(identity);
  const int first = std::stoi(identity.substr(identity.find(' ') + 1));
  return first >= kFixed ? std::vector<int>{second, first} : std::vector<int>{second};
}

class RecordedIslands : public ::testing::TestWithParam<unsigned> {
 protected:
  RecordedIslands() { WriteTextFile(folder_ + "/" + kName, RandomRecording(GetParam())); }
  static constexpr const char* kName = "islands.jsonl";
  const std::string folder_ = ::testing::TempDir();
};

TEST_P(RecordedIslands, AreProblemsThatTheirSourcesMakeNoTwoTheSame) {
  for (const RecordedLevel level : {RecordedLevel::kVelocity, RecordedLevel::kFriction}) {
    ProblemSource source(folder_);
    std::set<std::string> contents;
    const std::vector<RecordedIsland> islands = ChooseIslands(folder_, kName, level);
    ASSERT_GE(islands.size(), 5U);
    std::map<std::string_view, std::size_t> of_class;
    std::size_t friction_rows = 0;
    for (const RecordedIsland& island : islands) {
      ManifestEntry entry;
      entry.source = island.source;
      const LcpProblem made = source.Get(entry);
      EXPECT_EQ(made.id(), island.made.problem.id());
      EXPECT_EQ(ContentHash(made), ContentHash(island.made.problem));
      EXPECT_TRUE(contents.insert(ContentHash(made)).second) << made.id();
      EXPECT_LE(made.size(), kMostIslandRows);
      EXPECT_LE(++of_class[SizeClassOf(made.size()).key], kIslandsOfRecording);
      friction_rows += made.friction_rows().size();
    }
    EXPECT_EQ(friction_rows > 0, level == RecordedLevel::kFriction);
  }
}

TEST_P(RecordedIslands, OfDifferentBasesShareNoBodyInAnyStep) {
  // Parts of the whole recording, by spreading the least number until nothing changes.
  std::vector<int> part(kBodies);
  std::iota(part.begin(), part.end(), 0);
  RecordingReader reader(folder_ + "/" + kName);
  std::vector<std::vector<int>> pairs;
  for (RecordedStep step; reader.Next(&step);) {
    for (const auto& contact : step.contacts) pairs.push_back(BodiesOf(contact.identity));
  }
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::vector<int>& pair : pairs) {
      const int least =
          std::min(part[static_cast<std::size_t>(pair.front())], part[static_cast<std::size_t>(pair.back())]);
      for (const int body : pair) {
        changed |= part[static_cast<std::size_t>(body)] != least;
        part[static_cast<std::size_t>(body)] = least;
      }
    }
  }
  std::map<int, int> size;
  for (int k = kFixed; k < kBodies; ++k) ++size[part[static_cast<std::size_t>(k)]];
  int largest = kFixed;
  for (const auto& [name, bodies] : size) largest = bodies > size[largest] ? name : largest;
  for (const RecordedIsland& island : ChooseIslands(folder_, kName)) {
    for (const std::string& row : island.made.identity) {
      for (const int body : BodiesOf(row)) {
        const int of = part[static_cast<std::size_t>(body)];
        EXPECT_EQ(island.base, of == largest ? "e-s" : "e-s-body" + std::to_string(of)) << row;
      }
    }
  }
}

TEST_P(RecordedIslands, ComeByTurnsOfTheirBases) {
  std::map<std::string_view, std::map<std::string, int>> taken;
  for (const RecordedIsland& island : ChooseIslands(folder_, kName)) {
    std::map<std::string, int>& of_class = taken[SizeClassOf(island.made.problem.size()).key];
    const int turn = ++of_class[island.base];
    // No base had more turns before.
    for (const auto& [base, turns] : of_class) EXPECT_LE(turns, turn) << base;
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, RecordedIslands, ::testing::Range(1U, 11U));

}  // namespace
}  // namespace lcpbench
