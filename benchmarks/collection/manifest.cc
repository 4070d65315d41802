#include "benchmarks/collection/manifest.h"

#include <algorithm>
#include <concepts>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <tuple>
#include <type_traits>
#include <utility>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/problem_formats.h"
#include "benchmarks/collection/recipes/formulas.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"
#include "support/json_field.h"
#include "support/printable.h"
#include "support/text_file.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kLeastRatio = 0.999;  // of a largest number to the smallest one, with what rounding leaves

// Measured numbers differ in their last digits from machine to machine; what is worth telling stands in the first.
Json Rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::strtod(text, nullptr);
}

std::uint64_t Seed(const JsonField& field) {
  constexpr double kMost = 9007199254740992;  // beyond it a JSON number need not be the integer it shows
  const double value = field.Number();
  if (!(value >= 0 && value <= kMost && value == static_cast<double>(static_cast<std::uint64_t>(value)))) {
    field.Mismatch("a seed, an integer from 0 to 2^53");
  }
  return static_cast<std::uint64_t>(value);
}

int PositiveInteger(const JsonField& field) {
  const int value = field.Integer();
  if (value < 1) field.Mismatch("an integer >= 1");
  return value;
}

// A manifest names no file outside its folder.
void RequireInside(const JsonField& field, const std::string& path) {
  const std::filesystem::path normal = std::filesystem::path(path).lexically_normal();
  if (normal.empty() || normal.is_absolute() || *normal.begin() == "..") {
    field.Mismatch("a path within the manifest's folder");
  }
}

// A sequence's id names its file in campaigns' folders.
void RequireFileName(const JsonField& field, const std::string& id) {
  const bool is_name = id.find_first_of("/\\") == std::string::npos && id.front() != '.' && Printable(id) == id;
  if (!is_name) field.Mismatch("an id that can name a file");
}

std::string ReadHash(const JsonField& field) {
  constexpr size_t kDigits = 64;
  std::string hash = field.String();
  if (hash.size() != kDigits || hash.find_first_not_of("0123456789abcdef") != std::string::npos) {
    field.Mismatch("a SHA-256 of 64 hexadecimal digits");
  }
  return hash;
}

// ----- members in their order, for writing and reading

template <typename T, typename U>
concept Is = std::same_as<std::remove_const_t<T>, U>;

/// Writes members; numbers of type double are rounded.
struct Writer {
  static constexpr bool kReads = false;
  Json json = Json::object();

  /// A member that must be there.
  void Must(const char* name, const auto& value) { json[name] = ToJson(value); }
  /// One that is always written, and keeps its value where a file lacks it.
  void May(const char* name, const auto& value) { json[name] = ToJson(value); }
  /// One that is not written where there is nothing to say.
  template <typename Value>
  void Some(const char* name, const Value& value) {
    if (!(value == Value{})) json[name] = ToJson(value);
  }
  void Object(const char* name, const auto& write) {
    Writer inside;
    write(inside);
    json[name] = std::move(inside.json);
  }

  template <typename Value>
  static Json ToJson(const Value& value) {
    if constexpr (std::is_same_v<Value, double>) {
      return Rounded(value);
    } else if constexpr (requires { value.has_value(); }) {
      return value ? ToJson(*value) : Json(nullptr);
    } else if constexpr (requires(Writer inside) { Members(inside, value); }) {
      Writer inside;
      Members(inside, value);
      return std::move(inside.json);
    } else {
      return value;
    }
  }
  static Json ToJson(const std::vector<Change>& changes) {
    Json list = Json::array();
    for (const auto& [name, amount] : changes) list.push_back({{"name", name}, {"amount", amount}});
    return list;
  }
};

/// Reads them, and refuses others.
struct Reader {
  static constexpr bool kReads = true;
  JsonField field;
  std::vector<const char*> known = {};

  void Must(const char* name, auto& value) {
    known.push_back(name);
    Get(field[name], &value);
    if (field[name].IsString()) RequireText(field[name]);
  }
  void May(const char* name, auto& value) {
    known.push_back(name);
    if (field.Has(name)) Get(field[name], &value);
  }
  void Some(const char* name, auto& value) { May(name, value); }
  void Object(const char* name, const auto& read) {
    known.push_back(name);
    Reader inside{field[name]};
    read(inside);
    inside.Finish();
  }
  void Finish() const { field.RequireOnlyKeys(known); }
  /// Checks a member that may be missing.
  void OneOf(const char* name, const std::vector<std::string>& words) {
    known.push_back(name);
    if (!field.Has(name)) return;
    std::string all;
    for (const std::string& word : words) all += (all.empty() ? "" : ", ") + word;
    const JsonField member = field[name];
    if (std::find(words.begin(), words.end(), member.String()) == words.end()) member.Mismatch(all);
  }
  void Within(const char* name, double least, double most) const {
    if (!field.Knows(name)) return;
    const double value = field[name].Number();
    if (!(value >= least && value <= most)) {
      field[name].Mismatch("a number >= " + Json(least).dump() + (most < kInfinity ? " and <= 1" : ""));
    }
  }

  static void RequireText(const JsonField& from) {
    if (from.String().empty()) from.Mismatch("a text that is not empty");
  }
  static void Get(const JsonField& from, std::string* value) { *value = from.String(); }
  static void Get(const JsonField& from, bool* value) { *value = from.Boolean(); }
  static void Get(const JsonField& from, double* value) { *value = from.Number(); }
  static void Get(const JsonField& from, Index* value) { *value = from.IndexBelow(std::numeric_limits<int>::max()); }
  static void Get(const JsonField& from, int* value) { *value = PositiveInteger(from); }
  static void Get(const JsonField& from, std::uint64_t* value) { *value = Seed(from); }
  static void Get(const JsonField& from, std::map<std::string, int>* value) {
    for (const auto& [key, count] : from.Members()) (*value)[key] = PositiveInteger(count);
  }
  static void Get(const JsonField& from, std::vector<Change>* changes) {
    for (const JsonField& change : from.Items()) {
      change.RequireOnlyKeys({"name", "amount"});
      changes->push_back({change["name"].String(), change["amount"].Number()});
    }
  }
  template <typename Value>
  static void Get(const JsonField& from, std::optional<Value>* value) {
    if (!from.IsNull()) Get(from, &value->emplace());
  }
  template <typename Value>
  requires std::is_class_v<Value>
  static void Get(const JsonField& from, Value* value) {
    Reader inside{from};
    Members(inside, *value);
    inside.Finish();
  }
};

void Members(auto& archive, Is<Recipe> auto& recipe) {
  archive.Must("scene", recipe.scene);
  archive.Must("rows", recipe.rows);
  archive.Must("seed", recipe.seed);
  archive.Some("motion_step", recipe.motion_step);
  archive.Some("changes", recipe.changes);
}

void Members(auto& archive, Is<FileSource> auto& file) {
  archive.Must("path", file.path);
  archive.Must("line", file.line);
  if constexpr (std::remove_reference_t<decltype(archive)>::kReads) {
    RequireInside(archive.field["path"], file.path);
    PositiveInteger(archive.field["line"]);
  }
}

// Numbers of steps, unlike counts, may be 0.
void StepNumber(auto& archive, const char* name, Is<int> auto& number) {
  if constexpr (std::remove_reference_t<decltype(archive)>::kReads) {
    archive.known.push_back(name);
    number = archive.field[name].Integer();
  } else {
    archive.Must(name, number);
  }
}

void Members(auto& archive, Is<RecordingSource> auto& recording) {
  archive.Must("path", recording.path);
  StepNumber(archive, "step", recording.step);
  std::string level = kRecordedLevels.begin()[static_cast<std::size_t>(recording.level)].first;
  archive.Must("level", level);
  archive.Some("island", recording.island);
  if constexpr (std::remove_reference_t<decltype(archive)>::kReads) {
    RequireInside(archive.field["path"], recording.path);
    recording.level = archive.field["level"].template Choice<RecordedLevel>(kRecordedLevels);
    if (archive.field.Has("island")) PositiveInteger(archive.field["island"]);
  }
}

void Members(auto& archive, Is<RecordedSteps> auto& recording) {
  archive.Must("path", recording.path);
  StepNumber(archive, "first", recording.first);
  if constexpr (std::remove_reference_t<decltype(archive)>::kReads) {
    RequireInside(archive.field["path"], recording.path);
    archive.Within("first", 0, kInfinity);
  }
}

void Members(auto& archive, Is<ReferenceSummary> auto& reference) {
  archive.Must("kind", reference.kind);
  archive.Some("status", reference.status);
  if (std::remove_reference_t<decltype(archive)>::kReads || reference.status == "solved") {
    archive.May("f_unique", reference.f_unique);
    archive.May("nullity_on_active", reference.nullity_on_active);
    archive.May("strictly_complementary", reference.strictly_complementary);
  }
  archive.Some("proof", reference.proof);
  archive.Some("energy_bound", reference.energy_bound);
  archive.Some("energy_shift", reference.energy_shift);
  archive.Some("w_bound", reference.w_bound);
  archive.Some("f_bound", reference.f_bound);
  archive.Some("mu_shift", reference.mu_shift);
  archive.Some("detail", reference.detail);
  if constexpr (std::remove_reference_t<decltype(archive)>::kReads) {
    archive.OneOf("kind", {"certified", "bounded", "none"});
    archive.OneOf("status", {"solved", "infeasible"});
    archive.OneOf("proof", {"active rows", "feasible point", "modes", "nearby problem"});
    for (const char* name : {"energy_bound", "energy_shift", "w_bound", "f_bound", "mu_shift"}) {
      archive.Within(name, 0, kInfinity);
    }
  }
}

// A problem comes from a recipe, or from a file and perhaps the recipe that the file was made by.
void SourceMembers(Writer& writer, const ManifestEntry& entry) {
  const auto* file = std::get_if<FileSource>(&entry.source);
  const auto* recipe = std::get_if<Recipe>(&entry.source);
  writer.Some("recipe", recipe != nullptr ? std::optional<Recipe>(*recipe) : entry.remake);
  if (file != nullptr) writer.Must("file", *file);
  if (const auto* recording = std::get_if<RecordingSource>(&entry.source)) writer.Must("recording", *recording);
  writer.Must("base", entry.base.empty() ? entry.id : entry.base);
  writer.Must("origin", entry.origin);
}

void SourceMembers(Reader& reader, ManifestEntry& entry) {
  const bool has_file = reader.field.Has("file");
  entry.base = entry.id;
  if (reader.field.Has("recording")) {
    reader.Must("recording", entry.source.emplace<RecordingSource>());
    entry.origin = "recorded";
    reader.May("base", entry.base);
    reader.May("origin", entry.origin);
    reader.OneOf("origin", {"recorded"});
    return;
  }
  if (reader.field.Has("recipe") || !has_file) {
    Recipe recipe;
    reader.Must("recipe", recipe);
    entry.base = BaseOf(recipe);
    if (recipe.motion_step > 0) entry.origin = "motion";
    if (FindFormula(recipe.scene) != nullptr) entry.origin = "literature";
    entry.source = recipe;
    if (has_file) entry.remake = std::move(recipe);
  }
  if (has_file) reader.Must("file", entry.source.emplace<FileSource>());
  if (reader.field.Has("recipe")) {
    // They follow from the recipe.
    reader.OneOf("base", {entry.base});
    reader.OneOf("origin", {entry.origin});
  } else {
    reader.May("base", entry.base);
    reader.May("origin", entry.origin);
    reader.OneOf("origin", {"placed", "literature"});
  }
}

void Members(auto& archive, Is<ProblemProperties> auto& p) {
  archive.Must("rows", p.rows);
  archive.May("bilateral", p.bilateral);
  archive.Some("friction", p.friction);
  archive.Some("bounded", p.bounded);
  archive.May("bodies", p.bodies);
  archive.May("nonzeros_A", p.nonzeros_A);
  archive.May("nonzeros_J", p.nonzeros_J);
  archive.May("rank", p.rank.value);
  archive.May("rank_method", p.rank.method);
  archive.May("numerical_rank", p.numerical_rank);
  archive.May("condition", p.condition.value);
  archive.May("condition_method", p.condition.method);
  archive.May("redundancy", p.redundancy);
  archive.May("mass_ratio", p.mass_ratio);
  archive.May("kinds", p.kinds);
}

void Members(auto& archive, Is<ManifestEntry> auto& entry) {
  archive.Must("id", entry.id);
  archive.Must("family", entry.family);
  SourceMembers(archive, entry);
  archive.Some("grid", entry.grid);
  archive.Some("purpose", entry.purpose);
  Members(archive, entry.properties);
  std::optional<double> active;
  std::optional<Index> degenerate;
  AnswerProperties answer = entry.answer.value_or(AnswerProperties{});
  if (entry.answer) std::tie(active, degenerate) = std::tie(answer.fraction_active, answer.degenerate);
  archive.May("fraction_active", active);
  archive.May("degenerate", degenerate);
  archive.Some("open", answer.open);
  archive.Some("stick", answer.stick);
  archive.Some("slip", answer.slip);
  if constexpr (std::remove_reference_t<decltype(archive)>::kReads) {
    answer.fraction_active = active.value_or(0);
    answer.degenerate = degenerate.value_or(0);
    if (active) entry.answer = answer;
    archive.OneOf("grid", {"mass ratio", "redundancy", "condition", "active fraction", "curvature contrast",
                           "coefficient of friction"});
    for (const char* share : {"redundancy", "fraction_active", "open", "stick", "slip"}) archive.Within(share, 0, 1);
    for (const char* ratio : {"condition", "mass_ratio"}) archive.Within(ratio, kLeastRatio, kInfinity);
  }
  archive.May("reference", entry.reference);
  archive.May("provenance", entry.provenance);
  archive.May("licence", entry.licence);
  archive.Must("sha256", entry.sha256);
}

void SequenceSource(Writer& writer, const SequenceEntry& entry) {
  if (const auto* start = std::get_if<Recipe>(&entry.source)) writer.Must("start", *start);
  if (const auto* recording = std::get_if<RecordedSteps>(&entry.source)) writer.Must("recording", *recording);
}

void SequenceSource(Reader& reader, SequenceEntry& entry) {
  if (reader.field.Has("recording")) {
    reader.Must("recording", entry.source.emplace<RecordedSteps>());
  } else {
    reader.Must("start", entry.source.emplace<Recipe>());
  }
}

void Members(auto& archive, Is<SequenceEntry> auto& entry) {
  archive.Must("id", entry.id);
  archive.Must("family", entry.family);
  SequenceSource(archive, entry);
  archive.Must("steps", entry.steps);
  archive.Must("problems", entry.problems);
  archive.Object("rows", [&](auto& inside) {
    inside.May("least", entry.least_rows);
    inside.May("median", entry.median_rows);
    inside.Must("most", entry.most_rows);
  });
  archive.May("unsolvable", entry.unsolvable);
  archive.Object("changes", [&](auto& inside) {
    inside.May("entered", entry.entered);
    inside.May("left", entry.left);
    inside.May("activated", entry.activated);
    inside.May("deactivated", entry.deactivated);
  });
  archive.May("churn", entry.churn);
  archive.May("still_share", entry.still_share);
  archive.May("provenance", entry.provenance);
  archive.May("licence", entry.licence);
  archive.Must("sha256", entry.sha256);
  if constexpr (std::remove_reference_t<decltype(archive)>::kReads) {
    RequireFileName(archive.field["id"], entry.id);
    archive.Within("churn", 0, kInfinity);
    archive.Within("still_share", 0, 1);
  }
}

void Members(auto& archive, Is<Refusal> auto& refusal) {
  archive.Must("id", refusal.id);
  archive.Must("reason", refusal.reason);
}

// ----- fill-ups

// Seeds by scene and rows, in the order of the problems.
Json Describe(const FillClass& fill, std::span<const ManifestEntry> problems) {
  Json json;
  json["size_class"] = fill.size_class;
  json["problems"] = fill.problems;
  json["refused_by_reason"] = Json::object();
  for (const auto& [reason, count] : fill.refused) json["refused_by_reason"][reason] = count;
  json["sha256"] = fill.sha256;
  json["recipes"] = Json::array();
  const Recipe* before = nullptr;
  for (const ManifestEntry& entry : problems) {
    const auto& recipe = std::get<Recipe>(entry.source);
    if (before == nullptr || before->scene != recipe.scene || before->rows != recipe.rows) {
      json["recipes"].push_back({{"scene", recipe.scene}, {"rows", recipe.rows}, {"seeds", Json::array()}});
    }
    json["recipes"].back()["seeds"].push_back(recipe.seed);
    before = &recipe;
  }
  return json;
}

// One item a line.
std::string Lines(const std::vector<Json>& items) {
  std::string text = "[";
  for (size_t k = 0; k < items.size(); ++k) text += (k == 0 ? "\n  " : ",\n  ") + items[k].dump();
  return text + (items.empty() ? "]" : "\n ]");
}

std::string LinesOf(const auto& items) {
  std::vector<Json> lines;
  for (const auto& item : items) lines.push_back(Writer::ToJson(item));
  return Lines(lines);
}

std::vector<Json> DescribeFill(const Manifest& manifest) {
  std::vector<Json> described;
  std::span<const ManifestEntry> rest(manifest.fill);
  for (const FillClass& fill : manifest.fill_classes) {
    described.push_back(Describe(fill, rest.first(fill.problems)));
    rest = rest.subspan(fill.problems);
  }
  return described;
}

void ReadFillClass(const JsonField& field, Manifest* manifest) {
  FillClass fill;
  field.RequireOnlyKeys({"size_class", "problems", "refused_by_reason", "sha256", "recipes"});
  fill.size_class = field["size_class"].String();
  Reader::RequireText(field["size_class"]);
  if (field.Has("refused_by_reason")) Reader::Get(field["refused_by_reason"], &fill.refused);
  fill.sha256 = ReadHash(field["sha256"]);
  const size_t before = manifest->fill.size();
  for (const JsonField& group : field["recipes"].Items()) {
    Recipe recipe;
    group.RequireOnlyKeys({"scene", "rows", "seeds"});
    recipe.scene = group["scene"].String();
    Reader::RequireText(group["scene"]);
    recipe.rows = PositiveInteger(group["rows"]);
    for (const JsonField& seed : group["seeds"].Items()) {
      recipe.seed = Seed(seed);
      manifest->fill.push_back(FillEntry(recipe));
    }
  }
  fill.problems = manifest->fill.size() - before;
  if (fill.problems != static_cast<size_t>(PositiveInteger(field["problems"]))) {
    field["problems"].Mismatch("the number of seeds, " + std::to_string(fill.problems));
  }
  manifest->fill_classes.push_back(std::move(fill));
}

}  // namespace

std::string ManifestHash(const Manifest& manifest) {
  std::string text;
  for (const ManifestEntry& entry : manifest.problems) text += entry.id + ' ' + entry.sha256 + '\n';
  for (const FillClass& fill : manifest.fill_classes) text += fill.size_class + ' ' + fill.sha256 + '\n';
  for (const SequenceEntry& entry : manifest.sequences) text += entry.id + ' ' + entry.sha256 + '\n';
  return TextHash(text);
}

ManifestEntry FillEntry(const Recipe& recipe) {
  ManifestEntry entry;
  entry.id = RecipeId(recipe);
  entry.family = recipe.scene;
  entry.source = recipe;
  entry.base = BaseOf(recipe);
  entry.fill = true;
  entry.properties.rows = recipe.rows;
  entry.reference.kind = "certified";
  return entry;
}

std::string FolderOf(const std::string& path) { return std::filesystem::path(path).parent_path().string(); }

Index SizeOf(const SequenceEntry& entry) {
  if (const auto* start = std::get_if<Recipe>(&entry.source)) return start->rows;
  constexpr Index kSizes[] = {12, 40, 120};
  for (const Index size : kSizes) {
    if (entry.most_rows <= size) return size;
  }
  return kMostSequenceRows;
}

ProblemSource::ProblemSource(std::string folder) : folder_(std::move(folder)) {}

LcpProblem ProblemSource::Get(const ManifestEntry& entry) {
  if (const auto* recipe = std::get_if<Recipe>(&entry.source)) return MakeInstance(*recipe).problem;
  if (const auto* recording = std::get_if<RecordingSource>(&entry.source)) return Make(*recording);
  return Read(std::get<FileSource>(entry.source));
}

LcpProblem ProblemSource::Make(const RecordingSource& source) {
  const std::string path = (std::filesystem::path(folder_) / source.path).string();
  if (!recording_ || recording_->path() != path || step_.number > source.step) {
    recording_.emplace(path);
    step_ = {};
  }
  while (step_.number != source.step || step_.bodies.empty()) {
    if (!recording_->Next(&step_)) throw InputError(path + ": expected a step " + std::to_string(source.step));
  }
  const std::optional<RecordedProblem> whole = MakeRecorded(recording_->header(), step_, source.level);
  if (!whole) throw InputError(path + ": step " + std::to_string(source.step) + " is not a problem of this level");
  if (source.island == 0) return whole->problem;
  const std::vector<RecordedProblem> islands = IslandsOf(*whole, 1);
  if (static_cast<std::size_t>(source.island) > islands.size()) {
    throw InputError(path + ": step " + std::to_string(source.step) + " has no island " +
                     std::to_string(source.island));
  }
  return islands[static_cast<std::size_t>(source.island) - 1].problem;
}

LcpProblem ProblemSource::Read(const FileSource& source) {
  const std::string path = (std::filesystem::path(folder_) / source.path).string();
  if (!FormatOfFile(path).is_lines()) return ReadProblemFile(path, {});
  if (!open_ || open_->name() != path || open_->number() >= source.line) open_.emplace(path);
  std::string line;
  while (open_->number() < source.line) {
    if (!open_->Next(&line)) {
      throw InputError(path + ": expected " + std::to_string(source.line) + " lines, found " +
                       std::to_string(open_->number()));
    }
  }
  return ParseLcpRecord(line, path + ":" + std::to_string(source.line)).problem;
}

std::string FormatManifest(const Manifest& manifest) {
  Json counts = Json::object();
  for (const Refusal& refusal : manifest.refused) {
    counts[refusal.reason] = counts.value(refusal.reason, 0) + 1;
  }
  std::string text = "{\n";
  const auto member = [&text](const char* name, const std::string& value, bool last = false) {
    text += std::string(" \"") + name + "\": " + value + (last ? "\n" : ",\n");
  };
  member("lcpbench_manifest", std::to_string(kFormat));
  member("name", Json(manifest.name).dump());
  member("version", Json(manifest.version).dump());
  member("purpose", Json(manifest.purpose).dump());
  if (!manifest.references.empty()) member("references", Json(manifest.references).dump());
  member("refused_by_reason", counts.dump());
  member("refused", LinesOf(manifest.refused));
  member("problems", LinesOf(manifest.problems));
  if (!manifest.fill.empty()) member("fill", Lines(DescribeFill(manifest)));
  member("sequences", LinesOf(manifest.sequences), true);
  return text + "}\n";
}

nlohmann::ordered_json DescribeProperties(const ProblemProperties& properties) { return Writer::ToJson(properties); }

Manifest ReadManifest(const std::string& path) {
  const nlohmann::json document = ParseJsonObject(ReadTextFile(path), path);
  const JsonField root(document, path);
  if (root["lcpbench_manifest"].Integer() != kFormat) {
    root["lcpbench_manifest"].Mismatch("the format's number " + std::to_string(kFormat));
  }
  Manifest manifest;
  std::map<std::string, int> refusals;
  manifest.name = root["name"].String();
  manifest.version = root["version"].String();
  for (const char* name : {"name", "version"}) Reader::RequireText(root[name]);
  if (root.Has("purpose")) manifest.purpose = root["purpose"].String();
  if (root.Has("references")) {
    manifest.references = root["references"].String();
    RequireInside(root["references"], manifest.references);
  }
  root.RequireOnlyKeys({"lcpbench_manifest", "name", "version", "purpose", "references", "refused_by_reason", "refused",
                        "problems", "fill", "sequences"});
  // The refused candidates are listed for readers only.
  if (root.Has("refused_by_reason")) Reader::Get(root["refused_by_reason"], &refusals);
  if (root.Has("refused")) {
    for (const JsonField& item : root["refused"].Items()) Reader::Get(item, &manifest.refused.emplace_back());
  }
  std::set<std::string> ids;
  const auto read = [&ids](const JsonField& item, auto& entry) {
    Reader::Get(item, &entry);
    entry.sha256 = ReadHash(item["sha256"]);
    if (!ids.insert(entry.id).second) item["id"].Mismatch("an id that no other problem has");
  };
  for (const JsonField& item : root["problems"].Items()) read(item, manifest.problems.emplace_back());
  if (root.Has("fill")) {
    for (const JsonField& item : root["fill"].Items()) {
      const size_t before = manifest.fill.size();
      ReadFillClass(item, &manifest);
      for (size_t k = before; k < manifest.fill.size(); ++k) {
        if (!ids.insert(manifest.fill[k].id).second) item["recipes"].Mismatch("ids that no other problem has");
      }
    }
  }
  if (root.Has("sequences")) {
    for (const JsonField& item : root["sequences"].Items()) {
      read(item, manifest.sequences.emplace_back());
      for (const JsonField& count : {item["problems"], item["rows"]["most"]}) PositiveInteger(count);
    }
  }
  return manifest;
}

}  // namespace lcpbench
