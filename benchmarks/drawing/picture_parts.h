#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "benchmarks/drawing/picture_layout.h"
#include "model/contact/assembly.h"
#include "model/contact/loads.h"
#include "model/contact/system.h"

namespace lcpbench {

/// What a row is drawn as: grey disc where nothing is solved, filled disc, open diamond, open disc, the joint's symbol.
enum class RowKind { kPlain, kActive, kOpen, kDegenerate, kJoint };
inline constexpr std::array kRowKinds{RowKind::kPlain, RowKind::kActive, RowKind::kOpen, RowKind::kDegenerate,
                                      RowKind::kJoint};

/// Everything that the parts of a picture are drawn from. Sizes in pixels.
struct Picture {
  Picture(const ContactSystem& drawn, const AssembledLcp& assembled, const Eigen::VectorXd* forces,
          const Eigen::VectorXd* accelerations, const Loads* drawn_loads);

  const ContactSystem& system;
  const AssembledLcp& lcp;
  const Eigen::VectorXd* f;
  const Loads* loads;
  Layout layout;
  std::string id;  ///< prefix of all identifiers
  std::vector<RowKind> kinds;
  double line = 1;         ///< stroke width of edges
  double mark = 3;         ///< radius of a contact's mark
  double arrow = 1;        ///< stroke width of forces
  double hatch = 9;        ///< depth of the hatching of unbounded bodies
  double connector = 4;    ///< half width of springs, dampers and of rods' ends
  double arrow_scale = 0;  ///< [px/N]; 0 without forces

 private:
  void Classify(const Eigen::VectorXd* w);
};

/// A fixed body that moves, or begins to, as prescribed.
bool IsDriven(const Body& body);

// Each appends its elements to `out`, in the coordinates of Layout::ToPage.

/// Patterns that bodies are filled with.
void AppendPatterns(const Picture& picture, std::string* out);
/// Fixed bodies below movable ones.
void AppendBodies(const Picture& picture, std::string* out);
/// Joints, rods, ropes, springs, dampers.
void AppendConnectors(const Picture& picture, std::string* out);
/// Symbols that AppendRows uses.
void AppendMarks(const Picture& picture, std::string* out);
/// Normals, forces with their values, and marks of the contacts.
void AppendRows(const Picture& picture, std::string* out);

/// The legend, laid out from `top` downwards; returns its height.
double AppendLegend(const Picture& picture, double top, std::string* out);

// Symbols, at page points, shared with the legend.

void AppendArrow(Vec2 from, Vec2 to, double width, std::string_view color, std::string* out);
std::string MarkShape(RowKind kind, double radius);
/// Along from-to; `half` is half the symbol's width.
std::string SpringShape(Vec2 from, Vec2 to, double half);
std::string DamperShape(Vec2 from, Vec2 to, double half);
std::string RodShape(Vec2 from, Vec2 to, double half);
std::string RopeShape(Vec2 from, Vec2 to, double length, double half);
std::string PinShape(Vec2 at, double radius);
std::string SliderShape(Vec2 at, Vec2 normal, double radius);

}  // namespace lcpbench
