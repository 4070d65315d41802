#include "solvers/auto/law_ladder.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "solvers/friction/lagged_bounds.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/islands.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// None where all rows are connected.
std::vector<std::vector<Index>> IslandsOf(const LcpProblem& problem) {
  Islands found;
  if (problem.has_factors()) {
    found.FindByColumns(problem.J(), problem.inverse_mass(), problem.friction_rows());
  } else {
    found.Find(problem.SparseA(), std::vector<char>(At(problem.size()), 1), problem.friction_rows());
  }
  std::vector<std::vector<Index>> islands;
  if (found.count() == 1) return islands;
  for (Index k = 0; k < found.count(); ++k) islands.emplace_back(found.rows(k).begin(), found.rows(k).end());
  return islands;
}

// Whether `found` has a ray that proves that this problem has no solution; *result has it then.
bool TakeRay(const LcpProblem& problem, LcpResult* found, LcpResult* result) {
  std::optional<Eigen::VectorXd>& ray = found->farkas_ray;
  if (found->status != LcpStatus::kInfeasible || !ray || !VerifyFarkasRay(problem, *ray).accepted) return false;
  result->farkas_ray = std::move(ray);
  result->status = LcpStatus::kInfeasible;
  return true;
}

}  // namespace

LawLadder::LawLadder(SmallPivoting* tableau, const WithinOptions& plain, const AutoLimits& limits)
    : plain_(plain), limits_(limits), rounds_(tableau, plain) {}

void LawLadder::Reserve(Index max_rows) {
  newton_.Reserve(max_rows);
  path_.Reserve(max_rows);
  rounds_.Reserve(max_rows);
  phi_.Lengthen(max_rows);
}

const char* LawLadder::Solve(const ContactRows& rows, std::size_t* next, FrictionAnswer* answer, LcpResult* result) {
  const Laws laws = rows.laws();
  facts_ = {.limits = &limits_};
  facts_.rows = rows.size();
  facts_.tolerance = answer->tolerance();
  facts_.contacts = std::ssize(laws.normals);
  facts_.can_stick = std::ranges::any_of(laws.friction, &CanStick);
  facts_.can_relax = rows.can_relax();
  facts_.is_paired = rows.is_paired();
  facts_.has_bounded = !laws.bounded.empty();
  facts_.has_start = answer->options().initial_f != nullptr;
  facts_.has_problem = plain_.make_plain != nullptr;
  newton_.Reset();
  has_rounds_ = false;
  const std::span<const AutoRule> rules = AutoRulesOf(AutoStage::kLaws);
  AutoFacts of_problem = facts_;
  of_problem.has_problem = true;
  std::size_t left = rules.size();  // the first rule that only an LcpProblem may ask
  while (*next < rules.size()) {
    const AutoRule& rule = rules[(*next)++];
    if (rule.Grants(facts_) == 0) {
      if (rule.Grants(of_problem) > 0) left = std::min(left, *next - 1);
      continue;
    }
    if (const char* method = TryMethod(rule, rows, answer, result)) return method;
    if (answer->IsOver()) {
      if (answer->is_unclear()) --*next;
      break;
    }
    if (facts_.relaxation_failed && !facts_.has_problem) {
      --*next;  // a solver of plain problems has other methods
      break;
    }
  }
  *next = std::min(*next, left);
  return nullptr;
}

const char* LawLadder::TryMethod(const AutoRule& rule, const ContactRows& rows, FrictionAnswer* answer,
                                 LcpResult* result) {
  constexpr double kFirstEps = 1e-8;
  constexpr unsigned kSeeds = 2;
  const auto granted = static_cast<int>(std::min<std::int64_t>(rule.Grants(facts_), ModeSteps::kMostSteps));
  const auto start_at_zero = [&] {
    phi_.Lengthen(rows.size());
    phi_.head(rows.size()).setZero();
  };
  const auto run_rounds = [&](int count) {
    if (!std::exchange(has_rounds_, true)) rounds_.Start(rows);
    return rounds_.TakeRounds(rows, count, &newton_, &phi_, answer);
  };
  switch (rule.method) {
    case AutoMethod::kNoFriction:
      return run_rounds(1) != nullptr ? "no friction" : nullptr;
    case AutoMethod::kWarmModes:
      return newton_.Warm(rows, granted, answer) ? "warm modes" : nullptr;
    case AutoMethod::kModes:
      start_at_zero();
      return newton_.TakeFullSteps(rows, granted, &phi_, answer) ? "modes" : nullptr;
    case AutoMethod::kAllModes:
      return newton_.TryAll(rows, answer) ? "modes" : nullptr;
    case AutoMethod::kSweeps:
      if (!answer->GetBest(&phi_)) start_at_zero();
      return TrySweeps(rows, static_cast<double>(rule.Grants(facts_)), answer);
    case AutoMethod::kRelaxation: {
      const char* const method = run_rounds(granted);
      facts_.relaxation_failed = method == nullptr && !rounds_.is_solved() && !rounds_.ran_out_of_time();
      return method;
    }
    case AutoMethod::kModeNewton:
      start_at_zero();
      if (rows.size() > ModeFactor::kMostDense) {
        return path_.ApproachByNewton(rows, &newton_, &phi_, answer) ? "mode-newton" : nullptr;
      }
      return newton_.TakeDampedSteps(rows, {.steps = granted, .eps = kFirstEps}, &phi_, answer) ? "mode-newton"
                                                                                                : nullptr;
    case AutoMethod::kCoulombPath:
      return coulomb_path_.Follow(rows, granted, &newton_, &phi_, answer) ? "central path" : nullptr;
    case AutoMethod::kLaggedBounds:
      return TryLaggedBounds(granted, answer, result) ? "lagged-bounds" : nullptr;
    case AutoMethod::kLemke:
      return path_.Cover(rows, kSeeds, &newton_, &phi_, answer) ? "lemke" : nullptr;
    case AutoMethod::kProximalPoints:
      if (!answer->GetBest(&phi_)) start_at_zero();
      return path_.Approach(rows, granted, &newton_, &phi_, answer) ? "proximal points" : nullptr;
    case AutoMethod::kRay:
      return FindRay(*answer, result) ? "a ray without friction" : nullptr;
    default:
      return nullptr;
  }
}

// Sweeps from phi_, in spans that double, as long as the rate of the last one promises an answer within `granted`.
const char* LawLadder::TrySweeps(const ContactRows& rows, double granted, FrictionAnswer* answer) {
  constexpr double kFirstSpan = 2;  // times the root of the rows: forces travel a row or so a sweep
  constexpr ModeSteps::Limits kNear{.steps = 3, .eps = 1e-8};
  double all = 0, rest = 0, before = std::numeric_limits<double>::infinity();
  double span = kFirstSpan * std::sqrt(static_cast<double>(rows.size()));
  for (; all + rest <= granted && !answer->IsOver(); span = all) {
    if (newton_.Sweep(rows, static_cast<int>(span), &phi_, answer) || answer->Take(phi_)) return "sweeps";
    const double rho = answer->rho();
    if (rho < limits_.newton_rho && newton_.TakeDampedSteps(rows, kNear, &phi_, answer)) return "mode-newton";
    if (!(rho < before)) break;
    all += span;
    rest = span * std::log(rho / answer->tolerance()) / std::log(before / rho);
    before = rho;
  }
  return nullptr;
}

// So many rounds from 0. True where an answer passes, or a ray proves that there is none.
bool LawLadder::TryLaggedBounds(int rounds, FrictionAnswer* answer, LcpResult* result) const {
  LcpOptions of_rounds = answer->options();
  of_rounds.initial_f = nullptr;
  if (of_rounds.max_iterations > 0) of_rounds.max_iterations -= answer->iterations();
  if (of_rounds.max_iterations <= 0 || of_rounds.max_iterations > rounds) of_rounds.max_iterations = rounds;
  of_rounds.time_limit_s =
      std::max(limits_.bounds_time_share * answer->Remaining(), std::numeric_limits<double>::min());
  LcpResult found;
  LaggedBoundsSolver(plain_).Solve(answer->problem(), of_rounds, &found);
  answer->ForgetTime();
  answer->iterations() += found.iterations;
  return answer->TakeForces(found.f) || TakeRay(answer->problem(), &found, result);
}

// Whether there is no solution even without friction, whose forces then do not help [docs/friction.md section 2].
bool LawLadder::FindRay(const FrictionAnswer& answer, LcpResult* result) const {
  const LcpProblem& problem = answer.problem();
  RowBounds bounds = problem.bounds();
  for (const FrictionRow& row : bounds.friction) bounds.bounded.push_back({row.row, 0, 0});
  bounds.friction.clear();
  LcpOptions plain = answer.options();
  plain.initial_f = nullptr;
  plain.time_limit_s = std::max(answer.Remaining(), std::numeric_limits<double>::min());
  LcpResult frictionless;
  plain_.make_plain()->Solve(problem.WithBounds(std::move(bounds)), plain, &frictionless);
  answer.ForgetTime();
  return TakeRay(problem, &frictionless, result);
}

void TakeAnswer(const LcpProblem& problem, std::span<const Index> rows, const LcpResult& part, LcpResult* result) {
  result->iterations += part.iterations;
  if (part.status != LcpStatus::kSolved) result->status = part.status;
  Eigen::VectorXd ray;
  if (part.status == LcpStatus::kInfeasible) ray.setZero(problem.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    result->f[rows[k]] = part.f[static_cast<Index>(k)];
    if (ray.size() > 0) ray[rows[k]] = (*part.farkas_ray)[static_cast<Index>(k)];
  }
  if (ray.size() == 0) return;
  if (VerifyFarkasRay(problem, ray).accepted) result->farkas_ray = std::move(ray);
  if (!result->farkas_ray) result->status = LcpStatus::kNumericalFailure;
}

void LawPortfolio::Prepare(const LcpProblem& problem) {
  // Without friction the whole is left to the solver of plain problems, to be solved in the same bits.
  const bool is_plain =
      problem.bounded_rows().empty() &&
      std::ranges::all_of(problem.friction_rows(), [](const FrictionRow& row) { return row.mu == 0; });
  std::vector<std::vector<Index>> islands;
  if (!is_plain && problem.size() > ModeSteps::kFewRows) islands = IslandsOf(problem);
  parts_.resize(std::max(islands.size(), size_t{1}));
  for (size_t k = 0; k < parts_.size(); ++k) {
    Part& part = parts_[k];
    part.rows = islands.empty() ? std::vector<Index>() : std::move(islands[k]);
    part.problem = islands.empty() ? problem : Subproblem(problem, part.rows);
    part.contacts.Prepare(*part.problem);
  }
}

void LawPortfolio::Solve(const LcpProblem& problem, const LcpOptions& options, std::size_t next,
                         const Eigen::VectorXd* reached, LcpResult* result) {
  if (parts_.size() == 1) return SolvePart(&parts_.front(), problem, options, next, reached, result);
  const Deadline deadline(options);
  LcpResult of_part;
  Eigen::VectorXd start, reached_of_part;
  result->status = LcpStatus::kSolved;
  size_t largest = 0;
  std::string last;
  for (Part& part : parts_) {
    LcpOptions rest = options;
    rest.time_limit_s = deadline.RestOfLimit();
    if (options.initial_f != nullptr) {
      start = (*options.initial_f)(part.rows);
      rest.initial_f = &start;
    }
    if (reached != nullptr) reached_of_part = (*reached)(part.rows);
    of_part.f.setZero(std::ssize(part.rows));
    of_part.status = LcpStatus::kNumericalFailure;
    of_part.iterations = 0;
    of_part.farkas_ray.reset();
    const LcpProblem of_rows = part.problem->WithB(problem.b()(part.rows));
    SolvePart(&part, of_rows, rest, next, reached == nullptr ? nullptr : &reached_of_part, &of_part);
    TakeAnswer(problem, part.rows, of_part, result);
    if (part.rows.size() > largest || of_part.status != LcpStatus::kSolved) last = of_part.detail;
    largest = std::max(largest, part.rows.size());
    if (of_part.status == LcpStatus::kInfeasible) break;
  }
  result->detail = std::to_string(parts_.size()) + " islands, largest " + std::to_string(largest) + " rows; " + last;
  // All parts pass; S of the whole is no less than theirs together, but for the least that counts.
  if (result->status == LcpStatus::kSolved && !PassesTier(ComputeMetrics(problem, result->f), options.tolerance)) {
    result->status = LcpStatus::kNumericalFailure;
  }
}

void LawPortfolio::SolvePart(Part* part, const LcpProblem& problem, const LcpOptions& options, std::size_t next,
                             const Eigen::VectorXd* reached, LcpResult* result) {
  const ContactRows& rows = part->contacts;
  part->contacts.SetB(problem);
  FrictionAnswer answer(rows, &problem, options, result);
  if (rows.size() > ModeFactor::kMostDense) next = 0;
  const bool has_arrived = reached != nullptr && answer.TakeForces(*reached);
  const char* const method = has_arrived ? "rows in place" : ladder_.Solve(rows, &next, &answer, result);
  if (method == nullptr) return answer.Fail("no method finds an answer");
  result->detail = method;
}

}  // namespace lcpbench
