#include "solvers/exact/exact_input.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "solvers/io/json_lines.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using Json = nlohmann::json;

struct Entry {
  Index row;
  Index column;
  Rational value;
};

// Converts what ParseLcpRecord has found to be a number or "p/q".
Rational RationalOf(const Json& value) {
  if (!value.is_string()) return Rational(value.get<double>());
  std::string text = value.get<std::string>();
  if (text.front() == '+') text.erase(0, 1);
  Rational rational;
  mpq_set_str(rational.backend().data(), text.c_str(), 10);
  mpq_canonicalize(rational.backend().data());
  return rational;
}

std::vector<Entry> Entries(const SparseMatrix& matrix) {
  std::vector<Entry> entries;
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(matrix, i); it; ++it) entries.push_back({i, it.col(), Rational(it.value())});
  }
  return entries;
}

// The three forms of a matrix in a record.
std::vector<Entry> Entries(const Json& matrix, Index columns) {
  std::vector<Entry> entries;
  if (matrix.is_object()) {
    for (size_t k = 0; k < matrix["val"].size(); ++k) {
      entries.push_back({matrix["row"][k].get<Index>(), matrix["col"][k].get<Index>(), RationalOf(matrix["val"][k])});
    }
    return entries;
  }
  Index place = 0;
  const auto add = [&](const Json& value) {
    entries.push_back({place / columns, place % columns, RationalOf(value)});
    ++place;
  };
  for (const Json& row : matrix) {
    if (!row.is_array()) {
      add(row);
      continue;
    }
    for (const Json& value : row) add(value);
  }
  return entries;
}

bool HasStrings(const Json& value) {
  if (value.is_string()) return true;
  if (!value.is_structured()) return false;
  for (const Json& part : value) {
    if (HasStrings(part)) return true;
  }
  return false;
}

// The begin of a message.
std::string Named(const std::string& id) { return id.empty() ? "" : id + ": "; }

// A = J M^-1 J^T, column by column of J.
void Multiply(const std::vector<Entry>& J, const std::vector<Rational>& inverse_mass, ExactLcp* lcp) {
  std::vector<std::vector<const Entry*>> columns(inverse_mass.size());
  for (const Entry& entry : J) {
    if (entry.value != 0) columns[At(entry.column)].push_back(&entry);
  }
  for (size_t k = 0; k < columns.size(); ++k) {
    if (inverse_mass[k] == 0) continue;
    for (const Entry* left : columns[k]) {
      const Rational scaled = left->value * inverse_mass[k];
      for (const Entry* right : columns[k]) {
        lcp->A[At(left->row * lcp->size + right->row)] += scaled * right->value;
      }
    }
  }
}

void SetMatrix(const std::vector<Entry>& entries, ExactLcp* lcp) {
  for (const Entry& entry : entries) lcp->A[At(entry.row * lcp->size + entry.column)] += entry.value;
}

void RequireSymmetric(const ExactLcp& lcp) {
  for (Index i = 0; i < lcp.size; ++i) {
    for (Index j = 0; j < i; ++j) {
      if (lcp.A[At(i * lcp.size + j)] == lcp.A[At(j * lcp.size + i)]) continue;
      throw InputError(Named(lcp.id) + "A is not symmetric: entries (" + std::to_string(i) + ", " + std::to_string(j) +
                       ") and (" + std::to_string(j) + ", " + std::to_string(i) +
                       ") differ; expected a symmetric positive semidefinite matrix, or J and invM");
    }
  }
}

ExactLcp Frame(const LcpProblem& problem) {
  if (problem.size() > kMostExactRows) {
    throw InputError(Named(problem.id()) + "expected at most " + std::to_string(kMostExactRows) +
                     " rows for an exact answer, found " + std::to_string(problem.size()));
  }
  ExactLcp lcp;
  lcp.id = problem.id();
  lcp.size = problem.size();
  lcp.A.resize(At(lcp.size * lcp.size));
  lcp.b.resize(At(lcp.size));
  lcp.bilateral.assign(At(lcp.size), 0);
  for (const Index i : problem.bilateral_rows()) lcp.bilateral[At(i)] = 1;
  lcp.has_factors = problem.has_factors();
  for (const FrictionRow& row : problem.friction_rows()) {
    lcp.friction.push_back({row.row, row.normal, Rational(row.mu), row.slip});
  }
  const auto bound = [](double value) -> std::optional<Rational> {
    if (std::isinf(value)) return std::nullopt;
    return Rational(value);
  };
  for (const BoundedRow& row : problem.bounded_rows()) {
    lcp.bounded.push_back({row.row, bound(row.lower), bound(row.upper)});
  }
  return lcp;
}

// The numbers of friction and bounded rows as the record has them, in its own order of rows.
void ReadLaws(const Json& json, ExactLcp* lcp) {
  const auto place = [](auto& rows, const Json& row) {
    return std::ranges::find(rows, row.get<Index>(), [](const auto& of) { return of.row; });
  };
  if (json.contains("friction") && !json["friction"].is_null()) {
    const Json& friction = json["friction"];
    for (size_t k = 0; k < friction["row"].size(); ++k) {
      place(lcp->friction, friction["row"][k])->mu = RationalOf(friction["mu"][k]);
    }
  }
  if (!json.contains("bounded") || json["bounded"].is_null()) return;
  const Json& bounded = json["bounded"];
  for (size_t k = 0; k < bounded["row"].size(); ++k) {
    const auto row = place(lcp->bounded, bounded["row"][k]);
    if (row->lower) row->lower = RationalOf(bounded["lower"][k]);
    if (row->upper) row->upper = RationalOf(bounded["upper"][k]);
  }
}

}  // namespace

ExactLcp ExactFromAny(const LcpProblem& problem) {
  ExactLcp lcp = Frame(problem);
  for (Index i = 0; i < lcp.size; ++i) lcp.b[At(i)] = Rational(problem.b()[i]);
  if (problem.has_factors()) {
    std::vector<Rational> inverse_mass;
    for (const double value : problem.inverse_mass()) inverse_mass.emplace_back(value);
    Multiply(Entries(problem.J()), inverse_mass, &lcp);
  } else {
    SetMatrix(Entries(problem.SparseA()), &lcp);
  }
  return lcp;
}

ExactLcp ExactFrom(const LcpProblem& problem) {
  ExactLcp lcp = ExactFromAny(problem);
  if (!lcp.has_factors) RequireSymmetric(lcp);
  return lcp;
}

bool HasFractions(std::string_view line) {
  const Json json = Json::parse(line);
  for (const char* field : {"A", "J", "invM", "b", "friction", "bounded"}) {
    if (json.contains(field) && HasStrings(json[field])) return true;
  }
  return false;
}

ExactLcp ParseExactLcp(std::string_view line, const std::string& where) {
  const LcpRecord record = ParseLcpRecord(line, where);
  const Json json = Json::parse(line);
  const bool factors = record.problem.has_factors();
  const Json& matrix = factors ? json["J"] : json["A"];
  if (!HasFractions(line)) return ExactFrom(record.problem);
  ExactLcp lcp = Frame(record.problem);
  for (Index i = 0; i < lcp.size; ++i) lcp.b[At(i)] = RationalOf(json["b"][At(i)]);
  ReadLaws(json, &lcp);
  if (factors) {
    std::vector<Rational> inverse_mass;
    for (const Json& value : json["invM"]) inverse_mass.push_back(RationalOf(value));
    Multiply(Entries(matrix, static_cast<Index>(inverse_mass.size())), inverse_mass, &lcp);
    return lcp;
  }
  SetMatrix(Entries(matrix, lcp.size), &lcp);
  RequireSymmetric(lcp);
  return lcp;
}

}  // namespace lcpbench
