#pragma once

#include <map>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "benchmarks/collection/properties.h"
#include "benchmarks/collection/recipes/recipe.h"
#include "benchmarks/collection/recording.h"
#include "solvers/io/gzip_file.h"

namespace lcpbench {

// The collection's manifests: which problems a set consists of, how each is made, what is known of it, and the hash of
// its content. JSON, one problem a line; docs/formats/manifest.schema.json is the format.

/// A problem in a file beside the manifest.
struct FileSource {
  std::string path;      ///< relative to the manifest's folder
  std::size_t line = 1;  ///< of JSON lines, from 1; 1 for other formats
};

/// A step of a recording beside the manifest, as a problem of one level, or one island of it.
struct RecordingSource {
  std::string path;  ///< relative to the manifest's folder
  int step = 0;
  RecordedLevel level = RecordedLevel::kVelocity;
  int island = 0;  ///< from 1 in the order of IslandsOf(whole, 1); 0: the whole scene
};

/// What is known of a problem's answer, without the numbers: those stand in the manifest's file of references.
struct ReferenceSummary {
  std::string kind = "none";  ///< certified (exact arithmetic), bounded (rigorous bound of the error), none
  std::string status;         ///< solved, infeasible; "" where there is none
  std::optional<bool> f_unique;
  std::optional<Index> nullity_on_active;  ///< of A on the rows with w = 0
  std::optional<bool> strictly_complementary;
  // Members of a bounded reference (bounded_reference.h; with friction ModeProof, energy_shift being its b_shift).
  std::string proof;
  std::optional<double> energy_bound;
  std::optional<double> energy_shift;
  std::optional<double> w_bound;
  std::optional<double> f_bound;
  std::optional<double> mu_shift;  ///< with friction, of "nearby problem": ModeProof::mu_shift (solvers/exact/modes/)
  std::string detail;              ///< why there is none, or what is not known
};

struct ManifestEntry {
  std::string id;
  std::string family;  ///< scene, hard case, or the folder it was imported from
  std::variant<Recipe, FileSource, RecordingSource> source;
  std::optional<Recipe> remake;  ///< of a problem in a file that was generated: how it is made anew
  std::string base;              ///< BaseOf its recipe; where it has none its own id, or what its file says
  std::string origin =
      "placed";       ///< or "motion": a step of a scene's motion; "literature": not of ours; "recorded": of an engine
  bool fill = false;  ///< a fill-up (FillClass): `properties.rows` is all that is known of it
  std::string grid;   ///< the property that the problem's neighbours differ in; "" outside grids
  std::string purpose;  ///< of pathological ones: what it is meant to break
  ProblemProperties properties;
  std::optional<AnswerProperties> answer;
  ReferenceSummary reference;
  std::string provenance;
  std::string licence;
  std::string sha256;  ///< ContentHash; "" of fill-ups
};

/// Fill-ups: problems of the set's own families and sizes with further seeds, so that streams are long enough
/// (SizeClass). The manifest has one hash over all of a class, and no properties.
struct FillClass {
  std::string size_class;  ///< key
  std::size_t problems = 0;
  std::map<std::string, int> refused;  ///< candidates that were not taken, by reason
  std::string sha256;                  ///< SequenceHash of its problems in their order
};

/// The most rows of a step of a recorded sequence.
inline constexpr Index kMostSequenceRows = 300;

/// Consecutive steps of a recording, whole scenes at the velocity level.
struct RecordedSteps {
  std::string path;  ///< relative to the manifest's folder
  int first = 0;     ///< number of the first step
};

/// A sequence: consecutive problems of one motion or recording, and how much the active set changes.
struct SequenceEntry {
  std::string id;
  std::string family;
  std::variant<Recipe, RecordedSteps> source;  ///< a recipe, without changes: the scene that starts moving
  int steps = 0;                               ///< of the scene's own length, or of the recording
  std::int64_t problems = 0;
  Index least_rows = 0;
  Index median_rows = 0;
  Index most_rows = 0;
  std::int64_t unsolvable = 0;  ///< problems without a solution, followed by the relaxed one
  /// Rows that entered, left, became active and ceased to be, summed over all problems but the first.
  std::int64_t entered = 0;
  std::int64_t left = 0;
  std::int64_t activated = 0;
  std::int64_t deactivated = 0;
  double churn = 0;        ///< (activated + deactivated + entered + left) by rows, mean over those problems
  double still_share = 0;  ///< of those problems, the share without any such change
  std::string provenance;
  std::string licence;
  std::string sha256;  ///< SequenceHash
};

/// Rows of the recipe; of a recording, whose scene has no size of its own, the least class of 12, 40, 120 and 300 rows
/// that has all its steps.
Index SizeOf(const SequenceEntry& entry);

/// Candidates that were not taken, by reason.
struct Refusal {
  std::string id;
  std::string reason;
};

struct Manifest {
  std::string name;     ///< of the tier or set
  std::string version;  ///< of the collection, frozen with its hashes
  std::string purpose;
  std::string references;  ///< file of references, relative to the manifest; "" for none
  std::vector<Refusal> refused;
  std::vector<ManifestEntry> problems;
  std::vector<FillClass> fill_classes;
  std::vector<ManifestEntry> fill;  ///< of all classes, one after the other
  std::vector<SequenceEntry> sequences;
};

/// The entry of a problem that fills up a stream; its answer is certified.
ManifestEntry FillEntry(const Recipe& recipe);

/// The folder that paths in the manifest are relative to.
std::string FolderOf(const std::string& path);

/// The text of a manifest file.
std::string FormatManifest(const Manifest& manifest);

/// Properties as the members of a problem's entry.
nlohmann::ordered_json DescribeProperties(const ProblemProperties& properties);

/// Reads a manifest, but for its refusals and what sequences are like. Only what makes the problems must be there.
/// @throws InputError naming file, place, what was expected and what was found
Manifest ReadManifest(const std::string& path);

/// SHA-256 of the ids and hashes of all problems, fill-ups and sequences: what a set consists of.
std::string ManifestHash(const Manifest& manifest);

/// Makes the problems of a manifest's entries, or reads them. Entries in the order of their file's lines cost one pass.
class ProblemSource {
 public:
  /// @param folder  of the manifest
  explicit ProblemSource(std::string folder);

  /// @throws InputError as MakeInstance, or as the file's reader
  LcpProblem Get(const ManifestEntry& entry);

 private:
  LcpProblem Read(const FileSource& source);
  LcpProblem Make(const RecordingSource& source);

  std::string folder_;
  std::optional<LineReader> open_;  // of JSON lines
  std::optional<RecordingReader> recording_;
  RecordedStep step_;  // the last one read of it
};

}  // namespace lcpbench
