#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/plan.h"
#include "benchmarks/collection/references.h"

namespace lcpbench {

/// A manifest with its file of references, and of problems where the tier has one: JSON lines. Problems that are steps
/// of motions stand in a file of their own, which the manifest's entries name: making them anew takes a motion.
struct BuiltTier {
  Manifest manifest;
  std::string references;
  std::string problems;
  std::string motion_problems;
};
inline constexpr const char* kMotionProblems = "problems/motion.jsonl.gz";

/// Files of sequences (`-sequence.jsonl.gz`) are sequences as a whole, where every step has 1 to kMostSequenceRows
/// rows; a tier with friction has none. Of each other recording RecordedShare::steps steps spread evenly over it give
/// the whole scene at the tier's level, its largest island where that is not the whole, and without friction the whole
/// scene at the acceleration level where there is one; with the same rules as motions for what is refused, and no two
/// with the same content.
/// Each size class up to kMostIslandRows rows gets RecordedShare::islands islands from all steps as well: the
/// recordings take turns, each with its islands in the order of ChooseIslands (recorded_islands.h).
inline constexpr const char* kRecordings = "recordings";
inline constexpr const char* kRecordedSequence = "-sequence.jsonl.gz";
inline constexpr Index kLeastRecordedRows = 4;  ///< of whole scenes and largest islands
inline constexpr Index kMostRecordedRows = 5000;

/// A tier as an earlier build left it.
class KnownTier {
 public:
  /// @param folder  of the manifest
  KnownTier(Manifest manifest, const std::string& folder);

  /// What is known of the problem, if it has the same id and content.
  std::optional<Examined> Find(const LcpProblem& problem) const;

 private:
  References references_;
  std::map<std::string, ManifestEntry> entries_;
};

/// Makes and examines every problem and sequence of a tier. Where the tier refuses, a candidate that is trivial
/// (Triviality) or has no solution is noted as refused and tried again with other seeds, some times. Size classes whose
/// stream has fewer problems are filled up, by turns of all planned scenes and sizes; a fill-up must have a certified
/// answer and a content of its own, too.
/// @param progress  called after every candidate with how many are done, of how many, and the last one's id
/// Problems by formulas are tried once, and literal ones read from the tier's file in `folder`.
/// @param known  of an earlier build: problems with the same id and content are not examined again. Or null.
/// @param folder  of the manifests
/// @throws InputError where literal problems cannot be read, or a formula's answer is wrong
BuiltTier BuildTier(const Tier& tier, const ExamineOptions& options, const KnownTier* known,
                    const std::function<void(int done, int all, const std::string& id)>& progress,
                    const std::string& folder = ".");

/// Where a tier's problems stand, relative to the folder of manifests.
std::string ProblemFileOf(const Tier& tier);

/// Counts and hashes the problems of a sequence, and names it; provenance and licence are the caller's.
/// @param folder  of the manifest, for recordings
/// @throws InputError where the motion ends before its time, and as ForEachProblemOf
SequenceEntry MeasureSequence(const Recipe& start, int steps);
SequenceEntry MeasureSequence(const RecordedSteps& source, int steps, const std::string& folder);

/// How often a candidate is tried with another seed, and by what its seed is raised.
inline constexpr int kSeedsTried = 20;
inline constexpr std::uint64_t kSeedStep = 100;
/// Motions without any step that is taken.
inline constexpr int kMotionsTried = 3;
/// The first seed of fill-ups.
inline constexpr std::uint64_t kFillSeed = 10'001;

}  // namespace lcpbench
