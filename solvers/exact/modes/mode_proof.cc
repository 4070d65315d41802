#include "solvers/exact/modes/mode_proof.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/exact/dyadic_lcp.h"
#include "solvers/exact/exact_solver.h"
#include "solvers/exact/mode_system.h"
#include "solvers/friction/mode_equations.h"

namespace lcpbench {
namespace {

constexpr double kUnitRoundoff = std::numeric_limits<double>::epsilon() / 2;
// For the rounding of sums of bounds, some thousand operations on numbers of one sign.
constexpr double kSlack = 1.01;
// Where all numbers are within the limits below, what underflow loses anywhere is far less.
constexpr double kUnderflow = 1e-200;
constexpr double kLargestEntry = 0x1p192, kLargestLoad = 0x1p128, kLeastLoad = 0x1p-300, kLargestMu = 0x1p100;
// a of the header: beyond, R is too poor to be of use.
constexpr double kMostDefect = 0.9;
constexpr int kMostSteps = 16;

// Higham's gamma_k.
double Gamma(Index operations) {
  const double part = static_cast<double>(operations) * kUnitRoundoff;
  return part / (1 - part);
}

}  // namespace

// K x = -w at x = 0, and what is around it.
struct RoundedModes::Equations {
  ModeEquations<double> of;
  Eigen::MatrixXd R;
  double inverse_norm = 0;               // |K^-1|_inf <=
  double shares = 0, largest_share = 1;  // the sum of |coefficients|, and the largest
  double error = 0;                      // |x - x*|_inf <=, once it is known
  Eigen::VectorXd forces;                // n
};

RoundedModes::RoundedModes(const ExactLcp& problem)
    : A_(problem.size, problem.size), b_(problem.size), entry_error_(4 * kUnitRoundoff), bilateral_(problem.bilateral) {
  for (Index i = 0; i < problem.size; ++i) {
    b_[i] = problem.b[At(i)].convert_to<double>();
    is_usable_ = is_usable_ && (b_[i] != 0 || problem.b[At(i)] == 0);
    for (Index j = 0; j < problem.size; ++j) {
      const Rational& entry = problem.A[At(i * problem.size + j)];
      A_(i, j) = entry.convert_to<double>();
      is_usable_ = is_usable_ && (A_(i, j) != 0 || entry == 0);
    }
  }
  for (const ExactFrictionRow& row : problem.friction) {
    friction_.push_back({row.row, row.normal, row.mu.convert_to<double>(), static_cast<signed char>(row.slip)});
    is_usable_ = is_usable_ && (friction_.back().mu != 0 || row.mu == 0);
  }
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (const ExactBoundedRow& row : problem.bounded) {
    bounded_.push_back({row.row, row.lower ? row.lower->convert_to<double>() : -kInfinity,
                        row.upper ? row.upper->convert_to<double>() : kInfinity});
  }
  Scale();
}

RoundedModes::RoundedModes(const LcpProblem& problem)
    : A_(problem.DenseA()), b_(problem.b()), bilateral_(At(problem.size()), 0) {
  for (const Index row : problem.bilateral_rows()) bilateral_[At(row)] = 1;
  friction_ = problem.friction_rows();
  bounded_ = problem.bounded_rows();
  is_usable_ = !problem.has_extreme_matrix();
  if (problem.has_factors()) {
    Index most = 0;
    for (Index i = 0; i < problem.size(); ++i) {
      Index entries = 0;
      for (SparseMatrix::InnerIterator it(problem.J(), i); it; ++it) {
        if (it.value() != 0 && problem.inverse_mass()[it.col()] > 0) ++entries;
      }
      most = std::max(most, entries);
      is_usable_ = is_usable_ && (entries == 0 || A_(i, i) > 0);
    }
    entry_error_ = 2 * Gamma(most + 3);
  }
  Scale();
}

// entry_error_ is given for entries below 2.
void RoundedModes::Scale() {
  scale_.setOnes(b_.size());
  for (Index i = 0; i < b_.size(); ++i) {
    const double diagonal = A_(i, i), load = std::abs(b_[i]);
    if (diagonal > 0) scale_[i] = std::ldexp(1.0, static_cast<int>(-(FrexpExponent(diagonal) >> 1)));
    is_usable_ = is_usable_ && (load == 0 || (load >= kLeastLoad && load <= kLargestLoad)) &&
                 (diagonal == 0 || (diagonal >= 1 / kLargestEntry && diagonal <= kLargestEntry));
  }
  A_ = scale_.asDiagonal() * A_ * scale_.asDiagonal();
  b_ = scale_.cwiseProduct(b_);
  largest_ = std::max(2.0, A_.size() > 0 ? A_.cwiseAbs().maxCoeff() : 0.0);
  entry_error_ = entry_error_ * largest_ + kUnderflow;
  is_usable_ = is_usable_ && largest_ <= kLargestEntry;
  for (FrictionRow& row : friction_) {
    row.mu *= scale_[row.normal] / scale_[row.row];
    is_usable_ = is_usable_ && row.mu <= kLargestMu && (row.mu == 0 || row.mu >= 1 / kLargestMu);
  }
  for (BoundedRow& row : bounded_) {
    row.lower /= scale_[row.row];
    row.upper /= scale_[row.row];
    for (const double bound : {row.lower, row.upper}) {
      const double size = std::abs(bound);
      is_usable_ = is_usable_ && (size == 0 || std::isinf(size) || (size >= kLeastLoad && size <= kLargestLoad));
    }
  }
}

// False where K may be singular.
bool RoundedModes::MakeEquations(const std::string& modes, Equations* equations) const {
  Equations& e = *equations;
  e.of.Set(SidesOf(modes), friction_, bounded_);
  const auto n = static_cast<Index>(modes.size()), m = e.of.size();
  const std::vector<Index>& E = e.of.equation;
  Eigen::MatrixXd K = Eigen::MatrixXd::Zero(m, m);
  e.of.VisitFollowers([&](Index row, Index unknown, double share) {
    K.col(unknown) += share * A_(E, row);
    e.shares += std::abs(share);
    e.largest_share = std::max(e.largest_share, std::abs(share));
  });
  if (m == 0) return true;
  e.R = K.partialPivLu().inverse();
  if (!e.R.allFinite()) return false;
  // What each entry of K is off by, at most, summed over a row.
  const double entry_errors = (entry_error_ + Gamma(n + 6) * largest_) * e.shares;
  const Eigen::VectorXd sums = e.R.cwiseAbs().rowwise().sum();
  const Eigen::VectorXd products = e.R.cwiseAbs() * K.cwiseAbs().rowwise().sum();
  const Eigen::VectorXd defects = (Eigen::MatrixXd::Identity(m, m) - e.R * K).cwiseAbs().rowwise().sum() +
                                  Gamma(m + 2) * (products + Eigen::VectorXd::Ones(m)) + entry_errors * sums;
  const double defect = kSlack * defects.maxCoeff() + static_cast<double>(m) * kUnderflow;
  if (!(defect < kMostDefect)) return false;
  e.inverse_norm = kSlack * sums.maxCoeff() / (1 - defect);
  return true;
}

ModeEnclosure RoundedModes::Enclose(const std::string& modes) const {
  ModeEnclosure enclosure;
  Equations e;
  const auto n = static_cast<Index>(modes.size());
  if (!is_usable_) return enclosure;
  const bool is_nonsingular = MakeEquations(modes, &e);
  if (!e.R.allFinite()) return enclosure;
  Eigen::VectorXd x = Eigen::VectorXd::Zero(e.of.size());
  Eigen::VectorXd gaps;
  // Newton's step from x = 0 ends at the solution but for rounding; the second refines it.
  for (int step = 0; step < 3; ++step) {
    e.forces.resize(n);
    for (Index i = 0; i < n; ++i) e.forces[i] = e.of.ForceOf(i, x);
    gaps = b_ + A_ * e.forces;
    if (step < 2 && e.of.size() > 0) x -= e.R * gaps(e.of.equation);
  }
  if (!e.forces.allFinite() || !gaps.allFinite()) return enclosure;
  enclosure.f = scale_.cwiseProduct(e.forces);
  if (!is_nonsingular) return enclosure;
  Eigen::VectorXd gap_errors =
      kSlack * (((Gamma(n + 6) * largest_ + entry_error_) * e.forces.lpNorm<1>() + kUnderflow) +
                (Gamma(n + 6) * b_.cwiseAbs()).array())
                   .matrix();
  double residual = 0;
  for (const Index i : e.of.equation) residual = std::max(residual, std::abs(gaps[i]) + gap_errors[i]);
  e.error = kSlack * e.inverse_norm * residual;
  gap_errors.array() += kSlack * largest_ * e.shares * e.error;
  JudgeSigns(modes, e, gaps, gap_errors, &enclosure);
  // D_ii^1/2 s_i is below 2^1/2; the forces of followers and bounds are rounded, too.
  enclosure.error =
      kSlack * std::sqrt(2.0) *
      (e.largest_share * e.error + 8 * kUnitRoundoff * (n > 0 ? e.forces.lpNorm<Eigen::Infinity>() : 0.0));
  return enclosure;
}

void RoundedModes::JudgeSigns(const std::string& modes, const Equations& e, const Eigen::VectorXd& gaps,
                              const Eigen::VectorXd& gap_errors, ModeEnclosure* enclosure) const {
  bool strict = true, violated = false;
  for (const LinearLaw<double>& law : LawsOf(friction_, bounded_, modes)) {
    if (law.is_equation) continue;
    // What the value is off by, and its terms, which are rounded.
    double value = law.constant, error = 0, terms = std::abs(law.constant);
    for (const auto& [row, is_gap, factor] : law.terms) {
      const double term = factor * (is_gap ? gaps : e.forces)[row];
      value += term;
      terms += std::abs(term);
      error += std::abs(factor) * (is_gap ? gap_errors[row] : e.error);
    }
    const double most = kSlack * error + 16 * kUnitRoundoff * terms + kUnderflow;
    strict = strict && value > most;
    violated = violated || value < -most;
  }
  if (strict) enclosure->signs = ModeEnclosure::Signs::kStrict;
  if (violated) enclosure->signs = ModeEnclosure::Signs::kViolated;
}

const char* ToString(ModeProof::Proof proof) { return proof == ModeProof::Proof::kModes ? "modes" : "nearby problem"; }

namespace {

// f with f_n >= 0, f_t = 0 where f_n or mu is 0, and bounds.
Eigen::VectorXd Clipped(const LcpProblem& problem, Eigen::VectorXd f) {
  for (Index i = 0; i < problem.size(); ++i) {
    if (problem.kind(i) == RowKind::kUnilateral) f[i] = std::max(f[i], 0.0);
  }
  for (const FrictionRow& row : problem.friction_rows()) {
    if (row.mu == 0 || f[row.normal] == 0) f[row.row] = 0;
  }
  for (const BoundedRow& row : problem.bounded_rows()) f[row.row] = std::clamp(f[row.row], row.lower, row.upper);
  return f;
}

// f_t counts as on the boundary of its cone where it is off by less than this part; beyond, in the inside.
constexpr double kBoundary = 0x1p-20;

}  // namespace

ModeProof ProveNearby(const LcpProblem& problem, const Eigen::VectorXd& start) {
  ModeProof proof;
  proof.f = Clipped(problem, start);
  const DyadicLcp lcp(problem);
  const Index n = problem.size();
  std::vector<BigInteger> f(At(n)), w;
  // Forces are integers of these units without any rounding.
  long bits = std::max(0L, lcp.least_force_bits());
  for (Index i = 0; i < n; ++i) {
    if (proof.f[i] != 0) bits = std::max(bits, std::numeric_limits<double>::digits - FrexpExponent(proof.f[i]));
  }
  for (Index i = 0; i < n; ++i) f[At(i)] = Scaled(proof.f[i], bits);
  lcp.ComputeGaps(f, bits, &w);
  // w becomes w - w~, w~ being the nearest gaps that obey the laws.
  proof.modes.assign(At(n), 'O');
  const auto keep = [&](Index i, bool keeps) {
    if (keeps) w[At(i)] = 0;
  };
  for (Index i = 0; i < n; ++i) {
    if (problem.is_bilateral(i)) proof.modes[At(i)] = 'B';
    if (problem.kind(i) != RowKind::kUnilateral) continue;
    if (proof.f[i] > 0) proof.modes[At(i)] = 'C';
    keep(i, proof.f[i] == 0 && w[At(i)] >= 0);
  }
  for (const FrictionRow& row : problem.friction_rows()) {
    char& mode = proof.modes[At(row.row)];
    const double normal = proof.f[row.normal], tangent = proof.f[row.row];
    mode = 'o';
    if (normal == 0 || row.mu == 0) {
      if (normal != 0) mode = row.slip != 0 ? 'k' : w[At(row.row)] >= 0 ? '+' : '-';
      keep(row.row, true);
      continue;
    }
    const Rational ratio = abs(Rational(tangent)) / Rational(normal), mu(row.mu);
    const bool slips = row.slip != 0 || ratio >= mu * Rational(1 - kBoundary);
    if (row.slip != 0 && row.slip * tangent > 0) proof.mu_shift = std::numeric_limits<double>::infinity();
    if (slips || ratio > mu) proof.mu_shift = std::max(proof.mu_shift, RoundUp(abs(Rational(ratio - mu)) / mu));
    mode = row.slip != 0 ? 'k' : !slips ? 'S' : tangent < 0 ? '+' : '-';
    keep(row.row, row.slip != 0 || (slips && (tangent < 0 ? w[At(row.row)] >= 0 : w[At(row.row)] <= 0)));
  }
  for (const BoundedRow& row : problem.bounded_rows()) {
    const double force = proof.f[row.row];
    const bool up = force == row.lower && w[At(row.row)] >= 0, down = force == row.upper && w[At(row.row)] <= 0;
    proof.modes[At(row.row)] = up ? '+' : down ? '-' : 'S';
    keep(row.row, up || down);
  }
  proof.b_shift = lcp.ScaledNorm(w, lcp.matrix_bits() + bits);
  return proof;
}

bool ModeProof::IsBetterThan(const ModeProof& other) const {
  if (proof != other.proof) return proof == Proof::kModes;
  return std::max(b_shift, mu_shift) < std::max(other.b_shift, other.mu_shift);
}

ModeProof ProveModes(const LcpProblem& problem, const Eigen::VectorXd& start) {
  const RoundedModes rounded(problem);
  const bool is_start = start.size() == problem.size() && start.allFinite();
  Eigen::VectorXd f = is_start ? start : Eigen::VectorXd::Zero(problem.size());
  ModeProof best = ProveNearby(problem, f);
  std::string before;
  for (int step = 0; step < kMostSteps; ++step) {
    const std::string modes = ModesOf(problem, f);
    if (modes == before) break;
    before = modes;
    ModeEnclosure enclosure = rounded.Enclose(modes);
    if (enclosure.f.size() != problem.size()) break;
    f = std::move(enclosure.f);
    if (enclosure.signs == ModeEnclosure::Signs::kStrict) {
      return {ModeProof::Proof::kModes, modes, std::move(f), enclosure.error};
    }
    ModeProof nearby = ProveNearby(problem, f);
    if (nearby.IsBetterThan(best)) best = std::move(nearby);
  }
  return best;
}

}  // namespace lcpbench
