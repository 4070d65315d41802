#include "solvers/peers/protocol/external_solver.h"

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "solvers/peers/protocol/protocol.h"
#include "support/input_error.h"

namespace lcpbench {

using How = WorkerFailure::How;

namespace {

std::string Seconds(double seconds) {
  std::ostringstream text;
  text << seconds << " s";
  return text.str();
}

}  // namespace

ExternalSolver::ExternalSolver(ExternalSolverOptions options) : options_(std::move(options)) {
  if (options_.command.empty()) throw InputError("external solver: expected a command");
  const bool valid =
      options_.start_limit_s > 0 && options_.prepare_limit_s > 0 && options_.grace_factor >= 0 && options_.grace_s > 0;
  if (!valid) throw InputError("external solver: limits must be > 0");
}

ExternalSolver::~ExternalSolver() = default;

void ExternalSolver::Check(Transfer outcome, double limit_s) {
  const std::string name = Name();
  if (outcome == Transfer::kTimeout) {
    process_->Kill();
    throw WorkerFailure(How::kTimeLimit, name + "gave no answer within " + Seconds(limit_s) + " and was killed");
  }
  if (outcome == Transfer::kClosed) {
    // It is about to end, unless it closed its end on purpose.
    constexpr double kWait = 1;  // s
    const int status = process_->WaitOrKill(kWait);
    throw WorkerFailure(WasKilled(status) ? How::kKilled : How::kEnded, name + DescribeEnd(status));
  }
}

Bytes ExternalSolver::Receive(MessageType expected, double limit_s) {
  MessageType type{};
  Bytes payload;
  Check(ReadFrame(process_->socket(), &type, &payload, SteadyNow() + limit_s), limit_s);
  if (type == expected) return payload;
  process_->Kill();
  if (expected == MessageType::kHello && type == MessageType::kRefusal) throw InputError(DecodeRefusal(payload));
  throw WorkerFailure(How::kBroken, Name() + "sent bytes that are not a message of the protocol");
}

// Sends, and decodes the answer. Whatever goes wrong, the worker is gone afterwards.
template <typename Decode>
auto ExternalSolver::Exchange(MessageType type, const Bytes& payload, MessageType answer, double limit_s,
                              Decode decode) {
  try {
    Check(WriteFrame(process_->socket(), type, payload, SteadyNow() + limit_s), limit_s);
    return decode(Receive(answer, limit_s));
  } catch (...) {
    process_.reset();
    loaded_.reset();
    has_stream_ = false;
    throw;
  }
}

namespace {

// Workers of older versions are asked for single solves, whose own times count.
constexpr std::uint32_t kFirstWithPasses = 4;

// The kind of rows that makes a problem more than a plain one.
const char* SpecialRows(const LcpProblem& problem) {
  return problem.friction_rows().empty() ? "bounded rows" : "friction rows";
}

bool TakeAnswer(const Bytes& /*empty*/) { return true; }

}  // namespace

// Whether what failed is to be tried again: once, from the start of a worker to the end of the solve or pass.
bool ExternalSolver::Retries(const WorkerFailure& failure) {
  const bool again = failure.how() == How::kKilled && may_retry_;
  may_retry_ = !again;
  if (again) retried_ += (retried_.empty() ? "" : "; ") + std::string(failure.what());
  return again;
}

const Hello& ExternalSolver::Greet() {
  if (process_ != nullptr) return hello_;
  try {
    SubprocessOptions start;
    start.command = options_.command;
    start.memory_limit = options_.memory_limit;
    process_ = std::make_unique<Subprocess>(start);
    hello_ = DecodeHello(Receive(MessageType::kHello, options_.start_limit_s));
  } catch (const WorkerFailure& failure) {
    process_.reset();
    if (Retries(failure)) return Greet();
    const bool late = failure.how() == How::kTimeLimit;
    throw InputError(late ? Name() + "did not greet within its start limit of " + Seconds(options_.start_limit_s) +
                                " and was killed"
                          : failure.what() + std::string(" before its greeting (docs/protocol.md)"));
  } catch (const std::system_error&) {  // no fault of the worker's
    throw;
  } catch (const std::exception& error) {
    process_.reset();
    throw InputError(error.what());
  }
  return hello_;
}

void ExternalSolver::Load(const LcpProblem& problem, double time_limit_s) {
  Greet();
  const bool has_matrix = loaded_ && loaded_->SharesMatrixWith(problem);
  if (has_matrix && &loaded_->b() == &problem.b()) return;
  const auto limit = [&](const Bytes& sent) {
    constexpr double kSlowestReader = 2e7;  // bytes/s
    return std::min(options_.prepare_limit_s,
                    WithGrace(time_limit_s) + static_cast<double>(sent.size()) / kSlowestReader);
  };
  loaded_.reset();
  formed_on_host_s_ = 0;
  prepared_ = {};
  if (hello_.version == 1) {
    const double start = SteadyNow();
    LcpProblem wanted = problem.CopyOfGivenForm();
    if (hello_.form == WantedForm::kDense) wanted.DenseA();
    if (hello_.form == WantedForm::kSparse) wanted.SparseA();
    formed_on_host_s_ = SteadyNow() - start;
    if (hello_.form == WantedForm::kDense) wanted = InForm(wanted, MatrixForm::kDense);
    if (hello_.form == WantedForm::kSparse) wanted = InForm(wanted, MatrixForm::kSparse);
    const Bytes arrays = Encode(ProblemArrays::Of(wanted), hello_.version);
    prepared_ = Exchange(MessageType::kProblem, arrays, MessageType::kPrepared, limit(arrays), DecodePrepared);
  } else if (has_matrix) {
    const Bytes b = Encode(problem.b());
    Exchange(MessageType::kOtherB, b, MessageType::kLoaded, limit(b), TakeAnswer);
  } else {
    const Bytes arrays = Encode(ProblemArrays::Of(problem), hello_.version);
    Exchange(MessageType::kProblem, arrays, MessageType::kLoaded, limit(arrays), TakeAnswer);
  }
  loaded_ = problem;
}

LcpResult ExternalSolver::RequestSolve(const LcpProblem& problem, const LcpOptions& options) {
  const auto refusal = [&](std::string why) {
    LcpResult result;
    result.f.setZero(problem.size());
    result.status = LcpStatus::kUnsupported;
    result.detail = std::move(why);
    return result;
  };
  if (!problem.is_plain() && Greet().version < kFirstWithLaws) {
    return refusal(std::string(SpecialRows(problem)) + ", for which its worker has to speak version " +
                   std::to_string(kFirstWithLaws) + " of the protocol, found " + std::to_string(hello_.version));
  }
  Load(problem, options.time_limit_s);
  if (!prepared_.why_unsupported.empty()) return refusal(prepared_.why_unsupported);
  SolveRequest request;
  request.tolerance = options.tolerance;
  request.time_limit_s = options.time_limit_s;
  request.max_iterations = options.max_iterations;
  request.time_parts = options.time_parts;
  if (options.initial_f != nullptr) request.start = *options.initial_f;
  LcpResult result = Exchange(
      MessageType::kSolve, Encode(request, hello_.version), MessageType::kResult, WithGrace(options.time_limit_s),
      [&](const Bytes& payload) { return DecodeResult(payload, problem.size(), hello_.version); });
  if (hello_.version == 1) {
    result.own_fresh_s = formed_on_host_s_ + prepared_.convert_s + std::max(0.0, result.own_convert_s) +
                         std::max(0.0, result.own_solve_s);
  }
  return result;
}

void ExternalSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  try {
    *result = RequestSolve(problem, options);
    may_retry_ = true;
  } catch (const WorkerFailure& failure) {
    if (Retries(failure)) return DoSolve(problem, options, result);
    if (failure.how() != How::kTimeLimit) throw;
    result->status = LcpStatus::kTimeLimit;
    result->detail = failure.what();
  }
}

void ExternalSolver::LoadStream(std::span<const ProblemArrays> stream) {
  stream_ = stream;
  has_stream_ = false;
  try {
    SendStream();
  } catch (const WorkerFailure& failure) {
    if (!Retries(failure)) throw;  // else the pass sends it
  }
}

// Whether the worker runs passes over this stream; else it is asked for single solves.
bool ExternalSolver::RunsPasses() const {
  const auto is_plain = [](const ProblemArrays& arrays) { return arrays.friction.empty() && arrays.bounded.empty(); };
  return hello_.version >= kFirstWithLaws ||
         (hello_.version >= kFirstWithPasses && std::ranges::all_of(stream_, is_plain));
}

void ExternalSolver::SendStream() {
  try {
    Greet();
  } catch (const InputError& error) {
    throw WorkerFailure(How::kNotStarted, error.what());
  }
  if (has_stream_ || !RunsPasses()) return;
  has_stream_ = Exchange(MessageType::kStream, Encode(stream_, hello_.version), MessageType::kLoaded,
                         options_.prepare_limit_s, TakeAnswer);
}

PassReply ExternalSolver::RunPass(const PassRequest& request, double limit_s) {
  try {
    SendStream();
    PassReply reply = RunsPasses()
                          ? Exchange(MessageType::kPass, Encode(request), MessageType::kPassReply, limit_s,
                                     [&](const Bytes& payload) { return DecodePassReply(payload, request, stream_); })
                          : RunPassByProblems(request, limit_s);
    may_retry_ = true;
    return reply;
  } catch (const WorkerFailure& failure) {
    if (!Retries(failure)) throw;
  } catch (const std::exception& error) {
    throw WorkerFailure(How::kBroken, error.what());
  }
  return RunPass(request, limit_s);
}

PassReply ExternalSolver::RunPassByProblems(const PassRequest& request, double limit_s) {
  LcpOptions options;
  options.tolerance = request.tolerance;
  options.time_limit_s = request.time_limit_s;
  options.time_parts = request.kind == PassKind::kParts;
  const double start = SteadyNow();
  const auto solve = [&](const LcpProblem& problem) {
    if (SteadyNow() - start > limit_s) throw WorkerFailure(How::kTimeLimit, "a pass by single solves took too long");
    return RequestSolve(problem, options);
  };
  for (const std::uint32_t index : request.warm_up) solve(LcpProblem::FromArrays(stream_[index]));
  PassReply reply;
  for (std::size_t k = 0; k < request.order.size(); ++k) {
    LcpProblem problem = LcpProblem::FromArrays(stream_[request.order[k]]);
    if (request.kind == PassKind::kAgain) {
      if (hello_.version > 1) solve(problem);  // then the worker has the matrix
      problem = problem.WithB(request.other_b[k]);
    }
    const LcpResult result = solve(problem);
    PassEntry entry;
    entry.seconds = std::max(0.0, result.own_fresh_s);
    entry.problem_s = formed_on_host_s_;
    entry.prepare_s = prepared_.convert_s;
    entry.convert_s = std::max(0.0, result.own_convert_s);
    entry.solve_s = std::max(0.0, result.own_solve_s);
    entry.status = result.status;
    entry.f = result.f;
    reply.entries.push_back(std::move(entry));
  }
  return reply;
}

}  // namespace lcpbench
