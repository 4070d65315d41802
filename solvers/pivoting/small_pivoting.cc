#include "solvers/pivoting/small_pivoting.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "solvers/linear_algebra/tableau_rules.h"
#include "solvers/rows/two_body_product.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

using Index = Eigen::Index;

// Bodies in space have so many columns.
constexpr Index kMostColumnsPerBody = 6;
constexpr Index kMostWidth = 8;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
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
    : one_(instructions),
      of_few_rows_(FindKernel(kKernels, ForFewRows(instructions))),
      of_many_rows_(FindKernel(kKernels, instructions)) {
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
  std::fill(work_.matrix, RowOfA(n), 0.0);
}

// Row i of what is solved is row given(i) of the problem.
template <typename Given>
SmallPivoting::Answer SmallPivoting::SolveLoaded(const Given& given, const Request& request, double* f, double* w) {
  work_.guess_count = 0;
  for (int i = 0, k = 0; i < work_.n && request.initial_f != nullptr; ++i) {
    const bool is_joint = k < work_.joint_count && work_.joints[k] == i;
    if (is_joint) ++k;
    if (is_joint || request.initial_f[given(i)] > 0) work_.guess[work_.guess_count++] = i;
  }
  work_.row_limit = request.row_limit;
  work_.clock = work_.n > kRowsWithoutClock ? request.deadline : nullptr;
  if (!kernel_->solve(&work_)) return {kInfinity, kInfinity, false, false};
  const double inverse_b_scale = 1 / work_.b_scale;
  for (Index i = 0; i < work_.n; ++i) f[given(i)] = work_.force[i] * (work_.scale[i] * inverse_b_scale);
  for (Index i = 0; i < work_.n && w != nullptr; ++i) w[given(i)] = work_.w[i] * (inverse_b_scale / work_.scale[i]);
  return {work_.rho, work_.rounding, work_.rows_meet, work_.rows_are_clear};
}

// Row i of what is solved is row given(i) of the problem; fill(i, row) writes its entries over zeros.
template <typename Given, typename Joint, typename Fill>
void SmallPivoting::Load(Index n, const Given& given, const double* diagonal, const double* b, const Joint& is_joint,
                         const Fill& fill) {
  SetSize(n);
  for (int i = 0; i < work_.n; ++i) {
    work_.diagonal[i] = diagonal[given(i)];
    work_.b[i] = b[given(i)];
    if (is_joint(given(i))) work_.joints[work_.joint_count++] = i;
    fill(i, RowOfA(i));
  }
}

SmallPivoting::Answer SmallPivoting::Solve(const LcpProblem& problem, const Request& request, Eigen::VectorXd* f) {
  const auto given = [](Index i) { return i; };
  const Eigen::MatrixXd& A = problem.DenseA();
  // A is symmetric, so its columns serve as rows.
  Load(
      problem.size(), given, problem.DiagonalA().data(), problem.b().data(),
      [&](Index i) { return problem.is_bilateral(i); },
      [&](Index i, double* row) { std::copy_n(A.col(i).data(), A.rows(), row); });
  work_.is_assembled = problem.has_factors();
  return SolveLoaded(given, request, f->data(), nullptr);
}

SmallPivoting::Answer SmallPivoting::SolvePart(const LcpProblem& problem, std::span<const Index> rows,
                                               const Request& request, Eigen::VectorXd* f) {
  const auto given = [rows](Index i) { return rows[At(i)]; };
  const SparseMatrix& A = problem.SparseA();
  for (size_t i = 0; i < rows.size(); ++i) local_[At(rows[i])] = static_cast<int>(i);
  Load(
      std::ssize(rows), given, problem.DiagonalA().data(), problem.b().data(),
      [&](Index i) { return problem.is_bilateral(i); },
      [&](Index i, double* row) {
        for (SparseMatrix::InnerIterator it(A, given(i)); it; ++it) {
          // Rows that are no part of this island are left out of it: they carry no force.
          const Index j = local_[At(it.col())];
          if (j < work_.n && given(j) == it.col()) row[j] = it.value();
        }
      });
  work_.is_assembled = problem.has_factors();
  return SolveLoaded(given, request, f->data(), nullptr);
}

SmallPivoting::Answer SmallPivoting::SolveMatrix(const MatrixArrays& A, const Request& request, double* f) {
  const auto given = [](Index i) { return i; };
  Load(
      A.size(), given, A.diagonal().data(), A.arrays().b.data(), [&](Index i) { return A.is_joint(i); },
      [&](Index i, double* row) { A.ForEntries(i, [row](Index j, double a) { row[j] = a; }); });
  work_.is_assembled = false;
  return SolveLoaded(given, request, f, nullptr);
}

SmallPivoting::Answer SmallPivoting::SolveDense(Index m, const double* A, const double* diagonal, const double* b,
                                                const unsigned char* bilateral, const Request& request, double* f) {
  const auto given = [](Index i) { return i; };
  Load(
      m, given, diagonal, b, [&](Index i) { return bilateral[i] != 0; },
      [&](Index i, double* row) { std::copy_n(A + i * m, m, row); });
  return SolveLoaded(given, request, f, nullptr);
}

SmallPivoting::End SmallPivoting::SolveRows(const StepRows& all, std::span<const std::int32_t> part, double tolerance,
                                            Request request, RowJudge* judge, double* f, double* w, double* rho) {
  request.row_limit = tableau::kMargin * std::sqrt(tolerance);
  work_.pivots = 0;
  if (part.size() == 1 && one_.Solve(all, part, tolerance, request.row_limit, f, w, rho)) return End::kSolved;
  SetSize(std::ssize(part));
  WithNumbers(all, [&](const auto* J, auto p) {
    AssembleByBodies<p>(all, J, part, work_.matrix, work_.stride, jacobian_.data(), &sides_, [](Index, Index) {});
  });
  for (int i = 0; i < work_.n; ++i) {
    const Index row = part[At(i)];
    work_.b[i] = all.b[row];
    work_.diagonal[i] = RowOfA(i)[i];
    if (all.bilateral != nullptr && all.bilateral[row] != 0) work_.joints[work_.joint_count++] = i;
  }
  const Answer found = SolveLoaded([part](Index i) { return Index{part[At(i)]}; }, request, f, w);
  *rho = found.rho;
  const Answer::Judgement judgement = found.Judge(tolerance);
  if (judgement == Answer::Judgement::kRight) return End::kSolved;
  const bool is_unclear = judgement == Answer::Judgement::kUnclear;
  if (is_unclear && judge->Passes(all, part, tolerance, f, w, rho)) return End::kSolved;
  return std::isfinite(found.rho) ? End::kInexact : End::kGaveUp;
}

}  // namespace lcpbench
