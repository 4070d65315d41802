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

// @param for_bodies  of (row, action): calls action(the set of a body) for the bodies of a row that can move; all sets
//                    are empty, and will be
template <typename ForBodies>
void OrderByBodies(Index n, const ForBodies& for_bodies, std::vector<Index>* order) {
  const auto forbidden = [&](Index row) {
    ColourSet colours;
    for_bodies(row, [&](const ColourSet* body) { colours.Insert(*body); });
    return colours;
  };
  Order(
      n, forbidden, [&](Index row, Index colour) { for_bodies(row, [&](ColourSet* body) { body->Insert(colour); }); },
      [&](Index row) { for_bodies(row, [](ColourSet* body) { *body = {}; }); }, order);
}

void OrderByBodies(const LcpProblem& problem, std::vector<Index>* order) {
  const Index width = problem.columns_per_body();
  std::vector<ColourSet> on_body(At(problem.J().cols() / width + 1));
  const auto for_bodies = [&](Index row, const auto& action) {
    Index last = -1;
    for (SparseMatrix::InnerIterator it(problem.J(), row); it; ++it) {
      if (it.col() / width == last || it.value() == 0 || problem.inverse_mass()[it.col()] == 0) continue;
      last = it.col() / width;
      action(&on_body[At(last)]);
    }
  };
  OrderByBodies(problem.size(), for_bodies, order);
}

void OrderByEntries(const LcpProblem& problem, std::vector<Index>* order) {
  constexpr Index kNone = -1;
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
      [&](Index row) { colour_of[At(row)] = kNone; }, order);
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

std::vector<Index> ColouredOrder(const LcpProblem& problem, bool by_bodies) {
  std::vector<Index> order;
  by_bodies ? OrderByBodies(problem, &order) : OrderByEntries(problem, &order);
  return order;
}

RowForm ReadRowForm(SettingsReader* reader) {
  const std::string form = reader->Choice("form", "auto", {"auto", "assembled", "matrix-free"});
  if (form == "assembled") return RowForm::kAssembled;
  return form == "matrix-free" ? RowForm::kMatrixFree : RowForm::kAuto;
}

void RowWork::Prepare(const LcpProblem& problem, RowForm form, bool coloured) {
  const bool factors = UsesFactors(problem, form, coloured);
  scaled.Reset(problem, coloured ? ColouredOrder(problem, factors) : std::vector<Index>());
  if (!factors) {
    of_problem_ = MakeAssembledRows(problem, scaled);
  } else if (problem.has_two_body_rows()) {
    two_body_rows.Reset(problem, scaled);
    of_problem_ = MakeTwoBodyRows(scaled, problem.columns_per_body(), true, &two_body_rows);
  } else {
    of_problem_ = MakeFactorRows(problem, scaled);
  }
  x.f.setZero(scaled.size);
  x.image.resize(of_problem_->ImageSize());
  SetRows(of_problem_.get());
}

bool RowWork::Take(const StepRows& step, bool coloured) {
  const Index n = step.rows;
  scaled.Reserve(n);
  if (on_body_.size() < At(step.bodies)) {
    on_body_.resize(At(step.bodies));
    all_bodies_.resize(At(step.bodies));
    std::iota(all_bodies_.begin(), all_bodies_.end(), 0);
  }
  if (coloured) {
    const auto for_bodies = [&](Index row, const auto& action) {
      for (Index side = 2 * row; side < 2 * row + 2; ++side) {
        if (step.body[side] >= 0) action(&on_body_[At(step.body[side])]);
      }
    };
    OrderByBodies(n, for_bodies, &scaled.order);
  } else {
    scaled.order.resize(At(n));
    std::iota(scaled.order.begin(), scaled.order.end(), 0);
  }
  scaled.Take(step);
  const std::span<const std::int32_t> bodies(all_bodies_.data(), At(step.bodies));
  if (!two_body_rows.Take(step, bodies, all_bodies_.data(), &scaled)) return false;
  std::unique_ptr<RowKernel>& of_steps = step.columns_per_body == 3 ? in_plane_ : in_space_;
  if (of_steps == nullptr) of_steps = MakeTwoBodyRows(scaled, step.columns_per_body, true, &two_body_rows);
  SetRows(of_steps.get());
  return true;
}

void RowWork::SetRows(RowKernel* kernel) {
  rows_ = kernel;
  rows = kernel;
  kernel->SetRows();
  if (x.f.size() < scaled.size) x.f.setZero(scaled.size);
  if (x.image.size() < kernel->ImageSize()) x.image.resize(kernel->ImageSize());
  kernel->StartImage(&x.image);
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
