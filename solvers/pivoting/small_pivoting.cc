#include "solvers/pivoting/small_pivoting.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "solvers/linear_algebra/scaled_lcp.h"
#include "solvers/pivoting/tableau_rules.h"
#include "solvers/pivoting/vector_register.h"

namespace lcpbench {
namespace {

using Index = Eigen::Index;

size_t At(Index i) { return static_cast<size_t>(i); }

constexpr double kInfinity = std::numeric_limits<double>::infinity();
using tableau::kGoodEnough;
using tableau::kLeastPivot;
using tableau::kNoise;
// rho up to which a guess of the active set counts as right.
constexpr double kRightRho = 1e-13;
// Some microseconds of them.
constexpr int kPivotsPerClockRead = 8;

// rows += factor * p with factor = row[r], for rows of `count` registers; column r is set to factor * p[r].
template <int count>
void Eliminate(double* tableau, Index n, Index r, const double* pivot_row) {
  Register p[count];
  IntegerRegister is_r[count];
  for (int v = 0; v < count; ++v) {
    p[v] = AsRegisters(pivot_row)[v];
    is_r[v] = kFirstRows + kRegister * v == r;
  }
  for (Index i = 0; i < n; ++i) {
    double* row = tableau + i * count * kRegister;
    const double factor = row[r];
    for (int v = 0; v < count; ++v) {
      const Register others = is_r[v] ? Register{} : AsRegisters(row)[v];
      AsRegisters(row)[v] = others + factor * p[v];
    }
  }
}

// A row with both sides on one body has one side: the sum of both.
template <Index p>
double JoinSides(double* J, double* momentum, Index along, const double* mass, std::int64_t* second_body) {
  double d = 0;
  for (int c = 0; c < p; ++c) {
    const double j = J[c * along] + J[(p + c) * along];
    J[c * along] = j;
    momentum[c * along] = mass[c] * j;
    J[(p + c) * along] = momentum[(p + c) * along] = 0;
    d += mass[c] * (j * j);
  }
  *second_body = -1;
  return d;
}

// Active sets that are tried before the tableau: the guess, and what its violated rows make of it.
constexpr int kMaxGuesses = 2;
// Of bodies in space.
constexpr Index kMostColumnsPerBody = 6;

}  // namespace

SmallPivoting::Answer::Judgement SmallPivoting::Answer::Judge(double tolerance) const {
  if (!(rho - rounding <= std::min(tableau::kMostRho, tolerance) && rows_meet)) return Judgement::kWrong;
  return rho + rounding <= tolerance ? Judgement::kRight : Judgement::kUnclear;
}

void SmallPivoting::Reserve(Index max_rows, Index problem_rows) {
  if (static_cast<Index>(local_.size()) < problem_rows) local_.resize(At(problem_rows), 0);
  const Index stride = (max_rows + kRegister - 1) / kRegister * kRegister;
  if (stride <= q_.size()) return;
  for (Eigen::VectorXd* v : {&matrix_, &tableau_}) v->setZero(stride * stride);
  joints_.reserve(At(stride));
  guess_.reserve(At(stride));
  for (Eigen::VectorXd* v : {&diagonal_, &b_, &q_, &scale_, &root_, &inverse_root_, &weight_, &sign_, &least_force_,
                             &force_, &w_, &pivot_row_, &waiting_row_, &correction_, &blocked_weight_}) {
    v->setZero(stride);
  }
}

void SmallPivoting::ReserveRows(Index max_rows, Index max_bodies) {
  Reserve(max_rows);
  const auto sides = At(2 * q_.size());
  if (body_of_.size() < static_cast<Index>(sides)) {
    body_of_.setConstant(static_cast<Index>(sides), -1);
    before_.resize(sides, -1);
    jacobian_.setZero(static_cast<Index>(sides) * kMostColumnsPerBody);
    momentum_.setZero(static_cast<Index>(sides) * kMostColumnsPerBody);
  }
  if (last_.size() < At(max_bodies)) last_.resize(At(max_bodies), -1);
}

void SmallPivoting::EliminateOne(double* row, Index stride, const PivotRow& pivot) {
  const double factor = row[pivot.r];
  if (factor == 0) return;
  for (Index v = 0; v < stride / kRegister; ++v) AsRegisters(row)[v] += factor * AsRegisters(pivot.p)[v];
  row[pivot.r] = factor * pivot.p[pivot.r];
}

// Exchanges f_r and w_r. False if rounding is all that the pivot is made of. Above 16 rows only q and row r are those
// after the pivot, the other rows of the tableau wait for the next one.
template <int count>
bool SmallPivoting::Pivot(Index r) {
  constexpr bool waits = count == 0 || count > 2;
  if (waits && r == waiting_) CatchUp();
  double* row = tableau_.data() + r * stride_;
  const bool any_waits = waits && waiting_ >= 0;
  const double* waiting = waiting_row_.data();
  const double behind = any_waits ? row[waiting_] : 0.0;
  const double pivot = any_waits ? row[r] + behind * waiting[r] : row[r];
  const double least = sign_[r] < 0 ? kLeastPivot * root_[r] * root_[r] : 0;
  if (!(pivot > least)) return false;
  ++pivots_;
  const double inverse = 1 / pivot;
  const Index registers = Registers<count>();
  const double q = -q_[r] * inverse;
  double* p = pivot_row_.data();
  const double sign = sign_[r];
  const double weight = weight_[r] == 0 ? 0.0 : sign < 0 ? root_[r] : inverse_root_[r];
  // Column r is row r but for the signs of a principal transform: skew between rows in F and others, else symmetric.
  // Entry r is set within its register: a register that is read soon after one of its doubles was written has to wait.
  IntegerRegister at = kFirstRows;
  constexpr IntegerRegister kFirstBits = {1, 2, 4, 8, 16, 32, 64, 128};
  IntegerRegister reached = {};
  for (Index v = 0; v < registers; ++v) {
    const IntegerRegister is_r = at == r;
    Register t = AsRegisters(row)[v];
    if constexpr (waits) {
      if (any_waits) t = (at == waiting_ ? Register{} : t) + behind * AsRegisters(waiting)[v];
    }
    if constexpr (count > 2) reached |= (t != 0) & (kFirstBits << (v * kRegister));
    const Register signs = AsRegisters(sign_.data())[v];
    const Register q_new = AsRegisters(q_.data())[v] + (sign * q) * (t * signs);
    AsRegisters(p)[v] = is_r ? Register{} + inverse : -inverse * t;
    AsRegisters(q_.data())[v] = is_r ? Register{} + q : q_new;
    AsRegisters(sign_.data())[v] = is_r ? -signs : signs;
    AsRegisters(weight_.data())[v] = is_r ? Register{} + weight : AsRegisters(weight_.data())[v];
    at += kRegister;
  }
  if constexpr (waits) {
    const std::uint64_t reached_rows = Together(&reached);
    if (any_waits) {
      EliminateBoth<count>({waiting_, waiting}, {r, p}, reached_rows);
      waiting_ = -1;
    } else {
      waiting_ = r;
      waiting_rows_ = reached_rows;
      waiting_row_.swap(pivot_row_);
    }
  } else {
    Eliminate<count>(tableau_.data(), n_, r, p);
  }
  for (Index v = 0; v < registers; ++v) AsRegisters(row)[v] = AsRegisters(p)[v];
  return true;
}

// Two pivots, one after the other, at once: most of what it costs to change a row is to read and to write it. Their own
// rows are those after them.
template <int count>
void SmallPivoting::EliminateBoth(const PivotRow& first, const PivotRow& second, std::uint64_t second_rows) {
  double* const tableau = tableau_.data();
  const Index r = first.r;
  const Index s = second.r;
  const double p_r = first.p[r];
  const double p_s = first.p[s];
  const double p2_r = second.p[r];
  const double p2_s = second.p[s];
  EliminateOne(tableau + r * stride_, stride_, second);
  if constexpr (count > 0) {
    static_assert(count * kRegister <= 64);
    Register p[count];
    Register p2[count];
    for (int v = 0; v < count; ++v) {
      p[v] = AsRegisters(first.p)[v];
      p2[v] = AsRegisters(second.p)[v];
    }
    // Without a branch on rows that is often guessed wrong.
    std::uint64_t rows = (waiting_rows_ | second_rows) & ~(std::uint64_t{1} << r) & ~(std::uint64_t{1} << s);
    for (; rows != 0; rows &= rows - 1) {
      double* const row = tableau + Index{std::countr_zero(rows)} * count * kRegister;
      const double factor = row[r];
      const double factor2 = row[s] + factor * p_s;
      for (int v = 0; v < count; ++v) AsRegisters(row)[v] = (AsRegisters(row)[v] + factor * p[v]) + factor2 * p2[v];
      row[r] = factor * p_r + factor2 * p2_r;
      row[s] = factor2 * p2_s;
    }
  } else {
    const double* __restrict p = first.p;
    const double* __restrict p2 = second.p;
    for (Index i = 0; i < n_; ++i) {
      double* __restrict row = tableau + i * stride_;
      const double factor = row[r];
      const double factor2 = row[s] + factor * p_s;
      if (i == r || i == s || (factor == 0 && factor2 == 0)) continue;
      for (Index j = 0; j < stride_; ++j) row[j] = (row[j] + factor * p[j]) + factor2 * p2[j];
      row[r] = factor * p_r + factor2 * p2_r;
      row[s] = factor2 * p2_s;
    }
  }
}

// The tableau after all pivots.
void SmallPivoting::CatchUp() {
  for (Index i = 0; i < n_ && waiting_ >= 0; ++i) {
    if (i != waiting_) EliminateOne(tableau_.data() + i * stride_, stride_, {waiting_, waiting_row_.data()});
  }
  waiting_ = -1;
}

// -1 if there is none.
template <int count>
Index SmallPivoting::MostViolated() const {
  // The last bits of a double carry the row, so that one minimum finds both; a violation is not needed to 1e-13. Of
  // equal ones, which negative numbers order by larger bits, the least row wins.
  constexpr std::int64_t kRowBits = kMaxRows - 1;
  IntegerRegister row = {kRowBits,     kRowBits - 1, kRowBits - 2, kRowBits - 3,
                         kRowBits - 4, kRowBits - 5, kRowBits - 6, kRowBits - 7};
  Register least = {};
  for (Index v = 0; v < Registers<count>(); ++v) {
    Register marked = AsRegisters(q_.data())[v] * AsRegisters(weight_.data())[v];
    IntegerRegister& bits = reinterpret_cast<IntegerRegister&>(marked);
    bits = (bits & ~kRowBits) | row;
    least = marked < least ? marked : least;
    row -= kRegister;
  }
  const double worst = Least(&least);
  if (!(worst < -noise_)) return -1;
  return kRowBits - static_cast<Index>(std::bit_cast<std::int64_t>(worst) & kRowBits);
}

Index SmallPivoting::FirstViolated() const {
  for (Index i = 0; i < n_; ++i) {
    if (violated(i)) return i;
  }
  return -1;
}

void SmallPivoting::FindForces() {
  for (Index v = 0; v < stride_ / kRegister; ++v) {
    const Register f = AsRegisters(sign_.data())[v] > 0 ? AsRegisters(q_.data())[v] : Register{};
    const Register least = AsRegisters(least_force_.data())[v];
    AsRegisters(force_.data())[v] = f > least ? f : least;
  }
}

// rho of force_. Leaves w.
double SmallPivoting::Rho() {
  const Index registers = stride_ / kRegister;
  for (Index v = 0; v < registers; ++v) AsRegisters(w_.data())[v] = AsRegisters(b_.data())[v];
  for (Index v = 0; v < registers; v += 2) {
    // Two registers of w at a time, over all forces: w stays where it is computed.
    const Index second = v + 1 < registers ? v + 1 : v;
    Register w0 = {};
    Register w1 = {};
    for (Index j = 0; j < n_; ++j) {
      const double* row = matrix_.data() + j * stride_;
      const double f = force_[j];
      w0 += f * AsRegisters(row)[v];
      w1 += f * AsRegisters(row)[second];
    }
    AsRegisters(w_.data())[v] += w0;
    if (second != v) AsRegisters(w_.data())[second] += w1;
  }
  Register sum = {};
  for (Index v = 0; v < registers; ++v) {
    const Register gap = AsRegisters(w_.data())[v] * AsRegisters(inverse_root_.data())[v];
    const Register force =
        (AsRegisters(force_.data())[v] - AsRegisters(least_force_.data())[v]) * AsRegisters(root_.data())[v];
    const Register residual = gap < force ? gap : force;
    sum += residual * residual;
  }
  return std::sqrt(Sum(&sum)) / b_norm_;
}

// f_F -= A_FF^-1 w_F.
void SmallPivoting::Refine() {
  CatchUp();
  const Index registers = stride_ / kRegister;
  for (Index v = 0; v < registers; ++v)
    AsRegisters(w_.data())[v] = AsRegisters(sign_.data())[v] > 0 ? AsRegisters(w_.data())[v] : Register{};
  for (Index i = 0; i < n_; ++i) {
    const double* row = tableau_.data() + i * stride_;
    Register sum = {};
    for (Index v = 0; v < registers; ++v) sum += AsRegisters(row)[v] * AsRegisters(w_.data())[v];
    correction_[i] = sign_[i] > 0 ? Sum(&sum) : 0;
  }
  for (Index i = 0; i < n_; ++i) q_[i] -= correction_[i];
}

bool SmallPivoting::RowsMeet(double limit) const {
  for (Index i = 0; i < n_; ++i) {
    const double* row = matrix_.data() + i * stride_;
    const double force = row[i] * force_[i];
    const double defect = std::abs(least_force_[i] < 0 ? w_[i] : std::min(w_[i], force));
    // (|A| |f|)_i is at least both |A f|_i and A_ii f_i: most rows pass by that alone.
    if (defect <= limit * (std::max(std::abs(w_[i] - b_[i]), std::abs(force)) + std::abs(b_[i]))) continue;
    double size = std::abs(b_[i]);
    for (Index j = 0; j < n_; ++j) size += std::abs(row[j] * force_[j]);
    if (!(defect <= limit * size)) return false;
  }
  return true;
}

SmallPivoting::Answer SmallPivoting::Finish(const Request& request) {
  if (!request.self_check) {
    if (n_ <= 2 && SolveInClosedForm()) return {0, 0, true};
    const bool found = FindActiveSet(request.deadline);
    FindForces();
    return {found ? 0 : kInfinity, 0, found};
  }
  Answer answer{Run(request.deadline), kInfinity, false};
  if (answer.rho == kInfinity) return answer;
  double size = 0;
  for (Index i = 0; i < n_; ++i) size += std::abs(force_[i]) * root_[i];
  const auto rows = static_cast<double>(n_);
  answer.rounding = 2 * (rows + 8) * std::numeric_limits<double>::epsilon() * std::sqrt(rows) * size / b_norm_;
  answer.rows_meet = RowsMeet(request.row_limit);
  if (answer.rows_meet) return answer;
  // Where all forces around a row should be 0, its backward error is rounding over rounding.
  double largest = 0;
  for (Index i = 0; i < n_; ++i) largest = std::max(largest, std::abs(force_[i]) * root_[i]);
  for (Index i = 0; i < n_; ++i) {
    if (std::abs(force_[i]) * root_[i] <= kNoise * largest) force_[i] = 0;
  }
  answer.rho = Rho();
  answer.rows_meet = RowsMeet(request.row_limit);
  if (answer.rows_meet) return answer;
  // A joint among them still has a small force to carry: that which its rounded b asks for.
  Refine();
  for (const Index i : joints_) force_[i] -= correction_[i];
  answer.rho = Rho();
  answer.rows_meet = RowsMeet(request.row_limit);
  return answer;
}

// False if the limit of pivots or the deadline came first.
template <int count>
bool SmallPivoting::DrivePivots(const Deadline* deadline) {
  noise_ = kNoise;
  waiting_ = -1;
  for (const Index r : joints_) Pivot<count>(r);
  for (const Index r : guess_) {
    if (sign_[r] < 0) Pivot<count>(r);
  }
  const int greedy = static_cast<int>(2 * n_);
  const int limit = static_cast<int>(6 * n_) + 20;
  for (bool any_blocked = false;;) {
    const Index r = pivots_ > greedy ? FirstViolated() : MostViolated<count>();
    if (r < 0 && (!any_blocked || !Exchange<count>())) return true;
    const bool is_late =
        deadline != nullptr && n_ > kRowsWithoutClock && pivots_ % kPivotsPerClockRead == 0 && deadline->Expired();
    if (pivots_ >= limit || is_late) return false;
    if (r >= 0 && !Pivot<count>(r)) {
      std::swap(weight_[r], blocked_weight_[r]);
      any_blocked = true;
      continue;
    }
    if (any_blocked) {  // F has changed, and what depends on it
      for (Index i = 0; i < n_; ++i) weight_[i] += blocked_weight_[i];
      blocked_weight_.setZero();
      any_blocked = false;
    }
    if (r >= 0) noise_ = std::max(noise_, kNoise * std::abs(q_[r]));
  }
}

// Lets the most violated of the rows that depend on F take the place of the row whose force it drives to 0 first; all
// forces have their signs. False if none is violated by more than rounding, or none is in its way.
template <int count>
bool SmallPivoting::Exchange() {
  Index r = -1;
  double worst = -tableau::kMargin * tableau::kMostRho * b_norm_;
  for (Index i = 0; i < n_; ++i) {
    const double violation = q_[i] * blocked_weight_[i];
    if (!(violation < worst)) continue;
    worst = violation;
    r = i;
  }
  if (r < 0) return false;
  CatchUp();
  // Of F, row r of the tableau has by how much a unit of force at r lowers each force.
  const double* const row = tableau_.data() + r * stride_;
  Index leaving = -1;
  double least = kInfinity;
  for (Index i = 0; i < n_; ++i) {
    if (!(sign_[i] > 0 && least_force_[i] == 0 && row[i] > 0)) continue;
    // Without row i, row r no longer depends on F: its pivot is that.
    const double pivot = row[i] * row[i] / tableau_[i * stride_ + i];
    if (!(pivot > kLeastPivot * root_[r] * root_[r]) || !(q_[i] / row[i] < least)) continue;
    least = q_[i] / row[i];
    leaving = i;
  }
  if (leaving < 0 || !Pivot<count>(leaving)) return false;
  std::swap(weight_[r], blocked_weight_[r]);
  Pivot<count>(r);
  noise_ = std::max(noise_, kNoise * std::abs(q_[r]));
  return true;
}

bool SmallPivoting::FindActiveSet(const Deadline* deadline) {
  bool found = false;
  const bool is_unrolled = [&]<int... count>(std::integer_sequence<int, count...>) {
    return ((stride_ == (count + 1) * kRegister && (found = DrivePivots<count + 1>(deadline), true)) || ...);
  }
  (std::make_integer_sequence<int, 8>{});
  return is_unrolled ? found : DrivePivots<0>(deadline);
}

double SmallPivoting::Run(const Deadline* deadline) {
  if (n_ <= 2 && SolveInClosedForm()) {
    const double rho = Rho();
    if (rho <= kGoodEnough) return rho;
  }
  if (!guess_.empty()) {
    const double rho = TryGuess();
    if (rho <= kRightRho) return rho;
    std::copy(b_.data(), b_.data() + stride_, q_.data());
    std::copy(matrix_.data(), matrix_.data() + n_ * stride_, tableau_.data());
  }
  if (!FindActiveSet(deadline)) {
    FindForces();
    return kInfinity;
  }
  FindForces();
  double rho = Rho();
  if (rho > kGoodEnough) {
    const double before = rho;
    Refine();
    FindForces();
    rho = Rho();
    if (!(rho <= before)) {
      // Refinement in the same precision may lose the last digit.
      for (Index i = 0; i < n_; ++i) q_[i] += correction_[i];
      FindForces();
      rho = Rho();
    }
  }
  return rho;
}

bool SmallPivoting::LoadDense(const LcpProblem& problem) {
  SetSize(problem.size());
  diagonal_.head(n_) = problem.DiagonalA();
  b_.head(n_) = problem.b();
  for (const Index i : problem.bilateral_rows()) joints_.push_back(i);
  if (!Scale()) return false;
  // A is symmetric, so its columns serve as rows. What a register reads beyond a row's end is multiplied by 0; beyond
  // the last row there is nothing to read.
  const double* A = problem.DenseA().data();
  const Index registers = stride_ / kRegister;
  for (Index i = 0; i < n_; ++i) {
    const double* from = A + i * n_;
    const double s = scale_[i];
    double* to = matrix_.data() + i * stride_;
    double* to_tableau = tableau_.data() + i * stride_;
    if (i * n_ + stride_ <= n_ * n_) {
      for (Index v = 0; v < registers; ++v) {
        const Register row = AsRegisters(from)[v] * s * AsRegisters(scale_.data())[v];
        AsRegisters(to)[v] = row;
        AsRegisters(to_tableau)[v] = row;
      }
    } else {
      for (Index j = 0; j < n_; ++j) to[j] = to_tableau[j] = from[j] * s * scale_[j];
      for (Index j = n_; j < stride_; ++j) to[j] = to_tableau[j] = 0;
    }
  }
  return true;
}

bool SmallPivoting::LoadRows(const StepRows& all, std::span<const std::int32_t> part) {
  if (all.columns_per_body == 3) {
    return all.J != nullptr ? LoadRowsOf<3>(all, all.J, part) : LoadRowsOf<3>(all, all.J_single, part);
  }
  return all.J != nullptr ? LoadRowsOf<6>(all, all.J, part) : LoadRowsOf<6>(all, all.J_single, part);
}

// Component c of side s of row i lies at (s p + c) along + i step: rows side by side, or components.
template <Index p, typename Real>
bool SmallPivoting::LoadRowsOf(const StepRows& all, const Real* J, std::span<const std::int32_t> part) {
  SetSize(static_cast<Index>(part.size()));
  const bool by_registers = n_ <= kLaneRows;
  const Index along = by_registers ? stride_ : 1;
  const Index step = by_registers ? 1 : 2 * p;
  double* const jacobian = jacobian_.data();
  double* const momentum = momentum_.data();
  for (Index i = 0; i < n_; ++i) {
    const Index row = part[At(i)];
    const Real* from = J + row * 2 * p;
    double* to = jacobian + i * step;
    double* to_momentum = momentum + i * step;
    double d = 0;
    const std::int32_t first = all.body[2 * row];
    for (Index s = 0; s < 2; ++s) {
      const std::int32_t body = all.body[2 * row + s];
      const double* mass = all.inverse_mass + static_cast<Index>(body) * p;
      bool moves = false;
      for (int c = 0; c < p; ++c) {
        const Index at = (s * p + c) * along;
        const double j = body < 0 ? 0.0 : static_cast<double>(from[s * p + c]);
        const double m = body < 0 ? 0.0 : mass[c];
        moves = moves || m > 0;
        to[at] = j;
        to_momentum[at] = m * j;
        d += m * (j * j);
      }
      body_of_[s * stride_ + i] = moves ? body : -1;
    }
    if (first >= 0 && first == all.body[2 * row + 1])
      d = JoinSides<p>(to, to_momentum, along, all.inverse_mass + first * p, &body_of_[stride_ + i]);
    diagonal_[i] = d;
    b_[i] = all.b[row];
    if (all.bilateral != nullptr && all.bilateral[row] != 0) joints_.push_back(i);
  }
  if (!Scale()) return false;
  if (by_registers) {
    AssembleByRegisters<p>();
  } else {
    AssembleByBodies<p>();
  }
  return true;
}

// Of every row against all others at once: products of sides that are not on one body are masked out.
template <Index p>
void SmallPivoting::AssembleByRegisters() {
  const Index registers = stride_ / kRegister;
  for (Index i = n_; i < stride_; ++i) {
    body_of_[i] = body_of_[stride_ + i] = -2;
    for (Index c = 0; c < 2 * p; ++c) jacobian_[c * stride_ + i] = 0;
  }
  for (Index c = 0; c < 2 * p; ++c) {
    for (Index v = 0; v < registers; ++v) {
      AsRegisters(jacobian_.data() + c * stride_)[v] *= AsRegisters(scale_.data())[v];
    }
  }
  const auto* bodies = reinterpret_cast<const IntegerRegister*>(body_of_.data());
  for (Index i = 0; i < n_; ++i) {
    double g[2 * p];
    for (Index c = 0; c < 2 * p; ++c) g[c] = momentum_[c * stride_ + i] * scale_[i];
    const std::int64_t a = body_of_[i];
    const std::int64_t b = body_of_[stride_ + i];
    for (Index v = 0; v < registers; ++v) {
      Register sums[4] = {};  // of the first side with first and second sides, then of the second side
      for (int c = 0; c < p; ++c) {
        const Register first = AsRegisters(jacobian_.data() + c * stride_)[v];
        const Register second = AsRegisters(jacobian_.data() + (p + c) * stride_)[v];
        sums[0] += g[c] * first;
        sums[1] += g[c] * second;
        sums[2] += g[p + c] * first;
        sums[3] += g[p + c] * second;
      }
      const IntegerRegister firsts = bodies[v];
      const IntegerRegister seconds = bodies[registers + v];
      const Register zero = {};
      const Register row = ((firsts == a ? sums[0] : zero) + (seconds == b ? sums[3] : zero)) +
                           ((seconds == a ? sums[1] : zero) + (firsts == b ? sums[2] : zero));
      AsRegisters(matrix_.data() + i * stride_)[v] = row;
      AsRegisters(tableau_.data() + i * stride_)[v] = row;
    }
  }
}

// Row by row against the rows before it on the same bodies.
template <Index p>
void SmallPivoting::AssembleByBodies() {
  std::fill_n(tableau_.data(), n_ * stride_, 0.0);
  for (Index i = 0; i < n_; ++i) {
    const double s = scale_[i];
    double* const J = jacobian_.data() + i * 2 * p;
    double* const row = tableau_.data() + i * stride_;
    for (int c = 0; c < 2 * p; ++c) J[c] *= s;
    row[i] = diagonal_[i] * s * s;
    for (Index side = 0; side < 2; ++side) {
      const std::int64_t body = body_of_[side * stride_ + i];
      if (body < 0) continue;
      double g[p];
      for (int c = 0; c < p; ++c) g[c] = momentum_[(2 * i + side) * p + c] * s;
      const auto here = static_cast<std::int32_t>(2 * i + side);
      const std::int32_t before = last_[At(body)];
      for (std::int32_t other = before; other >= 0; other = before_[At(other)]) {
        const Index j = other / 2;
        const double* J_other = jacobian_.data() + static_cast<Index>(other) * p;
        double sum = 0;
        for (int c = 0; c < p; ++c) sum += g[c] * J_other[c];
        row[j] += sum;
        tableau_[j * stride_ + i] = row[j];
      }
      before_[At(here)] = before;
      last_[At(body)] = here;
    }
  }
  for (Index i = 0; i < 2 * stride_; ++i) {
    if (i % stride_ < n_ && body_of_[i] >= 0) last_[At(body_of_[i])] = -1;
  }
  std::copy_n(tableau_.data(), n_ * stride_, matrix_.data());
}

bool SmallPivoting::LoadPart(const LcpProblem& problem, std::span<const Index> rows) {
  SetSize(static_cast<Index>(rows.size()));
  for (Index i = 0; i < n_; ++i) {
    const Index given = rows[At(i)];
    diagonal_[i] = problem.DiagonalA()[given];
    b_[i] = problem.b()[given];
    local_[At(given)] = static_cast<int>(i);
    if (problem.is_bilateral(given)) joints_.push_back(i);
  }
  if (!Scale()) return false;
  std::fill(matrix_.data(), matrix_.data() + n_ * stride_, 0.0);
  for (Index i = 0; i < n_; ++i) {
    double* to = matrix_.data() + i * stride_;
    for (SparseMatrix::InnerIterator it(problem.SparseA(), rows[At(i)]); it; ++it) {
      // Rows that are no part of this island are left out of it: they carry no force.
      const auto j = static_cast<Index>(local_[At(it.col())]);
      if (j < n_ && rows[At(j)] == it.col()) to[j] = it.value() * scale_[i] * scale_[j];
    }
  }
  std::copy(matrix_.data(), matrix_.data() + n_ * stride_, tableau_.data());
  return true;
}

void SmallPivoting::SetSize(Index n) {
  n_ = n;
  stride_ = (n + kRegister - 1) / kRegister * kRegister;
  joints_.clear();
}

// diagonal_ and b_ are the given ones here and scaled ones afterwards; the rest follows from them. False unless all of
// the diagonal is positive.
bool SmallPivoting::Scale() {
  for (Index i = n_; i < stride_; ++i) {
    diagonal_[i] = 1;
    b_[i] = 0;
  }
  Register largest = {};
  Register squared = {};
  IntegerRegister at = kFirstRows;
  IntegerRegister is_wrong = {};
  const Index registers = stride_ / kRegister;
  for (Index v = 0; v < registers; ++v) {
    const Register d = AsRegisters(diagonal_.data())[v];
    is_wrong |= !(d > 0);
    // ScaleOfDiagonal of eight rows at once; 0 where there is no row.
    const IntegerRegister exponent = (reinterpret_cast<const IntegerRegister&>(d) >> kMantissaBits) - kExponentBias;
    const IntegerRegister bits = (kExponentBias - (exponent >> 1)) << kMantissaBits;
    const Register scale = at < n_ ? reinterpret_cast<const Register&>(bits) : Register{};
    const Register one = d * scale * scale;
    Register root;
    Eigen::Map<Eigen::Array<double, kRegister, 1>>(reinterpret_cast<double*>(&root)) =
        Eigen::Map<const Eigen::Array<double, kRegister, 1>>(reinterpret_cast<const double*>(&one)).sqrt();
    const Register inverse = at < n_ ? 1 / root : Register{};
    const Register b = AsRegisters(b_.data())[v] * scale;
    AsRegisters(scale_.data())[v] = scale;
    AsRegisters(root_.data())[v] = root;
    AsRegisters(inverse_root_.data())[v] = inverse;
    AsRegisters(b_.data())[v] = b;
    const Register size = b < 0 ? -b : b;
    largest = size > largest ? size : largest;
    const Register relative = b * inverse;
    squared += relative * relative;
    at += kRegister;
  }
  largest = -largest;
  b_scale_ = ScaleOfLargest(-Least(&largest));
  inverse_b_scale_ = 1 / b_scale_;
  const double norm = Sum(&squared);
  b_norm_ = norm == 0 ? 1.0 : std::sqrt(norm) * b_scale_;
  for (Index v = 0; v < registers; ++v) {
    const Register b = AsRegisters(b_.data())[v] * b_scale_;
    AsRegisters(b_.data())[v] = b;
    AsRegisters(q_.data())[v] = b;
    AsRegisters(weight_.data())[v] = AsRegisters(inverse_root_.data())[v];
    AsRegisters(sign_.data())[v] = Register{} - 1.0;
    AsRegisters(least_force_.data())[v] = Register{};
    AsRegisters(blocked_weight_.data())[v] = Register{};
  }
  for (const Index i : joints_) {
    weight_[i] = 0;
    least_force_[i] = -kInfinity;
  }
  for (Index k = 0; k < kRegister; ++k) {
    if (is_wrong[k] != 0) return false;
  }
  return true;
}

// force_ for one or two rows: the first active set, of none, one or both rows, whose forces and gaps have their signs.
// False if rounding leaves none.
bool SmallPivoting::SolveInClosedForm() {
  for (Index v = 0; v < stride_ / kRegister; ++v) AsRegisters(force_.data())[v] = Register{};
  const double* A = matrix_.data();
  const auto may_rest = [&](Index i, double gap) { return least_force_[i] == 0 && gap >= 0; };
  const auto may_push = [&](Index i, double force) { return force >= least_force_[i]; };
  const double f0 = -b_[0] / A[0];
  if (n_ == 1) {
    force_[0] = may_rest(0, b_[0]) ? 0.0 : f0;
    return true;
  }
  const double a11 = A[stride_ + 1];
  const double f1 = -b_[1] / a11;
  if (may_rest(0, b_[0]) && may_rest(1, b_[1])) return true;
  if (may_push(0, f0) && may_rest(1, b_[1] + A[1] * f0)) {
    force_[0] = f0;
    return true;
  }
  if (may_push(1, f1) && may_rest(0, b_[0] + A[1] * f1)) {
    force_[1] = f1;
    return true;
  }
  const double determinant = A[0] * a11 - A[1] * A[1];
  if (!(determinant > kLeastPivot * A[0] * a11)) return false;
  force_[0] = (A[1] * b_[1] - a11 * b_[0]) / determinant;
  force_[1] = (A[1] * b_[0] - A[0] * b_[1]) / determinant;
  return may_push(0, force_[0]) && may_push(1, force_[1]);
}

// force_ := -A_FF^-1 b_F by L D L^T, the tableau serving as workspace. Rows that depend on others leave F.
void SmallPivoting::SolveGuess() {
  const Index registers = stride_ / kRegister;
  double* tableau = tableau_.data();
  Register* y = AsRegisters(q_.data());
  for (Index v = 0; v < registers; ++v) {
    y[v] = -AsRegisters(b_.data())[v];
    AsRegisters(force_.data())[v] = Register{};
  }
  for (const Index i : guess_) {
    for (Index v = 0; v < registers; ++v) {
      AsRegisters(tableau + i * stride_)[v] = AsRegisters(matrix_.data() + i * stride_)[v];
    }
  }
  // Forward. Row i > r ends up with L_ir left of its diagonal and D_i L_ji from there on; what the whole-register steps
  // do to y left of r is never read again.
  size_t kept = 0;
  for (size_t k = 0; k < guess_.size(); ++k) {
    const Index r = guess_[k];
    const double* row = tableau + r * stride_;
    const double pivot = row[r];
    if (!(pivot > kLeastPivot * root_[r] * root_[r])) continue;
    guess_[kept++] = r;
    const double inverse = 1 / pivot;
    const double y_r = q_[r] * inverse;
    correction_[r] = y_r;
    const Index first = r / kRegister;
    const IntegerRegister is_r = kFirstRows == r % kRegister;
    const IntegerRegister is_after = kFirstRows > r % kRegister;
    for (Index v = first; v < registers; ++v) y[v] -= y_r * AsRegisters(row)[v];
    for (size_t m = k + 1; m < guess_.size(); ++m) {
      const Index i = guess_[m];
      const double factor = row[i] * inverse;
      if (factor == 0) continue;  // row i has zeros left of its diagonal where it had no L_ir yet
      Register* to = AsRegisters(tableau + i * stride_);
      const Register before = is_r ? Register{} + factor : to[first];
      const Register after = before - factor * AsRegisters(row)[first];
      to[first] = is_after ? after : before;
      for (Index v = first + 1; v < registers; ++v) to[v] -= factor * AsRegisters(row)[v];
    }
  }
  guess_.resize(kept);
  // Backward, each force subtracted from all rows before it at once.
  for (size_t k = kept; k-- > 0;) {
    const Index r = guess_[k];
    const double f = correction_[r];
    force_[r] = f;
    const double* row = tableau + r * stride_;
    for (Index v = 0; v <= r / kRegister; ++v) AsRegisters(correction_.data())[v] -= f * AsRegisters(row)[v];
  }
}

// Block principal pivoting from the guess, a few steps of it. Returns the last rho, with force_ and w_ of it. Spoils q_
// and the tableau.
double SmallPivoting::TryGuess() {
  const double limit = kRightRho * b_norm_;
  for (int round = 1;; ++round) {
    ++pivots_;
    SolveGuess();
    const double rho = Rho();
    if (rho <= kRightRho || round == kMaxGuesses) {
      IntegerRegister is_negative = {};
      for (Index v = 0; v < stride_ / kRegister; ++v) {
        const Register f = AsRegisters(force_.data())[v];
        const Register least = AsRegisters(least_force_.data())[v];
        is_negative |= f < least;
        AsRegisters(force_.data())[v] = f > least ? f : least;
      }
      // Forces that are rounding only may be all that a row has: its gap is then another without them.
      bool any_is_negative = false;
      for (Index k = 0; k < kRegister; ++k) any_is_negative = any_is_negative || is_negative[k] != 0;
      return any_is_negative ? Rho() : rho;
    }
    guess_.clear();
    for (Index i = 0; i < n_; ++i) {
      const double f = force_[i] * root_[i];
      const bool enters = f != 0 ? f >= -limit : w_[i] * inverse_root_[i] < -limit;
      if (least_force_[i] < 0 || enters) guess_.push_back(i);
    }
  }
}

bool SmallPivoting::LoadArrays(const ProblemArrays& arrays, const double* diagonal) {
  SetSize(arrays.rows);
  std::copy_n(diagonal, n_, diagonal_.data());
  std::copy_n(arrays.b.data(), n_, b_.data());
  for (Index i = 0; i < n_ && !arrays.bilateral.empty(); ++i) {
    if (arrays.bilateral[At(i)] != 0) joints_.push_back(i);
  }
  if (!Scale()) return false;
  const bool is_dense = arrays.form == MatrixForm::kDense;
  for (Index i = 0; i < n_; ++i) {
    const double s = scale_[i];
    double* const to = matrix_.data() + i * stride_;
    if (is_dense) {
      const double* const from = arrays.value.data() + i * n_;
      for (Index j = 0; j < n_; ++j) to[j] = from[j] * s * scale_[j];
      std::fill(to + n_, to + stride_, 0.0);
    } else {
      std::fill_n(to, stride_, 0.0);
      for (auto e = At(arrays.row_start[At(i)]); e < At(arrays.row_start[At(i) + 1]); ++e) {
        const Index j = arrays.column[e];
        to[j] = arrays.value[e] * s * scale_[j];
      }
    }
  }
  std::copy_n(matrix_.data(), n_ * stride_, tableau_.data());
  return true;
}

}  // namespace lcpbench
