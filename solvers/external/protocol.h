#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

// The binary protocol between lcpbench (the host) and a solver in a process of its own (the worker). Anyone can write a
// worker, in any language: the host starts its command and talks to it through its standard input and output.
//
// Every message is a frame: u32 type, u64 length of the payload in bytes, payload. Little-endian, packed; "string" is
// u32 length and bytes (UTF-8), f64 an IEEE double, n the number of rows.
//
//   worker  kHello     u32 protocol version (1), u8 form that it wants (WantedForm), string name, string version,
//                      string licence.  First of all, unasked.
//   host    kProblem   u64 n, u8 form, u8 symmetric and u8 positive semidefinite (1 = proved), f64 b[n], u8
//   bilateral[n]
//                      (1: w = 0, f free), then by form:
//                        0 dense     f64 A[n n], row after row
//                        1 sparse    CSR(n, n) of A, both triangles, every diagonal entry
//                        2 factors   u64 columns, CSR(n, columns) of J, f64 inverse_mass[columns]; A = J M^-1 J^T
//                      CSR: u64 entries, i32 row_start[n + 1], i32 column[entries], f64 value[entries]
//   worker  kPrepared  f64 seconds spent on converting the problem, string why it is unsupported ("" if it is not)
//   host    kSolve     f64 tolerance on rho, f64 time limit [s] (may be infinite), i64 iteration limit (0: default),
//                      u64 repetitions >= 1, u8 has_start, f64 start[n] if it has
//   worker  kResult    string status (keys of LcpStatus: "solved", "infeasible", "iteration_limit", ...),
//                      i64 iterations, f64 seconds per solve around the solve alone (mean over the repetitions),
//                      f64 seconds per solve of conversions besides, string detail, f64 f[n],
//                      u8 has_ray, f64 ray[n] if it has (Farkas ray, solver.h)
//   host    kQuit      empty: the worker ends
//
// The host repeats kProblem and kSolve as it likes. A worker that breaks the protocol, ends, or does not answer in time
// is killed, the solve counts as failed, and a new worker is started for the next one.

/// Workers of another version are refused.
inline constexpr std::uint32_t kProtocolVersion = 1;
/// A frame that claims more is refused before anything is allocated.
inline constexpr std::uint64_t kLargestPayload = std::uint64_t{1} << 36U;

/// What a frame holds.
enum class MessageType : std::uint32_t { kHello = 1, kProblem = 2, kPrepared = 3, kSolve = 4, kResult = 5, kQuit = 6 };

/// In which form a worker wants its problems. kAsGiven takes every form as it comes.
enum class WantedForm : std::uint8_t { kDense = 0, kSparse = 1, kAsGiven = 2 };

/// What a worker says of itself.
struct Hello {
  std::uint32_t version = kProtocolVersion;  ///< of the protocol
  WantedForm form = WantedForm::kDense;      ///< of the problems it gets
  std::string name;                          ///< of the method
  std::string library_version;               ///< of the library behind it
  std::string licence;                       ///< SPDX expression of the library
};

/// The worker's answer to a problem.
struct Prepared {
  double convert_s = 0;         ///< conversion into the library's form [s]
  std::string why_unsupported;  ///< "" where the worker takes the problem
};

/// LcpOptions as the protocol carries them.
struct SolveRequest {
  double tolerance = 1e-9;               ///< on rho
  double time_limit_s = 0;               ///< [s], may be infinite
  std::int64_t max_iterations = 0;       ///< 0: the worker's default
  std::uint64_t repetitions = 1;         ///< how often to solve, >= 1
  std::optional<Eigen::VectorXd> start;  ///< n values of a warm start
};

/// The payload of a frame.
using Bytes = std::vector<char>;

/// kHello.
Bytes Encode(const Hello& hello);
/// kProblem, in the form that the worker wants.
Bytes Encode(const LcpProblem& problem, WantedForm form);
/// kPrepared.
Bytes Encode(const Prepared& prepared);
/// kSolve.
Bytes Encode(const SolveRequest& request);
/// kResult.
Bytes Encode(const LcpResult& result);

/// Each throws std::runtime_error, saying which field, where the payload does not hold what the protocol prescribes.
/// Nothing is allocated beyond what the payload really holds.
Hello DecodeHello(const Bytes& payload);
/// As DecodeHello, for kProblem.
LcpProblem DecodeProblem(const Bytes& payload);
/// As DecodeHello, for kPrepared.
Prepared DecodePrepared(const Bytes& payload);
/// As DecodeHello, for kSolve.
/// @param rows  of the problem that was sent before
SolveRequest DecodeSolve(const Bytes& payload, Index rows);
/// As DecodeHello, for kResult.
/// @param rows  of the problem that was solved
LcpResult DecodeResult(const Bytes& payload, Index rows);

}  // namespace lcpbench
