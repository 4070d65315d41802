#include "solvers/exact/exact_pivoting.h"

#include <algorithm>

#include "solvers/exact/flint_matrix.h"

namespace lcpbench {
namespace {

// Blocks in a row that may leave as many rows violated, before least indices.
constexpr int kPatienceOfPivots = 3;
// Dependent rows that are tried as the last one of a guessed ray.
constexpr size_t kMostRayTries = 16;

}  // namespace

// The rows that are wanted, as far as they are independent, bilateral ones first.
void ExactPivoting::SetBasis(const std::vector<Index>& wanted) {
  std::vector<Index> rows = wanted;
  std::stable_partition(rows.begin(), rows.end(), [this](Index i) { return is_bilateral(i); });
  basis_ = IndependentRows(A_, rows);
  in_basis_.assign(At(size()), 0);
  for (const Index i : basis_) in_basis_[At(i)] = 1;
}

void ExactPivoting::SolveBasis() {
  ++solves_;
  const IntegerMatrix x = Numerators(Solve(Block(A_, basis_, basis_), Block(b_, basis_, {0})), &denominator_);  // -f_F
  f_ = IntegerMatrix(size(), 1);
  w_ = IntegerMatrix(size(), 1);
  for (size_t k = 0; k < basis_.size(); ++k) fmpz_neg(f_.at(basis_[k], 0), x.at(static_cast<Index>(k), 0));
  for (Index i = 0; i < size(); ++i) {
    if (in_basis(i)) continue;
    fmpz_mul(w_.at(i, 0), b_.at(i, 0), denominator_.get());
    for (const Index j : basis_) fmpz_addmul(w_.at(i, 0), A_.at(i, j), f_.at(j, 0));
  }
}

std::vector<Index> ExactPivoting::Violated() const {
  std::vector<Index> violated;
  for (Index i = 0; i < size(); ++i) {
    const bool wrong = is_bilateral(i) ? fmpz_is_zero(w_.at(i, 0)) == 0
                       : in_basis(i)   ? fmpz_sgn(f_.at(i, 0)) < 0
                                       : fmpz_sgn(w_.at(i, 0)) < 0;
    if (wrong) violated.push_back(i);
  }
  return violated;
}

void ExactPivoting::Exchange(const std::vector<Index>& violated) {
  std::vector<char> leaves(At(size()), 0);
  for (const Index i : violated) leaves[At(i)] = in_basis_[At(i)];
  std::vector<Index> wanted;
  for (const Index i : basis_) {
    if (leaves[At(i)] == 0) wanted.push_back(i);
  }
  for (const Index i : violated) {
    if (!in_basis(i)) wanted.push_back(i);
  }
  SetBasis(wanted);
}

// y = (d, 1) on the independent rows and k, A y = 0; turned so that b.y < 0. False where b.y = 0 or a sign is wrong.
bool ExactPivoting::MakeRay(const std::vector<Index>& independent, Index k, const RationalMatrix& d) {
  std::vector<Rational> y(At(size()));
  y[At(k)] = 1;
  for (size_t r = 0; r < independent.size(); ++r) y[At(independent[r])] = -ToRational(d.at(static_cast<Index>(r), 0));
  Rational b_dot_y = 0;
  for (Index i = 0; i < size(); ++i) {
    if (y[At(i)] != 0) b_dot_y += ToRational(b_.at(i, 0)) * y[At(i)];
  }
  if (b_dot_y == 0) return false;
  if (b_dot_y > 0) {
    for (Rational& value : y) value = -value;
  }
  for (Index i = 0; i < size(); ++i) {
    if (!is_bilateral(i) && y[At(i)] < 0) return false;
  }
  ray_ = std::move(y);
  return true;
}

ExactPivoting::End ExactPivoting::PivotOnLeastIndex(Index k) {
  std::vector<Index> wanted = basis_;
  if (in_basis(k)) {
    wanted.erase(std::find(wanted.begin(), wanted.end(), k));
    SetBasis(wanted);
    return End::kSolved;
  }
  // A column of the tableau: d = A_FF^-1 A_Fk, and the pivot.
  ++solves_;
  const RationalMatrix d = Solve(Block(A_, basis_, basis_), Block(A_, basis_, {k}));
  const int sign = SchurDiagonal(A_, basis_, d, 0, k).sign();
  if (sign < 0) return End::kNotSemidefinite;
  if (sign == 0) {
    // The force at k moves no gap: another row leaves for it, or nothing bounds it and y = (-d, 1) is a ray.
    Index leaving = size();
    for (size_t r = 0; r < basis_.size(); ++r) {
      if (is_bilateral(basis_[r]) || fmpq_sgn(d.at(static_cast<Index>(r), 0)) <= 0) continue;
      leaving = std::min(leaving, basis_[r]);
    }
    if (is_bilateral(k) || leaving == size()) {
      return MakeRay(basis_, k, d) ? End::kRay : End::kNotSemidefinite;
    }
    wanted.erase(std::find(wanted.begin(), wanted.end(), leaving));
  }
  wanted.push_back(k);
  SetBasis(wanted);
  return End::kSolved;
}

ExactPivoting::End ExactPivoting::Pivot(const std::vector<char>& start, const Deadline& deadline,
                                        std::int64_t most_solves) {
  const std::int64_t solves_before = solves_;
  std::vector<Index> wanted;
  for (Index i = 0; i < size(); ++i) {
    if (is_bilateral(i) || start[At(i)] != 0) wanted.push_back(i);
  }
  SetBasis(wanted);
  size_t least = At(size()) + 1;
  int patience = kPatienceOfPivots;
  for (;;) {
    if (deadline.Expired()) return End::kTimeLimit;
    if (most_solves > 0 && solves_ - solves_before >= most_solves) return End::kSolveLimit;
    SolveBasis();
    const std::vector<Index> violated = Violated();
    if (violated.empty()) return End::kSolved;
    // What joints alone contradict, no contact mends.
    const auto joint = std::find_if(violated.begin(), violated.end(), [this](Index i) { return is_bilateral(i); });
    if (joint == violated.end() && violated.size() < least) {
      least = violated.size();
      patience = kPatienceOfPivots;
    } else {
      patience = std::max(patience - 1, 0);
    }
    if (joint == violated.end() && patience > 0) {
      Exchange(violated);
      continue;
    }
    const End end = PivotOnLeastIndex(joint != violated.end() ? *joint : violated.front());
    if (end != End::kSolved) return end;
  }
}

bool ExactPivoting::TryRay(const std::vector<char>& support) {
  const std::vector<Index> rows = Marked(support);
  const std::vector<Index> independent = IndependentRows(A_, rows);
  size_t tries = 0;
  for (const Index k : rows) {
    if (std::find(independent.begin(), independent.end(), k) != independent.end()) continue;
    if (++tries > kMostRayTries) return false;
    ++solves_;
    if (!AllDepend(A_, independent, {k})) continue;
    if (MakeRay(independent, k, Solve(Block(A_, independent, independent), Block(A_, independent, {k})))) return true;
  }
  return false;
}

}  // namespace lcpbench
