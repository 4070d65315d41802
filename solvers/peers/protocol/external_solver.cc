#include "solvers/peers/protocol/external_solver.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "solvers/peers/protocol/channel.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using How = WorkerFailure::How;

// The problem as a worker of version 1 wants it.
LcpProblem InForm(const LcpProblem& problem, WantedForm form) {
  if (form == WantedForm::kAsGiven) return problem;
  RowBounds bounds = problem.bounds();
  if (form == WantedForm::kDense) {
    return LcpProblem::FromDense(problem.id(), problem.DenseA(), problem.b(), std::move(bounds), problem.facts());
  }
  return LcpProblem::FromSparse(problem.id(), problem.SparseA(), problem.b(), std::move(bounds), problem.facts());
}

}  // namespace

// One worker process.
class ExternalSolver::Process {
 public:
  explicit Process(const ExternalSolverOptions& options)
      : name_("worker '" + options.command.front() + "'"), process_(Start(options)) {}

  void Send(MessageType type, const Bytes& payload, double limit_s) {
    Check(WriteFrame(process_.socket(), type, payload, SteadyNow() + limit_s), limit_s);
  }

  Bytes Receive(MessageType expected, double limit_s) {
    MessageType type{};
    Bytes payload;
    Check(ReadFrame(process_.socket(), &type, &payload, SteadyNow() + limit_s), limit_s);
    if (type == expected) return payload;
    process_.Kill();
    throw WorkerFailure(How::kBroken, name_ + " sent what is no message of the protocol");
  }

 private:
  static SubprocessOptions Start(const ExternalSolverOptions& options) {
    SubprocessOptions start;
    start.command = options.command;
    start.memory_limit = options.memory_limit;
    return start;
  }

  void Check(Transfer outcome, double limit_s) {
    if (outcome == Transfer::kTimeout) {
      process_.Kill();
      throw WorkerFailure(How::kTimeLimit,
                          name_ + " gave no answer within " + std::to_string(limit_s) + " s and was killed");
    }
    if (outcome == Transfer::kClosed) {
      // It is about to end, unless it closed its end on purpose.
      constexpr double kWait = 1;  // s
      throw WorkerFailure(How::kEnded, name_ + " " + DescribeEnd(process_.WaitOrKill(kWait)));
    }
  }

  std::string name_;
  Subprocess process_;
};

ExternalSolver::ExternalSolver(ExternalSolverOptions options) : options_(std::move(options)) {
  if (options_.command.empty()) throw InputError("external solver: expected a command");
  const bool valid =
      options_.start_limit_s > 0 && options_.prepare_limit_s > 0 && options_.grace_factor >= 0 && options_.grace_s > 0;
  if (!valid) throw InputError("external solver: limits must be > 0");
}

ExternalSolver::~ExternalSolver() = default;

const Hello& ExternalSolver::Greet() {
  if (process_ != nullptr) return hello_;
  try {
    process_ = std::make_unique<Process>(options_);
    hello_ = DecodeHello(process_->Receive(MessageType::kHello, options_.start_limit_s));
  } catch (const std::exception& error) {
    process_.reset();
    throw InputError(error.what());
  }
  return hello_;
}

void ExternalSolver::Drop() {
  process_.reset();
  loaded_.reset();
  has_stream_ = false;
}

void ExternalSolver::Load(const LcpProblem& problem) {
  Greet();
  const bool has_matrix = loaded_ && loaded_->SharesMatrixWith(problem);
  if (has_matrix && &loaded_->b() == &problem.b()) return;
  const double limit = options_.prepare_limit_s;
  try {
    formed_on_host_s_ = 0;
    prepared_ = {};
    if (hello_.version == 1) {
      const double start = SteadyNow();
      const LcpProblem given = problem.CopyOfGivenForm();
      if (hello_.form == WantedForm::kDense) given.DenseA();
      if (hello_.form == WantedForm::kSparse) given.SparseA();
      formed_on_host_s_ = SteadyNow() - start;
      const ProblemArrays arrays = ProblemArrays::Of(InForm(given, hello_.form));
      process_->Send(MessageType::kProblem, Encode(arrays, hello_.version), limit);
      prepared_ = DecodePrepared(process_->Receive(MessageType::kPrepared, limit));
    } else {
      if (has_matrix) {
        process_->Send(MessageType::kOtherB, Encode(problem.b()), limit);
      } else {
        process_->Send(MessageType::kProblem, Encode(ProblemArrays::Of(problem)), limit);
      }
      process_->Receive(MessageType::kLoaded, limit);
    }
    loaded_ = problem;
  } catch (...) {
    Drop();
    throw;
  }
}

void ExternalSolver::DoPrepare(const LcpProblem& problem) {
  failure_.clear();
  try {
    Load(problem);
  } catch (const std::exception& error) {
    // A status of the solve that follows, not an end of the campaign.
    failure_ = error.what();
  }
}

LcpResult ExternalSolver::AskForSolve(const LcpProblem& problem, const LcpOptions& options) {
  // Here too: the worker may have ended at the solve before, and b may be another one.
  Load(problem);
  if (!prepared_.why_unsupported.empty()) {
    LcpResult result;
    result.f.setZero(problem.size());
    result.status = LcpStatus::kUnsupported;
    result.detail = prepared_.why_unsupported;
    return result;
  }
  SolveRequest request;
  request.tolerance = options.tolerance;
  request.time_limit_s = options.time_limit_s;
  request.max_iterations = options.max_iterations;
  request.time_parts = options.time_parts;
  if (options.initial_f != nullptr) request.start = *options.initial_f;
  const double limit = options.time_limit_s * (1 + options_.grace_factor) + options_.grace_s;
  try {
    process_->Send(MessageType::kSolve, Encode(request, hello_.version), limit);
    LcpResult result = DecodeResult(process_->Receive(MessageType::kResult, limit), problem.size(), hello_.version);
    if (hello_.version == 1) {
      result.own_fresh_s = formed_on_host_s_ + prepared_.convert_s + std::max(0.0, result.own_convert_s) +
                           std::max(0.0, result.own_solve_s);
    }
    return result;
  } catch (...) {
    Drop();
    throw;
  }
}

void ExternalSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  if (!failure_.empty()) throw std::runtime_error(std::exchange(failure_, {}));
  try {
    *result = AskForSolve(problem, options);
  } catch (const WorkerFailure& failure) {
    if (failure.how() != How::kTimeLimit) throw;
    result->status = LcpStatus::kTimeLimit;
    result->detail = failure.what();
  }
}

void ExternalSolver::LoadStream(std::span<const ProblemArrays> stream) {
  stream_.assign(stream.begin(), stream.end());
  has_stream_ = false;
  SendStream();
}

void ExternalSolver::SendStream() {
  try {
    Greet();
    if (has_stream_ || hello_.version == 1) return;
    process_->Send(MessageType::kStream, Encode(stream_), options_.prepare_limit_s);
    process_->Receive(MessageType::kLoaded, options_.prepare_limit_s);
    has_stream_ = true;
  } catch (const InputError& error) {
    throw WorkerFailure(How::kNotStarted, error.what());
  } catch (...) {
    Drop();
    throw;
  }
}

PassReply ExternalSolver::RunPass(const PassRequest& request, double limit_s) {
  SendStream();
  if (hello_.version == 1) return RunPassByProblems(request, limit_s);
  try {
    process_->Send(MessageType::kPass, Encode(request), limit_s);
    return DecodePassReply(process_->Receive(MessageType::kPassReply, limit_s), request, stream_);
  } catch (const WorkerFailure&) {
    Drop();
    throw;
  } catch (const std::exception& error) {
    Drop();
    throw WorkerFailure(How::kBroken, error.what());
  }
}

PassReply ExternalSolver::RunPassByProblems(const PassRequest& request, double limit_s) {
  LcpOptions options;
  options.tolerance = request.tolerance;
  options.time_limit_s = request.time_limit_s;
  const double start = SteadyNow();
  const auto solve = [&](const LcpProblem& problem) {
    if (SteadyNow() - start > limit_s) throw WorkerFailure(How::kTimeLimit, "a pass by single solves took too long");
    try {
      return AskForSolve(problem, options);
    } catch (const WorkerFailure&) {
      throw;
    } catch (const std::exception& error) {
      throw WorkerFailure(How::kBroken, error.what());
    }
  };
  for (const std::uint32_t index : request.warm_up) solve(LcpProblem::FromArrays(stream_[index]));
  PassReply reply;
  double spent = 0;
  for (std::size_t k = 0; k < request.order.size() && spent <= request.budget_s; ++k) {
    LcpProblem problem = LcpProblem::FromArrays(stream_[request.order[k]]);
    if (request.kind == PassKind::kAgain) problem = problem.WithB(request.other_b[k]);
    const LcpResult result = solve(problem);
    PassEntry entry;
    entry.seconds = std::max(0.0, result.own_fresh_s);
    entry.problem_s = formed_on_host_s_;
    entry.prepare_s = prepared_.convert_s;
    entry.convert_s = std::max(0.0, result.own_convert_s);
    entry.solve_s = std::max(0.0, result.own_solve_s);
    entry.status = result.status;
    entry.f = result.f;
    spent += entry.seconds;
    reply.push_back(std::move(entry));
  }
  return reply;
}

}  // namespace lcpbench
