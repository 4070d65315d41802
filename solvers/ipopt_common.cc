// Shared by ipopt_qp.cc and ipopt_ncp.cc: the only file that sees Ipopt.
#include "solvers/ipopt_common.h"

#include <IpIpoptApplication.hpp>
#include <IpIpoptCalculatedQuantities.hpp>
#include <IpIpoptData.hpp>
#include <IpOrigIpoptNLP.hpp>
#include <IpSolveStatistics.hpp>
#include <IpTNLP.hpp>
#include <IpTNLPAdapter.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>

#include "solvers/given_form.h"
#include "solvers/lcp/verify.h"

namespace lcpbench::ipopt {
namespace {

using Ipopt::Number;
using IpoptIndex = Ipopt::Index;

constexpr long double kInfinity = std::numeric_limits<long double>::infinity();
// Ipopt takes bounds from nlp_upper_bound_inf = 1e19 on as none.
constexpr double kNoBound = 2e19;

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

// A at least this many times as dense as J makes the lifted form the faster one (measured: equal near 25 on a single
// body with n contacts).
constexpr Index kLiftedFill = 25;

double Largest(const Eigen::VectorXd& x) {
  double largest = 0;
  for (const double value : x) largest = std::max(largest, std::abs(value));
  return largest;
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
  // tol bounds the overall error and so dominates dual_inf_tol and constr_viol_tol; compl_inf_tol also floors mu.
  number("tol", 1e-40);
  number("compl_inf_tol", 1e-40);
  // The floor of mu in adaptive mode; its default 1e-11 stops degenerate rows at 3e-6.
  number("mu_min", 1e-40);
  // "Acceptable" points are no answer here: only the tier test is.
  integer("acceptable_iter", 0);
  // Predictor-corrector steps without line search (and with them mu_strategy = adaptive and mu_oracle = probing): made
  // for convex QPs, and measured to reach 1e-9 on degenerate rows where the default monotone mu stalls.
  text("mehrotra_algorithm", "yes");
  // Not in the restoration phase, though: there Ipopt 3.11.9 reads an affine step that nothing has computed, and
  // crashes (null pointer in PDSearchDirCalculator).
  text("resto.mehrotra_algorithm", "no");
  // Mehrotra mode starts 10 off the bounds. Here |b| = 1 and A has a unit diagonal, so forces are of order 1 or less:
  // nearer takes a quarter fewer iterations on small problems, and does not matter on large ones.
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
  // The only linear solver in Debian's build.
  text("linear_solver", "mumps");
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
  // Called with every iterate; true stops Ipopt.
  std::function<bool(const Eigen::VectorXd&)> on_iterate;

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
    return !on_iterate(x_);
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

ScaledLcp::ScaledLcp(const LcpProblem& problem) : problem_(problem) {
  inverse_root_ = problem.DiagonalA().unaryExpr([](double d) { return d == 0 ? 1.0 : 1.0 / std::sqrt(std::abs(d)); });
  b_ = problem.b().cwiseProduct(inverse_root_);
  long double squares = 0;  // its exponent range holds the square of every double
  for (const double value : b_) squares += static_cast<long double>(value) * value;
  const double norm = squares == 0 ? 1.0 : static_cast<double>(std::sqrt(squares));
  b_ /= norm;
  force_unit_ = inverse_root_ * norm;
  gap_unit_ = inverse_root_.cwiseInverse() * norm;
}

SparseMatrix ScaledLcp::Factor() const {
  const SparseMatrix& J = problem_.J();
  const Eigen::VectorXd& inverse_mass = problem_.inverse_mass();
  std::vector<int> place(static_cast<size_t>(J.cols()), -1);
  std::vector<Eigen::Triplet<double, int>> entries;
  int columns = 0;
  for (Index i = 0; i < J.rows(); ++i) {
    for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
      const double value = it.value() * std::sqrt(inverse_mass[it.col()]) * inverse_root_[i];
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

bool ScaledLcp::LiftedIsSparser() const {
  return problem_.has_factors() && BoundEntriesOfA(problem_) > kLiftedFill * problem_.J().nonZeros();
}

struct Runner::State {
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application;
  std::optional<ScaledLcp> scaled;
  GivenFormTest given;
  // Workspace of the test after each iteration.
  Eigen::VectorXd f;
  Eigen::VectorXd last_x;
  Eigen::VectorXd ray;
  Eigen::VectorXd product;
  long double best_rho = kInfinity;

  bool Accept(const Eigen::VectorXd& x, double tolerance, LcpResult* result);
  bool AcceptRay(const Eigen::VectorXd& direction, LcpResult* result);
  Start FirstPoint(const Formulation& formulation, const LcpOptions& options);
  bool Run(const Formulation& formulation, const LcpOptions& options, const Deadline& deadline, LcpResult* result);
};

Runner::Runner() : state_(std::make_unique<State>()) {}
Runner::~Runner() = default;

void Runner::Prepare(const ScaledLcp& scaled) {
  State& s = *state_;
  if (!Ipopt::IsValid(s.application)) {
    s.application = new Ipopt::IpoptApplication(/*create_console_out=*/false);
    // An empty name: the default would read ipopt.opt from the working directory.
    if (s.application->Initialize("") != Ipopt::Solve_Succeeded) throw std::runtime_error("Ipopt did not initialise");
    SetOptions(Ipopt::GetRawPtr(s.application->Options()));
  }
  s.scaled.emplace(scaled);
  s.given.Reset(s.scaled->problem());
}

// Whether x (scaled; its first n entries are f) meets the tier. Keeps the best f in the result.
bool Runner::State::Accept(const Eigen::VectorXd& x, double tolerance, LcpResult* result) {
  const LcpProblem& problem = scaled->problem();
  const Index n = problem.size();
  f = x.head(n);
  for (Index i = 0; i < n; ++i) {
    if (!problem.is_bilateral(i)) f[i] = std::max(f[i], 0.0);
    f[i] *= scaled->ForceUnit()[i];
  }
  const long double rho = given.Rho(f);
  if (rho < best_rho) {
    best_rho = rho;
    result->f = f;
  }
  if (!(rho <= tolerance)) return false;
  if (!given.Meets(tolerance, f)) {
    for (Index i = 0; i < n; ++i) {
      if (!problem.is_bilateral(i) && x[i] <= kClipShare * tolerance) f[i] = 0;
    }
    if (!given.Meets(tolerance, f)) return false;
  }
  result->f = f;
  result->status = LcpStatus::kSolved;
  return true;
}

// Whether the direction, clipped, proves the LCP infeasible.
bool Runner::State::AcceptRay(const Eigen::VectorXd& direction, LcpResult* result) {
  const LcpProblem& problem = scaled->problem();
  const Index n = problem.size();
  for (const bool clip : {false, true}) {
    ray = direction.head(n);
    const double largest = Largest(ray);
    if (!(largest > 0 && std::isfinite(largest))) return false;
    double slope = 0;
    for (Index i = 0; i < n; ++i) {
      if (!problem.is_bilateral(i)) ray[i] = std::max(ray[i], 0.0);
      if (clip && std::abs(ray[i]) < kRayClip * largest) ray[i] = 0;
      ray[i] /= largest;
      slope += scaled->b()[i] * ray[i];
      ray[i] *= scaled->ForceUnit()[i];
    }
    if (!(slope < 0)) continue;
    problem.ComputeW(ray, &product);
    product = (product - problem.b()).cwiseQuotient(scaled->GapUnit());
    if (!(Largest(product) <= kRayGate)) continue;
    if (!VerifyFarkasRay(problem, ray).accepted) continue;
    result->status = LcpStatus::kInfeasible;
    result->farkas_ray = ray;
    return true;
  }
  return false;
}

Start Runner::State::FirstPoint(const Formulation& formulation, const LcpOptions& options) {
  const LcpProblem& problem = scaled->problem();
  const Index n = problem.size();
  if (options.initial_f == nullptr) {
    // Ipopt moves x to its own distance from the bounds (bound_push) and sets all multipliers.
    const QuadraticProgram& program = formulation.program;
    return {Eigen::VectorXd::Zero(program.c.size()), Eigen::VectorXd::Zero(program.c.size()),
            Eigen::VectorXd::Zero(program.d.size())};
  }
  Eigen::VectorXd force = options.initial_f->cwiseQuotient(scaled->ForceUnit());
  problem.ComputeW(*options.initial_f, &product);
  Eigen::VectorXd gap = product.cwiseQuotient(scaled->GapUnit());
  const double force_push = kWarmPush * std::max(Largest(force), Largest(scaled->b()));
  const double gap_push = kWarmPush * Largest(scaled->b());
  for (Index i = 0; i < n; ++i) {
    if (problem.is_bilateral(i)) continue;
    force[i] = std::max(force[i], force_push);
    gap[i] = std::max(gap[i], gap_push);
  }
  return formulation.start(force, gap);
}

// True when the solve is over: the next formulation need not be tried.
bool Runner::State::Run(const Formulation& formulation, const LcpOptions& options, const Deadline& deadline,
                        LcpResult* result) {
  const Start start = FirstPoint(formulation, options);
  const bool symmetric = scaled->problem().IsNumericallySymmetric();
  Ipopt::SmartPtr<ProgramNlp> nlp = new ProgramNlp;
  nlp->program = &formulation.program;
  nlp->start = &start;
  bool over = false;
  bool late = false;
  last_x.setZero(start.x.size());
  nlp->on_iterate = [&](const Eigen::VectorXd& x) {
    if (x.size() > 0) {
      over = Accept(x, options.tolerance, result);
      if (!over && symmetric) {
        over = AcceptRay(x, result);
        last_x = x - last_x;
        over = over || AcceptRay(last_x, result);
        last_x = x;
      }
    }
    if (!over) late = deadline.Expired();
    return over || late;
  };

  const std::int64_t limit =
      options.max_iterations > 0 ? options.max_iterations - result->iterations : Runner::kDefaultIterations;
  application->Options()->SetIntegerValue("max_iter", static_cast<int>(std::min<std::int64_t>(limit, 1 << 30)));
  application->Options()->SetStringValue("warm_start_init_point", options.initial_f == nullptr ? "no" : "yes");
  const Ipopt::ApplicationReturnStatus code = application->OptimizeTNLP(Ipopt::GetRawPtr(nlp));
  if (Ipopt::IsValid(application->Statistics())) result->iterations += application->Statistics()->IterationCount();

  if (!result->detail.empty()) result->detail += "; ";
  result->detail += "Ipopt (" + std::string(formulation.name) + " form): " + std::string(Name(code));
  if (over) return true;
  if (late) {
    result->status = LcpStatus::kTimeLimit;
    return true;
  }
  const bool limited = code == Ipopt::Maximum_Iterations_Exceeded;
  result->status = limited ? LcpStatus::kIterationLimit : LcpStatus::kNumericalFailure;
  return limited && options.max_iterations > 0;
}

void Runner::Solve(const std::vector<Formulation>& formulations, const LcpOptions& options, LcpResult* result) {
  State& s = *state_;
  const Deadline deadline(options);
  s.best_rho = kInfinity;
  // The start may be the answer already: an interior point method would walk away from it.
  Eigen::VectorXd first = Eigen::VectorXd::Zero(s.scaled->size());
  if (options.initial_f != nullptr) first = options.initial_f->cwiseQuotient(s.scaled->ForceUnit());
  if (s.Accept(first, options.tolerance, result)) return;
  for (const Formulation& formulation : formulations) {
    if (s.Run(formulation, options, deadline, result)) return;
  }
}

}  // namespace lcpbench::ipopt
