#include "solvers/friction/few_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/lcp/law.h"
#include "solvers/rows/two_body_product.h"

namespace lcpbench {
namespace {

constexpr int kSteps = 5;
// About the iterate, so that redundant contacts do no harm.
constexpr double kEps = 1e-13;

// Normal and friction row of each contact in turn; mu.
using RowsInOrder = std::array<std::int32_t, 2 * FewContacts::kMostContacts>;
using Coefficients = std::array<double, FewContacts::kMostContacts>;

// n = 2 contacts rows: normal and friction row of each contact in turn.
template <int n>
class Contacts {
 public:
  // Apart from Find: where wide registers are in use all through, GCC leaves their upper halves in use at the end, and
  // what follows waits.
  template <int p, typename Real>
  [[gnu::noinline]] bool Load(const StepRows& step, const Real* J, const RowsInOrder& order, const Coefficients& mu);
  void Start(const RowsInOrder& order, const double* initial_f);
  [[gnu::noinline]] bool Find(double tolerance, bool is_warm, std::int64_t* iterations);
  void Store(const RowsInOrder& order, double* f, double* w) const;
  double rho() const { return rho_; }

 private:
  void ComputeGaps() {
    for (int i = 0; i < n; ++i) {
      omega_[i] = b_[i];
      for (int j = 0; j < n; ++j) omega_[i] += A_[i][j] * phi_[j];
    }
  }
  // visit(row, range) at these forces of normal rows.
  template <typename Force, typename Visit>
  void VisitRanges(const Force& force, const Visit& visit) const {
    for (int i = 0; i < n; i += 2) {
      const double most = mu_[i / 2] * std::max(force(i), 0.0);
      visit(i, HalfLineRange{});
      visit(i + 1, IntervalRange{-most, most});
    }
  }
  void FindSides(RangeSide* sides) const {
    const auto trial = [this](int i) { return phi_[i] - omega_[i]; };
    VisitRanges(trial, [&](int i, const auto& range) { sides[i] = SideOf(range, trial(i)); });
  }
  void AddResiduals(LawSums<double>* sums) const {
    VisitRanges([this](int i) { return phi_[i]; },
                [&](int i, const auto& range) { sums->AddResidual(ResidualOf(range, phi_[i], omega_[i])); });
  }
  double Rho() const {
    LawSums<double> sums;
    AddResiduals(&sums);
    return sums.norm() / scale_;
  }
  bool SolveSides(const RangeSide* sides);
  void ObeyLaws();
  bool IsSurelyRight(double tolerance);
  bool Passes(double rho, double tolerance) {
    if (!(rho <= tolerance)) return false;
    ObeyLaws();
    return IsSurelyRight(tolerance);
  }

  double A_[n][n], b_[n], root_[n];
  double mu_[n / 2], given_mu_[n / 2];
  double scale_ = 1, rho_ = 0;
  double phi_[n], omega_[n], f_[n];
};

// False where a friction row is on other bodies than its normal row, and where a row moves nothing.
template <int n>
template <int p, typename Real>
bool Contacts<n>::Load(const StepRows& step, const Real* J, const RowsInOrder& order, const Coefficients& mu) {
  if (!AssembleFew<p, 2>(step, J, order.data(), A_)) return false;
  double inverse_root[n];
  for (int i = 0; i < n; ++i) {
    root_[i] = std::sqrt(A_[i][i]);
    inverse_root[i] = 1 / root_[i];
    b_[i] = step.b[order[static_cast<std::size_t>(i)]] * inverse_root[i];
    for (int j = 0; j <= i; ++j) A_[i][j] = A_[j][i] = A_[i][j] * (inverse_root[i] * inverse_root[j]);
  }
  double plain = 0, answered = 0, all = 0;
  for (int i = 0; i < n; i += 2) plain += law::Square(b_[i]);
  for (int k = 0; k < n / 2; ++k) {
    given_mu_[k] = mu[static_cast<std::size_t>(k)];
    mu_[k] = given_mu_[k] * (root_[2 * k + 1] * inverse_root[2 * k]);
    const double load = law::Square(b_[2 * k + 1]);
    answered += std::min(load, law::Square(mu_[k]) * plain);
    all += load;
  }
  scale_ = law::Scale(plain, answered, all + plain);
  return true;
}

template <int n>
void Contacts<n>::Start(const RowsInOrder& order, const double* initial_f) {
  for (int i = 0; i < n; ++i) {
    phi_[i] = initial_f == nullptr ? 0 : root_[i] * initial_f[order[static_cast<std::size_t>(i)]];
  }
}

// phi of these sides, with an equation for each row: of its gap, or of its force. False where they are singular.
template <int n>
bool Contacts<n>::SolveSides(const RangeSide* sides) {
  double K[n][n], y[n];
  for (int i = 0; i < n; i += 2) {
    for (int r = i; r < i + 2; ++r) {
      const bool has_gap = sides[r] == RangeSide::kInside;
      for (int j = 0; j < n; ++j) K[r][j] = has_gap ? A_[r][j] : 0;
      K[r][r] += has_gap ? kEps : 1;
      y[r] = has_gap ? kEps * phi_[r] - b_[r] : 0;
    }
    if (sides[i + 1] != RangeSide::kInside) K[i + 1][i] = -static_cast<int>(sides[i + 1]) * mu_[i / 2];
  }
  for (int k = 0; k < n; ++k) {
    int pivot = k;
    for (int i = k + 1; i < n; ++i) pivot = std::abs(K[i][k]) > std::abs(K[pivot][k]) ? i : pivot;
    if (!(std::abs(K[pivot][k]) > 0)) return false;
    if (pivot != k) {
      for (int j = k; j < n; ++j) std::swap(K[k][j], K[pivot][j]);
      std::swap(y[k], y[pivot]);
    }
    const double inverse = 1 / K[k][k];
    for (int i = k + 1; i < n; ++i) {
      const double factor = K[i][k] * inverse;
      for (int j = k + 1; j < n; ++j) K[i][j] -= factor * K[k][j];
      y[i] -= factor * y[k];
    }
    K[k][k] = inverse;
  }
  for (int k = n - 1; k >= 0; --k) {
    double sum = y[k];
    for (int j = k + 1; j < n; ++j) sum -= K[k][j] * phi_[j];
    phi_[k] = sum * K[k][k];
  }
  return true;
}

template <int n>
bool Contacts<n>::Find(double tolerance, bool is_warm, std::int64_t* iterations) {
  ComputeGaps();
  if (is_warm && Passes(Rho(), tolerance)) return true;
  RangeSide sides[n], next[n];
  FindSides(sides);
  for (int step = 0; step < kSteps; ++step) {
    if (!SolveSides(sides)) return false;
    ++*iterations;
    ComputeGaps();
    const double rho = Rho();
    if (Passes(rho, tolerance)) return true;
    FindSides(next);
    if (!std::isfinite(rho) || std::equal(sides, sides + n, next)) return false;
    std::copy_n(next, n, sides);
  }
  return false;
}

// Forces in the problem's units that obey the laws of forces exactly, as ContactRows::ToForces.
template <int n>
void Contacts<n>::ObeyLaws() {
  RangeSide sides[n];
  FindSides(sides);
  for (int i = 0; i < n; i += 2) {
    const double least = law::kPartOfLoad * std::max(std::abs(b_[i]), std::abs(b_[i + 1]));
    const bool is_open = sides[i] == RangeSide::kLower || (phi_[i] < least && std::abs(phi_[i + 1]) < least);
    f_[i] = is_open ? 0 : std::max(phi_[i], 0.0) / root_[i];
    const double most = given_mu_[i / 2] * f_[i];
    f_[i + 1] = sides[i + 1] != RangeSide::kInside ? static_cast<int>(sides[i + 1]) * most
                                                   : std::clamp(phi_[i + 1] / root_[i + 1], -most, most);
  }
}

// Judges f_, and leaves its gaps in omega_.
template <int n>
bool Contacts<n>::IsSurelyRight(double tolerance) {
  double forces = 0;
  double size[n];
  for (int i = 0; i < n; ++i) {
    phi_[i] = root_[i] * f_[i];
    forces += std::abs(phi_[i]);
  }
  constexpr double kUnit = (n + law::kTermsBesideRows) * std::numeric_limits<double>::epsilon();
  for (int i = 0; i < n; ++i) {
    omega_[i] = b_[i];
    size[i] = std::abs(b_[i]);
    for (int j = 0; j < n; ++j) {
      omega_[i] += A_[i][j] * phi_[j];
      size[i] += std::abs(A_[i][j] * phi_[j]);
    }
  }
  LawSums<double> sums(std::sqrt(tolerance));
  AddResiduals(&sums);
  rho_ = sums.norm() / scale_;
  for (int i = 0; i < n; i += 2) {
    const double of_normal = kUnit * (forces + size[i]), of_tangent = kUnit * (forces + size[i + 1]);
    sums.AddHidden(of_normal, GapDefect(omega_[i], f_[i] == 0, false), size[i]);
    const double most = given_mu_[i / 2] * f_[i], along = f_[i + 1];
    if (most == 0 && along == 0) {
      sums.AddHidden(of_tangent);
    } else {
      sums.AddHidden(of_tangent, GapDefect(omega_[i + 1], along == -most, along == most), size[i + 1]);
    }
  }
  return sums.AreSurelyRight(tolerance, scale_);
}

template <int n>
void Contacts<n>::Store(const RowsInOrder& order, double* f, double* w) const {
  for (int i = 0; i < n; ++i) {
    const std::int32_t row = order[static_cast<std::size_t>(i)];
    f[row] = f_[i];
    if (w != nullptr) w[row] = omega_[i] * root_[i];
  }
}

template <int n>
bool SolveContacts(const StepRows& rows, const RowsInOrder& order, const Coefficients& mu, double tolerance,
                   const double* initial_f, double* f, double* w, double* rho, std::int64_t* iterations) {
  Contacts<n> contacts;
  if (!WithNumbers(rows, [&](const auto* J, auto p) { return contacts.template Load<p>(rows, J, order, mu); })) {
    return false;
  }
  contacts.Start(order, initial_f);
  if (!contacts.Find(tolerance, initial_f != nullptr, iterations)) return false;
  contacts.Store(order, f, w);
  *rho = contacts.rho();
  return true;
}

}  // namespace

bool FewContacts::Solve(const StepRows& rows, Index size, std::span<const FrictionRow> friction, double tolerance,
                        const double* initial_f, double* f, double* w, double* rho, std::int64_t* iterations) {
  const Index contacts = std::ssize(friction);
  if (contacts == 0 || contacts > kMostContacts || size != 2 * contacts) return false;
  RowsInOrder order{};
  Coefficients mu{};
  std::size_t taken = 0;
  const auto take = [&](Index row) {
    const bool is_row = row >= 0 && row < rows.rows && (rows.bilateral == nullptr || rows.bilateral[row] == 0);
    const std::int32_t* const begin = order.data();
    const std::int32_t* const end = begin + taken;
    if (!is_row || std::find(begin, end, row) != end) return false;
    order[taken++] = static_cast<std::int32_t>(row);
    return true;
  };
  for (const FrictionRow& row : friction) {
    mu[taken / 2] = row.mu;
    const bool fits = row.slip == 0 && row.mu > 0 && row.mu <= std::numeric_limits<double>::max();
    if (!fits || !take(row.normal) || !take(row.row)) return false;
  }
  constexpr auto kSolve = []<std::size_t... k>(std::index_sequence<k...>) {
    return std::array{&SolveContacts<2 * (static_cast<int>(k) + 1)>...};
  }
  (std::make_index_sequence<kMostContacts>());
  return kSolve[static_cast<std::size_t>(contacts - 1)](rows, order, mu, tolerance, initial_f, f, w, rho, iterations);
}

}  // namespace lcpbench
