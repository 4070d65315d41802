#include "solvers/derivative/derivative.h"

#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "solvers/auto/auto_solver.h"
#include "solvers/friction/mode_equations.h"
#include "solvers/friction/mode_factor.h"
#include "solvers/lcp/verify.h"
#include "solvers/linear_algebra/islands.h"
#include "solvers/linear_algebra/sparse_lu.h"
#include "solvers/pivoting/least_norm.h"
#include "support/array_index.h"
#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

using Vector = Eigen::VectorXd;

// Parts of the size of the change: equations that are missed by more contradict each other; answers of the problem of
// degenerate rows and of its modes that differ by more disagree.
constexpr double kConsistent = 1e-6, kAgrees = 1e-5;
// Forces that keep contacts closed, over the size of the change: the second where the first is too small.
constexpr double kOffsets[] = {64, 65536};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What a row does while the data change: df = c; dw = 0; friction that slips with w > 0, w < 0.
enum class Role : unsigned char { kFixed, kEquation, kUp, kDown };
int SlipOf(Role role) { return role == Role::kUp ? 1 : role == Role::kDown ? -1 : 0; }
Role SlipTo(bool up) { return up ? Role::kUp : Role::kDown; }

double Largest(const Vector& x) { return x.size() == 0 ? 0 : x.lpNorm<Eigen::Infinity>(); }

void CheckSize(const char* name, Index rows, Index columns, Index n, Index m) {
  if (rows == n && columns == m) return;
  const auto shape = [](Index r, Index c) { return std::to_string(r) + " x " + std::to_string(c); };
  throw InputError(std::string("derivative: expected ") + name + " of shape " + shape(n, m) + ", found " +
                   shape(rows, columns));
}

// The linear system of a choice of roles, rows scaled: K = D^-1/2 A_E B.
class Mode {
 public:
  Mode(const LcpProblem& problem, const std::vector<Role>& roles, const Vector& root, double rank_tolerance)
      : problem_(problem) {
    std::vector<RangeSide> sides;
    for (const Role role : roles) {
      sides.push_back(role == Role::kEquation ? RangeSide::kInside
                      : role == Role::kDown   ? RangeSide::kUpper
                                              : RangeSide::kLower);
    }
    of_.Set(sides, problem.friction_rows(), std::vector<BoundedRow>());
    root_ = root(of_.equation);
    std::vector<Eigen::Triplet<double, int>> entries;
    for (Index k = 0; k < root_.size(); ++k) {
      for (SparseMatrix::InnerIterator it(problem.SparseA(), of_.equation[At(k)]); it; ++it) {
        const Index j = of_.unknown[At(it.col())];
        const double value = it.value() * of_.coefficient[At(it.col())] / root_[k];
        if (j >= 0) entries.emplace_back(static_cast<int>(k), static_cast<int>(j), value);
      }
    }
    K_.resize(root_.size(), root_.size());
    K_.setFromTriplets(entries.begin(), entries.end());
    Factor(rank_tolerance);
  }

  const std::vector<Index>& equations() const { return of_.equation; }
  bool is_singular() const { return is_singular_; }

  // df with (A df + r)_E = 0, the least dy where there are many; df = c elsewhere, plus what follows from the unknowns.
  Vector Solve(const Vector& r, const Vector& c) const {
    const Vector rest = r + problem_.SparseA() * c;
    return c + Expand(solve_(-rest(of_.equation).cwiseQuotient(root_)));
  }
  // lambda, 0 but on E, with lambda.r = df_bar.Solve(r, 0) for all r.
  Vector SolveTransposed(const Vector& df_bar) const {
    Vector y = Vector::Zero(root_.size()), lambda = Vector::Zero(df_bar.size());
    for (Index i = 0; i < df_bar.size(); ++i) {
      if (of_.unknown[At(i)] >= 0) y[of_.unknown[At(i)]] += of_.coefficient[At(i)] * df_bar[i];
    }
    lambda(of_.equation) = -solve_transposed_(y).cwiseQuotient(root_);
    return lambda;
  }
  // For plain problems: the least l with A_E l = f_E, and the part of x_E in the null space of A_E.
  Vector Multipliers(const Vector& f) const { return Expand(solve_(f(of_.equation).cwiseQuotient(root_))); }
  Vector FreePart(const Vector& x) const { return Expand(x(of_.equation) - solve_(K_ * x(of_.equation))); }

 private:
  Vector Expand(const Vector& y) const {
    Vector x = Vector::Zero(problem_.size());
    for (Index i = 0; i < x.size(); ++i) {
      if (of_.unknown[At(i)] >= 0) x[i] = of_.coefficient[At(i)] * y[of_.unknown[At(i)]];
    }
    return x;
  }

  template <typename Factorization>
  void Take(const std::shared_ptr<Factorization>& factor) {
    solve_ = [factor](const Vector& x) -> Vector { return factor->solve(x); };
    solve_transposed_ = [factor](const Vector& x) -> Vector { return factor->transpose().solve(x); };
  }

  // Whether a known solution comes back: rounding moves it by the condition of K times a rounding.
  bool IsRegular(double rank_tolerance) const {
    constexpr double kGolden = 0.6180339887498949;
    Vector x(K_.cols());
    for (Index k = 0; k < x.size(); ++k) x[k] = (1 + std::fmod(static_cast<double>(k + 1) * kGolden, 1.0)) / root_[k];
    const Vector back = solve_(K_ * x);
    return back.allFinite() && (back - x).cwiseProduct(root_).norm() <= std::numeric_limits<double>::epsilon() /
                                                                            rank_tolerance *
                                                                            x.cwiseProduct(root_).norm();
  }

  void Factor(double rank_tolerance) {
    solve_ = solve_transposed_ = [](const Vector& x) { return x; };
    if (K_.rows() == 0) return;
    if (K_.rows() <= ModeFactor::kMostDense) {
      Take(std::make_shared<Eigen::PartialPivLU<Eigen::MatrixXd>>(Eigen::MatrixXd(K_)));
      if (IsRegular(rank_tolerance)) return;
    } else {
      const auto factor = std::make_shared<SparseLu>();
      solve_ = [factor](const Vector& x) { return factor->Solve(x); };
      solve_transposed_ = [factor](const Vector& x) { return factor->SolveTransposed(x); };
      if (factor->Factorize(K_) && IsRegular(rank_tolerance)) return;
    }
    const auto factor = std::make_shared<Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>>();
    factor->setThreshold(rank_tolerance);
    factor->compute(Eigen::MatrixXd(K_));
    is_singular_ = factor->rank() < K_.rows();
    Take(factor);
  }

  LcpProblem problem_;
  ModeEquations<double> of_;
  Vector root_;  // D^1/2 on E
  Eigen::SparseMatrix<double> K_;
  std::function<Vector(const Vector&)> solve_, solve_transposed_;  // K, the least solution; and its transpose
  bool is_singular_ = false;
};

// What a direction does.
struct Load {
  Vector r, c;
};

// The problem whose solution x gives df = x + c - offset on `rows`. Contacts that slide, or may, get an offset of force
// that keeps them closed: the law of friction near f_n > 0 is that of its rows.
struct OneSided {
  std::vector<Index> rows;
  Vector offset;  // n
  LcpProblem problem;
};

}  // namespace

// The solution, and what its rows do while the data change.
struct Derivative::Point {
  Point(const LcpProblem& given, const Vector& forces_given, const DerivativeOptions& given_options)
      : problem(given), options(given_options), f(forces_given) {
    for (const double value : {options.tolerance, options.degeneracy_tolerance, options.rank_tolerance}) {
      if (!(value > 0 && value < 1)) {
        throw InputError("derivative: expected tolerances in (0, 1), found " + NumberText(value));
      }
    }
    CheckSize("f", f.size(), 1, problem.size(), 1);
    const Metrics metrics = ComputeMetrics(problem, f);
    if (!PassesTier(metrics, options.tolerance)) {
      throw InputError("derivative: expected forces that solve the problem to " + NumberText(options.tolerance) +
                       ", found rho " + NumberText(metrics.rho) + ", eta " + NumberText(metrics.backward_error));
    }
    root = problem.DiagonalA().unaryExpr([](double d) { return d > 0 ? std::sqrt(d) : 1.0; });
    Classify();
    if (mode->is_singular() || (problem.is_plain() && !is_strict && MakeMode(Closed()).is_singular())) TakeLeastNorm();
    Polish();
  }

  bool IsClear(Index row, double scaled) const { return scaled > limit[row]; }
  bool IsEquation(Index row) const { return roles[At(row)] == Role::kEquation; }
  bool IsDegenerate(Index row) const { return degenerate[At(row)] != 0; }
  int Slip(Index row) const { return SlipOf(roles[At(row)]); }
  bool IsAtLower(Index row) const { return f[row] - lower[row] < upper[row] - f[row]; }
  // mu = 0, and no slip: |df| <= dmu f_n.
  bool HasBounds(const FrictionRow& row) const {
    return row.mu == 0 && IsDegenerate(row.row) && IsEquation(row.normal);
  }
  // Where degenerate contacts are closed.
  std::vector<Role> Closed() const {
    std::vector<Role> closed = roles;
    for (size_t i = 0; i < closed.size(); ++i) closed[i] = degenerate[i] != 0 ? Role::kEquation : closed[i];
    return closed;
  }
  Mode MakeMode(const std::vector<Role>& of) const { return {problem, of, root, options.rank_tolerance}; }
  Vector Nowhere() const { return Vector::Constant(f.size(), std::numeric_limits<double>::quiet_NaN()); }

  void SetLimits() {
    Islands islands;
    islands.Find(problem.SparseA(), std::vector<char>(At(problem.size()), 1), problem.friction_rows());
    limit.resize(problem.size());
    for (Index k = 0; k < islands.count(); ++k) {
      double force = 0, gap = 0;
      for (const Index i : islands.rows(k)) {
        force = std::max(force, std::abs(root[i] * f[i]));
        gap = std::max(gap, std::abs(w[i] / root[i]));
      }
      for (const Index i : islands.rows(k)) limit[i] = options.degeneracy_tolerance * (force > 0 ? force : gap);
    }
  }

  void ClassifyRow(Index i) {
    const bool slips = IsClear(i, std::abs(w[i] / root[i]));
    const bool is_inside = IsClear(i, root[i] * std::min(f[i] - lower[i], upper[i] - f[i]));
    if (is_inside) roles[At(i)] = Role::kEquation;
    degenerate[At(i)] = is_inside || slips ? 0 : 1;
  }

  void Classify() {
    problem.ComputeW(f, &w);
    SetLimits();
    roles.assign(At(problem.size()), Role::kFixed);
    degenerate.assign(roles.size(), 0);
    lower = Vector::Zero(problem.size());
    upper = Vector::Constant(problem.size(), kInfinity);
    for (const Index i : problem.bilateral_rows()) lower[i] = -kInfinity;
    for (const BoundedRow& row : problem.bounded_rows()) {
      lower[row.row] = row.lower;
      upper[row.row] = row.upper;
    }
    for (Index i = 0; i < problem.size(); ++i) {
      if (problem.kind(i) != RowKind::kFriction) ClassifyRow(i);
      if (lower[i] == upper[i]) degenerate[At(i)] = 0;
    }
    for (const FrictionRow& row : problem.friction_rows()) {
      upper[row.row] = IsEquation(row.normal) ? row.mu * f[row.normal] : 0;
      lower[row.row] = -upper[row.row];
      if (!IsEquation(row.normal) && !IsDegenerate(row.normal)) continue;  // open
      ClassifyRow(row.row);
      const bool slips = IsClear(row.row, std::abs(w[row.row] / root[row.row]));
      if (row.slip != 0) degenerate[At(row.row)] = 0;
      if (row.slip != 0 || !IsEquation(row.row)) {
        roles[At(row.row)] = SlipTo(row.slip != 0 ? row.slip > 0 : slips ? w[row.row] > 0 : f[row.row] <= 0);
      }
    }
    is_strict = std::ranges::find(degenerate, 1) == degenerate.end();
    mode.emplace(MakeMode(roles));
  }

  // Contacts without force that depend on those with force stay closed. l: multipliers of least norm.
  void TakeLeastNorm() {
    forces = Forces::kNearest;
    const LeastNormForces least =
        FindLeastNormForces(problem, f, {.tolerance = options.tolerance, .rank_tolerance = options.rank_tolerance});
    if (least.status != LcpStatus::kSolved) return;
    forces = Forces::kLeastNorm;
    f = least.f;
    Classify();
    is_strict = true;
    const Vector zero = Vector::Zero(problem.size()), pull = -(problem.SparseA() * mode->Multipliers(f));
    for (Index i = 0; i < problem.size(); ++i) {
      if (!IsDegenerate(i)) continue;
      const double gap = problem.SparseA().row(i).dot(mode->Solve(zero, Vector::Unit(problem.size(), i)));
      const bool depends = gap <= options.rank_tolerance * problem.DiagonalA()[i];
      if (depends) degenerate[At(i)] = 0;
      is_strict = is_strict && depends && IsClear(i, root[i] * pull[i]);
    }
  }

  // f meets the laws of its roles exactly, and their equations by one more solve.
  void Polish() {
    Vector better = f, gaps;
    for (Index i = 0; i < f.size(); ++i) {
      if (!IsEquation(i)) better[i] = IsAtLower(i) ? lower[i] : upper[i];
    }
    for (const FrictionRow& row : problem.friction_rows()) {
      if (!IsEquation(row.row)) better[row.row] = -Slip(row.row) * row.mu * better[row.normal];
    }
    problem.ComputeW(better, &gaps);
    better += mode->Solve(gaps, Vector::Zero(f.size()));
    if (better.allFinite() && PassesTier(ComputeMetrics(problem, better), options.tolerance)) f = better;
    problem.ComputeW(f, &w);
  }

  // dA x or dA^T x, by factors without dA.
  Vector ChangeOfA(const ProblemChange& change, const Vector& x, bool transposed) const {
    Vector sum = Vector::Zero(x.size());
    if (change.A) sum += transposed ? Vector(change.A->transpose() * x) : Vector(*change.A * x);
    if (!change.J && !change.inverse_mass) return sum;
    const SparseMatrix& J = problem.J();
    const Vector impulse = J.transpose() * x;
    if (change.inverse_mass) sum += J * change.inverse_mass->cwiseProduct(impulse);
    if (!change.J) return sum;
    sum += *change.J * problem.inverse_mass().cwiseProduct(impulse);
    return sum + J * problem.inverse_mass().cwiseProduct(change.J->transpose() * x);
  }

  Load LoadOf(const ProblemChange& change) const {
    const Index n = problem.size(), frictions = static_cast<Index>(problem.friction_rows().size());
    if ((change.J || change.inverse_mass) && !problem.has_factors()) {
      throw InputError("derivative: changes of J and inverse masses need a problem given by factors");
    }
    if (change.A) CheckSize("dA", change.A->rows(), change.A->cols(), n, n);
    if (change.J) CheckSize("dJ", change.J->rows(), change.J->cols(), n, problem.J().cols());
    if (change.inverse_mass) CheckSize("dinverse_mass", change.inverse_mass->size(), 1, problem.J().cols(), 1);
    if (change.b) CheckSize("db", change.b->size(), 1, n, 1);
    if (change.mu) CheckSize("dmu", change.mu->size(), 1, frictions, 1);
    Load load{ChangeOfA(change, f, false), Vector::Zero(n)};
    if (change.b) load.r += *change.b;
    for (Index k = 0; change.mu && k < frictions; ++k) {
      const FrictionRow& row = problem.friction_rows()[At(k)];
      if (row.mu == 0 && (*change.mu)[k] < 0) {
        throw InputError("derivative: expected dmu >= 0 of row " + std::to_string(row.row) + ", whose mu is 0");
      }
      load.c[row.row] = -Slip(row.row) * (*change.mu)[k] * f[row.normal];
    }
    if (!load.r.allFinite() || !load.c.allFinite()) throw InputError("derivative: expected finite changes");
    return load;
  }

  SolutionChange ChangeIn(const Mode& of, const ProblemChange& change, const Load& load) const {
    Vector df = of.Solve(load.r, load.c);
    if (forces == Forces::kLeastNorm && of.is_singular()) {
      df += of.FreePart(ChangeOfA(change, of.Multipliers(f), true));
    }
    Vector dw = problem.SparseA() * df + load.r;
    const double size = std::max(Largest(load.r.cwiseQuotient(root)), Largest(df.cwiseProduct(root)));
    for (const Index i : of.equations()) {
      if (std::abs(dw[i]) / root[i] > kConsistent * size) {
        return {LcpStatus::kInfeasible, Nowhere(), Nowhere(), "the direction makes closed rows contradict each other"};
      }
      dw[i] = 0;
    }
    return {LcpStatus::kSolved, std::move(df), std::move(dw), {}};
  }

  // @param jumps  of plain problems: any f may be the one that changes, which all of f in the offset leaves open
  OneSided MakeOneSided(const Load& load, double size, bool jumps) const {
    Vector offset = Vector::Zero(f.size());
    if (jumps) offset = size / Largest(f.cwiseProduct(root)) * f;
    for (const FrictionRow& row : problem.friction_rows()) {
      if (!IsEquation(row.normal) || Slip(row.row) == 0 || HasBounds(row)) continue;
      const double room = IsDegenerate(row.row) ? row.mu * root[row.row] / root[row.normal] : 1;
      offset[row.normal] = std::max(offset[row.normal], size * (1 + 1 / room) / root[row.normal]);
    }
    std::vector<Index> place(roles.size(), -1), rows;
    RowBounds bounds;
    for (Index i = 0; i < problem.size(); ++i) {
      const bool may_close = jumps && !IsClear(i, w[i] / root[i]);
      if (roles[At(i)] == Role::kFixed && !IsDegenerate(i) && !may_close) continue;
      place[At(i)] = static_cast<Index>(rows.size());
      rows.push_back(i);
      const bool keeps_sign = problem.kind(i) == RowKind::kUnilateral && offset[i] > 0;
      bounds.bilateral.push_back(IsEquation(i) && !keeps_sign ? 1 : 0);
      if (!IsDegenerate(i) || problem.kind(i) != RowKind::kBounded) continue;
      bounds.bounded.push_back({place[At(i)], IsAtLower(i) ? 0 : -kInfinity, IsAtLower(i) ? kInfinity : 0});
    }
    for (const FrictionRow& row : problem.friction_rows()) {
      const Index tangent = place[At(row.row)], normal = place[At(row.normal)];
      if (Slip(row.row) == 0) continue;
      offset[row.row] = -Slip(row.row) * row.mu * offset[row.normal];
      const int slip = IsDegenerate(row.row) ? 0 : Slip(row.row);
      if (HasBounds(row)) {
        bounds.bounded.push_back({tangent, 0, -2 * load.c[row.row]});
      } else {
        bounds.friction.push_back({tangent, normal, row.mu, static_cast<signed char>(slip)});
      }
    }
    const Vector b = load.r + problem.SparseA() * (load.c - offset);
    LcpProblem one_sided = Subproblem(problem, rows).WithBounds(bounds).WithB(b(rows));
    return {std::move(rows), offset, std::move(one_sided)};
  }

  // The roles in the solution of a OneSided problem: of two numbers of which one is 0 the larger one tells.
  std::vector<Role> RolesOf(const OneSided& one_sided, const Vector& x, bool jumps, Load* load) const {
    Vector force = Vector::Zero(f.size()), gap = force, gaps;
    one_sided.problem.ComputeW(x, &gaps);
    force(one_sided.rows) = x.cwiseProduct(root(one_sided.rows));
    gap(one_sided.rows) = gaps.cwiseQuotient(root(one_sided.rows));
    std::vector<Role> found = roles;
    for (const Index i : one_sided.rows) {
      if (problem.kind(i) == RowKind::kFriction || !(jumps || IsDegenerate(i)) || problem.is_bilateral(i)) continue;
      found[At(i)] = std::abs(force[i]) > std::abs(gap[i]) ? Role::kEquation : Role::kFixed;
    }
    for (const FrictionRow& row : problem.friction_rows()) {
      if (!IsDegenerate(row.row)) continue;
      double& c = load->c[row.row];
      const bool has_bounds = HasBounds(row);
      const double along = force[row.row] + (has_bounds ? root[row.row] * c : 0);
      const double most = has_bounds ? -c : row.mu * force[row.normal] / root[row.normal];
      const bool sticks = root[row.row] * most - std::abs(along) > std::abs(gap[row.row]);
      found[At(row.row)] = sticks ? Role::kEquation : has_bounds ? Role::kFixed : SlipTo(along < 0);
      if (sticks || has_bounds) c = sticks ? 0 : gap[row.row] > 0 ? c : -c;
    }
    return found;
  }

  SolutionChange Resolve(const ProblemChange& change, const Load& load, bool jumps) const {
    const double size = std::max({Largest(load.r.cwiseQuotient(root)), Largest(load.c.cwiseProduct(root)),
                                  Largest(mode->Solve(load.r, load.c).cwiseProduct(root))});
    if (size == 0) return ChangeIn(*mode, change, load);
    SolutionChange answer{LcpStatus::kNumericalFailure, {}, {}, "modes of degenerate rows do not fit their solution"};
    for (const double offset : kOffsets) {
      const OneSided one_sided = MakeOneSided(load, offset * size, jumps);
      LcpResult result;
      AutoSolver().Solve(one_sided.problem, {}, &result);
      if (result.status != LcpStatus::kSolved) {
        answer.status = result.status;
        answer.detail = "the problem of the degenerate rows was not solved: " + result.detail;
        continue;
      }
      if (forces == Forces::kLeastNorm) result.f = FindLeastNormForces(one_sided.problem, result.f).f;
      Load along = load;
      SolutionChange found = ChangeIn(MakeMode(RolesOf(one_sided, result.f, jumps, &along)), change, along);
      Vector df = load.c - one_sided.offset;
      df(one_sided.rows) += result.f;
      const Vector difference = found.w - problem.SparseA() * df - load.r;
      if (Largest(difference.cwiseQuotient(root)) <= kAgrees * size) return found;
    }
    answer.f = answer.w = Nowhere();
    return answer;
  }

  LcpProblem problem;
  DerivativeOptions options;
  Forces forces = Forces::kUnique;
  bool is_strict = true;
  Vector f, w, root, limit;  // root: D^1/2; limit: scaled numbers up to it are 0
  Vector lower, upper;       // of f
  std::vector<Role> roles;   // where degenerate rows stay at their bounds
  std::vector<char> degenerate;
  std::optional<Mode> mode;  // of roles
};

Eigen::MatrixXd ProblemGradient::J(const LcpProblem& problem) const {
  const Eigen::MatrixXd of_left = problem.inverse_mass().asDiagonal() * (problem.J().transpose() * left);
  const Eigen::MatrixXd of_right = problem.inverse_mass().asDiagonal() * (problem.J().transpose() * right);
  return left * of_right.transpose() + right * of_left.transpose();
}

Vector ProblemGradient::InverseMass(const LcpProblem& problem) const {
  const SparseMatrix& J = problem.J();
  return Eigen::MatrixXd(J.transpose() * left).cwiseProduct(Eigen::MatrixXd(J.transpose() * right)).rowwise().sum();
}

Derivative::Derivative(const LcpProblem& problem, const Vector& f, const DerivativeOptions& options)
    : point_(std::make_shared<const Point>(problem, f, options)) {}

bool Derivative::strictly_complementary() const { return point_->is_strict; }
Derivative::Forces Derivative::forces() const { return point_->forces; }
const std::vector<char>& Derivative::degenerate() const { return point_->degenerate; }
const Vector& Derivative::f() const { return point_->f; }
const Vector& Derivative::w() const { return point_->w; }

SolutionChange Derivative::Jvp(const ProblemChange& change) const {
  const Point& point = *point_;
  const Load load = point.LoadOf(change);
  const bool is_degenerate = std::ranges::find(point.degenerate, 1) != point.degenerate.end();
  SolutionChange answer =
      is_degenerate ? point.Resolve(change, load, false) : point.ChangeIn(*point.mode, change, load);
  // dA f is that of other forces, too, unless it turns rows.
  const bool may_jump = point.problem.is_plain() && point.mode->is_singular() && !change.A && !change.J;
  if (answer.status != LcpStatus::kInfeasible || !may_jump) return answer;
  SolutionChange jump = point.Resolve(change, load, true);
  if (jump.status != LcpStatus::kSolved) return answer;
  jump.f = answer.f;
  jump.detail = "f jumps: " + answer.detail;
  return jump;
}

ProblemGradient Derivative::Vjp(const Vector& f_bar, const Vector& w_bar) const {
  const Point& point = *point_;
  const LcpProblem& problem = point.problem;
  const Vector of_f = f_bar.size() == 0 ? Vector::Zero(problem.size()).eval() : f_bar;
  const Vector of_w = w_bar.size() == 0 ? Vector::Zero(problem.size()).eval() : w_bar;
  CheckSize("f_bar", of_f.size(), 1, problem.size(), 1);
  CheckSize("w_bar", of_w.size(), 1, problem.size(), 1);
  const Vector through_f = of_f + problem.SparseA().transpose() * of_w;
  ProblemGradient gradient;
  gradient.b = of_w + point.mode->SolveTransposed(through_f);
  gradient.left = gradient.b;
  gradient.right = point.f;
  if (point.forces == Forces::kLeastNorm) {
    gradient.left.conservativeResize(Eigen::NoChange, 2);
    gradient.right.conservativeResize(Eigen::NoChange, 2);
    gradient.left.col(1) = point.mode->Multipliers(point.f);
    gradient.right.col(1) = point.mode->FreePart(through_f);
  }
  const Vector of_c = of_f + problem.SparseA().transpose() * gradient.b;
  gradient.mu.resize(static_cast<Index>(problem.friction_rows().size()));
  for (Index k = 0; k < gradient.mu.size(); ++k) {
    const FrictionRow& row = problem.friction_rows()[At(k)];
    gradient.mu[k] = -point.Slip(row.row) * point.f[row.normal] * of_c[row.row];
  }
  return gradient;
}

}  // namespace lcpbench
