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
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <SparseBlockMatrix.h>
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
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/loaded_blas.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

// What the arrays of this class hold is not Siconos's to free.
void FreeShell(NumericsMatrix* matrix) {
  matrix->matrix0 = nullptr;
  matrix->matrix1 = nullptr;
  NM_clear(matrix);
  std::free(matrix);  // NOLINT(cppcoreguidelines-no-malloc): from NM_new
}

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

/// The matrix of a problem in Siconos's form, w = M z + q, 0 <= z, w, z'w = 0, and a place for q.
///
/// Bilateral rows: Siconos's LCP solvers know none. f_i = z_i - z_i' with both >= 0, and the row -w_i beside w_i: both
/// are >= 0 only where w_i = 0. Nothing is computed for that but signs, so that the split is exact; M becomes singular.
///
/// Either dense (column by column), or in sparse blocks: one for the rows between the same two bodies, as Siconos's own
/// simulation makes one for each of its interactions, up to `largest_block` rows; with their mirrored rows beside them.
/// Without factors every row is a block. O(n^2), or O(nnz of A), memory, which stays for the next problem.
class SiconosProblem {
 public:
  enum class Storage { kDense, kBlocks };

  SiconosProblem() = default;
  void Set(const LcpProblem& problem, Storage storage, std::size_t largest_block) {
    Clear();
    const bool dense = storage == Storage::kDense;
    if (dense) {
      OrderByRows(problem);
      FillDense(problem);
    } else {
      OrderByBlocks(problem, largest_block);
      FillBlocks(problem);
    }
    q_.resize(variables_.size());
    const auto n = static_cast<int>(variables_.size());
    matrix_.reset(NM_new());  // the library keeps factors of the one before in it
    void* data = dense ? static_cast<void*>(values_.data()) : static_cast<void*>(&sparse_);
    NM_fill(matrix_.get(), dense ? NM_DENSE : NM_SPARSE_BLOCK, n, n, data);
    problem_.size = n;
    problem_.M = matrix_.get();
    problem_.q = q_.data();
  }
  ~SiconosProblem() { Clear(); }
  SiconosProblem(const SiconosProblem&) = delete;
  SiconosProblem& operator=(const SiconosProblem&) = delete;

  LinearComplementarityProblem* get() { return &problem_; }
  /// q from b of a problem with the same matrix.
  void SetB(const Eigen::VectorXd& b) {
    for (std::size_t i = 0; i < q_.size(); ++i) q_[i] = variables_[i].sign * b[variables_[i].row];
  }
  /// Rows, the mirrored ones included.
  Index size() const { return static_cast<Index>(variables_.size()); }
  /// Stored entries of M.
  std::size_t entries() const { return values_.size(); }

  Eigen::VectorXd VariablesOf(const Eigen::VectorXd& f) const {
    Eigen::VectorXd z(size());
    for (Index i = 0; i < size(); ++i) {
      const Variable& variable = variables_[static_cast<std::size_t>(i)];
      z[i] = std::max(0.0, variable.sign * f[variable.row]);
    }
    return z;
  }
  void SetForces(const Eigen::VectorXd& z, Eigen::VectorXd* f) const {
    f->setZero();
    for (Index i = 0; i < size(); ++i) {
      const Variable& variable = variables_[static_cast<std::size_t>(i)];
      (*f)[variable.row] += variable.sign * z[i];
    }
  }

 private:
  struct Variable {
    Index row = 0;
    double sign = 1;
  };

  void Clear() {
    matrix_.reset();
    std::free(sparse_.diagonal_blocks);  // NOLINT(cppcoreguidelines-no-malloc): Siconos notes them there on first use
    sparse_ = {};
    variables_.clear();
    ends_.clear();
    row_starts_.clear();
    columns_.clear();
    blocks_.clear();
  }

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

  void FillBlocks(const LcpProblem& problem) {
    const SparseMatrix& A = problem.SparseA();
    // Where each row of the problem stands: its block, and the position of it; of its mirror the one behind.
    struct Place {
      std::size_t block = 0;
      std::size_t first = 0;
    };
    std::vector<Place> places(static_cast<std::size_t>(problem.size()));
    const auto begin_of = [&](std::size_t block) {
      return block == 0 ? 0 : static_cast<std::size_t>(ends_[block - 1]);
    };
    for (std::size_t block = 0; block < ends_.size(); ++block) {
      for (std::size_t i = begin_of(block); i < ends_[block]; ++i) {
        if (variables_[i].sign > 0) places[static_cast<std::size_t>(variables_[i].row)] = {block, i};
      }
    }
    // The pattern first, since values_ must not move once blocks point into it.
    std::vector<std::size_t> offsets;
    std::size_t total = 0;
    row_starts_.push_back(0);
    for (std::size_t block = 0; block < ends_.size(); ++block) {
      std::vector<std::size_t> neighbours{block};
      for (std::size_t i = begin_of(block); i < ends_[block]; ++i) {
        for (SparseMatrix::InnerIterator entry(A, variables_[i].row); entry; ++entry) {
          neighbours.push_back(places[static_cast<std::size_t>(entry.col())].block);
        }
      }
      std::sort(neighbours.begin(), neighbours.end());
      neighbours.erase(std::unique(neighbours.begin(), neighbours.end()), neighbours.end());
      for (const std::size_t neighbour : neighbours) {
        columns_.push_back(neighbour);
        offsets.push_back(total);
        total += (ends_[block] - begin_of(block)) * (ends_[neighbour] - begin_of(neighbour));
      }
      row_starts_.push_back(columns_.size());
    }
    values_.assign(total, 0);
    for (const std::size_t offset : offsets) blocks_.push_back(values_.data() + offset);
    for (std::size_t block = 0; block < ends_.size(); ++block) {
      const std::size_t height = ends_[block] - begin_of(block);
      const auto first = columns_.begin() + static_cast<std::ptrdiff_t>(row_starts_[block]);
      const auto last = columns_.begin() + static_cast<std::ptrdiff_t>(row_starts_[block + 1]);
      for (std::size_t i = begin_of(block); i < ends_[block]; ++i) {
        for (SparseMatrix::InnerIterator entry(A, variables_[i].row); entry; ++entry) {
          const Place& place = places[static_cast<std::size_t>(entry.col())];
          const auto column = std::lower_bound(first, last, place.block);
          double* values = blocks_[static_cast<std::size_t>(column - columns_.begin())];
          const std::size_t end = place.first + (problem.is_bilateral(entry.col()) ? 2 : 1);
          for (std::size_t j = place.first; j < end; ++j) {
            values[(i - begin_of(block)) + (j - begin_of(place.block)) * height] =
                variables_[i].sign * variables_[j].sign * entry.value();
          }
        }
      }
    }
    SBM_null(&sparse_);
    sparse_.nbblocks = static_cast<unsigned int>(blocks_.size());
    sparse_.block = blocks_.data();
    sparse_.blocknumber0 = sparse_.blocknumber1 = static_cast<unsigned int>(ends_.size());
    sparse_.blocksize0 = sparse_.blocksize1 = ends_.data();
    sparse_.filled1 = row_starts_.size();
    sparse_.filled2 = columns_.size();
    sparse_.index1_data = row_starts_.data();
    sparse_.index2_data = columns_.data();
  }

  std::vector<Variable> variables_;
  std::vector<double> q_;
  std::vector<double> values_;
  // Blocks: where each ends, and the compressed rows of blocks.
  std::vector<unsigned int> ends_;
  std::vector<std::size_t> row_starts_;
  std::vector<std::size_t> columns_;
  std::vector<double*> blocks_;
  SparseBlockStructuredMatrix sparse_{};
  std::unique_ptr<NumericsMatrix, void (*)(NumericsMatrix*)> matrix_{nullptr, &FreeShell};
  LinearComplementarityProblem problem_{};
};

// SICONOS_CONVEXQP_PGOC_RHO, of a header that Debian does not install.
constexpr int kProjectedGradientStep = 3;

constexpr std::size_t kLargestBlock = 16;  // rows, unless told otherwise

using OptionsPointer = std::unique_ptr<SolverOptions, void (*)(SolverOptions*)>;

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
    TimeLibraryCall(options, result, [&] { Run(*own_, deadline, &z, &w, result); });
    TimeConversion(options, result, [&] { problem_.SetForces(z, &result->f); });
  }

 private:
  // About 20 ms of work: short beside any time limit, long beside what a call costs of itself.
  static constexpr double kPortion = 2e7;      // products
  static constexpr double kPerRow = 500;       // products that take as long as a row's solve without them
  static constexpr std::int64_t kFewest = 16;  // sweeps, of a method that does not tell how many it made

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

  // Kept, as a user keeps them, unless a method has hung something of the problem before on them. Numbers are set anew,
  // since methods write to them.
  void SetOptions(const LcpOptions& options) {
    SolverOptions* own = own_.get();
    const bool is_kept = own != nullptr && own->numberOfInternalSolvers == 0 && own->dWork == nullptr &&
                         own->iWork == nullptr && own->solverData == nullptr;
    if (is_kept) {
      std::copy(integers_.begin(), integers_.end(), own->iparam);
      std::copy(reals_.begin(), reals_.end(), own->dparam);
    } else {
      own_.reset(solver_options_create(solver_));
      own = own_.get();
      integers_.assign(own->iparam, own->iparam + own->iSize);
      reals_.assign(own->dparam, own->dparam + own->dSize);
    }
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

  /// The most sweeps or steps between two readings of the clock.
  std::int64_t LargestPortion(std::int64_t most) const {
    if (method_.cost_power == 0 || method_.forgets_start) return most;
    const auto n = static_cast<double>(problem_.size());
    const double products =
        (static_cast<double>(problem_.entries()) + kPerRow * n) * std::pow(n, method_.cost_power - 2);
    return std::max<std::int64_t>(1, static_cast<std::int64_t>(kPortion / products));
  }

  void Run(SolverOptions& own, const Deadline& deadline, Eigen::VectorXd* z, Eigen::VectorXd* w, LcpResult* result) {
    // The block method overwrites its count of sweeps with its residual: it has made all that were asked for, or fewer
    // and solved.
    const bool counts = method_.solver != SICONOS_LCP_NSGS_SBM;
    const std::int64_t most = own.iparam[SICONOS_IPARAM_MAX_ITER];
    const std::int64_t largest = LargestPortion(most);
    std::int64_t portion = counts ? largest : std::min(kFewest, largest);
    Eigen::VectorXd before;
    result->iterations = 0;
    for (;;) {
      const int asked = static_cast<int>(std::min(portion, most - result->iterations));
      own.iparam[SICONOS_IPARAM_MAX_ITER] = asked;
      own.iparam[SICONOS_IPARAM_ITER_DONE] = 0;
      before = *z;
      const int info = linearComplementarity_driver(problem_.get(), z->data(), w->data(), &own);
      const int done = counts ? own.iparam[SICONOS_IPARAM_ITER_DONE] : asked;
      result->iterations += done;
      if (info == 0) {
        result->status = LcpStatus::kSolved;
        return;
      }
      if (done == asked && result->iterations >= most) {
        result->status = LcpStatus::kIterationLimit;
        return;
      }
      if (done < asked || *z == before) {
        std::ostringstream detail;
        detail << "Siconos: gave up, its residual " << own.dparam[SICONOS_DPARAM_RESIDU];
        result->detail = detail.str();
        return;
      }
      if (deadline.Expired()) {
        result->status = LcpStatus::kTimeLimit;
        return;
      }
      portion = std::min(2 * portion, largest);
    }
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
  OptionsPointer own_{nullptr, &solver_options_delete};
  std::vector<int> integers_;  // of own_, as the library makes them
  std::vector<double> reals_;
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
