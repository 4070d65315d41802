#include "solvers/io/json_lines.h"

#include <boost/multiprecision/cpp_int.hpp>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "solvers/lcp/metric_table.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;

[[noreturn]] void Reject(const std::string& where, const std::string& field, const std::string& what) {
  throw InputError(where + ": field '" + field + "': " + what);
}

std::string Describe(const Json& value) {
  if (value.is_array()) return "a list of " + std::to_string(value.size());
  if (value.is_object()) return "an object";
  std::string text = value.dump();
  constexpr std::size_t kLongest = 40;
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "...";
  return text;
}

bool IsInteger(std::string_view text) {
  if (!text.empty() && (text.front() == '-' || text.front() == '+')) text.remove_prefix(1);
  return !text.empty() && text.find_first_not_of("0123456789") == std::string_view::npos;
}

// A JSON number or an exact "p/q": rounded once, to the nearest double.
double ParseNumber(const Json& value, const std::string& where, const std::string& field) {
  if (value.is_number()) {
    const double number = value.get<double>();
    if (!std::isfinite(number)) Reject(where, field, "expected a finite number, found " + Describe(value));
    return number;
  }
  if (value.is_string()) {
    const std::string text = value.get<std::string>();
    const auto slash = text.find('/');
    const std::string numerator = text.substr(0, slash);
    const std::string denominator = slash == std::string::npos ? "1" : text.substr(slash + 1);
    // A sign belongs to the numerator; a digit count beyond any double's range is refused before it costs time.
    constexpr std::size_t kLongest = 4000;
    if (IsInteger(numerator) && IsInteger(denominator) && denominator.front() != '-' && denominator.front() != '+' &&
        text.size() <= kLongest) {
      using boost::multiprecision::cpp_int;
      using boost::multiprecision::cpp_rational;
      const auto unsigned_text = [](const std::string& digits) {
        const auto first = digits.find_first_not_of("+-0");
        return first == std::string::npos ? std::string("0") : digits.substr(first);  // no octal by leading zeros
      };
      const cpp_int p(unsigned_text(numerator));
      const cpp_int q(unsigned_text(denominator));
      if (q != 0) {
        const double magnitude = cpp_rational(p, q).convert_to<double>();
        if (std::isfinite(magnitude)) return numerator.front() == '-' ? -magnitude : magnitude;
      }
    }
  }
  Reject(where, field, "expected a finite number or \"p/q\", found " + Describe(value));
}

const Json& Member(const Json& object, const std::string& where, const std::string& field) {
  const auto found = object.find(field);
  if (found == object.end()) Reject(where, field, "is missing");
  return *found;
}

Eigen::VectorXd ParseVector(const Json& value, const std::string& where, const std::string& field) {
  if (!value.is_array()) Reject(where, field, "expected a list of numbers, found " + Describe(value));
  Eigen::VectorXd vector(static_cast<Index>(value.size()));
  for (std::size_t i = 0; i < value.size(); ++i) {
    vector[static_cast<Index>(i)] = ParseNumber(value[i], where, field + "[" + std::to_string(i) + "]");
  }
  return vector;
}

Index ParseIndex(const Json& value, Index limit, const std::string& where, const std::string& field) {
  if (!value.is_number_integer() || value.get<double>() < 0 || value.get<double>() >= static_cast<double>(limit)) {
    Reject(where, field, "expected an index in [0, " + std::to_string(limit) + "), found " + Describe(value));
  }
  return value.get<Index>();
}

// What a matrix field holds, before anyone allocates: dense rows stay dense, coordinates stay sparse.
struct ParsedMatrix {
  bool is_dense = false;
  Eigen::MatrixXd dense;
  SparseMatrix sparse;
};

[[noreturn]] void RejectShape(const std::string& where, const std::string& field, Index rows, Index cols,
                              const std::string& found) {
  Reject(where, field,
         "expected " + std::to_string(rows) + " rows of " + std::to_string(cols) + " columns, found " + found);
}

ParsedMatrix ParseMatrix(const Json& value, Index rows, Index cols, const std::string& where,
                         const std::string& field) {
  ParsedMatrix matrix;
  if (value.is_object()) {
    const auto part = [&](const char* name) -> const Json& {
      const auto found = value.find(name);
      if (found == value.end() || !found->is_array()) Reject(where, field + "." + name, "expected a list");
      return *found;
    };
    const Json& shape = part("shape");
    if (shape.size() != 2 || shape[0] != rows || shape[1] != cols) {
      Reject(where, field + ".shape",
             "expected [" + std::to_string(rows) + "," + std::to_string(cols) + "], found " + shape.dump());
    }
    const Json& row = part("row");
    const Json& col = part("col");
    const Json& val = part("val");
    if (row.size() != val.size() || col.size() != val.size()) {
      Reject(where, field,
             "row, col and val must be equally long, found " + std::to_string(row.size()) + ", " +
                 std::to_string(col.size()) + ", " + std::to_string(val.size()));
    }
    std::vector<Eigen::Triplet<double, int>> entries;
    entries.reserve(val.size());
    for (std::size_t k = 0; k < val.size(); ++k) {
      const std::string at = "[" + std::to_string(k) + "]";
      entries.emplace_back(static_cast<int>(ParseIndex(row[k], rows, where, field + ".row" + at)),
                           static_cast<int>(ParseIndex(col[k], cols, where, field + ".col" + at)),
                           ParseNumber(val[k], where, field + ".val" + at));
    }
    matrix.sparse.resize(rows, cols);
    matrix.sparse.setFromTriplets(entries.begin(), entries.end());
    return matrix;
  }
  if (!value.is_array()) Reject(where, field, "expected a matrix, found " + Describe(value));
  matrix.is_dense = true;
  const bool flat = !value.empty() && !value[0].is_array();
  if (flat) {
    if (value.size() != static_cast<std::size_t>(rows * cols)) {
      RejectShape(where, field, rows, cols, "a flat list of " + std::to_string(value.size()));
    }
    matrix.dense.resize(rows, cols);
    for (Index k = 0; k < rows * cols; ++k) {
      matrix.dense(k / cols, k % cols) =
          ParseNumber(value[static_cast<std::size_t>(k)], where, field + "[" + std::to_string(k) + "]");
    }
    return matrix;
  }
  if (value.size() != static_cast<std::size_t>(rows)) {
    RejectShape(where, field, rows, cols, std::to_string(value.size()) + " rows");
  }
  for (std::size_t i = 0; i < value.size(); ++i) {
    if (!value[i].is_array() || value[i].size() != static_cast<std::size_t>(cols)) {
      RejectShape(where, field + "[" + std::to_string(i) + "]", rows, cols, Describe(value[i]));
    }
  }
  matrix.dense.resize(rows, cols);
  for (Index i = 0; i < rows; ++i) {
    matrix.dense.row(i) =
        ParseVector(value[static_cast<std::size_t>(i)], where, field + "[" + std::to_string(i) + "]").transpose();
  }
  return matrix;
}

std::vector<Index> ParseBilateral(const Json& record, Index n, const std::string& where) {
  std::vector<Index> rows;
  if (const auto found = record.find("bilateral"); found != record.end()) {
    if (!found->is_array()) Reject(where, "bilateral", "expected a list of row indices, found " + Describe(*found));
    for (std::size_t k = 0; k < found->size(); ++k) {
      rows.push_back(ParseIndex((*found)[k], n, where, "bilateral[" + std::to_string(k) + "]"));
    }
    return rows;
  }
  // Recorded contact problems mark joints per row instead.
  const auto add_if = [&](const Json& flag, std::size_t i, const std::string& field) {
    if (!flag.is_boolean()) Reject(where, field, "expected true or false, found " + Describe(flag));
    if (flag.get<bool>()) rows.push_back(static_cast<Index>(i));
  };
  if (const auto joint = record.find("joint"); joint != record.end() && joint->is_array()) {
    if (joint->size() != static_cast<std::size_t>(n)) {
      Reject(where, "joint", "expected " + std::to_string(n) + " entries, found " + std::to_string(joint->size()));
    }
    for (std::size_t i = 0; i < joint->size(); ++i) add_if((*joint)[i], i, "joint[" + std::to_string(i) + "]");
  } else if (const auto contacts = record.find("contacts"); contacts != record.end() && contacts->is_array()) {
    if (contacts->size() != static_cast<std::size_t>(n)) {
      Reject(where, "contacts",
             "expected " + std::to_string(n) + " entries, found " + std::to_string(contacts->size()));
    }
    for (std::size_t i = 0; i < contacts->size(); ++i) {
      const Json& contact = (*contacts)[i];
      const std::string field = "contacts[" + std::to_string(i) + "]";
      if (!contact.is_object()) Reject(where, field, "expected an object, found " + Describe(contact));
      if (contact.contains("joint")) add_if(contact["joint"], i, field + ".joint");
    }
  }
  return rows;
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

}  // namespace

LcpRecord ParseLcpRecord(std::string_view line, const std::string& where) {
  Json record;
  try {
    record = Json::parse(line);
  } catch (const Json::exception& error) {
    // The library's text starts with its own tag in brackets.
    const std::string text = error.what();
    const auto tag_end = text.find("] ");
    throw InputError(where +
                     ": not a JSON record: " + (tag_end == std::string::npos ? text : text.substr(tag_end + 2)));
  }
  if (!record.is_object()) throw InputError(where + ": expected a JSON object, found " + Describe(record));

  std::string id = where;
  if (const auto found = record.find("id"); found != record.end()) {
    if (found->is_string()) {
      id = found->get<std::string>();
    } else if (found->is_number()) {
      id = found->dump();
    } else {
      Reject(where, "id", "expected a string or a number, found " + Describe(*found));
    }
  }
  Eigen::VectorXd b = ParseVector(Member(record, where, "b"), where, "b");
  const Index n = b.size();
  if (const auto found = record.find("n"); found != record.end() && *found != n) {
    Reject(where, "n", "expected the length of b, " + std::to_string(n) + ", found " + Describe(*found));
  }

  MatrixFacts facts;
  if (const auto rank = record.find("rank_A"); rank != record.end() && rank->is_number_integer()) {
    facts.rank = rank->get<Index>();
  }
  if (const auto unique = record.find("f_unique"); unique != record.end() && unique->is_boolean()) {
    facts.f_unique = unique->get<bool>();
  }
  LcpReference reference;
  const auto status = record.find("status");
  if (status != record.end() && status->is_string()) {
    if (*status == "solved") reference.status = LcpReference::Status::kSolved;
    if (*status == "infeasible") reference.status = LcpReference::Status::kInfeasible;
  }
  const auto answer = [&](const char* field) -> std::optional<Eigen::VectorXd> {
    const auto found = record.find(field);
    if (found == record.end() || !found->is_array()) return std::nullopt;
    Eigen::VectorXd vector = ParseVector(*found, where, field);
    if (vector.size() != n) {
      Reject(where, field, "expected " + std::to_string(n) + " entries, found " + std::to_string(vector.size()));
    }
    return vector;
  };
  if (reference.status == LcpReference::Status::kSolved) {
    reference.w = answer("w");
    if (facts.f_unique.value_or(false)) reference.f = answer("f_minnorm");
  }
  std::string category;
  if (const auto found = record.find("category"); found != record.end() && found->is_string()) {
    category = found->get<std::string>();
  }

  const std::vector<Index> bilateral = ParseBilateral(record, n, where);
  try {
    RowBounds bounds = RowBounds::WithBilateralRows(n, bilateral);
    if (record.contains("J")) {
      Eigen::VectorXd inverse_mass = ParseVector(Member(record, where, "invM"), where, "invM");
      ParsedMatrix J = ParseMatrix(record["J"], n, inverse_mass.size(), where, "J");
      if (J.is_dense) J.sparse = J.dense.sparseView(1.0, 0.0);
      return {LcpProblem::FromFactors(std::move(id), J.sparse, std::move(inverse_mass), std::move(b), std::move(bounds),
                                      facts),
              std::move(reference), std::move(category)};
    }
    if (!record.contains("A")) throw InputError(where + ": expected field 'A', or 'J' with 'invM'");
    ParsedMatrix A = ParseMatrix(record["A"], n, n, where, "A");
    LcpProblem problem =
        A.is_dense ? LcpProblem::FromDense(std::move(id), std::move(A.dense), std::move(b), std::move(bounds), facts)
                   : LcpProblem::FromSparse(std::move(id), A.sparse, std::move(b), std::move(bounds), facts);
    return {std::move(problem), std::move(reference), std::move(category)};
  } catch (const InputError& error) {
    const std::string text = error.what();
    throw InputError(text.starts_with(where) ? text : where + ": " + text);
  }
}

LcpReader::LcpReader(std::istream& input, std::string name) : input_(input), name_(std::move(name)) {}

std::optional<LcpRecord> LcpReader::Next() {
  while (std::getline(input_, line_)) {
    ++line_number_;
    if (line_.find_first_not_of(" \t\r") == std::string::npos) continue;
    return ParseLcpRecord(line_, name_ + ":" + std::to_string(line_number_));
  }
  return std::nullopt;
}

std::vector<LcpRecord> ReadLcpFile(const std::string& path) {
  std::ifstream file(path);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  LcpReader reader(file, path);
  std::vector<LcpRecord> records;
  while (std::optional<LcpRecord> record = reader.Next()) records.push_back(std::move(*record));
  return records;
}

std::string FormatLcpRecord(const LcpProblem& problem, bool with_matrix) {
  nlohmann::ordered_json record;
  record["id"] = problem.id();
  record["n"] = problem.size();
  if (problem.has_factors()) {
    record["invM"] = ToJson(problem.inverse_mass());
    record["J"] = ToJson(problem.J());
  }
  if (with_matrix || !problem.has_factors()) record["A"] = ToJson(problem.SparseA());
  record["b"] = ToJson(problem.b());
  record["bilateral"] = problem.bilateral_rows();
  return record.dump();
}

std::string FormatSolveRecord(const LcpProblem& problem, std::string_view solver, const LcpResult& result,
                              const Verdict& verdict, double setup_s, double time_s) {
  nlohmann::ordered_json record;
  record["id"] = problem.id();
  record["solver"] = solver;
  record["status"] = ToString(result.status);
  record["f"] = ToJson(result.f);
  record["w"] = ToJson(verdict.metrics.w);
  record["iterations"] = result.iterations;
  record["setup_s"] = setup_s;
  record["time_s"] = time_s;
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
  if (verdict.farkas.has_value()) {
    const FarkasVerdict& farkas = *verdict.farkas;
    judgement["farkas"] = {{"accepted", farkas.accepted},
                           {"b_dot_y", ToJson(farkas.b_dot_y)},
                           {"force_min", ToJson(farkas.force_min)},
                           {"reason", farkas.reason}};
  }
  record["verdict"] = judgement;
  record["detail"] = result.detail;
  if (result.farkas_ray.has_value()) record["farkas_ray"] = ToJson(*result.farkas_ray);
  // A library's message may hold any bytes; the line must stay valid JSON.
  return record.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace lcpbench
