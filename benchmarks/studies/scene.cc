#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/studies/studies.h"
#include "model/contact/assembly.h"
#include "model/detection/detection.h"
#include "model/detection/narrow_phase.h"
#include "model/geometry/broad_phase.h"
#include "model/motion/contact_finder.h"
#include "model/scenes/scene.h"
#include "model/scenes/scene_builder.h"
#include "support/process_watch.h"

namespace lcpbench {
namespace {

constexpr int kSmallest = 1'000;
constexpr std::uint64_t kSeed = 1;
constexpr double kLeastTime = 0.1;  // s
// Less than what bodies of a scene that do not touch are apart [m].
constexpr double kTolerance = 1e-7;

// What every stage leaves to the next.
struct Workload {
  Workload(const SceneFamily& family, int rows)
      : system(family.generate(rows, kSeed)), finder(WorldUnderGravity(system, {})), lcp(AssembleContactLcp(system)) {
    for (const Body& body : system.bodies) {
      outlines.push_back(OutlineOf(body));
      if (!outlines.back().loops.empty()) boxes.push_back(BoxOf(PlaceOutline(outlines.back(), body.x, body.theta)));
    }
  }

  // Within it a contact may lie.
  static BoundingBox BoxOf(const PlacedOutline& placed) {
    BoundingBox all = placed.boxes.front();
    for (const BoundingBox& box : placed.boxes) all = Union(all, box);
    return Inflated(all, placed.x, kTolerance);
  }

  ContactSystem system;
  ContactFinder finder;
  AssembledLcp lcp;
  std::vector<Outline> outlines;   // of the bodies
  std::vector<BoundingBox> boxes;  // of those with an outline
};

void Place(const Workload& work) {
  for (std::size_t i = 0; i < work.outlines.size(); ++i) {
    const Body& body = work.system.bodies[i];
    benchmark::DoNotOptimize(PlaceOutline(work.outlines[i], body.x, body.theta).spans.data());
  }
}

// A copy each time, because a problem keeps its A.
void FormMatrix(const Workload& work) {
  const LcpProblem problem = work.lcp.problem.CopyOfGivenForm();
  benchmark::DoNotOptimize(problem.SparseA().valuePtr());
}

struct Stage {
  const char* name;
  void (*run)(const Workload& work);  // null: the scene itself is made
};
constexpr Stage kStages[] = {
    {"generate", nullptr},  // seed to bodies and contacts
    // Boxes of the bodies to overlapping pairs.
    {"broad-phase", [](const Workload& work) { benchmark::DoNotOptimize(FindOverlappingPairs(work.boxes).data()); }},
    {"place", Place},  // outlines into the world
    // Outlines to contacts, with place and broad-phase.
    {"detect",
     [](const Workload& work) {
       benchmark::DoNotOptimize(work.finder.Find(work.system.bodies, kTolerance, kTolerance).data());
     }},
    // Contacts to J, gamma, b.
    {"rows", [](const Workload& work) { benchmark::DoNotOptimize(AssembleContactLcp(work.system).rows.data()); }},
    {"matrix", FormMatrix},  // J to A, sparse
};

// @param others_bytes  resident before any stage: the problems of other benchmarks
void Time(const SceneFamily& family, const Stage& stage, double others_bytes, benchmark::State& state) {
  static std::string kept_name;
  static std::unique_ptr<Workload> kept;
  const int rows = static_cast<int>(state.range(0));
  const std::string name = std::string(family.key) + "/" + std::to_string(rows);
  // What is resident is what the stage needs and makes.
  if (stage.run == nullptr || kept_name != name) kept.reset();
  if (stage.run != nullptr && !kept) kept = std::make_unique<Workload>(family, rows);
  kept_name = name;
  ResetPeak();
  for (auto _ : state) {
    if (kept) {
      stage.run(*kept);
    } else {
      benchmark::DoNotOptimize(family.generate(rows, kSeed).constraints.data());
    }
  }
  state.counters["MB"] = 1e-6 * (PeakBytes() - others_bytes);
  CountPerRow(state, rows);
  state.SetComplexityN(rows);
}

}  // namespace

void RegisterScenes(int largest) {
  ResetPeak();
  const double others_bytes = PeakBytes();
  for (const SceneFamily& family : AllScenes()) {
    for (const Stage& stage : kStages) {
      const auto time = [&family, &stage, others_bytes](benchmark::State& state) {
        Time(family, stage, others_bytes, state);
      };
      benchmark::RegisterBenchmark(("scene/" + std::string(family.key) + "/" + stage.name).c_str(), time)
          ->RangeMultiplier(10)
          ->Range(kSmallest, largest)
          ->Complexity()
          ->Unit(benchmark::kMillisecond)
          ->MinTime(kLeastTime);
    }
  }
}

}  // namespace lcpbench
