#include "solvers/pgs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "solvers/given_form.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Scaled forces below this share of the largest one can be rounding alone: a product of a row with up to some ten
// entries is off by that much.
constexpr double kNoise = 16 * std::numeric_limits<double>::epsilon();
// Entries of A per row (as BoundEntriesOfA counts them) up to which a sweep over A is at least as fast as one over J:
// measured, 0.6 ns per entry of A against 6 ns per two-body row.
constexpr Index kAssembledRowLimit = 14;

size_t At(Index i) { return static_cast<size_t>(i); }

// Rows that step differently: a bilateral row is not projected (floor -inf), a row without diagonal does not step
// (gain 0). Most problems have neither, and then the sweeps read no per-row control at all.
struct RowControl {
  double gain;   // omega, or 0
  double floor;  // 0, or -infinity
};

// What all sweeps share. `f`, `b` and the matrices are those of the scaled problem.
struct SweepState {
  Eigen::VectorXd f;
  Eigen::VectorXd b;
  std::vector<RowControl> control;  // empty: {omega, 0} in every row
  double omega = 1;

  // One Gauss-Seidel step; returns the change of f_i. Arguments of min and max are ordered so that a NaN stays.
  template <bool kMixed>
  double Step(Index i, double w, double* squares) {
    const double gain = kMixed ? control[At(i)].gain : omega;
    const double floor = kMixed ? control[At(i)].floor : 0.0;
    const double old = f[i];
    const double residual = kMixed && floor != 0 ? w : std::min(w, old);
    *squares += residual * residual;
    const double next = std::max(old - gain * w, floor);
    f[i] = next;
    return next - old;
  }
};

// ---- Assembled: rows of D^-1/2 A D^-1/2 without the diagonal, which is 1 (or 0). ----
class AssembledRows {
 public:
  void Reset(const SparseMatrix& A, const Eigen::VectorXd& inverse_root) {
    const Index n = A.rows();
    start_.assign(1, 0);
    column_.clear();
    value_.clear();
    column_.reserve(At(A.nonZeros()));
    value_.reserve(At(A.nonZeros()));
    diagonal_.setZero(n);
    for (Index i = 0; i < n; ++i) {
      for (SparseMatrix::InnerIterator it(A, i); it; ++it) {
        const double scaled = it.value() * inverse_root[i] * inverse_root[it.col()];
        if (it.col() == i) {
          diagonal_[i] = it.value() == 0 ? 0.0 : 1.0;
        } else if (scaled != 0) {
          column_.push_back(static_cast<int>(it.col()));
          value_.push_back(scaled);
        }
      }
      start_.push_back(static_cast<Index>(value_.size()));
    }
  }

  void Refresh(const Eigen::VectorXd& /*f*/) {}
  double W(Index i, const SweepState& s) const { return s.b[i] + diagonal_[i] * s.f[i] + OffDiagonal(i, s.f.data()); }
  Index RowEntries() const { return std::max<Index>(1, start_.back() / static_cast<Index>(start_.size())); }

  template <bool kMixed>
  double Sweep(Index begin, Index end, SweepState* s) {
    double squares = 0;
    for (Index i = begin; i < end; ++i) {
      const double own = kMixed ? diagonal_[i] * s->f[i] : s->f[i];
      s->Step<kMixed>(i, s->b[i] + own + OffDiagonal(i, s->f.data()), &squares);
    }
    return squares;
  }

 private:
  // Four sums: one alone would wait for its own addition at every entry.
  double OffDiagonal(Index i, const double* f) const {
    const double* value = value_.data();
    const int* column = column_.data();
    Index k = start_[At(i)];
    const Index end = start_[At(i) + 1];
    double s0 = 0, s1 = 0, s2 = 0, s3 = 0;
    for (; k + 4 <= end; k += 4) {
      s0 += value[k] * f[column[k]];
      s1 += value[k + 1] * f[column[k + 1]];
      s2 += value[k + 2] * f[column[k + 2]];
      s3 += value[k + 3] * f[column[k + 3]];
    }
    for (; k < end; ++k) s0 += value[k] * f[column[k]];
    return (s0 + s1) + (s2 + s3);
  }

  std::vector<Index> start_;
  std::vector<int> column_;
  std::vector<double> value_;
  Eigen::VectorXd diagonal_;
};

// ---- Matrix-free, two bodies per row: S = D^-1/2 J M^-1/2 in blocks of three; velocities v = S^T f. ----
class TwoBodyRows {
 public:
  void Reset(const LcpProblem& problem, const Eigen::VectorXd& inverse_root) {
    const SparseMatrix& J = problem.J();
    const Index n = J.rows();
    const Index bodies = J.cols() / 3;
    // Rows on one body (the other is fixed) write a spare body as their second, with factors 0. There are several
    // spares, so that neighbouring rows do not wait for each other's store.
    velocity_.assign(At(bodies + kSpares), {});
    rows_.assign(At(n), {});
    for (Index i = 0; i < n; ++i) {
      Row& row = rows_[At(i)];
      std::array<int, 2> body = {-1, -1};
      for (SparseMatrix::InnerIterator it(J, i); it; ++it) {
        const double m = problem.inverse_mass()[it.col()];
        if (m == 0 || it.value() == 0) continue;
        const auto block = static_cast<int>(it.col() / 3);
        const size_t side = body[0] < 0 || body[0] == block ? 0 : 1;
        body[side] = block;
        row.s[3 * side + At(it.col() % 3)] = it.value() * std::sqrt(m) * inverse_root[i];
      }
      row.b = 0;
      row.first = body[0] >= 0 ? body[0] : static_cast<int>(bodies + i % kSpares);
      row.second = body[1] >= 0 ? body[1] : static_cast<int>(bodies + (i + kSpares / 2) % kSpares);
    }
  }
  void SetB(const Eigen::VectorXd& b) {
    for (Index i = 0; i < b.size(); ++i) rows_[At(i)].b = b[i];
  }

  void Refresh(const Eigen::VectorXd& f) {
    std::fill(velocity_.begin(), velocity_.end(), Velocity{});
    for (Index i = 0; i < f.size(); ++i) {
      if (f[i] != 0) Push(rows_[At(i)], f[i]);
    }
  }
  double W(Index i, const SweepState& /*s*/) const { return Product(rows_[At(i)]); }
  static Index RowEntries() { return kEntriesPerRow; }

  template <bool kMixed>
  double Sweep(Index begin, Index end, SweepState* s) {
    double squares = 0;
    for (Index i = begin; i < end; ++i) {
      const Row& row = rows_[At(i)];
      Push(row, s->Step<kMixed>(i, Product(row), &squares));
    }
    return squares;
  }

 private:
  static constexpr Index kSpares = 8;
  static constexpr Index kEntriesPerRow = 12;
  struct alignas(64) Row {
    std::array<double, 6> s{};
    double b = 0;
    int first = 0;
    int second = 0;
  };
  // Padded to half a cache line, so that no body straddles two.
  struct alignas(32) Velocity {
    std::array<double, 4> v{};
  };

  double Product(const Row& row) const {
    const Velocity& p = velocity_[static_cast<size_t>(row.first)];
    const Velocity& q = velocity_[static_cast<size_t>(row.second)];
    const double first = row.s[0] * p.v[0] + row.s[1] * p.v[1] + row.s[2] * p.v[2];
    const double second = row.s[3] * q.v[0] + row.s[4] * q.v[1] + row.s[5] * q.v[2];
    return row.b + (first + second);
  }
  void Push(const Row& row, double df) {
    Velocity& p = velocity_[static_cast<size_t>(row.first)];
    Velocity& q = velocity_[static_cast<size_t>(row.second)];
    for (size_t k = 0; k < 3; ++k) p.v[k] += row.s[k] * df;
    for (size_t k = 0; k < 3; ++k) q.v[k] += row.s[k + 3] * df;
  }

  std::vector<Row> rows_;
  std::vector<Velocity> velocity_;
};

// ---- Matrix-free, any sparse J. ----
class SparseRows {
 public:
  void Reset(const LcpProblem& problem, const Eigen::VectorXd& inverse_root) {
    S_ = problem.J();
    for (Index i = 0; i < S_.rows(); ++i) {
      for (SparseMatrix::InnerIterator it(S_, i); it; ++it) {
        it.valueRef() *= std::sqrt(problem.inverse_mass()[it.col()]) * inverse_root[i];
      }
    }
    S_.prune(0.0, 0.0);
    S_.makeCompressed();
    velocity_.setZero(S_.cols());
  }

  void Refresh(const Eigen::VectorXd& f) {
    velocity_.setZero();
    for (Index i = 0; i < f.size(); ++i) {
      if (f[i] != 0) Push(i, f[i]);
    }
  }
  double W(Index i, const SweepState& s) const { return s.b[i] + Product(i); }
  Index RowEntries() const { return std::max<Index>(1, 2 * S_.nonZeros() / S_.rows()); }

  template <bool kMixed>
  double Sweep(Index begin, Index end, SweepState* s) {
    double squares = 0;
    for (Index i = begin; i < end; ++i) Push(i, s->Step<kMixed>(i, W(i, *s), &squares));
    return squares;
  }

 private:
  double Product(Index i) const {
    double sum = 0;
    for (SparseMatrix::InnerIterator it(S_, i); it; ++it) sum += it.value() * velocity_[it.col()];
    return sum;
  }
  void Push(Index i, double df) {
    for (SparseMatrix::InnerIterator it(S_, i); it; ++it) velocity_[it.col()] += it.value() * df;
  }

  SparseMatrix S_;
  Eigen::VectorXd velocity_;
};

void CheckRelaxation(double relaxation) {
  if (!(relaxation > 0 && relaxation < 2)) {
    throw InputError("pgs: option 'relaxation' must be in (0, 2), found " + std::to_string(relaxation));
  }
}

bool UsesFactors(const LcpProblem& problem, PgsOptions::Form form) {
  if (form != PgsOptions::Form::kAuto) return form == PgsOptions::Form::kMatrixFree;
  return problem.has_two_body_rows() && BoundEntriesOfA(problem) > kAssembledRowLimit * problem.size();
}

}  // namespace

struct PgsSolver::Workspace {
  std::variant<AssembledRows, TwoBodyRows, SparseRows> rows;
  SweepState state;
  GivenFormTest given;
  Eigen::VectorXd unit;       // f_i of the problem per f_i of the scaled problem
  Eigen::VectorXd best;       // scaled iterate of least rho
  Eigen::VectorXd candidate;  // unscaled iterate on trial for the claim
  bool mixed = false;

  // rho of the scaled problem at state.f, everything made afresh.
  template <typename Rows>
  double Rho(Rows* own) {
    own->Refresh(state.f);
    double squares = 0;
    for (Index i = 0; i < state.f.size(); ++i) {
      const double w = own->W(i, state);
      const bool free = mixed && state.control[At(i)].floor != 0;
      const double residual = free ? w : std::min(w, state.f[i]);
      squares += residual * residual;
    }
    return std::sqrt(squares);
  }

  double LargestForce() const {
    double largest = 0;
    for (const double force : state.f) largest = std::max(largest, std::abs(force));
    return largest;
  }

  template <bool kMixed, typename Rows>
  void Run(Rows* own, const LcpOptions& options, LcpResult* result);
};

template <bool kMixed, typename Rows>
void PgsSolver::Workspace::Run(Rows* own, const LcpOptions& options, LcpResult* result) {
  const Deadline deadline(options);
  const bool limited = std::isfinite(options.time_limit_s);
  const std::int64_t sweeps = options.max_iterations > 0 ? options.max_iterations : kDefaultSweeps;
  const Index n = state.f.size();
  const Index chunk = std::max<Index>(1, kEntriesPerClockRead / own->RowEntries());
  double best_rho = kInfinity;
  bool best_is_candidate = false;
  best = state.f;

  // True when the solve is over; the status says how.
  const auto check = [&] {
    const double rho = Rho(own);
    if (!std::isfinite(rho)) {
      result->status = LcpStatus::kNumericalFailure;
      result->detail = "the iterates overflow";
      return true;
    }
    if (rho < best_rho) {
      best_rho = rho;
      best = state.f;
    }
    if (rho > options.tolerance) return false;
    candidate = state.f.cwiseProduct(unit);
    if (!given.Meets(options.tolerance, candidate)) {
      // Forces that are nothing but rounding of others fail the backward error of rows where the answer is 0 = 0.
      const double noise = kNoise * LargestForce();
      for (Index i = 0; i < n; ++i) {
        if (std::abs(state.f[i]) <= noise) candidate[i] = 0;
      }
      if (!given.Meets(options.tolerance, candidate)) return false;
      best_is_candidate = true;
    }
    best = state.f;
    result->status = LcpStatus::kSolved;
    return true;
  };
  const auto finish = [&] {
    if (best_is_candidate) {
      result->f = candidate;
    } else {
      result->f = best.cwiseProduct(unit);
    }
  };

  if (check()) return finish();
  Index unread = 0;  // rows since the last clock read
  int unchecked = 0;
  bool tried_early = false;
  while (result->iterations < sweeps) {
    double squares = 0;
    for (Index begin = 0; begin < n;) {
      const Index end = std::min(n, begin + chunk - unread);
      squares += own->template Sweep<kMixed>(begin, end, &state);
      unread += end - begin;
      begin = end;
      if (unread < chunk) continue;
      unread = 0;
      if (limited && deadline.Expired()) {
        if (!check()) result->status = LcpStatus::kTimeLimit;
        return finish();
      }
    }
    ++result->iterations;
    ++unchecked;
    const bool early = !tried_early && std::sqrt(squares) <= options.tolerance;
    if (unchecked < kCheckInterval && !early && result->iterations < sweeps) continue;
    tried_early = early && unchecked < kCheckInterval;
    if (unchecked >= kCheckInterval) unchecked = 0;
    if (check()) return finish();
    if (limited && deadline.Expired()) {
      result->status = LcpStatus::kTimeLimit;
      return finish();
    }
  }
  result->status = LcpStatus::kIterationLimit;
  finish();
}

PgsOptions PgsOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("pgs", settings);
  PgsOptions options;
  const std::string form = reader.Choice("form", "auto", {"auto", "assembled", "matrix-free"});
  if (form == "assembled") options.form = Form::kAssembled;
  if (form == "matrix-free") options.form = Form::kMatrixFree;
  options.relaxation = reader.Number("relaxation", options.relaxation, 0.0, 2.0);
  reader.Finish();
  CheckRelaxation(options.relaxation);
  return options;
}

PgsSolver::PgsSolver(PgsOptions options) : options_(options), work_(std::make_unique<Workspace>()) {
  CheckRelaxation(options.relaxation);
}
PgsSolver::~PgsSolver() = default;

std::string PgsSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (problem.has_factors()) return {};
  if (options_.form == PgsOptions::Form::kMatrixFree) return "the matrix-free form needs a problem given by factors";
  const Eigen::VectorXd& D = problem.DiagonalA();
  for (Index i = 0; i < D.size(); ++i) {
    if (D[i] < 0) return "A has a negative diagonal entry in row " + std::to_string(i);
  }
  return {};
}

void PgsSolver::DoPrepare(const LcpProblem& problem) {
  Workspace& work = *work_;
  const Index n = problem.size();
  const Eigen::VectorXd& D = problem.DiagonalA();
  const Eigen::VectorXd inverse_root = D.unaryExpr([](double d) { return d == 0 ? 1.0 : 1.0 / std::sqrt(d); });

  SweepState& state = work.state;
  state.omega = options_.relaxation;
  state.f.setZero(n);
  state.b = problem.b().cwiseProduct(inverse_root);
  long double b_squared = 0;  // its exponent range holds the square of every double
  for (const double value : state.b) b_squared += static_cast<long double>(value) * value;
  const auto b_norm = static_cast<double>(std::sqrt(b_squared));
  if (b_norm > 0) state.b /= b_norm;
  work.unit = inverse_root * (b_norm > 0 ? b_norm : 1.0);
  work.best.setZero(n);
  work.candidate.setZero(n);

  work.mixed = !problem.bilateral_rows().empty() || (D.array() == 0).any();
  state.control.clear();
  if (work.mixed) {
    state.control.assign(At(n), {options_.relaxation, 0.0});
    for (const Index i : problem.bilateral_rows()) state.control[At(i)].floor = -kInfinity;
    for (Index i = 0; i < n; ++i) {
      if (D[i] == 0) state.control[At(i)].gain = 0;
    }
  }

  if (!UsesFactors(problem, options_.form)) {
    work.rows.emplace<AssembledRows>().Reset(problem.SparseA(), inverse_root);
  } else if (problem.has_two_body_rows()) {
    auto& rows = work.rows.emplace<TwoBodyRows>();
    rows.Reset(problem, inverse_root);
    rows.SetB(state.b);
  } else {
    work.rows.emplace<SparseRows>().Reset(problem, inverse_root);
  }
  work.given.Reset(problem);
}

void PgsSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  Workspace& work = *work_;
  SweepState& state = work.state;
  if (options.initial_f == nullptr) {
    state.f.setZero();
  } else {
    for (Index i = 0; i < state.f.size(); ++i) {
      const bool held = work.mixed && state.control[At(i)].gain == 0;
      const double start = (*options.initial_f)[i] / work.unit[i];
      state.f[i] = held ? 0.0 : problem.is_bilateral(i) ? start : std::max(start, 0.0);
    }
  }
  std::visit(
      [&](auto& rows) {
        if (work.mixed) {
          work.Run<true>(&rows, options, result);
        } else {
          work.Run<false>(&rows, options, result);
        }
      },
      work.rows);
}

}  // namespace lcpbench
