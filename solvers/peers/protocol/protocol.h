#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solvers/lcp/fresh_pass.h"
#include "solvers/lcp/problem.h"
#include "solvers/lcp/solver.h"

namespace lcpbench {

// The binary protocol between lcpbench (the host) and a solver in a process of its own (the worker). Anyone can write a
// worker, in any language: the host starts its command and talks to it through its standard input and output.
//
// Every message is a frame: u32 type, u64 length of the payload in bytes, payload. Little-endian, packed; "string" is
// u32 length and bytes (UTF-8), f64 an IEEE double, n the number of rows of the problem that is spoken of. What differs
// in version 1 follows below.
//
//   worker  kHello     u32 protocol version (2), string name, string version, string licence.  First of all, unasked.
//   host    kProblem   a problem in its given form:
//                      u64 n, u8 form, u8 symmetric and u8 positive semidefinite (1 = proved), i64 rank of A and
//                      i8 whether at most one f solves it (1 yes, 0 no; both -1: not known), f64 b[n], u8 bilateral[n]
//                      (1: w = 0, f free), then by form:
//                        0 dense     f64 A[n n], row after row
//                        1 sparse    CSR(n, n) of A, both triangles, every diagonal entry
//                        2 factors   u64 columns, CSR(n, columns) of J, f64 inverse_mass[columns]; A = J M^-1 J^T
//                      CSR: u64 entries, i32 row_start[n + 1], i32 column[entries], f64 value[entries]
//   host    kOtherB    f64 b[n]: the problem sent last with another b; what is known of its matrix may be kept
//   worker  kLoaded    empty: it holds what was sent, as plain arrays. The answer to kProblem, kOtherB and kStream
//   host    kSolve     f64 tolerance on rho, f64 time limit [s] (may be infinite), i64 iteration limit (0: default),
//                      u8 whether the two parts of the result are wanted, u8 has_start, f64 start[n] if it has
//   worker  kResult    string status (keys of LcpStatus: "solved", "infeasible", "iteration_limit", ...),
//                      i64 iterations, f64 seconds of the library's call alone (of everything where that is not known),
//                      f64 seconds of conversions during the solve (negative: not known), f64 seconds from the arrays
//                      to f in one interval (after kOtherB: from the new b to f), string detail, f64 f[n], u8 has_ray,
//                      f64 ray[n] if it has (Farkas ray, solver.h)
//   host    kStream    u64 count, then so many problems as kProblem has them. They stand beside that of kProblem
//   host    kPass      a pass over the stream (fresh_pass.h): u8 kind (0 fresh, 1 parts, 2 again), f64 tolerance, f64
//                      time limit of a solve [s], f64 budget [s], u32 problems per pair of clock reads, u32 count and
//                      u32 indices of the warm-up, u32 count and u32 indices in the order to be timed, and of kind 2
//                      the other b of each of those, f64 b[n]
//   worker  kPassReply u32 count, then for each: f64 seconds, of problem, of preparation, of conversion, of the solve
//                      (as PassEntry has them), string status, f64 f[n]. By a solver object made for this pass
//   host    kQuit      empty: the worker ends
//
// The host repeats its messages as it likes. A worker that breaks the protocol, ends, or does not answer in time is
// killed, the solve counts as failed, and a new worker is started for the next one.
//
// Version 1 is what a program has to do at the least: kHello, kProblem, kPrepared, kSolve, kResult, kQuit. It has
//   worker  kHello     u32 protocol version (1), u8 form that it wants (WantedForm), string name, ...
//   host    kProblem   without rank and uniqueness, in the form that the worker wants
//   worker  kPrepared  f64 seconds spent on converting the problem, string why it is unsupported ("" if it is not): the
//                      answer to kProblem
//   host    kSolve     between iteration limit and has_start u64 1
//   worker  kResult    without the seconds from the arrays to f
// The host forms A for it, and adds the time of that to the worker's.

/// Of workers written here.
inline constexpr std::uint32_t kProtocolVersion = 2;
/// A frame that claims more is refused before anything is allocated.
inline constexpr std::uint64_t kLargestPayload = std::uint64_t{1} << 36U;

/// What a frame holds.
enum class MessageType : std::uint32_t {
  kNone = 0,  ///< never sent: what is no frame of the protocol
  kHello = 1,
  kProblem = 2,
  kPrepared = 3,
  kSolve = 4,
  kResult = 5,
  kQuit = 6,
  kOtherB = 7,
  kLoaded = 8,
  kStream = 9,
  kPass = 10,
  kPassReply = 11
};

/// In which form a worker of version 1 wants its problems. kAsGiven takes every form as it comes.
enum class WantedForm : std::uint8_t { kDense = 0, kSparse = 1, kAsGiven = 2 };

/// What a worker says of itself.
struct Hello {
  std::uint32_t version = kProtocolVersion;  ///< of the protocol: 1 or 2
  WantedForm form = WantedForm::kAsGiven;    ///< of the problems it gets; version 1 only
  std::string name;                          ///< of the method
  std::string library_version;               ///< of the library behind it
  std::string licence;                       ///< SPDX expression of the library
};

/// The answer of a worker of version 1 to a problem.
struct Prepared {
  double convert_s = 0;         ///< conversion into the library's form [s]
  std::string why_unsupported;  ///< "" where the worker takes the problem
};

/// LcpOptions as the protocol carries them.
struct SolveRequest {
  double tolerance = 1e-9;               ///< on rho
  double time_limit_s = 0;               ///< [s], may be infinite
  std::int64_t max_iterations = 0;       ///< 0: the worker's default
  bool time_parts = false;               ///< as LcpOptions has it; version 1 always times them
  std::optional<Eigen::VectorXd> start;  ///< n values of a warm start
};

/// The payload of a frame.
using Bytes = std::vector<char>;

/// kHello.
Bytes Encode(const Hello& hello);
/// kProblem. @param version  the worker's, here and below
Bytes Encode(const ProblemArrays& problem, std::uint32_t version = kProtocolVersion);
/// kOtherB.
Bytes Encode(const Eigen::VectorXd& b);
/// kPrepared.
Bytes Encode(const Prepared& prepared);
/// kSolve.
Bytes Encode(const SolveRequest& request, std::uint32_t version = kProtocolVersion);
/// kResult.
Bytes Encode(const LcpResult& result, std::uint32_t version = kProtocolVersion);
/// kStream.
Bytes Encode(std::span<const ProblemArrays> stream);
/// kPass.
Bytes Encode(const PassRequest& request);
/// kPassReply.
Bytes Encode(const PassReply& reply);

/// Each throws std::runtime_error, saying which field, where the payload does not hold what the protocol prescribes.
/// Nothing is allocated beyond what the payload really holds.
Hello DecodeHello(const Bytes& payload);
/// As DecodeHello, for kProblem. Compressed rows are in order.
ProblemArrays DecodeProblem(const Bytes& payload, std::uint32_t version = kProtocolVersion);
/// As DecodeHello, for kOtherB.
/// @param rows  of the problem that was sent before, here and below
Eigen::VectorXd DecodeOtherB(const Bytes& payload, Index rows);
/// As DecodeHello, for kPrepared.
Prepared DecodePrepared(const Bytes& payload);
/// As DecodeHello, for kSolve.
SolveRequest DecodeSolve(const Bytes& payload, Index rows, std::uint32_t version = kProtocolVersion);
/// As DecodeHello, for kResult.
LcpResult DecodeResult(const Bytes& payload, Index rows, std::uint32_t version = kProtocolVersion);
/// As DecodeHello, for kStream.
std::vector<ProblemArrays> DecodeStream(const Bytes& payload);
/// As DecodeHello, for kPass. @param stream  that it is about: every index is one of it
PassRequest DecodePass(const Bytes& payload, std::span<const ProblemArrays> stream);
/// As DecodeHello, for kPassReply.
/// @param request  that it answers
PassReply DecodePassReply(const Bytes& payload, const PassRequest& request, std::span<const ProblemArrays> stream);

}  // namespace lcpbench
