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

// What the broad phase compares: all spans of a body, or one of a body that has many.
struct Block {
  int body = 0;
  SpanRange spans;
};

void AppendBlocks(int body, const PlacedOutline& placed, double margin, std::vector<Block>* blocks,
                  std::vector<BoundingBox>* boxes) {
  const int count = static_cast<int>(placed.spans.size());
  const int step = count > kManySpans ? 1 : count;
  for (int first = 0; first < count; first += step) {
    BoundingBox all = placed.boxes[static_cast<std::size_t>(first)];
    for (int k = first + 1; k < first + step; ++k) all = Union(all, placed.boxes[static_cast<std::size_t>(k)]);
    blocks->push_back({body, {first, step}});
    boxes->push_back(Inflated(all, placed.x, margin));
  }
}

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
      RequireValidPiece(outline.loops[loop][piece], "body '" + body.name + "', " + PieceName(outline, loop, piece));
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
  std::vector<PlacedOutline> placed(bodies.size());
  std::vector<Block> blocks;
  std::vector<BoundingBox> boxes;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (outlines[i].loops.empty()) continue;
    RequireValid(bodies[i], outlines[i]);
    placed[i] = PlaceOutline(outlines[i], bodies[i].x, bodies[i].theta);
    AppendBlocks(static_cast<int>(i), placed[i], reach, &blocks, &boxes);
  }

  // Blocks are in body order, and so are their pairs; a pair of bodies with several blocks comes in several runs.
  std::vector<std::pair<int, int>> pairs = FindOverlappingPairs(boxes);
  const auto block = [&](int index) -> const Block& { return blocks[static_cast<std::size_t>(index)]; };
  const auto bodies_of = [&](const std::pair<int, int>& pair) {
    return std::pair(block(pair.first).body, block(pair.second).body);
  };
  std::stable_sort(pairs.begin(), pairs.end(),
                   [&](const auto& p, const auto& q) { return bodies_of(p) < bodies_of(q); });

  std::vector<Constraint> contacts;
  std::vector<GapMinimum> minima;
  for (std::size_t k = 0; k < pairs.size();) {
    const auto [i, j] = bodies_of(pairs[k]);
    const Body& body1 = bodies[static_cast<std::size_t>(i)];
    const Body& body2 = bodies[static_cast<std::size_t>(j)];
    const PlacedOutline& placed1 = placed[static_cast<std::size_t>(i)];
    const PlacedOutline& placed2 = placed[static_cast<std::size_t>(j)];
    const bool skip = i == j || (body1.fixed && body2.fixed) || IsExcluded(options, i, j);
    minima.clear();
    try {
      for (; k < pairs.size() && bodies_of(pairs[k]) == std::pair(i, j); ++k) {
        if (skip) continue;
        FindGapMinima(placed1, block(pairs[k].first).spans, placed2, block(pairs[k].second).spans, range, &minima);
      }
    } catch (const InputError& error) {
      throw InputError("contact of body 1 '" + body1.name + "' and body 2 '" + body2.name + "': " + error.what());
    }
    RemoveRepeated(placed1, placed2, &minima);
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
