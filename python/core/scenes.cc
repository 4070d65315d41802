#include "python/core/scenes.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>

#include <cmath>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/drawing/animation.h"
#include "benchmarks/drawing/picture.h"
#include "benchmarks/motions/scene_source.h"
#include "model/contact/assembly.h"
#include "model/contact/contact_row.h"
#include "model/scenes/scene.h"
#include "python/core/long_work.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench::python {
namespace {

/// What a scene's keyword arguments override.
struct Wishes {
  std::optional<double> friction = {};  ///< of every contact
  std::string level = {};               ///< "": the scene's own
  std::optional<double> step = {};      ///< [s]
};

struct Scene {
  MovingScene moving;    ///< what moves
  ContactSystem system;  ///< the instant
  AssembledLcp lcp;      ///< AssembleInstant(system, moving.step)

  bool is_time_step() const { return !lcp.problem.is_plain(); }
};

Scene Assembled(MovingScene moving, ContactSystem system) {
  AssembledLcp lcp = AssembleInstant(system, moving.step);
  return {std::move(moving), std::move(system), std::move(lcp)};
}

void Apply(const Wishes& wishes, MovingScene* moving) {
  if (!wishes.level.empty()) moving->level = MotionLevelFromString(wishes.level);
  if (wishes.step) {
    if (!(*wishes.step > 0 && std::isfinite(*wishes.step))) Refuse("step", "expected seconds > 0");
    moving->step = *wishes.step;
  }
  if (!wishes.friction) return;
  if (!(*wishes.friction >= 0 && *wishes.friction <= kMostFriction)) {
    Refuse("friction", "expected a number from 0 to 1e6");
  }
  SetFriction(*wishes.friction, moving);
}

Scene LoadByName(const std::string& name, int size, std::uint64_t seed, const Wishes& wishes) {
  if (size < 1) Refuse("size", "expected a number >= 1");
  MovingScene moving = LoadScene(name, size, seed);
  Apply(wishes, &moving);
  ContactSystem system = LoadInstant(name, size, seed, moving.level);
  if (wishes.friction) SetFriction(*wishes.friction, &system);
  return Assembled(std::move(moving), std::move(system));
}

Scene ReadText(const std::string& text, const Wishes& wishes) {
  MovingScene moving = ToMovingScene(ParseScene(text, "scene"));
  Apply(wishes, &moving);
  ContactSystem system = InstantWithContacts(moving.world, moving.level, kFoundGap);
  if (wishes.friction) SetFriction(*wishes.friction, &system);
  return Assembled(std::move(moving), std::move(system));
}

// Three numbers for every body.
std::vector<double> ReadBodies(nb::handle values, const char* name, std::size_t bodies) {
  const DenseMatrix read = ReadMatrix(values, name);
  if (read.rows != static_cast<Index>(bodies) || read.columns != 3) {
    Refuse(name, "expected three numbers for each of the " + std::to_string(bodies) + " bodies");
  }
  std::vector<double> numbers;
  for (Index i = 0; i < read.rows; ++i) {
    for (Index k = 0; k < 3; ++k) {
      numbers.push_back(read.data[read.by_columns ? k * read.rows + i : 3 * i + k]);
    }
  }
  return numbers;
}

void SetContactFriction(nb::handle friction, ContactSystem* system) {
  std::vector<Constraint*> contacts;
  for (Constraint& constraint : system->constraints) {
    if (constraint.type == ConstraintType::kContact) contacts.push_back(&constraint);
  }
  const auto mu =
      ReadVector<double>(friction, "friction", static_cast<Index>(contacts.size()), "the number of contacts");
  for (std::size_t k = 0; k < contacts.size(); ++k) contacts[k]->friction = mu.data[k];
}

// What then moves is this instant, under its forces.
Scene Replaced(const Scene& scene, nb::handle forces, nb::handle velocities, nb::handle friction) {
  ContactSystem system = scene.system;
  const auto set = [&](nb::handle values, const char* name, Vec2 Body::*linear, double Body::*angular) {
    if (values.is_none()) return;
    const std::vector<double> numbers = ReadBodies(values, name, system.bodies.size());
    for (std::size_t i = 0; i < system.bodies.size(); ++i) {
      system.bodies[i].*linear = {numbers[3 * i], numbers[3 * i + 1]};
      system.bodies[i].*angular = numbers[3 * i + 2];
    }
  };
  set(forces, "forces", &Body::force, &Body::torque);
  set(velocities, "velocities", &Body::v, &Body::omega);
  if (!friction.is_none()) SetContactFriction(friction, &system);
  MovingScene moving = scene.moving;
  return LeavableWithoutGil(false, [=]() mutable {
    moving.world = WorldOf(system);
    return Assembled(std::move(moving), std::move(system));
  });
}

// The model in Python's terms.

nb::tuple Pair(Vec2 p) { return nb::make_tuple(p.x, p.y); }

template <class Curve>
nb::dict DescribeCurve(const Curve& curve) {
  return std::visit(
      [](const auto& e) {
        nb::dict numbers;
        ForEachField(e, [&numbers](const char* name, const auto& value) {
          if constexpr (requires { value.x; }) {
            numbers[name] = Pair(value);
          } else if constexpr (requires { value[0].x; }) {
            nb::list points;
            for (const Vec2 p : value) points.append(Pair(p));
            numbers[name] = points;
          } else if constexpr (std::is_same_v<std::decay_t<decltype(value)>, Side>) {
            numbers[name] = value == Side::kConvex ? "convex" : "concave";
          } else {
            numbers[name] = value;
          }
        });
        nb::dict edge;
        edge["kind"] = e.kName;
        edge["numbers"] = numbers;
        return edge;
      },
      curve);
}

nb::list DescribeBodies(const Scene& scene) {
  nb::list bodies;
  for (const Body& body : scene.system.bodies) {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    nb::list edges;
    for (const OutlineEdge& piece : body.outline) {
      nb::dict edge = DescribeCurve(piece.edge);
      edge["s_begin"] = piece.s_begin;
      edge["s_end"] = piece.s_end;
      edges.append(edge);
    }
    nb::dict one;
    one["name"] = body.name;
    one["mass"] = body.mass;
    one["inertia"] = body.inertia;
    one["fixed"] = body.fixed;
    one["x"] = Pair(body.x);
    one["theta"] = body.theta;
    one["v"] = Pair(body.v);
    one["omega"] = body.omega;
    one["force"] = Pair(body.force);
    one["torque"] = body.torque;
    one["acceleration"] = Pair(body.acceleration);
    one["alpha"] = body.alpha;
    one["edges"] = edges;
    bodies.append(one);
  }
  return bodies;
}

// The terms of a contact that its geometry has besides (docs/model.md section 4).
void AddContactTerms(const Scene& scene, const Constraint& constraint, nb::dict* terms) {
  const std::vector<Body>& bodies = scene.system.bodies;
  const Body& body1 = bodies[static_cast<std::size_t>(constraint.body1)];
  const Body& body2 = bodies[static_cast<std::size_t>(constraint.body2)];
  const bool is_contact = constraint.type == ConstraintType::kContact;
  const ClosestPoints closest =
      FindClosestPoints(constraint, bodies, is_contact ? Regularity::kLocalMinimum : Regularity::kNonzeroD);
  const ContactRow row = ComputeContactRow(closest, body1, body2);
  const auto curvature = [](const CurvaturePair& pair) { return pair.is_vertex() ? nb::none() : nb::cast(pair.s); };
  nb::dict& of = *terms;
  of["kappa1"] = curvature(closest.curvature1);
  of["kappa2"] = curvature(closest.curvature2);
  of["D"] = closest.D();
  of["u"] = ComputeTangentRow(closest, body1, body2, row).slip;
  of["omega_n"] = row.omega_n;
}

nb::dict DescribeRow(const Scene& scene, std::size_t i) {
  const RowInfo& row = scene.lcp.rows[i];
  const Constraint& constraint = scene.system.constraints[static_cast<std::size_t>(row.constraint)];
  const Body& body1 = scene.system.bodies[static_cast<std::size_t>(constraint.body1)];
  const Body& body2 = scene.system.bodies[static_cast<std::size_t>(constraint.body2)];
  const bool is_tangent = row.axis == 't';
  nb::dict of;
  of["kind"] = is_tangent ? "tangent" : row.axis == 'r' ? "torque" : ToString(constraint.type);
  of["constraint"] = row.constraint;
  of["bilateral"] = row.bilateral;
  of["body1"] = constraint.body1;
  of["body2"] = constraint.body2;
  of["feature1"] = DescribeCurve(constraint.feature1);
  of["feature2"] = DescribeCurve(constraint.feature2);
  of["friction"] = constraint.friction;
  of["p1"] = Pair(row.p1);
  of["p2"] = Pair(row.p2);
  of["n"] = Pair(row.n);
  of["R1"] = Pair(row.p1 - body1.x);
  of["R2"] = Pair(row.p2 - body2.x);
  of["d"] = row.d;
  of["d_dot"] = row.d_dot;
  of["gamma"] = row.gamma;
  of["b"] = scene.lcp.problem.b()[static_cast<Index>(i)];
  const bool has_curvature =
      constraint.type == ConstraintType::kContact || constraint.type == ConstraintType::kPathJoint;
  if (has_curvature && !is_tangent) AddContactTerms(scene, constraint, &of);
  return of;
}

nb::list DescribeRows(const Scene& scene) {
  nb::list rows;
  for (std::size_t i = 0; i < scene.lcp.rows.size(); ++i) {
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    rows.append(DescribeRow(scene, i));
  }
  return rows;
}

// Pictures. Of time steps, impulses and velocities are shown as the forces and accelerations of their step.
std::string Draw(const Scene& scene, nb::handle f, nb::handle w, const std::string& caption) {
  const double unit = scene.is_time_step() ? scene.moving.step : 1;
  const bool has_forces = !f.is_none();
  Eigen::VectorXd forces, accelerations;
  if (has_forces) {
    forces = ReadEigen(f, "f") / unit;
    accelerations = ReadEigen(w, "w") / unit;
  }
  return LeavableWithoutGil(false, [=] {
    const PictureExtras extras{&scene.moving.world.loads, caption};
    return RenderSvg(scene.system, scene.lcp, has_forces ? &forces : nullptr, has_forces ? &accelerations : nullptr,
                     extras);
  });
}

// The page, and why the motion stopped before its time ("" where it did not).
std::pair<std::string, std::string> Animate(const Scene& scene, const std::string& key, double tolerance,
                                            const AnimationOptions& options) {
  RequireValid(options);
  return LeavableWithoutGil(false, [=]() -> std::pair<std::string, std::string> {
    LcpOptions lcp;
    lcp.tolerance = tolerance;
    lcp.time_limit_s = options.budget_s;
    const auto solver = MakeMotionSolver(scene.moving, key);
    const auto motion = StartMotion(scene.moving, lcp, *solver);
    Animation recorded = RecordAnimation(motion.get(), options);
    recorded.caption = key + ", " + std::string(ToString(scene.moving.level)) + " level";
    return {RenderAnimationPage(recorded), recorded.stopped};
  });
}

nb::list FamiliesOf(std::span<const SceneFamily> scenes, bool friction) {
  nb::list families;
  for (const SceneFamily& family : scenes) {
    nb::dict one;
    one["scene"] = std::string(family.key);
    one["title"] = std::string(family.title);
    one["friction"] = friction;
    one["purpose"] = std::string(family.purpose);
    families.append(one);
  }
  return families;
}

}  // namespace

void BindScenes(nb::module_& module) {
  nb::class_<Scene>(module, "Scene", "What lcpbench.generate makes a Scene of.")
      .def_prop_ro("name", [](const Scene& scene) { return scene.system.name; })
      .def_prop_ro("level", [](const Scene& scene) { return std::string(ToString(scene.moving.level)); })
      .def_prop_ro("step", [](const Scene& scene) { return scene.moving.step; })
      .def_prop_ro("is_time_step", &Scene::is_time_step)
      .def_prop_ro("problem", [](const Scene& scene) { return scene.lcp.problem; })
      .def("bodies", &DescribeBodies)
      .def("rows", &DescribeRows)
      .def("replace", &Replaced, nb::arg("forces") = nb::none(), nb::arg("velocities") = nb::none(),
           nb::arg("friction") = nb::none())
      .def("svg", &Draw, nb::arg("f") = nb::none(), nb::arg("w") = nb::none(), nb::arg("caption") = "")
      .def("file_text", [](const Scene& scene) { return FormatMovingScene(scene.moving); })
      .def(
          "animation",
          [](const Scene& scene, const std::string& solver, double duration, double fps, double tolerance,
             double budget) {
            return Animate(scene, solver, tolerance, {duration, fps, budget});
          },
          nb::arg("solver"), nb::arg("duration"), nb::arg("fps"), nb::arg("tolerance"), nb::arg("budget"));
  module.def(
      "load_scene",
      [](const std::string& name, int size, std::uint64_t seed, std::optional<double> friction,
         const std::string& level, std::optional<double> step) {
        return LeavableWithoutGil(false, [=] { return LoadByName(name, size, seed, {friction, level, step}); });
      },
      nb::arg("name"), nb::arg("size"), nb::arg("seed"), nb::arg("friction").none(), nb::arg("level"),
      nb::arg("step").none());
  module.def(
      "read_scene",
      [](const std::string& text, std::optional<double> friction, const std::string& level,
         std::optional<double> step) {
        return LeavableWithoutGil(false, [=] { return ReadText(text, {friction, level, step}); });
      },
      nb::arg("text"), nb::arg("friction").none(), nb::arg("level"), nb::arg("step").none());
  module.def("scene_families", [] {
    nb::list families = FamiliesOf(AllScenes(), false);
    families.extend(FamiliesOf(FrictionScenes(), true));
    return families;
  });
}

}  // namespace lcpbench::python
