#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "solvers/friction/contact_rows.h"
#include "solvers/friction/friction_answer.h"
#include "solvers/friction/mode_steps.h"
#include "solvers/friction/profile_lu.h"

/// Internal to solvers/.
namespace lcpbench {

/// Lemke's path along the modes of contacts with friction [Lemke 1965; Eaves 1976; docs/friction.md section 5]: the
/// solutions of omega = A phi + b + z d as z falls from where all contacts are open to 0, d in the interior of the dual
/// cones. Each step goes to the nearest wall of the present modes and crosses it; z may rise on the way.
///
/// The basis has a column for each row (a force, a gap, or the distance of a force from the wall of its cone) and z;
/// its inverse is dense, n x n, renewed by rank-one updates, O(n^2) a pivot, and made anew at times.
class ContactPath {
 public:
  /// How a path ended.
  enum class End {
    kReached,   ///< z = 0, within rounding
    kRay,       ///< no wall ahead: a secondary ray, which proves nothing about the problem
    kSingular,  ///< rounding spoils the basis
    kLimit,     ///< of pivots, or of the answer's iterations or time
  };

  /// For problems of up to so many rows.
  void Reserve(Index max_rows);
  /// @param seed  of d
  /// @param eps   added to the diagonal of A, so that no rows are dependent
  /// @param phi   n, written where it ended at kReached
  End Follow(const ContactRows& rows, unsigned seed, double eps, FrictionAnswer* answer, Eigen::VectorXd* phi);

 private:
  enum class Cell : unsigned char { kOpen, kClosed, kSlip, kStick, kJoint, kDropped };
  // What a row belongs to, and where that stands.
  struct State {
    Index normal = -1, tangent = -1;  // of the row's contact; -1 of others
    double mu = 0;                    // 0: the friction row has no walls
    double along = 0;                 // f_t / f_n while it neither slips nor sticks
    double span = 0;                  // of a bounded row: between the bounds, may be infinite
    Cell cell = Cell::kJoint;         // the same for both rows of a contact
    int side = 1;                     // the wall: slip of this sign, or bound (1: lower)
  };
  struct Wall {
    Index row = -1;
    bool is_far = false;  // the other side of the cone, or the other bound
    double step = 0;
  };

  void SetViews();
  void Start(const ContactRows& rows, unsigned seed);
  void StartJoints();
  State& Of(Index row) { return state_[static_cast<size_t>(owner_[static_cast<size_t>(row)])]; }
  const State& Of(Index row) const { return state_[static_cast<size_t>(owner_[static_cast<size_t>(row)])]; }
  bool IsNormal(Index row) const { return Of(row).normal == row; }
  bool IsTangent(Index row) const { return Of(row).tangent == row; }
  double BoundOf(Index row) const;
  void SetColumn(Index variable);
  void AddForce(Index row, double factor);
  void SetDirection();
  double ValueOf(Index variable) const;
  double DirectionOf(Index variable) const;
  void Pivot(Index position);
  bool Renew();
  template <typename Test>
  void VisitWalls(Index row, const Test& test) const;
  Wall FirstWall() const;
  void Replace(const Wall& wall);
  void Cross(const Wall& wall);
  Index FarWall(Index row);
  void GetForces(Eigen::VectorXd* phi) const;

  const ContactRows* rows_ = nullptr;
  Index n_ = 0;
  double eps_ = 0;
  std::vector<State> state_;
  std::vector<Index> owner_;     // n, in state_
  std::vector<Index> position_;  // n + 1, of each row's variable and z; -1: not in the basis
  std::vector<Index> variable_;  // n, by position
  // Views of room_: d; the basis's inverse; a column, the direction and values, both by position.
  template <typename Matrix>
  using View = Eigen::Map<Matrix>;
  View<Eigen::VectorXd> cover_{nullptr, 0}, column_{nullptr, 0}, direction_{nullptr, 0}, value_{nullptr, 0};
  View<Eigen::MatrixXd> inverse_{nullptr, 0, 0};
  std::vector<double> room_;
  ProfileLu basis_;
  Index entering_ = -1;
  double entered_ = 0;  // value of the entering variable
  int updates_ = 0;
};

/// Paths of some seeds, each polished and judged; then the same on A + 1e-7 with Newton's method after it. True where
/// an answer passes. *end: of the latest path. *phi: room.
bool FollowPaths(const ContactRows& rows, unsigned seeds, ContactPath* path, ModeSteps* newton, Eigen::VectorXd* phi,
                 FrictionAnswer* answer, ContactPath::End* end);

/// The solver `lemke` for problems that are not plain: FollowPaths. Own limit 50 n + 1000 pivots a path; a secondary
/// ray is kNumericalFailure, as it proves nothing.
class ContactPathSolver {
 public:
  void Prepare(const LcpProblem& problem);                                              ///< LcpSolver::DoPrepare
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result);  ///< LcpSolver::DoSolve

 private:
  ContactRows rows_;
  ContactPath path_;
  ModeSteps newton_;
  Eigen::VectorXd phi_;
};

}  // namespace lcpbench
