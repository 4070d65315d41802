#include "benchmarks/studies/fresh_contestant.h"

#include <optional>
#include <stdexcept>
#include <utility>

#include "benchmarks/studies/step_arrays.h"
#include "solvers/lcp/settings.h"
#include "solvers/lcp/verify.h"
#include "solvers/peers/linked_peers.h"
#include "solvers/peers/peer_table.h"
#include "solvers/peers/protocol/external_solver.h"
#include "solvers/step/step_solver.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

using SolveRows = std::function<void(const StepRows& rows, const LcpOptions& options, LcpResult* result)>;

// Solves the problems of a stream as an engine's arrays hold them, which are made off the clock. Which one is wanted is
// known by the address of its arrays in the stream.
class SolverOfSteps final : public LcpSolver {
 public:
  SolverOfSteps(const FreshStream& stream, SolveRows solve) : first_(stream.arrays.data()), solve_(std::move(solve)) {
    for (const LcpProblem& problem : stream.problems) {
      if (!problem.has_factors() || !problem.has_two_body_rows()) {
        throw InputError("problem '" + problem.id() +
                         "' has rows on more than two bodies, or A itself: --from rows needs J by bodies");
      }
      steps_.push_back(StepArrays::Of(problem));
    }
    for (const StepArrays& step : steps_) rows_.push_back(step.View());
  }

  bool TakesFriction() const override { return true; }

 protected:
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& /*problem*/, const LcpOptions& /*options*/, LcpResult* /*result*/) override {
    throw std::logic_error("rows are solved from arrays");
  }
  bool DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) override {
    solve_(rows_[static_cast<std::size_t>(&arrays - first_)], options, result);
    return true;
  }

 private:
  const ProblemArrays* first_;
  SolveRows solve_;
  std::vector<StepArrays> steps_;
  std::vector<StepRows> rows_;  // views of steps_
};

// Makes an LcpProblem of the arrays, as a C++ program does that has no other use for them.
class SolverOfProblems final : public LcpSolver {
 public:
  explicit SolverOfProblems(std::unique_ptr<LcpSolver> solver) : solver_(std::move(solver)) {}

  bool TakesFriction() const override { return true; }

 protected:
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    solver_->Solve(problem, options, result);
  }
  bool DoSolveArrays(const ProblemArrays& arrays, const LcpOptions& options, LcpResult* result) override {
    solver_->Solve(LcpProblem::FromArrays(arrays), options, result);
    return true;
  }

 private:
  std::unique_ptr<LcpSolver> solver_;
};

std::unique_ptr<LcpSolver> MakeStepSolver(const FreshStream& stream, const PassRequest& request) {
  const auto solver =
      std::make_shared<StepSolver>(StepOptions{.tolerance = request.tolerance, .time_limit_s = request.time_limit_s});
  return std::make_unique<SolverOfSteps>(
      stream, [solver](const StepRows& rows, const LcpOptions& /*options*/, LcpResult* result) {
        result->f.resize(rows.rows);
        result->status = solver->Solve(rows, nullptr, result->f.data()).status;
      });
}

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

std::unique_ptr<LcpSolver> MakeLinked(const PeerLibrary& library, const std::string& key) {
  const Settings none;
  SettingsReader reader(key, none);
  return library.make(key, &reader);
}

Contestant FromRows(const SolverEntry& entry) {
  if (entry.key == "auto") return {entry, "in this process, by StepSolver", MakeStepSolver};
  const std::optional<PeerLibrary> library = LinkedLibrary(entry.key);
  if (!library || dynamic_cast<SolverOfRows*>(MakeLinked(*library, entry.key).get()) == nullptr) {
    throw InputError("solver '" + entry.key +
                     "' takes no rows by bodies, expected auto, or one of ODE or Bullet that is linked");
  }
  const auto make = [library, key = entry.key](const FreshStream& stream, const PassRequest& /*request*/) {
    const std::shared_ptr<LcpSolver> solver = MakeLinked(*library, key);
    auto* const of_rows = dynamic_cast<SolverOfRows*>(solver.get());
    return std::make_unique<SolverOfSteps>(
        stream, [solver, of_rows](const StepRows& rows, const LcpOptions& options, LcpResult* result) {
          of_rows->SolveRows(rows, options, result);
        });
  };
  return {entry, "in this process, judged in a worker", make};
}

Contestant FromArrays(const SolverEntry& entry, bool only_workers) {
  if (entry.origin == SolverOrigin::kOwn) {
    return {entry, "in this process",
            [entry](const auto& /*stream*/, const auto& /*request*/) { return entry.make({}); }};
  }
  std::optional<PeerLibrary> library;
  if (!only_workers) library = LinkedLibrary(entry.key);
  if (!library) return {entry, "in a worker", nullptr};
  return {entry, "in this process, judged in a worker",
          [library, key = entry.key](const auto& /*stream*/, const auto& /*request*/) {
            return MakeLinked(*library, key);
          }};
}

}  // namespace

std::vector<Contestant> MakeContestants(const std::vector<std::string>& keys, bool only_workers, TimedFrom begins) {
  std::vector<Contestant> contestants;
  contestants.reserve(keys.size());
  for (const std::string& key : keys) {
    const SolverEntry& entry = FindSolver(key);
    if (!entry.available) throw InputError("solver '" + key + "' is not in this build");
    Contestant contestant = begins == TimedFrom::kRows ? FromRows(entry) : FromArrays(entry, only_workers);
    if (begins == TimedFrom::kProblem && entry.origin == SolverOrigin::kOwn) {
      contestant.make = [entry](const auto& /*stream*/, const auto& /*request*/) {
        return std::make_unique<SolverOfProblems>(entry.make({}));
      };
    }
    contestants.push_back(std::move(contestant));
  }
  return contestants;
}

bool IsRight(const FreshStream& stream, std::size_t place, const Eigen::VectorXd& f, double tier) {
  return PassesTier(ComputeMetrics(stream.problems[place], f, &stream.references[place]), tier);
}

std::vector<bool> Judge(const Contestant& contestant, const FreshStream& stream, double tier,
                        const SolveLimits& limits) {
  const std::unique_ptr<LcpSolver> solver = contestant.entry.make({});
  if (auto* external = dynamic_cast<ExternalSolver*>(solver.get())) external->Greet();
  LcpOptions options;
  options.tolerance = tier;
  LcpResult result;
  std::vector<bool> right(stream.problems.size(), false);
  for (std::size_t place = 0; place < right.size(); ++place) {
    const LcpProblem& problem = stream.problems[place];
    if (!SizeRefusal(contestant.entry, problem.size()).empty()) continue;
    options.time_limit_s = limits.Of(problem.size());
    solver->Solve(problem, options, &result);
    right[place] = IsRight(stream, place, result.f, tier);
  }
  return right;
}

PassReply RunPass(const Contestant& contestant, const FreshStream& stream, const PassRequest& request) {
  if (contestant.make) return RunPass([&] { return contestant.make(stream, request); }, stream.arrays, request);
  const std::unique_ptr<LcpSolver> solver = contestant.entry.make({});
  auto* const external = dynamic_cast<ExternalSolver*>(solver.get());
  if (external == nullptr) {
    throw std::logic_error("solver '" + contestant.entry.key + "' does not run in a process of its own");
  }
  external->LoadStream(stream.arrays);
  return external->RunPass(request, PassLimit(request));
}

}  // namespace lcpbench
