#include "solvers/ipopt/ipopt_common.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "solvers/lcp/residual.h"
#include "solvers/lcp/verify.h"

namespace lcpbench::ipopt {
namespace {

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

// A at least this many times as dense as J makes the lifted form the faster one (measured: equal near 25 on a single
// body with n contacts).
constexpr Index kLiftedFill = 25;

double Largest(const Eigen::VectorXd& x) {
  double largest = 0;
  for (const double value : x) largest = std::max(largest, std::abs(value));
  return largest;
}

}  // namespace

ScaledLcp::ScaledLcp(const LcpProblem& problem) : problem_(problem) {
  inverse_root_ = problem.DiagonalA().unaryExpr([](double d) { return d == 0 ? 1.0 : 1.0 / std::sqrt(std::abs(d)); });
}

void ScaledLcp::SetB(const LcpProblem& problem) {
  problem_ = problem;
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
  std::span<Formulation> formulations;
  std::vector<std::unique_ptr<Engine>> engines;  // of each formulation; made when first needed
  std::optional<ScaledLcp> scaled;
  GivenFormTest given;
  // Workspace of the test after each iteration.
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

Runner::Runner() : state_(std::make_unique<State>()) {}
Runner::~Runner() = default;

void Runner::Prepare(const ScaledLcp& scaled, std::span<Formulation> formulations) {
  State& s = *state_;
  s.scaled.emplace(scaled);
  s.given.Reset(s.scaled->problem());
  s.formulations = formulations;
  s.engines.clear();
  s.engines.resize(formulations.size());
  // What Ipopt builds for the first program does not depend on b.
  s.TakeB(Eigen::VectorXd::Ones(s.scaled->size()));
  s.EngineOf(0);
}

void Runner::State::TakeB(const Eigen::VectorXd& b) {
  for (Formulation& form : formulations) {
    form.program.c.head(b.size()) = b;
    if (form.has_gap_constraints) form.program.d.head(b.size()) = -b;
  }
}

Engine& Runner::State::EngineOf(std::size_t which) {
  std::unique_ptr<Engine>& engine = engines[which];
  if (engine == nullptr) engine = std::make_unique<Engine>(formulations[which].program);
  return *engine;
}

// f of x (scaled; its first n entries), clipped, in the problem's units.
void Runner::State::Take(const Eigen::VectorXd& x) {
  const LcpProblem& problem = scaled->problem();
  const Index n = problem.size();
  f = x.head(n);
  for (Index i = 0; i < n; ++i) {
    if (!problem.is_bilateral(i)) f[i] = std::max(f[i], 0.0);
    f[i] *= scaled->ForceUnit()[i];
  }
}

// Whether x meets the tier. Keeps the best f in the result.
bool Runner::State::Accept(const Eigen::VectorXd& x, double tolerance, LcpResult* result) {
  const LcpProblem& problem = scaled->problem();
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
    return Start::Zero(formulation.program);
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
bool Runner::State::Run(std::size_t which, const LcpOptions& options, bool self_check, const Deadline& deadline,
                        LcpResult* result) {
  const Formulation& formulation = formulations[which];
  const Start start = FirstPoint(formulation, options);
  const bool symmetric = scaled->problem().IsNumericallySymmetric();
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
      options.max_iterations > 0 ? options.max_iterations - result->iterations : Runner::kDefaultIterations;
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

void Runner::Solve(const LcpProblem& problem, const LcpOptions& options, bool self_check, LcpResult* result) {
  State& s = *state_;
  const Deadline deadline(options);
  s.scaled->SetB(problem);
  s.given.SetB(problem);
  s.TakeB(s.scaled->b());
  s.best_rho = kInfinity;
  // The start may be the answer already: an interior point method would walk away from it.
  Eigen::VectorXd first = Eigen::VectorXd::Zero(s.scaled->size());
  if (options.initial_f != nullptr) first = options.initial_f->cwiseQuotient(s.scaled->ForceUnit());
  if (self_check && s.Accept(first, options.tolerance, result)) return;
  for (std::size_t which = 0; which < s.formulations.size(); ++which) {
    if (s.Run(which, options, self_check, deadline, result)) return;
  }
}

}  // namespace lcpbench::ipopt
