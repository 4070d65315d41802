#include "solvers/io/json_lines.h"

#include <algorithm>
#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <span>
#include <utility>

#include "solvers/lcp/verify.h"
#include "support/input_error.h"
#include "support/json_field.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;

// p/q or p, rounded once, to the nearest double; NaN for what is neither.
double ParseFraction(const std::string& text) {
  using boost::multiprecision::cpp_int;
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const auto parse = [](std::string_view digits) -> std::optional<cpp_int> {
    if (digits.empty() || digits.find_first_not_of("0123456789") != std::string_view::npos) return std::nullopt;
    digits.remove_prefix(std::min(digits.find_first_not_of('0'), digits.size() - 1));  // no octal by leading zeros
    return cpp_int(std::string(digits));
  };
  // A sign belongs to the numerator; a digit count beyond any double's range is refused before it costs time.
  constexpr std::size_t kLongest = 4000;
  if (text.empty() || text.size() > kLongest) return kNone;
  const std::size_t begin = text.front() == '-' || text.front() == '+' ? 1 : 0;
  const std::size_t slash = text.find('/');
  const std::optional<cpp_int> p = parse(std::string_view(text).substr(begin, slash - begin));
  const std::optional<cpp_int> q = slash == std::string::npos ? cpp_int(1) : parse(text.substr(slash + 1));
  if (!p || !q || *q == 0) return kNone;
  const auto magnitude = boost::multiprecision::cpp_rational(*p, *q).convert_to<double>();
  return text.front() == '-' ? -magnitude : magnitude;
}

double ParseNumber(const JsonField& field) {
  const double number = field.IsString()   ? ParseFraction(field.String())
                        : field.IsNumber() ? field.Number()
                                           : std::numeric_limits<double>::quiet_NaN();
  if (!std::isfinite(number)) field.Mismatch("a finite number or \"p/q\"");
  return number;
}

Eigen::VectorXd ParseVector(const JsonField& field, std::optional<std::size_t> size = std::nullopt) {
  Eigen::VectorXd vector(static_cast<Index>(field.Size(size)));
  for (Index i = 0; i < vector.size(); ++i) vector[i] = ParseNumber(field.Item(static_cast<std::size_t>(i)));
  return vector;
}

// What a matrix field holds, before anyone allocates: dense rows stay dense, coordinates stay sparse.
struct ParsedMatrix {
  bool is_dense = false;
  Eigen::MatrixXd dense;
  SparseMatrix sparse;
};

ParsedMatrix ParseMatrix(const JsonField& field, Index rows, Index columns) {
  ParsedMatrix matrix;
  const auto m = static_cast<std::size_t>(rows);
  const auto n = static_cast<std::size_t>(columns);
  if (field.IsObject()) {
    const std::vector<JsonField> shape = field["shape"].Items(2);
    for (const auto& [item, size] : {std::pair{&shape[0], rows}, {&shape[1], columns}}) {
      if (item->Number() != static_cast<double>(size)) item->Mismatch(std::to_string(size));
    }
    const JsonField value = field["val"], row = field["row"], column = field["col"];
    const std::size_t count = value.Size();
    row.Size(count);
    column.Size(count);
    std::vector<Eigen::Triplet<double, int>> entries;
    entries.reserve(count);
    for (std::size_t k = 0; k < count; ++k) {
      entries.emplace_back(row.Item(k).IndexBelow(m), column.Item(k).IndexBelow(n), ParseNumber(value.Item(k)));
    }
    matrix.sparse.resize(rows, columns);
    matrix.sparse.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }
  matrix.is_dense = true;
  if (!field.IsArray()) field.Mismatch("a matrix");
  const std::size_t count = field.Size();
  const bool flat = count > 0 && !field.Item(0).IsArray();
  if (count != (flat ? m * n : m)) {
    field.Mismatch(std::to_string(m) + " rows of " + std::to_string(n) + " columns");
  }
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) {
    const JsonField item = field.Item(i);
    if (flat) values.push_back(ParseNumber(item));
    for (std::size_t j = 0; !flat && j < item.Size(n); ++j) values.push_back(ParseNumber(item.Item(j)));
  }
  using ByRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  matrix.dense = Eigen::Map<const ByRows>(values.data(), rows, columns);
  return matrix;
}

// One flag a row: items of `field` or, in recorded contacts, their member "joint", false where it is missing.
std::vector<Index> MarkedRows(const JsonField& field, std::size_t n, bool by_contact) {
  field.Size(n);
  std::vector<Index> rows;
  for (std::size_t i = 0; i < n; ++i) {
    const JsonField item = field.Item(i);
    if (by_contact && !item.IsObject()) item.Mismatch("an object");
    if (by_contact && !item.Has("joint")) continue;
    if ((by_contact ? item["joint"] : item).Boolean()) rows.push_back(static_cast<Index>(i));
  }
  return rows;
}

bool MarksJoints(const JsonField& contacts) {
  for (const JsonField& contact : contacts.Items()) {
    if (contact.Has("joint")) return true;
  }
  return false;
}

// By `bilateral`, `joint` or `contacts`; where several say which rows are bilateral, they must agree.
std::vector<Index> ParseBilateral(const JsonField& record, std::size_t n) {
  std::vector<Index> rows;
  const char* said_by = nullptr;
  const auto agree = [&](const char* key, const std::vector<Index>& by_key) {
    const std::set<Index> before(rows.begin(), rows.end());
    if (said_by != nullptr && before != std::set<Index>(by_key.begin(), by_key.end())) {
      record[key].Fail("contradicts '" + std::string(said_by) + "', expected the same bilateral rows");
    }
    if (said_by == nullptr) rows = by_key;
    said_by = key;
  };
  if (record.Knows("bilateral")) {
    std::vector<Index> by_index;
    for (const JsonField& row : record["bilateral"].Items()) by_index.push_back(row.IndexBelow(n));
    agree("bilateral", by_index);
  }
  // Recorded contact problems mark joints per row instead.
  if (record.Knows("joint")) agree("joint", MarkedRows(record["joint"], n, false));
  if (record.Knows("contacts")) {
    const std::vector<Index> by_contact = MarkedRows(record["contacts"], n, true);
    if (said_by == nullptr || MarksJoints(record["contacts"])) agree("contacts", by_contact);
  }
  return rows;
}

// The three or four lists of `friction`.
std::vector<FrictionRow> ParseFriction(const JsonField& field, std::size_t n) {
  const JsonField row = field["row"], normal = field["normal"], mu = field["mu"];
  const std::size_t count = row.Size();
  normal.Size(count);
  mu.Size(count);
  const bool has_slip = field.Knows("slip");
  if (has_slip) field["slip"].Size(count);
  std::vector<FrictionRow> rows;
  for (std::size_t k = 0; k < count; ++k) {
    FrictionRow friction{row.Item(k).IndexBelow(n), normal.Item(k).IndexBelow(n), ParseNumber(mu.Item(k))};
    if (has_slip) {
      const JsonField slip = field["slip"].Item(k);
      const double sign = slip.Number();
      if (sign != 0 && sign != 1 && sign != -1) slip.Mismatch("-1, 0 or 1");
      friction.slip = static_cast<signed char>(sign);
    }
    rows.push_back(friction);
  }
  return rows;
}

std::vector<BoundedRow> ParseBounded(const JsonField& field, std::size_t n) {
  const JsonField row = field["row"], lower = field["lower"], upper = field["upper"];
  const std::size_t count = row.Size();
  lower.Size(count);
  upper.Size(count);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<BoundedRow> rows;
  for (std::size_t k = 0; k < count; ++k) {
    const JsonField low = lower.Item(k), high = upper.Item(k);
    rows.push_back({row.Item(k).IndexBelow(n), low.IsNull() ? -kInfinity : ParseNumber(low),
                    high.IsNull() ? kInfinity : ParseNumber(high)});
  }
  return rows;
}

// What a record says of the answer; null stands for what is not known.
// @param is_plain  w is unique where A is positive semidefinite; else a record has to say so
void ParseReference(const JsonField& record, std::size_t n, bool is_plain, MatrixFacts* facts,
                    LcpReference* reference) {
  if (record.Knows("rank_A")) facts->rank = record["rank_A"].IndexBelow(n + 1);
  if (record.Knows("columns_per_body")) {
    facts->columns_per_body = static_cast<int>(record["columns_per_body"].IndexBelow(7));
    if (facts->columns_per_body != 3 && facts->columns_per_body != 6) record["columns_per_body"].Mismatch("3 or 6");
  }
  if (record.Knows("f_unique")) facts->f_unique = record["f_unique"].Boolean();
  const std::string status = record.Knows("status") ? record["status"].String() : "";
  const bool solved = status == "solved";
  if (solved) reference->status = LcpReference::Status::kSolved;
  if (status == "infeasible") reference->status = LcpReference::Status::kInfeasible;
  if (record.Knows("solvable")) reference->solvable = record["solvable"].Boolean();
  const bool w_is_unique = record.Knows("w_unique") ? record["w_unique"].Boolean() : is_plain;
  for (const char* key : {"w", "f_minnorm"}) {
    if (!record.Knows(key)) continue;
    record[key].Size(n);
    if (!solved || !w_is_unique) continue;  // a failed solver's may have anything in them
    Eigen::VectorXd vector = ParseVector(record[key], n);
    if (key == std::string_view("w")) {
      reference->w = std::move(vector);
    } else if (facts->f_unique.value_or(false)) {
      reference->f = std::move(vector);
    }
  }
}

constexpr const char* kKnownMembers[] = {
    "id",       "n",        "A",       "J",      "invM",     "b",           "bilateral", "joint",
    "contacts", "status",   "w",       "f",      "rank_A",   "f_minnorm",   "f_unique",  "columns_per_body",
    "category", "family",   "base",    "floor",  "previous", "symmetrized", "licence",   "provenance",
    "motion",   "friction", "bounded", "modes",  "pieces",   "complete",    "f_exact",   "w_exact",
    "w_unique", "solvable", "origin",  "purpose"};

// The members that the objects within a problem may have.
constexpr const char *kCoordinates[] = {"shape", "row", "col", "val"}, *kFriction[] = {"row", "normal", "mu", "slip"},
                     *kBounded[] = {"row", "lower", "upper"};
constexpr std::pair<const char*, std::span<const char* const>> kInnerMembers[] = {
    {"A", kCoordinates}, {"J", kCoordinates}, {"friction", kFriction}, {"bounded", kBounded}};

// What other tools use these for, which a problem does not have.
constexpr std::pair<const char*, const char*> kForeignMembers[] = {
    {"lo", "bounds of f"},        {"hi", "bounds of f"},
    {"lower", "bounds of f"},     {"upper", "bounds of f"},
    {"l", "bounds of f"},         {"u", "bounds of f"},
    {"lb", "bounds of f"},        {"ub", "bounds of f"},
    {"mu", "friction"},           {"G", "constraints"},
    {"h", "constraints"},         {"P", "a quadratic program"},
    {"q", "a quadratic program"}, {"M", "a mass matrix, or A of an LCP"}};

// `h` of recorded contact problems.
bool IsTimeStep(const JsonField& record, std::string_view name) { return name == "h" && record.Has("contacts"); }

// Refuses foreign members. @return those that nobody knows
std::vector<std::string> UnknownMembers(const JsonField& record) {
  for (const auto& [name, meaning] : kForeignMembers) {
    if (!record.Has(name) || IsTimeStep(record, name)) continue;
    record[name].Fail(std::string("a problem has no such member; other tools use it for ") + meaning +
                      "; expected w = A f + b by A (or J and invM), b, bilateral, friction and bounded");
  }
  std::vector<std::string> unknown;
  for (const auto& [name, value] : record.Members()) {
    const bool is_known =
        std::find(std::begin(kKnownMembers), std::end(kKnownMembers), name) != std::end(kKnownMembers);
    if (!is_known && !IsTimeStep(record, name)) {
      unknown.push_back(PointerToken(name));
    }
  }
  for (const auto& [of, known] : kInnerMembers) {
    if (!record.Has(of) || !record[of].IsObject()) continue;
    for (const auto& [name, value] : record[of].Members()) {
      if (std::ranges::find(known, name) == known.end()) {
        unknown.push_back(std::string(of) + "/" + PointerToken(name));
      }
    }
  }
  return unknown;
}

Json ToJson(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json ToJson(const Eigen::VectorXd& vector) {
  Json list = Json::array();
  for (const double value : vector) list.push_back(ToJson(value));
  return list;
}

Json ToJson(const SparseMatrix& matrix) {
  Json row = Json::array();
  Json col = Json::array();
  Json val = Json::array();
  for (Index i = 0; i < matrix.outerSize(); ++i) {
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) {
      row.push_back(i);
      col.push_back(it.col());
      val.push_back(it.value());
    }
  }
  return {{"shape", {matrix.rows(), matrix.cols()}}, {"row", row}, {"col", col}, {"val", val}};
}

void AddLaws(const LcpProblem& problem, nlohmann::ordered_json* record) {
  nlohmann::ordered_json friction, bounded;
  bool slides = false;
  for (const FrictionRow& row : problem.friction_rows()) {
    friction["row"].push_back(row.row);
    friction["normal"].push_back(row.normal);
    friction["mu"].push_back(row.mu);
    friction["slip"].push_back(static_cast<int>(row.slip));
    slides = slides || row.slip != 0;
  }
  for (const BoundedRow& row : problem.bounded_rows()) {
    bounded["row"].push_back(row.row);
    bounded["lower"].push_back(nlohmann::ordered_json(ToJson(row.lower)));
    bounded["upper"].push_back(nlohmann::ordered_json(ToJson(row.upper)));
  }
  if (!slides && !friction.is_null()) friction.erase("slip");
  if (!friction.is_null()) (*record)["friction"] = std::move(friction);
  if (!bounded.is_null()) (*record)["bounded"] = std::move(bounded);
}

}  // namespace

LcpRecord ParseLcpRecord(std::string_view line, const std::string& where) {
  const Json json = ParseJsonObject(line, where);
  const JsonField record(json, where);
  std::vector<std::string> unknown = UnknownMembers(record);
  std::string id = where;
  if (record.Has("id")) id = record["id"].IsNumber() ? json["id"].dump() : record["id"].String();
  Eigen::VectorXd b = ParseVector(record["b"]);
  const Index n = b.size();
  const auto rows = static_cast<std::size_t>(n);
  if (record.Has("n") && json["n"] != n) record["n"].Mismatch("the length of b, " + std::to_string(n));

  MatrixFacts facts;
  LcpReference reference;
  const std::vector<Index> bilateral = ParseBilateral(record, rows);
  RowBounds bounds;
  if (record.Knows("friction")) bounds.friction = ParseFriction(record["friction"], rows);
  if (record.Knows("bounded")) bounds.bounded = ParseBounded(record["bounded"], rows);
  ParseReference(record, rows, bounds.is_plain(), &facts, &reference);
  const std::string category = record.Knows("category") ? record["category"].String() : "";
  std::optional<double> symmetrized;
  if (record.Knows("symmetrized")) {
    symmetrized = record["symmetrized"].Number();
    if (*symmetrized < 0) record["symmetrized"].Mismatch("a number >= 0");
  }

  const auto problem = [&]() -> LcpProblem {
    bounds.bilateral = RowBounds::WithBilateralRows(n, bilateral).bilateral;
    if (record.Has("J")) {
      Eigen::VectorXd inverse_mass = ParseVector(record["invM"]);
      ParsedMatrix J = ParseMatrix(record["J"], n, inverse_mass.size());
      if (J.is_dense) J.sparse = J.dense.sparseView(1.0, 0.0);
      return LcpProblem::FromFactors(std::move(id), J.sparse, std::move(inverse_mass), std::move(b), std::move(bounds),
                                     facts);
    }
    if (!record.Has("A")) throw InputError(where + ": expected field 'A', or 'J' with 'invM'");
    ParsedMatrix A = ParseMatrix(record["A"], n, n);
    if (!A.is_dense) return LcpProblem::FromSparse(std::move(id), A.sparse, std::move(b), std::move(bounds), facts);
    return LcpProblem::FromDense(std::move(id), std::move(A.dense), std::move(b), std::move(bounds), facts);
  };
  try {
    return {problem(), std::move(reference), category, symmetrized, std::move(unknown)};
  } catch (const InputError& error) {
    const std::string text = error.what();
    throw InputError(text.starts_with(where) ? text : where + ": " + text);
  }
}

std::string FormatLcpRecord(const LcpProblem& problem, bool with_matrix, std::optional<double> symmetrized,
                            const std::optional<std::string>& id) {
  nlohmann::ordered_json record;
  record["id"] = id.value_or(problem.id());
  record["n"] = problem.size();
  if (problem.has_factors()) {
    record["invM"] = ToJson(problem.inverse_mass());
    record["J"] = ToJson(problem.J());
    if (problem.columns_per_body() != 3) record["columns_per_body"] = problem.columns_per_body();
  }
  if (with_matrix || !problem.has_factors()) record["A"] = ToJson(problem.SparseA());
  record["b"] = ToJson(problem.b());
  record["bilateral"] = problem.bilateral_rows();
  AddLaws(problem, &record);
  if (symmetrized) record["symmetrized"] = *symmetrized;
  return record.dump();
}

std::string FormatSolveRecord(const LcpRecord& of, std::string_view solver, const LcpResult& result,
                              const Verdict& verdict, const SolveNotes& notes) {
  nlohmann::ordered_json record;
  record["id"] = of.problem.id();
  if (of.symmetrized) record["symmetrized"] = *of.symmetrized;
  record["solver"] = solver;
  record["status"] = ToString(result.status);
  record["f"] = ToJson(result.f);
  record["f_unique"] = notes.f_unique ? Json(*notes.f_unique) : Json(nullptr);
  if (notes.least_norm) {
    record["least_norm"] = {{"nullity", notes.least_norm->nullity},
                            {"rank_tolerance", notes.least_norm->rank_tolerance}};
  }
  record["w"] = ToJson(verdict.metrics.w);
  record["iterations"] = result.iterations;
  record["setup_s"] = notes.setup_s;
  record["time_s"] = notes.time_s;
  nlohmann::ordered_json metrics;
  for (const MetricEntry& metric : AllMetrics()) {
    const double value = verdict.metrics.*metric.value;
    // -1 marks "not applicable" (no reference, A not known to be PSD).
    metrics[std::string(metric.key)] = value == -1 ? Json(nullptr) : ToJson(value);
  }
  record["metrics"] = metrics;
  nlohmann::ordered_json judgement;
  judgement["requested"] = verdict.requested;
  judgement["passes"] = verdict.passes;
  judgement["at_floor"] = verdict.at_floor;
  judgement["best_tier"] = verdict.best_tier > 0 ? Json(verdict.best_tier) : Json(nullptr);
  judgement["false_success"] = verdict.false_success;
  judgement["false_infeasible"] = verdict.false_infeasible;
  judgement["reason"] = verdict.reason;
  if (result.model != FrictionModel::kCoulomb) {
    judgement["model"] = result.model == FrictionModel::kRelaxation ? "relaxation" : "frozen_bounds";
    judgement["model_rho"] = ToJson(verdict.model_rho);
  }
  if (verdict.farkas.has_value()) {
    const FarkasVerdict& farkas = *verdict.farkas;
    judgement["farkas"] = {{"accepted", farkas.accepted},
                           {"proved", farkas.proved},
                           {"b_dot_y", ToJson(farkas.b_dot_y)},
                           {"force_min", ToJson(farkas.force_min)},
                           {"null_residual", ToJson(farkas.null_residual)},
                           {"reason", farkas.reason}};
  }
  record["verdict"] = judgement;
  record["detail"] = result.detail;
  if (result.farkas_ray.has_value()) record["farkas_ray"] = ToJson(*result.farkas_ray);
  // A library's message may hold any bytes; the line must stay valid JSON.
  return record.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lcpbench
