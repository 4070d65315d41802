#include "solvers/exact/modes/mode_search.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "solvers/exact/flint_matrix.h"
#include "solvers/exact/lemke_path.h"
#include "solvers/exact/mode_system.h"
#include "solvers/exact/modes/mode_proof.h"

namespace lcpbench {
namespace {

// Directions of Lemke's path that are tried in turn.
constexpr unsigned kSeeds = 8;

// Rows whose modes belong together, and the strings that they may have: a contact, a bounded row.
struct ModeGroup {
  std::vector<Index> rows;
  std::vector<std::string> choices;
};

std::vector<ModeGroup> GroupsOf(const ExactLcp& problem) {
  std::vector<ModeGroup> of_row(At(problem.size));
  for (Index i = 0; i < problem.size; ++i) {
    of_row[At(i)] = {
        {i}, problem.bilateral[At(i)] != 0 ? std::vector<std::string>{"B"} : std::vector<std::string>{"C", "O"}};
  }
  for (const ExactFrictionRow& row : problem.friction) {
    of_row[At(row.row)] = {};
    ModeGroup& contact = of_row[At(row.normal)];
    contact.rows.push_back(row.row);
    std::vector<std::string> choices;
    for (const std::string& before : contact.choices) {
      const std::string of_tangent = before.front() == 'O' ? "o" : row.slip != 0 ? "k" : "S+-";
      for (const char mode : of_tangent) choices.push_back(before + mode);
    }
    contact.choices = std::move(choices);
  }
  for (const ExactBoundedRow& row : problem.bounded) {
    of_row[At(row.row)] = {{row.row}, {"S"}};
    if (row.lower) of_row[At(row.row)].choices.emplace_back("+");
    if (row.upper) of_row[At(row.row)].choices.emplace_back("-");
  }
  std::erase_if(of_row, [](const ModeGroup& group) { return group.rows.empty(); });
  return of_row;
}

// The number of strings, or most + 1 where there are more.
std::int64_t CountModes(const std::vector<ModeGroup>& groups, std::int64_t most) {
  std::int64_t count = 1;
  for (const ModeGroup& group : groups) {
    count *= static_cast<std::int64_t>(group.choices.size());
    if (count > most) return most + 1;
  }
  return count;
}

// The dimension of the hull of points and directions.
Index DimensionOf(const Polyhedron& set) {
  std::vector<RationalVector> differences = set.rays;
  differences.insert(differences.end(), set.lines.begin(), set.lines.end());
  for (size_t k = 1; k < set.vertices.size(); ++k) {
    differences.push_back(set.vertices[k]);
    for (size_t i = 0; i < differences.back().size(); ++i) differences.back()[i] -= set.vertices[0][i];
  }
  if (differences.empty()) return 0;
  const auto rows = static_cast<Index>(differences.size());
  const auto columns = static_cast<Index>(differences.front().size());
  RationalMatrix matrix(rows, columns);
  for (Index i = 0; i < rows; ++i) {
    for (Index j = 0; j < columns; ++j) Assign(matrix.at(i, j), differences[At(i)][At(j)]);
  }
  return fmpq_mat_rref(matrix.get(), matrix.get());
}

// Whether a direction, or a point, meets the laws; a line both ways.
enum class Kind { kPoint, kRay, kLine };
bool Meets(const ExactLcp& problem, const std::vector<Law>& laws, const RationalVector& f, Kind kind) {
  const bool is_direction = kind != Kind::kPoint;
  const RationalVector w = GapsOf(problem, f, is_direction);
  return std::ranges::all_of(laws, [&](const Law& law) {
    const Rational value = ValueOf(law, f, w, is_direction);
    return law.is_equation || kind == Kind::kLine ? value == 0 : value >= 0;
  });
}

// All solutions, mode by mode; or one.
class ModeSearch {
 public:
  ModeSearch(const ExactLcp& problem, const ExactOptions& options)
      : problem_(problem),
        deadline_(LcpOptions{.time_limit_s = options.time_limit_s, .now = options.now}),
        system_(problem),
        rounded_(problem),
        groups_(GroupsOf(problem)) {}

  bool IsSmall(std::int64_t most) const { return CountModes(groups_, most) <= most; }

  ExactAnswer Search() {
    std::string modes(At(problem_.size), ' ');
    if (!TryAll(0, &modes)) {
      answer_.detail = "out of time after " + std::to_string(answer_.steps) + " modes";
      return std::move(answer_);
    }
    answer_.complete = true;
    answer_.status = pieces_.empty() ? ExactAnswer::Status::kInfeasible : ExactAnswer::Status::kSolved;
    if (pieces_.empty()) {
      answer_.ray = NormalRay();
      return std::move(answer_);
    }
    Describe();
    return std::move(answer_);
  }

  ExactAnswer FindOne(const ExactOptions& options) {
    for (const std::string& modes : options.guessed_modes ? options.guessed_modes() : std::vector<std::string>{}) {
      if (TakeModes(modes, true)) return std::move(answer_);
    }
    answer_.detail = "no guess has the modes of a solution";
    if (!options.follows_path) return std::move(answer_);
    std::vector<char> has_tangent(At(problem_.size), 0);
    bool takes = problem_.bounded.empty();
    for (const ExactFrictionRow& row : problem_.friction) {
      takes = takes && row.slip == 0 && std::exchange(has_tangent[At(row.normal)], 1) == 0;
    }
    if (!takes) {
      answer_.detail += ", and the path takes one friction row a contact, no sliding and no bounded rows";
      return std::move(answer_);
    }
    for (unsigned seed = 1; seed <= kSeeds; ++seed) {
      const LemkeEnd end = FollowLemke(problem_, system_.A(), system_.b(), seed, deadline_);
      answer_.steps += end.steps;
      if (end.kind == LemkeEnd::Kind::kSolved && TakeModes(end.modes, false)) break;
      answer_.detail = end.kind == LemkeEnd::Kind::kRay     ? "secondary ray"
                       : end.kind == LemkeEnd::Kind::kLimit ? "out of time or steps"
                                                            : "ties on every path";
      if (end.kind == LemkeEnd::Kind::kLimit) break;
    }
    return std::move(answer_);
  }

 private:
  struct Found {
    ModePiece piece;
    std::vector<Law> laws;
    ModeSpace space;
  };

  // False where there is no time left.
  bool TryAll(size_t group, std::string* modes) {
    if (group == groups_.size()) {
      ++answer_.steps;
      Try(*modes);
      return !deadline_.Expired();
    }
    for (const std::string& choice : groups_[group].choices) {
      for (size_t k = 0; k < choice.size(); ++k) (*modes)[At(groups_[group].rows[k])] = choice[k];
      if (!TryAll(group + 1, modes)) return false;
    }
    return true;
  }

  void Try(const std::string& modes) {
    if (rounded_.Enclose(modes).signs == ModeEnclosure::Signs::kViolated) return;
    std::optional<ModeSpace> space = system_.SpaceOf(modes);
    if (!space) return;
    std::vector<Law> laws = LawsOf(problem_, modes);
    const Polyhedron points = PointsOf(*space, laws);
    if (points.is_empty()) return;
    Polyhedron f;
    const auto move = [&](const std::vector<RationalVector>& from, bool is_direction, std::vector<RationalVector>* to) {
      for (const RationalVector& x : from) {
        RationalVector forces = is_direction ? RationalVector(modes.size()) : space->f;
        for (size_t k = 0; k < x.size(); ++k) {
          for (size_t i = 0; i < forces.size(); ++i) forces[i] += x[k] * space->f_directions[k][i];
        }
        to->push_back(std::move(forces));
      }
    };
    move(points.vertices, false, &f.vertices);
    move(points.rays, true, &f.rays);
    move(points.lines, true, &f.lines);
    for (const Found& other : pieces_) {
      if (IsWithin(f, other.laws)) return;
    }
    std::erase_if(pieces_, [&](const Found& other) { return IsWithin(other.piece.f, laws); });
    pieces_.push_back({{modes, 0, std::move(f)}, std::move(laws), std::move(*space)});
  }

  // Takes modes where they have a solution; those of a guess where they have no other. A tangent with mu = 0 that is on
  // a closed contact slips.
  bool TakeModes(std::string modes, bool is_guess) {
    std::optional<ModeSpace> space = system_.SpaceOf(modes);
    if (!space || (is_guess && !space->f_directions.empty())) return false;
    for (const ExactFrictionRow& row : problem_.friction) {
      if (is_guess || row.mu != 0 || modes[At(row.normal)] != 'C') continue;
      modes[At(row.row)] = space->w[At(row.row)] >= 0 ? '+' : '-';
    }
    if (!FindFaultOfModes(problem_, modes, space->f).empty()) return false;
    answer_.status = ExactAnswer::Status::kSolved;
    answer_.f = std::move(space->f);
    answer_.w = std::move(space->w);
    answer_.modes = std::move(modes);
    answer_.detail.clear();
    return true;
  }

  bool IsWithin(const Polyhedron& f, const std::vector<Law>& laws) const {
    const auto all = [&](const std::vector<RationalVector>& list, Kind kind) {
      return std::ranges::all_of(list, [&](const RationalVector& x) { return Meets(problem_, laws, x, kind); });
    };
    return all(f.vertices, Kind::kPoint) && all(f.rays, Kind::kRay) && all(f.lines, Kind::kLine);
  }

  void Describe() {
    for (Found& found : pieces_) found.piece.dimension = DimensionOf(found.piece.f);
    answer_.components = CountComponents();
    const Polyhedron& first = pieces_.front().piece.f;
    answer_.f = first.vertices.front();
    answer_.w = GapsOf(problem_, answer_.f);
    answer_.modes = pieces_.front().piece.modes;
    answer_.f_unique = pieces_.size() == 1 && pieces_.front().piece.dimension == 0;
    answer_.w_unique = std::ranges::all_of(pieces_, [this](const Found& found) {
      const auto has = [this](const std::vector<RationalVector>& list, bool is_direction, const RationalVector& w) {
        return std::ranges::all_of(list,
                                   [&](const RationalVector& f) { return GapsOf(problem_, f, is_direction) == w; });
      };
      const RationalVector zero(answer_.w.size());
      return has(found.piece.f.vertices, false, answer_.w) && has(found.piece.f.rays, true, zero) &&
             has(found.piece.f.lines, true, zero);
    });
    for (Found& found : pieces_) answer_.pieces.push_back(std::move(found.piece));
  }

  Index CountComponents() const {
    std::vector<size_t> root(pieces_.size());
    std::iota(root.begin(), root.end(), size_t{0});
    const auto find = [&root](size_t k) {
      while (root[k] != k) k = root[k];
      return k;
    };
    for (size_t i = 0; i < pieces_.size(); ++i) {
      for (size_t j = 0; j < i; ++j) {
        if (find(i) != find(j) && Touch(pieces_[i], pieces_[j])) root[find(i)] = find(j);
      }
    }
    Index components = 0;
    for (size_t k = 0; k < root.size(); ++k) components += root[k] == k ? 1 : 0;
    return components;
  }

  static bool Touch(const Found& one, const Found& other) {
    std::vector<Law> laws = one.laws;
    laws.insert(laws.end(), other.laws.begin(), other.laws.end());
    return !PointsOf(one.space, laws).is_empty();
  }

  // A ray of ExactAnswer::ray; empty where there is none: A^T y = 0 on the rows that may be in it, by its extreme rays.
  RationalVector NormalRay() const {
    ExactLcp rays = problem_;
    for (Index i = 0; i < rays.size; ++i) {
      for (Index j = 0; j < i; ++j) std::swap(rays.A[At(i * rays.size + j)], rays.A[At(j * rays.size + i)]);
    }
    rays.b.assign(rays.b.size(), 0);
    rays.friction.clear();
    rays.bounded.clear();
    // As an LCP of closed rows, A^T y = 0 is its equation; rows that are not in it are held at 0 by bounds.
    std::string modes(At(problem_.size), 'C');
    std::vector<Law> signs;
    for (Index i = 0; i < problem_.size; ++i) {
      if (problem_.bilateral[At(i)] != 0) modes[At(i)] = 'B';
    }
    for (const ExactFrictionRow& row : problem_.friction) modes[At(row.row)] = 'O';
    for (const ExactBoundedRow& row : problem_.bounded) {
      if (row.lower && row.upper) modes[At(row.row)] = 'O';
      if (!row.lower && !row.upper) modes[At(row.row)] = 'B';
      if (!row.lower && row.upper) {
        modes[At(row.row)] = 'B';
        signs.push_back({{{row.row, false, -1}}, 0, false});
      }
    }
    for (Index i = 0; i < problem_.size; ++i) {
      if (modes[At(i)] == 'C') signs.push_back({{{i, false, 1}}, 0, false});
      signs.push_back({{{i, true, 1}}, 0, true});
    }
    const std::optional<ModeSpace> space = ModeSystem(rays).SpaceOf(modes);
    if (!space) return {};
    const Polyhedron points = PointsOf(*space, signs);
    std::vector<RationalVector> directions = points.rays;
    for (const RationalVector& line : points.lines) {
      directions.push_back(line);
      directions.push_back(line);
      for (Rational& value : directions.back()) value = -value;
    }
    for (const RationalVector& x : directions) {
      RationalVector y(At(problem_.size));
      Rational b_dot_y = 0;
      for (size_t i = 0; i < y.size(); ++i) {
        for (size_t k = 0; k < x.size(); ++k) y[i] += x[k] * space->f_directions[k][i];
        b_dot_y += problem_.b[i] * y[i];
      }
      if (b_dot_y >= 0) continue;
      for (Rational& value : y) value /= -b_dot_y;
      return y;
    }
    return {};
  }

  const ExactLcp& problem_;
  Deadline deadline_;
  ModeSystem system_;
  RoundedModes rounded_;
  std::vector<ModeGroup> groups_;
  std::vector<Found> pieces_;
  ExactAnswer answer_;
};

// A row with w < 0 whatever f >= 0; -1 where there is none.
Index HopelessRow(const LcpProblem& problem) {
  if (!problem.bilateral_rows().empty()) return -1;
  for (Index i = 0; i < problem.size(); ++i) {
    bool has_positive = false;
    for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) has_positive = has_positive || it.value() > 0;
    if (problem.b()[i] < 0 && !has_positive) return i;
  }
  return -1;
}

}  // namespace

ExactAnswer SolveByModes(const ExactLcp& problem, const ExactOptions& options) {
  ModeSearch search(problem, options);
  if (search.IsSmall(options.most_modes)) return search.Search();
  return search.FindOne(options);
}

ExactAnswer Certify(const ExactLcp& problem, const ExactOptions& options) {
  const bool is_plain = problem.is_plain();
  ExactAnswer answer = is_plain ? SolveExactly(problem, options) : SolveByModes(problem, options);
  answer.fault = FindFault(problem, answer);
  const bool is_known = answer.is_solved() || answer.status == ExactAnswer::Status::kInfeasible;
  answer.certified = is_known && answer.fault.empty();
  if (is_plain) answer.complete = answer.certified;
  return answer;
}

std::optional<RationalVector> GapsOfAnswer(const LcpProblem& problem, const RationalVector& f) {
  RationalVector w(At(problem.size()));
  for (Index i = 0; i < problem.size(); ++i) {
    Rational& gap = w[At(i)];
    gap = problem.b()[i];
    for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it; ++it) {
      if (f[At(it.col())] != 0) gap += Rational(it.value()) * f[At(it.col())];
    }
    const bool solves = problem.is_bilateral(i) ? gap == 0 : gap >= 0 && f[At(i)] >= 0 && (gap == 0 || f[At(i)] == 0);
    if (!solves) return std::nullopt;
  }
  return w;
}

ExactAnswer SolveByEnumeration(const LcpProblem& problem, const std::vector<Eigen::VectorXd>& guesses) {
  using Status = ExactAnswer::Status;
  ExactAnswer answer;
  answer.detail = "no answer was guessed";
  if (const Index row = HopelessRow(problem); row >= 0) {
    answer.status = Status::kInfeasible;
    answer.detail = "w < 0 on row " + std::to_string(row) + " whatever f >= 0";
    return answer;
  }
  if (problem.size() > kMostGuessedRows) return answer;
  const ExactLcp exact = ExactFromAny(problem);
  for (const Eigen::VectorXd& guess : guesses) {
    if (guess.size() != problem.size() || !guess.allFinite()) continue;
    const auto modes = [&] { return std::vector{ModesOf(problem, guess)}; };
    ExactAnswer guessed = SolveByModes(exact, {.most_modes = 0, .guessed_modes = modes, .follows_path = false});
    if (guessed.status != Status::kSolved) continue;
    if (answer.status != Status::kSolved) {
      answer = std::move(guessed);
    } else if (guessed.f != answer.f) {
      answer.f_unique = false;
    }
  }
  ExactAnswer all = SolveByModes(exact, {.follows_path = false});
  if (!all.complete) return answer;
  if (answer.status == Status::kSolved) {
    all.f = std::move(answer.f);
    all.w = std::move(answer.w);
    all.modes = std::move(answer.modes);
  }
  if (all.status == Status::kInfeasible) all.detail = "by enumeration of all active sets";
  return all;
}

}  // namespace lcpbench
