#include "solvers/exact/modes/mode_system.h"

#include <algorithm>
#include <utility>

namespace lcpbench {
namespace {

// The laws of a unilateral or bilateral row.
void AddPlainLaws(Index row, char mode, std::vector<Law>* laws) {
  const bool is_closed = mode != 'O';
  laws->push_back({{{row, is_closed, 1}}, 0, true});
  if (mode != 'B') laws->push_back({{{row, !is_closed, 1}}, 0, false});
}

void AddFrictionLaws(const ExactFrictionRow& row, char mode, std::vector<Law>* laws) {
  const auto force = [&row](const Rational& factor) {
    return std::vector<LawTerm>{{row.row, false, factor}, {row.normal, false, row.mu}};
  };
  const std::vector<LawTerm> gap_up = {{row.row, true, 1}}, gap_down = {{row.row, true, -1}};
  switch (mode) {
    case 'o':
      laws->push_back({{{row.row, false, 1}}, 0, true});
      return;
    case 'S':
      laws->push_back({gap_up, 0, true});
      laws->push_back({force(1), 0, false});
      laws->push_back({force(-1), 0, false});
      return;
    case 'k':
      laws->push_back({force(row.slip), 0, true});
      return;
    default:
      laws->push_back({force(mode == '+' ? 1 : -1), 0, true});
      laws->push_back({mode == '+' ? gap_up : gap_down, 0, false});
  }
}

void AddBoundedLaws(const ExactBoundedRow& row, char mode, std::vector<Law>* laws) {
  const auto limit = [&](bool lower, bool is_equation) {
    const std::optional<Rational>& bound = lower ? row.lower : row.upper;
    if (bound) laws->push_back({{{row.row, false, lower ? 1 : -1}}, lower ? -*bound : *bound, is_equation});
  };
  if (mode == 'S') {
    laws->push_back({{{row.row, true, 1}}, 0, true});
    limit(true, false);
    limit(false, false);
    return;
  }
  limit(mode == '+', true);
  laws->push_back({{{row.row, true, mode == '+' ? 1 : -1}}, 0, false});
}

// An unknown force, with the friction forces that follow it: `row` times 1, and other rows times factors.
struct Unknown {
  Index row;
  std::vector<std::pair<Index, Rational>> followers;
};

std::vector<Unknown> UnknownsOf(const ExactLcp& problem, const std::string& modes) {
  std::vector<Unknown> unknowns;
  std::vector<Index> place(modes.size(), -1);
  for (Index i = 0; i < problem.size; ++i) {
    const char mode = modes[At(i)];
    if (mode != 'C' && mode != 'B' && mode != 'S') continue;
    place[At(i)] = static_cast<Index>(unknowns.size());
    unknowns.push_back({i, {}});
  }
  for (const ExactFrictionRow& row : problem.friction) {
    const char mode = modes[At(row.row)];
    if (mode == 'o' || mode == 'S' || row.mu == 0) continue;
    const int sign = mode == 'k' ? row.slip : mode == '+' ? 1 : -1;
    unknowns[At(place[At(row.normal)])].followers.emplace_back(row.row, -sign * row.mu);
  }
  return unknowns;
}

// The forces of bounded rows at their bounds; zeros elsewhere.
RationalVector FixedForces(const ExactLcp& problem, const std::string& modes) {
  RationalVector fixed(modes.size());
  for (const ExactBoundedRow& row : problem.bounded) {
    const char mode = modes[At(row.row)];
    if (mode != 'S') fixed[At(row.row)] = mode == '+' ? *row.lower : *row.upper;
  }
  return fixed;
}

void AddTimes(const Rational& factor, const Unknown& unknown, RationalVector* f) {
  (*f)[At(unknown.row)] += factor;
  for (const auto& [row, part] : unknown.followers) (*f)[At(row)] += factor * part;
}

}  // namespace

std::vector<Law> LawsOf(const ExactLcp& problem, const std::string& modes) {
  std::vector<Law> laws;
  std::vector<char> is_plain(modes.size(), 1);
  for (const ExactFrictionRow& row : problem.friction) {
    is_plain[At(row.row)] = 0;
    AddFrictionLaws(row, modes[At(row.row)], &laws);
  }
  for (const ExactBoundedRow& row : problem.bounded) {
    is_plain[At(row.row)] = 0;
    AddBoundedLaws(row, modes[At(row.row)], &laws);
  }
  for (Index i = 0; i < problem.size; ++i) {
    if (is_plain[At(i)] != 0) AddPlainLaws(i, modes[At(i)], &laws);
  }
  return laws;
}

Rational ValueOf(const Law& law, const RationalVector& f, const RationalVector& w, bool is_direction) {
  Rational sum = is_direction ? Rational(0) : law.constant;
  for (const LawTerm& term : law.terms) sum += term.factor * (term.is_gap ? w : f)[At(term.row)];
  return sum;
}

RationalVector GapsOf(const ExactLcp& problem, const RationalVector& f, bool is_direction) {
  RationalVector w = is_direction ? RationalVector(f.size()) : problem.b;
  for (Index j = 0; j < problem.size; ++j) {
    if (f[At(j)] == 0) continue;
    for (Index i = 0; i < problem.size; ++i) {
      const Rational& entry = problem.A[At(i * problem.size + j)];
      if (entry != 0) w[At(i)] += entry * f[At(j)];
    }
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
  const std::vector<Unknown> unknowns = UnknownsOf(problem_, modes);
  const RationalVector fixed = FixedForces(problem_, modes);
  const auto m = static_cast<Index>(unknowns.size());
  IntegerMatrix system(m, m + 1);
  std::vector<BigInteger> unit(At(m), 1);
  Integer factor, product;
  for (Index j = 0; j < m; ++j) {
    for (const auto& [row, part] : unknowns[At(j)].followers) unit[At(j)] = lcm(unit[At(j)], denominator(part));
    fmpz_set_mpz(factor.get(), unit[At(j)].backend().data());
    for (Index i = 0; i < m; ++i) {
      fmpz_mul(system.at(i, j), factor.get(), A_.at(unknowns[At(i)].row, unknowns[At(j)].row));
    }
    for (const auto& [row, part] : unknowns[At(j)].followers) {
      const BigInteger scaled = numerator(part) * (unit[At(j)] / denominator(part));
      fmpz_set_mpz(factor.get(), scaled.backend().data());
      for (Index i = 0; i < m; ++i) {
        fmpz_mul(product.get(), factor.get(), A_.at(unknowns[At(i)].row, row));
        fmpz_add(system.at(i, j), system.at(i, j), product.get());
      }
    }
  }
  BigInteger load_unit = load_unit_;
  if (problem_.bounded.empty()) {
    for (Index i = 0; i < m; ++i) fmpz_neg(system.at(i, m), b_.at(unknowns[At(i)].row, 0));
  } else {
    const RationalVector rest = GapsOf(problem_, fixed);
    load_unit = CommonDenominator(rest);
    const IntegerMatrix scaled = Scaled(rest, problem_.size, load_unit);
    for (Index i = 0; i < m; ++i) fmpz_neg(system.at(i, m), scaled.at(unknowns[At(i)].row, 0));
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
  space.f = fixed;
  const Rational force_unit(matrix_unit_, load_unit);
  for (Index i = 0; i < rank; ++i) AddTimes(unknown_of(i, m) * force_unit, unknowns[At(pivots[At(i)])], &space.f);
  space.w = GapsOf(problem_, space.f);
  for (const Index free : OtherRows(m, pivots)) {
    RationalVector direction(At(problem_.size));
    AddTimes(Rational(unit[At(free)]), unknowns[At(free)], &direction);
    for (Index i = 0; i < rank; ++i) AddTimes(-unknown_of(i, free), unknowns[At(pivots[At(i)])], &direction);
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
