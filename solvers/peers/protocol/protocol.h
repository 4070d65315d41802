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
#include "support/subprocess.h"

namespace lcpbench {

// The binary protocol between lcpbench (the host) and a solver in a process of its own (the worker). Anyone can write a
// worker, in any language: the host starts its command and talks to it through its standard input and output.
// docs/protocol.md describes every message of all versions.

/// The version of workers written here.
inline constexpr std::uint32_t kProtocolVersion = 5;
/// The first version with friction, sliding and bounded rows, and with the model of an answer.
inline constexpr std::uint32_t kFirstWithLaws = 5;
/// A frame that claims more is refused before anything is allocated.
inline constexpr std::uint64_t kLargestPayload = std::uint64_t{1} << 36U;

/// What a frame holds.
enum class MessageType : std::uint32_t {
  kNone = 0,  ///< never sent: not a frame of the protocol
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
  kPassReply = 11,
  kRefusal = 12
};

/// In which form a worker of version 1 wants its problems. kAsGiven takes every form as it comes.
enum class WantedForm : std::uint8_t { kDense = 0, kSparse = 1, kAsGiven = 2 };

/// What a worker says of itself.
struct Hello {
  std::uint32_t version = kProtocolVersion;  ///< of the protocol: 1 to 5
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

/// kRefusal: why a worker does not start, in the place of kHello.
Bytes EncodeRefusal(const std::string& why);
/// The opposite.
std::string DecodeRefusal(const Bytes& payload);
/// kHello.
Bytes Encode(const Hello& hello);
/// kProblem. @param version  the worker's, here and below; std::runtime_error for friction and bounded rows before 5
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
Bytes Encode(std::span<const ProblemArrays> stream, std::uint32_t version = kProtocolVersion);
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
std::vector<ProblemArrays> DecodeStream(const Bytes& payload, std::uint32_t version = kProtocolVersion);
/// As DecodeHello, for kPass. @param stream  that it is about: every index is one of it
PassRequest DecodePass(const Bytes& payload, std::span<const ProblemArrays> stream);
/// As DecodeHello, for kPassReply.
/// @param request  that it answers
PassReply DecodePassReply(const Bytes& payload, const PassRequest& request, std::span<const ProblemArrays> stream);

/// Writes one frame, as WriteAll.
Transfer WriteFrame(int fd, MessageType type, const Bytes& payload, double until);
/// Reads one frame, as ReadAll. The type is kNone where the header is not one of the protocol or promises more than
/// kLargestPayload. Memory grows with what arrives, not with what the header promises.
Transfer ReadFrame(int fd, MessageType* type, Bytes* payload, double until);

}  // namespace lcpbench
