#include "benchmarks/collection/recorded_islands.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/turns.h"
#include "solvers/linear_algebra/islands.h"

namespace lcpbench {
namespace {

// Which bodies are ever in one island, and which one of its two bodies names a row.
class Parts {
 public:
  explicit Parts(const RecordingHeader& header) : header_(header) {
    met_.Reset(static_cast<Index>(header.bodies.size()));
  }

  // Joins the bodies of the step's rows. Returns a body that can move by row, by the row's identity.
  std::map<std::string, int> Follow(const RecordedStep& step) {
    std::map<std::string, int> body_of;
    const auto follow = [&](int first, int second, const std::string& identity) {
      if (CanMove(header_, first) && CanMove(header_, second)) met_.Join(first, second);
      body_of[identity] = CanMove(header_, first) ? first : second;
    };
    for (const auto& contact : step.contacts) follow(contact.first, contact.second, contact.identity);
    for (const auto& row : step.joint_rows) follow(row.first, row.second, row.identity);
    return body_of;
  }

  // The base of the part that a body belongs to, by body.
  std::vector<std::string> Bases() {
    const auto count = static_cast<int>(header_.bodies.size());
    std::vector<int> movable(header_.bodies.size(), 0);  // by first body of a part
    for (int k = 0; k < count; ++k) movable[At(met_.Root(k))] += CanMove(header_, k) ? 1 : 0;
    const Index largest = std::max_element(movable.begin(), movable.end()) - movable.begin();
    const std::string scene = header_.engine + "-" + header_.scene;
    std::vector<std::string> bases;
    for (int k = 0; k < count; ++k) {
      const Index part = met_.Root(k);
      bases.push_back(part == largest ? scene : scene + "-body" + std::to_string(part));
    }
    return bases;
  }

 private:
  static std::size_t At(Index body) { return static_cast<std::size_t>(body); }

  const RecordingHeader& header_;
  DisjointSets met_;
};

// Whether nothing acts on it, as on a resting body of a step without loads, or no force on its rows does anything, as
// where a row would turn a body that cannot turn.
bool IsIdle(const LcpProblem& problem) { return problem.b().isZero(0) || problem.DiagonalA().isZero(0); }

}  // namespace

std::vector<RecordedIsland> ChooseIslands(const std::string& folder, const std::string& path, RecordedLevel level) {
  RecordingReader reader((std::filesystem::path(folder) / path).string());
  Parts parts(reader.header());
  std::map<std::string, std::pair<RecordedIsland, int>> by_content;  // with a body of each
  for (RecordedStep step; reader.Next(&step);) {
    const std::map<std::string, int> body_of = parts.Follow(step);
    const std::optional<RecordedProblem> whole = MakeRecorded(reader.header(), step, level);
    if (!whole) continue;
    int number = 0;
    for (RecordedProblem& island : IslandsOf(*whole, 1)) {
      ++number;
      if (island.problem.size() > kMostIslandRows || IsIdle(island.problem)) continue;
      const int body = body_of.at(island.identity.front());
      std::string hash = ContentHash(island.problem);
      by_content.try_emplace(std::move(hash), RecordedIsland{std::move(island), {path, step.number, level, number}, {}},
                             body);
    }
  }
  const std::vector<std::string> bases = parts.Bases();
  std::vector<RecordedIsland> islands;
  for (auto& [hash, entry] : by_content) {
    islands.push_back(std::move(entry.first));
    islands.back().base = bases[static_cast<std::size_t>(entry.second)];
  }
  const auto size_class = [](const RecordedIsland& island) { return SizeClassOf(island.made.problem.size()).least; };
  TakeTurns(&islands, [&](const RecordedIsland& island) { return std::pair(size_class(island), island.base); });
  // The first of a class are of different bases.
  std::map<Index, std::set<std::string>> bases_of_class;
  std::map<Index, std::size_t> kept;
  std::erase_if(islands, [&](const RecordedIsland& island) {
    std::set<std::string>& of_class = bases_of_class[size_class(island)];
    if (of_class.size() < kPartsOfRecording) of_class.insert(island.base);
    return !of_class.contains(island.base) || ++kept[size_class(island)] > kIslandsOfRecording;
  });
  return islands;
}

}  // namespace lcpbench
