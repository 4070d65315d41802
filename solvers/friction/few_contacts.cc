#include "solvers/friction/few_contacts.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "solvers/friction/contact_law.h"

namespace lcpbench {
namespace {

constexpr int kSteps = 5;
// About the iterate, so that redundant contacts do no harm.
constexpr double kEps = 1e-13;

// Normal and friction row of each contact in turn; mu.
using RowsInOrder = std::array<int, 2 * FewContacts::kMostContacts>;
using Coefficients = std::array<double, FewContacts::kMostContacts>;

// n = 2 contacts rows: normal and friction row of each contact in turn.
template <int n>
class Contacts {
 public:
  template <Index p, typename Real>
  bool Load(const StepRows& step, const Real* J, const RowsInOrder& order, const Coefficients& mu);
  void Start(const RowsInOrder& order, const double* initial_f);
  bool Find(double tolerance, bool is_warm, std::int64_t* iterations);
  void Store(const RowsInOrder& order, double* f, double* w) const;
  double rho() const { return rho_; }

 private:
  void ComputeGaps() {
    for (int i = 0; i < n; ++i) {
      omega_[i] = b_[i];
      for (int j = 0; j < n; ++j) omega_[i] += A_[i][j] * phi_[j];
    }
  }
  unsigned Modes() const;
  RowMode ModeOf(int contact) const {
    const int i = 2 * contact;
    return ContactLaw::ModeOf(mu_[contact], phi_[i] - omega_[i], phi_[i + 1] - omega_[i + 1]);
  }
  double Rho() const;
  bool SolveModes();
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
template <Index p, typename Real>
bool Contacts<n>::Load(const StepRows& step, const Real* J, const RowsInOrder& order, const Coefficients& mu) {
  double jacobian[n][2 * p];
  std::int32_t body[n / 2][2];
  for (int k = 0; k < n / 2; ++k) {
    double momentum[2][2 * p];
    for (int r = 0; r < 2; ++r) {
      const int i = 2 * k + r;
      const Index row = order[static_cast<std::size_t>(i)];
      for (int s = 0; s < 2; ++s) {
        const std::int32_t of = step.body[2 * row + s];
        if (r == 0) body[k][s] = of;
        if (of != body[k][s]) return false;
        for (Index c = 0; c < p; ++c) {
          const double j = of < 0 ? 0.0 : static_cast<double>(J[(2 * row + s) * p + c]);
          jacobian[i][s * p + c] = j;
          momentum[r][s * p + c] = of < 0 ? 0.0 : step.inverse_mass[of * p + c] * j;
        }
      }
    }
    for (int l = 0; l <= k; ++l) {
      double sum[2][2] = {};
      for (int s = 0; s < 2; ++s) {
        for (int t = 0; t < 2; ++t) {
          if (body[k][s] < 0 || body[k][s] != body[l][t]) continue;
          for (int r = 0; r < 2; ++r) {
            for (int q = 0; q < 2; ++q) {
              for (Index c = 0; c < p; ++c) sum[r][q] += momentum[r][s * p + c] * jacobian[2 * l + q][t * p + c];
            }
          }
        }
      }
      for (int r = 0; r < 2; ++r) {
        for (int q = 0; q < 2; ++q) A_[2 * k + r][2 * l + q] = sum[r][q];
      }
    }
    if (!(A_[2 * k][2 * k] > 0 && A_[2 * k + 1][2 * k + 1] > 0)) return false;
  }
  double inverse_root[n];
  for (int i = 0; i < n; ++i) {
    root_[i] = std::sqrt(A_[i][i]);
    inverse_root[i] = 1 / root_[i];
    b_[i] = step.b[order[static_cast<std::size_t>(i)]] * inverse_root[i];
    for (int j = 0; j <= i; ++j) A_[i][j] = A_[j][i] = A_[i][j] * (inverse_root[i] * inverse_root[j]);
  }
  double plain = 0, answered = 0, all = 0;
  for (int i = 0; i < n; i += 2) plain += ContactLaw::Square(b_[i]);
  for (int k = 0; k < n / 2; ++k) {
    given_mu_[k] = mu[static_cast<std::size_t>(k)];
    mu_[k] = given_mu_[k] * (root_[2 * k + 1] * inverse_root[2 * k]);
    const double load = ContactLaw::Square(b_[2 * k + 1]);
    answered += std::min(load, ContactLaw::Square(mu_[k]) * plain);
    all += load;
  }
  scale_ = ContactLaw::Scale(plain, answered, all + plain);
  return true;
}

template <int n>
void Contacts<n>::Start(const RowsInOrder& order, const double* initial_f) {
  for (int i = 0; i < n; ++i) {
    phi_[i] = initial_f == nullptr ? 0 : root_[i] * initial_f[order[static_cast<std::size_t>(i)]];
  }
}

template <int n>
unsigned Contacts<n>::Modes() const {
  unsigned modes = 0;
  for (int k = 0; k < n / 2; ++k) modes = modes << 3U | static_cast<unsigned>(ModeOf(k));
  return modes;
}

template <int n>
double Contacts<n>::Rho() const {
  double sum = 0;
  for (int i = 0; i < n; i += 2) {
    sum += ContactLaw::Square(std::min(phi_[i], omega_[i])) +
           ContactLaw::Square(ContactLaw::Residual(mu_[i / 2], phi_[i], phi_[i + 1], omega_[i + 1]));
  }
  return std::sqrt(sum) / scale_;
}

// phi of its modes, with an equation for each row: of its gap, or of its force. False where they are singular.
template <int n>
bool Contacts<n>::SolveModes() {
  double K[n][n], y[n];
  for (int i = 0; i < n; i += 2) {
    const RowMode mode = ModeOf(i / 2);
    for (int r = i; r < i + 2; ++r) {
      const bool has_gap = mode == RowMode::kStick || (mode != RowMode::kOpen && r == i);
      for (int j = 0; j < n; ++j) K[r][j] = has_gap ? A_[r][j] : 0;
      K[r][r] += has_gap ? kEps : 1;
      y[r] = has_gap ? kEps * phi_[r] - b_[r] : 0;
    }
    if (mode == RowMode::kUp) K[i + 1][i] = mu_[i / 2];
    if (mode == RowMode::kDown) K[i + 1][i] = -mu_[i / 2];
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
  for (int step = 0; step < kSteps; ++step) {
    const unsigned modes = Modes();
    if (!SolveModes()) return false;
    ++*iterations;
    ComputeGaps();
    const double rho = Rho();
    if (Passes(rho, tolerance)) return true;
    if (!std::isfinite(rho) || Modes() == modes) return false;
  }
  return false;
}

// Forces in the problem's units that obey the laws of forces exactly, as ContactRows::ToForces.
template <int n>
void Contacts<n>::ObeyLaws() {
  for (int k = 0; k < n / 2; ++k) {
    const int i = 2 * k;
    const RowMode mode = ModeOf(k);
    const double least = ContactLaw::kPartOfLoad * std::max(std::abs(b_[i]), std::abs(b_[i + 1]));
    const bool is_open = mode == RowMode::kOpen || (phi_[i] < least && std::abs(phi_[i + 1]) < least);
    f_[i] = is_open ? 0 : std::max(phi_[i], 0.0) / root_[i];
    f_[i + 1] = is_open ? 0 : ContactLaw::Friction(mode, given_mu_[k] * f_[i], phi_[i + 1] / root_[i + 1]);
  }
}

// Of f_; its gaps are those in omega_ then.
template <int n>
bool Contacts<n>::IsSurelyRight(double tolerance) {
  double forces = 0;
  double size[n];
  for (int i = 0; i < n; ++i) {
    phi_[i] = root_[i] * f_[i];
    forces += std::abs(phi_[i]);
  }
  constexpr double kUnit = (n + ContactLaw::kTermsBesideRows) * std::numeric_limits<double>::epsilon();
  double hidden = 0;
  for (int i = 0; i < n; ++i) {
    omega_[i] = b_[i];
    size[i] = std::abs(b_[i]);
    for (int j = 0; j < n; ++j) {
      omega_[i] += A_[i][j] * phi_[j];
      size[i] += std::abs(A_[i][j] * phi_[j]);
    }
    hidden += ContactLaw::Square(kUnit * (forces + size[i]));
  }
  rho_ = Rho();
  if (!(rho_ + std::sqrt(hidden) / scale_ <= tolerance)) return false;
  bool is_right = true;
  const double limit = std::sqrt(tolerance);
  const auto require = [&](int i, double defect) {
    is_right = is_right && defect + kUnit * (forces + size[i]) <= limit * size[i];
  };
  for (int k = 0; k < n / 2; ++k) {
    const int i = 2 * k;
    require(i, f_[i] == 0 ? -omega_[i] : std::abs(omega_[i]));
    const double most = given_mu_[k] * f_[i];
    if (most != 0 || f_[i + 1] != 0) require(i + 1, ContactLaw::Defect(most, f_[i + 1], omega_[i + 1]));
  }
  return is_right;
}

template <int n>
void Contacts<n>::Store(const RowsInOrder& order, double* f, double* w) const {
  for (int i = 0; i < n; ++i) {
    const int row = order[static_cast<std::size_t>(i)];
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
    const int* const begin = order.data();
    const int* const end = begin + taken;
    if (!is_row || std::find(begin, end, row) != end) return false;
    order[taken++] = static_cast<int>(row);
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
