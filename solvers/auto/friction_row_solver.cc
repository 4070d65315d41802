#include "solvers/auto/friction_row_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "solvers/friction/few_contacts.h"
#include "solvers/lcp/number_range.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// Rounds of the relaxation, the first unshifted; in islands without one, Newton steps from 0.
constexpr int kRounds = 4;
constexpr unsigned kSeeds = 2;  // of Lemke's paths
constexpr ModeSteps::Limits kCold{.steps = 30, .eps = 1e-8};
// rho of several islands together is at most 2^1/2 times that of one: S of the whole has another least (SetScale).
constexpr double kPartOfTolerance = 0.7;

}  // namespace

FrictionRowSolver::FrictionRowSolver(RowSolver* plain)
    : plain_(*plain),
      rounds_([this](const FrictionAnswer& answer, const Eigen::VectorXd& shift, const Eigen::VectorXd* start,
                     Eigen::VectorXd* f) { return Relax(answer, shift, start, f); }) {}

void FrictionRowSolver::Reserve(Index max_rows, Index max_bodies) {
  if (max_rows <= reserved_rows_ && max_bodies <= reserved_bodies_) return;
  max_rows = reserved_rows_ = std::max(max_rows, reserved_rows_);
  max_bodies = reserved_bodies_ = std::max(max_bodies, reserved_bodies_);
  plain_.Reserve(max_rows, max_bodies);
  islands_.Reserve(max_rows, max_bodies);
  const auto known = static_cast<std::int32_t>(all_.size());
  all_.resize(At(max_rows));
  std::iota(all_.begin() + known, all_.end(), known);
  for (std::vector<std::int32_t>* const numbers : {&law_, &place_}) numbers->resize(At(max_rows));
  // A step without friction is relaxed as a whole.
  relaxed_.Reserve(max_rows);
  constexpr Index kMostColumns = 12;  // two bodies in space
  relaxed_body_.reserve(At(2 * max_rows));
  relaxed_J_.reserve(At(kMostColumns * max_rows));
  relaxed_bilateral_.reserve(At(max_rows));
  for (std::vector<double>* const numbers : {&relaxed_b_, &relaxed_f_, &relaxed_w_, &relaxed_start_}) {
    numbers->reserve(At(max_rows));
  }
  friction_.reserve(At(max_rows));
  bounded_.reserve(At(max_rows));
  const Index most = std::min(max_rows, kMostRows);
  contacts_.Reserve(most, max_bodies);
  newton_.Reserve(most);
  path_.Reserve(most);
  rounds_.Reserve(most);
  for (Eigen::VectorXd* const numbers : {&start_, &phi_, &loads_, &room_.phi, &room_.gaps, &room_.f, &result_.f}) {
    ContactRows::Lengthen(most, numbers);
  }
}

// Whether the lists are such as LcpProblem takes, which tells what is wrong otherwise.
bool FrictionRowSolver::TakeLaws(const StepRows& rows) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::fill_n(law_.begin(), rows.rows, -1);
  const auto is_joint = [&](Index row) { return rows.bilateral != nullptr && rows.bilateral[row] != 0; };
  const auto is_row = [&](Index row) { return row >= 0 && row < rows.rows && !is_joint(row); };
  for (std::size_t k = 0; k < rows.friction.size(); ++k) {
    const FrictionRow& row = rows.friction[k];
    const bool is_in_range = is_row(row.row) && is_row(row.normal) && row.mu >= 0 &&
                             row.mu <= std::numeric_limits<double>::max() && row.slip >= -1 && row.slip <= 1;
    if (!is_in_range || law_[At(row.row)] >= 0) return false;
    law_[At(row.row)] = static_cast<std::int32_t>(k);
  }
  for (std::size_t k = 0; k < rows.bounded.size(); ++k) {
    const BoundedRow& row = rows.bounded[k];
    const bool is_in_range = row.lower <= row.upper && row.lower < kInfinity && row.upper > -kInfinity;
    if (!is_row(row.row) || !is_in_range || law_[At(row.row)] >= 0) return false;
    law_[At(row.row)] = static_cast<std::int32_t>(rows.friction.size() + k);
  }
  return std::ranges::all_of(rows.friction, [&](const FrictionRow& row) { return law_[At(row.normal)] < 0; });
}

RowAnswer FrictionRowSolver::Solve(const StepRows& rows, double tolerance, const Deadline* deadline,
                                   const double* initial_f, double* f, double* w) {
  RowAnswer answer;
  method_ = "";
  rows_of_method_ = 0;
  // As many friction rows as others: the check of the laws is its own.
  if (rows.bounded.empty() && TakeFew(rows, rows.rows, rows.friction, tolerance, initial_f, f, w, &answer)) {
    answer.solved = true;
    return answer;
  }
  const bool has_friction = std::ranges::any_of(rows.friction, [](const FrictionRow& row) { return row.mu > 0; });
  if (!has_friction || !TakeLaws(rows)) return answer;
  step_ = &rows;
  deadline_ = deadline;
  options_.tolerance = tolerance;
  if (rows.rows <= ModeSteps::kFewRows) {
    answer.solved = SolvePart({all_.data(), At(rows.rows)}, initial_f, f, w, &answer);
    return answer;
  }
  islands_.Find(rows);
  answer.fits = islands_.largest() <= kMostRows;
  answer.solved = answer.fits;
  if (islands_.count() > 1) options_.tolerance *= kPartOfTolerance;
  for (Index k = 0; k < islands_.count() && answer.solved; ++k) {
    answer.solved = SolvePart(islands_.rows(k), initial_f, f, w, &answer) &&
                    (k + 1 == islands_.count() || deadline == nullptr || !deadline->Expired());
  }
  return answer;
}

// Few contacts alone: the rows of `friction`, as many others, and none besides.
bool FrictionRowSolver::TakeFew(const StepRows& rows, Index size, std::span<const FrictionRow> friction,
                                double tolerance, const double* initial_f, double* f, double* w, RowAnswer* answer) {
  double rho = 0;
  if (!FewContacts::Solve(rows, size, friction, tolerance, initial_f, f, w, &rho, &answer->iterations)) return false;
  answer->rho = std::max(answer->rho, rho);
  NameMethod("modes", size);
  return true;
}

void FrictionRowSolver::NameMethod(const char* method, Index size) {
  if (size > rows_of_method_) method_ = method;
  rows_of_method_ = std::max(rows_of_method_, size);
}

bool FrictionRowSolver::SolvePart(Part part, const double* initial_f, double* f, double* w, RowAnswer* answer) {
  const Index n = std::ssize(part);
  friction_.clear();
  for (const std::int32_t row : part) {
    const std::int32_t law = law_[At(row)];
    if (law >= 0 && law < std::ssize(step_->friction)) friction_.push_back(step_->friction[At(law)]);
  }
  if (n < step_->rows && TakeFew(*step_, n, friction_, options_.tolerance, initial_f, f, w, answer)) return true;
  TakePart(part);
  options_.initial_f = initial_f == nullptr ? nullptr : &start_;
  for (Index i = 0; i < n && initial_f != nullptr; ++i) start_[i] = initial_f[part[At(i)]];
  options_.time_limit_s = deadline_ == nullptr ? std::numeric_limits<double>::infinity() : deadline_->Remaining();
  result_.status = LcpStatus::kNumericalFailure;
  result_.iterations = 0;
  result_.f.head(n).setZero();
  FrictionAnswer found(contacts_, nullptr, options_, &result_, &room_);
  const char* const method = Ask(&found);
  answer->iterations += result_.iterations;
  if (method == nullptr) return false;
  NameMethod(method, n);
  answer->rho = std::max(answer->rho, found.rho());
  for (Index i = 0; i < n; ++i) f[part[At(i)]] = result_.f[i];
  if (w == nullptr) return true;
  contacts_.ComputeGapsOf(result_.f, &phi_);
  for (Index i = 0; i < n; ++i) w[part[At(i)]] = phi_[i];
  return true;
}

// Laws and rows of a part, whose friction rows are in friction_.
void FrictionRowSolver::TakePart(Part part) {
  bounded_.clear();
  const auto count = std::ssize(step_->friction);
  for (std::size_t i = 0; i < part.size(); ++i) {
    place_[At(part[i])] = static_cast<std::int32_t>(i);
    const std::int32_t law = law_[At(part[i])];
    if (law >= count) bounded_.emplace_back(step_->bounded[At(law - count)]).row = static_cast<Index>(i);
  }
  for (FrictionRow& row : friction_) {
    row.row = place_[At(row.row)];
    row.normal = place_[At(row.normal)];
  }
  contacts_.Prepare(*step_, part, friction_, bounded_);
  part_ = part;
  relaxed_is_ready_ = false;
}

// The method that answered; nullptr if none did.
const char* FrictionRowSolver::Ask(FrictionAnswer* answer) {
  newton_.Reset();
  if (const char* method = newton_.Begin(contacts_, answer)) return method;
  if (contacts_.can_relax()) {
    rounds_.Start(contacts_);
    if (const char* method = rounds_.Run(contacts_, kRounds, &newton_, &phi_, answer)) return method;
    if (!rounds_.is_solved()) return nullptr;
  } else {
    phi_.head(contacts_.size()).setZero();
    if (newton_.Run(contacts_, kCold, &phi_, answer)) return "mode-newton";
  }
  const bool is_right = contacts_.is_paired() && path_.Cover(contacts_, kSeeds, &newton_, &phi_, answer);
  return is_right ? "lemke" : nullptr;
}

// The relaxation's rows as those of a step. False where a friction row is on other bodies than its normal row, or a
// number is extreme.
bool FrictionRowSolver::TakeRelaxation() {
  const Index p = step_->columns_per_body;
  relaxed_.Set(std::ssize(part_), friction_);
  const Index m = relaxed_.size();
  relaxed_body_.assign(At(2 * m), -1);
  relaxed_J_.assign(At(2 * p * m), 0);
  relaxed_bilateral_.resize(At(m));
  for (std::vector<double>* const numbers : {&relaxed_b_, &relaxed_f_, &relaxed_w_, &relaxed_start_}) {
    numbers->resize(At(m));
  }
  bool fits = true;
  for (Index k = 0; k < m; ++k) {
    std::int32_t* const body = relaxed_body_.data() + 2 * k;
    double* const J = relaxed_J_.data() + 2 * p * k;
    const auto add = [&](Index row, double factor) {
      for (Index side = 2 * row; side < 2 * row + 2; ++side) {
        const std::int32_t of = step_->body[side];
        if (of < 0) continue;
        const Index to = body[0] < 0 || body[0] == of ? 0 : 1;
        fits = fits && (body[to] < 0 || body[to] == of);
        body[to] = of;
        for (Index c = 0; c < p; ++c) {
          const Index at = side * p + c;
          J[to * p + c] += factor * (step_->J != nullptr ? step_->J[at] : static_cast<double>(step_->J_single[at]));
        }
      }
    };
    const RelaxedRows::Row& row = relaxed_.rows()[At(k)];
    const std::int32_t normal = part_[At(row.normal)];
    add(normal, 1);
    if (row.tangent >= 0) add(part_[At(row.tangent)], row.factor);
    relaxed_bilateral_[At(k)] = step_->bilateral == nullptr ? 0 : step_->bilateral[normal];
  }
  relaxed_step_ = *step_;
  relaxed_step_.rows = m;
  relaxed_step_.body = relaxed_body_.data();
  relaxed_step_.J = relaxed_J_.data();
  relaxed_step_.J_single = nullptr;
  relaxed_step_.b = relaxed_b_.data();
  relaxed_step_.bilateral = step_->bilateral == nullptr ? nullptr : relaxed_bilateral_.data();
  relaxed_step_.friction = {};
  relaxed_step_.bounded = {};
  NumberRange range(kFactorRange);
  range.Look(relaxed_J_.data(), std::ssize(relaxed_J_));
  relaxed_is_ready_ = fits && !range.has_large() && (!range.has_small() || HasDiagonalInRange(relaxed_step_));
  return relaxed_is_ready_;
}

LcpStatus FrictionRowSolver::Relax(const FrictionAnswer& answer, const Eigen::VectorXd& shift,
                                   const Eigen::VectorXd* start, Eigen::VectorXd* f) {
  if (!relaxed_is_ready_ && !TakeRelaxation()) return LcpStatus::kUnsupported;
  for (Index i = 0; i < std::ssize(part_); ++i) loads_[i] = step_->b[part_[At(i)]] + shift[i];
  for (Index k = 0; k < relaxed_.size(); ++k) {
    const RelaxedRows::Row& row = relaxed_.rows()[At(k)];
    relaxed_b_[At(k)] = RelaxedRows::Load(row, loads_);
    if (start != nullptr) relaxed_start_[At(k)] = RelaxedRows::StartOf(row, *start);
  }
  NumberRange of_loads(kLoadRange);
  of_loads.Look(relaxed_b_.data(), relaxed_.size());
  if (!of_loads.is_within()) return LcpStatus::kUnsupported;
  const double* const initial_f = start == nullptr ? nullptr : relaxed_start_.data();
  const RowAnswer found =
      plain_.Solve(relaxed_step_, answer.tolerance(), deadline_, initial_f, relaxed_f_.data(), relaxed_w_.data());
  relaxed_.GetForces(relaxed_f_.data(), f);
  return found.solved ? LcpStatus::kSolved : LcpStatus::kUnsupported;
}

}  // namespace lcpbench
