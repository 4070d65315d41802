#include "solvers/friction/friction_portfolio.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <utility>

#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/islands.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// Rounds of the relaxation, the first unshifted.
constexpr int kRounds = 4;
// Lemke's path, with its dense inverse, is for islands of up to so many contacts.
constexpr size_t kContactsOfPath = 128;

// At tolerances from here on large islands are swept first: the relaxation, a plain problem of as many rows, may take
// longer than all these sweeps.
constexpr double kLooseTolerance = 1e-4;
constexpr Index kLargeIsland = 129;  ///< rows
constexpr double kLooseSweeps = 40;  ///< times the root of the rows: forces travel a row or so a sweep

constexpr double kLeastTime = 1e-9;  // [s]: limits are > 0
constexpr const char* kRay = "a ray without friction";

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

}  // namespace

void FrictionPortfolio::Prepare(const LcpProblem& problem) {
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

void FrictionPortfolio::Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  if (parts_.size() == 1) return SolvePart(&parts_.front(), problem, options, result);
  const Deadline deadline(options);
  LcpResult of_part;
  Eigen::VectorXd b, start;
  result->status = LcpStatus::kSolved;
  const auto gather = [](const Eigen::VectorXd& whole, const std::vector<Index>& rows, Eigen::VectorXd* part) {
    part->resize(static_cast<Index>(rows.size()));
    for (size_t k = 0; k < rows.size(); ++k) (*part)[static_cast<Index>(k)] = whole[rows[k]];
  };
  size_t largest = 0;
  std::string last;
  for (Part& part : parts_) {
    LcpOptions rest = options;
    rest.time_limit_s = std::max(deadline.Remaining(), kLeastTime);
    if (options.initial_f != nullptr) {
      gather(*options.initial_f, part.rows, &start);
      rest.initial_f = &start;
    }
    gather(problem.b(), part.rows, &b);
    of_part.f.setZero(b.size());
    of_part.status = LcpStatus::kNumericalFailure;
    of_part.iterations = 0;
    of_part.farkas_ray.reset();
    const LcpProblem of_rows = part.problem->WithB(b);
    SolvePart(&part, of_rows, rest, &of_part);
    for (size_t k = 0; k < part.rows.size(); ++k) result->f[part.rows[k]] = of_part.f[static_cast<Index>(k)];
    result->iterations += of_part.iterations;
    if (part.rows.size() > largest || of_part.status != LcpStatus::kSolved) last = of_part.detail;
    largest = std::max(largest, part.rows.size());
    if (of_part.status == LcpStatus::kSolved) continue;
    result->status = of_part.status;
    if (of_part.status != LcpStatus::kInfeasible) continue;
    Eigen::VectorXd ray = Eigen::VectorXd::Zero(problem.size());
    for (size_t k = 0; k < part.rows.size(); ++k) ray[part.rows[k]] = (*of_part.farkas_ray)[static_cast<Index>(k)];
    if (VerifyFarkasRay(problem, ray).accepted) result->farkas_ray = std::move(ray);
    if (!result->farkas_ray) result->status = LcpStatus::kNumericalFailure;
    break;
  }
  result->detail = std::to_string(parts_.size()) + " islands, largest " + std::to_string(largest) + " rows; " + last;
  // All parts pass; S of the whole is no less than theirs together, but for the least that counts.
  if (result->status == LcpStatus::kSolved && !PassesTier(ComputeMetrics(problem, result->f), options.tolerance)) {
    result->status = LcpStatus::kNumericalFailure;
  }
}

void FrictionPortfolio::SolvePart(Part* part, const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  const ContactRows& rows = part->contacts;
  part->contacts.SetB(problem);
  newton_.Reset();
  rounds_.Start(rows);
  FrictionAnswer answer(rows, &problem, options, result);
  const char* const method = Ask(rows, &answer, result);
  if (method != nullptr) {
    result->detail = method;
    return;
  }
  answer.Fail("no method finds an answer");
  if (result->status == LcpStatus::kNumericalFailure && FindRay(answer, result)) result->detail = kRay;
}

// The method that answered; nullptr if none did.
const char* FrictionPortfolio::Ask(const ContactRows& rows, FrictionAnswer* answer, LcpResult* result) {
  constexpr ModeSteps::Limits kCold{.steps = 30, .eps = 1e-8};
  constexpr unsigned kSeeds = 2;
  constexpr int kPoints = 1000;
  const bool has_friction = std::ranges::any_of(rows.laws().friction, &CanStick);
  const auto ask_rounds = [&](int count) { return rounds_.Run(rows, count, &newton_, &phi_, answer); };
  if (!has_friction && rows.can_relax() && ask_rounds(1) != nullptr) return "no friction";
  if (const char* method = newton_.Begin(rows, answer)) return method;
  if (answer->tolerance() >= kLooseTolerance && rows.size() >= kLargeIsland) {
    phi_.setZero(rows.size());
    const int sweeps = static_cast<int>(kLooseSweeps * std::sqrt(static_cast<double>(rows.size())));
    if (newton_.Sweep(rows, sweeps, &phi_, answer)) return "sweeps";
  }
  if (rows.can_relax()) {
    if (const char* method = ask_rounds(kRounds)) return method;
    if (!rounds_.is_solved() && !rounds_.ran_out_of_time() && FindRay(*answer, result)) return kRay;
  } else {
    phi_.setZero(rows.size());
    if (newton_.Run(rows, kCold, &phi_, answer)) return "mode-newton";
  }
  if (rows.is_paired() && rows.laws().normals.size() <= kContactsOfPath &&
      mode_path_.Cover(rows, kSeeds, &newton_, &phi_, answer)) {
    return "lemke";
  }
  if (!answer->GetBest(&phi_)) phi_.setZero(rows.size());
  if (mode_path_.Approach(rows, kPoints, &newton_, &phi_, answer)) return "proximal points";
  return nullptr;
}

// Whether there is no solution even without friction, whose forces then do not help [docs/friction.md section 2].
bool FrictionPortfolio::FindRay(const FrictionAnswer& answer, LcpResult* result) const {
  const LcpProblem& problem = answer.problem();
  RowBounds bounds = problem.bounds();
  for (const FrictionRow& row : bounds.friction) bounds.bounded.push_back({row.row, 0, 0});
  bounds.friction.clear();
  LcpOptions plain = answer.options();
  plain.initial_f = nullptr;
  plain.time_limit_s = std::max(answer.Remaining(), kLeastTime);
  LcpResult frictionless;
  plain_.make_plain()->Solve(problem.WithBounds(std::move(bounds)), plain, &frictionless);
  std::optional<Eigen::VectorXd>& ray = frictionless.farkas_ray;
  if (frictionless.status != LcpStatus::kInfeasible || !ray || !VerifyFarkasRay(problem, *ray).accepted) return false;
  result->farkas_ray = std::move(ray);
  result->status = LcpStatus::kInfeasible;
  return true;
}

}  // namespace lcpbench
