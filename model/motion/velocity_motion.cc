#include "model/motion/velocity_motion.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "model/contact/loads.h"
#include "model/contact/path.h"
#include "model/motion/contact_finder.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

/// More than 1 because impulses make bodies faster than their free velocities.
constexpr double kReach = 1.5;
/// Above the rounding of gaps, where everything is at rest [sizes].
constexpr double kContactGap = 1e-6;
/// Gaps and depths of contacts with friction that count as none [sizes]: without it gaps of rounding grow from step to
/// step in piles (docs/friction.md section 9).
constexpr double kClosed = 1e-10;
/// delta [sizes].
constexpr double kDepthClamp = 0.01;

using BodyIndex = std::size_t;

Index Column(BodyIndex body) { return static_cast<Index>(3 * body); }

void Require(bool holds, const char* option, const char* expected) {
  if (!holds) throw InputError(std::string("velocity-level motion: ") + option + ": expected " + expected);
}

void RequireInRange(const VelocityOptions& options) {
  const auto positive = [](double x) { return std::isfinite(x) && x > 0; };
  Require(positive(options.step), "step", "a finite time > 0");
  Require(options.restitution >= 0 && options.restitution <= 1, "restitution", "a number in [0, 1]");
  Require(std::isfinite(options.resting_speed) && options.resting_speed >= 0, "resting_speed", "a finite number >= 0");
  Require(positive(options.doubtful_depth), "doubtful_depth", "a finite number > 0");
}

// y = J x, terms in the order of the columns.
Eigen::VectorXd Times(const SparseMatrix& J, const Eigen::VectorXd& x) {
  Eigen::VectorXd y(J.rows());
  for (Index i = 0; i < J.rows(); ++i) {
    double sum = 0;
    for (SparseMatrix::InnerIterator entry(J, i); entry; ++entry) sum += entry.value() * x[entry.col()];
    y[i] = sum;
  }
  return y;
}

// b = J v^ + c, where a gap rate that stays zero but for rounding is zero: solved again every step, it shrinks by the
// rounding of every step down to numbers without digits, on which no answer is accurate.
Eigen::VectorXd RightHandSide(const SparseMatrix& J, const Eigen::VectorXd& v, const Eigen::VectorXd& c) {
  constexpr double kNothing = 1e-100;  // [m/s]
  Eigen::VectorXd b = Times(J, v) + c;
  for (double& value : b) {
    if (std::abs(value) < kNothing) value = 0;
  }
  return b;
}

// v + M^-1 J^T p, rows in order.
Eigen::VectorXd AfterImpulses(const LcpProblem& problem, const Eigen::VectorXd& p, Eigen::VectorXd v) {
  const SparseMatrix& J = problem.J();
  for (Index i = 0; i < J.rows(); ++i) {
    if (p[i] == 0) continue;
    for (SparseMatrix::InnerIterator entry(J, i); entry; ++entry) {
      v[entry.col()] += problem.inverse_mass()[entry.col()] * (entry.value() * p[i]);
    }
  }
  return v;
}

class VelocityMotion final : public Motion {
 public:
  VelocityMotion(World world, const VelocityOptions& options, LcpSolver& solver)
      : Motion(std::move(world), options.lcp, solver), options_(options) {
    RequireInRange(options_);
    if (finder_.least_width() > 0) size_ = finder_.least_width();
    finder_.RequireShallow(world_, ToString(MotionLevel::kVelocity), TreatedDepth(MotionLevel::kVelocity, size_));
    FollowPathJoints(world_.bodies, world_.joints);
  }

 private:
  // By the least number of equal steps of at most VelocityOptions::step.
  void Move(double duration) override {
    // A quotient that rounding put just above a whole number is that number.
    constexpr double kWhole = 1e-9;
    const double count = std::max(1.0, std::ceil(duration / options_.step - kWhole));
    const double h = duration / count;
    if (!CanAdvance(duration, h)) return;
    for (double k = 0; k < count && status_ == MotionStatus::kMoving; ++k) Step(h);
  }

  double LargestSpeed(const Eigen::VectorXd& v_free) const {
    double largest = 0;
    for (BodyIndex i = 0; i < world_.bodies.size(); ++i) {
      const double radius = finder_.extents()[i].radius;
      if (radius == 0) continue;
      const Vec2 v{v_free[Column(i)], v_free[Column(i) + 1]};
      largest = std::max(largest, Norm(v) + std::abs(v_free[Column(i) + 2]) * radius);
    }
    return largest;
  }

  double DepthTerm(const RowInfo& row, const Constraint& constraint, double h) const {
    const bool contact = constraint.type == ConstraintType::kContact;
    const double clamp = kDepthClamp * size_;
    if (!row.has_gap()) return row.drive;
    if (row.bilateral) return std::clamp(row.d, -clamp, clamp) / h;
    double c = row.d >= 0 ? row.d / h : std::max(row.d, -clamp) / h;
    if (contact && constraint.friction > 0 && std::abs(row.d) <= kClosed * size_) c = 0;
    const bool bounces = options_.restitution > 0 && options_.impact_law == ImpactLaw::kNewton;
    if (contact && bounces && Closes(row, h)) c = std::min(c, options_.restitution * row.d_dot);
    return c;
  }

  // Faster than what counts as rest.
  bool Closes(const RowInfo& row, double h) const {
    return row.d_dot < 0 && -row.d_dot >= options_.resting_speed && row.d + h * row.d_dot <= 0;
  }

  // An impact of the constraints that touch or close within the step, by Poisson's law and without friction; false
  // where none is due.
  bool ResolveImpacts(const std::vector<RowInfo>& rows, double h, ContactSystem* system) {
    ImpactOptions impact;
    impact.law = ImpactLaw::kPoisson;
    impact.restitution = options_.restitution;
    impact.resting_speed = options_.resting_speed;
    bool due = false;
    std::vector<bool> touches(system->constraints.size(), false);
    for (const RowInfo& row : rows) {
      if (!row.has_gap()) continue;
      const bool closes = !row.bilateral && Closes(row, h);
      due = due || (closes && -row.d_dot > impact.velocity_tolerance);
      if (row.bilateral || closes || row.d <= kContactGap * size_) {
        touches[static_cast<std::size_t>(row.constraint)] = true;
      }
    }
    if (!due) return false;
    ++statistics_.impacts;
    ContactSystem touching = PartOf(*system, touches);
    ResolveImpact(impact, Impulses(true), &touching);
    CopyVelocities(touching.bodies, system->bodies);
    CopyVelocities(touching.bodies, world_.bodies);
    return true;
  }

  void GuessImpulses(const ContactSystem& system, const std::vector<RowInfo>& rows) {
    const std::vector<std::optional<int>> previous = matching_.Follow(system, rows);
    guess_ = Eigen::VectorXd::Zero(static_cast<Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (previous[i]) guess_[static_cast<Index>(i)] = impulses_[*previous[i]];
    }
  }

  // With friction a problem may have no solution although no ray says so, and pivoting then breaks down.
  static bool IsUnsolvable(const LcpProblem& problem, const LcpResult& result) {
    if (result.status == LcpStatus::kInfeasible) return true;
    return result.status == LcpStatus::kNumericalFailure && !problem.friction_rows().empty();
  }

  LcpResult Solve(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd& v_free, double h) {
    const LcpProblem& assembled = lcp.problem;
    const Index n = assembled.size();
    Eigen::VectorXd c(n);
    for (Index i = 0; i < n; ++i) {
      const RowInfo& row = lcp.rows[static_cast<std::size_t>(i)];
      const Constraint& constraint = system.constraints[static_cast<std::size_t>(row.constraint)];
      c[i] = DepthTerm(row, constraint, h);
    }
    Eigen::VectorXd v = v_free;
    Eigen::VectorXd b = RightHandSide(assembled.J(), v, c);

    const std::string id = world_.name + "-step" + std::to_string(statistics_.steps);
    // What a step is repeated with while no solution exists.
    const std::function<void()> relax_depth = [&] {
      for (Index i = 0; i < n; ++i) {
        if (lcp.rows[static_cast<std::size_t>(i)].has_gap()) c[i] = assembled.is_bilateral(i) ? 0 : std::max(c[i], 0.0);
      }
    };
    const std::function<void()> relax_drive = [&] {
      for (const FrictionRow& row : assembled.friction_rows()) c[row.row] = 0;
      for (BodyIndex i = 0; i < world_.bodies.size(); ++i) {
        if (world_.bodies[i].fixed) v.segment<3>(Column(i)).setZero();
      }
    };
    LcpResult result;
    const auto solve = [&](const char* suffix) {
      const LcpProblem problem =
          LcpProblem::FromFactors(id + suffix, assembled.J(), assembled.inverse_mass(), b, assembled.bounds());
      solver_.Solve(problem, options_.warm_start ? &guess_ : nullptr, &result);
      if (result.status == LcpStatus::kInfeasible) ++statistics_.unsolvable;
      Observe(MotionProblemKind::kTimeStep, system, lcp.rows, problem, result);
      return !IsUnsolvable(problem, result);
    };
    bool solvable = solve("");
    for (const auto& [relax, suffix] : {std::pair(relax_depth, "-without-depth"), {relax_drive, "-without-drive"}}) {
      if (solvable) break;
      const Eigen::VectorXd refused = b;
      relax();
      b = RightHandSide(assembled.J(), v, c);
      if (b != refused) solvable = solve(suffix);
    }
    RequireFinite(assembled, result);
    return result;
  }

  void MoveBodies(const Eigen::VectorXd& v_new, double h) {
    for (BodyIndex i = 0; i < world_.bodies.size(); ++i) {
      Body& body = world_.bodies[i];
      const Vec2 v{v_new[Column(i)], v_new[Column(i) + 1]};
      const double omega = v_new[Column(i) + 2];
      body.x = body.x + h * v;
      body.theta += h * omega;
      // v_new of a kinematic body is its mean velocity.
      body.v = body.fixed ? body.v + h * body.acceleration : v;
      body.omega = body.fixed ? body.omega + h * body.alpha : omega;
      if (!(IsFinite(body.x) && std::isfinite(body.theta) && IsFinite(body.v) && std::isfinite(body.omega))) {
        status_ = MotionStatus::kSolverFailed;
        detail_ = "the motion of body '" + body.name + "' is not finite";
      }
    }
  }

  // A step that would pass the end of a path is not made.
  // @param before  the bodies at its beginning
  void FollowJoints(std::vector<Body> before) {
    try {
      FollowPathJoints(world_.bodies, world_.joints);
    } catch (const PathEnd&) {
      world_.bodies = std::move(before);
      FollowPathJoints(world_.bodies, world_.joints);
      throw;
    }
  }

  void Step(double h) {
    SetLoads(world_.loads, world_.bodies);
    Eigen::VectorXd v_free = FreeVelocity(world_.bodies, h);
    const double range = kReach * 2 * h * LargestSpeed(v_free) + kContactGap * size_;
    std::vector<Constraint> found = finder_.Find(world_.bodies, range, TreatedDepth(MotionLevel::kVelocity, size_));
    const std::size_t count = found.size();
    ContactSystem system = InstantOf(world_, std::move(found));
    AssembledLcp lcp = AssembleStepLcp(system, h);
    NoteGaps(system, lcp.rows);
    std::vector<Constraint> contacts = WithoutGhosts(system, lcp.rows, options_.doubtful_depth * size_);
    if (contacts.size() < count) {
      system = InstantOf(world_, std::move(contacts));
      lcp = AssembleStepLcp(system, h);
    }
    if (options_.restitution > 0 && options_.impact_law == ImpactLaw::kPoisson &&
        ResolveImpacts(lcp.rows, h, &system)) {
      v_free = FreeVelocity(world_.bodies, h);
      lcp = AssembleStepLcp(system, h);
    }
    GuessImpulses(system, lcp.rows);

    const LcpResult result = Solve(system, lcp, v_free, h);
    impulses_ = result.f;
    MoveBodies(AfterImpulses(lcp.problem, result.f, v_free), h);
    if (status_ == MotionStatus::kMoving) FollowJoints(system.bodies);
    RequireAdvance(system.bodies, h, kContactGap * size_);
    time_ += h;
    ++statistics_.steps;
    EndIfUntreatable(h, TreatedDepth(MotionLevel::kVelocity, size_));
  }

  VelocityOptions options_;
  RowMatching matching_;
  double size_ = 1;
  Eigen::VectorXd impulses_;  // of the step before
  Eigen::VectorXd guess_;
};

}  // namespace

std::unique_ptr<Motion> MakeVelocityMotion(World world, const VelocityOptions& options, LcpSolver& solver) {
  return std::make_unique<VelocityMotion>(std::move(world), options, solver);
}

}  // namespace lcpbench
