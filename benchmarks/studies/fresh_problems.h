#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/references.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

/// Where the problems of fresh_benchmark come from: everything that is named here together.
struct FreshSources {
  std::vector<std::string> manifests;  ///< paths
  std::vector<std::string> files;      ///< of problems, in any format that is read; JSON lines may be compressed
  std::vector<std::string> scenes;     ///< families, as they are placed; "all"
  std::vector<std::string> motions;    ///< families, steps of whose motions are taken (TakeSteps); "all"
  std::vector<int> sizes;              ///< rows of `scenes` and `motions`
  std::vector<std::uint64_t> seeds;    ///< of both
  int steps = 2;                       ///< of a motion
  int most_problems = 0;               ///< of a size class; 0: all
};

/// Keys of scene families, of all where one is "all". @throws InputError for a family that does not exist
std::vector<std::string> FamiliesOf(const std::vector<std::string>& named);

/// The problems, planned as a campaign's are: weights, and the order within a size class. Only the manifests' have
/// known answers, and so a rounding floor that verdicts are relative to.
class FreshProblems {
 public:
  /// @param plan  most_rows, fills, filter and seed of it
  /// @throws InputError where something named does not exist or is another kind of file
  FreshProblems(const FreshSources& sources, const CampaignPlan& plan);
  FreshProblems(const FreshProblems&) = delete;
  FreshProblems& operator=(const FreshProblems&) = delete;

  /// By size class.
  const std::vector<PlannedProblem>& planned() const { return planned_; }

  struct Problem {
    LcpProblem problem;
    LcpReference reference;
  };
  /// Those of [begin, end) of planned(), made anew or read. @throws InputError as ProblemSource::Get
  std::vector<Problem> Make(std::size_t begin, std::size_t end);

 private:
  void AddFile(const std::string& path);
  void AddScenes(const FreshSources& sources);
  void AddMotions(const FreshSources& sources, Index most_rows);
  void KeepPerClass(int most);
  void Add(Manifest manifest, const std::string& folder);

  std::vector<Manifest> manifests_;
  std::vector<std::unique_ptr<ProblemSource>> made_by_;  // of the manifests
  std::vector<std::unique_ptr<References>> references_;  // of the manifests
  std::map<std::string, LcpProblem> steps_;              // of motions, by id: making one anew takes the motion
  std::vector<PlannedProblem> planned_;
};

}  // namespace lcpbench
