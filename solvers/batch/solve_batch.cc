#include "solvers/batch/solve_batch.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <barrier>
#include <cmath>
#include <exception>
#include <functional>
#include <limits>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "solvers/batch/instructions.h"
#include "solvers/batch/kernel.h"
#include "solvers/lcp/residual.h"
#include "solvers/pivoting/tableau_rules.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// Groups that a thread takes at a time.
constexpr std::size_t kChunk = 4;
constexpr std::size_t kSizes = kBatchMaxRows + 1;
static_assert(BatchSolver::kMaxRows == kBatchMaxRows);

}  // namespace

// Threads that wait between calls. Only construction allocates.
class WorkerPool {
 public:
  // @param threads  >= 1, the calling one among them
  explicit WorkerPool(int threads) : start_(threads), done_(threads) {
    for (int worker = 1; worker < threads; ++worker) {
      threads_.emplace_back([this, worker] {
        for (start_.arrive_and_wait(); job_ != nullptr; start_.arrive_and_wait()) {
          Call(worker);
          done_.arrive_and_wait();
        }
      });
    }
  }
  ~WorkerPool() {
    job_ = nullptr;
    start_.arrive_and_wait();
    for (std::thread& thread : threads_) thread.join();
  }
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  // job(w) once for every w in [0, threads), worker 0 on the calling thread; returns when all have. The first
  // exception of any is thrown again here.
  void Run(const std::function<void(int worker)>& job) {
    job_ = &job;
    start_.arrive_and_wait();
    Call(0);
    done_.arrive_and_wait();
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  void Call(int worker) {
    try {
      (*job_)(worker);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
  }

  std::barrier<> start_, done_;
  const std::function<void(int)>* job_ = nullptr;  // written before start_ by the caller alone; none: end
  std::mutex mutex_;
  std::exception_ptr error_;
  std::vector<std::thread> threads_;
};

struct BatchSolver::Implementation {
  explicit Implementation(const BatchOptions& batch_options)
      : instructions(batch_options.instructions == BatchInstructions::kBest ? AvailableBatchInstructions().back()
                                                                            : batch_options.instructions),
        kernel(FindBatchKernels(instructions)),
        pool(CheckedThreads(batch_options)) {
    for (int i = 0; i < batch_options.threads; ++i) {
      fallback.push_back(std::make_unique<AutoSolver>(batch_options.fallback));
    }
    for (const std::unique_ptr<AutoSolver>& solver : fallback) solver->Reserve(kMaxRows);
    scratch.resize(fallback.size());
    tests.resize(fallback.size());
    for (LcpResult& result : scratch) result.f.resize(kMaxRows);
  }

  static int CheckedThreads(const BatchOptions& given) {
    if (given.threads < 1) throw InputError("batch: threads must be >= 1, found " + std::to_string(given.threads));
    return given.threads;
  }

  void Start(const LcpOptions& lcp_options) {
    if (lcp_options.initial_f != nullptr) throw InputError("batch: an initial f is not for a batch of problems");
    fallback[0]->Solve(nothing, lcp_options, &scratch[0]);  // refuses options out of range
    options = lcp_options;
    deadline.emplace(options);
    fallbacks = 0;
    next = 0;
  }
  bool TimeIsUp() const { return std::isfinite(options.time_limit_s) && deadline->Expired(); }

  void Reserve(std::size_t problems) {
    if (order.size() >= problems) return;
    order.resize(problems);
    rows.resize(problems);
  }

  // Both kinds of batches: sorts what lanes take by size, runs the groups, and leaves the rest to `batch.Fallback`.
  template <typename Batch>
  void Run(Batch* batch) {
    std::array<std::size_t, kSizes + 1> starts{};
    const std::size_t count = batch->size();
    Reserve(count);
    // Sizes in [1, 32] for the lanes, 0 for the others, which come first.
    for (std::size_t p = 0; p < count; ++p) {
      rows[p] = static_cast<unsigned char>(batch->LaneRows(p));
      ++starts[rows[p] + 1U];
    }
    for (std::size_t size = 1; size <= kSizes; ++size) starts[size] += starts[size - 1];
    others = starts[1];
    end = count;
    for (std::size_t p = 0; p < count; ++p) order[starts[rows[p]]++] = p;
    pool.Run([this, batch](int worker) { Work(batch, static_cast<std::size_t>(worker)); });
  }

  template <typename Batch>
  void Work(Batch* batch, std::size_t worker) {
    const std::size_t lanes = kernel.lanes;
    const std::size_t chunk = kChunk * lanes;
    BatchGroup group;
    group.rho_limit = std::min(tableau::kMostRho, options.tolerance / 2);
    group.rounding_limit = options.tolerance / 2;
    group.close_rho_limit = options.tolerance;
    group.row_limit = tableau::kMargin * std::sqrt(options.tolerance);
    for (;;) {
      const std::size_t first = next.fetch_add(chunk, std::memory_order_relaxed);
      if (first >= end) return;
      const std::size_t last = std::min(end, first + chunk);
      std::size_t p = first;
      for (; p < last && p < others; ++p) Leave(batch, order[p], worker);
      for (; p < last; p += lanes) {
        const std::size_t used = std::min(lanes, last - p);
        for (std::size_t l = 0; l < used; ++l) group.items[l] = batch->Item(order[p + l]);
        for (std::size_t l = used; l < lanes; ++l) group.items[l] = group.items[0];
        group.met = group.close = 0;
        if (!TimeIsUp()) kernel.solve(&group);
        for (std::size_t l = 0; l < used; ++l) {
          const bool met = (group.met >> l & 1U) != 0;
          const bool close = (group.close >> l & 1U) != 0;
          if (met || (close && Meets(batch, order[p + l], &tests[worker]))) {
            batch->Answer(order[p + l], LcpStatus::kSolved, group.pivots[l], "lanes");
          } else {
            Leave(batch, order[p + l], worker);
          }
        }
      }
    }
  }

  template <typename Batch>
  bool Meets(Batch* batch, std::size_t p, GivenFormTest* test) const {
    test->Reset(batch->Problem(p), GivenFormTest::Rows::kGivenWhenNeeded);
    return test->Meets(options.tolerance, batch->Forces(p));
  }

  template <typename Batch>
  void Leave(Batch* batch, std::size_t p, std::size_t worker) {
    if (TimeIsUp()) {
      batch->Forces(p).setZero();
      batch->Answer(p, LcpStatus::kTimeLimit, 0, "");
      return;
    }
    fallbacks.fetch_add(1, std::memory_order_relaxed);
    LcpOptions rest = options;
    if (std::isfinite(options.time_limit_s)) {
      rest.time_limit_s = std::max(deadline->Remaining(), std::numeric_limits<double>::min());
    }
    LcpResult* const result = batch->ResultOr(p, &scratch[worker]);
    fallback[worker]->Solve(batch->Problem(p), rest, result);
    batch->Take(p, *result);
  }

  BatchInstructions instructions;
  const BatchKernels& kernel;
  std::vector<std::unique_ptr<AutoSolver>> fallback;  // one per thread
  std::vector<LcpResult> scratch;
  std::vector<GivenFormTest> tests;
  LcpProblem nothing = LcpProblem::FromDense("", Eigen::MatrixXd(), Eigen::VectorXd());
  std::vector<std::size_t> order;
  std::vector<unsigned char> rows;  // as lanes see a problem, 0 for what is not for them
  std::size_t others = 0;
  std::size_t end = 0;
  LcpOptions options;
  std::optional<Deadline> deadline;
  std::atomic<std::size_t> next = 0;
  std::atomic<Index> fallbacks = 0;
  WorkerPool pool;  // last: its threads end first
};

namespace {

struct ProblemBatch {
  std::span<const LcpProblem> problems;
  std::span<LcpResult> results;
  bool to_lanes;

  std::size_t size() const { return problems.size(); }
  Index LaneRows(std::size_t p) const {
    const LcpProblem& problem = problems[p];
    const bool fits = to_lanes && problem.size() <= BatchSolver::kMaxRows && problem.IsNumericallySymmetric();
    return fits ? problem.size() : 0;
  }
  const LcpProblem& Problem(std::size_t p) const { return problems[p]; }
  Eigen::VectorXd& Forces(std::size_t p) {
    results[p].f.resize(problems[p].size());
    return results[p].f;
  }
  BatchItem Item(std::size_t p) {
    std::uint32_t joints = 0;
    for (const Index row : problems[p].bilateral_rows()) joints |= 1U << static_cast<unsigned>(row);
    return {problems[p].DenseA().data(), problems[p].b().data(), Forces(p).data(), joints,
            static_cast<int>(problems[p].size())};
  }
  LcpResult* ResultOr(std::size_t p, LcpResult* /*scratch*/) { return &results[p]; }
  void Take(std::size_t /*p*/, const LcpResult& /*result*/) {}
  void Answer(std::size_t p, LcpStatus status, int pivots, const char* detail) {
    LcpResult& result = results[p];
    result.status = status;
    result.iterations = pivots;
    result.detail = detail;
    result.own_solve_s = -1;
    result.own_convert_s = -1;
    result.farkas_ray.reset();
  }
};

struct RawBatch {
  const DenseBatch& given;
  double* f;
  LcpStatus* status;
  bool to_lanes;

  std::size_t size() const { return static_cast<std::size_t>(given.problems); }
  Index LaneRows(std::size_t /*p*/) const { return to_lanes ? given.rows : 0; }
  LcpProblem Problem(std::size_t p) {
    const BatchItem item = Item(p);
    std::vector<Index> bilateral;
    for (Index i = 0; i < given.rows; ++i) {
      if ((item.joints >> i & 1U) != 0) bilateral.push_back(i);
    }
    // Columns of the map are rows of the given A: what is read is its upper triangle.
    const Eigen::MatrixXd A = Eigen::Map<const Eigen::MatrixXd>(item.A, given.rows, given.rows);
    return LcpProblem::FromDense(std::to_string(p), A.selfadjointView<Eigen::Upper>(),
                                 Eigen::Map<const Eigen::VectorXd>(item.b, given.rows),
                                 RowBounds::WithBilateralRows(given.rows, bilateral));
  }
  Eigen::Map<Eigen::VectorXd> Forces(std::size_t p) { return {Item(p).f, given.rows}; }
  BatchItem Item(std::size_t p) {
    const auto n = static_cast<std::size_t>(given.rows);
    return {given.A + p * n * n, given.b + p * n, f + p * n, given.bilateral == nullptr ? 0 : given.bilateral[p],
            static_cast<int>(n)};
  }
  LcpResult* ResultOr(std::size_t /*p*/, LcpResult* scratch) { return scratch; }
  void Take(std::size_t p, const LcpResult& result) {
    Forces(p) = result.f;
    Answer(p, result.status, 0, "");
  }
  void Answer(std::size_t p, LcpStatus value, int /*pivots*/, const char* /*detail*/) {
    if (status != nullptr) status[p] = value;
  }
};

}  // namespace

BatchSolver::BatchSolver(BatchOptions options) : implementation_(std::make_unique<Implementation>(options)) {}
BatchSolver::~BatchSolver() = default;

void BatchSolver::Reserve(Index max_problems) {
  implementation_->Reserve(static_cast<std::size_t>(std::max<Index>(max_problems, 0)));
}

void BatchSolver::Solve(std::span<const LcpProblem> problems, const LcpOptions& options, std::span<LcpResult> results) {
  if (problems.size() != results.size()) {
    throw InputError("batch: " + std::to_string(problems.size()) + " problems, but " + std::to_string(results.size()) +
                     " results");
  }
  implementation_->Start(options);
  ProblemBatch batch{problems, results, options.max_iterations == 0};
  implementation_->Run(&batch);
}

void BatchSolver::Solve(const DenseBatch& batch, const LcpOptions& options, double* f, LcpStatus* status) {
  if (batch.rows < 0 || batch.rows > kMaxRows || batch.problems < 0) {
    throw InputError("batch: rows must be in [0, " + std::to_string(kMaxRows) + "], problems >= 0, found " +
                     std::to_string(batch.rows) + " and " + std::to_string(batch.problems));
  }
  implementation_->Start(options);
  RawBatch raw{batch, f, status, options.max_iterations == 0};
  implementation_->Run(&raw);
}

Index BatchSolver::fallbacks() const { return implementation_->fallbacks; }
BatchInstructions BatchSolver::instructions() const { return implementation_->instructions; }

}  // namespace lcpbench
