// The only file that sees Ipopt.
#include "solvers/ipopt/ipopt_engine.h"

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpOrigIpoptNLP.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>
#include <IpTNLPAdapter.hpp>
#include <algorithm>
#include <limits>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

#include "solvers/lcp/factor_clock.h"
#include "solvers/lcp/work_counts.h"

namespace lcpbench::ipopt {
namespace {

using Ipopt::Number;
using IpoptIndex = Ipopt::Index;

// Ipopt takes bounds from nlp_upper_bound_inf = 1e19 on as none.
constexpr double kNoBound = 2e19;

// MUMPS keeps state in modules of the whole process, and Ipopt counts its instances in a plain int: every call into
// them, construction and destruction included, is made under this lock.
std::mutex& LibraryMutex() {
  static std::mutex mutex;
  return mutex;
}

// Every option that differs from Ipopt's default; docs/solvers/ipopt.md has the measurements.
//
// The test of the project stops Ipopt from its callback, after every iteration, and Ipopt's own tests are set out of
// reach: the tier T bounds a 2-norm of min(f, w), Ipopt max-norms of its optimality conditions, of which
// complementarity is a product, and no fixed map from T to `tol` serves both.
void SetOptions(Ipopt::OptionsList* options) {
  constexpr std::pair<const char*, double> kNumbers[] = {
      // The floor of mu in adaptive mode; its default 1e-11 stops degenerate rows at 3e-6. compl_inf_tol, which
      // Optimize sets, is a floor of it too.
      {"mu_min", 1e-40},
      // Mehrotra mode starts 10 off the bounds. Here |b| = 1 and A has a unit diagonal: forces are of order 1 or less.
      {"bound_push", 0.1},
      {"bound_mult_init_val", 0.1},
      // A relaxed bound f >= -1e-8 would let f and w of one row be negative together.
      {"bound_relax_factor", 0.0},
      {"constr_mult_init_max", 0.0},
      // The warm start is moved off its bounds by us, in proportion to its size.
      {"warm_start_bound_push", 1e-16},
      {"warm_start_bound_frac", 1e-16},
      {"warm_start_slack_bound_push", 1e-16},
      {"warm_start_slack_bound_frac", 1e-16},
      {"warm_start_mult_bound_push", 1e-16},
  };
  constexpr std::pair<const char*, int> kIntegers[] = {
      {"print_level", 0},
      // "Acceptable" points are no answer here: only the tier test is.
      {"acceptable_iter", 0},
      // No matching and no scaling inside MUMPS: the program is scaled.
      {"mumps_permuting_scaling", 0},
      {"mumps_scaling", 0},
      // A linear solve is refined only where its residual asks for it.
      {"min_refinement_steps", 0},
  };
  constexpr std::pair<const char*, const char*> kTexts[] = {
      {"sb", "yes"},  // no banner at the first solve of the process
      // Predictor-corrector steps without line search, with mu_strategy = adaptive and mu_oracle = probing.
      {"mehrotra_algorithm", "yes"},
      // Not in the restoration phase: there Ipopt 3.11.9 reads an affine step that nothing has computed, and crashes
      // (null pointer in PDSearchDirCalculator).
      {"resto.mehrotra_algorithm", "no"},
      // The program is Jacobi-scaled already; a second scaling would change what the numbers above mean.
      {"nlp_scaling_method", "none"},
      // H and G are constant, so each is evaluated once.
      {"hessian_constant", "yes"},
      {"jac_c_constant", "yes"},
      {"jac_d_constant", "yes"},
      // The only linear solver in Debian's build.
      {"linear_solver", "mumps"},
      // Least-squares problems for x and y: where y is empty or starts at 0 they buy nothing.
      {"least_square_init_primal", "no"},
      {"least_square_init_duals", "no"},
      // Redundant joints make the constraints of the contact form dependent. Regularising them always, not only after
      // MUMPS has noticed, is what lets those problems converge.
      {"perturb_always_cd", "yes"},
  };
  const auto require = [](bool taken, const char* name) {
    if (!taken) throw std::runtime_error(std::string("Ipopt refused option ") + name);
  };
  for (const auto& [name, value] : kNumbers) require(options->SetNumericValue(name, value), name);
  for (const auto& [name, value] : kIntegers) require(options->SetIntegerValue(name, value), name);
  for (const auto& [name, value] : kTexts) require(options->SetStringValue(name, value), name);
}

// Ipopt's own name of a status.
std::string_view Name(Ipopt::ApplicationReturnStatus code) {
  constexpr std::pair<Ipopt::ApplicationReturnStatus, std::string_view> kNames[] = {
      {Ipopt::Solve_Succeeded, "Solve_Succeeded"},
      {Ipopt::Solved_To_Acceptable_Level, "Solved_To_Acceptable_Level"},
      {Ipopt::Infeasible_Problem_Detected, "Infeasible_Problem_Detected"},
      {Ipopt::Search_Direction_Becomes_Too_Small, "Search_Direction_Becomes_Too_Small"},
      {Ipopt::Diverging_Iterates, "Diverging_Iterates"},
      {Ipopt::User_Requested_Stop, "User_Requested_Stop"},
      {Ipopt::Feasible_Point_Found, "Feasible_Point_Found"},
      {Ipopt::Maximum_Iterations_Exceeded, "Maximum_Iterations_Exceeded"},
      {Ipopt::Restoration_Failed, "Restoration_Failed"},
      {Ipopt::Error_In_Step_Computation, "Error_In_Step_Computation"},
      {Ipopt::Maximum_CpuTime_Exceeded, "Maximum_CpuTime_Exceeded"},
      {Ipopt::Not_Enough_Degrees_Of_Freedom, "Not_Enough_Degrees_Of_Freedom"},
      {Ipopt::Invalid_Problem_Definition, "Invalid_Problem_Definition"},
      {Ipopt::Invalid_Option, "Invalid_Option"},
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

// Ipopt's view of a QuadraticProgram.
class ProgramNlp final : public Ipopt::TNLP {
 public:
  const QuadraticProgram* program = nullptr;
  const Start* start = nullptr;
  // See Engine::Optimize.
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
  static void Copy(const Entries& from, double factor, IpoptIndex* row, IpoptIndex* column, Number* values) {
    if (values == nullptr) {
      std::copy(from.row.begin(), from.row.end(), row);
      std::copy(from.column.begin(), from.column.end(), column);
    } else {
      std::transform(from.value.begin(), from.value.end(), values, [&](double x) { return factor * x; });
    }
  }

  Eigen::VectorXd x_;
};

}  // namespace

struct Engine::State {
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application;
  Ipopt::SmartPtr<ProgramNlp> nlp;
  bool built = false;  // the algorithm's objects exist: ReOptimizeTNLP works

  ~State() {
    const std::lock_guard lock(LibraryMutex());
    application = nullptr;
  }
};

Engine::Engine(const QuadraticProgram& program) : state_(std::make_unique<State>()) {
  ++WorkCounts::OfThread().analyses;
  State& s = *state_;
  s.nlp = new ProgramNlp;
  s.nlp->program = &program;
  {
    const std::lock_guard lock(LibraryMutex());
    s.application = new Ipopt::IpoptApplication(/*create_console_out=*/false);
    // An empty name: the default would read ipopt.opt from the working directory.
    if (s.application->Initialize("") != Ipopt::Solve_Succeeded) throw std::runtime_error("Ipopt did not initialise");
    SetOptions(Ipopt::GetRawPtr(s.application->Options()));
  }
  const auto go_on = [](const Eigen::VectorXd&) { return false; };
  s.built = Optimize(Start::Zero(program), /*warm=*/false, /*max_iterations=*/0, kNever, go_on).iteration_limit;
}

Engine::~Engine() = default;

Engine::Ending Engine::Optimize(const Start& start, bool warm, std::int64_t max_iterations, double tolerance,
                                const OnIterate& on_iterate) {
  State& s = *state_;
  const std::lock_guard lock(LibraryMutex());
  s.nlp->start = &start;
  s.nlp->on_iterate = &on_iterate;
  Ipopt::OptionsList& options = *s.application->Options();
  constexpr std::int64_t kMost = std::numeric_limits<IpoptIndex>::max();
  options.SetIntegerValue("max_iter", static_cast<IpoptIndex>(std::min(max_iterations, kMost)));
  for (const char* name : {"tol", "compl_inf_tol"}) options.SetNumericValue(name, tolerance);
  options.SetStringValue("warm_start_init_point", warm ? "yes" : "no");
  Ipopt::TNLP* const program = Ipopt::GetRawPtr(s.nlp);
  const Ipopt::ApplicationReturnStatus code =
      s.built ? s.application->ReOptimizeTNLP(program) : s.application->OptimizeTNLP(program);
  // Of MUMPS, Ipopt 3.11.9 times the symbolic analysis and the solves only.
  FactorClock::CannotTell();
  ++WorkCounts::OfThread().factorizations;  // or more: it does not say
  Ending ending;
  ending.status = Name(code);
  ending.converged = code == Ipopt::Solve_Succeeded;
  ending.iteration_limit = code == Ipopt::Maximum_Iterations_Exceeded;
  if (Ipopt::IsValid(s.application->Statistics())) ending.iterations = s.application->Statistics()->IterationCount();
  return ending;
}

}  // namespace lcpbench::ipopt
