#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign_plan.h"
#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/references.h"
#include "support/append_only_file.h"

namespace lcpbench {

/// campaign.json (RESULTS.md): what is run, where, and with which rules. It is written before the first solve.
nlohmann::ordered_json DescribeCampaign(const CampaignPlan& plan, const std::vector<Manifest>& manifests,
                                        const std::vector<PlannedProblem>& problems);

/// Two campaigns are one if all but the start's time and the environment is the same.
bool SameCampaign(nlohmann::ordered_json a, nlohmann::ordered_json b);

/// @throws InputError naming the file
nlohmann::ordered_json ReadCampaignFile(const std::string& path);
void WriteCampaignFile(const std::string& path, const nlohmann::ordered_json& campaign);

inline constexpr const char* kCampaignFile = "campaign.json";
inline constexpr const char* kLockFile = "campaign.lock";  // of the one run that writes here
inline constexpr const char* kProblemsFile = "problems.jsonl";

/// A manifest, its problems and their known answers.
struct ProblemSet {
  /// @throws InputError as ReadManifest and References
  explicit ProblemSet(const std::string& path);

  Manifest manifest;
  ProblemSource source;
  References references;
};

/// Opens problems.jsonl and reads what it has: the first of `problems`, as these have them.
/// @param manifests  of the plan
/// @param done       how many there are
/// @throws InputError naming file and line where the file has another problem
AppendOnlyFile OpenProblems(const std::string& path, const std::vector<Manifest>& manifests,
                            const std::vector<PlannedProblem>& problems, std::size_t* done);

/// Writes problems.jsonl (RESULTS.md): what is known of every problem of a campaign, and what an oracle would have to
/// pay for it that is told the active set (oracle.h), measured here. Problems that the file has already are passed
/// over. Lines have the order of `problems`, which is
/// what the arrays of streams.jsonl refer to. The k problems of the campaign that have one base weigh 1/k each.
/// @param manifests  of the plan
/// @throws InputError as OpenProblems
void WriteProblems(const std::string& path, const CampaignPlan& plan, const std::vector<Manifest>& manifests,
                   const std::vector<PlannedProblem>& problems);

}  // namespace lcpbench
