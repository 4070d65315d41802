#include "solvers/first_order/sweeps/row_kernel.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

namespace lcpbench {
namespace {

// Rows get the first colour that is not in forbidden(row), and set(row, colour) takes note of it; clear(row) forgets it
// when the row's block is over.
template <typename Forbidden, typename Set, typename Clear>
void Order(Index n, const Forbidden& forbidden, const Set& set, const Clear& clear, std::vector<Index>* order) {
  order->resize(At(n));
  std::array<Index, At(kColourBlock)> colour;
  std::array<Index, At(kColourBlock) + 1> first;  // of each colour its first place
  for (Index begin = 0; begin < n; begin += kColourBlock) {
    const Index size = std::min(n - begin, kColourBlock);
    std::fill_n(first.begin(), size + 1, 0);
    for (Index k = 0; k < size; ++k) {
      set(begin + k, colour[At(k)] = forbidden(begin + k).FirstAbsent());
      ++first[At(colour[At(k)]) + 1];
    }
    std::partial_sum(first.begin(), first.begin() + size + 1, first.begin());
    for (Index k = 0; k < size; ++k) (*order)[At(begin + first[At(colour[At(k)])]++)] = begin + k;
    for (Index k = 0; k < size; ++k) clear(begin + k);
  }
}

// @param on_body  by body, none of a colour between calls
void OrderByBodies(const StepRows& step, std::vector<ColourSet>* on_body, std::vector<Index>* order) {
  const auto for_bodies = [&](Index row, const auto& action) {
    for (Index side = 2 * row; side < 2 * row + 2; ++side) {
      if (step.body[side] >= 0) action(&(*on_body)[At(step.body[side])]);
    }
  };
  const auto forbidden = [&](Index row) {
    ColourSet colours;
    for_bodies(row, [&](const ColourSet* body) { colours.Insert(*body); });
    return colours;
  };
  Order(
      step.rows, forbidden,
      [&](Index row, Index colour) { for_bodies(row, [&](ColourSet* body) { body->Insert(colour); }); },
      [&](Index row) { for_bodies(row, [](ColourSet* body) { *body = {}; }); }, order);
}

std::vector<Index> OrderByEntries(const LcpProblem& problem) {
  constexpr Index kNone = -1;
  std::vector<Index> order;
  std::vector<Index> colour_of(At(problem.size()), kNone);
  const auto forbidden = [&](Index row) {
    ColourSet colours;
    for (SparseMatrix::InnerIterator it(problem.SparseA(), row); it; ++it) {
      if (it.value() != 0 && colour_of[At(it.col())] != kNone) colours.Insert(colour_of[At(it.col())]);
    }
    return colours;
  };
  Order(
      problem.size(), forbidden, [&](Index row, Index colour) { colour_of[At(row)] = colour; },
      [&](Index row) { colour_of[At(row)] = kNone; }, &order);
  return order;
}

// Entries of A per row (as BoundEntriesOfA counts them) up to which a sweep over A is at least as fast as one over J:
// measured, 0.6 ns per entry of A against 5 to 6 ns per two-body row in the given order and 1.5 to 2 ns in a coloured
// one.
constexpr Index kAssembledRowLimit = 14;
constexpr Index kAssembledRowLimitColoured = 4;

bool UsesFactors(const LcpProblem& problem, RowForm form, bool coloured) {
  if (form != RowForm::kAuto) return form == RowForm::kMatrixFree;
  const Index limit = coloured ? kAssembledRowLimitColoured : kAssembledRowLimit;
  return problem.has_two_body_rows() && BoundEntriesOfA(problem) > limit * problem.size();
}

}  // namespace

RowKernel::~RowKernel() = default;

void RowKernel::SetRows() {}

void RowKernel::SetB() {}

std::unique_ptr<RowKernel> MakeTwoBodyRows(const ScaledProblem& scaled, Index p, bool in_sets, ScaledRows* rows,
                                           InstructionSet instructions) {
  static constexpr KernelTable<decltype(&NewTwoBodyRowsSse2)> kKernels{&NewTwoBodyRowsSse2, &NewTwoBodyRowsAvx2,
                                                                       &NewTwoBodyRowsAvx512};
  return std::unique_ptr<RowKernel>(FindKernel(kKernels, instructions)(scaled, p, in_sets, rows));
}

RowForm ReadRowForm(SettingsReader* reader) {
  const std::string form = reader->Choice("form", "auto", {"auto", "assembled", "matrix-free"});
  if (form == "assembled") return RowForm::kAssembled;
  return form == "matrix-free" ? RowForm::kMatrixFree : RowForm::kAuto;
}

void RowWork::Prepare(const LcpProblem& problem, RowForm form, bool coloured, const StepRows* step) {
  const bool factors = UsesFactors(problem, form, coloured);
  if (!factors || step == nullptr || !Take(*step, coloured)) {
    scaled.Reset(problem, coloured && !factors ? OrderByEntries(problem) : std::vector<Index>());
    of_problem_ = factors ? MakeFactorRows(problem, scaled) : MakeAssembledRows(problem, scaled);
    SetRows(of_problem_.get());
  }
  x.f.setZero(scaled.size);
  x.image.resize(rows->ImageSize());
  rows->StartImage(&x.image);
}

bool RowWork::Take(const StepRows& step, bool coloured) {
  scaled.Reserve(step.rows);
  if (on_body_.size() < At(step.bodies)) {
    on_body_.resize(At(step.bodies));
    all_bodies_.resize(At(step.bodies));
    std::iota(all_bodies_.begin(), all_bodies_.end(), 0);
  }
  if (coloured) {
    OrderByBodies(step, &on_body_, &scaled.order);
  } else {
    scaled.order.resize(At(step.rows));
    std::iota(scaled.order.begin(), scaled.order.end(), 0);
  }
  scaled.Take(step);
  const std::span<const std::int32_t> bodies(all_bodies_.data(), At(step.bodies));
  if (!two_body_rows.Take(step, bodies, all_bodies_.data(), &scaled)) return false;
  std::unique_ptr<RowKernel>& of_steps = step.columns_per_body == 3 ? in_plane_ : in_space_;
  if (of_steps == nullptr) of_steps = MakeTwoBodyRows(scaled, step.columns_per_body, true, &two_body_rows);
  SetRows(of_steps.get());
  if (x.f.size() < scaled.size) x.f.resize(scaled.size);
  if (x.image.size() < rows->ImageSize()) x.image.resize(rows->ImageSize());
  return true;
}

void RowWork::SetRows(RowKernel* kernel) {
  rows_ = kernel;
  rows = kernel;
  kernel->SetRows();
}

void RowWork::Start(const double* given_b, const Eigen::VectorXd* initial_f) {
  scaled.SetB(given_b);
  rows_->SetB();
  scaled.Start(initial_f == nullptr ? nullptr : initial_f->data(), &x.f);
}

std::string WhyNoRows(const LcpProblem& problem, RowForm form) {
  if (problem.has_factors()) return {};
  if (form == RowForm::kMatrixFree) return "the matrix-free form needs a problem given by factors";
  Index row = 0;
  const bool is_negative = problem.size() > 0 && problem.DiagonalA().minCoeff(&row) < 0;
  return is_negative ? "A has a negative diagonal entry in row " + std::to_string(row) : "";
}

}  // namespace lcpbench
