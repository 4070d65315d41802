// Where the time of a fresh step goes that RowSolver answers: nanoseconds a problem by phase (load, islands, assemble,
// pivots, sweeps, factor, check, store) and size, beside a floor, what reading the problem once and writing f and w
// once takes. The problems are placed scenes that the collection does not have, solved one after the other; every
// answer is judged by the verifier first. The total is processor time without clock reads in between. The parts come
// from a second run of the same work that a timer interrupts: program counters, looked up in this program's line tables
// by addr2line, give the shares of phases. A function of kPhaseOf that is inlined counts as itself, any other one for
// its caller.

#include <link.h>
#include <ucontext.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "benchmarks/command/options.h"
#include "benchmarks/command/program.h"
#include "benchmarks/studies/fresh_problems.h"
#include "solvers/auto/auto_solver.h"
#include "solvers/lcp/solver.h"
#include "solvers/lcp/verify.h"
#include "solvers/rows/row_solver.h"
#include "solvers/step/step_solver.h"
#include "support/clock.h"
#include "support/input_error.h"
#include "support/subprocess.h"

namespace lcpbench {
namespace {

enum Phase : std::uint8_t { kLoad, kIslands, kAssemble, kPivots, kSweeps, kFactor, kCheck, kStore, kOther, kPhases };
constexpr std::array<const char*, kPhases> kPhaseNames = {"load",   "islands", "assemble", "pivots", "sweeps",
                                                          "factor", "check",   "store",    "other"};

// Functions by source file and name. What is called from several phases is not here.
struct PhaseOf {
  std::string_view file;
  std::string_view function;
  Phase phase;
};
constexpr PhaseOf kPhaseOf[] = {
    {"row_solver", "Take", kLoad},
    {"row_solver", "TakeRows", kLoad},
    {"check_rows", "CheckRows", kLoad},
    {"step_rows", "HasDiagonalInRange", kLoad},
    {"row_islands", "Find", kIslands},
    {"row_islands", "Root", kIslands},
    {"tiny_rows", "SolveRows", kAssemble},  // what is left of it are loops that read and assemble
    {"tiny_rows", "Find", kPivots},
    {"tiny_rows", "Try", kPivots},
    {"tiny_rows", "Enter", kPivots},
    {"tiny_rows", "Clip", kCheck},
    {"tiny_rows", "Passes", kCheck},
    {"tiny_rows", "Store", kStore},
    {"small_pivoting", "LoadRows", kLoad},
    {"small_pivoting", "LoadRowsOf", kLoad},
    {"small_pivoting", "JoinSides", kLoad},
    {"small_pivoting", "Scale", kAssemble},
    {"small_pivoting", "AssembleByRegisters", kAssemble},
    {"small_pivoting", "AssembleByBodies", kAssemble},
    {"small_pivoting", "SolveInClosedForm", kPivots},
    {"small_pivoting", "TryGuess", kPivots},
    {"small_pivoting", "SolveGuess", kPivots},
    {"small_pivoting", "FindActiveSet", kPivots},
    {"small_pivoting", "DrivePivots", kPivots},
    {"small_pivoting", "Pivot", kPivots},
    {"small_pivoting", "EliminateBoth", kPivots},
    {"small_pivoting", "EliminateOne", kPivots},
    {"small_pivoting", "CatchUp", kPivots},
    {"small_pivoting", "Refine", kPivots},
    {"small_pivoting", "FindForces", kCheck},
    {"small_pivoting", "Rho", kCheck},
    {"small_pivoting", "RowsMeet", kCheck},
    {"small_pivoting", "Finish", kCheck},
    {"small_pivoting", "Store", kStore},
    {"profile_pivoting", "Load", kLoad},
    {"profile_pivoting", "OrderBodies", kLoad},
    {"profile_pivoting", "FindProfile", kAssemble},
    {"profile_pivoting", "AssembleProfile", kAssemble},
    {"profile_pivoting", "Iterate", kSweeps},
    {"profile_pivoting", "Sweep", kSweeps},
    {"profile_pivoting", "Restart", kSweeps},
    {"profile_pivoting", "Pivot", kFactor},
    {"profile_pivoting", "Factorize", kFactor},
    {"profile_pivoting", "SolveFactor", kFactor},
    {"profile_pivoting", "FollowCentralPath", kFactor},
    {"profile_pivoting", "Residual", kCheck},
    {"profile_pivoting", "PolishOf", kCheck},
    {"profile_pivoting", "Store", kStore},
    {"row_solver", "Judge", kCheck},
    {"row_solver", "JudgePart", kCheck},
};

// What of the memory is the program's own code.
struct Text {
  std::uintptr_t at = 0;  // that it must hold
  std::uintptr_t base = 0;
  std::uintptr_t begin = 0;
  std::uintptr_t end = 0;
};

// Where a timer interrupts this program.
class Sampler {
 public:
  static constexpr std::size_t kMost = 1 << 16;

  Sampler() {
    own_.at = reinterpret_cast<std::uintptr_t>(&HandleSignal);
    dl_iterate_phdr(&FindText, &own_);
    if (own_.begin == own_.end) throw std::runtime_error("the program's own code was not found");
    addresses_.assign(kMost, 0);
    struct sigaction action = {};
    action.sa_sigaction = &HandleSignal;
    action.sa_flags = SA_SIGINFO | SA_RESTART;
    if (sigaction(SIGPROF, &action, nullptr) != 0) throw std::system_error(errno, std::generic_category(), "sigaction");
    sigevent event = {};
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGPROF;
    if (timer_create(CLOCK_MONOTONIC, &event, &timer_) != 0) {
      throw std::system_error(errno, std::generic_category(), "timer_create");
    }
  }
  ~Sampler() {
    timer_delete(timer_);
    signal(SIGPROF, SIG_IGN);
  }
  Sampler(const Sampler&) = delete;
  Sampler& operator=(const Sampler&) = delete;

  void Start(std::int64_t period_ns) {
    count_ = 0;
    Set(period_ns);
  }
  // Addresses as the file of this program has them, in the order of time.
  std::vector<std::uintptr_t> Stop() {
    Set(0);
    std::vector<std::uintptr_t> found(addresses_.begin(), addresses_.begin() + static_cast<std::ptrdiff_t>(count_));
    for (std::uintptr_t& address : found) address -= IsOwn(address) ? own_.base : address;
    return found;
  }

 private:
  static int FindText(dl_phdr_info* info, std::size_t /*size*/, void* to) {
    auto* text = static_cast<Text*>(to);
    for (int k = 0; k < info->dlpi_phnum; ++k) {
      const auto& segment = info->dlpi_phdr[k];
      const std::uintptr_t begin = info->dlpi_addr + segment.p_vaddr;
      if (segment.p_type != PT_LOAD || text->at < begin || text->at - begin >= segment.p_memsz) continue;
      *text = {text->at, info->dlpi_addr, begin, begin + segment.p_memsz};
      return 1;
    }
    return 0;
  }
  static bool IsOwn(std::uintptr_t address) { return address >= own_.begin && address < own_.end; }
  static void HandleSignal(int /*signal*/, siginfo_t* /*info*/, void* context) {
    if (count_ == kMost) return;
    const auto* machine = static_cast<const ucontext_t*>(context);
    auto address = static_cast<std::uintptr_t>(machine->uc_mcontext.gregs[REG_RIP]);
    if (!IsOwn(address)) {
      // Copies of the C library have no frame: who called them is on top of the stack.
      const auto caller = *std::bit_cast<const std::uintptr_t*>(machine->uc_mcontext.gregs[REG_RSP]);
      if (IsOwn(caller)) address = caller - 1;
    }
    addresses_[count_++] = address;
  }
  void Set(std::int64_t period_ns) const {
    itimerspec every = {};
    every.it_interval.tv_nsec = period_ns;
    every.it_value.tv_nsec = period_ns;
    if (timer_settime(timer_, 0, &every, nullptr) != 0) {
      throw std::system_error(errno, std::generic_category(), "timer_settime");
    }
  }

  static inline Text own_;
  static inline std::vector<std::uintptr_t> addresses_;
  static inline std::size_t count_ = 0;
  timer_t timer_ = {};
};

// "Pivot" of "bool lcpbench::SmallPivoting::Pivot<4>(long)".
std::string BareName(std::string name) {
  constexpr std::string_view kUnnamed = "(anonymous namespace)::";
  for (std::size_t at = 0; (at = name.find(kUnnamed)) != std::string::npos;) name.erase(at, kUnnamed.size());
  std::string bare;
  int depth = 0;
  for (const char c : name) {
    if (c == '<') ++depth;
    if (depth == 0 && c == '(') break;
    if (depth == 0) bare = c == ' ' || c == ':' ? "" : bare + c;
    if (c == '>') --depth;
  }
  return bare;
}

std::string Stem(std::string path) {
  path.erase(0, path.find_last_of('/') + 1);
  return path.substr(0, path.find('.'));
}

std::string ReadLink(const char* path) {
  std::string target(4096, '\0');
  const ssize_t length = readlink(path, target.data(), target.size());
  target.resize(length > 0 ? static_cast<std::size_t>(length) : 0);
  return target;
}

// Looks addresses up, each once.
class Phases {
 public:
  void Learn(const std::vector<std::uintptr_t>& addresses) {
    std::set<std::uintptr_t> unknown;
    for (const std::uintptr_t address : addresses) {
      if (address != 0 && known_.count(address) == 0) unknown.insert(address);
    }
    constexpr std::size_t kAtOnce = 2000;  // the length of a command line is limited
    for (auto next = unknown.begin(); next != unknown.end();) {
      SubprocessOptions options;
      options.command = {"addr2line", "-a", "-i", "-f", "-C", "-e", ReadLink("/proc/self/exe")};
      for (std::size_t k = 0; k < kAtOnce && next != unknown.end(); ++k, ++next) {
        std::ostringstream text;
        text << "0x" << std::hex << *next;
        options.command.push_back(text.str());
      }
      Read(options);
    }
  }
  Phase Of(std::uintptr_t address) const {
    const auto found = known_.find(address);
    return found == known_.end() ? kOther : found->second.phase;
  }
  // For --functions: innermost function of all.
  std::string FunctionOf(std::uintptr_t address) const {
    const auto found = known_.find(address);
    return found == known_.end() ? "a library" : found->second.function;
  }

 private:
  struct Place {
    Phase phase = kOther;
    std::string function;
  };

  // An address, then of each function, the innermost one first, its name and its place.
  void Read(const SubprocessOptions& options) {
    constexpr double kLimit = 120;  // s
    Subprocess addr2line(options);
    const double until = SteadyNow() + kLimit;
    Place* place = nullptr;
    std::string line;
    while (addr2line.ReadLine(&line, until) == Transfer::kDone) {
      if (line.starts_with("0x")) {
        place = &known_[std::stoull(line, nullptr, 16)];
        continue;
      }
      std::string source;
      if (place == nullptr || addr2line.ReadLine(&source, until) != Transfer::kDone) break;
      const std::string function = BareName(line);
      const std::string file = Stem(source.substr(0, source.find(':')));
      if (place->function.empty()) place->function.append(file).append(" ").append(function);
      if (place->phase != kOther) continue;
      for (const PhaseOf& one : kPhaseOf) {
        const bool is_its_file = file == one.file || file.starts_with("??");
        if (is_its_file && function == one.function) place->phase = one.phase;
      }
    }
    if (const int status = addr2line.WaitOrKill(1); status != 0) {
      throw std::runtime_error("addr2line (Debian: binutils) " + DescribeEnd(status));
    }
  }

  std::map<std::uintptr_t, Place> known_;
};

struct Options {
  std::vector<int> sizes = {1, 2, 3, 4, 6, 8, 10, 16, 20, 40, 64, 100, 300, 1000};
  std::vector<std::string> scenes = {"all"};
  std::uint64_t first_seed = 900'001;
  int most_problems = 2000;
  std::string from = "arrays";
  double tier = 1e-6;
  double seconds = 1;
  bool functions = false;
};

// One size: problems, and what works on them.
class Stream {
 public:
  Stream(const Options& options, int rows) : options_(options), rows_(rows), step_({.tolerance = options.tier}) {
    solve_.tolerance = options.tier;
    // Families make about as many rows as they are asked for, so seeds are drawn until there are enough that have them.
    constexpr int kRounds = 40;
    constexpr std::uint64_t kSeedsOfRound = 4;
    const auto most_entries = static_cast<std::size_t>(std::max(100, 2'000'000 / (rows * rows + 1)));
    const std::size_t most = std::min<std::size_t>(static_cast<std::size_t>(options.most_problems), most_entries);
    for (int round = 0; round < kRounds && arrays_.size() < most; ++round) {
      FreshSources from;
      from.scenes = options.scenes;
      from.sizes = {rows};
      for (std::uint64_t k = 0; k < kSeedsOfRound; ++k) {
        from.seeds.push_back(options.first_seed + kSeedsOfRound * static_cast<std::uint64_t>(round) + k);
      }
      CampaignPlan plan;
      plan.seed = 1 + static_cast<std::uint64_t>(round);
      FreshProblems problems(from, plan);
      for (const FreshProblems::Problem& one : problems.Make(0, problems.planned().size())) {
        if (arrays_.size() < most && IsOfSize(one.problem.size())) Add(one.problem);
      }
    }
    copies_.resize(arrays_.size());
    for (std::size_t k = 0; k < arrays_.size(); ++k) copies_[k].Take(arrays_[k]);
  }

  std::size_t count() const { return arrays_.size(); }
  int left() const { return left_; }
  double mean_rows() const {
    double sum = 0;
    for (const ProblemArrays& one : arrays_) sum += static_cast<double>(one.rows);
    return sum / static_cast<double>(count());
  }
  // Pivots, active sets, and iterations of what solves larger islands.
  double mean_iterations() const { return static_cast<double>(iterations_) / static_cast<double>(count()); }

  // Every problem once.
  void Pass() {
    if (options_.from == "arrays") {
      for (const ProblemArrays& one : arrays_) auto_.SolveArrays(one, solve_, &result_);
    } else {
      for (const TwoBodyCopy& one : copies_) step_.Solve(one.rows(), nullptr, f_.data(), w_.data());
    }
  }
  // Reads what Pass is given once, and writes as many numbers as f and w have.
  void Touch() {
    if (options_.from == "arrays") {
      for (const ProblemArrays& one : arrays_) {
        double sum = Sum(one.value.data(), one.value.size()) + Sum(one.b.data(), one.b.size());
        sum += Sum(one.inverse_mass.data(), one.inverse_mass.size());
        sum += static_cast<double>(Sum(one.column.data(), one.column.size()) +
                                   Sum(one.row_start.data(), one.row_start.size()));
        Write(one.rows, sum);
      }
      return;
    }
    for (const TwoBodyCopy& one : copies_) {
      const StepRows& rows = one.rows();
      const auto p = static_cast<std::size_t>(rows.columns_per_body);
      const auto n = static_cast<std::size_t>(rows.rows);
      double sum = Sum(rows.J, 2 * p * n) + Sum(rows.b, n);
      sum += Sum(rows.inverse_mass, p * static_cast<std::size_t>(rows.bodies));
      sum += static_cast<double>(Sum(rows.body, 2 * n));
      Write(rows.rows, sum);
    }
  }

 private:
  bool IsOfSize(Index rows) const {
    // Families round to whole bodies: large sizes are met within a part.
    constexpr Index kParts = 16;
    return std::abs(rows - rows_) <= rows_ / kParts;
  }

  void Add(const LcpProblem& problem) {
    ProblemArrays arrays = ProblemArrays::Of(problem);
    if (arrays.form != MatrixForm::kFactors) return;
    auto_.SolveArrays(arrays, solve_, &result_);
    if (result_.detail != "rows") {
      ++left_;
      return;
    }
    if (f_.size() < problem.size()) {
      f_.setZero(problem.size());
      w_.setZero(problem.size());
    }
    if (options_.from == "rows") {
      TwoBodyCopy copy;
      copy.Take(arrays);
      result_.status = step_.Solve(copy.rows(), nullptr, f_.data(), w_.data()).status;
      result_.f = f_.head(problem.size());
    }
    if (!Verify(problem, result_, options_.tier).passes) throw std::runtime_error("a wrong answer to " + arrays.id);
    iterations_ += result_.iterations;
    arrays_.push_back(std::move(arrays));
  }

  template <typename Number>
  static Number Sum(const Number* from, std::size_t count) {
    constexpr std::size_t kLanes = 16;
    Number sums[kLanes] = {};
    std::size_t k = 0;
    for (; k + kLanes <= count; k += kLanes) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) sums[lane] += from[k + lane];
    }
    Number sum = 0;
    for (; k < count; ++k) sum += from[k];
    for (const Number one : sums) sum += one;
    return sum;
  }
  void Write(Index rows, double value) {
    f_.head(rows).setConstant(value);
    w_.head(rows).setConstant(value);
    // The compiler must not see that nobody reads them.
    asm volatile("" : : "r"(f_.data()), "r"(w_.data()) : "memory");
  }

  const Options& options_;
  Index rows_;
  LcpOptions solve_;
  AutoSolver auto_;
  StepSolver step_;
  LcpResult result_;
  std::vector<ProblemArrays> arrays_;
  std::vector<TwoBodyCopy> copies_;
  Eigen::VectorXd f_, w_;
  int left_ = 0;
  std::int64_t iterations_ = 0;
};

// Processor time of this thread [s]: what other programs do meanwhile does not count.
double ThreadTime() {
  timespec now = {};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// Nanoseconds a problem: the median over passes that take so long in all.
template <typename Pass>
double NanosecondsOf(std::size_t problems, double seconds, const Pass& pass) {
  pass();
  std::vector<double> times;
  constexpr std::size_t kLeastPasses = 5;
  const double until = ThreadTime() + seconds;
  while (ThreadTime() < until || times.size() < kLeastPasses) {
    const double start = ThreadTime();
    pass();
    times.push_back(ThreadTime() - start);
  }
  const auto middle = times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2);
  std::nth_element(times.begin(), middle, times.end());
  return *middle * 1e9 / static_cast<double>(problems);
}

void WriteRow(const Options& options, int size, Sampler* sampler, Phases* phases) {
  Stream stream(options, size);
  if (stream.count() == 0) {
    std::cerr << "phase_benchmark: no scene has " << size << " rows\n";
    return;
  }
  if (stream.left() > 0) {
    std::cerr << "phase_benchmark: " << stream.left() << " problems of " << size << " rows are not RowSolver's\n";
  }
  const double floor = NanosecondsOf(stream.count(), options.seconds / 4, [&] { stream.Touch(); });
  const double total = NanosecondsOf(stream.count(), options.seconds, [&] { stream.Pass(); });
  // A prime number of microseconds: the period must not be one of the passes.
  constexpr std::int64_t kPeriod = 97'000;  // ns
  const double until = ThreadTime() + options.seconds;
  sampler->Start(kPeriod);
  while (ThreadTime() < until) stream.Pass();
  const std::vector<std::uintptr_t> samples = sampler->Stop();
  phases->Learn(samples);
  std::array<double, kPhases> share = {};
  std::map<std::string, int> functions;
  for (const std::uintptr_t one : samples) {
    share[phases->Of(one)] += 1 / static_cast<double>(samples.size());
    if (options.functions) {
      const Phase phase = phases->Of(one);
      ++functions[std::string(kPhaseNames[phase]).append(": ").append(phases->FunctionOf(one))];
    }
  }
  const auto number = [](double value) {
    char text[32];
    std::snprintf(text, sizeof text, value < 10 ? "%.2g" : "%.0f", value);
    return std::string(text);
  };
  std::cout << "| " << number(stream.mean_rows()) << " | " << stream.count() << " | " << number(floor) << " | "
            << number(floor / stream.mean_rows()) << " | **" << number(total) << "** | "
            << number(stream.mean_iterations()) << " |";
  for (const double one : share) std::cout << ' ' << (one > 0 ? number(one * total) : "0") << " |";
  std::cout << ' ' << samples.size() << " |" << std::endl;
  for (const auto& [name, count] : functions) std::cerr << size << " rows, " << name << ' ' << count << '\n';
}

int Main(int argc, char** argv) {
  Options options;
  CLI::App app{"Where the time of a fresh step goes, by phase and size", "phase_benchmark"};
  app.add_option("--sizes", options.sizes, "Rows; larger ones within a 16th")
      ->delimiter(',')
      ->check(AtLeast(1))
      ->capture_default_str();
  app.add_option("--scenes", options.scenes, "Scene families as they are placed, or all")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--first-seed", options.first_seed, "Of the scenes")->capture_default_str();
  app.add_option("--problems", options.most_problems, "Of a size at most; fewer of many rows")
      ->check(AtLeast(1))
      ->capture_default_str();
  app.add_option("--from", options.from, "arrays: compressed rows, by auto; rows: bodies and J, by StepSolver")
      ->check(CLI::IsMember({"arrays", "rows"}))
      ->capture_default_str();
  app.add_option("--tier", options.tier, "Tolerance, asked for and judged at")
      ->check(Tolerance())
      ->capture_default_str();
  app.add_option("--seconds", options.seconds, "Of a size's timing, and of its sampling")
      ->check(PositiveSeconds())
      ->capture_default_str();
  app.add_flag("--functions", options.functions, "Samples by function, on standard error");
  if (const auto status = ParseCommandLine(app, argc, argv)) return *status;
  options.scenes = FamiliesOf(options.scenes);  // of a user's mistake there is one line only

  Sampler sampler;
  Phases phases;
  std::cout << "| rows | problems | floor | floor a row | total | iterations |";
  for (const char* name : kPhaseNames) std::cout << ' ' << name << " |";
  std::cout << " samples |\n|";
  for (std::size_t k = 0; k < 7 + kPhases; ++k) std::cout << "---:|";
  std::cout << std::endl;
  for (const int size : options.sizes) WriteRow(options, size, &sampler, &phases);
  return 0;
}

}  // namespace
}  // namespace lcpbench

int main(int argc, char** argv) {
  return lcpbench::RunProgram("phase_benchmark", [&] { return lcpbench::Main(argc, argv); });
}
