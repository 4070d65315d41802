#include "benchmarks/collection/manifest.h"

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <sstream>
#include <utility>

#include "benchmarks/collection/content_hash.h"
#include "benchmarks/collection/problem_formats.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;

// Measured numbers differ in their last digits from machine to machine; what is worth telling stands in the first.
Json Rounded(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.4g", value);
  return std::strtod(text, nullptr);
}

Json RoundedOrNull(const std::optional<double>& value) { return value ? Rounded(*value) : Json(nullptr); }

template <typename Value>
Json OrNull(const std::optional<Value>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json Describe(const Recipe& recipe) {
  Json json;
  json["scene"] = recipe.scene;
  json["rows"] = recipe.rows;
  json["seed"] = recipe.seed;
  if (recipe.motion_step > 0) json["motion_step"] = recipe.motion_step;
  if (!recipe.changes.empty()) {
    Json changes = Json::array();
    for (const Change& change : recipe.changes) changes.push_back({{"name", change.name}, {"amount", change.amount}});
    json["changes"] = changes;
  }
  return json;
}

Json Describe(const ReferenceSummary& reference) {
  Json json;
  json["kind"] = reference.kind;
  if (!reference.status.empty()) json["status"] = reference.status;
  if (reference.status == "solved") {
    json["f_unique"] = OrNull(reference.f_unique);
    json["nullity_on_active"] = OrNull(reference.nullity_on_active);
    json["strictly_complementary"] = OrNull(reference.strictly_complementary);
  }
  if (!reference.proof.empty()) json["proof"] = reference.proof;
  if (reference.energy_bound) json["energy_bound"] = Rounded(*reference.energy_bound);
  if (reference.energy_shift) json["energy_shift"] = Rounded(*reference.energy_shift);
  if (reference.w_bound) json["w_bound"] = Rounded(*reference.w_bound);
  if (reference.f_bound) json["f_bound"] = Rounded(*reference.f_bound);
  if (!reference.detail.empty()) json["detail"] = reference.detail;
  return json;
}

Json Describe(const ManifestEntry& entry) {
  const ProblemProperties& p = entry.properties;
  Json json;
  json["id"] = entry.id;
  json["family"] = entry.family;
  if (const auto* recipe = std::get_if<Recipe>(&entry.source)) {
    json["recipe"] = Describe(*recipe);
  } else {
    const auto& file = std::get<FileSource>(entry.source);
    if (entry.remake.has_value()) json["recipe"] = Describe(*entry.remake);
    json["file"] = {{"path", file.path}, {"line", file.line}};
  }
  json["base"] = entry.base.empty() ? entry.id : entry.base;
  json["origin"] = entry.origin;
  if (!entry.grid.empty()) json["grid"] = entry.grid;
  if (!entry.purpose.empty()) json["purpose"] = entry.purpose;
  json["rows"] = p.rows;
  json["bilateral"] = p.bilateral;
  json["bodies"] = p.bodies;
  json["nonzeros_A"] = p.nonzeros_A;
  json["nonzeros_J"] = OrNull(p.nonzeros_J);
  json["rank"] = OrNull(p.rank.value);
  json["rank_method"] = p.rank.method;
  json["numerical_rank"] = OrNull(p.numerical_rank);
  json["condition"] = RoundedOrNull(p.condition.value);
  json["condition_method"] = p.condition.method;
  json["redundancy"] = RoundedOrNull(p.redundancy);
  json["mass_ratio"] = RoundedOrNull(p.mass_ratio);
  json["kinds"] = Json::object();
  for (const auto& [kind, count] : p.kinds) json["kinds"][kind] = count;
  json["fraction_active"] = entry.answer ? Rounded(entry.answer->fraction_active) : Json(nullptr);
  json["degenerate"] = entry.answer ? Json(entry.answer->degenerate) : Json(nullptr);
  json["reference"] = Describe(entry.reference);
  json["provenance"] = entry.provenance;
  json["licence"] = entry.licence;
  json["sha256"] = entry.sha256;
  return json;
}

Json Describe(const SequenceEntry& entry) {
  Json json;
  json["id"] = entry.id;
  json["family"] = entry.family;
  json["start"] = Describe(entry.start);
  json["steps"] = entry.steps;
  json["problems"] = entry.problems;
  json["rows"] = {{"least", entry.least_rows}, {"median", entry.median_rows}, {"most", entry.most_rows}};
  json["unsolvable"] = entry.unsolvable;
  json["changes"] = {{"entered", entry.entered},
                     {"left", entry.left},
                     {"activated", entry.activated},
                     {"deactivated", entry.deactivated}};
  json["churn"] = Rounded(entry.churn);
  json["still_share"] = Rounded(entry.still_share);
  json["provenance"] = entry.provenance;
  json["licence"] = entry.licence;
  json["sha256"] = entry.sha256;
  return json;
}

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

Json Describe(const Refusal& refusal) { return {{"id", refusal.id}, {"reason", refusal.reason}}; }

// One item a line.
std::string Lines(const std::vector<Json>& items) {
  std::string text = "[";
  for (size_t k = 0; k < items.size(); ++k) text += (k == 0 ? "\n  " : ",\n  ") + items[k].dump();
  return text + (items.empty() ? "]" : "\n ]");
}

template <typename Item>
std::vector<Json> DescribeAll(const std::vector<Item>& items) {
  std::vector<Json> described;
  described.reserve(items.size());
  for (const Item& item : items) described.push_back(Describe(item));
  return described;
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

// ----- reading

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

Recipe ReadRecipe(const JsonField& field) {
  Recipe recipe;
  recipe.scene = field["scene"].String();
  recipe.rows = PositiveInteger(field["rows"]);
  recipe.seed = Seed(field["seed"]);
  if (field.Has("changes")) {
    for (const JsonField& change : field["changes"].Items()) {
      recipe.changes.push_back({change["name"].String(), change["amount"].Number()});
    }
  }
  if (field.Has("motion_step")) recipe.motion_step = PositiveInteger(field["motion_step"]);
  return recipe;
}

std::string ReadHash(const JsonField& field) {
  constexpr size_t kDigits = 64;
  std::string hash = field.String();
  if (hash.size() != kDigits || hash.find_first_not_of("0123456789abcdef") != std::string::npos) {
    field.Mismatch("a SHA-256 of 64 hexadecimal digits");
  }
  return hash;
}

std::string TextOr(const JsonField& field, const char* key) { return field.Has(key) ? field[key].String() : ""; }

std::optional<double> NumberOrNothing(const JsonField& field, const char* key) {
  return field.Has(key) ? field[key].NumberOrNull() : std::nullopt;
}

std::optional<Index> CountOrNothing(const JsonField& field, const char* key) {
  return field.Has(key) && !field[key].IsNull() ? std::optional<Index>(field[key].Integer()) : std::nullopt;
}

std::optional<bool> TruthOrNothing(const JsonField& field, const char* key) {
  return field.Has(key) && !field[key].IsNull() ? std::optional<bool>(field[key].Boolean()) : std::nullopt;
}

ProblemProperties ReadProperties(const JsonField& field) {
  ProblemProperties p;
  p.rows = field["rows"].Integer();
  p.bilateral = CountOrNothing(field, "bilateral").value_or(0);
  p.bodies = CountOrNothing(field, "bodies").value_or(0);
  p.nonzeros_A = CountOrNothing(field, "nonzeros_A").value_or(0);
  p.nonzeros_J = CountOrNothing(field, "nonzeros_J");
  p.rank = {CountOrNothing(field, "rank"), TextOr(field, "rank_method")};
  p.numerical_rank = CountOrNothing(field, "numerical_rank");
  p.condition = {NumberOrNothing(field, "condition"), TextOr(field, "condition_method")};
  p.redundancy = NumberOrNothing(field, "redundancy");
  p.mass_ratio = NumberOrNothing(field, "mass_ratio");
  if (field.Has("kinds")) {
    for (const auto& [kind, count] : field["kinds"].Members()) p.kinds[kind] = count.Integer();
  }
  return p;
}

ReferenceSummary ReadReference(const JsonField& field) {
  ReferenceSummary reference;
  reference.kind = field["kind"].String();
  reference.status = TextOr(field, "status");
  reference.f_unique = TruthOrNothing(field, "f_unique");
  reference.nullity_on_active = CountOrNothing(field, "nullity_on_active");
  reference.strictly_complementary = TruthOrNothing(field, "strictly_complementary");
  reference.proof = TextOr(field, "proof");
  reference.energy_bound = NumberOrNothing(field, "energy_bound");
  reference.energy_shift = NumberOrNothing(field, "energy_shift");
  reference.w_bound = NumberOrNothing(field, "w_bound");
  reference.f_bound = NumberOrNothing(field, "f_bound");
  reference.detail = TextOr(field, "detail");
  return reference;
}

ManifestEntry ReadEntry(const JsonField& field) {
  ManifestEntry entry;
  entry.id = field["id"].String();
  entry.family = field["family"].String();
  entry.base = entry.id;
  if (field.Has("recipe") || !field.Has("file")) {
    Recipe recipe = ReadRecipe(field["recipe"]);
    entry.base = BaseOf(recipe);
    if (recipe.motion_step > 0) entry.origin = "motion";
    entry.source = recipe;
    if (field.Has("file")) entry.remake = std::move(recipe);
  }
  if (field.Has("file")) {
    entry.source =
        FileSource{field["file"]["path"].String(), static_cast<std::size_t>(PositiveInteger(field["file"]["line"]))};
  }
  entry.grid = TextOr(field, "grid");
  entry.purpose = TextOr(field, "purpose");
  entry.properties = ReadProperties(field);
  const std::optional<double> active = NumberOrNothing(field, "fraction_active");
  if (active.has_value()) entry.answer = {*active, CountOrNothing(field, "degenerate").value_or(0)};
  if (field.Has("reference")) entry.reference = ReadReference(field["reference"]);
  entry.provenance = TextOr(field, "provenance");
  entry.licence = TextOr(field, "licence");
  entry.sha256 = ReadHash(field["sha256"]);
  return entry;
}

void ReadFillClass(const JsonField& field, Manifest* manifest) {
  FillClass fill;
  fill.size_class = field["size_class"].String();
  fill.sha256 = ReadHash(field["sha256"]);
  const size_t before = manifest->fill.size();
  for (const JsonField& group : field["recipes"].Items()) {
    Recipe recipe;
    recipe.scene = group["scene"].String();
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

SequenceEntry ReadSequence(const JsonField& field) {
  SequenceEntry entry;
  entry.id = field["id"].String();
  entry.family = field["family"].String();
  entry.start = ReadRecipe(field["start"]);
  entry.steps = PositiveInteger(field["steps"]);
  entry.problems = PositiveInteger(field["problems"]);
  entry.most_rows = PositiveInteger(field["rows"]["most"]);
  entry.sha256 = ReadHash(field["sha256"]);
  return entry;
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

std::map<std::string, double> WeightsByBase(const std::vector<ManifestEntry>& problems) {
  std::map<std::string, double> weights;
  for (const ManifestEntry& entry : problems) weights[entry.base] += 1;
  for (auto& [base, weight] : weights) weight = 1 / weight;
  return weights;
}

ProblemSource::ProblemSource(std::string folder) : folder_(std::move(folder)) {}

LcpProblem ProblemSource::Get(const ManifestEntry& entry) {
  if (const auto* recipe = std::get_if<Recipe>(&entry.source)) return MakeInstance(*recipe).problem;
  return Read(std::get<FileSource>(entry.source));
}

LcpProblem ProblemSource::Read(const FileSource& source) {
  const std::string path = (std::filesystem::path(folder_) / source.path).string();
  if (FormatOfFile(path) != ProblemFormat::kJsonLines) return ReadProblemFile(path);
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
  member("refused", Lines(DescribeAll(manifest.refused)));
  member("problems", Lines(DescribeAll(manifest.problems)));
  if (!manifest.fill.empty()) member("fill", Lines(DescribeFill(manifest)));
  member("sequences", Lines(DescribeAll(manifest.sequences)), true);
  return text + "}\n";
}

Manifest ReadManifest(const std::string& path) {
  std::ifstream file(path);
  if (!file || std::filesystem::is_directory(path)) throw InputError(path + ": cannot be opened for reading");
  std::stringstream text;
  text << file.rdbuf();
  const nlohmann::json document = ParseJsonObject(text.str(), path);
  const JsonField root(document, path);
  if (root["lcpbench_manifest"].Integer() != kFormat) {
    root["lcpbench_manifest"].Mismatch("the format's number " + std::to_string(kFormat));
  }
  Manifest manifest;
  manifest.name = root["name"].String();
  manifest.version = root["version"].String();
  if (root.Has("purpose")) manifest.purpose = root["purpose"].String();
  if (root.Has("references")) manifest.references = root["references"].String();
  std::set<std::string> ids;
  const auto once = [&ids](const JsonField& item, const std::string& id) {
    if (!ids.insert(id).second) item["id"].Mismatch("an id of its own");
  };
  for (const JsonField& item : root["problems"].Items()) {
    manifest.problems.push_back(ReadEntry(item));
    once(item, manifest.problems.back().id);
  }
  if (root.Has("fill")) {
    for (const JsonField& item : root["fill"].Items()) {
      const size_t before = manifest.fill.size();
      ReadFillClass(item, &manifest);
      for (size_t k = before; k < manifest.fill.size(); ++k) {
        if (!ids.insert(manifest.fill[k].id).second) item["recipes"].Mismatch("ids of their own");
      }
    }
  }
  if (root.Has("sequences")) {
    for (const JsonField& item : root["sequences"].Items()) {
      manifest.sequences.push_back(ReadSequence(item));
      once(item, manifest.sequences.back().id);
    }
  }
  return manifest;
}

}  // namespace lcpbench
