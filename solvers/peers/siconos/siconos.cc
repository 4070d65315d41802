// Siconos's solvers for linear complementarity problems, behind linearComplementarity_driver.
//
// Known of release 4.4. The driver answers "no row pulls" (q >= 0) itself, and in the end recomputes w and accepts an
// answer when ||min(z, w)|| <= tolerance ||q||, whatever units z and w have: that is every method's claim of success. A
// residual that is not a number passes. The pivoting codes test with the tolerance that their options begin with (1e-6,
// and 1e-12 for the variational inequality). Where Lemke's method meets a column without positive entry, it gives up
// and does not say whether the problem has no solution: no claim of infeasibility is made of that.
//
// Sweeps and Newton steps are asked for in portions, with the clock read in between: all that the next depends on is z,
// so that this changes nothing. Pivoting cannot be interrupted; the host's time limit ends it.
//
// The block method solves each diagonal block by Gauss-Seidel. Its default, projected relaxation, prints a warning at
// each call; with the library's pivoting codes it passed fewer of the tuning problems, because they fail on blocks that
// redundant rows make singular, and a block that fails ends the sweep. Iterations are pivots, sweeps or Newton steps;
// the block method does not tell its sweeps: those asked for are counted, at most twice as many and kFewest as made.
//
// Settings, other than `tolerance` and of keys that do not end in -default, as the library's documentation of its LCP
// solvers has them; the first is the library's own.
//   siconos-lexicolemke  rule: lexico, lemke, bard, murty: the pivoting code (SICONOS_LCP_LEMKE, _PIVOT, _BARD, _MURTY)
//   siconos-newton-fb    direction: fischer-burmeister, min; search: armijo, goldstein; reference: monotone, max, mean
//                        (of the last ten merit values)
//   siconos-pgs          regularization: 0, or as a share of the largest diagonal entry: the regularized code (_RPGS)
//   siconos-nsgs-sbm     local: pgs, rpgs, lemke, newton-fb, the solver of a block; local-iterations: 0, its own limit,
//                        or another; block-rows: rows of a block at most

#include <LinearComplementarityProblem.h>
#include <Newton_methods.h>
#include <NonSmoothDrivers.h>
#include <NumericsMatrix.h>
#include <SolverOptions.h>
#include <SparseBlockMatrix.h>
#include <fcntl.h>
#include <lcp_cst.h>
#include <line_search.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "solvers/linear_algebra/library_threads.h"
#include "solvers/peers/given_matrix.h"
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
/// Without factors every row is a block. O(n^2), or O(nnz of A), memory.
class SiconosProblem {
 public:
  static constexpr std::size_t kLargestBlock = 16;  ///< unless told otherwise
  enum class Storage { kDense, kBlocks };

  SiconosProblem(const LcpProblem& problem, Storage storage, std::size_t largest_block)
      : matrix_(NM_new(), &FreeShell) {
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
    void* data = dense ? static_cast<void*>(values_.data()) : static_cast<void*>(&sparse_);
    NM_fill(matrix_.get(), dense ? NM_DENSE : NM_SPARSE_BLOCK, n, n, data);
    problem_.size = n;
    problem_.M = matrix_.get();
    problem_.q = q_.data();
  }
  ~SiconosProblem() {
    std::free(sparse_.diagonal_blocks);  // NOLINT(cppcoreguidelines-no-malloc): Siconos notes them there on first use
  }
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
    const auto n = static_cast<std::size_t>(problem.size());
    const std::size_t size = variables_.size();
    values_.resize(size * size);
    WriteDenseColumns(problem, static_cast<Index>(size), values_.data());
    // The mirrored rows, then the mirrored columns.
    for (std::size_t mirror = n; mirror < size; ++mirror) {
      const auto row = static_cast<std::size_t>(variables_[mirror].row);
      for (std::size_t column = 0; column < n; ++column) {
        values_[column * size + mirror] = -values_[column * size + row];
      }
    }
    for (std::size_t mirror = n; mirror < size; ++mirror) {
      const auto column = static_cast<std::size_t>(variables_[mirror].row);
      for (std::size_t i = 0; i < size; ++i) values_[mirror * size + i] = -values_[column * size + i];
    }
  }

  void FillBlocks(const LcpProblem& problem) {
    const SparseMatrix& A = problem.SparseA();
    // Where each row of the problem stands: its block, and the positions of it and of its mirror.
    struct Place {
      std::size_t block = 0;
      std::size_t first = 0;
      std::size_t count = 0;
    };
    std::vector<Place> places(static_cast<std::size_t>(problem.size()));
    const auto begin_of = [&](std::size_t block) {
      return block == 0 ? 0 : static_cast<std::size_t>(ends_[block - 1]);
    };
    for (std::size_t block = 0; block < ends_.size(); ++block) {
      for (std::size_t i = begin_of(block); i < ends_[block]; ++i) {
        Place& place = places[static_cast<std::size_t>(variables_[i].row)];
        if (place.count++ == 0) place = {block, i, 1};
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
          for (std::size_t j = place.first; j < place.first + place.count; ++j) {
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
  std::unique_ptr<NumericsMatrix, void (*)(NumericsMatrix*)> matrix_;
  LinearComplementarityProblem problem_{};
};

// The library prints each failed block, each sweep: nobody reads that, and a campaign's terminal would drown in it.
class Silence {
 public:
  Silence() {
    std::fflush(nullptr);
    const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC);  // NOLINT(cppcoreguidelines-pro-type-vararg)
    for (std::size_t i = 0; i < kStreams.size(); ++i) {
      kept_[i] = dup(kStreams[i]);
      if (nowhere >= 0) dup2(nowhere, kStreams[i]);
    }
    if (nowhere >= 0) close(nowhere);
  }
  ~Silence() {
    std::fflush(nullptr);
    for (std::size_t i = 0; i < kStreams.size(); ++i) {
      dup2(kept_[i], kStreams[i]);
      close(kept_[i]);
    }
  }
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;

 private:
  static constexpr std::array kStreams{STDOUT_FILENO, STDERR_FILENO};
  std::array<int, kStreams.size()> kept_{};
};

using OptionsPointer = std::unique_ptr<SolverOptions, void (*)(SolverOptions*)>;

struct Method {
  std::string_view key;
  LCP_SOLVER solver = SICONOS_LCP_LEMKE;
  SiconosProblem::Storage storage = SiconosProblem::Storage::kDense;
  /// What one sweep or step costs, as a power of n of a dense problem; 0 for a method that cannot be asked in portions.
  int cost_power = 0;
};

// What the settings make of a method.
struct Tuning {
  bool as_the_library_has_it = false;
  LCP_SOLVER solver = SICONOS_LCP_LEMKE;
  PeerTolerance tolerance;
  // Newton.
  LSA_ALGO search = SICONOS_LSA_ARMIJO;
  int reference = NM_LS_DISABLE;
  // Sweeps.
  double regularization = 0;
  // Blocks.
  LCP_SOLVER local = SICONOS_LCP_PGS;
  int local_iterations = 0;
  std::size_t block_rows = SiconosProblem::kLargestBlock;
};

class Siconos : public LcpSolver {
 public:
  Siconos(const Method& method, const Tuning& tuning) : method_(method), tuning_(tuning) {}

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    problem_.emplace(problem, method_.storage, tuning_.block_rows);
    if (tuning_.regularization > 0) largest_diagonal_ = problem.DiagonalA().cwiseAbs().maxCoeff();
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    OptionsPointer own(nullptr, &solver_options_delete);
    Eigen::VectorXd z;
    Eigen::VectorXd w;
    TimeConversion(options, result, [&] {
      own = MakeOptions(options);
      problem_->SetB(problem.b());
      z = options.initial_f != nullptr ? problem_->VariablesOf(*options.initial_f)
                                       : Eigen::VectorXd(Eigen::VectorXd::Zero(problem_->size()));
      w.setZero(problem_->size());
    });
    const Deadline deadline(options);
    {
      const Silence silence;
      TimeLibraryCall(options, result, [&] { Run(*own, deadline, &z, &w, result); });
    }
    TimeConversion(options, result, [&] { problem_->SetForces(z, &result->f); });
  }

 private:
  // About 20 ms of work: short beside any time limit, long beside what a call costs of itself.
  static constexpr double kPortion = 2e7;      // products
  static constexpr double kPerRow = 500;       // products that take as long as a row's solve without them
  static constexpr std::int64_t kFewest = 16;  // sweeps, of a method that does not tell how many it made

  OptionsPointer MakeOptions(const LcpOptions& options) const {
    OptionsPointer own(solver_options_create(tuning_.solver), &solver_options_delete);
    if (method_.solver == SICONOS_LCP_NSGS_SBM) {
      solver_options_update_internal(own.get(), 0, tuning_.local);
      SolverOptions& local = *own->internalSolvers[0];
      if (tuning_.local_iterations > 0) local.iparam[SICONOS_IPARAM_MAX_ITER] = tuning_.local_iterations;
    }
    if (method_.solver == SICONOS_LCP_NEWTON_FB_FBLSA) {
      constexpr int kRemembered = 10;
      own->iparam[SICONOS_IPARAM_LSA_SEARCH_CRITERION] = tuning_.search;
      own->iparam[SICONOS_IPARAM_LSA_NONMONOTONE_LS] = tuning_.reference;
      own->iparam[SICONOS_IPARAM_LSA_NONMONOTONE_LS_M] = tuning_.reference == NM_LS_DISABLE ? 0 : kRemembered;
    }
    if (tuning_.regularization > 0) own->dparam[SICONOS_LCP_DPARAM_RHO] = tuning_.regularization * largest_diagonal_;
    double most = own->iparam[SICONOS_IPARAM_MAX_ITER];
    if (!tuning_.as_the_library_has_it && method_.cost_power > 0) {
      own->dparam[SICONOS_DPARAM_TOL] = tuning_.tolerance.For(options);
      most = TierIterations(method_.key);
    }
    own->iparam[SICONOS_IPARAM_MAX_ITER] = IterationLimit(options, most);
    return own;
  }

  /// The most sweeps or steps between two readings of the clock.
  std::int64_t LargestPortion(std::int64_t most) const {
    if (method_.cost_power == 0) return most;
    const auto n = static_cast<double>(problem_->size());
    const double products =
        (static_cast<double>(problem_->entries()) + kPerRow * n) * std::pow(n, method_.cost_power - 2);
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
      const int info = linearComplementarity_driver(problem_->get(), z->data(), w->data(), &own);
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
  Tuning tuning_;
  double largest_diagonal_ = 0;
  std::optional<SiconosProblem> problem_;
};

constexpr auto kBlocks = SiconosProblem::Storage::kBlocks;
constexpr auto kDense = SiconosProblem::Storage::kDense;
constexpr Method kMethods[] = {
    {"siconos-lexicolemke", SICONOS_LCP_LEMKE},  {"siconos-newton-fb", SICONOS_LCP_NEWTON_FB_FBLSA, kDense, 3},
    {"siconos-pgs", SICONOS_LCP_PGS, kDense, 2}, {"siconos-nsgs-sbm", SICONOS_LCP_NSGS_SBM, kBlocks, 2},
    {"siconos-avi", SICONOS_LCP_AVI_CAOFERRIS},
};

void ReadSettings(const Method& method, SettingsReader* reader, Tuning* tuning) {
  if (method.cost_power > 0) tuning->tolerance = PeerTolerance(method.key, reader);
  switch (method.solver) {
    case SICONOS_LCP_LEMKE:
      tuning->solver = Choose<LCP_SOLVER>(reader, "rule",
                                          {{"lexico", SICONOS_LCP_LEMKE},
                                           {"lemke", SICONOS_LCP_PIVOT},
                                           {"bard", SICONOS_LCP_BARD},
                                           {"murty", SICONOS_LCP_MURTY}});
      return;
    case SICONOS_LCP_NEWTON_FB_FBLSA:
      tuning->solver = Choose<LCP_SOLVER>(
          reader, "direction",
          {{"fischer-burmeister", SICONOS_LCP_NEWTON_FB_FBLSA}, {"min", SICONOS_LCP_NEWTON_MIN_FBLSA}});
      tuning->search =
          Choose<LSA_ALGO>(reader, "search", {{"armijo", SICONOS_LSA_ARMIJO}, {"goldstein", SICONOS_LSA_GOLDSTEIN}});
      tuning->reference =
          Choose<int>(reader, "reference", {{"monotone", NM_LS_DISABLE}, {"max", NM_LS_MAX}, {"mean", NM_LS_MEAN}});
      return;
    case SICONOS_LCP_PGS:
      tuning->regularization = reader->Number("regularization", 0, 0, 10);
      if (tuning->regularization > 0) tuning->solver = SICONOS_LCP_RPGS;
      return;
    case SICONOS_LCP_NSGS_SBM:
      tuning->local = Choose<LCP_SOLVER>(reader, "local",
                                         {{"pgs", SICONOS_LCP_PGS},
                                          {"rpgs", SICONOS_LCP_RPGS},
                                          {"lemke", SICONOS_LCP_LEMKE},
                                          {"newton-fb", SICONOS_LCP_NEWTON_FB_FBLSA}});
      tuning->local_iterations = static_cast<int>(reader->Number("local-iterations", 0, 0, 1e6));
      tuning->block_rows =
          static_cast<std::size_t>(reader->Number("block-rows", static_cast<double>(tuning->block_rows), 1, 1000));
      return;
    default:
      return;
  }
}

std::unique_ptr<LcpSolver> Make(std::string_view key, const Settings& settings) {
  SettingsReader reader(key, settings);
  const auto* method = std::find_if(std::begin(kMethods), std::end(kMethods),
                                    [key](const Method& known) { return key.starts_with(known.key); });
  Tuning tuning;
  tuning.as_the_library_has_it = key.ends_with("-default");
  tuning.solver = method->solver;
  if (!tuning.as_the_library_has_it) ReadSettings(*method, &reader, &tuning);
  reader.Finish();
  return std::make_unique<Siconos>(*method, tuning);
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  LimitLibraryThreads(1);
  return {LCPBENCH_SICONOS_VERSION, &Make};
}

}  // namespace lcpbench
