#include "benchmarks/studies/fresh_contestant.h"

#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include "solvers/lcp/settings.h"
#include "solvers/peers/linked_peers.h"
#include "solvers/peers/peer_table.h"
#include "solvers/peers/protocol/external_solver.h"
#include "solvers/registry.h"
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
    if (external_ == nullptr) throw std::logic_error("solver '" + key() + "' is in no process of its own");
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

// Judged by its worker, timed here.
class LinkedPeer final : public WorkerSolver {
 public:
  LinkedPeer(const SolverEntry& entry, PeerLibrary library)
      : WorkerSolver(entry, "in this process, judged in a worker"), library_(std::move(library)) {}

  bool is_elsewhere() const override { return false; }
  PassReply Pass(std::span<const ProblemArrays> stream, const PassRequest& request) override {
    return RunPass(
        [this] {
          const Settings none;
          SettingsReader reader(key(), none);
          return library_.make(key(), &reader);
        },
        stream, request);
  }

 private:
  PeerLibrary library_;
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

std::unique_ptr<Contestant> Make(const std::string& key, bool only_workers) {
  // A contestant that is no LcpSolver of the registry, such as one that takes rows by bodies, is told by its key here
  // and has a class of its own above: Judge solves one problem, Pass is RunPass with what makes it an LcpSolver from
  // arrays (DoSolveArrays).
  const SolverEntry& entry = FindSolver(key);
  if (!entry.available) throw InputError("solver '" + key + "' is not in this build");
  if (entry.origin == SolverOrigin::kOwn) return std::make_unique<OwnSolver>(entry);
  std::optional<PeerLibrary> library;
  if (!only_workers) library = LinkedLibrary(entry.key);
  if (library) return std::make_unique<LinkedPeer>(entry, *std::move(library));
  return std::make_unique<WorkerSolver>(entry);
}

}  // namespace

std::vector<std::unique_ptr<Contestant>> MakeContestants(const std::vector<std::string>& keys, bool only_workers) {
  std::vector<std::unique_ptr<Contestant>> contestants;
  contestants.reserve(keys.size());
  for (const std::string& key : keys) contestants.push_back(Make(key, only_workers));
  return contestants;
}

}  // namespace lcpbench
