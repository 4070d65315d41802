#include "solvers/exact/mode_system.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/friction/mode_equations.h"

namespace lcpbench {
namespace {

std::optional<Rational> FiniteBound(const std::optional<Rational>& bound) { return bound; }
std::optional<double> FiniteBound(double bound) { return std::isinf(bound) ? std::nullopt : std::optional(bound); }

// The rows are like FrictionRow and BoundedRow, with Numbers.
template <typename Number, typename FrictionRows, typename BoundedRows>
std::vector<LinearLaw<Number>> LinearLawsOf(const FrictionRows& friction, const BoundedRows& bounded,
                                            const std::string& modes) {
  std::vector<LinearLaw<Number>> laws;
  using Terms = std::vector<LinearTerm<Number>>;
  const auto add = [&laws](Terms terms, bool is_equation, const Number& constant = Number(0)) {
    laws.push_back({std::move(terms), constant, is_equation});
  };
  const auto own = [](Index row, bool is_gap, int sign) { return Terms{{row, is_gap, Number(sign)}}; };
  std::vector<char> is_plain(modes.size(), 1);
  for (const auto& row : friction) {
    const Index i = row.row;
    const char mode = modes[At(i)];
    is_plain[At(i)] = 0;
    const auto side = [&](int sign) { return Terms{{i, false, Number(sign)}, {row.normal, false, Number(row.mu)}}; };
    if (mode == 'o') add(own(i, false, 1), true);
    if (mode == 'k') add(side(row.slip), true);
    if (mode == 'S') {
      add(own(i, true, 1), true);
      add(side(1), false);
      add(side(-1), false);
    }
    if (mode != '+' && mode != '-') continue;
    add(side(mode == '+' ? 1 : -1), true);
    add(own(i, true, mode == '+' ? 1 : -1), false);
  }
  for (const auto& row : bounded) {
    const Index i = row.row;
    const char mode = modes[At(i)];
    is_plain[At(i)] = 0;
    const auto lower = FiniteBound(row.lower), upper = FiniteBound(row.upper);
    add(own(i, true, mode == '-' ? -1 : 1), mode == 'S');
    if (lower && mode != '-') add(own(i, false, 1), mode == '+', -*lower);
    if (upper && mode != '+') add(own(i, false, -1), mode == '-', *upper);
  }
  for (Index i = 0; i < static_cast<Index>(modes.size()); ++i) {
    if (is_plain[At(i)] == 0) continue;
    const bool is_closed = modes[At(i)] != 'O';
    add(own(i, is_closed, 1), true);
    if (modes[At(i)] != 'B') add(own(i, !is_closed, 1), false);
  }
  return laws;
}

}  // namespace

std::vector<RangeSide> SidesOf(const std::string& modes) {
  std::vector<RangeSide> sides;
  for (const char mode : modes) {
    const bool is_inside = mode == 'C' || mode == 'B' || mode == 'S';
    sides.push_back(is_inside ? RangeSide::kInside : mode == '-' ? RangeSide::kUpper : RangeSide::kLower);
  }
  return sides;
}

std::vector<Law> LawsOf(const ExactLcp& problem, const std::string& modes) {
  return LinearLawsOf<Rational>(problem.friction, problem.bounded, modes);
}
std::vector<LinearLaw<double>> LawsOf(const std::vector<FrictionRow>& friction, const std::vector<BoundedRow>& bounded,
                                      const std::string& modes) {
  return LinearLawsOf<double>(friction, bounded, modes);
}

Rational ValueOf(const Law& law, const RationalVector& f, const RationalVector& w, bool is_direction) {
  Rational sum = is_direction ? Rational(0) : law.constant;
  for (const LawTerm& term : law.terms) sum += term.factor * (term.is_gap ? w : f)[At(term.row)];
  return sum;
}

// In a common denominator of f: a sum of rationals reduces every one of them.
RationalVector GapsOf(const ExactLcp& problem, const RationalVector& f, bool is_direction) {
  const Rational unit(CommonDenominator(f));
  RationalVector w(f.size());
  for (Index j = 0; j < problem.size; ++j) {
    if (f[At(j)] == 0) continue;
    const Rational force = f[At(j)] * unit;
    for (Index i = 0; i < problem.size; ++i) {
      const Rational& entry = problem.A[At(i * problem.size + j)];
      if (entry != 0) w[At(i)] += entry * force;
    }
  }
  for (size_t i = 0; i < w.size(); ++i) {
    w[i] /= unit;
    if (!is_direction) w[i] += problem.b[i];
  }
  return w;
}

ModeSystem::ModeSystem(const ExactLcp& problem)
    : problem_(problem),
      matrix_unit_(CommonDenominator(problem.A)),
      load_unit_(CommonDenominator(problem.b)),
      A_(Scaled(problem.A, problem.size, matrix_unit_)),
      b_(Scaled(problem.b, problem.size, load_unit_)) {}

// K y = -r of integers: columns of K are in units of their own, so that coefficients of friction are integers, too.
std::optional<ModeSpace> ModeSystem::SpaceOf(const std::string& modes) const {
  ModeEquations<Rational> equations;
  equations.Set(SidesOf(modes), problem_.friction, problem_.bounded);
  const std::vector<Index>& E = equations.equation;
  const auto m = equations.size();
  IntegerMatrix system(m, m + 1);
  std::vector<BigInteger> unit(At(m), 1);
  equations.VisitFollowers([&](Index /*row*/, Index unknown, const Rational& part) {
    unit[At(unknown)] = lcm(unit[At(unknown)], denominator(part));
  });
  Integer factor, product;
  equations.VisitFollowers([&](Index row, Index unknown, const Rational& part) {
    const BigInteger scaled = numerator(part) * (unit[At(unknown)] / denominator(part));
    fmpz_set_mpz(factor.get(), scaled.backend().data());
    for (Index i = 0; i < m; ++i) {
      fmpz_mul(product.get(), factor.get(), A_.at(E[At(i)], row));
      fmpz_add(system.at(i, unknown), system.at(i, unknown), product.get());
    }
  });
  const auto add_times = [&](const Rational& times, Index unknown, RationalVector* f) {
    equations.VisitFollowers([&](Index row, Index of, const Rational& part) {
      if (of == unknown) (*f)[At(row)] += times * part;
    });
  };
  BigInteger load_unit = load_unit_;
  if (problem_.bounded.empty()) {
    for (Index i = 0; i < m; ++i) fmpz_neg(system.at(i, m), b_.at(E[At(i)], 0));
  } else {
    const RationalVector rest = GapsOf(problem_, equations.fixed);
    load_unit = CommonDenominator(rest);
    const IntegerMatrix scaled = Scaled(rest, problem_.size, load_unit);
    for (Index i = 0; i < m; ++i) fmpz_neg(system.at(i, m), scaled.at(E[At(i)], 0));
  }
  Integer common;
  const Index rank = m == 0 ? 0 : fmpz_mat_rref(system.get(), common.get(), system.get());
  std::vector<Index> pivots;  // the column of the first number of each row
  for (Index i = 0, j = 0; i < rank; ++i, ++j) {
    while (fmpz_is_zero(system.at(i, j)) != 0) ++j;
    if (j == m) return std::nullopt;  // 0 = 1
    pivots.push_back(j);
  }
  // y_j of K y = -r: that of the integers times its column's unit, and A's unit over b's.
  const auto unknown_of = [&](Index i, Index column) {
    return ToRational(system.at(i, column), common.get()) * Rational(unit[At(pivots[At(i)])]);
  };
  ModeSpace space;
  space.f = equations.fixed;
  const Rational force_unit(matrix_unit_, load_unit);
  for (Index i = 0; i < rank; ++i) add_times(unknown_of(i, m) * force_unit, pivots[At(i)], &space.f);
  space.w = GapsOf(problem_, space.f);
  for (const Index free : OtherRows(m, pivots)) {
    RationalVector direction(At(problem_.size));
    add_times(Rational(unit[At(free)]), free, &direction);
    for (Index i = 0; i < rank; ++i) add_times(-unknown_of(i, free), pivots[At(i)], &direction);
    space.w_directions.push_back(GapsOf(problem_, direction, true));
    space.f_directions.push_back(std::move(direction));
  }
  return space;
}

Polyhedron PointsOf(const ModeSpace& space, const std::vector<Law>& laws) {
  const size_t dimension = space.f_directions.size();
  std::vector<Halfspace> halfspaces;
  for (const Law& law : laws) {
    Halfspace halfspace{RationalVector(dimension), ValueOf(law, space.f, space.w)};
    bool is_constant = true;
    for (size_t k = 0; k < dimension; ++k) {
      halfspace.normal[k] = ValueOf(law, space.f_directions[k], space.w_directions[k], true);
      is_constant = is_constant && halfspace.normal[k] == 0;
    }
    if (is_constant) {
      if (law.is_equation ? halfspace.constant != 0 : halfspace.constant < 0) return {};
      continue;
    }
    halfspaces.push_back(halfspace);
    if (!law.is_equation) continue;
    for (Rational& value : halfspace.normal) value = -value;
    halfspace.constant = -halfspace.constant;
    halfspaces.push_back(std::move(halfspace));
  }
  return Intersect(static_cast<Index>(dimension), halfspaces);
}

}  // namespace lcpbench
