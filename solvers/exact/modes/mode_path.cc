#include "solvers/exact/modes/mode_path.h"

#include <algorithm>
#include <random>
#include <utility>

#include "solvers/exact/flint_matrix.h"
#include "solvers/exact/modes/mode_system.h"
#include "solvers/friction/mode_equations.h"

namespace lcpbench {
namespace {

constexpr int kSeeds = 8;
constexpr Index kMostStepsPerContact = 60;
// From here on p-adic lifting is faster than what FLINT chooses.
constexpr Index kLeastLiftedRows = 20;

// A linear function of f and w: what is positive inside a cell and 0 on a wall.
struct Wall {
  Index contact;
  char beyond;  // the mode of the contact on the other side: O, C, S, + or -
  std::vector<LawTerm> terms;
};

// x = at + step lambda, of unknown forces and z.
struct Line {
  RationalVector f, f_step;  // n
  RationalVector w, w_step;  // n, with z d
  Rational z, z_step;
};

class ModePath {
 public:
  ModePath(const ExactLcp& problem, const ModeOptions& options)
      : problem_(problem),
        deadline_(LcpOptions{.time_limit_s = options.time_limit_s, .now = options.now}),
        tangent_(At(problem.size), nullptr) {
    for (const ExactFrictionRow& row : problem.friction) {
      if (row.mu != 0) tangent_[At(row.normal)] = &row;
    }
    std::vector<char> other(At(problem.size), 0);
    for (const ExactFrictionRow& row : problem.friction) other[At(row.row)] = 1;
    for (Index i = 0; i < problem.size; ++i) {
      if (problem.bilateral[At(i)] != 0) {
        joints_.push_back(i);
      } else if (other[At(i)] == 0) {
        contacts_.push_back(i);
      }
    }
    joints_ = IndependentJoints();
  }

  // The solution at the end; nothing where there is none, or the path had a tie.
  enum class End { kSolved, kTie, kRay, kLimit };
  End Follow(unsigned seed, ModeAnswer* answer) {
    Draw(seed);
    modes_.assign(At(problem_.size), 'O');
    for (Index i = 0; i < problem_.size; ++i) {
      if (problem_.bilateral[At(i)] != 0) modes_[At(i)] = 'B';
    }
    for (const ExactFrictionRow& row : problem_.friction) modes_[At(row.row)] = 'o';
    std::optional<Line> line = StartLine();
    Wall entering{};  // none: lambda is z, from above
    if (!line) return End::kTie;
    for (Index step = 0; step < kMostStepsPerContact * (1 + static_cast<Index>(contacts_.size())); ++step) {
      if (deadline_.Expired()) return End::kLimit;
      ++answer->tried;
      Wall next{};
      Rational lambda;
      const End end = FindWall(*line, entering, &next, &lambda);
      if (end == End::kSolved) {
        answer->f.clear();
        for (size_t i = 0; i < line->f.size(); ++i) answer->f.push_back(line->f[i] + lambda * line->f_step[i]);
        answer->modes = ModesAtEnd(answer->f);
        return End::kSolved;
      }
      if (end != End::kLimit) return end;
      entering = Cross(next, *line, lambda);
      line = LineFrom(entering);
      if (!line) return End::kTie;
    }
    return End::kLimit;
  }

 private:
  // With those of tangents that have mu = 0, which are not on the path.
  std::string ModesAtEnd(const RationalVector& f) const {
    std::string modes = modes_;
    const RationalVector w = GapsOf(problem_, f);
    for (const ExactFrictionRow& row : problem_.friction) {
      if (row.mu == 0 && modes[At(row.normal)] == 'C') modes[At(row.row)] = w[At(row.row)] >= 0 ? '+' : '-';
    }
    return modes;
  }

  // Integers: normal ones from kUnit to 2 kUnit, and |d_t| < d_n / max(mu, 1).
  void Draw(unsigned seed) {
    std::mt19937_64 random(seed);
    constexpr std::uint64_t kUnit = std::uint64_t{1} << 30U;
    d_.assign(At(problem_.size), 0);
    for (const Index i : contacts_) {
      d_[At(i)] = Rational(kUnit + random() % kUnit);
      const ExactFrictionRow* tangent = tangent_[At(i)];
      if (tangent == nullptr) continue;
      const Rational part = Rational(random() % kUnit) / Rational(kUnit) * Rational(9, 10);
      const Rational most = tangent->mu > 1 ? Rational(d_[At(i)] / tangent->mu) : d_[At(i)];
      d_[At(tangent->row)] = random() % 2 == 0 ? Rational(part * most) : Rational(-part * most);
    }
  }

  std::vector<Index> IndependentJoints() const {
    const auto m = static_cast<Index>(joints_.size());
    RationalMatrix block(m, m);
    for (Index i = 0; i < m; ++i) {
      for (Index j = 0; j < m; ++j) {
        Assign(block.at(i, j), problem_.A[At(joints_[At(i)] * problem_.size + joints_[At(j)])]);
      }
    }
    std::vector<Index> independent;
    const Index rank = m == 0 ? 0 : fmpq_mat_rref(block.get(), block.get());
    for (Index i = 0, j = 0; i < rank; ++i, ++j) {
      while (fmpq_is_zero(block.at(i, j)) != 0) ++j;
      independent.push_back(joints_[At(j)]);
    }
    return independent;
  }

  // The unknown forces of the modes at hand, as columns, and the rows with w = 0: joints that depend on others are
  // none.
  struct System {
    std::vector<RationalVector> columns;
    std::vector<Index> equations;
  };
  System MakeSystem() const {
    std::vector<RangeSide> sides = SidesOf(modes_);
    for (Index i = 0; i < problem_.size; ++i) {
      const bool is_joint = problem_.bilateral[At(i)] != 0;
      if (is_joint && !std::ranges::binary_search(joints_, i)) sides[At(i)] = RangeSide::kLower;
    }
    ModeEquations<Rational> of;
    of.Set(sides, problem_.friction, problem_.bounded);
    System system{std::vector<RationalVector>(of.equation.size(), RationalVector(At(problem_.size))), of.equation};
    of.VisitFollowers(
        [&](Index row, Index unknown, const Rational& part) { system.columns[At(unknown)][At(row)] = part; });
    return system;
  }

  // With w_E = 0 and, where `wall` has terms, its value = lambda; else z = lambda. Nothing where that is singular.
  std::optional<Line> LineOf(const Wall& wall) const {
    const System system = MakeSystem();
    const auto m = static_cast<Index>(system.columns.size());
    std::vector<RationalVector> products;
    for (const RationalVector& column : system.columns) products.push_back(GapsOf(problem_, column, true));
    RationalMatrix matrix(m + 1, m + 1), right(m + 1, 2), solution(m + 1, 2);
    for (Index i = 0; i < m; ++i) {
      const size_t row = At(system.equations[At(i)]);
      for (Index j = 0; j < m; ++j) Assign(matrix.at(i, j), products[At(j)][row]);
      Assign(matrix.at(i, m), d_[row]);
      Assign(right.at(i, 0), -problem_.b[row]);
    }
    Law value{wall.terms, 0, false};
    const RationalVector none(At(problem_.size));
    for (Index j = 0; j < m; ++j) {
      if (!wall.terms.empty()) Assign(matrix.at(m, j), ValueOf(value, system.columns[At(j)], products[At(j)], true));
    }
    Assign(matrix.at(m, m), wall.terms.empty() ? Rational(1) : ValueOf(value, none, d_, true));
    Assign(right.at(m, 0), wall.terms.empty() ? Rational(0) : -ValueOf(value, none, problem_.b, true));
    fmpq_one(right.at(m, 1));
    const auto solve = m < kLeastLiftedRows ? &fmpq_mat_solve : &fmpq_mat_solve_dixon;
    if (solve(solution.get(), matrix.get(), right.get()) == 0) return std::nullopt;
    Line line{none, none, problem_.b, none, ToRational(solution.at(m, 0)), ToRational(solution.at(m, 1))};
    for (Index j = 0; j < m; ++j) {
      const Rational at = ToRational(solution.at(j, 0)), step = ToRational(solution.at(j, 1));
      for (size_t i = 0; i < none.size(); ++i) {
        line.f[i] += at * system.columns[At(j)][i];
        line.f_step[i] += step * system.columns[At(j)][i];
        line.w[i] += at * products[At(j)][i];
        line.w_step[i] += step * products[At(j)][i];
      }
    }
    for (size_t i = 0; i < none.size(); ++i) {
      line.w[i] += line.z * d_[i];
      line.w_step[i] += line.z_step * d_[i];
    }
    return line;
  }

  // z falls from infinity: lambda = -z.
  std::optional<Line> StartLine() const {
    std::optional<Line> line = LineOf({});
    if (!line) return line;
    for (RationalVector* step : {&line->f_step, &line->w_step}) {
      for (Rational& value : *step) value = -value;
    }
    line->z_step = -line->z_step;
    return line;
  }
  std::optional<Line> LineFrom(const Wall& entering) const { return LineOf(entering); }

  // The walls of a contact's cell.
  std::vector<Wall> WallsOf(Index i) const {
    const ExactFrictionRow* tangent = tangent_[At(i)];
    if (modes_[At(i)] == 'O') return {{i, 'C', {{i, true, 1}}}};
    if (tangent == nullptr) return {{i, 'O', {{i, false, 1}}}};
    const Index t = tangent->row;
    const char mode = modes_[At(t)];
    if (mode == 'S') {
      return {{i, '+', {{i, false, tangent->mu}, {t, false, 1}}}, {i, '-', {{i, false, tangent->mu}, {t, false, -1}}}};
    }
    return {{i, 'O', {{i, false, 1}}}, {i, 'S', {{t, true, mode == '+' ? 1 : -1}}}};
  }

  // The first wall ahead, or z = 0 (kSolved); kLimit: there is one.
  End FindWall(const Line& line, const Wall& entering, Wall* next, Rational* lambda) const {
    bool found = false, tie = false;
    const auto consider = [&](const Rational& at, const Rational& step, const Wall& wall) {
      if (step >= 0) return;
      const Rational reach = -at / step;
      if (found && reach == *lambda) tie = true;
      if (found && reach >= *lambda) return;
      found = true;
      tie = false;
      *lambda = reach;
      *next = wall;
    };
    for (const Index i : contacts_) {
      for (const Wall& wall : WallsOf(i)) {
        const Law law{wall.terms, 0, false};
        consider(ValueOf(law, line.f, line.w), ValueOf(law, line.f_step, line.w_step, true), wall);
      }
    }
    // A wall that is reached there as well is of the same closed cell.
    if (line.z_step < 0 && (!found || -line.z / line.z_step <= *lambda)) {
      *lambda = -line.z / line.z_step;
      return End::kSolved;
    }
    if (!found) return End::kRay;
    // The path enters its cell: what is behind was crossed already.
    if (tie || (!entering.terms.empty() && *lambda <= 0)) return End::kTie;
    return End::kLimit;
  }

  // Changes the mode, and returns the wall as seen from the other side.
  Wall Cross(const Wall& wall, const Line& line, const Rational& lambda) {
    const Index i = wall.contact;
    const ExactFrictionRow* tangent = tangent_[At(i)];
    const char before = tangent == nullptr ? modes_[At(i)] : modes_[At(tangent->row)];
    if (wall.beyond == 'O') {
      modes_[At(i)] = 'O';
      if (tangent != nullptr) modes_[At(tangent->row)] = 'o';
      return {i, 'C', {{i, true, 1}}};
    }
    modes_[At(i)] = 'C';
    if (tangent == nullptr) return {i, 'O', {{i, false, 1}}};
    const Index t = tangent->row;
    if (wall.beyond == 'C') {
      modes_[At(t)] = line.w[At(t)] + lambda * line.w_step[At(t)] >= 0 ? '+' : '-';
      return {i, 'O', {{i, false, 1}}};
    }
    modes_[At(t)] = wall.beyond;
    if (wall.beyond == 'S') return {i, before, {{i, false, tangent->mu}, {t, false, before == '+' ? 1 : -1}}};
    return {i, 'S', {{t, true, wall.beyond == '+' ? 1 : -1}}};
  }

  const ExactLcp& problem_;
  Deadline deadline_;
  std::vector<const ExactFrictionRow*> tangent_;  // of each normal row; null: none, or mu = 0
  std::vector<Index> contacts_, joints_;
  RationalVector d_;
  std::string modes_;
};

// Takes the modes of a guess where they have a solution.
bool TakeModes(const ExactLcp& problem, const std::string& modes, ModeAnswer* answer) {
  const std::optional<ModeSpace> space = ModeSystem(problem).SpaceOf(modes);
  if (!space || !space->f_directions.empty()) return false;
  if (!FindFaultOfModes(problem, modes, space->f).empty()) return false;
  answer->f = space->f;
  answer->modes = modes;
  return true;
}

}  // namespace

ModeAnswer SolveAlongModes(const ExactLcp& problem, const ModeOptions& options) {
  ModeAnswer answer;
  const auto finish = [&] {
    answer.status = LcpReference::Status::kSolved;
    answer.w = GapsOf(problem, answer.f);
  };
  for (const std::string& modes : options.guesses ? options.guesses() : std::vector<std::string>{}) {
    if (!TakeModes(problem, modes, &answer)) continue;
    finish();
    return answer;
  }
  if (!options.follows_path) {
    answer.detail = "no guess has the modes of a solution";
    return answer;
  }
  std::vector<char> has_tangent(At(problem.size), 0);
  bool takes = problem.bounded.empty();
  for (const ExactFrictionRow& row : problem.friction) {
    takes = takes && row.slip == 0 && std::exchange(has_tangent[At(row.normal)], 1) == 0;
  }
  if (!takes) {
    answer.detail =
        "no guess has the modes of a solution, and the path takes one friction row a contact, no sliding "
        "and no bounded rows";
    return answer;
  }
  ModePath path(problem, options);
  for (unsigned seed = 1; seed <= kSeeds; ++seed) {
    const ModePath::End end = path.Follow(seed, &answer);
    if (end == ModePath::End::kSolved && FindFaultOfModes(problem, answer.modes, answer.f).empty()) {
      finish();
      return answer;
    }
    answer.f.clear();
    answer.modes.clear();
    answer.detail = end == ModePath::End::kRay     ? "secondary ray"
                    : end == ModePath::End::kLimit ? "out of time or steps"
                                                   : "ties on every path";
    if (end == ModePath::End::kLimit) break;
  }
  return answer;
}

}  // namespace lcpbench
