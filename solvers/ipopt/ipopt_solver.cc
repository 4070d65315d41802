#include "solvers/ipopt/ipopt_solver.h"

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpOrigIpoptNLP.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>
#include <IpTNLPAdapter.hpp>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/answers/answer_judge.h"
#include "solvers/ipopt/quadratic_program.h"
#include "solvers/lcp/factor_clock.h"
#include "solvers/lcp/residual.h"
#include "solvers/linear_algebra/loaded_blas.h"

namespace lcpbench {
namespace {

using ipopt::Entry;
using Ipopt::Number;
using ipopt::QuadraticProgram;
using IpoptIndex = Ipopt::Index;

// Ipopt iterations per formulation where LcpOptions names no limit. Ordinary problems take 5 to 40; the rest of the
// allowance is for redundant joints.
constexpr std::int64_t kDefaultIterations = 200;
constexpr long double kInfinity = std::numeric_limits<long double>::infinity();
// An interior point has no zeros, but the answer does: scaled forces up to this share of the tolerance are tried as 0
// where f passes in rho and not yet in the backward error. That moves rho by no more than about the share.
constexpr double kClipShare = 0.1;

// A warm start is moved off the bounds to this share of the largest scaled force (gap). Smaller starts stick to the
// bounds they should leave, larger ones lose what is known.
constexpr double kWarmPush = 1e-3;

// A diverging iterate is tried as a Farkas ray where |A y| is below this share of |y|: verification decides, this only
// spares it on the iterates of an ordinary solve.
constexpr double kRayGate = 1e-6;
// Entries of a ray below this share of its largest are what the bounded part of the iterate left; tried as 0 too.
constexpr double kRayClip = 1e-8;

// A at least this many times as dense as J makes the lifted form the faster one.
constexpr Index kLiftedFill = 25;

// Ipopt takes bounds from nlp_upper_bound_inf = 1e19 on as none.
constexpr double kNoBound = 2e19;

// Every option that differs from Ipopt's default, in the notation of its options files; docs/solvers/ipopt.md has the
// reasons.
//
// The test of the project stops Ipopt from its callback, after every iteration, and Ipopt's own tests are set out of
// reach: the tier T bounds a 2-norm of min(f, w), Ipopt max-norms of its optimality conditions, of which
// complementarity is a product, and no fixed map from T to `tol` serves both.
constexpr const char* kOptions = R"(
print_level 0
# No banner at the first solve of the process.
sb yes
# What Ipopt does not reach, so that our own test stops it.
tol 1e-40
compl_inf_tol 1e-40
# The floor of mu in adaptive mode; its default 1e-11 stops degenerate rows at 3e-6. compl_inf_tol is a floor of it too.
mu_min 1e-40
# Mehrotra mode starts 10 off the bounds. Here |b| = 1 and A has a unit diagonal: forces are of order 1 or less.
bound_push 0.1
bound_mult_init_val 0.1
# A relaxed bound f >= -1e-8 would let f and w of one row be negative together.
bound_relax_factor 0
constr_mult_init_max 0
# The warm start is moved off its bounds by us, in proportion to its size.
warm_start_bound_push 1e-16
warm_start_bound_frac 1e-16
warm_start_slack_bound_push 1e-16
warm_start_slack_bound_frac 1e-16
warm_start_mult_bound_push 1e-16
# "Acceptable" points are no answer here: only the tier test is.
acceptable_iter 0
# The only linear solver in Debian's build. No matching and no scaling inside it: the program is scaled.
linear_solver mumps
mumps_permuting_scaling 0
mumps_scaling 0
# A linear solve is refined only where its residual asks for it.
min_refinement_steps 0
# Predictor-corrector steps without line search, with mu_strategy = adaptive and mu_oracle = probing. Not in the
# restoration phase: there Ipopt 3.11.9 reads an affine step that nothing has computed, and crashes (null pointer in
# PDSearchDirCalculator).
mehrotra_algorithm yes
resto.mehrotra_algorithm no
# The program is Jacobi-scaled already; a second scaling would change what the numbers above mean.
nlp_scaling_method none
# H and G are constant, so each is evaluated once.
hessian_constant yes
jac_c_constant yes
jac_d_constant yes
# Least-squares problems for x and y: where y is empty or starts at 0 they buy nothing.
least_square_init_primal no
least_square_init_duals no
# Redundant joints make the constraints of the contact form dependent. Regularising them always, not only after MUMPS
# has noticed, is what lets those problems converge.
perturb_always_cd yes
)";

// MUMPS keeps state in modules of the whole process, and Ipopt counts its instances in a plain int: every call into
// them, construction and destruction included, is made under this lock.
std::mutex& LibraryMutex() {
  static std::mutex mutex;
  return mutex;
}

// Ipopt's own name of a status that its options here allow.
std::string_view Name(Ipopt::ApplicationReturnStatus code) {
  constexpr std::pair<Ipopt::ApplicationReturnStatus, std::string_view> kNames[] = {
      {Ipopt::Solve_Succeeded, "Solve_Succeeded"},
      {Ipopt::Infeasible_Problem_Detected, "Infeasible_Problem_Detected"},
      {Ipopt::Search_Direction_Becomes_Too_Small, "Search_Direction_Becomes_Too_Small"},
      {Ipopt::Diverging_Iterates, "Diverging_Iterates"},
      {Ipopt::User_Requested_Stop, "User_Requested_Stop"},
      {Ipopt::Feasible_Point_Found, "Feasible_Point_Found"},
      {Ipopt::Maximum_Iterations_Exceeded, "Maximum_Iterations_Exceeded"},
      {Ipopt::Restoration_Failed, "Restoration_Failed"},
      {Ipopt::Error_In_Step_Computation, "Error_In_Step_Computation"},
      {Ipopt::Not_Enough_Degrees_Of_Freedom, "Not_Enough_Degrees_Of_Freedom"},
      {Ipopt::Invalid_Number_Detected, "Invalid_Number_Detected"},
      {Ipopt::Unrecoverable_Exception, "Unrecoverable_Exception"},
      {Ipopt::NonIpopt_Exception_Thrown, "NonIpopt_Exception_Thrown"},
      {Ipopt::Insufficient_Memory, "Insufficient_Memory"},
      {Ipopt::Internal_Error, "Internal_Error"},
  };
  for (const auto& [known, name] : kNames) {
    if (known == code) return name;
  }
  return "unknown status";
}

// A starting point. Multipliers have Ipopt's signs: H x + c + G^T y - z = 0.
struct Start {
  Eigen::VectorXd x;
  Eigen::VectorXd z;  // of the bounds x >= 0, one per variable
  Eigen::VectorXd y;  // of the constraints

  explicit Start(const QuadraticProgram& program)
      : x(Eigen::VectorXd::Zero(program.c.size())), z(x), y(Eigen::VectorXd::Zero(program.d.size())) {}
};

// Called with every iterate, which is empty in the restoration phase, where it belongs to another program. True stops
// Ipopt. Must not use Ipopt.
using OnIterate = std::function<bool(const Eigen::VectorXd&)>;

// Ipopt's view of a QuadraticProgram.
class ProgramNlp final : public Ipopt::TNLP {
 public:
  explicit ProgramNlp(const QuadraticProgram& given) : program(&given) {}

  const QuadraticProgram* const program;
  const Start* start = nullptr;
  const OnIterate* on_iterate = nullptr;

  bool get_nlp_info(IpoptIndex& n, IpoptIndex& m, IpoptIndex& jacobian_entries, IpoptIndex& hessian_entries,
                    IndexStyleEnum& style) override {
    n = static_cast<IpoptIndex>(program->c.size());
    m = static_cast<IpoptIndex>(program->d.size());
    jacobian_entries = static_cast<IpoptIndex>(program->jacobian.size());
    hessian_entries = static_cast<IpoptIndex>(program->hessian.size());
    style = C_STYLE;
    return true;
  }

  bool get_bounds_info(IpoptIndex n, Number* lower, Number* upper, IpoptIndex m, Number* g_lower,
                       Number* g_upper) override {
    for (IpoptIndex j = 0; j < n; ++j) lower[j] = program->nonnegative[static_cast<size_t>(j)] ? 0.0 : -kNoBound;
    std::fill_n(upper, n, kNoBound);
    std::copy_n(program->d.data(), m, g_lower);
    std::copy_n(program->d.data(), m, g_upper);
    return true;
  }

  bool get_starting_point(IpoptIndex n, bool init_x, Number* x, bool init_z, Number* z_lower, Number* z_upper,
                          IpoptIndex m, bool init_y, Number* y) override {
    if (init_x) std::copy_n(start->x.data(), n, x);
    if (init_z) {
      std::copy_n(start->z.data(), n, z_lower);
      std::fill_n(z_upper, n, 0.0);
    }
    if (init_y) std::copy_n(start->y.data(), m, y);
    return true;
  }

  bool eval_f(IpoptIndex /*n*/, const Number* x, bool /*new_x*/, Number& value) override {
    value = program->Objective(x);
    return true;
  }
  bool eval_grad_f(IpoptIndex /*n*/, const Number* x, bool /*new_x*/, Number* gradient) override {
    program->Gradient(x, gradient);
    return true;
  }
  bool eval_g(IpoptIndex /*n*/, const Number* x, bool /*new_x*/, IpoptIndex /*m*/, Number* g) override {
    program->Constraints(x, g);
    return true;
  }
  bool eval_jac_g(IpoptIndex /*n*/, const Number* /*x*/, bool /*new_x*/, IpoptIndex /*m*/, IpoptIndex /*count*/,
                  IpoptIndex* row, IpoptIndex* column, Number* values) override {
    Copy(program->jacobian, 1.0, row, column, values);
    return true;
  }
  bool eval_h(IpoptIndex /*n*/, const Number* /*x*/, bool /*new_x*/, Number objective_factor, IpoptIndex /*m*/,
              const Number* /*lambda*/, bool /*new_lambda*/, IpoptIndex /*count*/, IpoptIndex* row, IpoptIndex* column,
              Number* values) override {
    Copy(program->hessian, objective_factor, row, column, values);
    return true;
  }

  // The answer is taken from the iterates, so that the one returned is the one tested.
  void finalize_solution(Ipopt::SolverReturn /*status*/, IpoptIndex /*n*/, const Number* /*x*/,
                         const Number* /*z_lower*/, const Number* /*z_upper*/, IpoptIndex /*m*/, const Number* /*g*/,
                         const Number* /*lambda*/, Number /*objective*/, const Ipopt::IpoptData* /*data*/,
                         Ipopt::IpoptCalculatedQuantities* /*quantities*/) override {}

  bool intermediate_callback(Ipopt::AlgorithmMode mode, IpoptIndex /*iteration*/, Number /*objective*/,
                             Number /*primal_infeasibility*/, Number /*dual_infeasibility*/, Number /*mu*/,
                             Number /*step*/, Number /*regularization*/, Number /*dual_alpha*/, Number /*primal_alpha*/,
                             IpoptIndex /*trials*/, const Ipopt::IpoptData* data,
                             Ipopt::IpoptCalculatedQuantities* quantities) override {
    // In restoration the iterate belongs to another program; there it counts as "no iterate" (empty).
    x_.resize(0);
    if (mode == Ipopt::RegularMode && data != nullptr && quantities != nullptr) {
      auto* nlp = dynamic_cast<Ipopt::OrigIpoptNLP*>(Ipopt::GetRawPtr(quantities->GetIpoptNLP()));
      auto* adapter = nlp == nullptr ? nullptr : dynamic_cast<Ipopt::TNLPAdapter*>(Ipopt::GetRawPtr(nlp->nlp()));
      if (adapter != nullptr) {
        x_.resize(program->c.size());
        adapter->ResortX(*data->curr()->x(), x_.data());
      }
    }
    return !(*on_iterate)(x_);
  }

 private:
  static void Copy(const std::vector<Entry>& from, double factor, IpoptIndex* row, IpoptIndex* column, Number* values) {
    for (size_t k = 0; k < from.size(); ++k) {
      if (values != nullptr) {
        values[k] = factor * from[k].value();
      } else {
        row[k] = from[k].row();
        column[k] = from[k].col();
      }
    }
  }

  Eigen::VectorXd x_;
};

// Ipopt made ready for one program: silent, without an options file. The objects of its algorithm are built once, by a
// run of no iterations, and serve every Optimize after it; nothing else carries over.
class Application {
 public:
  struct Ending {
    Ipopt::ApplicationReturnStatus code;
    std::int64_t iterations = 0;
  };

  // `program` is not owned. Throws std::runtime_error where Ipopt does not know one of the options.
  explicit Application(const QuadraticProgram& program) : nlp_(new ProgramNlp(program)) {
    ++WorkCounts::OfThread().analyses;
    {
      const std::lock_guard lock(LibraryMutex());
      RequireBlasMemory();
      application_ = new Ipopt::IpoptApplication(/*create_console_out=*/false);
      std::istringstream options(kOptions);
      if (application_->Initialize(options) != Ipopt::Solve_Succeeded) {
        throw std::runtime_error("Ipopt refused an option");
      }
    }
    const auto go_on = [](const Eigen::VectorXd&) { return false; };
    built_ = Optimize(Start(program), false, 0, go_on).code == Ipopt::Maximum_Iterations_Exceeded;
  }
  ~Application() {
    const std::lock_guard lock(LibraryMutex());
    application_ = nullptr;
  }
  Application(const Application&) = delete;
  Application& operator=(const Application&) = delete;

  // warm: `start` is used as it is; else Ipopt moves x off its bounds and sets all multipliers. Waits for its turn; the
  // wait counts as time of the solve.
  Ending Optimize(const Start& start, bool warm, std::int64_t max_iterations, const OnIterate& on_iterate) {
    const std::lock_guard lock(LibraryMutex());
    nlp_->start = &start;
    nlp_->on_iterate = &on_iterate;
    Ipopt::OptionsList& options = *application_->Options();
    constexpr std::int64_t kMost = std::numeric_limits<IpoptIndex>::max();
    options.SetIntegerValue("max_iter", static_cast<IpoptIndex>(std::min(max_iterations, kMost)));
    options.SetStringValue("warm_start_init_point", warm ? "yes" : "no");
    const Ipopt::SmartPtr<Ipopt::TNLP> program = Ipopt::GetRawPtr(nlp_);
    Ending ending{built_ ? application_->ReOptimizeTNLP(program) : application_->OptimizeTNLP(program)};
    // Ipopt 3.11.9 times the symbolic analysis and the solves of MUMPS only.
    FactorClock::CannotTell();
    ++WorkCounts::OfThread().factorizations;  // or more: it does not say
    const Ipopt::SmartPtr<Ipopt::SolveStatistics> statistics = application_->Statistics();
    if (Ipopt::IsValid(statistics)) ending.iterations = statistics->IterationCount();
    return ending;
  }

 private:
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application_;
  Ipopt::SmartPtr<ProgramNlp> nlp_;
  bool built_ = false;  // the algorithm's objects exist: ReOptimizeTNLP works
};

double Largest(const Eigen::VectorXd& x) { return x.size() == 0 ? 0 : x.cwiseAbs().maxCoeff<Eigen::PropagateNaN>(); }

// The Jacobi-scaled LCP with |b| = 1 that the programs are written in; tolerances and starting values have no units
// there. A = D^-1/2 A D^-1/2, b = D^-1/2 b / |D^-1/2 b|; D_ii = |A_ii|, and 1 where A_ii = 0.
struct ScaledLcp {
  LcpProblem problem;
  Eigen::VectorXd inverse_root;  // D^-1/2
  Eigen::VectorXd b;
  Eigen::VectorXd force_unit;  // f of the problem = force_unit * f of the scaled one, row by row
  Eigen::VectorXd gap_unit;    // w likewise

  // b is still to be given.
  explicit ScaledLcp(const LcpProblem& given) : problem(given) {
    inverse_root = problem.DiagonalA().unaryExpr([](double d) { return d == 0 ? 1.0 : 1.0 / std::sqrt(std::abs(d)); });
  }

  // b and the units, of a problem that shares the matrix.
  void SetB(const LcpProblem& given) {
    problem = given;
    b = problem.b().cwiseProduct(inverse_root);
    long double squares = 0;  // its exponent range holds the square of every double
    for (const double value : b) squares += static_cast<long double>(value) * value;
    const double norm = squares == 0 ? 1.0 : static_cast<double>(std::sqrt(squares));
    b /= norm;
    force_unit = inverse_root * norm;
    gap_unit = inverse_root.cwiseInverse() * norm;
  }

  Index size() const { return inverse_root.size(); }

  // S = D^-1/2 J M^-1/2 without the columns that are empty or of zero inverse mass; S S^T is the scaled A.
  SparseMatrix Factor() const {
    const SparseMatrix& J = problem.J();
    const Eigen::VectorXd& inverse_mass = problem.inverse_mass();
    std::vector<int> place(static_cast<size_t>(J.cols()), -1);
    std::vector<Eigen::Triplet<double, int>> entries;
    int columns = 0;
    for (Index i = 0; i < J.rows(); ++i) {
      for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
        const double value = it.value() * std::sqrt(inverse_mass[it.col()]) * inverse_root[i];
        if (value == 0) continue;
        int& column = place[static_cast<size_t>(it.col())];
        if (column < 0) column = columns++;
        entries.emplace_back(static_cast<int>(i), column, value);
      }
    }
    SparseMatrix S(J.rows(), columns);
    S.setFromTriplets(entries.begin(), entries.end());
    return S;
  }
};

// One way to write the LCP as a program. Variables are the scaled f, the velocities v = S^T f of the lifted form, and
// the gaps w of kNcp on unilateral rows; c begins with b.
struct Formulation {
  std::string_view name;
  QuadraticProgram program;
  bool is_ncp = false;                       // then the first n constraints are w = A f + b, and d begins with -b
  SparseMatrix S;                            // lifted
  std::vector<Index> gap_rows;               // of the variables w
  std::unique_ptr<Application> application;  // made when first needed

  Application& Ready() {
    if (application == nullptr) application = std::make_unique<Application>(program);
    return *application;
  }

  // A start with the given scaled f and w (both already off their bounds), primal and dual. The stationarity of f asks
  // for z_f = w, that of w for z_w = f and multipliers -f of the constraints w = ...; those of S^T f - v = 0 are v.
  Start StartAt(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
    const Eigen::VectorXd v = S.cols() > 0 ? Eigen::VectorXd(S.transpose() * f) : Eigen::VectorXd();
    const Index n = f.size();
    const Index gaps = n + v.size();
    Start start(program);
    start.x.head(n) = f;
    start.x.segment(n, v.size()) = v;
    start.z.head(n) = w;
    for (size_t k = 0; k < gap_rows.size(); ++k) {
      start.x[gaps + static_cast<Index>(k)] = w[gap_rows[k]];
      start.z[gaps + static_cast<Index>(k)] = f[gap_rows[k]];
    }
    if (is_ncp) start.y.head(n) = -f;
    start.y.tail(v.size()) = v;
    return start;
  }
};

void Add(Index i, Index j, double x, std::vector<Entry>* entries) {
  entries->emplace_back(static_cast<int>(i), static_cast<int>(j), x);
}

// Adds w of the unilateral rows as variables with the entries -w in constraints 0..n-1, and sizes c and d.
Formulation Finished(const ScaledLcp& scaled, Index constraints, Formulation form) {
  QuadraticProgram& program = form.program;
  for (Index i = 0; i < scaled.size() && form.is_ncp; ++i) {
    if (scaled.problem.is_bilateral(i)) continue;
    Add(i, static_cast<Index>(program.nonnegative.size()), -1.0, &program.jacobian);
    program.nonnegative.push_back(true);
    form.gap_rows.push_back(i);
  }
  program.c.setZero(static_cast<Index>(program.nonnegative.size()));
  program.d.setZero(constraints + (form.is_ncp ? scaled.size() : 0));
  return form;
}

// kQp: Hessian A. kNcp: Hessian A + A^T; constraints A f - w = -b.
Formulation ContactForm(const ScaledLcp& scaled, bool is_ncp) {
  const LcpProblem& problem = scaled.problem;
  const SparseMatrix& A = problem.SparseA();
  SparseMatrix twice;
  if (is_ncp) twice = A + SparseMatrix(A.transpose());
  Formulation form;
  form.name = "contact";
  form.is_ncp = is_ncp;
  for (Index i = 0; i < scaled.size(); ++i) {
    const auto scale = [&](Index j) { return scaled.inverse_root[i] * scaled.inverse_root[j]; };
    form.program.nonnegative.push_back(!problem.is_bilateral(i));
    for (SparseMatrix::InnerIterator it(A, i); it && is_ncp; ++it) {
      Add(i, it.col(), it.value() * scale(it.col()), &form.program.jacobian);
    }
    for (SparseMatrix::InnerIterator it(is_ncp ? twice : A, i); it && it.col() <= i; ++it) {
      Add(i, it.col(), it.value() * scale(it.col()), &form.program.hessian);
    }
  }
  return Finished(scaled, 0, std::move(form));
}

// kQp: 1/2 v.v + b.f. kNcp: v.v + b.f; constraints S v - w = -b. Both: constraints S^T f - v = 0.
Formulation LiftedForm(const ScaledLcp& scaled, bool is_ncp) {
  const Index n = scaled.size();
  const Index first = is_ncp ? n : 0;
  Formulation form;
  form.name = "lifted";
  form.is_ncp = is_ncp;
  form.S = scaled.Factor();
  QuadraticProgram& program = form.program;
  for (Index i = 0; i < n; ++i) {
    program.nonnegative.push_back(!scaled.problem.is_bilateral(i));
    for (SparseMatrix::InnerIterator it(form.S, i); it; ++it) {
      if (is_ncp) Add(i, n + it.col(), it.value(), &program.jacobian);
      Add(first + it.col(), i, it.value(), &program.jacobian);
    }
  }
  for (Index k = 0; k < form.S.cols(); ++k) {
    program.nonnegative.push_back(false);
    Add(first + k, n + k, -1.0, &program.jacobian);
    Add(n + k, n + k, is_ncp ? 2.0 : 1.0, &program.hessian);
  }
  const Index velocities = form.S.cols();
  return Finished(scaled, velocities, std::move(form));
}

}  // namespace

class IpoptEngine {
 public:
  explicit IpoptEngine(const IpoptOptions& options) : options_(options) {}

  std::string WhyUnsupported(const LcpProblem& problem) const {
    if (options_.form == IpoptOptions::Form::kLifted && !problem.has_factors()) {
      return "the lifted form needs a problem given by factors";
    }
    return options_.program == IpoptOptions::Program::kQp ? WhyNotSymmetric(problem) : "";
  }
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);

 private:
  void TakeB(const Eigen::VectorXd& b);
  bool Accept(const Eigen::VectorXd& x, double tolerance, LcpResult* result);
  bool AcceptRay(const Eigen::VectorXd& direction, LcpResult* result);
  Start FirstPoint(const Formulation& formulation, const LcpOptions& options);
  bool Run(Formulation* formulation, const LcpOptions& options, const Deadline& deadline, LcpResult* result);

  IpoptOptions options_;
  // Kept for one matrix:
  std::optional<ScaledLcp> scaled_;
  std::vector<Formulation> formulations_;
  GivenFormTest given_;
  // For the test after each iteration:
  Eigen::VectorXd f_;
  Eigen::VectorXd last_x_;
  Eigen::VectorXd ray_;
  Eigen::VectorXd product_;
  long double best_rho_ = kInfinity;
};

void IpoptEngine::TakeB(const Eigen::VectorXd& b) {
  for (Formulation& form : formulations_) {
    form.program.c.head(b.size()) = b;
    if (form.is_ncp) form.program.d.head(b.size()) = -b;
  }
}

// Whether f of x (scaled; its first n entries), clipped, meets the tier. Keeps the best one in the result.
bool IpoptEngine::Accept(const Eigen::VectorXd& x, double tolerance, LcpResult* result) {
  const LcpProblem& problem = scaled_->problem;
  const Index n = problem.size();
  f_ = x.head(n);
  for (Index i = 0; i < n; ++i) {
    if (!problem.is_bilateral(i)) f_[i] = std::max(f_[i], 0.0);
    f_[i] *= scaled_->force_unit[i];
  }
  const long double rho = given_.Rho(f_);
  if (rho < best_rho_) {
    best_rho_ = rho;
    result->f = f_;
  }
  if (!(rho <= tolerance)) return false;
  if (!given_.Meets(tolerance, f_)) {
    for (Index i = 0; i < n; ++i) {
      if (!problem.is_bilateral(i) && x[i] <= kClipShare * tolerance) f_[i] = 0;
    }
    if (!given_.Meets(tolerance, f_)) return false;
  }
  result->f = f_;
  result->status = LcpStatus::kSolved;
  return true;
}

// Whether the direction, clipped, proves the LCP infeasible.
bool IpoptEngine::AcceptRay(const Eigen::VectorXd& direction, LcpResult* result) {
  const LcpProblem& problem = scaled_->problem;
  const Index n = problem.size();
  for (const bool clip : {false, true}) {
    ray_ = direction.head(n);
    const double largest = Largest(ray_);
    if (!(largest > 0 && std::isfinite(largest))) return false;
    double slope = 0;
    for (Index i = 0; i < n; ++i) {
      if (!problem.is_bilateral(i)) ray_[i] = std::max(ray_[i], 0.0);
      if (clip && std::abs(ray_[i]) < kRayClip * largest) ray_[i] = 0;
      ray_[i] /= largest;
      slope += scaled_->b[i] * ray_[i];
      ray_[i] *= scaled_->force_unit[i];
    }
    if (!(slope < 0)) continue;
    problem.ComputeW(ray_, &product_);
    product_ = (product_ - problem.b()).cwiseQuotient(scaled_->gap_unit);
    if (!(Largest(product_) <= kRayGate)) continue;
    result->farkas_ray = AcceptedRay(problem, ray_);
    if (!result->farkas_ray.has_value()) continue;
    result->status = LcpStatus::kInfeasible;
    return true;
  }
  return false;
}

Start IpoptEngine::FirstPoint(const Formulation& formulation, const LcpOptions& options) {
  const LcpProblem& problem = scaled_->problem;
  const Index n = problem.size();
  // Ipopt moves x to its own distance from the bounds (bound_push) and sets all multipliers.
  if (options.initial_f == nullptr) return Start(formulation.program);
  Eigen::VectorXd force = options.initial_f->cwiseQuotient(scaled_->force_unit);
  problem.ComputeW(*options.initial_f, &product_);
  Eigen::VectorXd gap = product_.cwiseQuotient(scaled_->gap_unit);
  const double force_push = kWarmPush * std::max(Largest(force), Largest(scaled_->b));
  const double gap_push = kWarmPush * Largest(scaled_->b);
  for (Index i = 0; i < n; ++i) {
    if (problem.is_bilateral(i)) continue;
    force[i] = std::max(force[i], force_push);
    gap[i] = std::max(gap[i], gap_push);
  }
  return formulation.StartAt(force, gap);
}

// True when the solve is over: the next formulation need not be tried.
bool IpoptEngine::Run(Formulation* formulation, const LcpOptions& options, const Deadline& deadline,
                      LcpResult* result) {
  const Start start = FirstPoint(*formulation, options);
  const bool symmetric = scaled_->problem.IsNumericallySymmetric();
  bool over = false;
  bool late = false;
  last_x_.setZero(start.x.size());
  const auto on_iterate = [&](const Eigen::VectorXd& x) {
    if (x.size() > 0) {
      over = Accept(x, options.tolerance, result);
      if (!over && symmetric) {
        over = AcceptRay(x, result);
        last_x_ = x - last_x_;
        over = over || AcceptRay(last_x_, result);
        last_x_ = x;
      }
    }
    if (!over) late = deadline.Expired();
    return over || late;
  };

  const std::int64_t limit =
      options.max_iterations > 0 ? options.max_iterations - result->iterations : kDefaultIterations;
  const Application::Ending ending =
      formulation->Ready().Optimize(start, options.initial_f != nullptr, limit, on_iterate);
  result->iterations += ending.iterations;

  if (!result->detail.empty()) result->detail += "; ";
  result->detail += "Ipopt (" + std::string(formulation->name) + " form): " + std::string(Name(ending.code));
  if (over) return true;
  if (late) {
    result->status = LcpStatus::kTimeLimit;
    return true;
  }
  const bool at_limit = ending.code == Ipopt::Maximum_Iterations_Exceeded;
  result->status = at_limit ? LcpStatus::kIterationLimit : LcpStatus::kNumericalFailure;
  return at_limit && options.max_iterations > 0;
}

void IpoptOptions::Read(SettingsReader* reader) {
  const std::string chosen = reader->Choice("form", "auto", {"auto", "contact", "lifted"});
  if (chosen == "contact") form = Form::kContact;
  if (chosen == "lifted") form = Form::kLifted;
}

void IpoptEngine::Prepare(const LcpProblem& problem) {
  using Form = IpoptOptions::Form;
  const ScaledLcp& scaled = scaled_.emplace(problem);
  const bool is_ncp = options_.program == IpoptOptions::Program::kNcp;
  given_.Reset(problem);
  formulations_.clear();
  // Then the lifted form is the sparser one, and A may not fit in memory.
  const bool dense = problem.has_factors() && BoundEntriesOfA(problem) > kLiftedFill * problem.J().nonZeros();
  if (options_.form == Form::kContact || (options_.form == Form::kAuto && !dense)) {
    formulations_.push_back(ContactForm(scaled, is_ncp));
  }
  if (options_.form == Form::kLifted || (options_.form == Form::kAuto && problem.has_factors())) {
    formulations_.push_back(LiftedForm(scaled, is_ncp));
  }
  // What Ipopt builds for the first program does not depend on b.
  TakeB(Eigen::VectorXd::Ones(scaled.size()));
  formulations_.front().Ready();
}

void IpoptEngine::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  scaled_->SetB(problem);
  given_.SetB(problem);
  TakeB(scaled_->b);
  best_rho_ = kInfinity;
  // The start may be the answer already: an interior point method would walk away from it.
  Eigen::VectorXd first = Eigen::VectorXd::Zero(scaled_->size());
  if (options.initial_f != nullptr) first = options.initial_f->cwiseQuotient(scaled_->force_unit);
  if (Accept(first, options.tolerance, result)) return;
  for (Formulation& formulation : formulations_) {
    if (Run(&formulation, options, deadline, result)) return;
  }
}

template class EngineSolver<IpoptOptions, IpoptEngine>;

}  // namespace lcpbench
