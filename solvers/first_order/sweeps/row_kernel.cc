#include "solvers/first_order/sweeps/row_kernel.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numeric>
#include <utility>
#include <vector>

#include "support/array_index.h"

namespace lcpbench {
namespace {

// As many colours as a block has rows always suffice.
class ColourSet {
 public:
  void Insert(Index colour) { words_[At(colour / kBits)] |= std::uint64_t{1} << (colour % kBits); }
  void Insert(const ColourSet& other) {
    for (size_t word = 0; word < words_.size(); ++word) words_[word] |= other.words_[word];
  }
  Index FirstAbsent() const {
    size_t word = 0;
    while (words_[word] == ~std::uint64_t{0}) ++word;
    return static_cast<Index>(word) * kBits + std::countr_one(words_[word]);
  }

 private:
  static constexpr Index kBits = 64;
  std::array<std::uint64_t, At(kColourBlock / kBits)> words_{};
};

// Rows get the first colour that is not in forbidden(row), and set(row, colour) takes note of it; clear(row) forgets it
// when the row's block is over.
template <typename Forbidden, typename Set, typename Clear>
std::vector<Index> Order(Index n, const Forbidden& forbidden, const Set& set, const Clear& clear) {
  std::vector<Index> order(At(n));
  std::iota(order.begin(), order.end(), 0);
  std::vector<Index> colour(At(n));
  for (Index begin = 0; begin < n; begin += kColourBlock) {
    const Index end = std::min(n, begin + kColourBlock);
    for (Index row = begin; row < end; ++row) set(row, colour[At(row)] = forbidden(row).FirstAbsent());
    for (Index row = begin; row < end; ++row) clear(row);
    std::sort(order.begin() + begin, order.begin() + end,
              [&](Index a, Index b) { return colour[At(a)] != colour[At(b)] ? colour[At(a)] < colour[At(b)] : a < b; });
  }
  return order;
}

std::vector<Index> OrderByBodies(const LcpProblem& problem) {
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
  const auto forbidden = [&](Index row) {
    ColourSet colours;
    for_bodies(row, [&](const ColourSet* body) { colours.Insert(*body); });
    return colours;
  };
  return Order(
      problem.size(), forbidden,
      [&](Index row, Index colour) { for_bodies(row, [&](ColourSet* body) { body->Insert(colour); }); },
      [&](Index row) { for_bodies(row, [](ColourSet* body) { *body = {}; }); });
}

std::vector<Index> OrderByEntries(const LcpProblem& problem) {
  constexpr Index kNone = -1;
  std::vector<Index> colour_of(At(problem.size()), kNone);
  const auto forbidden = [&](Index row) {
    ColourSet colours;
    for (SparseMatrix::InnerIterator it(problem.SparseA(), row); it; ++it) {
      if (it.value() != 0 && colour_of[At(it.col())] != kNone) colours.Insert(colour_of[At(it.col())]);
    }
    return colours;
  };
  return Order(
      problem.size(), forbidden, [&](Index row, Index colour) { colour_of[At(row)] = colour; },
      [&](Index row) { colour_of[At(row)] = kNone; });
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

void RowKernel::SetB() {}

std::unique_ptr<RowKernel> MakeTwoBodyRows(const ScaledProblem& scaled, Index p, bool in_sets, ScaledRows* rows,
                                           InstructionSet instructions) {
  static constexpr KernelTable<decltype(&NewTwoBodyRowsSse2)> kKernels{&NewTwoBodyRowsSse2, &NewTwoBodyRowsAvx2,
                                                                       &NewTwoBodyRowsAvx512};
  if (in_sets) rows->FindSets();
  return std::unique_ptr<RowKernel>(FindKernel(kKernels, instructions)(scaled, p, in_sets, rows));
}

std::vector<Index> ColouredOrder(const LcpProblem& problem, bool by_bodies) {
  return by_bodies ? OrderByBodies(problem) : OrderByEntries(problem);
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
    rows = MakeAssembledRows(problem, scaled);
  } else if (problem.has_two_body_rows()) {
    two_body_rows.Reset(problem, scaled);
    rows = MakeTwoBodyRows(scaled, problem.columns_per_body(), true, &two_body_rows);
  } else {
    rows = MakeFactorRows(problem, scaled);
  }
  x.f.setZero(scaled.size);
  x.image.resize(rows->ImageSize());
  rows->StartImage(&x.image);
}

void RowWork::Start(const LcpProblem& problem, const Eigen::VectorXd* initial_f) {
  scaled.SetB(problem.b().data());
  rows->SetB();
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
