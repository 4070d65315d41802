#pragma once

#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "solvers/io/gzip_file.h"
#include "solvers/lcp/problem.h"

namespace lcpbench {

// Recordings: what an engine itself met in a scene of its own, step by step (docs/formats/recording.schema.json), and
// the problems that are made of it. The engine's own restitution, softness and position correction are left out: w is
// what rigid contact demands, frictionless or with Coulomb's law.

/// What all steps have in common. World axes, SI units or the engine's own.
struct RecordingHeader {
  std::string engine;
  std::string engine_version;
  std::string licence;  ///< SPDX name, of the scene's data
  std::string scene;
  std::string source;  ///< where the scene comes from, and what was left out
  int dimension = 2;   ///< 2 or 3
  double time_step = 0;
  struct Body {
    double inverse_mass = 0;
    std::array<double, 3> inverse_inertia = {0, 0, 0};  ///< about the principal axes; in the plane the last one
  };
  std::vector<Body> bodies;
};

/// Whether the body can move at all; -1, the world, cannot.
bool CanMove(const RecordingHeader& header, int body);

/// The state before the engine's velocity solve. Vectors have three numbers; in the plane spins and torques are the
/// third.
struct RecordedStep {
  using Vector = std::array<double, 3>;
  int number = 0;
  struct Body {
    Vector x, v, omega, force, torque;
    double angle = 0;                           ///< in the plane [rad]
    std::array<double, 4> turn = {1, 0, 0, 0};  ///< in space: principal axes to world, a quaternion w, x, y, z
  };
  struct Contact {
    int first = -1, second = -1;  ///< bodies, -1: the world
    Vector point, normal;         ///< the unit normal points from the first to the second body
    double gap = 0;
    double friction = 0;
    std::string identity;
    std::array<std::string, 2> shape;
    std::array<double, 2> radius = {0, 0};  ///< of curvature, < 0 concave; 0 where the surface is not round
  };
  struct JointRow {
    int first = -1, second = -1;
    std::vector<double> J;  ///< 6 or 12: linear and angular of the first, of the second body
    bool is_limit = false;  ///< unilateral
    std::string identity;
  };
  std::vector<Body> bodies;
  std::vector<Contact> contacts;
  std::vector<JointRow> joint_rows;
};

/// @param where  "file:line"
/// @throws InputError naming where, the JSON path, what was expected and what was found
RecordingHeader ParseRecordingHeader(std::string_view line, const std::string& where);
RecordedStep ParseRecordedStep(std::string_view line, const RecordingHeader& header, const std::string& where);

/// A problem, and what each of its rows is called from step to step.
struct RecordedProblem {
  LcpProblem problem;
  std::vector<std::string> identity;
};

/// "<engine>-<scene>-step<k>".
std::string RecordedId(const RecordingHeader& header, const RecordedStep& step);

/// What is made of a step: VelocityProblem, AccelerationProblem, or VelocityProblem with friction.
enum class RecordedLevel { kVelocity, kAcceleration, kFriction };
/// By name, in manifests and options.
inline constexpr std::initializer_list<std::pair<const char*, RecordedLevel>> kRecordedLevels = {
    {"velocity", RecordedLevel::kVelocity},
    {"acceleration", RecordedLevel::kAcceleration},
    {"friction", RecordedLevel::kFriction}};

/// The velocity step of time h without softness, contacts first, then rows of joints:
///     w = J v^+ + max(gap, 0) / h  (contacts),   J v^+  (joints),   v^+ = v + h M^-1 F + M^-1 J^T f
/// so b = J (v + h M^-1 F) + max(gap, 0) / h, f are impulses and w speeds, a contact's row being the speed at which its
/// bodies part. Columns: the bodies that can move and that a row touches; three in the plane, six in space, there with
/// angular parts in principal axes. Rows that touch no body that can move are left out.
/// @param with_friction  a contact with mu > 0 has friction rows after its own: its tangent, or in space two that are
///                       perpendicular to each other, w = J v^+ being the slip of the second body (docs/friction.md)
/// O(rows)
RecordedProblem VelocityProblem(const RecordingHeader& header, const RecordedStep& step, bool with_friction = false);

/// The acceleration-level problem by our own assembly (AssembleContactLcp), so that curvature enters b, where all of a
/// step's contacts are between circles, or a circle and something flat, and there are no joints; in the plane.
/// nullopt: another step.
/// @throws InputError as AssembleContactLcp
std::optional<RecordedProblem> AccelerationProblem(const RecordingHeader& header, const RecordedStep& step);

/// One of these; at the velocity level there always is one, which may have no row.
std::optional<RecordedProblem> MakeRecorded(const RecordingHeader& header, const RecordedStep& step,
                                            RecordedLevel level);

/// A recording, read step by step.
class RecordingReader {
 public:
  /// @param path  plain or gzip
  /// @throws InputError where it cannot be opened or its first line is not a header
  explicit RecordingReader(const std::string& path);

  const std::string& path() const { return lines_.name(); }
  const RecordingHeader& header() const { return header_; }
  /// The next step; false at the end. @throws InputError as ParseRecordedStep
  bool Next(RecordedStep* step);

 private:
  LineReader lines_;
  RecordingHeader header_;
};

/// The problem's islands of at least `least_rows` rows, in order of their first rows: "<id>-island<k>", k from 1 among
/// all islands.
std::vector<RecordedProblem> IslandsOf(const RecordedProblem& whole, Index least_rows);

}  // namespace lcpbench
