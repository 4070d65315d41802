#include "tests/attack/attack_problem.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <utility>
#include <vector>

#include "solvers/lcp/verify.h"
#include "tests/solvers/exact_problems.h"

namespace lcpbench {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

int Below(Index count, TestRandom* random) { return random->Integer(0, static_cast<int>(count) - 1); }

int Below(size_t count, TestRandom* random) { return Below(static_cast<Index>(count), random); }

template <typename Value>
Value Pick(std::initializer_list<Value> choices, TestRandom* random) {
  return choices.begin()[Below(static_cast<Index>(choices.size()), random)];
}

// Kinds of G, n rows each.

MatrixXd EveryRank(Index n, TestRandom* random) {
  const Index rank = random->Integer(0, static_cast<int>(n));
  const double density = random->Integer(2, 10) / 10.0;
  MatrixXd G = MatrixXd::Zero(n, std::max<Index>(rank, 1));
  for (Index i = 0; i < n * rank; ++i) G(i) = random->Chance(density) ? random->Integer(-3, 3) : 0;
  return G;
}

MatrixXd TwoBodies(Index n, TestRandom* random) {
  const Index bodies = random->Integer(1, static_cast<int>(n) / 2 + 1);
  MatrixXd G = MatrixXd::Zero(n, 3 * bodies);
  for (Index i = 0; i < 2 * n; ++i) {
    const Index body = Below(bodies, random);
    for (Index k = 0; k < 3; ++k) G(i / 2, 3 * body + k) = random->Integer(-3, 3);
  }
  return G;
}

MatrixXd Chain(Index n, TestRandom* random) {
  if (random->Chance(0.15)) n = random->Integer(100, 300);
  MatrixXd G = MatrixXd::Zero(n, n + 1);
  G.diagonal().setOnes();
  G.diagonal(1).setConstant(-1);
  return G;
}

MatrixXd Copies(Index n, TestRandom* random) {
  const Index distinct = random->Integer(1, static_cast<int>(n + 2) / 3);
  MatrixXd G = MatrixXd::Zero(n, random->Integer(1, static_cast<int>(distinct) + 2));
  for (double& entry : G.topRows(distinct).reshaped()) entry = random->Integer(-3, 3);
  for (Index i = distinct; i < n; ++i) G.row(i) = Pick({1, 1, -1, 2}, random) * G.row(Below(distinct, random));
  return G;
}

MatrixXd Isolated(Index n, TestRandom* random) {
  MatrixXd G = MatrixXd::Zero(n, n);
  for (Index i = 0; i < n; ++i) G(i, i) = random->Chance(0.2) ? 0 : std::ldexp(1.0, random->Integer(-4, 4));
  return G;
}

// Rows n, t, n, t, ...: two bodies, normals and arms in integers.
MatrixXd Contacts(Index n, TestRandom* random) {
  const Index bodies = random->Integer(1, static_cast<int>(n) / 2 + 1);
  MatrixXd G = MatrixXd::Zero(n, 3 * bodies);
  for (Index i = 0; i < n; i += 2) {
    const int x = random->Integer(-3, 3), y = random->Integer(1, 3);
    const Index first = Below(bodies + 1, random), second = Below(bodies, random);
    for (const auto& [body, sign] : {std::pair(first, 1), std::pair(second, -1)}) {
      if (body == bodies || (sign < 0 && first == second)) continue;  // the ground
      G.block<1, 3>(i, 3 * body) << sign * x, sign * y, random->Integer(-3, 3);
      if (i + 1 < n) G.block<1, 3>(i + 1, 3 * body) << -sign * y, sign * x, random->Integer(-3, 3);
    }
  }
  return G;
}

MatrixXd NearlyDependent(Index n, TestRandom* random) {
  MatrixXd G = EveryRank(n, random);
  const double apart = std::ldexp(1.0, -random->Integer(1, 8));
  for (Index i = 1; i < n; ++i) {
    if (random->Chance(0.5)) G.row(i) = Pick({1, -1}, random) * G.row(Below(i, random)) + apart * G.row(i);
  }
  return G;
}

struct Kind {
  const char* name;
  MatrixXd (*rows)(Index n, TestRandom* random);
};
constexpr Kind kKinds[] = {{"rank", &EveryRank},   {"bodies", &TwoBodies},  {"chain", &Chain},
                           {"copies", &Copies},    {"isolated", &Isolated}, {"nearly-dependent", &NearlyDependent},
                           {"contacts", &Contacts}};
// Only those with friction have the last kind.
constexpr Index kPlainKinds = std::size(kKinds) - 1;

// A = G diag(m) G^T.
struct Exact {
  MatrixXd G;
  VectorXd m;
  std::vector<Index> bilateral;
  std::vector<FrictionRow> friction;
  std::vector<BoundedRow> bounded;
  VectorXd f, w, b;         // planted
  VectorXd y;               // of a closing row; empty where there is none
  double gap = 0;           // b.y
  bool is_unknown = false;  // b is not what f and w say

  RowBounds bounds() const {
    RowBounds bounds = RowBounds::WithBilateralRows(G.rows(), bilateral);
    bounds.friction = friction;
    bounds.bounded = bounded;
    return bounds;
  }
};

// What rows are, the last one a contact or a joint; joints have been drawn.
void DrawLaws(TestRandom* random, Exact* exact) {
  const Index n = exact->G.rows();
  const bool is_paired = random->Chance(0.5);  // n, t, n, t, ...
  const double along = Pick({0.2, 0.5, 0.7}, random), bounded = Pick({0.0, 0.0, 0.2, 0.6}, random);
  const double sliding = Pick({0.0, 0.0, 0.0, 0.3, 1.0}, random), further = Pick({0.0, 0.0, 0.3}, random);
  const double any_mu = Pick({0.0, 0.25, 0.5, 1.0, 4.0, 1e3, 1e6}, random);
  std::vector<Index> normals, tangents;
  std::vector<char> is_joint(static_cast<size_t>(n), 0);
  for (const Index i : exact->bilateral) is_joint[static_cast<size_t>(i)] = 1;
  for (Index i = 0; i < n; ++i) {
    if (is_joint[static_cast<size_t>(i)] != 0) continue;
    if (i + 1 < n && random->Chance(bounded)) {
      const double lower = random->Integer(-9, 9), upper = lower + random->Integer(0, 9);
      const int infinite = random->Integer(0, 5);  // bit 0: below, 1: above
      exact->bounded.push_back({i, infinite % 2 == 1 ? -kInfinity : lower, infinite / 2 == 1 ? kInfinity : upper});
    } else if (i + 1 < n && (is_paired ? i % 2 == 1 : random->Chance(along))) {
      tangents.push_back(i);
    } else {
      normals.push_back(i);
    }
  }
  std::vector<Index> free = normals;
  for (const Index row : tangents) {
    const bool is_further = !normals.empty() && random->Chance(further);
    if (!is_further && free.empty()) {
      exact->bounded.push_back({row, -1, 1});
      continue;
    }
    const auto at = is_paired ? std::ranges::lower_bound(free, row) : free.begin() + Below(free.size() + 1, random);
    const auto chosen = at == free.begin() ? at : at - 1;
    FrictionRow friction{row, is_further ? normals[static_cast<size_t>(Below(normals.size(), random))] : *chosen,
                         any_mu};
    if (!is_further) free.erase(chosen);
    if (random->Chance(0.3)) friction.mu = Pick({0.0, 0x1p-10, 0.125, 0.5, 1.0, 3.0, 64.0, 1e6}, random);
    if (random->Chance(sliding)) friction.slip = static_cast<signed char>(Pick({-1, 1}, random));
    exact->friction.push_back(friction);
  }
}

// +1, -1: the sign that a ray may have on the row; 2: either; 0: none.
std::vector<int> SignsOfRays(const Exact& exact) {
  std::vector<int> sign(static_cast<size_t>(exact.G.rows()), 1);
  for (const Index i : exact.bilateral) sign[static_cast<size_t>(i)] = 2;
  for (const FrictionRow& row : exact.friction) sign[static_cast<size_t>(row.row)] = 0;
  for (const BoundedRow& row : exact.bounded) {
    const bool above = row.upper == kInfinity, below = row.lower == -kInfinity;
    sign[static_cast<size_t>(row.row)] = above && below ? 2 : above ? 1 : below ? -1 : 0;
  }
  return sign;
}

// Planted f and w of friction and bounded rows; those of contacts are there.
void PlantLaws(TestRandom* random, Exact* exact) {
  const double edges = Pick({0.3, 0.6, 1.0}, random), moving = Pick({0.0, 0.5, 0.9}, random);
  const auto gap = [&] { return random->Chance(moving) ? random->Integer(1, 9) : 0; };
  for (const FrictionRow& row : exact->friction) {
    const double most = row.mu * exact->f[row.normal];
    double &f = exact->f[row.row], &w = exact->w[row.row];
    f = w = 0;
    if (row.slip != 0 || most == 0) {
      f = -row.slip * most;
      w = Pick({-1, 1}, random) * gap();
    } else if (random->Chance(edges)) {
      const int slip = Pick({-1, 1}, random);
      f = -slip * most;
      w = slip * gap();
    } else {
      f = most * random->Integer(-8, 8) / 8;
    }
  }
  for (const BoundedRow& row : exact->bounded) {
    double &f = exact->f[row.row], &w = exact->w[row.row];
    f = std::clamp<double>(random->Integer(-9, 9), row.lower, row.upper);
    w = 0;
    const bool at_lower = row.lower > -kInfinity && random->Chance(edges);
    if (exact->y.size() > 0 && exact->y[row.row] != 0) continue;
    if (at_lower || (row.upper < kInfinity && random->Chance(edges))) {
      f = at_lower ? row.lower : row.upper;
      w = at_lower ? gap() : -gap();
    }
  }
}

// The last row becomes -(a combination of the others): G^T y = 0.
void CloseACombination(TestRandom* random, Exact* exact) {
  const Index last = exact->G.rows() - 1;
  exact->y = VectorXd::Zero(last + 1);
  const std::vector<int> sign = SignsOfRays(*exact);
  const double share = Pick({0.1, 0.4, 1.0}, random);
  const int largest = share == 1.0 ? 1 : 3;
  for (Index i = 0; i < last; ++i) {
    if (sign[static_cast<size_t>(i)] == 0 || !random->Chance(share)) continue;
    exact->y[i] = (sign[static_cast<size_t>(i)] < 0 ? -1 : 1) * random->Integer(1, largest);
  }
  for (const Index i : exact->bilateral) {
    if (i < last && random->Chance(0.5)) exact->y[i] *= -1;
  }
  exact->G.row(last) = -exact->y.transpose() * exact->G;
  exact->y[last] = 1;
  const double size = random->Chance(0.6) ? random->Integer(1, 9) : std::ldexp(1.0, -random->Integer(5, 20));
  exact->gap = Pick({-1, -1, 0, 1}, random) * size;
}

Exact MakeExact(const Kind& kind, bool with_friction, TestRandom* random) {
  const int most = with_friction ? Pick({4, 8, 16, 16, 40, 100}, random) : Pick({6, 12, 30, 70, 130}, random);
  Exact exact;
  exact.G = kind.rows(random->Integer(1, most), random);
  const Index n = exact.G.rows();
  const double joints = Pick({0.0, 0.0, 0.2, 1.0}, random);
  for (Index i = 0; i < n; ++i) {
    if (random->Chance(joints)) exact.bilateral.push_back(i);
  }
  if (with_friction) DrawLaws(random, &exact);
  if (random->Chance(0.5)) CloseACombination(random, &exact);

  const int wide = random->Chance(0.3) ? 6 : 0;
  exact.m.resize(exact.G.cols());
  for (double& m : exact.m)
    m = random->Chance(0.1) ? 0 : std::ldexp(random->Integer(1, 4), random->Integer(-wide, wide));

  const RowBounds bounds = RowBounds::WithBilateralRows(n, exact.bilateral);
  const auto is_joint = [&](Index i) {
    return !bounds.bilateral.empty() && bounds.bilateral[static_cast<size_t>(i)] != 0;
  };
  const double degenerate = Pick({0.0, 0.0, 0.3, 0.85, 1.0}, random);
  const double active = Pick({0.0, 0.3, 0.5, 0.8, 1.0}, random);
  exact.f = exact.w = VectorXd::Zero(n);
  for (Index i = 0; i < n; ++i) {
    const double value = random->Integer(1, 9);
    const bool closed = exact.y.size() > 0 && exact.y[i] != 0;  // y.w = b.y
    if (is_joint(i)) {
      exact.f[i] = Pick({-1, 1}, random) * value;
    } else if (!random->Chance(degenerate)) {
      if (random->Chance(active)) {
        exact.f[i] = value;
      } else if (!closed) {
        exact.w[i] = value;
      }
    }
  }
  if (exact.gap > 0) {
    if (is_joint(n - 1)) {
      exact.gap = 0;
    } else {
      exact.f[n - 1] = 0;
      exact.w[n - 1] = exact.gap;
    }
  }
  if (with_friction) PlantLaws(random, &exact);
  exact.b = exact.w - exact.G * exact.m.cwiseProduct(exact.G.transpose() * exact.f);
  if (exact.gap < 0) exact.b[n - 1] += exact.gap;
  exact.is_unknown = with_friction && exact.gap >= 0 && random->Chance(0.1);
  for (double& b : exact.b) {
    if (exact.is_unknown && random->Chance(0.5)) b += random->Integer(-9, 9);
  }
  return exact;
}

constexpr int kMost = 490;  // so that A, whose entries reach 2^30 before, stays finite
constexpr int kMostWithFriction = 300;
constexpr int kSafe = 950;  // the same for b, and f other than the planted one

struct Scale {
  const char* name;
  std::vector<int> row;     // S_ii = 2^row_i
  std::vector<int> column;  // c_k = 2^column_k, by factors only
  int load = 0;             // t = 2^load
};

Scale MakeScale(Index n, Index columns, bool by_factors, int most, TestRandom* random) {
  Scale scale{"plain", std::vector<int>(static_cast<size_t>(n), 0), std::vector<int>(static_cast<size_t>(columns), 0)};
  if (random->Chance(0.1)) return scale;
  const int spread = std::min(Pick({0, 0, 20, 100, 250, kMost}, random), most);
  const int middle = random->Integer(spread - most, most - spread);
  const bool is_graded = random->Chance(0.5);
  scale.name = spread == 0 ? "uniform" : is_graded ? "graded" : "rows";
  for (Index i = 0; i < n; ++i) {
    const int step = is_graded ? static_cast<int>(2 * spread * i / std::max<Index>(n - 1, 1)) - spread
                               : random->Integer(-spread, spread);
    scale.row[static_cast<size_t>(i)] = middle + step;
  }
  // b in range, and f where it can be.
  const auto [least, largest] = std::minmax_element(scale.row.begin(), scale.row.end());
  scale.load = random->Integer(std::max(*largest, -*least) - kSafe, kSafe - std::max(*largest, -*least));
  if (by_factors && random->Chance(0.1)) {
    scale.name = "tiny";  // A_ii is below the range of doubles
    std::fill(scale.row.begin(), scale.row.end(), random->Integer(-900, -kMost));
    scale.load = random->Integer(-50, 50);
  } else if (random->Chance(0.15)) {
    scale.name = "far";  // f wherever it may be
    scale.load = random->Integer(-kSafe - *least, kSafe - *largest);
  }
  if (by_factors && random->Chance(0.3)) {
    const int unit = Pick({5, 50, 100}, random);
    for (int& c : scale.column) c = random->Integer(-unit, unit);
  }
  return scale;
}

// Whether a ray that is rounded to double, or a little worse, still meets the verifier's threshold. Only for rows that
// nothing moves, whose unit the verifier does not know, that depends on the scale.
bool IsProvable(const Exact& exact, const Scale& scale) {
  const VectorXd diagonal = exact.G.cwiseAbs2() * exact.m;
  const VectorXd body = exact.m.cwiseProduct(exact.G.cwiseAbs().transpose() * exact.y.cwiseAbs());
  const VectorXd summed = exact.G.cwiseAbs() * body;
  double largest = 0;
  double b = 0;
  for (Index i = 0; i < diagonal.size(); ++i) {
    const double unit = diagonal[i] == 0 ? std::ldexp(1.0, -scale.row[static_cast<size_t>(i)]) : std::sqrt(diagonal[i]);
    largest = std::max(largest, summed[i] / unit);
    b += std::abs(exact.b[i]) / unit;
  }
  constexpr double kRounding = 0x1p-50;
  return -exact.gap >= FarkasVerdict::kRayThreshold * kRounding * largest * b;
}

// An exact product, which may be beyond the range.
VectorXd Scaled(const VectorXd& x, const std::vector<int>& row, int sign, int load) {
  VectorXd scaled(x.size());
  for (Index i = 0; i < x.size(); ++i) scaled[i] = std::ldexp(x[i], sign * row[static_cast<size_t>(i)] + load);
  return scaled;
}

LcpProblem Build(const std::string& id, const Exact& exact, const Scale& scale, MatrixForm form) {
  VectorXd b = Scaled(exact.b, scale.row, 1, scale.load);
  RowBounds bounds = exact.bounds();
  const auto exponent = [&](Index row) { return scale.row[static_cast<size_t>(row)]; };
  for (FrictionRow& row : bounds.friction) row.mu = std::ldexp(row.mu, exponent(row.normal) - exponent(row.row));
  for (BoundedRow& row : bounds.bounded) {
    row.lower = std::ldexp(row.lower, scale.load - exponent(row.row));
    row.upper = std::ldexp(row.upper, scale.load - exponent(row.row));
  }
  const bool has_factors = form == MatrixForm::kFactors;
  MatrixXd matrix = has_factors ? exact.G : MatrixXd(exact.G * exact.m.asDiagonal() * exact.G.transpose());
  for (Index i = 0; i < matrix.rows(); ++i) {
    for (Index k = 0; k < matrix.cols(); ++k) {
      const int across = has_factors ? -scale.column[static_cast<size_t>(k)] : scale.row[static_cast<size_t>(k)];
      matrix(i, k) = std::ldexp(matrix(i, k), scale.row[static_cast<size_t>(i)] + across);
    }
  }
  if (form == MatrixForm::kDense) {
    return LcpProblem::FromDense(id, std::move(matrix), std::move(b), std::move(bounds), SymmetricPsd());
  }
  const SparseMatrix sparse = matrix.sparseView(1.0, 0.0);
  if (!has_factors) return LcpProblem::FromSparse(id, sparse, std::move(b), std::move(bounds), SymmetricPsd());
  std::vector<int> twice = scale.column;
  for (int& c : twice) c *= 2;
  return LcpProblem::FromFactors(id, sparse, Scaled(exact.m, twice, 1, 0), std::move(b), std::move(bounds));
}

AttackProblem Draw(unsigned seed, bool with_friction, TestRandom* random) {
  const Kind& kind = kKinds[Below(with_friction ? static_cast<Index>(std::size(kKinds)) : kPlainKinds, random)];
  const Exact exact = MakeExact(kind, with_friction, random);
  const MatrixForm form = Pick({MatrixForm::kDense, MatrixForm::kSparse, MatrixForm::kFactors}, random);
  Scale scale = MakeScale(exact.G.rows(), exact.G.cols(), form == MatrixForm::kFactors,
                          with_friction ? kMostWithFriction : kMost, random);
  if (!exact.bounded.empty()) {  // bounds in range
    const auto [least, largest] = std::minmax_element(scale.row.begin(), scale.row.end());
    scale.load = std::clamp(scale.load, *largest - kSafe, *least + kSafe);
  }
  const bool is_solvable = exact.gap >= 0;

  constexpr const char* kForms[] = {"dense", "sparse", "factors"};
  const std::string id = std::to_string(seed) + "-" + kind.name + "-" + scale.name + "-" +
                         kForms[static_cast<size_t>(form)] +
                         (exact.is_unknown ? "-unknown"
                          : is_solvable    ? ""
                                           : "-infeasible");
  AttackProblem attack{.test = {Build(id, exact, scale, form), {}}, .proof = {}};
  if (exact.is_unknown) return attack;
  attack.test.reference.status = is_solvable ? LcpReference::Status::kSolved : LcpReference::Status::kInfeasible;
  if (!is_solvable) {
    attack.proof = Scaled(exact.y, scale.row, -1, 0);
    attack.may_fail = !IsProvable(exact, scale);
    return attack;
  }
  if (exact.friction.empty()) attack.test.reference.w = Scaled(exact.w, scale.row, 1, scale.load);
  attack.proof = Scaled(exact.f, scale.row, -1, scale.load);
  if (random->Chance(0.2)) {
    attack.start = attack.proof;
    for (double& f : *attack.start) {
      if (random->Chance(0.2)) f = Pick({0.0, 2 * f, -f, 1e300, 1e-300}, random);
    }
    if (!attack.start->allFinite()) attack.start.reset();
  }
  attack.may_fail =
      !std::all_of(scale.row.begin(), scale.row.end(), [&](int row) { return std::abs(scale.load - row) <= kSafe; });
  return attack;
}

// Whether `proof` proves the status without any rounding, by the verifier's measures.
bool IsProved(const AttackProblem& attack) {
  const LcpProblem& problem = attack.test.problem;
  if (attack.test.reference.status == LcpReference::Status::kUnknown) return true;
  if (attack.test.reference.status == LcpReference::Status::kInfeasible) {
    return VerifyFarkasRay(problem, attack.proof).proved;
  }
  return attack.may_fail || ComputeMetrics(problem, attack.proof).rho == 0;
}

}  // namespace

AttackProblem MakeAttackProblem(unsigned seed, bool with_friction) {
  TestRandom random(seed);
  for (;;) {
    AttackProblem attack = Draw(seed, with_friction, &random);
    if (IsProved(attack)) return attack;
  }
}

}  // namespace lcpbench
