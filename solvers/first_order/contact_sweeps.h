#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "solvers/lcp/problem.h"

/// Internal to solvers/.
namespace lcpbench {

/// Gauss-Seidel sweeps over problems with friction, sliding or bounded rows, a contact at a time: the pair of a normal
/// and its friction row is solved exactly [docs/friction.md section 5, "local solve"]; several friction rows of a
/// contact are projected one after the other, with the newest normal force. From factors matrix-free: forces act on
/// body velocities, O(nnz J) a sweep; else by the rows of A.
///
/// A sweep may cycle: there is no guarantee with friction. Its fixed points are solutions.
class ContactSweeps {
 public:
  /// O(nnz of the given form)
  void Prepare(const LcpProblem& problem);
  /// f = initial_f, or 0, brought within the laws: f_n >= 0, friction within its cone, bounds.
  /// @param problem  has the matrix and the laws of the one that was prepared
  void Start(const LcpProblem& problem, const Eigen::VectorXd* initial_f);
  /// One sweep; each contact or row goes `omega` times the way to its own solution.
  /// @return the squared norm of the changes of D^1/2 f
  double Sweep(double omega);
  /// n forces.
  void GetForces(Eigen::VectorXd* f) const;
  /// |D^-1/2 b|_2, which changes may be compared with.
  double load() const { return load_; }

 private:
  struct Pair {
    double normal = 0, tangent = 0;
  };
  // A row that is visited, with the friction rows that follow from it.
  struct Visit {
    Index row;
    RowKind kind;
    Index first_friction, last_friction;  // in friction_
    Index bounded = -1;                   // in the problem's bounded rows
  };
  struct Tangent {
    Index row;
    double mu;        // scaled: mu (D_t / D_n)^1/2
    double coupling;  // scaled A_nt
    int slip;
  };

  double Gap(Index row) const;
  void Move(Index row, double change);
  double VisitPlain(const Visit& visit, double omega);
  double VisitContact(const Visit& visit, double omega);
  double VisitPair(Index normal, const Tangent& tangent, double omega);
  double VisitSliding(Index normal, const Tangent& tangent, double omega);
  Pair SolvePair(Index normal, const Tangent& tangent, Pair rest) const;

  bool has_factors_ = false;
  std::vector<Index> start_;  // compressed rows of D^-1/2 J M^-1/2, or of D^-1/2 A D^-1/2
  std::vector<int> column_;
  std::vector<double> value_;
  std::vector<double> root_;      // D^1/2, 1 where A_ii = 0
  std::vector<double> diagonal_;  // scaled: 1, 0 where A_ii = 0
  std::vector<Visit> visits_;
  std::vector<Tangent> friction_;
  std::vector<double> lower_, upper_;                // scaled, of bounded rows
  std::vector<double> force_, load_of_row_, state_;  // D^1/2 f; D^-1/2 b; what rows act on: body velocities, or forces
  double load_ = 0;
};

}  // namespace lcpbench
