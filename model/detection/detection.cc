#include "model/detection/detection.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "model/detection/narrow_phase.h"
#include "model/geometry/broad_phase.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

bool IsExcluded(const DetectionOptions& options, int i, int j) {
  return std::binary_search(options.excluded.begin(), options.excluded.end(), std::pair(i, j));
}

void RequireValid(const DetectionOptions& options) {
  if (!(std::isfinite(options.tolerance) && options.tolerance > 0)) {
    throw InputError("contact detection: the tolerance must be finite and > 0");
  }
  if (!(std::isfinite(options.penetration) && options.penetration >= 0)) {
    throw InputError("contact detection: the penetration must be finite and >= 0");
  }
}

void RequireValid(const Body& body, const Outline& outline) {
  if (!IsFinite(body.x) || !std::isfinite(body.theta)) {
    throw InputError("contact detection: body '" + body.name + "' has a position that is not finite");
  }
  for (std::size_t loop = 0; loop < outline.loops.size(); ++loop) {
    for (std::size_t piece = 0; piece < outline.loops[loop].size(); ++piece) {
      const OutlinePiece& checked = outline.loops[loop][piece];
      // The name of a sound piece is not put together.
      if (!WhyInvalid(checked).empty()) {
        RequireValidPiece(checked, "body '" + body.name + "', " + PieceName(outline, loop, piece));
      }
    }
  }
}

}  // namespace

std::vector<Constraint> DetectContacts(std::span<const Body> bodies, std::span<const Outline> outlines,
                                       const DetectionOptions& options) {
  RequireValid(options);
  if (bodies.size() != outlines.size()) {
    throw InputError("contact detection: " + std::to_string(bodies.size()) + " bodies but " +
                     std::to_string(outlines.size()) + " outlines");
  }
  const GapRange range{options.tolerance, options.penetration};
  const double reach = std::max(range.gap, range.penetration);
  const StopCheck check = options.check != nullptr ? *options.check : [] {};
  std::vector<PlacedOutline> placed(bodies.size());
  std::vector<int> with_outline;
  std::vector<BoundingBox> boxes;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (outlines[i].loops.empty()) continue;
    check();
    RequireValid(bodies[i], outlines[i]);
    placed[i] = PlaceOutline(outlines[i], bodies[i].x, bodies[i].theta);
    with_outline.push_back(static_cast<int>(i));
    boxes.push_back(Inflated(placed[i].whole, placed[i].x, reach));
  }

  std::vector<Constraint> contacts;
  for (const auto& pair : FindOverlappingPairs(boxes)) {
    const int i = with_outline[static_cast<std::size_t>(pair.first)];
    const int j = with_outline[static_cast<std::size_t>(pair.second)];
    const Body& body1 = bodies[static_cast<std::size_t>(i)];
    const Body& body2 = bodies[static_cast<std::size_t>(j)];
    const PlacedOutline& placed1 = placed[static_cast<std::size_t>(i)];
    const PlacedOutline& placed2 = placed[static_cast<std::size_t>(j)];
    if ((body1.fixed && body2.fixed) || IsExcluded(options, i, j)) continue;
    check();
    std::vector<GapMinimum> minima;
    try {
      minima = FindGapMinima(placed1, placed2, range, check);
    } catch (const InputError& error) {
      throw InputError("contact of body 1 '" + body1.name + "' and body 2 '" + body2.name + "': " + error.what());
    }
    for (const GapMinimum& minimum : minima) {
      contacts.push_back({.body1 = i,
                          .body2 = j,
                          .feature1 = placed1.spans[static_cast<std::size_t>(minimum.span1)].feature,
                          .feature2 = placed2.spans[static_cast<std::size_t>(minimum.span2)].feature,
                          .s1 = minimum.s1,
                          .s2 = minimum.s2,
                          .nominal_gap = minimum.closest.d});
    }
  }
  return contacts;
}

Outline OutlineOf(const Body& body) {
  constexpr double kJoined = 1e-9;
  Outline outline{body.name, {}};
  Vec2 end;
  for (const OutlineEdge& edge : body.outline) {
    const Vec2 begin = CurvePoint(edge.edge, edge.s_begin);
    const bool joins = !outline.loops.empty() && Norm(begin - end) <= kJoined * Reach(edge);
    if (!joins) outline.loops.emplace_back();
    outline.loops.back().push_back(edge);
    end = CurvePoint(edge.edge, edge.s_end);
  }
  return outline;
}

}  // namespace lcpbench
