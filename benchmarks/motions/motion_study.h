#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "benchmarks/motions/scene_source.h"

namespace lcpbench {

/// What drives a motion.
struct MotionDriver {
  std::string solver;               ///< registry key
  double tolerance = 0;             ///< 0: those of the study
  std::int64_t max_iterations = 0;  ///< LcpOptions::max_iterations of every solve; 0: the solver's own limit
  bool warm_start = true;           ///< at the velocity level, from the forces of the step before
};
/// From "KEY" and "KEY@PART@PART...": a PART below 1 is the tolerance, a whole number max_iterations, "cold" a start
/// from 0.
/// @throws InputError saying what was expected
MotionDriver ParseMotionDriver(const std::string& text);
std::string ToString(const MotionDriver& driver);  ///< reads back as the same driver, but for its tolerance

/// Every solver drives the same scenes: what its error does to the motion.
struct MotionStudy {
  std::vector<MovingScene> scenes;
  std::vector<MotionDriver> drivers;
  /// Each drives every scene, unless a driver has a tolerance of its own. Direct methods and drivers that stop after a
  /// number of iterations run once, with the least.
  std::vector<double> tolerances;
  int size = 0;  ///< rows at the start, as told to the scenes; for the files only
  std::uint64_t seed = 0;
  int steps = 0;  ///< of MovingScene::step each
  /// Wall clock of one motion; what takes longer is stopped, and said to be; thrice for the reference.
  double budget_s = 10;
};

/// Figures that were not measured.
inline constexpr double kNotMeasured = std::numeric_limits<double>::quiet_NaN();

/// The worst of a motion, or of a part of it.
struct WorstFigures {
  /// Largest |E - E_ref| at equal times over the scale: the largest kinetic energy of the reference motion, and at
  /// least what its loads give bodies at rest in one step.
  double energy_error = kNotMeasured;
  /// Largest |x - x_ref| of a centre of mass at equal times [m].
  double distance = kNotMeasured;
  double penetration = kNotMeasured;  ///< deepest of all contacts [m]
  double joint_error = kNotMeasured;  ///< largest [m]
  double rho = kNotMeasured;          ///< of all answers; infinite where one was not finite
  /// Largest gap in which a contact with friction bears force after a step [m]: h min(w_n, A_nn f_n).
  double lost_gap = kNotMeasured;

  void Note(const WorstFigures& other) {
    for (double WorstFigures::*of : {&WorstFigures::energy_error, &WorstFigures::distance, &WorstFigures::penetration,
                                     &WorstFigures::joint_error, &WorstFigures::rho, &WorstFigures::lost_gap}) {
      this->*of = std::fmax(this->*of, other.*of);
    }
  }
};

/// One scene driven by one solver at one tolerance, from the start to `time`. kNotMeasured where there was nothing to
/// measure: no step to the end, no step in common with the reference, no row of the kind.
struct MotionOutcome : WorstFigures {
  std::string scene;
  MotionLevel level = MotionLevel::kVelocity;
  MotionDriver driver;
  double tolerance = 0;
  int steps = 0;    ///< of MovingScene::step, done
  double time = 0;  ///< [s]
  /// E(end) - E(start) over the scale; physical impacts take energy, too.
  double energy_drift = kNotMeasured;
  /// Sum over the steps of the largest slip of a contact whose friction could have held it [m]:
  /// h min(|w_t|, A_tt (mu f_n - |f_t|)).
  double creep = kNotMeasured;
  /// Sum over the steps of f_t w_t where friction pushes the way that the contact slips, over the scale.
  double created = kNotMeasured;
  double solve_time_s = 0;  ///< inside the solver
  std::int64_t solves = 0;
  std::int64_t failed = 0;           ///< not claimed solved
  std::int64_t not_passed = 0;       ///< answers seen by the observer that Verify does not pass at `tolerance`
  std::int64_t false_successes = 0;  ///< of these, claimed solved
  std::string stopped;               ///< why the motion ended before its time; empty otherwise
};

/// Tolerance of the reference motion, which has the same scene, level and step and is driven by kDrivingSolver: so the
/// differences are the solver's and not those of the discretisation.
inline constexpr double kReferenceTolerance = 1e-12;

/// Runs the study and writes `folder`/motion.json, and motion.csv as it goes (RESULTS.md). Stops early, with what there
/// is, when an Interruption is requested.
/// @throws InputError for unknown solvers, impossible numbers, and a folder that cannot be written
std::vector<MotionOutcome> RunMotionStudy(const MotionStudy& study, const std::string& folder);

/// An aligned table, a block per scene, for reading; "-" for what was not measured.
std::string FormatMotionTable(const std::vector<MotionOutcome>& outcomes);

}  // namespace lcpbench
