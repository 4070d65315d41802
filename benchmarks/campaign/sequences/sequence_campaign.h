#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "benchmarks/campaign/campaign.h"
#include "benchmarks/campaign/worker_process.h"
#include "benchmarks/collection/manifest.h"

namespace lcpbench {

// The part of a campaign that runs its manifests' sequences: FOLDER/sequences/ and FOLDER/steps.jsonl (RESULTS.md).

bool HasSequences(const std::vector<Manifest>& manifests);

/// Adds to campaign.json which sequences are run, and with which deadlines; nothing where there are none.
void DescribeSequences(const CampaignPlan& plan, const std::vector<Manifest>& manifests,
                       nlohmann::ordered_json* campaign);

/// PassName of every pass of the shard.
std::vector<std::string> PassNames(const CampaignPlan& plan, const CampaignOptions& options,
                                   const std::vector<Manifest>& manifests);

/// Makes the sequences that the folder does not have yet, then visits every pass in every round; passes that did not
/// complete in round 0 are not visited again, and after one that ran out of time stricter tiers of the same mode are
/// not tried. The caller keeps the Interruption.
/// @return false where it was interrupted
/// @throws InputError as ReadSequenceFile, for a sequence that the folder has
bool RunSequences(const CampaignPlan& plan, const CampaignOptions& options, const std::vector<Manifest>& manifests,
                  const WorkerOptions& worker, const std::string& environment_hash);

}  // namespace lcpbench
