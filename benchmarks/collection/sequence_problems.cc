#include "benchmarks/collection/sequence_problems.h"

#include <filesystem>
#include <unordered_map>

#include "benchmarks/collection/recipes/motion_steps.h"
#include "benchmarks/collection/recording.h"
#include "benchmarks/motions/sequence.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using RowsByName = std::unordered_map<std::string, int>;

// A name that stands twice in a step is that of the first row that has it.
std::vector<int> Matched(const std::vector<std::string>& names, RowsByName* before) {
  std::vector<int> previous;
  RowsByName rows;
  for (const std::string& name : names) {
    const auto found = before->find(name);
    previous.push_back(found == before->end() ? -1 : found->second);
    // One row of the step before is the same as one row here.
    if (found != before->end()) before->erase(found);
    rows.try_emplace(name, static_cast<int>(previous.size()) - 1);
  }
  *before = std::move(rows);
  return previous;
}

void ForEachRecorded(const SequenceEntry& entry, const RecordedSteps& source, const std::string& folder,
                     const std::function<void(const SequenceProblem& met)>& handle) {
  RecordingReader reader((std::filesystem::path(folder) / source.path).string());
  RowsByName before;
  RecordedStep step;
  for (int number = source.first; number < source.first + entry.steps; ++number) {
    const auto what = [&] { return reader.path() + ": step " + std::to_string(number); };
    do {
      if (!reader.Next(&step)) throw InputError(what() + ": the recording does not have it");
    } while (step.number < number);
    if (step.number != number) throw InputError(what() + ": the recording does not have it");
    const RecordedProblem made = VelocityProblem(reader.header(), step);
    const Index rows = made.problem.size();
    if (rows < 1 || rows > kMostSequenceRows) {
      throw InputError(what() + ": expected 1 to " + std::to_string(kMostSequenceRows) + " rows, found " +
                       std::to_string(rows));
    }
    const std::vector<int> previous = Matched(made.identity, &before);
    handle({made.problem, previous, nullptr});
  }
}

}  // namespace

std::string ForEachProblemOf(const SequenceEntry& entry, const std::string& folder,
                             const std::function<void(const SequenceProblem& met)>& handle) {
  if (const auto* recording = std::get_if<RecordedSteps>(&entry.source)) {
    ForEachRecorded(entry, *recording, folder, handle);
    return {};
  }
  RowMatching matching;
  return ForEachSequenceProblem(std::get<Recipe>(entry.source), entry.steps,
                                [&](const LcpProblem& problem, const MotionProblem& met) {
                                  handle({problem, PreviousRows(&matching, met), &met.result});
                                });
}

}  // namespace lcpbench
