// The main program of every peer's worker: lcpbench-worker-<peer> KEY [NAME=VALUE ...], started by ExternalSolver.

#include <algorithm>
#include <exception>
#include <iostream>
#include <memory>
#include <sstream>
#include <string>
#include <utility>

#include "solvers/lcp/residual.h"
#include "solvers/lcp/solver.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/peer_table.h"
#include "solvers/peers/protocol/worker.h"
#include "support/input_error.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

// A solver with the check that ours have: rho of its answer by the given form, and where that is above the tolerance
// one more solve of A + s I, from which the better answer is taken. `kSolved` then says that rho is within the
// tolerance. All of it is on the clock.
//
// s is `shift` times the largest diagonal entry of A. From factors the shift is n more columns of J, so that the
// problem keeps its form; what bodies a row joins is not seen any more then.
class CheckedSolver : public LcpSolver {
 public:
  static constexpr double kShift = 1e-9;  // unless told otherwise: what the engines' users take

  CheckedSolver(std::unique_ptr<LcpSolver> inner, double shift) : inner_(std::move(inner)), shift_(shift) {}

  std::string WhyUnsupported(const LcpProblem& problem) const override { return inner_->WhyUnsupported(problem); }

 protected:
  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  std::unique_ptr<LcpSolver> inner_;
  double shift_;
};

// [J, I] with s as the masses of the new columns.
LcpProblem ShiftedFactors(const LcpProblem& problem, double s) {
  const Index n = problem.size();
  const Index columns = problem.J().cols();
  Eigen::SparseMatrix<double, Eigen::ColMajor, int> J(n, columns + n), identity(n, n);
  identity.setIdentity();
  J.leftCols(columns) = problem.J();
  J.rightCols(n) = identity;
  Eigen::VectorXd inverse_mass(columns + n);
  inverse_mass << problem.inverse_mass(), Eigen::VectorXd::Constant(n, s);
  return LcpProblem::FromFactors(problem.id(), J, std::move(inverse_mass), problem.b(), problem.bounds(),
                                 problem.facts());
}

LcpProblem Shifted(const LcpProblem& problem, double shift) {
  const double s = shift * problem.DiagonalA().cwiseAbs().maxCoeff();
  switch (problem.given_form()) {
    case MatrixForm::kFactors:
      return ShiftedFactors(problem, s);
    case MatrixForm::kSparse: {
      SparseMatrix A = problem.SparseA();  // has every diagonal entry
      for (Index row = 0; row < problem.size(); ++row) A.coeffRef(row, row) += s;
      return LcpProblem::FromSparse(problem.id(), A, problem.b(), problem.bounds(), problem.facts());
    }
    case MatrixForm::kDense:
      break;
  }
  Eigen::MatrixXd A = problem.DenseA();
  A.diagonal().array() += s;
  return LcpProblem::FromDense(problem.id(), std::move(A), problem.b(), problem.bounds(), problem.facts());
}

// Seconds that may be unknown, which is negative.
void Add(double seconds, double* sum) {
  if (seconds >= 0) *sum = std::max(0.0, *sum) + seconds;
}

void CheckedSolver::DoPrepare(const LcpProblem& problem) { inner_->Prepare(problem); }

void CheckedSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  inner_->Solve(problem, options, result);
  if (result->status == LcpStatus::kUnsupported || result->status == LcpStatus::kInfeasible) return;
  double rho = ResidualEstimate(problem).Rho(result->f);
  if (!(rho <= options.tolerance) && !deadline.Expired()) {
    LcpOptions rest = options;
    rest.time_limit_s = deadline.Remaining();
    LcpResult again;
    if (rest.time_limit_s > 0) inner_->Solve(Shifted(problem, shift_), rest, &again);
    const double rho_again = again.f.size() == problem.size() ? ResidualEstimate(problem).Rho(again.f) : rho;
    Add(result->own_solve_s, &again.own_solve_s);
    Add(result->own_convert_s, &again.own_convert_s);
    if (rho_again < rho || !(rho == rho)) {
      rho = rho_again;
      *result = std::move(again);
    } else {
      result->own_solve_s = again.own_solve_s;
      result->own_convert_s = again.own_convert_s;
    }
  }
  if (rho <= options.tolerance) {
    result->status = LcpStatus::kSolved;
  } else if (result->status == LcpStatus::kSolved) {
    std::ostringstream detail;
    detail << "checked: rho is " << rho;
    result->status = LcpStatus::kNumericalFailure;
    result->detail = detail.str();
  }
}

Settings ParseSettings(int argc, char** argv) {
  Settings settings;
  for (int i = 2; i < argc; ++i) {
    const std::string pair = argv[i];
    const auto equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError("expected NAME=VALUE, found '" + pair + "'");
    }
    settings[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return settings;
}

// Settings of every peer: check=yes (default no) with check_shift, see CheckedSolver.
std::unique_ptr<LcpSolver> Make(const PeerLibrary& library, std::string_view key, const Settings& settings) {
  SettingsReader reader(key, settings);
  const bool is_checked = reader.Choice("check", "no", {"no", "yes"}) == "yes";
  const double shift = reader.Number("check_shift", CheckedSolver::kShift, 0, 1);
  auto made = library.make(key, &reader);
  reader.Finish();
  return is_checked ? std::make_unique<CheckedSolver>(std::move(made), shift) : std::move(made);
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  using namespace lcpbench;
  constexpr int kMisuse = 2;
  try {
    const PeerLibrary library = ThisPeerLibrary();
    std::string known;
    for (const PeerEntry& peer : AllPeers()) {
      if (peer.project.folder != LCPBENCH_PEER) continue;
      known += (known.empty() ? "" : ", ") + std::string(peer.key);
      if (argc < 2 || peer.key != argv[1]) continue;
      const auto make = [&, settings = ParseSettings(argc, argv)] { return Make(library, peer.key, settings); };
      make();  // what is wrong with the settings is said now
      Hello hello;
      hello.name = peer.key;
      hello.library_version = library.version;
      hello.licence = peer.project.licence;
      return RunWorker(hello, make);
    }
    throw InputError("expected one of " + known);
  } catch (const InputError& error) {
    if (!RefuseToStart(error.what())) std::cerr << argv[0] << ": " << Printable(error.what()) << std::endl;
    return kMisuse;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": internal error: " << Printable(error.what()) << std::endl;
    return 1;
  }
}
