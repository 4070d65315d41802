#pragma once

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

namespace lcpbench::recorders {

/// Writes a recording (docs/formats/recording.schema.json) to standard output: an engine's own scene, step by step.
/// A recorder is one program, one file: it knows its engine and nothing of ours but this header. RunRecorder writes the
/// header once, then for every recorded step the state before the velocity solve and the contacts that the engine made
/// there. Numbers are rounded to nine significant digits, so that files stay small; the problem is made of what the
/// file says.

using Json = nlohmann::ordered_json;

/// Nine significant digits; an infinity or NaN ends the recorder, as no problem can be made of it.
inline double Rounded(double value) {
  if (!std::isfinite(value)) {
    std::fprintf(stderr, "recorder: a number is not finite\n");
    std::exit(1);
  }
  char text[32];
  std::snprintf(text, sizeof text, "%.9g", value);
  const double rounded = std::strtod(text, nullptr);
  return rounded == 0 ? 0 : rounded;
}

template <class Range>
Json Numbers(const Range& values) {
  Json list = Json::array();
  for (const double value : values) list.push_back(Rounded(value));
  return list;
}
inline Json Numbers(std::initializer_list<double> values) { return Numbers<std::initializer_list<double>>(values); }

/// A vector of any engine, by its functions x(), y() and z().
Json Vector(const auto& v) { return Numbers({v.x(), v.y(), v.z()}); }
Json Quaternion(const auto& q) { return Numbers({q.w(), q.x(), q.y(), q.z()}); }

/// A row of a joint: w = J v of two bodies, 3 + 3 numbers in the plane, 6 + 6 in space (linear, angular; world axes).
struct JointRow {
  std::vector<double> J;
  double error = 0;       ///< [m] or [rad]
  bool is_limit = false;  ///< unilateral: w >= 0
};

/// A body of the header. Both are 0 for a body that cannot move.
inline Json BodyOf(double inverse_mass, Json inverse_inertia) {
  return {{"inverse_mass", Rounded(inverse_mass)}, {"inverse_inertia", std::move(inverse_inertia)}};
}

class Step {
 public:
  explicit Step(int number) {
    line_["step"] = number;
    line_["bodies"] = {{"x", Json::array()},     {"q", Json::array()},     {"v", Json::array()},
                       {"omega", Json::array()}, {"force", Json::array()}, {"torque", Json::array()}};
    line_["contacts"] = Json::array();
    line_["joints"] = Json::array();
  }

  /// In the order of the header. Angles, angular velocities and torques in the plane: numbers, in space: lists.
  void Body(Json x, Json q, Json v, Json omega, Json force, Json torque) {
    Json& bodies = line_["bodies"];
    bodies["x"].push_back(std::move(x));
    bodies["q"].push_back(std::move(q));
    bodies["v"].push_back(std::move(v));
    bodies["omega"].push_back(std::move(omega));
    bodies["force"].push_back(std::move(force));
    bodies["torque"].push_back(std::move(torque));
  }

  /// @param i, j  bodies of the header, -1: the world
  /// @param n  unit normal from i to j
  /// @param gap  negative where they overlap
  /// @param radius  of curvature, 0 where the surface is no circle and no sphere
  void Contact(int i, int j, Json p, Json n, double gap, double mu, std::string id,
               const std::array<std::string, 2>& shape, const std::array<double, 2>& radius) {
    Json radii = Json::array();
    for (const double r : radius) radii.push_back(r == 0 ? Json(nullptr) : Json(Rounded(r)));
    line_["contacts"].push_back({{"b", {i, j}},
                                 {"p", std::move(p)},
                                 {"n", std::move(n)},
                                 {"gap", Rounded(gap)},
                                 {"mu", Rounded(mu)},
                                 {"id", std::move(id)},
                                 {"shape", shape},
                                 {"radius", std::move(radii)}});
  }

  /// Nothing where there are no rows. What the rows have of the world is set to 0.
  /// @param number  of the joint in its world
  void Joint(int i, int j, const std::string& kind, std::size_t number, std::vector<JointRow> rows) {
    if (rows.empty()) return;
    Json joint = {{"b", {i, j}}, {"kind", kind}, {"id", "j" + std::to_string(number)}, {"rows", Json::array()}};
    for (JointRow& row : rows) {
      const auto middle = row.J.begin() + static_cast<std::ptrdiff_t>(row.J.size() / 2);
      if (i < 0) std::fill(row.J.begin(), middle, 0.0);
      if (j < 0) std::fill(middle, row.J.end(), 0.0);
      Json written = {{"J", Numbers(row.J)}, {"error", Rounded(row.error)}};
      if (row.is_limit) written["limit"] = true;
      joint["rows"].push_back(std::move(written));
    }
    line_["joints"].push_back(std::move(joint));
  }

  void Write() const { std::puts(line_.dump().c_str()); }

 private:
  Json line_;
};

/// Random numbers of our own, the same everywhere, for scenes that engines' demos draw at random.
class Uniform {
 public:
  double operator()(double low, double high) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return low + (high - low) * static_cast<double>(state_ >> 11U) / 9007199254740992.0;
  }

 private:
  std::uint64_t state_ = 24;
};

/// What a recorder is asked for: `steps` recorded steps of a scene, from step `first` on, `every` steps apart. Steps
/// are counted from 0, the first one that the engine makes.
struct Request {
  std::string scene;
  int first = 0, steps = 1, every = 1;
  int last() const { return first + (steps - 1) * every; }
  bool includes(int step) const { return step >= first && (step - first) % every == 0; }
};

/// Reads `recorder-ENGINE SCENE [--first STEP] [--steps N] [--every K]`; `--list` lists the scenes. Ends the program
/// where that is not what it is given.
inline Request ReadCommandLine(int argc, char** argv, const std::vector<std::string>& scenes) {
  Request request;
  CLI::App app("Records steps of a scene", argv[0]);
  const auto list = [&scenes](std::int64_t) {
    for (const std::string& scene : scenes) std::puts(scene.c_str());
    std::exit(0);
  };
  app.add_option("scene", request.scene, "Which one")->required()->check(CLI::IsMember(scenes));
  app.add_flag_function("--list", list, "Name all scenes")->trigger_on_parse();
  app.add_option("--first", request.first, "The first recorded step, from 0")->check(CLI::Range(0, 1000000));
  app.add_option("--steps", request.steps, "How many are recorded")->check(CLI::Range(1, 1000000));
  app.add_option("--every", request.every, "How far they are apart")->check(CLI::Range(1, 1000000));
  try {
    app.parse(argc, argv);
  } catch (const CLI::CallForHelp&) {
    std::exit(app.exit(CLI::CallForHelp()));
  } catch (const CLI::ParseError& error) {
    std::fprintf(stderr, "%s: %s\n", argv[0], error.what());
    std::exit(2);
  }
  return request;
}

/// The engine's numbers of kinds in words.
inline std::string NameOf(int kind, std::initializer_list<std::pair<int, const char*>> names, const char* other) {
  for (const auto& [number, name] : names) {
    if (number == kind) return name;
  }
  return other;
}

/// A number of a body, -1 for the world.
template <class Map, class Key>
int IndexOf(const Map& indices, const Key& key) {
  const auto found = indices.find(key);
  return found == indices.end() ? -1 : found->second;
}

/// A contact's name from step to step: its number within a pair of shapes or bodies.
inline std::string ContactId(int first, int second, auto number) {
  return std::to_string(first) + ":" + std::to_string(second) + ":" + std::to_string(number);
}

/// A scene that a recorder builds.
template <class Scene>
struct SceneEntry {
  const char* name;
  const char* file;     ///< of the engine's source
  const char* changes;  ///< what differs from it
  void (*build)(Scene&);
};

/// What every recording of an engine says of itself.
struct Engine {
  std::string name, version, licence;
  std::string folder;    ///< of the scenes' files
  std::string rebuilt;   ///< whose source it is, and what steps the scene
  std::string left_out;  ///< of what the engine does
  int dimension;
};

/// The program: builds the scene that the command line asks for, steps it, and writes the header and the steps.
///
/// Stage holds the engine's world. It is a Scene and has
///   void Advance(int number, Step* step)  a step of the engine; fills `step` in it, unless that is null
///   Json Gravity() const, double TimeStep() const
///   Json Bodies() const                   BodyOf each; asked after the first recorded step
template <class Stage, class Scene, std::size_t count>
int RunRecorder(int argc, char** argv, const Engine& engine, const SceneEntry<Scene> (&scenes)[count]) {
  std::vector<std::string> names;
  for (const auto& scene : scenes) names.emplace_back(scene.name);
  const Request request = ReadCommandLine(argc, argv, names);
  const SceneEntry<Scene>& scene =
      *std::find_if(scenes, scenes + count, [&](const auto& one) { return one.name == request.scene; });
  Stage stage;
  scene.build(stage);
  for (int number = 0; number <= request.last(); ++number) {
    Step step(number);
    stage.Advance(number, request.includes(number) ? &step : nullptr);
    if (!request.includes(number)) continue;
    if (number == request.first) {
      const std::string source = engine.folder + scene.file + engine.rebuilt + (*scene.changes == '\0' ? "" : "; ") +
                                 scene.changes + "; left out: " + engine.left_out;
      const Json header = {
          {"lcpbench_recording", 1},       {"engine", engine.name},      {"engine_version", engine.version},
          {"licence", engine.licence},     {"scene", scene.name},        {"source", source},
          {"dimension", engine.dimension}, {"gravity", stage.Gravity()}, {"time_step", Rounded(stage.TimeStep())},
          {"bodies", stage.Bodies()}};
      std::puts(header.dump().c_str());
    }
    step.Write();
  }
  return 0;
}

}  // namespace lcpbench::recorders
