// Siconos's solvers for linear complementarity problems, behind linearComplementarity_driver.
//
// Sweeps and Newton steps are asked for in portions, with the clock read in between: all that the next depends on is z,
// so that this changes nothing, but that conjugate gradients begin with the gradient again and projected gradients with
// their first step length, every 20 ms or so. Pivoting and the Newton method on min cannot be interrupted; the host's
// time limit ends them. Iterations are pivots,
// sweeps or Newton steps; the block method does not tell its sweeps: those asked for are counted, at most twice as many
// and kFewest as made. docs/peers.md has what is known of release 4.4.

#include <LinearComplementarityProblem.h>
#include <Newton_methods.h>
#include <NonSmoothDrivers.h>
#include <SolverOptions.h>
#include <lcp_cst.h>
#include <line_search.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/loaded_blas.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/siconos/siconos_numerics.h"

namespace lcpbench {
namespace {

// The movable bodies that a row joins; the same pair for rows between the same bodies.
using Bodies = std::array<Index, 2>;
Bodies BodiesOf(const LcpProblem& problem, Index row) {
  constexpr Index kPerBody = 3;
  Bodies bodies{-1, -1};
  for (SparseMatrix::InnerIterator entry(problem.J(), row); entry; ++entry) {
    if (problem.inverse_mass()[entry.col()] == 0) continue;
    const Index body = entry.col() / kPerBody;
    if (body == bodies[0] || body == bodies[1]) continue;
    bodies[bodies[0] < 0 ? 0 : 1] = body;
  }
  return bodies;
}

/// An LCP in Siconos's form, 0 <= z, w, z'w = 0.
///
/// Bilateral rows: Siconos's LCP solvers know none. f_i = z_i - z_i' with both >= 0, and the row -w_i beside w_i: both
/// are >= 0 only where w_i = 0. Nothing is computed for that but signs, so that the split is exact; M becomes singular.
///
/// Sparse blocks: one for the rows between the same two bodies, as Siconos's own simulation makes one for each of its
/// interactions, up to `largest_block` rows; with their mirrored rows beside them. Without factors every row is a
/// block.
class SiconosProblem : public SiconosMatrix {
 public:
  void Set(const LcpProblem& problem, Storage storage, std::size_t largest_block) {
    Clear();
    if (storage == Storage::kDense) {
      OrderByRows(problem);
      FillDense(problem);
    } else {
      OrderByBlocks(problem, largest_block);
      FillBlocks(problem.SparseA());
    }
    Finish(storage);
    problem_ = {.size = static_cast<int>(size()), .M = matrix(), .q = q()};
  }

  LinearComplementarityProblem* get() { return &problem_; }

  Eigen::VectorXd VariablesOf(const Eigen::VectorXd& f) const {
    Eigen::VectorXd z(size());
    for (Index i = 0; i < size(); ++i) {
      const Variable& variable = variables_[static_cast<std::size_t>(i)];
      z[i] = std::max(0.0, variable.factor * f[variable.row]);
    }
    return z;
  }

 private:
  void OrderByRows(const LcpProblem& problem) {
    for (Index row = 0; row < problem.size(); ++row) variables_.push_back({row, 1});
    for (const Index row : problem.bilateral_rows()) variables_.push_back({row, -1});
  }
  void OrderByBlocks(const LcpProblem& problem, std::size_t largest_block) {
    std::vector<std::vector<Index>> groups;
    std::map<Bodies, std::size_t> group_of;
    for (Index row = 0; row < problem.size(); ++row) {
      std::size_t group = groups.size();
      if (problem.has_two_body_rows()) {
        auto [found, is_new] = group_of.try_emplace(BodiesOf(problem, row), group);
        if (!is_new && groups[found->second].size() >= largest_block) found->second = group;
        group = found->second;
      }
      if (group == groups.size()) groups.emplace_back();
      groups[group].push_back(row);
    }
    for (const std::vector<Index>& group : groups) {
      for (const Index row : group) {
        variables_.push_back({row, 1});
        if (problem.is_bilateral(row)) variables_.push_back({row, -1});
      }
      ends_.push_back(static_cast<unsigned int>(variables_.size()));
    }
  }

  void FillDense(const LcpProblem& problem) {
    const Index n = problem.size();
    RequireDenseMatrices(size(), 2);  // and the code's copy
    values_.resize(variables_.size() * variables_.size());
    Eigen::Map<Eigen::MatrixXd> M(values_.data(), size(), size());
    if (problem.has_factors()) {
      AssembleDenseA(problem, values_.data(), size());  // symmetric: rows are columns
    } else {
      M.topLeftCorner(n, n) = problem.DenseA();
    }
    // The mirrored rows, then the mirrored columns.
    for (Index i = n; i < size(); ++i) M.row(i).head(n) = -M.row(RowOf(i)).head(n);
    for (Index i = n; i < size(); ++i) M.col(i) = -M.col(RowOf(i));
  }
  Index RowOf(Index variable) const { return variables_[static_cast<std::size_t>(variable)].row; }

  LinearComplementarityProblem problem_{};
};

// SICONOS_CONVEXQP_PGOC_RHO, of a header that Debian does not install.
constexpr int kProjectedGradientStep = 3;

constexpr std::size_t kLargestBlock = 16;  // rows, unless told otherwise

struct Method {
  std::string_view key;
  LCP_SOLVER solver = SICONOS_LCP_LEMKE;
  SiconosProblem::Storage storage = SiconosProblem::Storage::kDense;
  /// What one sweep or step costs, as a power of n of a dense problem; 0 for a method without tolerance.
  int cost_power = 0;
  /// Begins anew at each call, whatever z is: no portions, and the host's time limit ends it.
  bool forgets_start = false;
};

class Siconos : public LcpSolver {
 public:
  Siconos(const Method& method, std::string_view key, SettingsReader* reader)
      : method_(method), solver_(method.solver), is_library_default_(key.ends_with("-default")) {
    if (!is_library_default_) ReadSettings(reader);
  }

  std::string WhyUnsupported(const LcpProblem& problem) const override {
    // Mirrored rows end its path at once, even of a joint alone.
    const bool takes_joints = method_.solver != SICONOS_LCP_PATHSEARCH || problem.bilateral_rows().empty();
    return takes_joints ? "" : "takes unilateral rows only";
  }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    problem_.Set(problem, method_.storage, block_rows_);
    if (regularization_ > 0) largest_diagonal_ = problem.DiagonalA().cwiseAbs().maxCoeff();
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    Eigen::VectorXd z;
    Eigen::VectorXd w;
    TimeConversion(options, result, [&] {
      SetOptions(options);
      problem_.SetB(problem.b());
      // From other forces than none the path search gives up.
      const bool is_warm = options.initial_f != nullptr && method_.solver != SICONOS_LCP_PATHSEARCH;
      z = is_warm ? problem_.VariablesOf(*options.initial_f) : Eigen::VectorXd(Eigen::VectorXd::Zero(problem_.size()));
      w.setZero(problem_.size());
    });
    const Deadline deadline(options);
    SilenceLibrary();  // it prints each failed block, each sweep
    TimeLibraryCall(options, result, [&] { Run(&own_.get(), deadline, &z, &w, result); });
    TimeConversion(options, result, [&] { problem_.SetForces(z, &result->f); });
  }

 private:
  void ReadSettings(SettingsReader* reader) {
    if (method_.cost_power > 0) tier_ = PeerTier(method_.key, reader);
    switch (method_.solver) {
      case SICONOS_LCP_LEMKE:
        solver_ = Choose<LCP_SOLVER>(reader, "rule",
                                     {{"lexico", SICONOS_LCP_LEMKE},
                                      {"lemke", SICONOS_LCP_PIVOT},
                                      {"bard", SICONOS_LCP_BARD},
                                      {"murty", SICONOS_LCP_MURTY}});
        return;
      case SICONOS_LCP_NEWTON_FB_FBLSA:
        solver_ = Choose<LCP_SOLVER>(
            reader, "direction",
            {{"fischer-burmeister", SICONOS_LCP_NEWTON_FB_FBLSA}, {"min", SICONOS_LCP_NEWTON_MIN_FBLSA}});
        search_ =
            Choose<LSA_ALGO>(reader, "search", {{"armijo", SICONOS_LSA_ARMIJO}, {"goldstein", SICONOS_LSA_GOLDSTEIN}});
        reference_ =
            Choose<int>(reader, "reference", {{"monotone", NM_LS_DISABLE}, {"max", NM_LS_MAX}, {"mean", NM_LS_MEAN}});
        return;
      case SICONOS_LCP_PGS:
        regularization_ = reader->Number("regularization", 0, 0, 10);
        if (regularization_ > 0) solver_ = SICONOS_LCP_RPGS;
        return;
      case SICONOS_LCP_CONVEXQP_PG:
        first_step_ = reader->Number("first_step", 0, 0, 1e12);
        return;
      case SICONOS_LCP_NSGS_SBM:
        local_ = Choose<LCP_SOLVER>(reader, "local",
                                    {{"pgs", SICONOS_LCP_PGS},
                                     {"rpgs", SICONOS_LCP_RPGS},
                                     {"lemke", SICONOS_LCP_LEMKE},
                                     {"newton-fb", SICONOS_LCP_NEWTON_FB_FBLSA}});
        local_iterations_ = static_cast<int>(reader->Number("local_iterations", 0, 0, 1e6));
        block_rows_ = static_cast<std::size_t>(reader->Number("block_rows", kLargestBlock, 1, 1000));
        return;
      default:
        return;
    }
  }

  void SetOptions(const LcpOptions& options) {
    SolverOptions* own = own_.Fresh(solver_);
    if (method_.solver == SICONOS_LCP_NSGS_SBM) {
      solver_options_update_internal(own, 0, local_);
      if (local_iterations_ > 0) own->internalSolvers[0]->iparam[SICONOS_IPARAM_MAX_ITER] = local_iterations_;
    }
    if (method_.solver == SICONOS_LCP_NEWTON_FB_FBLSA) {
      constexpr int kRemembered = 10;
      own->iparam[SICONOS_IPARAM_LSA_SEARCH_CRITERION] = search_;
      own->iparam[SICONOS_IPARAM_LSA_NONMONOTONE_LS] = reference_;
      own->iparam[SICONOS_IPARAM_LSA_NONMONOTONE_LS_M] = reference_ == NM_LS_DISABLE ? 0 : kRemembered;
    }
    if (regularization_ > 0) own->dparam[SICONOS_LCP_DPARAM_RHO] = regularization_ * largest_diagonal_;
    if (first_step_ > 0) own->dparam[kProjectedGradientStep] = -first_step_;  // negative: with line search
    int& most = own->iparam[SICONOS_IPARAM_MAX_ITER];
    if (!is_library_default_ && method_.cost_power > 0) {
      own->dparam[SICONOS_DPARAM_TOL] = tier_.Tolerance(options);
      most = tier_.Iterations(options);
    }
    most = IterationLimit(options, most);
  }

  static constexpr std::int64_t kFewest = 16;  // sweeps

  // The block method overwrites its count of sweeps with its residual: it has made all that were asked for, or fewer
  // and solved.
  void Run(SolverOptions* own, const Deadline& deadline, Eigen::VectorXd* z, Eigen::VectorXd* w, LcpResult* result) {
    SiconosPortions portions;
    portions.counts = method_.solver != SICONOS_LCP_NSGS_SBM;
    portions.most = own->iparam[SICONOS_IPARAM_MAX_ITER];
    const bool has_portions = method_.cost_power > 0 && !method_.forgets_start;
    portions.first = has_portions ? FirstPortion(problem_, method_.cost_power) : portions.most;
    if (!portions.counts) portions.first = std::min(kFewest, portions.first);
    const auto call = [&] { return linearComplementarity_driver(problem_.get(), z->data(), w->data(), own); };
    SolveInPortions(portions, deadline, call, own, z, result);
  }

  Method method_;
  LCP_SOLVER solver_;
  bool is_library_default_;
  PeerTier tier_;
  // Newton methods:
  LSA_ALGO search_ = SICONOS_LSA_ARMIJO;
  int reference_ = NM_LS_DISABLE;
  // Sweeps:
  double regularization_ = 0;
  // Projected gradients; 0: the library's own.
  double first_step_ = 0;
  // Blocks:
  LCP_SOLVER local_ = SICONOS_LCP_PGS;
  int local_iterations_ = 0;
  std::size_t block_rows_ = kLargestBlock;
  double largest_diagonal_ = 0;
  SiconosProblem problem_;
  SiconosOptions own_;
};

constexpr auto kBlocks = SiconosProblem::Storage::kBlocks;
constexpr auto kDense = SiconosProblem::Storage::kDense;
constexpr Method kMethods[] = {
    {"siconos-lexicolemke", SICONOS_LCP_LEMKE},     {"siconos-newton-fb", SICONOS_LCP_NEWTON_FB_FBLSA, kDense, 3},
    {"siconos-pgs", SICONOS_LCP_PGS, kDense, 2},    {"siconos-nsgs-sbm", SICONOS_LCP_NSGS_SBM, kBlocks, 2},
    {"siconos-avi", SICONOS_LCP_AVI_CAOFERRIS},     {"siconos-pivot", SICONOS_LCP_PIVOT},
    {"siconos-pathsearch", SICONOS_LCP_PATHSEARCH}, {"siconos-newton-min", SICONOS_LCP_NEWTONMIN, kDense, 3, true},
    {"siconos-cpg", SICONOS_LCP_CPG, kDense, 2},    {"siconos-convexqp-pg", SICONOS_LCP_CONVEXQP_PG, kDense, 2},
};

std::unique_ptr<LcpSolver> Make(std::string_view key, SettingsReader* reader) {
  if (key.starts_with("siconos-fc")) return MakeSiconosContacts(key, reader);
  const auto* method = std::find_if(std::begin(kMethods), std::end(kMethods),
                                    [key](const Method& known) { return key.starts_with(known.key); });
  return std::make_unique<Siconos>(*method, key, reader);
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  LimitLibraryThreads(1);
  return {LCPBENCH_SICONOS_VERSION, &Make};
}

}  // namespace lcpbench
