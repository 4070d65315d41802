// Times what comes before a solve, stage by stage, for every scene family at 10^3 to 10^5 rows: generating the scene,
// finding its contacts from the outlines of its bodies, assembling J, gamma and b, forming A. Items (study.h) are rows;
// counted is also the most memory resident at a time, and Google Benchmark fits how the time grows.
// --largest=N (a power of ten) goes on to N rows or stops there.

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/studies/study.h"
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
constexpr int kLargestByDefault = 100'000;
constexpr int kLargestOfAll = 1'000'000;
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

void FindPairs(const Workload& work) { benchmark::DoNotOptimize(FindOverlappingPairs(work.boxes).data()); }

void Place(const Workload& work) {
  for (size_t i = 0; i < work.outlines.size(); ++i) {
    const Body& body = work.system.bodies[i];
    benchmark::DoNotOptimize(PlaceOutline(work.outlines[i], body.x, body.theta).spans.data());
  }
}

void Detect(const Workload& work) {
  benchmark::DoNotOptimize(work.finder.Find(work.system.bodies, kTolerance, kTolerance).data());
}

void AssembleRows(const Workload& work) { benchmark::DoNotOptimize(AssembleContactLcp(work.system).rows.data()); }

// A copy each time, because a problem keeps its A.
void FormMatrix(const Workload& work) {
  const LcpProblem problem = work.lcp.problem.CopyOfGivenForm();
  benchmark::DoNotOptimize(problem.SparseA().valuePtr());
}

struct Stage {
  const char* name;
  void (*run)(const Workload& work);  // null: the scene itself is made
};

constexpr std::array kStages = {
    Stage{"generate", nullptr},       // seed to bodies and contacts
    Stage{"broad-phase", FindPairs},  // boxes of the bodies to overlapping pairs
    Stage{"place", Place},            // outlines into the world
    Stage{"detect", Detect},          // outlines to contacts, with place and broad-phase
    Stage{"rows", AssembleRows},      // contacts to J, gamma, b
    Stage{"matrix", FormMatrix},      // J to A, sparse
};

KeptWorkload<Workload> kept;

void Time(const SceneFamily& family, int rows, const Stage& stage, benchmark::State& state) {
  const Workload* work = nullptr;
  if (stage.run != nullptr) {
    work = &kept.Get(std::string(family.key) + "/" + std::to_string(rows), family, rows);
  } else {
    kept.Drop();  // what is resident is what the stage needs and makes
  }
  ResetPeak();
  for (auto _ : state) {
    if (work != nullptr) {
      stage.run(*work);
    } else {
      benchmark::DoNotOptimize(family.generate(rows, kSeed).constraints.data());
    }
  }
  state.counters["MB"] = 1e-6 * PeakBytes();
  CountPerItem(state, rows);
  state.SetComplexityN(rows);
}

void RegisterAll(int largest) {
  for (const SceneFamily& family : AllScenes()) {
    for (const Stage& stage : kStages) {
      const std::string name = std::string(family.key) + "/" + stage.name;
      const auto time = [&family, &stage](benchmark::State& state) {
        Time(family, static_cast<int>(state.range(0)), stage, state);
      };
      benchmark::RegisterBenchmark(name.c_str(), time)
          ->RangeMultiplier(10)
          ->Range(kSmallest, largest)
          ->Complexity()
          ->Unit(benchmark::kMillisecond)
          ->MinTime(kLeastTime);
    }
  }
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  constexpr std::string_view kOption = "--largest=";
  int largest = lcpbench::kLargestByDefault;
  char** const end = std::remove_if(argv + 1, argv + argc, [&](const char* argument) {
    if (!std::string_view(argument).starts_with(kOption)) return false;
    largest = std::atoi(argument + kOption.size());
    return true;
  });
  if (largest < lcpbench::kSmallest || largest > lcpbench::kLargestOfAll) {
    std::fprintf(stderr, "--largest=%d: expected %d to %d rows\n", largest, lcpbench::kSmallest,
                 lcpbench::kLargestOfAll);
    return lcpbench::kMisuse;
  }
  lcpbench::RegisterAll(largest);
  return lcpbench::RunStudy(static_cast<int>(end - argv), argv);
}
