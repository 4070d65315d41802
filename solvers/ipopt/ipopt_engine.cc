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

// Every option that differs from Ipopt's default, with its reason.
//
// Tolerances. The tier T bounds rho, a 2-norm of min(f, w); Ipopt bounds max-norms of its optimality conditions, of
// which complementarity is a product: a degenerate row (f = w = 0) has f = w = sqrt(mu) on the central path, so that
// T = 1e-9 takes mu near 1e-20, and a row of large f far less. No fixed map from T to tol serves both. So the test of
// the project stops Ipopt from its callback, after every iteration, and Ipopt's own tests are set out of reach.
void SetOptions(Ipopt::OptionsList* options) {
  const auto number = [&](const char* name, double value) {
    if (!options->SetNumericValue(name, value)) throw std::runtime_error(std::string("Ipopt refused option ") + name);
  };
  const auto integer = [&](const char* name, int value) {
    if (!options->SetIntegerValue(name, value)) throw std::runtime_error(std::string("Ipopt refused option ") + name);
  };
  const auto text = [&](const char* name, const char* value) {
    if (!options->SetStringValue(name, value)) throw std::runtime_error(std::string("Ipopt refused option ") + name);
  };
  // Silence: no iteration table, and no banner at the first solve of the process.
  integer("print_level", 0);
  text("sb", "yes");
  // tol bounds the overall error and so dominates dual_inf_tol and constr_viol_tol, see Optimize; compl_inf_tol also
  // floors mu.
  // The floor of mu in adaptive mode; its default 1e-11 stops degenerate rows at 3e-6.
  number("mu_min", 1e-40);
  // "Acceptable" points are no answer here: only the tier test is.
  integer("acceptable_iter", 0);
  // Predictor-corrector steps without line search (and with them mu_strategy = adaptive and mu_oracle = probing): made
  // for convex QPs, and measured to reach 1e-9 on degenerate rows where the default monotone mu stalls. At n = 10 (100)
  // the others take more time at their best settings: monotone with mu_init = 0.1, a steep decrease and
  // barrier_tol_factor = 1000 3 % (15 %), adaptive loqo 15 % (30 %), probing without corrector 35 % (45 %),
  // quality-function 130 % (110 %).
  text("mehrotra_algorithm", "yes");
  // Not in the restoration phase, though: there Ipopt 3.11.9 reads an affine step that nothing has computed, and
  // crashes (null pointer in PDSearchDirCalculator).
  text("resto.mehrotra_algorithm", "no");
  // Mehrotra mode starts 10 off the bounds. Here |b| = 1 and A has a unit diagonal, so forces are of order 1 or less:
  // nearer takes a quarter fewer iterations on small problems, and does not matter on large ones. Between 0.03 and 0.3
  // the counts differ by 5 %, either way with size and form; 0.01 and 1 take 15 % more.
  number("bound_push", 0.1);
  number("bound_mult_init_val", 0.1);
  // A relaxed bound f >= -1e-8 would let f and w of one row be negative together: complementarity at 1e-9 is then lost.
  number("bound_relax_factor", 0.0);
  // The program is Jacobi-scaled already; a second scaling would change what the numbers above mean.
  text("nlp_scaling_method", "none");
  // H and G are constant, so each is evaluated once.
  text("hessian_constant", "yes");
  text("jac_c_constant", "yes");
  text("jac_d_constant", "yes");
  // The only linear solver in Debian's build: MA27, MA57 and PARDISO are loaded at run time from libraries that Debian
  // does not have, and this Ipopt does not know SPRAL.
  text("linear_solver", "mumps");
  // No matching and no scaling inside MUMPS: the program is scaled, and on a KKT matrix with a Jacobi-scaled A neither
  // changes an iteration (measured). 1 to 3 % faster.
  integer("mumps_permuting_scaling", 0);
  integer("mumps_scaling", 0);
  // A linear solve is refined only where its residual asks for it. The default refines each once more, which changes
  // no iteration count below n = 1000 and costs 15 to 20 %: a call of this MUMPS takes tens of microseconds whatever n.
  integer("min_refinement_steps", 0);
  // Mehrotra mode begins with two least-squares problems, for x and for y. Where y is empty or starts at 0 as well,
  // they buy nothing: a factorisation saved, the same iterations to within 3 %.
  text("least_square_init_primal", "no");
  text("least_square_init_duals", "no");
  number("constr_mult_init_max", 0.0);
  // Redundant joints make the constraints of the contact form dependent. Regularising them always, not only after
  // MUMPS has noticed, is what lets those problems converge.
  text("perturb_always_cd", "yes");
  // The warm start is moved off its bounds by us, in proportion to its size; Ipopt's own absolute pushes stay away.
  number("warm_start_bound_push", 1e-16);
  number("warm_start_bound_frac", 1e-16);
  number("warm_start_slack_bound_push", 1e-16);
  number("warm_start_slack_bound_frac", 1e-16);
  number("warm_start_mult_bound_push", 1e-16);
}

std::string_view Name(Ipopt::ApplicationReturnStatus code) {
  switch (code) {
    case Ipopt::Solve_Succeeded:
      return "Solve_Succeeded";
    case Ipopt::Solved_To_Acceptable_Level:
      return "Solved_To_Acceptable_Level";
    case Ipopt::Infeasible_Problem_Detected:
      return "Infeasible_Problem_Detected";
    case Ipopt::Search_Direction_Becomes_Too_Small:
      return "Search_Direction_Becomes_Too_Small";
    case Ipopt::Diverging_Iterates:
      return "Diverging_Iterates";
    case Ipopt::User_Requested_Stop:
      return "User_Requested_Stop";
    case Ipopt::Feasible_Point_Found:
      return "Feasible_Point_Found";
    case Ipopt::Maximum_Iterations_Exceeded:
      return "Maximum_Iterations_Exceeded";
    case Ipopt::Restoration_Failed:
      return "Restoration_Failed";
    case Ipopt::Error_In_Step_Computation:
      return "Error_In_Step_Computation";
    case Ipopt::Maximum_CpuTime_Exceeded:
      return "Maximum_CpuTime_Exceeded";
    case Ipopt::Not_Enough_Degrees_Of_Freedom:
      return "Not_Enough_Degrees_Of_Freedom";
    case Ipopt::Invalid_Problem_Definition:
      return "Invalid_Problem_Definition";
    case Ipopt::Invalid_Option:
      return "Invalid_Option";
    case Ipopt::Invalid_Number_Detected:
      return "Invalid_Number_Detected";
    case Ipopt::Unrecoverable_Exception:
      return "Unrecoverable_Exception";
    case Ipopt::NonIpopt_Exception_Thrown:
      return "NonIpopt_Exception_Thrown";
    case Ipopt::Insufficient_Memory:
      return "Insufficient_Memory";
    case Ipopt::Internal_Error:
      return "Internal_Error";
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
