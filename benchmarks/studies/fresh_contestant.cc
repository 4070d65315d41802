#include "benchmarks/studies/fresh_contestant.h"

#include <array>
#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "benchmarks/studies/step_arrays.h"
#include "solvers/lcp/settings.h"
#include "solvers/peers/linked_peers.h"
#include "solvers/peers/peer_table.h"
#include "solvers/peers/protocol/external_solver.h"
#include "solvers/registry.h"
#include "solvers/step/step_solver.h"
#include "support/clock.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

class OwnSolver final : public Contestant {
 public:
  explicit OwnSolver(const SolverEntry& entry) : Contestant(entry.key, true, "in this process"), entry_(entry) {}

  std::string WhyRefused(Index rows) const override { return SizeRefusal(entry_, rows); }
  LcpResult Judge(const LcpProblem& /*problem*/, const ProblemArrays& arrays, const LcpOptions& options,
                  double* seconds) override {
    const std::unique_ptr<LcpSolver> solver = entry_.make({});
    LcpResult result;
    const double start = SteadyNow();
    solver->SolveArrays(arrays, options, &result);
    *seconds = SteadyNow() - start;
    return result;
  }
  PassReply Pass(std::span<const ProblemArrays> stream, const PassRequest& request) override {
    return RunPass([this] { return entry_.make({}); }, stream, request);
  }

 private:
  SolverEntry entry_;
};

class WorkerSolver : public Contestant {
 public:
  explicit WorkerSolver(const SolverEntry& entry, const char* place = "in a worker")
      : Contestant(entry.key, false, place), entry_(entry), solver_(entry.make({})) {
    external_ = dynamic_cast<ExternalSolver*>(solver_.get());
    if (external_ == nullptr) throw std::logic_error("solver '" + key() + "' does not run in a process of its own");
    external_->Greet();
  }

  bool is_elsewhere() const override { return true; }
  std::string WhyRefused(Index rows) const override { return SizeRefusal(entry_, rows); }
  LcpResult Judge(const LcpProblem& problem, const ProblemArrays& /*arrays*/, const LcpOptions& options,
                  double* seconds) override {
    LcpResult result;
    const double start = SteadyNow();
    solver_->Solve(problem, options, &result);
    *seconds = result.own_fresh_s >= 0 ? result.own_fresh_s : SteadyNow() - start;
    return result;
  }
  void BeginStream() override { has_stream_ = false; }
  PassReply Pass(std::span<const ProblemArrays> stream, const PassRequest& request) override {
    if (!has_stream_) external_->LoadStream(stream);
    has_stream_ = true;
    const double most_s =
        2 * (request.budget_s + request.time_limit_s) * static_cast<double>(2 + request.warm_up.size());
    return external_->RunPass(request, most_s);
  }

 private:
  SolverEntry entry_;
  std::unique_ptr<LcpSolver> solver_;
  ExternalSolver* external_ = nullptr;
  bool has_stream_ = false;
};

using SolveRows = std::function<void(const StepRows& rows, const LcpOptions& options, LcpResult* result)>;

StepArrays StepOf(const LcpProblem& problem) {
  if (problem.has_factors() && problem.has_two_body_rows()) return StepArrays::Of(problem);
  throw InputError("problem '" + problem.id() +
                   "' has rows on more than two bodies, or A itself: --from rows needs J by bodies");
}

// The steps of a stream as an engine's arrays hold them: made of its problems once, off the clock. Which one is wanted
// is known by the address of its arrays in the stream.
class StepStream {
 public:
  void Forget() { stream_ = {}; }
  PassReply Run(std::span<const ProblemArrays> stream, const PassRequest& request, const SolveRows& solve) {
    if (stream.data() != stream_.data() || stream.size() != stream_.size()) {
      stream_ = stream;
      steps_.clear();
      for (const ProblemArrays& arrays : stream) steps_.push_back(StepOf(LcpProblem::FromArrays(arrays)));
    }
    return RunPass([&] { return std::make_unique<Timed>(*this, solve); }, stream, request);
  }

 private:
  // What RunPass times.
  class Timed final : public LcpSolver {
   public:
    Timed(const StepStream& steps, const SolveRows& solve) : steps_(steps), solve_(solve) {}

   protected:
    void DoPrepare(const LcpProblem& /*problem*/) override {}
    void DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* /*result*/) override {
      throw std::logic_error("rows are solved from arrays");
    }
    bool DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) override {
      const auto place = static_cast<std::size_t>(&arrays - steps_.stream_.data());
      solve_(steps_.steps_[place].View(), options, result);
      return true;
    }

   private:
    const StepStream& steps_;
    const SolveRows& solve_;
  };

  std::span<const ProblemArrays> stream_;
  std::vector<StepArrays> steps_;
};

class StepContestant final : public Contestant {
 public:
  explicit StepContestant(std::string key) : Contestant(std::move(key), true, "in this process, by StepSolver") {}

  std::string WhyRefused(Index /*rows*/) const override { return {}; }
  LcpResult Judge(const LcpProblem& problem, const ProblemArrays& /*arrays*/, const LcpOptions& options,
                  double* seconds) override {
    LcpResult result;
    result.f.setZero(problem.size());
    const StepArrays step = StepOf(problem);
    StepSolver solver({.tolerance = options.tolerance, .time_limit_s = options.time_limit_s});
    const double start = SteadyNow();
    result.status = solver.Solve(step.View(), nullptr, result.f.data()).status;
    *seconds = SteadyNow() - start;
    return result;
  }
  void BeginStream() override { stream_.Forget(); }
  PassReply Pass(std::span<const ProblemArrays> stream, const PassRequest& request) override {
    StepSolver solver({.tolerance = request.tolerance, .time_limit_s = request.time_limit_s});
    return stream_.Run(stream, request, [&](const StepRows& rows, const LcpOptions& /*options*/, LcpResult* result) {
      result->f.resize(rows.rows);
      result->status = solver.Solve(rows, nullptr, result->f.data()).status;
    });
  }

 private:
  StepStream stream_;
};

// Judged by its worker, timed here.
class LinkedPeer : public WorkerSolver {
 public:
  LinkedPeer(const SolverEntry& entry, PeerLibrary library)
      : WorkerSolver(entry, "in this process, judged in a worker"), library_(std::move(library)) {}

  bool is_elsewhere() const override { return false; }
  PassReply Pass(std::span<const ProblemArrays> stream, const PassRequest& request) override {
    return RunPass([this] { return MakeLinked(); }, stream, request);
  }

 protected:
  std::unique_ptr<LcpSolver> MakeLinked() const {
    const Settings none;
    SettingsReader reader(key(), none);
    return library_.make(key(), &reader);
  }

 private:
  PeerLibrary library_;
};

// The same code, from rows.
class LinkedPeerOfRows final : public LinkedPeer {
 public:
  LinkedPeerOfRows(const SolverEntry& entry, PeerLibrary library) : LinkedPeer(entry, std::move(library)) {
    if (dynamic_cast<SolverOfRows*>(MakeLinked().get()) == nullptr) {
      throw InputError("solver '" + key() + "' takes no rows by bodies");
    }
  }

  void BeginStream() override { stream_.Forget(); }
  PassReply Pass(std::span<const ProblemArrays> stream, const PassRequest& request) override {
    const std::unique_ptr<LcpSolver> solver = MakeLinked();
    auto* const peer = dynamic_cast<SolverOfRows*>(solver.get());
    return stream_.Run(stream, request, [peer](const StepRows& rows, const LcpOptions& options, LcpResult* result) {
      peer->SolveRows(rows, options, result);
    });
  }

 private:
  StepStream stream_;
};

// The library behind a peer's key, where it is linked into this program.
std::optional<PeerLibrary> LinkedLibrary(std::string_view key) {
  for (const PeerEntry& peer : AllPeers()) {
    if (peer.key != key) continue;
#ifdef LCPBENCH_LINKED_ODE
    if (peer.project.folder == "ode") return OdeLibrary();
#endif
#ifdef LCPBENCH_LINKED_BULLET
    if (peer.project.folder == "bullet") return BulletLibrary();
#endif
  }
  return std::nullopt;
}

std::unique_ptr<Contestant> MakeFromRows(const std::string& key) {
  const SolverEntry& entry = FindSolver(key);
  if (key == "auto") return std::make_unique<StepContestant>(key);
  std::optional<PeerLibrary> library = LinkedLibrary(entry.key);
  if (!library) {
    throw InputError("solver '" + key +
                     "' takes no rows by bodies, expected auto, or one of ODE or Bullet that is linked");
  }
  return std::make_unique<LinkedPeerOfRows>(entry, *std::move(library));
}

std::unique_ptr<Contestant> Make(const std::string& key, bool only_workers) {
  const SolverEntry& entry = FindSolver(key);
  if (!entry.available) throw InputError("solver '" + key + "' is not in this build");
  if (entry.origin == SolverOrigin::kOwn) return std::make_unique<OwnSolver>(entry);
  std::optional<PeerLibrary> library;
  if (!only_workers) library = LinkedLibrary(entry.key);
  if (library) return std::make_unique<LinkedPeer>(entry, *std::move(library));
  return std::make_unique<WorkerSolver>(entry);
}

}  // namespace

std::vector<std::unique_ptr<Contestant>> MakeContestants(const std::vector<std::string>& keys, bool only_workers,
                                                         bool from_rows) {
  std::vector<std::unique_ptr<Contestant>> contestants;
  contestants.reserve(keys.size());
  for (const std::string& key : keys) contestants.push_back(from_rows ? MakeFromRows(key) : Make(key, only_workers));
  return contestants;
}

}  // namespace lcpbench
