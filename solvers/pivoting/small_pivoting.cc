#include "solvers/pivoting/small_pivoting.h"

#include <algorithm>

#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/rows/two_body_product.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

using Index = Eigen::Index;

// Bodies in space have so many columns.
constexpr Index kMostColumnsPerBody = 6;
constexpr Index kMostWidth = 8;
constexpr KernelTable<TableauKernel> kKernels{
    {2, &SolveTableauSse2}, {4, &SolveTableauAvx2}, {kMostWidth, &SolveTableauAvx512}};

// Up to so many rows the wider registers of AVX-512 have too much padding.
constexpr Index kFewRows = 12;
InstructionSet ForFewRows(InstructionSet instructions) {
  const bool has_choice = instructions == InstructionSet::kBest;
  return has_choice && FindInstructionSet(instructions) == InstructionSet::kAvx512 ? InstructionSet::kAvx2
                                                                                   : instructions;
}

Index InRegisters(Index n, Index width) { return (n + width - 1) / width * width; }

}  // namespace

SmallPivoting::Answer::Judgement SmallPivoting::Answer::Judge(double tolerance) const {
  // Rounding of this form may be all that is in the way; where it hides more than kMostRho, others do better.
  const double hidden = std::min(rounding, tableau::kMostRho);
  if (!(rho - hidden <= std::min(tableau::kMostRho, tolerance) && rows_meet)) return Judgement::kWrong;
  return rows_are_clear && rho + rounding <= tolerance ? Judgement::kRight : Judgement::kUnclear;
}

SmallPivoting::SmallPivoting(InstructionSet instructions, TableauRule rule)
    : of_few_rows_(FindKernel(kKernels, ForFewRows(instructions))), of_many_rows_(FindKernel(kKernels, instructions)) {
  work_.rule = rule;
  work_.is_late = [](const void* clock) { return static_cast<const Deadline*>(clock)->Expired(); };
}

void SmallPivoting::Reserve(Index max_rows, Index problem_rows) {
  if (static_cast<Index>(local_.size()) < problem_rows) local_.resize(At(problem_rows), 0);
  const Index room = InRegisters(max_rows, kMostWidth);
  double** const vectors[] = {&work_.diagonal,       &work_.b,           &work_.force,      &work_.w,
                              &work_.scale,          &work_.pivot,       &work_.q,          &work_.weight,
                              &work_.blocked_weight, &work_.side,        &work_.root,       &work_.inverse_root,
                              &work_.least_force,    &work_.correction,  &work_.cover,      &work_.exchange[0],
                              &work_.exchange[1],    &work_.exchange[2], &work_.exchange[3]};
  const Index size = 2 * room * room + std::ssize(vectors) * room;
  if (size <= numbers_.size()) return;
  numbers_.setZero(size);
  work_.matrix = numbers_.data();
  work_.tableau = work_.matrix + room * room;
  double* at = work_.tableau + room * room;
  for (double** const vector : vectors) {
    *vector = at;
    at += room;
  }
  integers_.resize(At(4 * room));
  work_.joints = integers_.data();
  work_.guess = work_.joints + room;
  work_.rows = work_.guess + room;
  work_.columns = work_.rows + room;
}

void SmallPivoting::ReserveRows(Index max_rows, Index max_bodies) {
  Reserve(max_rows);
  const std::size_t numbers = At(2 * max_rows * kMostColumnsPerBody);
  if (jacobian_.size() < numbers) jacobian_.resize(numbers);
  sides_.Reserve(max_rows, max_bodies);
}

void SmallPivoting::SetSize(Index n) {
  kernel_ = n <= kFewRows ? &of_few_rows_ : &of_many_rows_;
  work_.n = static_cast<int>(n);
  work_.stride = static_cast<int>(InRegisters(n, kernel_->width));
  work_.joint_count = 0;
  work_.is_assembled = true;
  std::fill(work_.diagonal + n, work_.diagonal + work_.stride, 1.0);
  std::fill(work_.b + n, work_.b + work_.stride, 0.0);
}

void SmallPivoting::LoadDense(const LcpProblem& problem) {
  SetSize(problem.size());
  work_.is_assembled = problem.has_factors();
  const Index n = work_.n;
  std::copy_n(problem.DiagonalA().data(), n, work_.diagonal);
  std::copy_n(problem.b().data(), n, work_.b);
  for (const Index i : problem.bilateral_rows()) work_.joints[work_.joint_count++] = static_cast<int>(i);
  // A is symmetric, so its columns serve as rows.
  for (Index i = 0; i < n; ++i) {
    std::copy_n(problem.DenseA().col(i).data(), n, RowOfA(i));
    std::fill(RowOfA(i) + n, RowOfA(i) + work_.stride, 0.0);
  }
}

void SmallPivoting::LoadPart(const LcpProblem& problem, std::span<const Index> rows) {
  SetSize(static_cast<Index>(rows.size()));
  work_.is_assembled = problem.has_factors();
  for (int i = 0; i < work_.n; ++i) {
    const Index given = rows[At(i)];
    work_.diagonal[i] = problem.DiagonalA()[given];
    work_.b[i] = problem.b()[given];
    local_[At(given)] = i;
    if (problem.is_bilateral(given)) work_.joints[work_.joint_count++] = i;
  }
  std::fill(work_.matrix, RowOfA(work_.n), 0.0);
  for (Index i = 0; i < work_.n; ++i) {
    for (SparseMatrix::InnerIterator it(problem.SparseA(), rows[At(i)]); it; ++it) {
      // Rows that are no part of this island are left out of it: they carry no force.
      const Index j = local_[At(it.col())];
      if (j < work_.n && rows[At(j)] == it.col()) RowOfA(i)[j] = it.value();
    }
  }
}

void SmallPivoting::LoadArrays(const ProblemArrays& arrays, const double* diagonal) {
  SetSize(arrays.rows);
  work_.is_assembled = false;
  const Index n = work_.n;
  std::copy_n(diagonal, n, work_.diagonal);
  std::copy_n(arrays.b.data(), n, work_.b);
  for (int i = 0; i < work_.n && !arrays.bilateral.empty(); ++i) {
    if (arrays.bilateral[At(i)] != 0) work_.joints[work_.joint_count++] = i;
  }
  std::fill(work_.matrix, RowOfA(n), 0.0);
  for (Index i = 0; i < n; ++i) {
    if (arrays.form == MatrixForm::kDense) {
      std::copy_n(arrays.value.data() + i * n, n, RowOfA(i));
      continue;
    }
    for (auto e = At(arrays.row_start[At(i)]); e < At(arrays.row_start[At(i) + 1]); ++e) {
      RowOfA(i)[arrays.column[e]] = arrays.value[e];
    }
  }
}

void SmallPivoting::LoadRows(const StepRows& all, std::span<const std::int32_t> part) {
  WithNumbers(all, [&](const auto* J, auto p) { LoadRowsOf<p>(all, J, part); });
}

template <int p, typename Real>
void SmallPivoting::LoadRowsOf(const StepRows& all, const Real* J, std::span<const std::int32_t> part) {
  SetSize(static_cast<Index>(part.size()));
  std::fill(work_.matrix, RowOfA(work_.n), 0.0);
  AssembleByBodies<p>(all, J, part, work_.matrix, work_.stride, jacobian_.data(), &sides_, [](Index, Index) {});
  for (int i = 0; i < work_.n; ++i) {
    const Index row = part[At(i)];
    work_.b[i] = all.b[row];
    work_.diagonal[i] = RowOfA(i)[i];
    if (all.bilateral != nullptr && all.bilateral[row] != 0) work_.joints[work_.joint_count++] = i;
  }
}

}  // namespace lcpbench
