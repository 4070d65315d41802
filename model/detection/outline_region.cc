#include "model/detection/outline_region.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "model/contact/path.h"

namespace lcpbench {
namespace {

// An edge is halved so many times at most.
constexpr int kMostHalvings = 12;

Vec2 NormalAt(const OutlinePiece& piece, double s) {
  const double sense = piece.s_begin < piece.s_end ? 1 : -1;
  return -(sense * Perp(UnitOrZero(CurveDirection(piece.edge, s))));
}

double DistanceToBox(const BoundingBox& box, Vec2 p) {
  const Vec2 beyond{std::max({box.lower.x - p.x, p.x - box.upper.x, 0.0}),
                    std::max({box.lower.y - p.y, p.y - box.upper.y, 0.0})};
  return Norm(beyond);
}

}  // namespace

struct OutlineRegion::Nearest {
  double distance = std::numeric_limits<double>::infinity();
  bool is_inside = false;
  int edge = -1;
};

OutlineRegion::OutlineRegion(const Outline& outline, double fineness)
    : edges_(AllPieces(outline)), fineness_(fineness), half_thickness_(std::numeric_limits<double>::infinity()) {
  constexpr double kRoundingUnits = 16;
  double reach = 0;
  for (const OutlinePiece& edge : edges_) reach = std::max(reach, Reach(edge));
  rounding_ = kRoundingUnits * std::numeric_limits<double>::epsilon() * reach;
  int first = 0;
  double area = 0;
  for (const OutlineLoop& loop : outline.loops) {
    AddLoop(loop, first);
    first += static_cast<int>(loop.size());
    area += LoopMoments(loop, {}).area;
  }
  if (chords_.empty()) return;
  std::vector<BoundingBox> boxes;
  double length = 0;
  for (const Chord& chord : chords_) {
    boxes.push_back(chord.piece.Bounds(0));
    length += chord.piece.chord();
  }
  tree_.emplace(boxes, Union);
  box_ = boxes.front();
  for (const BoundingBox& box : boxes) box_ = Union(box_, box);
  has_chain_ = std::any_of(ends_.begin(), ends_.end(), [](const Ends& ends) { return ends.on_chain; });
  if (has_chain_) return;
  // 2 area / length is the width of a long bar.
  if (area > 0) half_thickness_ = area / length;
  FindInnerPoint();
}

void OutlineRegion::AddLoop(const OutlineLoop& loop, int first) {
  const bool closed = IsClosed(loop);
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const OutlinePiece& piece = loop[k];
    const OutlinePiece& before = loop[(k + loop.size() - 1) % loop.size()];
    const OutlinePiece& after = loop[(k + 1) % loop.size()];
    Ends ends{.begin = {}, .end = {}, .on_chain = !closed};
    if (closed || k > 0) ends.begin = NormalAt(before, before.s_end) + NormalAt(piece, piece.s_begin);
    if (closed || k + 1 < loop.size()) ends.end = NormalAt(piece, piece.s_end) + NormalAt(after, after.s_begin);
    ends_.push_back(ends);

    const int edge = first + static_cast<int>(k);
    const OutlinePiece& kept = edges_[static_cast<std::size_t>(edge)];
    std::vector<double> cuts = EnclosedCuts(kept);
    if (cuts.empty()) cuts = {kept.s_begin, kept.s_end};
    for (std::size_t c = 0; c + 1 < cuts.size(); ++c) {
      std::vector<std::pair<EnclosedPiece, int>> open = {{EnclosedPiece(kept.edge, cuts[c], cuts[c + 1]), 0}};
      while (!open.empty()) {
        const auto [part, halvings] = open.back();
        open.pop_back();
        if (part.height() <= fineness_ / 8 || halvings == kMostHalvings || !part.can_split()) {
          chords_.push_back({part, edge});
        } else {
          open.emplace_back(part.SecondHalf(), halvings + 1);
          open.emplace_back(part.FirstHalf(), halvings + 1);
        }
      }
    }
  }
}

void OutlineRegion::FindInnerPoint() {
  constexpr std::size_t kTried = 8;
  double depth = rounding_;
  for (std::size_t k = 0; k < std::min(kTried, chords_.size()); ++k) {
    const EnclosedPiece& piece = chords_[k * chords_.size() / std::min(kTried, chords_.size())].piece;
    const Vec2 inwards = Perp(UnitOrZero(piece.end - piece.begin));
    const Vec2 p = CurvePoint(*piece.curve, piece.middle()) + spacing() * inwards;
    const Place place = At(p, spacing() / 8);
    if (!(place.depth > depth)) continue;
    depth = place.depth;
    inner_point_ = p;
  }
}

OutlineRegion::Place OutlineRegion::At(Vec2 p, double accuracy, double shallow) const {
  Nearest nearest;
  tree_->Visit([&](const BoundingBox& box, std::size_t first, std::size_t count) {
    if (nearest.distance <= shallow || DistanceToBox(box, p) > nearest.distance + rounding_) return false;
    if (count == 1) Look(chords_[first].piece, chords_[first].edge, p, accuracy, &nearest);
    return true;
  });
  return {nearest.is_inside ? nearest.distance : -nearest.distance, nearest.edge, is_on_chain(nearest.edge)};
}

// Takes the nearest point of a part of an edge if it is nearer to p than what is known.
void OutlineRegion::Look(const EnclosedPiece& piece, int edge, Vec2 p, double accuracy, Nearest* nearest) const {
  constexpr double kRelative = 1e-6;
  const Vec2 along = piece.end - piece.begin;
  const double square = Dot(along, along);
  const double t = square > 0 ? std::clamp(Dot(p - piece.begin, along) / square, 0.0, 1.0) : 0;
  const Vec2 from_foot = t < 1 ? p - piece.begin - t * along : p - piece.end;
  const double distance = Norm(from_foot);
  if (distance - piece.height() > nearest->distance + rounding_) return;
  if (piece.height() > std::max({accuracy, kRelative * distance, rounding_}) && piece.can_split()) {
    const std::array<EnclosedPiece, 2> halves = {piece.FirstHalf(), piece.SecondHalf()};
    const std::size_t nearer = t < 0.5 ? 0 : 1;
    Look(halves.at(nearer), edge, p, accuracy, nearest);
    Look(halves.at(1 - nearer), edge, p, accuracy, nearest);
    return;
  }
  bool is_inside = Cross(along, from_foot) > 0;
  const OutlinePiece& whole = edges_[static_cast<std::size_t>(edge)];
  const bool at_begin = t == 0 && piece.s_begin == whole.s_begin;
  if (at_begin || (t == 1 && piece.s_end == whole.s_end)) {
    const Ends& ends = ends_[static_cast<std::size_t>(edge)];
    const std::optional<Vec2>& normals = at_begin ? ends.begin : ends.end;
    is_inside = normals && Dot(*normals, from_foot) < 0;
  }
  // Where two loops share an edge the point is inside one of them.
  const bool is_tie = std::abs(distance - nearest->distance) <= rounding_;
  if (is_tie ? is_inside && !nearest->is_inside : distance < nearest->distance) *nearest = {distance, is_inside, edge};
}

std::optional<Vec2> OutlineRegion::DeepestPoint() const {
  constexpr int kAcross = 16;
  constexpr int kHalvings = 8;
  const Vec2 size = box_.upper - box_.lower;
  Vec2 deepest;
  double depth = 0;
  const auto consider = [&](Vec2 p) {
    const Place place = At(p, fineness_ / 8);
    if (!(place.depth > depth)) return false;
    deepest = p;
    depth = place.depth;
    return true;
  };
  if (has_chain_) return std::nullopt;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      consider(box_.lower + Vec2{(i + 0.5) / kAcross * size.x, (j + 0.5) / kAcross * size.y});
    }
  }
  if (depth == 0) return std::nullopt;
  Vec2 step = (1.0 / kAcross) * size;
  for (int k = 0; k < kHalvings;) {
    const std::array<Vec2, 4> moves = {Vec2{step.x, 0}, Vec2{-step.x, 0}, Vec2{0, step.y}, Vec2{0, -step.y}};
    const Vec2 from = deepest;
    if (std::none_of(moves.begin(), moves.end(), [&](Vec2 move) { return consider(from + move); })) {
      step = 0.5 * step;
      ++k;
    }
  }
  return deepest;
}

}  // namespace lcpbench
