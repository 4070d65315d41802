#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/peers/peer_library.h"

namespace lcpbench {

/// What a library of quadratic programs is given:
///     min 1/2 x.H x + g.x   subject to   lower <= C x <= upper,  x >= x_lower
///
/// Dual form: x = f, H = A, g = b, x_lower = 0 (joints: -infinity). Primal form: x = v, the change of velocity that the
/// forces make, of the columns of J that can move (inverse mass > 0); H = M, g = 0, C = J, lower = -b, upper = infinity
/// (joints: -b); f are the multipliers of C x >= lower, since M v = J^T f and w = J v + b = A f + b. Where A is given
/// and not its factors, A = P^T L D L^T P stands for J M^-1 J^T, factored on the clock.
struct QuadraticProgram {
  bool is_primal = false;
  bool bounds_are_rows = false;          ///< dual form: x_lower is -infinity, and C has a row for each bound
  Eigen::SparseMatrix<double> H, C;      ///< both triangles, column after column; empty where dense ones are wanted
  Eigen::MatrixXd dense_H;               ///< empty where sparse ones are wanted
  Eigen::MatrixXd dense_C;               ///< see dense_H
  Eigen::VectorXd g, lower, upper;       ///< of x, and of the rows of C
  Eigen::VectorXd x_lower;               ///< of x
  std::vector<unsigned char> bilateral;  ///< by row of the LCP

  Eigen::Index variables() const { return g.size(); }  ///< of x
  Eigen::Index rows() const { return lower.size(); }   ///< of C
};

/// A guess from which a library may start.
struct QpStart {
  Eigen::VectorXd x;        ///< of the variables
  Eigen::VectorXd y;        ///< multipliers of the rows of C, >= 0 where the lower bound holds it
  Eigen::VectorXd bound_y;  ///< of x >= x_lower
};

/// How an adapter wants its matrices.
struct QpLayout {
  bool dense = false;
  bool bounds_are_rows = false;  ///< for libraries that know no bounds of variables
};

/// An adapter of a library of quadratic programs: the keys NAME-dual and NAME-primal, with "-default" where the options
/// are the library's own.
class QpPeer : public LcpSolver {
 public:
  std::string WhyUnsupported(const LcpProblem& problem) const override;

 protected:
  QpPeer(std::string_view key, SettingsReader* reader);

  bool is_primal() const { return is_primal_; }
  /// Whether the key follows the tier; codes without a tolerance, and the library's own options, do not.
  bool has_tiers() const { return has_tiers_; }
  const PeerTier& tier() const { return tier_; }
  void set_layout(QpLayout layout) { layout_ = layout; }
  /// The library's call, timed by TimeLibraryCall: sets status, iterations, detail, and the answer by SetAnswer. What
  /// depends on b and the start (nullptr: none) are its own to write to; H and C stay for another b.
  virtual void Run(QuadraticProgram& qp, QpStart* start, const LcpOptions& options, const Deadline& deadline,
                   LcpResult* result) = 0;
  /// f is x in the dual form; in the primal form the multipliers of C x >= lower, which is `sign` times y.
  void SetAnswer(const QuadraticProgram& qp, const double* x, const double* y, double sign, LcpResult* result) const;
  /// "Infeasible" with a proof: a direction of x along which the dual form falls without end, or multipliers y that the
  /// primal form cannot meet.
  void SetRay(const QuadraticProgram& qp, const double* x, const double* y, double sign, LcpResult* result) const;

  void DoPrepare(const LcpProblem& problem) override;
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override;

 private:
  bool has_tiers_ = false;
  PeerTier tier_;
  bool is_primal_ = false;
  QpLayout layout_;
  QuadraticProgram prepared_;  // what depends on b is of the last solve
};

}  // namespace lcpbench
