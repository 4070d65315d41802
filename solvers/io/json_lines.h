#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {

/// One line of a problem file: the problem, and what the record says of its answer.
struct LcpRecord {
  LcpProblem problem;      ///< in the form of the record
  LcpReference reference;  ///< kUnknown where the record says nothing
  std::string category;    ///< "" where the record names none
  /// LcpProblem::Asymmetry() of the matrix that (A + A^T) / 2 was made of; nothing where it stayed as it was.
  std::optional<double> symmetrized = std::nullopt;
  /// Members that are in no schema (docs/formats/problem.schema.json) and were ignored, as JSON pointers.
  std::vector<std::string> unknown_members = {};
};

/// Parses one JSON line:
///   id         string or number (default: `where`)
///   n          optional, checked against b
///   J and invM the factors; they win over A when both are given
///   A          otherwise
///   b          n numbers
///   bilateral  row indices, 0-based, default none (or `joint`: n booleans; or contacts[i].joint); where several
///              of them are given, they must agree
///   friction   {"row", "normal", "mu", "slip"}, lists of equal length, slip optional: FrictionRow
///   bounded    {"row", "lower", "upper"}, lists of equal length, null for infinite: BoundedRow
///   status, w, f_minnorm, f_unique, rank_A, category  optional, what is known of the answer; null: not known. Where
///              there are friction or bounded rows also w_unique and solvable; w is read only where w_unique is true
///   symmetrized  optional, see LcpRecord
/// Members that other tools use for what is spelled otherwise here, or not expressed, are refused by name: bounds,
/// mu, the matrices of programs and of motion (not h beside contacts, a time step). Other members are ignored
/// (LcpRecord::unknown_members), and so are family, base, licence and provenance of the collection, previous, floor and
/// motion of sequences, and f. A key that stands twice in an object is refused. A matrix is a list of rows, a flat
/// row-major list, or {"shape":[r,c],"row":[...],"col":[...],"val":[...]} with 0-based indices (equal positions add
/// up). A number is a JSON number or a string "p/q" or "p", rounded once to the nearest double.
/// @param where  "file:line", the start of every error text
/// @throws InputError naming where, the field, what was expected and what was found
LcpRecord ParseLcpRecord(std::string_view line, const std::string& where);

/// One line that ParseLcpRecord reads back bit for bit: the given form, b, kinds of rows.
/// @param with_matrix  also writes A (as coordinates) where the problem is given by factors
/// @param symmetrized  of LcpRecord
/// @param id           instead of the problem's
std::string FormatLcpRecord(const LcpProblem& problem, bool with_matrix = false,
                            std::optional<double> symmetrized = std::nullopt,
                            const std::optional<std::string>& id = std::nullopt);

/// What a solve record says besides the answer.
struct SolveNotes {
  double setup_s = 0;            ///< of Prepare [s]
  double time_s = 0;             ///< of Solve [s]
  std::optional<bool> f_unique;  ///< whether f is the only solution; nothing: not known
  /// How the solution of least norm was found.
  struct LeastNorm {
    Index nullity;          ///< free directions of the forces
    double rank_tolerance;  ///< by which they were found
  };
  std::optional<LeastNorm> least_norm;  ///< where f is the solution of least norm
};

/// One line for a solve: id, solver, status, f, f_unique, w, iterations, setup_s, time_s, metrics, verdict, detail, and
/// where there are such least_norm, the ray and what LcpRecord calls symmetrized. Numbers that are not finite become
/// null.
std::string FormatSolveRecord(const LcpRecord& record, std::string_view solver, const LcpResult& result,
                              const Verdict& verdict, const SolveNotes& notes);

}  // namespace lcpbench
