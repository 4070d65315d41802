// All solutions of problems with friction, in rationals, and proofs in doubles: docs/friction.md section 7.
#include "solvers/exact/modes/mode_search.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <boost/multiprecision/eigen.hpp>
#include <boost/multiprecision/gmp.hpp>
#include <cmath>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "solvers/exact/mode_system.h"
#include "solvers/exact/modes/mode_proof.h"
#include "solvers/exact/polyhedron.h"
#include "tests/solvers/friction/friction_records.h"

namespace lcpbench {
namespace {

RationalVector ToRationals(const nlohmann::json& numbers) {
  RationalVector vector;
  for (const nlohmann::json& number : numbers) {
    vector.push_back(number.is_string() ? Rational(number.get<std::string>()) : Rational(number.get<double>()));
  }
  return vector;
}

// Directions have any length.
RationalVector OfUnitLength(RationalVector direction, bool has_sign) {
  Rational sum = 0;
  for (const Rational& value : direction) sum += abs(value);
  const auto first = std::ranges::find_if(direction, [](const Rational& value) { return value != 0; });
  if (!has_sign && first != direction.end() && *first < 0) sum = -sum;
  for (Rational& value : direction) value /= sum;
  return direction;
}

using PointSet = std::set<RationalVector>;
struct PieceSets {
  PointSet vertices, rays;
  auto operator<=>(const PieceSets&) const = default;
};

TEST(ModeAnswer, HasThePiecesOfEveryRecord) {
  int solved = 0, infeasible = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    if (!record.json.contains("pieces") && record.is_solved()) continue;
    SCOPED_TRACE(record.problem().id());
    const ExactLcp problem = ParseExactLcp(record.line, "record");
    const ExactAnswer answer = SolveByModes(problem, {.most_modes = 65536});
    ASSERT_TRUE(answer.complete);
    EXPECT_EQ(answer.is_solved(), record.is_solved());
    if (!record.is_solved()) {
      ++infeasible;
      if (record.json.contains("infeasible_by")) {
        EXPECT_EQ(!answer.ray.empty(), record.json["infeasible_by"] == "normal-ray");
      }
      continue;
    }
    ++solved;
    std::set<PieceSets> found, known;
    for (const ModePiece& piece : answer.pieces) {
      PieceSets sets;
      sets.vertices.insert(piece.f.vertices.begin(), piece.f.vertices.end());
      for (const RationalVector& ray : piece.f.rays) sets.rays.insert(OfUnitLength(ray, true));
      EXPECT_TRUE(piece.f.lines.empty() || !record.json["pieces"].empty());
      found.insert(sets);
      for (const RationalVector& f : piece.f.vertices) EXPECT_EQ(FindFaultOfModes(problem, piece.modes, f), "");
    }
    bool has_lines = false;
    for (const nlohmann::json& piece : record.json["pieces"]) {
      PieceSets sets;
      for (const nlohmann::json& vertex : piece["vertices"]) sets.vertices.insert(ToRationals(vertex));
      for (const nlohmann::json& ray : piece["rays"]) sets.rays.insert(OfUnitLength(ToRationals(ray), true));
      has_lines = has_lines || !piece["lines"].empty();
      known.insert(sets);
    }
    EXPECT_EQ(answer.pieces.size(), record.json["pieces"].size());
    // With lines a vertex is any point of a face.
    if (!has_lines) {
      EXPECT_TRUE(found == known);
    }
    EXPECT_EQ(answer.components, record.json.value("components", answer.components));
    for (const auto& [key, is_unique] : {std::pair("f_unique", answer.f_unique), {"w_unique", answer.w_unique}}) {
      if (record.json.contains(key)) {
        EXPECT_EQ(is_unique, record.json[key].get<bool>()) << key;
      }
    }
  }
  EXPECT_GE(solved, 90);
  EXPECT_GE(infeasible, 8);
}

// Without enumeration: one solution by the path, from nothing, and from the modes of a rounded one.
TEST(ModeAnswer, ThePathEndsInASolution) {
  int solved = 0, rays = 0, from_guess = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    const auto& rows = record.problem().friction_rows();
    const bool takes =
        record.problem().bounded_rows().empty() && std::ranges::all_of(rows, [&](const FrictionRow& row) {
          return row.slip == 0 && std::ranges::count(rows, row.normal, &FrictionRow::normal) == 1;
        });
    if (!takes) continue;
    SCOPED_TRACE(record.problem().id());
    const ExactLcp problem = ParseExactLcp(record.line, "record");
    ExactAnswer answer = SolveByModes(problem, {.most_modes = 0});
    EXPECT_FALSE(answer.complete);
    if (answer.is_solved()) {
      EXPECT_TRUE(record.is_solved());
      EXPECT_EQ(FindFaultOfModes(problem, answer.modes, answer.f), "");
      ++solved;
    } else {
      ++rays;
      EXPECT_FALSE(answer.detail.empty());
    }
    if (!record.is_solved() || !record.json.contains("f_exact")) continue;
    const auto guess = [&] {
      return std::vector<std::string>{ModesOf(record.problem(), ToVector(record.json["f_exact"]))};
    };
    answer = SolveByModes(problem, {.most_modes = 0, .guessed_modes = guess});
    from_guess += answer.steps == 0 ? 1 : 0;
  }
  EXPECT_GE(solved, 85);
  EXPECT_LE(rays, 8);
  EXPECT_GE(from_guess, 40);
}

// Small integers: J of `contacts` contacts, rows n, t in turn; on few coordinates rows depend on each other.
ExactLcp RandomProblem(Index contacts, int coordinates, std::mt19937* random, std::string* line) {
  const auto number = [random](int most) { return static_cast<int>((*random)() % (2 * most + 1)) - most; };
  nlohmann::json record;
  const Index n = 2 * contacts;
  for (Index i = 0; i < n; ++i) {
    for (int k = 0; k < coordinates; ++k) record["J"][At(i)].push_back(number(3));
  }
  for (int k = 0; k < coordinates; ++k) record["invM"].push_back(1 + (*random)() % 3);
  // Level of velocities, b = J v + (c, 0), now and then with c < 0.
  std::vector<int> v;
  for (int k = 0; k < coordinates; ++k) v.push_back(number(6));
  for (Index i = 0; i < n; ++i) {
    int b = i % 2 == 0 && (*random)() % 2 == 0 ? number(12) : 0;
    for (size_t k = 0; k < v.size(); ++k) b += record["J"][At(i)][k].get<int>() * v[k];
    record["b"].push_back(b);
    if (i % 2 == 0) continue;
    record["friction"]["row"].push_back(i);
    record["friction"]["normal"].push_back(i - 1);
    record["friction"]["mu"].push_back(std::to_string((*random)() % 8) + "/4");
  }
  *line = record.dump();
  return ParseExactLcp(*line, "random");
}

// Rationals as Eigen takes them.
using Fraction = boost::multiprecision::number<boost::multiprecision::gmp_rational, boost::multiprecision::et_off>;
using FractionMatrix = Eigen::Matrix<Fraction, Eigen::Dynamic, Eigen::Dynamic>;
using FractionVector = Eigen::Matrix<Fraction, Eigen::Dynamic, 1>;

// Another algorithm: every complementary basis of the LCP of four rows a contact (p, beta+, beta-, sigma).
std::vector<RationalVector> BasicSolutions(const ExactLcp& problem) {
  const Index n = problem.size, m = 2 * n;
  FractionMatrix A(n, n), E = FractionMatrix::Zero(n, m);
  FractionVector b(n);
  for (Index i = 0; i < n; ++i) {
    b[i] = problem.b[At(i)];
    for (Index j = 0; j < n; ++j) A(i, j) = problem.A[At(i * n + j)];
  }
  for (Index i = 0; i < n / 2; ++i) {
    E(2 * i, 4 * i) = E(2 * i + 1, 4 * i + 1) = 1;
    E(2 * i + 1, 4 * i + 2) = -1;
  }
  FractionMatrix M = E.transpose() * A * E;
  const FractionVector q = E.transpose() * b;
  for (Index i = 0; i < n / 2; ++i) {
    M(4 * i + 1, 4 * i + 3) = M(4 * i + 2, 4 * i + 3) = 1;
    M(4 * i + 3, 4 * i) = problem.friction[At(i)].mu;
    M(4 * i + 3, 4 * i + 1) = M(4 * i + 3, 4 * i + 2) = -1;
  }
  std::vector<RationalVector> solutions;
  for (std::uint64_t basis = 0; basis < std::uint64_t{1} << static_cast<unsigned>(m); ++basis) {
    std::vector<Index> in;
    for (Index i = 0; i < m; ++i) {
      if ((basis >> static_cast<unsigned>(i) & 1U) != 0) in.push_back(i);
    }
    FractionVector z = FractionVector::Zero(m);
    if (!in.empty()) {
      Eigen::FullPivLU<FractionMatrix> factor(M(in, in));
      factor.setThreshold(0);
      if (!factor.isInvertible()) continue;
      const FractionVector right = -q(in);
      z(in) = factor.solve(right);
    }
    const FractionVector w = M * z + q;
    if (z.minCoeff() < 0 || w.minCoeff() < 0) continue;
    const FractionVector f = E * z;
    solutions.emplace_back(f.begin(), f.end());
  }
  return solutions;
}

TEST(ModeAnswer, AgreesWithAllComplementaryBases) {
  std::mt19937 random(17);
  const std::pair<Index, int> counts[] = {{1, 1200}, {2, 770}, {3, 30}};
  int without = 0, several = 0;
  for (const auto& [contacts, count] : counts) {
    for (int round = 0; round < count; ++round) {
      std::string line;
      const int coordinates = round % 3 == 0 ? 6 : 1 + round % 3;
      const ExactLcp problem = RandomProblem(contacts, coordinates, &random, &line);
      SCOPED_TRACE(line);
      const ExactAnswer answer = SolveByModes(problem, {});
      ASSERT_TRUE(answer.complete);
      const std::vector<RationalVector> basic = BasicSolutions(problem);
      EXPECT_EQ(answer.is_solved(), !basic.empty());
      without += basic.empty() ? 1 : 0;
      several += answer.pieces.size() > 1 ? 1 : 0;
      // A basic solution lies in a piece, and a vertex is one where rows are independent.
      PointSet vertices;
      bool has_lines = false;
      for (const ModePiece& piece : answer.pieces) {
        vertices.insert(piece.f.vertices.begin(), piece.f.vertices.end());
        has_lines = has_lines || !piece.f.lines.empty();
      }
      const PointSet basic_set(basic.begin(), basic.end());
      for (const RationalVector& f : basic) {
        EXPECT_TRUE(std::ranges::any_of(
            answer.pieces, [&](const ModePiece& piece) { return FindFaultOfModes(problem, piece.modes, f).empty(); }));
      }
      if (has_lines) continue;
      if (coordinates == 6) {
        for (const RationalVector& f : vertices) EXPECT_TRUE(basic_set.contains(f));
      }
      // And the path finds one of them.
      const ExactAnswer one = SolveByModes(problem, {.most_modes = 0});
      if (one.is_solved()) {
        EXPECT_EQ(FindFaultOfModes(problem, one.modes, one.f), "");
      }
    }
  }
  EXPECT_GE(without, 5);
  EXPECT_GE(several, 20);
}

// Row k is `second` times row `first` of another problem, in pairs n, t.
using Rows = std::vector<std::pair<Index, int>>;

ExactLcp Rearranged(const ExactLcp& problem, const Rows& rows) {
  ExactLcp result{problem.id, static_cast<Index>(rows.size()), {}, {}, std::vector<char>(rows.size(), 0)};
  for (const auto& [i, sign] : rows) {
    for (const auto& [j, other] : rows) result.A.push_back(sign * other * problem.A[At(i * problem.size + j)]);
    result.b.push_back(sign * problem.b[At(i)]);
  }
  for (Index k = 1; k < result.size; k += 2) {
    result.friction.push_back({k, k - 1, problem.friction[At(rows[At(k)].first / 2)].mu, 0});
  }
  return result;
}

RationalVector Rearranged(const RationalVector& f, const Rows& rows) {
  RationalVector result;
  for (const auto& [i, sign] : rows) result.push_back(sign * f[At(i)]);
  return result;
}

std::set<PieceSets> Rearranged(const ExactAnswer& answer, const Rows& rows) {
  std::set<PieceSets> all;
  for (const ModePiece& piece : answer.pieces) {
    PieceSets sets;
    for (const RationalVector& f : piece.f.vertices) sets.vertices.insert(Rearranged(f, rows));
    for (const RationalVector& ray : piece.f.rays) sets.rays.insert(OfUnitLength(Rearranged(ray, rows), true));
    all.insert(sets);
  }
  return all;
}

bool IsSolution(const ExactLcp& problem, const ExactAnswer& answer, const RationalVector& f) {
  return std::ranges::any_of(answer.pieces,
                             [&](const ModePiece& piece) { return FindFaultOfModes(problem, piece.modes, f).empty(); });
}

TEST(ModeAnswer, FollowsOrderMirrorAndSplitting) {
  std::mt19937 random(23);
  int compared = 0;
  for (int round = 0; round < 150; ++round) {
    const Index contacts = 1 + round % 3;
    std::string line;
    const ExactLcp problem = RandomProblem(contacts, 2 + round % 4, &random, &line);
    SCOPED_TRACE(line);
    const ExactAnswer answer = SolveByModes(problem, {});
    std::vector<Index> order = AllRows(contacts);
    std::ranges::shuffle(order, random);
    Rows same, ordered, mirrored;
    for (Index k = 0; k < contacts; ++k) {
      for (const Index row : {2 * k, 2 * k + 1}) {
        same.emplace_back(row, 1);
        ordered.emplace_back(2 * order[At(k)] + row % 2, 1);
        mirrored.emplace_back(row, row % 2 == 0 ? 1 : -1);
      }
    }
    const bool has_lines = std::ranges::any_of(answer.pieces, [](const ModePiece& p) { return !p.f.lines.empty(); });
    for (const Rows& rows : {ordered, mirrored}) {
      const ExactAnswer other = SolveByModes(Rearranged(problem, rows), {});
      EXPECT_EQ(other.pieces.size(), answer.pieces.size());
      EXPECT_EQ(other.components, answer.components);
      EXPECT_EQ(other.f_unique, answer.f_unique);
      EXPECT_EQ(other.w_unique, answer.w_unique);
      EXPECT_EQ(other.ray.empty(), answer.ray.empty());
      if (has_lines) continue;
      EXPECT_TRUE(Rearranged(other, same) == Rearranged(answer, rows));
      ++compared;
    }
    // Twice the first contact: forces of both add up.
    Rows split = same;
    split.insert(split.end(), same.begin(), same.begin() + 2);
    const ExactLcp twice = Rearranged(problem, split);
    const ExactAnswer other = SolveByModes(twice, {});
    EXPECT_EQ(other.components, answer.components);
    EXPECT_EQ(other.w_unique, answer.w_unique);
    const auto n = At(problem.size);
    for (const ModePiece& piece : other.pieces) {
      for (RationalVector f : piece.f.vertices) {
        f[0] += f[n];
        f[1] += f[n + 1];
        f.resize(n);
        EXPECT_TRUE(IsSolution(problem, answer, f));
      }
    }
    for (const ModePiece& piece : answer.pieces) {
      for (const RationalVector& f : piece.f.vertices) {
        RationalVector halves = Rearranged(f, split);
        for (const size_t i : {size_t{0}, size_t{1}, n, n + 1}) halves[i] /= 2;
        EXPECT_TRUE(IsSolution(twice, other, halves));
      }
    }
  }
  EXPECT_GE(compared, 200);
}

// A problem of doubles near to a random one of integers, where much is 0: J and b move by their last bits, or more.
LcpProblem NearlyDegenerate(int round, std::mt19937* random) {
  std::string line;
  RandomProblem(1 + round % 3, 1 + round % 5, random, &line);
  const LcpProblem problem = ParseLcpRecord(line, "random").problem;
  const double size = std::ldexp(1.0, -30 - 3 * (round % 8));
  const auto change = [&] { return round % 4 == 0 ? 0.0 : size * (static_cast<int>((*random)() % 7) - 3); };
  SparseMatrix J = problem.J();
  Eigen::VectorXd b = problem.b();
  for (double& value : J.coeffs()) value += change();
  for (double& value : b) value += change();
  return LcpProblem::FromFactors("nearly degenerate", J, problem.inverse_mass(), b, problem.bounds());
}

Rational SquaredDistance(const ExactLcp& problem, const Eigen::VectorXd& f, const RationalVector& exact) {
  Rational largest = 0;
  for (Index i = 0; i < problem.size; ++i) {
    const Rational difference = Rational(f[i]) - exact[At(i)];
    largest = std::max(largest, Rational(difference * difference * problem.A[At(i * problem.size + i)]));
  }
  return largest;
}

TEST(ModeProof, WhatDoublesProveOfAModeIsSo) {
  std::mt19937 random(31);
  int strict = 0, violated = 0, unknown = 0;
  for (int round = 0; round < 400; ++round) {
    const LcpProblem problem = NearlyDegenerate(round, &random);
    const ExactLcp exact = ExactFrom(problem);
    const ModeSystem system(exact);
    const RoundedModes of_doubles(problem), of_fractions(exact);
    const Index contacts = problem.size() / 2;
    for (int code = 0; code < 1 << (2 * contacts); ++code) {
      std::string modes;
      for (Index k = 0; k < contacts; ++k) modes += std::vector{"Oo", "CS", "C+", "C-"}[At(code >> (2 * k) & 3)];
      SCOPED_TRACE(modes + " " + std::to_string(round));
      const std::optional<ModeSpace> space = system.SpaceOf(modes);
      for (const RoundedModes* rounded : {&of_doubles, &of_fractions}) {
        const ModeEnclosure enclosure = rounded->Enclose(modes);
        if (std::isfinite(enclosure.error)) {
          ASSERT_TRUE(space && space->f_directions.empty());
          const Rational error(enclosure.error);
          EXPECT_LE(SquaredDistance(exact, enclosure.f, space->f), error * error);
        }
        if (enclosure.signs == ModeEnclosure::Signs::kUnknown) {
          ++unknown;
          continue;
        }
        const bool is_right = FindFaultOfModes(exact, modes, space->f).empty();
        EXPECT_EQ(is_right, enclosure.signs == ModeEnclosure::Signs::kStrict);
        ++(is_right ? strict : violated);
      }
    }
  }
  EXPECT_GE(strict, 150);
  EXPECT_GE(violated, 5000);
  EXPECT_GE(unknown, 500);
}

// Signs and coefficients that the proof says are those of f, put into the problem: f then solves it.
void ExpectNearby(const LcpProblem& problem, const ModeProof& proof) {
  ExactLcp nearby = ExactFrom(problem);
  RationalVector f;
  for (const double force : proof.f) f.emplace_back(force);
  RationalVector w = GapsOf(nearby, f);
  const RationalVector given = nearby.b;
  Rational mu_shift = 0, b_shift = 0;
  for (ExactFrictionRow& row : nearby.friction) {
    const char mode = proof.modes[At(row.row)];
    const Rational ratio = f[At(row.normal)] == 0 ? row.mu : Rational(abs(f[At(row.row)]) / f[At(row.normal)]);
    if (mode == 'o' || row.mu == 0 || (mode == 'S' && ratio <= row.mu)) continue;
    mu_shift = std::max(mu_shift, Rational(abs(Rational(ratio - row.mu)) / row.mu));
    row.mu = ratio;
  }
  for (Index i = 0; i < problem.size(); ++i) {
    const char mode = proof.modes[At(i)];
    const bool keeps = mode == 'o' || ((mode == 'O' || mode == '+') && w[At(i)] > 0) || (mode == '-' && w[At(i)] < 0);
    if (keeps) continue;
    nearby.b[At(i)] -= w[At(i)];
    const Rational& diagonal = nearby.A[At(i * nearby.size + i)];
    b_shift += w[At(i)] * w[At(i)] / (diagonal == 0 ? Rational(1) : diagonal);
  }
  EXPECT_EQ(FindFaultOfModes(nearby, proof.modes, f), "");
  EXPECT_LE(mu_shift, Rational(proof.mu_shift));
  EXPECT_LE(b_shift, Rational(proof.b_shift) * Rational(proof.b_shift));
  EXPECT_LE(Rational(proof.b_shift) * Rational(proof.b_shift), b_shift * Rational(1 + 1e-12));
}

TEST(ModeProof, NeverAcceptsAWrongAnswer) {
  std::mt19937 random(37);
  int proved = 0, nearby = 0;
  for (int round = 0; round < 400; ++round) {
    SCOPED_TRACE(round);
    const LcpProblem problem = NearlyDegenerate(round, &random);
    const ExactLcp exact = ExactFrom(problem);
    Eigen::VectorXd start(problem.size());
    for (double& force : start) force = round % 5 == 0 ? 0 : static_cast<int>(random() % 21) - 10;
    ExpectNearby(problem, ProveNearby(problem, start));
    const ModeProof proof = ProveModes(problem, start);
    if (proof.proof == ModeProof::Proof::kNearbyProblem) {
      ++nearby;
      ExpectNearby(problem, proof);
      continue;
    }
    ++proved;
    const std::optional<ModeSpace> space = ModeSystem(exact).SpaceOf(proof.modes);
    ASSERT_TRUE(space);
    EXPECT_EQ(FindFaultOfModes(exact, proof.modes, space->f), "");
    EXPECT_LE(SquaredDistance(exact, proof.f, space->f), Rational(proof.f_bound) * Rational(proof.f_bound));
  }
  EXPECT_GE(proved, 100);
  EXPECT_GE(nearby, 50);
}

// Right answers, rounded, solve problems that are as near as rounding; forces that are wrong by a thousandth do not.
TEST(ModeProof, NearbyIsNearForRightAnswersOnly) {
  int compared = 0;
  for (const FrictionRecord& record : FrictionRecords()) {
    if (!record.is_solved() || !record.json.contains("f_exact")) continue;
    SCOPED_TRACE(record.problem().id());
    const LcpProblem& problem = record.problem();
    const Eigen::VectorXd f = ToVector(record.json["f_exact"]);
    const double size = problem.b().norm() + f.norm() * problem.DenseA().norm();
    const ModeProof right = ProveNearby(problem, f);
    EXPECT_LE(right.b_shift, 1e-14 * size * size);
    EXPECT_LE(right.mu_shift, 1e-14);
    if (record.json.value("w_unique", false) && record.json.value("f_unique", false) && f.norm() > 0) {
      const ModeProof wrong = ProveNearby(problem, 1.001 * f);
      EXPECT_GE(std::max(wrong.b_shift, wrong.mu_shift), 1e-9);
      ++compared;
    }
  }
  EXPECT_GE(compared, 30);
}

TEST(Polyhedron, OfKnownShapes) {
  // The cube [0, 1]^3 has 8 vertices; without its upper faces it is an octant.
  std::vector<Halfspace> octant, cube;
  for (size_t k = 0; k < 3; ++k) {
    RationalVector normal(3);
    normal[k] = 1;
    octant.push_back({normal, 0});
    normal[k] = -1;
    cube.push_back({normal, 1});
  }
  EXPECT_EQ(Intersect(3, octant).vertices.size(), 1U);
  EXPECT_EQ(Intersect(3, octant).rays.size(), 3U);
  cube.insert(cube.end(), octant.begin(), octant.end());
  EXPECT_EQ(Intersect(3, cube).vertices.size(), 8U);
  EXPECT_TRUE(Intersect(3, cube).rays.empty());
  // A slab has lines; two half-lines that do not meet are empty.
  EXPECT_EQ(Intersect(3, {cube[0], octant[0]}).lines.size(), 2U);
  EXPECT_TRUE(Intersect(1, {{{Rational(1)}, Rational(-1)}, {{Rational(-1)}, Rational(0)}}).is_empty());
  EXPECT_EQ(Intersect(0, {}).vertices.size(), 1U);
}

}  // namespace
}  // namespace lcpbench
