// Bullet: btSolveDantzigLCP, btLemkeAlgorithm, projected Gauss-Seidel on A, and sequential impulses, double precision.
//
// Bullet keeps an error flag in a global variable and its containers in its own allocator; both are its alone.
// Lemke gives up after a number of loops of its own choosing unless told (default of the class: 100); it takes
// unilateral rows only.

#include <BulletDynamics/ConstraintSolver/btSequentialImpulseConstraintSolver.h>
#include <BulletDynamics/ConstraintSolver/btTypedConstraint.h>
#include <BulletDynamics/Dynamics/btRigidBody.h>
#include <BulletDynamics/MLCPSolvers/btDantzigLCP.h>
#include <BulletDynamics/MLCPSolvers/btLemkeAlgorithm.h>
#include <BulletDynamics/MLCPSolvers/btSolveProjectedGaussSeidel.h>
#include <LinearMath/btScalar.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/dantzig_peer.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {
namespace {

int NoPadding(int rows) { return rows; }

bool CallDantzig(const DantzigProblem& p) {
  // Kept between calls, as the engine does.
  static btDantzigScratchMemory scratch;
  return btSolveDantzigLCP(p.rows, p.A, p.x, p.b, p.w, 0, p.lower, p.upper, p.findex, scratch);
}

/// w = M z + q, as ours. One pivot is O(n^2) on a tableau of n (2n + 2).
class Lemke : public LcpSolver {
 public:
  std::string WhyUnsupported(const LcpProblem& problem) const override {
    return problem.bilateral_rows().empty() ? "" : "takes unilateral rows only";
  }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    RequireDenseMatrices(problem.size(), 3);  // M and the tableau
    const auto n = static_cast<int>(problem.size());
    M_.resize(n, n);
    AssembleDenseA(problem, M_.getBufferPointerWritable(), n);
  }
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    // Enough for every sequence of pivots that is not a cycle in practice; the class's own 100 ends most early.
    constexpr std::int64_t kPivotsPerRow = 20;
    constexpr std::int64_t kFewestPivots = 1000;
    const std::int64_t usual = std::max<std::int64_t>(kFewestPivots, kPivotsPerRow * problem.size());
    const int most = IterationLimit(options, static_cast<double>(usual));
    q_.resize(static_cast<int>(problem.size()));
    std::copy(problem.b().begin(), problem.b().end(), q_.getBufferPointerWritable());
    btLemkeAlgorithm lemke(M_, q_);
    btVectorXu z;
    TimeLibraryCall(options, result, [&] { z = lemke.solve(static_cast<unsigned int>(most)); });
    const bool solved = lemke.getInfo() == 0;
    // (w, z, z0): our f is its z, the second part.
    const auto n = static_cast<int>(problem.size());
    if (z.size() >= 2 * n) {
      for (int i = 0; i < n; ++i) result->f[i] = z[n + i];
    }
    result->iterations = lemke.getSteps();
    result->status = solved ? LcpStatus::kSolved : LcpStatus::kNumericalFailure;
    if (!solved) result->detail = "the code returned failure";
  }

 private:
  btMatrixXu M_;
  btVectorXu q_;
};

/// btSolveProjectedGaussSeidel: A x = b, with a friction row's bounds from the normal force of the same sweep. Starts
/// warm. Its numbers of sweeps are those asked for: it does not tell how many of the last portion it made. A row with
/// A_ii = 0 makes forces infinite, or no numbers.
class MatrixSweeps : public LcpSolver {
 public:
  MatrixSweeps(std::string_view key, SettingsReader* reader) : tier_(key, reader) {}
  bool TakesFriction() const override { return true; }
  bool TakesBounded() const override { return true; }
  std::string WhyUnsupported(const LcpProblem& problem) const override { return WhySliding(problem.friction_rows()); }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    RequireDenseMatrices(problem.size(), 2);  // and the code's lists of nonzero entries
    const auto n = static_cast<int>(problem.size());
    A_.resize(n, n);
    AssembleDenseA(problem, A_.getBufferPointerWritable(), n);
    lower_.resize(n);
    upper_.resize(n);
    normal_.resizeNoInitialize(0);
    normal_.resize(n, -1);
    for (int i = 0; i < n; ++i) {
      lower_[i] = problem.is_bilateral(i) ? -SIMD_INFINITY : 0;
      upper_[i] = SIMD_INFINITY;
    }
    for (const BoundedRow& row : problem.bounded_rows()) {
      lower_[static_cast<int>(row.row)] = row.lower;
      upper_[static_cast<int>(row.row)] = row.upper;
    }
    for (const FrictionRow& row : problem.friction_rows()) {
      lower_[static_cast<int>(row.row)] = -row.mu;
      upper_[static_cast<int>(row.row)] = row.mu;
      normal_[static_cast<int>(row.row)] = static_cast<int>(row.normal);
    }
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    const Deadline deadline(options);
    const Index n = problem.size();
    TimeConversion(options, result, [&] {
      b_.resize(static_cast<int>(n));
      x_.resize(static_cast<int>(n));
      double squares = 0;  // of what the first sweep would move forces by, if rows did not act on each other
      for (int i = 0; i < n; ++i) {
        b_[i] = -problem.b()[i];
        x_[i] = options.initial_f == nullptr ? 0 : (*options.initial_f)[i];
        if (A_(i, i) > 0) squares += (b_[i] / A_(i, i)) * (b_[i] / A_(i, i));
      }
      const double tolerance = tier_.Tolerance(options);
      code_.m_leastSquaresResidualThreshold = tolerance * tolerance * (squares > 0 ? squares : 1);
    });
    TimeLibraryCall(options, result, [&] {
      SweepInPortions(tier_.Iterations(options), static_cast<double>(n * n), deadline, result, [&](int sweeps) {
        code_.solveMLCP(A_, b_, x_, lower_, upper_, normal_, sweeps);
        return code_.m_leastSquaresResidual < code_.m_leastSquaresResidualThreshold;
      });
    });
    for (int i = 0; i < n; ++i) result->f[i] = x_[i];
  }

 private:
  PeerTier tier_;
  btSolveProjectedGaussSeidel code_;
  btMatrixXu A_;
  btVectorXu b_, x_, lower_, upper_;
  btAlignedObjectArray<int> normal_;
};

/// One row as the engine has it: directions of the force and of its moment, for either body.
struct EngineRow {
  /// Which of the engine's lists it stands in. Joints have bounds of their own.
  enum class List : unsigned char { kJoints, kContacts, kFriction };

  Index row = 0;
  std::array<btVector3, 2> linear;
  std::array<btVector3, 2> angular;
  btScalar lower = 0;
  btScalar upper = SIMD_INFINITY;
  List list = List::kJoints;
  std::size_t normal = 0;  ///< of kFriction: which EngineRow
  btScalar mu = 0;         ///< of kFriction
};

/// Consecutive rows between the same two bodies.
class Rows : public btTypedConstraint {
 public:
  Rows(btRigidBody* a, btRigidBody* b, const std::vector<EngineRow>* rows, std::size_t first, const double* minus_b)
      : btTypedConstraint(D6_CONSTRAINT_TYPE, *a, *b), rows_(rows), first_(first), minus_b_(minus_b) {}
  void Extend() { ++count_; }

  void getInfo1(btConstraintInfo1* info) override {
    info->m_numConstraintRows = count_;
    info->nub = 0;
  }
  void getInfo2(btConstraintInfo2* info) override {
    for (int i = 0; i < count_; ++i) {
      const EngineRow& row = (*rows_)[first_ + static_cast<std::size_t>(i)];
      const int at = i * info->rowskip;
      for (int axis = 0; axis < 3; ++axis) {
        info->m_J1linearAxis[at + axis] = row.linear[0][axis];
        info->m_J1angularAxis[at + axis] = row.angular[0][axis];
        info->m_J2linearAxis[at + axis] = row.linear[1][axis];
        info->m_J2angularAxis[at + axis] = row.angular[1][axis];
      }
      info->m_constraintError[at] = minus_b_[row.row];
      info->cfm[at] = 0;
      info->m_lowerLimit[at] = row.lower;
      info->m_upperLimit[at] = row.upper;
    }
  }
  void setParam(int /*number*/, btScalar /*value*/, int /*axis*/) override {}
  btScalar getParam(int /*number*/, int /*axis*/) const override { return 0; }

 private:
  const std::vector<EngineRow>* rows_;
  std::size_t first_;
  const double* minus_b_;
  int count_ = 1;
};

/// The engine's solver, with the clock read at each sweep; keeps the impulses, which it would throw away. All rows come
/// to it as joints: those of contacts with friction are put where it has contacts.
class Engine : public btSequentialImpulseConstraintSolver {
 public:
  /// @param rows  of the constraints that will be given, in order
  void Start(const std::vector<EngineRow>* rows, bool has_friction, const Deadline* deadline) {
    rows_ = rows;
    has_friction_ = has_friction;
    deadline_ = deadline;
    expired_ = false;
    reset();  // the seed of random orders
  }
  bool expired() const { return expired_; }
  int sweeps() const { return m_analyticsData.m_numIterationsUsed; }
  double residual() const { return m_analyticsData.m_remainingLeastSquaresResidual; }
  const std::vector<double>& impulses() const { return impulses_; }

 protected:
  btScalar solveGroupCacheFriendlySetup(btCollisionObject** bodies, int number_of_bodies,
                                        btPersistentManifold** manifolds, int number_of_manifolds,
                                        btTypedConstraint** constraints, int number_of_constraints,
                                        const btContactSolverInfo& info, btIDebugDraw* drawer) override {
    const btScalar made = btSequentialImpulseConstraintSolver::solveGroupCacheFriendlySetup(
        bodies, number_of_bodies, manifolds, number_of_manifolds, constraints, number_of_constraints, info, drawer);
    if (has_friction_) PlaceContacts();
    return made;
  }
  btScalar solveSingleIteration(int iteration, btCollisionObject** bodies, int number_of_bodies,
                                btPersistentManifold** manifolds, int number_of_manifolds,
                                btTypedConstraint** constraints, int number_of_constraints,
                                const btContactSolverInfo& info, btIDebugDraw* drawer) override {
    const btScalar residual = btSequentialImpulseConstraintSolver::solveSingleIteration(
        iteration, bodies, number_of_bodies, manifolds, number_of_manifolds, constraints, number_of_constraints, info,
        drawer);
    if (residual <= info.m_leastSquaresResidualThreshold || !deadline_->Expired()) return residual;
    expired_ = true;
    return 0;  // which ends the sweeps
  }
  btScalar solveGroupCacheFriendlyFinish(btCollisionObject** bodies, int number_of_bodies,
                                         const btContactSolverInfo& info) override {
    impulses_.resize(rows_->size());
    std::array<int, 3> next{};
    for (std::size_t i = 0; i < rows_->size(); ++i) {
      const EngineRow::List list = (*rows_)[i].list;
      impulses_[i] = ListOf(list)[next[static_cast<std::size_t>(list)]++].m_appliedImpulse;
    }
    return btSequentialImpulseConstraintSolver::solveGroupCacheFriendlyFinish(bodies, number_of_bodies, info);
  }

 private:
  btConstraintArray& ListOf(EngineRow::List list) {
    if (list == EngineRow::List::kJoints) return m_tmpSolverNonContactConstraintPool;
    return list == EngineRow::List::kContacts ? m_tmpSolverContactConstraintPool
                                              : m_tmpSolverContactFrictionConstraintPool;
  }
  void PlaceContacts() {
    all_ = m_tmpSolverNonContactConstraintPool;
    m_tmpSolverNonContactConstraintPool.resizeNoInitialize(0);
    std::vector<int> place(rows_->size());
    for (std::size_t i = 0; i < rows_->size(); ++i) {
      btConstraintArray& list = ListOf((*rows_)[i].list);
      place[i] = list.size();
      list.push_back(all_[static_cast<int>(i)]);
    }
    int tangent = 0;
    for (const EngineRow& row : *rows_) {
      if (row.list != EngineRow::List::kFriction) continue;
      btSolverConstraint& made = m_tmpSolverContactFrictionConstraintPool[tangent++];
      made.m_friction = row.mu;
      made.m_frictionIndex = place[row.normal];
    }
    SetOrder(m_tmpSolverNonContactConstraintPool, &m_orderNonContactConstraintPool);
    SetOrder(m_tmpSolverContactConstraintPool, &m_orderTmpConstraintPool);
    SetOrder(m_tmpSolverContactFrictionConstraintPool, &m_orderFrictionConstraintPool);
  }
  static void SetOrder(const btConstraintArray& list, btAlignedObjectArray<int>* order) {
    order->resizeNoInitialize(list.size());
    for (int i = 0; i < list.size(); ++i) (*order)[i] = i;
  }

  const std::vector<EngineRow>* rows_ = nullptr;
  bool has_friction_ = false;
  btConstraintArray all_;
  const Deadline* deadline_ = nullptr;
  bool expired_ = false;
  std::vector<double> impulses_;
};

/// A body with the scales of its columns: sqrt of the column's inverse mass over the body's.
class Body {
 public:
  Body(const LcpProblem& problem, Index body) {
    const Index width = problem.columns_per_body();
    const auto inverse_mass = problem.inverse_mass().segment(body * width, width);
    const Index directions = width / 2 + width % 2;  // 2 of 3, 3 of 6
    const double largest = inverse_mass.head(directions).maxCoeff();
    btVector3 inertia(0, 0, 0);
    for (Index axis = 0; axis < directions; ++axis) {
      linear_[static_cast<int>(axis)] = largest > 0 ? std::sqrt(inverse_mass[axis] / largest) : 0;
    }
    for (Index axis = 0; axis < width - directions; ++axis) {
      const double inverse = inverse_mass[directions + axis];
      // In the plane bodies turn about z.
      if (inverse > 0) inertia[static_cast<int>(width == kPlanar ? 2 : axis)] = 1 / inverse;
    }
    // What can turn but not move gets a mass that nothing sees, since the engine takes a body without one for fixed.
    const btScalar mass = largest > 0 ? 1 / largest : 1;
    rigid_ = std::make_unique<btRigidBody>(btRigidBody::btRigidBodyConstructionInfo(mass, nullptr, nullptr, inertia));
  }
  btRigidBody* rigid() const { return rigid_.get(); }
  /// An entry of a row of J becomes the engine's.
  void Place(Index column, Index width, double value, btVector3* linear, btVector3* angular) const {
    if (width == kPlanar) {
      if (column < 2) {
        (*linear)[static_cast<int>(column)] = value * linear_[static_cast<int>(column)];
      } else {
        (*angular)[2] = value;
      }
    } else if (column < 3) {
      (*linear)[static_cast<int>(column)] = value * linear_[static_cast<int>(column)];
    } else {
      (*angular)[static_cast<int>(column - 3)] = value;
    }
  }

 private:
  static constexpr Index kPlanar = 3;
  btVector3 linear_{0, 0, 0};
  std::unique_ptr<btRigidBody> rigid_;
};

/// btSequentialImpulseConstraintSolver, projected Gauss-Seidel over the velocities of bodies, as engines run it: keys
/// "bullet-si" (until the velocity that a sweep still corrects is small, see TierSettings) and "bullet-si-N" (N
/// sweeps).
///
/// Needs J with rows on at most two bodies. Runs of rows between the same two bodies become one btTypedConstraint whose
/// getInfo2 gives J, -b and the bounds. Nothing of the engine is left that would change w = A f + b: the bodies are at
/// rest, without load, and have neither damping nor error reduction (erp), mixing (cfm) or split impulses. Planar
/// bodies move in the xy-plane. The engine has one mass for the three directions of a body, the largest inverse one
/// here: columns whose inverse mass is another are scaled, which leaves A as it is. f starts at zero always: the engine
/// warm starts the contacts that it has made only. Iterations are sweeps. Not a word of success is said with N sweeps,
/// unless nothing moved in the last.
///
/// Where there is friction, unilateral rows are the engine's contacts and friction rows theirs, any number each: a
/// sweep goes over joints and bounded rows, then over contacts, then over friction rows with bounds from the contacts'
/// impulses. It passes by friction rows of contacts without impulse, which keep what impulse they have.
class SequentialImpulses : public LcpSolver {
 public:
  SequentialImpulses(std::string_view key, SettingsReader* reader) {
    constexpr std::string_view kPrefix = "bullet-si-";
    if (key.starts_with(kPrefix)) {
      std::from_chars(key.data() + kPrefix.size(), key.data() + key.size(), sweeps_);
      return;
    }
    tier_ = PeerTier(key, reader);
    is_random_ = Choose<bool>(reader, "order", {{"index", false}, {"random", true}});
  }

  bool TakesFriction() const override { return true; }
  bool TakesBounded() const override { return true; }
  std::string WhyUnsupported(const LcpProblem& problem) const override {
    if (!problem.has_factors()) return "needs the bodies: J and the inverse masses";
    return problem.has_two_body_rows() ? WhySliding(problem.friction_rows()) : "a row joins more than two bodies";
  }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    const Index width = problem.columns_per_body();
    const Index bodies = problem.J().cols() / width;
    RequireMemory(
        static_cast<double>(bodies) * (sizeof(btRigidBody) + sizeof(btSolverBody)) +
            static_cast<double>(problem.size()) * (sizeof(Rows) + sizeof(EngineRow) + sizeof(btSolverConstraint)),
        "the bodies and rows of the engine");
    constraints_.clear();
    rows_.clear();
    bodies_.clear();
    std::vector<int> place(static_cast<std::size_t>(bodies), -1);
    for (Index body = 0; body < bodies; ++body) {
      if (problem.inverse_mass().segment(body * width, width).maxCoeff() <= 0) continue;
      place[static_cast<std::size_t>(body)] = static_cast<int>(bodies_.size());
      bodies_.emplace_back(problem, body);
    }
    minus_b_.resize(problem.size());
    rows_.reserve(static_cast<std::size_t>(problem.size()));
    for (Index row = 0; row < problem.size(); ++row) AddRow(problem, row, place);
    if (!problem.is_plain()) SetLaws(problem);
    objects_.clear();
    for (const Body& body : bodies_) objects_.push_back(body.rigid());
    pointers_.clear();
    for (const auto& constraint : constraints_) pointers_.push_back(constraint.get());
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    const Deadline deadline(options);
    btContactSolverInfo info;
    TimeConversion(options, result, [&] {
      minus_b_ = -problem.b();
      // The velocities that the solve before left.
      for (const Body& body : bodies_) {
        body.rigid()->setLinearVelocity(btVector3(0, 0, 0));
        body.rigid()->setAngularVelocity(btVector3(0, 0, 0));
      }
      info.m_timeStep = 1;
      info.m_splitImpulse = 0;
      info.m_numIterations = IterationLimit(options, sweeps_);
      if (sweeps_ == 0) {
        const double velocity = tier_.Tolerance(options) * problem.b().cwiseAbs().maxCoeff();
        info.m_numIterations = tier_.Iterations(options);
        info.m_leastSquaresResidualThreshold = velocity * velocity;
      }
      info.m_solverMode &= ~SOLVER_USE_WARMSTARTING;  // there are no points of contact to keep impulses at
      if (is_random_) info.m_solverMode |= SOLVER_RANDMIZE_ORDER;
      engine_.Start(&rows_, !problem.friction_rows().empty(), &deadline);
    });
    if (pointers_.empty()) {
      result->status = LcpStatus::kSolved;
      return;
    }
    TimeLibraryCall(options, result, [&] {
      engine_.solveGroup(objects_.data(), static_cast<int>(objects_.size()), nullptr, 0, pointers_.data(),
                         static_cast<int>(pointers_.size()), info, nullptr, nullptr);
    });
    TimeConversion(options, result, [&] {
      for (std::size_t i = 0; i < rows_.size(); ++i) result->f[rows_[i].row] = engine_.impulses()[i];
    });
    result->iterations = engine_.sweeps();
    if (engine_.expired()) {
      result->status = LcpStatus::kTimeLimit;
    } else if (engine_.residual() <= info.m_leastSquaresResidualThreshold) {
      result->status = LcpStatus::kSolved;
    } else {
      result->status = LcpStatus::kIterationLimit;
    }
  }

 private:
  // Rows that move nothing are left out: the engine would divide by their A_ii.
  void AddRow(const LcpProblem& problem, Index row, const std::vector<int>& place) {
    const Index width = problem.columns_per_body();
    std::array<int, 2> joined{-1, -1};
    EngineRow made;
    made.row = row;
    made.lower = problem.is_bilateral(row) ? -SIMD_INFINITY : 0;
    for (int side = 0; side < 2; ++side) {
      made.linear[static_cast<std::size_t>(side)].setZero();
      made.angular[static_cast<std::size_t>(side)].setZero();
    }
    for (SparseMatrix::InnerIterator entry(problem.J(), row); entry; ++entry) {
      const int body = place[static_cast<std::size_t>(entry.col() / width)];
      if (body < 0 || problem.inverse_mass()[entry.col()] == 0) continue;
      if (joined[0] < 0) joined[0] = body;
      if (body != joined[0]) joined[1] = body;
      const std::size_t side = body == joined[0] ? 0 : 1;
      bodies_[static_cast<std::size_t>(body)].Place(entry.col() % width, width, entry.value(), &made.linear[side],
                                                    &made.angular[side]);
    }
    if (joined[0] < 0) return;
    rows_.push_back(made);
    if (!constraints_.empty() && joined == last_joined_) {
      constraints_.back()->Extend();
      return;
    }
    last_joined_ = joined;
    btRigidBody* second =
        joined[1] < 0 ? &btTypedConstraint::getFixedBody() : bodies_[static_cast<std::size_t>(joined[1])].rigid();
    constraints_.push_back(std::make_unique<Rows>(bodies_[static_cast<std::size_t>(joined[0])].rigid(), second, &rows_,
                                                  rows_.size() - 1, minus_b_.data()));
  }

  // Friction rows whose normal row was left out, which has no force, have none.
  void SetLaws(const LcpProblem& problem) {
    constexpr std::size_t kLeftOut = std::numeric_limits<std::size_t>::max();
    std::vector<std::size_t> place(static_cast<std::size_t>(problem.size()), kLeftOut);
    const auto place_of = [&](Index row) -> std::size_t& { return place[static_cast<std::size_t>(row)]; };
    for (std::size_t i = 0; i < rows_.size(); ++i) place_of(rows_[i].row) = i;
    for (const BoundedRow& bounded : problem.bounded_rows()) {
      if (place_of(bounded.row) == kLeftOut) continue;
      rows_[place_of(bounded.row)].lower = bounded.lower;
      rows_[place_of(bounded.row)].upper = bounded.upper;
    }
    if (problem.friction_rows().empty()) return;
    for (EngineRow& row : rows_) {
      if (problem.kind(row.row) == RowKind::kUnilateral) row.list = EngineRow::List::kContacts;
    }
    for (const FrictionRow& tangent : problem.friction_rows()) {
      if (place_of(tangent.row) == kLeftOut) continue;
      EngineRow& row = rows_[place_of(tangent.row)];
      row.upper = row.lower = 0;
      if (place_of(tangent.normal) == kLeftOut) continue;
      row.list = EngineRow::List::kFriction;
      row.normal = place_of(tangent.normal);
      row.mu = tangent.mu;
    }
  }

  int sweeps_ = 0;  // 0: as the tier says
  PeerTier tier_;
  bool is_random_ = false;
  std::vector<Body> bodies_;
  std::vector<EngineRow> rows_;
  std::vector<std::unique_ptr<Rows>> constraints_;
  std::array<int, 2> last_joined_{-1, -1};
  Eigen::VectorXd minus_b_;
  std::vector<btCollisionObject*> objects_;
  std::vector<btTypedConstraint*> pointers_;
  Engine engine_;
};

std::unique_ptr<LcpSolver> Make(std::string_view key, SettingsReader* reader) {
  if (key == "bullet-lemke") return std::make_unique<Lemke>();
  if (key == "bullet-pgs") return std::make_unique<MatrixSweeps>(key, reader);
  if (key.starts_with("bullet-si")) return std::make_unique<SequentialImpulses>(key, reader);
  return std::make_unique<DantzigPeer>(key, reader, DantzigPeer::Code{&NoPadding, &CallDantzig});
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  // 324 is 3.24.
  constexpr int kHundred = 100;
  return {std::to_string(btGetVersion() / kHundred) + "." + std::to_string(btGetVersion() % kHundred), &Make};
}

}  // namespace lcpbench
