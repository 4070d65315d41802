#pragma once

#include <Eigen/Core>
#include <vector>

#include "solvers/first_order/contact_sweeps.h"
#include "solvers/friction/friction_answer.h"
#include "solvers/friction/mode_factor.h"

/// Internal to solvers/.
namespace lcpbench {

/// The method of mode-newton by itself, see mode_newton.h.
class ModeSteps {
 public:
  static constexpr Index kFewRows = 12;    ///< of a problem whose modes may be tried one by one
  static constexpr int kMostSteps = 2000;  ///< of any method
  /// How far a run goes.
  struct Limits {
    int steps = 200;
    double eps = 1e-6;  ///< at first
    int sweeps = 0;     ///< where a step fails; 0: eps grows instead, and eight times ends the run
  };
  /// Forgets the matrix: the next run may be for another problem.
  void Reset() { sweeps_are_ready_ = false; }
  /// For problems of up to so many rows, all but Sweep.
  void Reserve(Index max_rows);
  /// options.initial_f, and up to so many steps from there. True where an answer passes.
  bool Warm(const ContactRows& rows, int steps, FrictionAnswer* answer);
  /// Up to `steps` steps of full length from *phi, which find most small problems; contacts without a load stick at
  /// first. True where an answer passes.
  bool TakeFullSteps(const ContactRows& rows, int steps, PaddedVector* phi, FrictionAnswer* answer);
  /// The modes of few contacts, all of them one by one. True where an answer passes.  O(4^contacts m^3)
  bool TryAll(const ContactRows& rows, FrictionAnswer* answer);
  /// True where an answer passes. *phi: where to start from; the last iterate afterwards.
  bool TakeDampedSteps(const ContactRows& rows, const Limits& limits, PaddedVector* phi, FrictionAnswer* answer);
  /// Solves the modes of *phi with a vanishing eps, a few times. True where an answer passes.
  bool Polish(const ContactRows& rows, const PaddedVector& phi, FrictionAnswer* answer);
  /// Up to `count` sweeps from *phi. True where an answer passes.
  bool Sweep(const ContactRows& rows, int count, PaddedVector* phi, FrictionAnswer* answer);

 private:
  bool TakeLastStep(const ContactRows& rows, const PaddedVector& phi, FrictionAnswer* answer);
  bool TryModes(const ContactRows& rows, const PaddedVector& center, double eps, FrictionAnswer* answer);
  void CloseUnloaded(const ContactRows& rows);
  void SetTrial(Index n, double t, const PaddedVector& phi);
  bool TryStep(const ContactRows& rows, double rho, PaddedVector* phi, double* next);

  ModeFactor factor_;
  ContactSweeps sweeps_;
  bool sweeps_are_ready_ = false;
  std::vector<RangeSide> sides_, tried_;
  PaddedVector gaps_, next_, trial_, center_, start_, f_;
};

}  // namespace lcpbench
