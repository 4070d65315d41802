#include "model/shape/outline.h"

#include <cmath>

#include "support/input_error.h"

namespace lcpbench {
namespace {

// The vertex where a piece begins: the end of the piece before if that has smaller numbers, hence smaller rounding
// errors. So a nearly straight arc, whose radius is huge, does not spoil the corners of the rest.
Vec2 VertexBetween(const OutlinePiece& before, const OutlinePiece& piece) {
  return Reach(before) < Reach(piece) ? CurvePoint(before.edge, before.s_end) : CurvePoint(piece.edge, piece.s_begin);
}

std::vector<Segment> SegmentsOf(const OutlineLoop& loop) {
  std::vector<Segment> segments;
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const OutlinePiece& piece = loop[k];
    const Vec2 begin = VertexBetween(loop[(k + loop.size() - 1) % loop.size()], piece);
    std::visit([&](const auto& e) { e.AppendMoments(piece.s_begin, piece.s_end, begin, &segments); }, piece.edge);
  }
  return segments;
}

// The triangle (base, p, q), p and q from the base.
AreaMoments TriangleMoments(Vec2 p, Vec2 q) {
  AreaMoments m;
  m.area = Cross(p, q) / 2;
  m.first = (m.area / 3) * (p + q);
  m.xx = m.area / 6 * (p.x * p.x + p.x * q.x + q.x * q.x);
  m.yy = m.area / 6 * (p.y * p.y + p.y * q.y + q.y * q.y);
  m.xy = m.area / 12 * (2 * p.x * p.y + p.x * q.y + q.x * p.y + 2 * q.x * q.y);
  return m;
}

AreaMoments Sum(const std::vector<Segment>& segments, Vec2 base) {
  AreaMoments sum;
  for (std::size_t k = 0; k < segments.size(); ++k) {
    const Segment& segment = segments[k];
    const Vec2 begin = segment.begin - base;
    const Vec2 end = segments[(k + 1) % segments.size()].begin - base;
    const Vec2 moments_base = segment.base == Segment::Base::kBegin ? begin : begin + 0.5 * (end - begin);
    sum = sum + TriangleMoments(begin, end) + Moved(segment.moments, moments_base);
  }
  return sum;
}

using OutlineSegments = std::vector<std::vector<Segment>>;

AreaMoments Sum(const OutlineSegments& loops, Vec2 base) {
  AreaMoments sum;
  for (const auto& segments : loops) sum = sum + Sum(segments, base);
  return sum;
}

}  // namespace

Outline Transformed(const Outline& outline, double angle, Vec2 shift) {
  Outline moved = outline;
  for (OutlineLoop& loop : moved.loops) {
    for (OutlinePiece& piece : loop) piece = Transformed(piece, angle, shift);
  }
  return moved;
}

std::vector<OutlinePiece> AllPieces(const Outline& outline) {
  std::vector<OutlinePiece> pieces;
  for (const OutlineLoop& loop : outline.loops) pieces.insert(pieces.end(), loop.begin(), loop.end());
  return pieces;
}

std::string LoopName(const Outline& outline, std::size_t loop) {
  return "outline '" + outline.name + "', " + (loop == 0 ? "outer boundary" : "hole " + std::to_string(loop));
}

std::string PieceName(const Outline& outline, std::size_t loop, std::size_t piece) {
  return LoopName(outline, loop) + ", edge " + std::to_string(piece);
}

AreaMoments LoopMoments(const OutlineLoop& loop, Vec2 base) { return Sum(SegmentsOf(loop), base); }

MassProperties ComputeMassProperties(const Outline& outline, double density) {
  if (!(density > 0) || !std::isfinite(density)) {
    throw InputError("outline '" + outline.name + "': the density must be finite and > 0");
  }
  OutlineSegments loops;
  for (const OutlineLoop& loop : outline.loops) loops.push_back(SegmentsOf(loop));
  if (loops.empty() || loops[0].empty()) throw InputError("outline '" + outline.name + "' has no edges");
  // Three passes: about any point of the boundary, then about the centre found so, where nothing cancels.
  MassProperties result;
  result.center = loops[0][0].begin;
  AreaMoments& moments = result.moments;
  constexpr int kPasses = 3;
  for (int pass = 0; pass < kPasses; ++pass) {
    moments = Sum(loops, result.center);
    result.area = moments.area;
    if (!(result.area > 0)) break;
    const Vec2 offset = (1 / moments.area) * moments.first;
    if (pass + 1 < kPasses) result.center = result.center + offset;
  }
  result.mass = density * moments.area;
  result.inertia = density * moments.polar();
  if (!(result.area > 0 && result.inertia > 0 && result.mass > 0) || !std::isfinite(result.mass) ||
      !std::isfinite(result.inertia) || !IsFinite(result.center)) {
    throw InputError("outline '" + outline.name + "': mass and inertia are not positive and finite");
  }
  return result;
}

}  // namespace lcpbench
