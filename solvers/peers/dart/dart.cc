// DART's LCP solvers: a Dantzig code that descends from ODE's, and projected Gauss-Seidel. Both take A x = b + w with
// rows of A padded to a multiple of four, and destroy A and b. Gauss-Seidel starts from what x holds, computes the
// bounds of a friction row anew before each of its updates, and has no clock: sweeps are asked for in portions, which
// only repeats the first-sweep test. An iteration is a sweep asked for: how many of the last portion were made it does
// not tell. docs/peers.md says when both succeed.

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <dart/config.hpp>
#include <dart/constraint/DantzigBoxedLcpSolver.hpp>
#include <dart/constraint/PgsBoxedLcpSolver.hpp>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/dantzig_peer.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

using dart::constraint::DantzigBoxedLcpSolver;
using dart::constraint::PgsBoxedLcpSolver;

static_assert(EIGEN_MAX_ALIGN_BYTES == 16,
              "libdart passes Eigen objects and was built for plain x86-64: no -march=native here");

template <bool kEarlyTermination>
bool CallDantzig(const DantzigProblem& p) {
  static DantzigBoxedLcpSolver solver;
  return solver.solve(p.rows, p.A, p.x, p.b, 0, p.lower, p.upper, p.findex, kEarlyTermination);
}

class Pgs : public LcpSolver {
 public:
  Pgs(std::string_view key, SettingsReader* reader) : tier_(key, reader, "relative_tolerance") {
    if (tier_.is_library_default()) return;
    // The first sweep's threshold has the unit of force: never stop by it, but where nothing moves at all.
    option_.mDeltaXThreshold = 0;
    option_.mRandomizeConstraintOrder = reader->Choice("randomize", "no", {"no", "yes"}) == "yes";
    option_.mEpsilonForDivision = reader->Number("epsilon_for_division", 1e-9, 0, 1);
  }

  bool TakesFriction() const override { return true; }
  bool TakesBounded() const override { return true; }
  std::string WhyUnsupported(const LcpProblem& problem) const override { return WhySliding(problem.friction_rows()); }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    Assemble(problem);
    lower_.setZero(problem.size());
    upper_.setConstant(problem.size(), std::numeric_limits<double>::infinity());
    for (const Index row : problem.bilateral_rows()) lower_[row] = -std::numeric_limits<double>::infinity();
    for (const BoundedRow& row : problem.bounded_rows()) {
      lower_[row.row] = row.lower;
      upper_[row.row] = row.upper;
    }
    findex_.assign(static_cast<std::size_t>(rows_), -1);
    for (const FrictionRow& row : problem.friction_rows()) {
      findex_[static_cast<std::size_t>(row.row)] = static_cast<int>(row.normal);
      upper_[row.row] = row.mu;  // the code reads no other bound of these rows
    }
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    TimeConversion(options, result, [&] {
      if (!is_whole_) Assemble(problem);
      is_whole_ = false;
      b_ = -problem.b();
      if (options.initial_f != nullptr) result->f = *options.initial_f;
    });
    PgsBoxedLcpSolver::Option option = option_;
    const int most = tier_.Iterations(options, option.mMaxIteration);
    if (!tier_.is_library_default()) option.mRelativeDeltaXTolerance = tier_.Tolerance(options);
    const Deadline deadline(options);
    TimeLibraryCall(options, result, [&] {
      SweepInPortions(most, static_cast<double>(A_.size()), deadline, result, [&](int sweeps) {
        option.mMaxIteration = sweeps;
        solver_.setOption(option);
        return solver_.solve(rows_, A_.data(), result->f.data(), b_.data(), 0, lower_.data(), upper_.data(),
                             findex_.data(), false);
      });
    });
  }

 private:
  void Assemble(const LcpProblem& problem) {
    RequireDenseMatrices(problem.size(), 2);  // and the code's copy
    rows_ = static_cast<int>(problem.size());
    A_.resize(problem.size(), PadToFour(rows_));
    AssembleDenseA(problem, A_.data(), PadToFour(rows_));
    is_whole_ = true;
  }

  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  PeerTier tier_;
  PgsBoxedLcpSolver::Option option_;
  PgsBoxedLcpSolver solver_;
  int rows_ = 0;
  bool is_whole_ = false;  // A_, as assembled
  RowMajor A_;
  Eigen::VectorXd b_;
  Eigen::VectorXd lower_;
  Eigen::VectorXd upper_;
  std::vector<int> findex_;
};

std::unique_ptr<LcpSolver> Make(std::string_view key, SettingsReader* reader) {
  if (!key.starts_with("dart-dantzig")) return std::make_unique<Pgs>(key, reader);
  const bool early = reader->Choice("early_termination", "yes", {"yes", "no"}) == "yes";
  return std::make_unique<DantzigPeer>(key, reader,
                                       DantzigPeer::Code{&PadToFour, early ? &CallDantzig<true> : &CallDantzig<false>});
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  // The library does not tell its version at run time.
  return {DART_VERSION, &Make};
}

}  // namespace lcpbench
