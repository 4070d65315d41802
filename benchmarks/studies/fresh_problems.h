#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/campaign/campaign_file.h"
#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/collection/manifest.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

/// Where the problems of lcpbench_benchmark come from: everything that is named here together.
struct FreshSources {
  std::vector<std::string> manifests;  ///< paths
  std::vector<std::string> files;      ///< of problems, in any format that is read; JSON lines may be compressed
  /// Families, as they are placed; "all", "friction". The sealed ones (data/sealed.json) are in neither, and refused,
  /// where the plan leaves them out.
  std::vector<std::string> scenes;
  std::vector<int> sizes;            ///< rows of `scenes`
  std::vector<std::uint64_t> seeds;  ///< of `scenes`
  bool relaxed = false;              ///< of each problem with friction its relaxation, too, as an origin of its own
  std::size_t most_problems = 0;     ///< of a stream; 0: all
};

/// The problems of one size class and origin, with the weights that they have in a campaign.
struct FreshStream {
  std::string name;  ///< "<size class>/<origin>"
  std::vector<PlannedProblem> planned;
  // What FreshProblems::Load makes of them, in the same order.
  std::vector<LcpProblem> problems;
  std::vector<LcpReference> references;  ///< verdicts are relative to their rounding floors; known of manifests only
  std::vector<ProblemArrays> arrays;     ///< of `problems`
};

/// The streams that the sources give.
class FreshProblems {
 public:
  /// @param plan  most_rows, fills, filter, seed and sealed set of it, and whether that is left out
  /// @throws InputError where something named does not exist or is another kind of file, and where nothing is found
  FreshProblems(const FreshSources& sources, const CampaignPlan& plan);
  FreshProblems(const FreshProblems&) = delete;
  FreshProblems& operator=(const FreshProblems&) = delete;

  /// By size class, and within by origin: placed, motions (both scenes of ours), engines (recorded), literature, given,
  /// relaxed.
  std::vector<FreshStream*> streams();
  /// Makes or reads the stream's problems where that is not done; those of other streams of large problems go.
  /// @throws InputError as ProblemSource::Get
  void Load(FreshStream* stream);

 private:
  void AddScenes(const FreshSources& sources, const CampaignPlan& plan);
  void Keep(const LcpProblem& problem, const char* origin, const std::string& base);

  std::unique_ptr<LcpSolver> relaxing_;  // where relaxations are wanted: the solver, which knows what it takes
  std::vector<std::unique_ptr<ProblemSet>> sets_;
  std::vector<Manifest> manifests_;                               // of the sets, and that of made_
  std::vector<LcpProblem> made_;                                  // what is of no manifest
  std::map<std::pair<Index, std::size_t>, FreshStream> streams_;  // by rows and origin
};

}  // namespace lcpbench
