#include "solvers/ipopt/ipopt_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/ipopt/ipopt_engine.h"
#include "solvers/lcp/residual.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

using ipopt::Engine;
using ipopt::QuadraticProgram;
using ipopt::Start;

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

double Largest(const Eigen::VectorXd& x) {
  double largest = 0;
  for (const double value : x) largest = std::max(largest, std::abs(value));
  return largest;
}

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

  // Whether the lifted form is the sparser one: A has many more entries than J.
  bool LiftedIsSparser() const {
    return problem.has_factors() && BoundEntriesOfA(problem) > kLiftedFill * problem.J().nonZeros();
  }
};

// One way to write the LCP as a program. Variables are the scaled f, the velocities v = S^T f of the lifted form, and
// the gaps w of kNcp on unilateral rows; c begins with b.
struct Formulation {
  std::string_view name;
  QuadraticProgram program;
  bool is_ncp = false;          // then the first n constraints are w = A f + b, and d begins with -b
  SparseMatrix S;               // lifted
  std::vector<Index> gap_rows;  // of the variables w

  // A start with the given scaled f and w (both already off their bounds), primal and dual. The stationarity of f asks
  // for z_f = w, that of w for z_w = f and multipliers -f of the constraints w = ...; those of S^T f - v = 0 are v.
  Start StartAt(const Eigen::VectorXd& f, const Eigen::VectorXd& w) const {
    const Eigen::VectorXd v = S.cols() > 0 ? Eigen::VectorXd(S.transpose() * f) : Eigen::VectorXd();
    const Index n = f.size();
    const Index gaps = n + v.size();
    Start start = Start::Zero(program);
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

// Adds w of the unilateral rows as variables with the entries -w in constraints 0..n-1, and sizes c and d.
Formulation Finished(const ScaledLcp& scaled, Index constraints, Formulation form) {
  QuadraticProgram& program = form.program;
  for (Index i = 0; i < scaled.size() && form.is_ncp; ++i) {
    if (scaled.problem.is_bilateral(i)) continue;
    program.jacobian.Add(i, static_cast<Index>(program.nonnegative.size()), -1.0);
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
      form.program.jacobian.Add(i, it.col(), it.value() * scale(it.col()));
    }
    for (SparseMatrix::InnerIterator it(is_ncp ? twice : A, i); it && it.col() <= i; ++it) {
      form.program.hessian.Add(i, it.col(), it.value() * scale(it.col()));
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
      if (is_ncp) program.jacobian.Add(i, n + it.col(), it.value());
      program.jacobian.Add(first + it.col(), i, it.value());
    }
  }
  for (Index k = 0; k < form.S.cols(); ++k) {
    program.nonnegative.push_back(false);
    program.jacobian.Add(first + k, n + k, -1.0);
    program.hessian.Add(n + k, n + k, is_ncp ? 2.0 : 1.0);
  }
  const Index bodies = form.S.cols();
  return Finished(scaled, bodies, std::move(form));
}

}  // namespace

// What is kept for one matrix, and the workspace of the test after each iteration.
struct IpoptSolver::State {
  std::optional<ScaledLcp> scaled;
  std::vector<Formulation> formulations;
  std::vector<std::unique_ptr<Engine>> engines;  // of each formulation; made when first needed
  GivenFormTest given;
  Eigen::VectorXd f;
  Eigen::VectorXd last_x;
  Eigen::VectorXd ray;
  Eigen::VectorXd product;
  long double best_rho = kInfinity;

  void TakeB(const Eigen::VectorXd& b);
  bool Accept(const Eigen::VectorXd& x, double tolerance, LcpResult* result);
  bool AcceptRay(const Eigen::VectorXd& direction, LcpResult* result);
  Start FirstPoint(const Formulation& formulation, const LcpOptions& options);
  Engine& EngineOf(std::size_t which);
  void Take(const Eigen::VectorXd& x);
  bool Run(std::size_t which, const LcpOptions& options, bool self_check, const Deadline& deadline, LcpResult* result);
};

void IpoptSolver::State::TakeB(const Eigen::VectorXd& b) {
  for (Formulation& form : formulations) {
    form.program.c.head(b.size()) = b;
    if (form.is_ncp) form.program.d.head(b.size()) = -b;
  }
}

Engine& IpoptSolver::State::EngineOf(std::size_t which) {
  std::unique_ptr<Engine>& engine = engines[which];
  if (engine == nullptr) engine = std::make_unique<Engine>(formulations[which].program);
  return *engine;
}

// f of x (scaled; its first n entries), clipped, in the problem's units.
void IpoptSolver::State::Take(const Eigen::VectorXd& x) {
  const LcpProblem& problem = scaled->problem;
  const Index n = problem.size();
  f = x.head(n);
  for (Index i = 0; i < n; ++i) {
    if (!problem.is_bilateral(i)) f[i] = std::max(f[i], 0.0);
    f[i] *= scaled->force_unit[i];
  }
}

// Whether x meets the tier. Keeps the best f in the result.
bool IpoptSolver::State::Accept(const Eigen::VectorXd& x, double tolerance, LcpResult* result) {
  const LcpProblem& problem = scaled->problem;
  const Index n = problem.size();
  Take(x);
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
bool IpoptSolver::State::AcceptRay(const Eigen::VectorXd& direction, LcpResult* result) {
  const LcpProblem& problem = scaled->problem;
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
      slope += scaled->b[i] * ray[i];
      ray[i] *= scaled->force_unit[i];
    }
    if (!(slope < 0)) continue;
    problem.ComputeW(ray, &product);
    product = (product - problem.b()).cwiseQuotient(scaled->gap_unit);
    if (!(Largest(product) <= kRayGate)) continue;
    if (!VerifyFarkasRay(problem, ray).accepted) continue;
    result->status = LcpStatus::kInfeasible;
    result->farkas_ray = ray;
    return true;
  }
  return false;
}

ipopt::Start IpoptSolver::State::FirstPoint(const Formulation& formulation, const LcpOptions& options) {
  const LcpProblem& problem = scaled->problem;
  const Index n = problem.size();
  if (options.initial_f == nullptr) {
    // Ipopt moves x to its own distance from the bounds (bound_push) and sets all multipliers.
    return Start::Zero(formulation.program);
  }
  Eigen::VectorXd force = options.initial_f->cwiseQuotient(scaled->force_unit);
  problem.ComputeW(*options.initial_f, &product);
  Eigen::VectorXd gap = product.cwiseQuotient(scaled->gap_unit);
  const double force_push = kWarmPush * std::max(Largest(force), Largest(scaled->b));
  const double gap_push = kWarmPush * Largest(scaled->b);
  for (Index i = 0; i < n; ++i) {
    if (problem.is_bilateral(i)) continue;
    force[i] = std::max(force[i], force_push);
    gap[i] = std::max(gap[i], gap_push);
  }
  return formulation.StartAt(force, gap);
}

// True when the solve is over: the next formulation need not be tried.
bool IpoptSolver::State::Run(std::size_t which, const LcpOptions& options, bool self_check, const Deadline& deadline,
                             LcpResult* result) {
  const Formulation& formulation = formulations[which];
  const Start start = FirstPoint(formulation, options);
  const bool symmetric = scaled->problem.IsNumericallySymmetric();
  bool over = false;
  bool late = false;
  last_x.setZero(start.x.size());
  const auto on_iterate = [&](const Eigen::VectorXd& x) {
    if (x.size() > 0) {
      over = self_check && Accept(x, options.tolerance, result);
      if (!self_check) last_x = x;
      if (!over && symmetric && self_check) {
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
      options.max_iterations > 0 ? options.max_iterations - result->iterations : kDefaultIterations;
  const bool warm = options.initial_f != nullptr;
  Engine& engine = EngineOf(which);
  const Engine::Ending ending =
      engine.Optimize(start, warm, limit, self_check ? Engine::kNever : options.tolerance, on_iterate);
  result->iterations += ending.iterations;
  if (!self_check && ending.converged) {
    Take(last_x);
    result->f = f;
    result->status = LcpStatus::kSolved;
    over = true;
  }

  if (!result->detail.empty()) result->detail += "; ";
  result->detail += "Ipopt (" + std::string(formulation.name) + " form): " + std::string(ending.status);
  if (over) return true;
  if (late) {
    result->status = LcpStatus::kTimeLimit;
    return true;
  }
  result->status = ending.iteration_limit ? LcpStatus::kIterationLimit : LcpStatus::kNumericalFailure;
  return ending.iteration_limit && options.max_iterations > 0;
}

IpoptOptions IpoptOptions::FromSettings(Program program, const Settings& settings) {
  SettingsReader reader(program == Program::kQp ? "ipopt-qp" : "ipopt-ncp", settings);
  IpoptOptions options;
  options.program = program;
  const std::string form = reader.Choice("form", "auto", {"auto", "contact", "lifted"});
  if (form == "contact") options.form = Form::kContact;
  if (form == "lifted") options.form = Form::kLifted;
  options.self_check = reader.SelfCheck();
  reader.Finish();
  return options;
}

IpoptSolver::IpoptSolver(IpoptOptions options) : options_(options), state_(std::make_unique<State>()) {}
IpoptSolver::~IpoptSolver() = default;

std::string IpoptSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (options_.form == IpoptOptions::Form::kLifted && !problem.has_factors()) {
    return "the lifted form needs a problem given by factors";
  }
  if (options_.program == IpoptOptions::Program::kQp && !problem.IsNumericallySymmetric()) {
    return "A is not symmetric, so the LCP is not the optimality of a QP";
  }
  return {};
}

void IpoptSolver::DoPrepare(const LcpProblem& problem) {
  using Form = IpoptOptions::Form;
  State& s = *state_;
  const ScaledLcp& scaled = s.scaled.emplace(problem);
  const bool is_ncp = options_.program == IpoptOptions::Program::kNcp;
  s.given.Reset(problem);
  s.engines.clear();
  s.formulations.clear();
  const bool dense = scaled.LiftedIsSparser();  // then A may not fit in memory
  if (options_.form == Form::kContact || (options_.form == Form::kAuto && !dense)) {
    s.formulations.push_back(ContactForm(scaled, is_ncp));
  }
  if (options_.form == Form::kLifted || (options_.form == Form::kAuto && problem.has_factors())) {
    s.formulations.push_back(LiftedForm(scaled, is_ncp));
  }
  s.engines.resize(s.formulations.size());
  // What Ipopt builds for the first program does not depend on b.
  s.TakeB(Eigen::VectorXd::Ones(scaled.size()));
  s.EngineOf(0);
}

void IpoptSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  State& s = *state_;
  const Deadline deadline(options);
  s.scaled->SetB(problem);
  s.given.SetB(problem);
  s.TakeB(s.scaled->b);
  s.best_rho = kInfinity;
  // The start may be the answer already: an interior point method would walk away from it.
  Eigen::VectorXd first = Eigen::VectorXd::Zero(s.scaled->size());
  if (options.initial_f != nullptr) first = options.initial_f->cwiseQuotient(s.scaled->force_unit);
  if (options_.self_check && s.Accept(first, options.tolerance, result)) return;
  for (std::size_t which = 0; which < s.formulations.size(); ++which) {
    if (s.Run(which, options, options_.self_check, deadline, result)) return;
  }
}

}  // namespace lcpbench
