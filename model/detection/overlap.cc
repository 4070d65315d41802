#include "model/detection/overlap.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <optional>
#include <utility>

#include "model/contact/contact_row.h"
#include "model/geometry/broad_phase.h"

namespace lcpbench {
namespace {

// The box around the corners of another one, each moved to `map(corner)`.
template <class Map>
BoundingBox AroundCorners(const BoundingBox& box, const Map& map) {
  return Union(BoxOf(map(box.lower), map(box.upper)),
               BoxOf(map({box.lower.x, box.upper.y}), map({box.upper.x, box.lower.y})));
}

// A body's region in the world.
struct PlacedRegion {
  const OutlineRegion* region = nullptr;
  Vec2 x;
  Rotation rotation;

  PlacedRegion(const OutlineRegion& of, const Body& body) : region(&of), x(body.x), rotation(SinCos(body.theta)) {}
  Vec2 ToBody(Vec2 p) const { return RotateBack(rotation, p - x); }
  Vec2 ToWorld(Vec2 c) const { return x + Rotate(rotation, c); }
  OutlineRegion::Place At(Vec2 p, double accuracy, double shallow = -1) const {
    return region->At(ToBody(p), accuracy, shallow);
  }
  BoundingBox Bounds() const {
    return AroundCorners(region->box(), [this](Vec2 corner) { return ToWorld(corner); });
  }
};

// The part of the segment a b within a box, as fractions of it; nothing where they do not meet.
std::optional<std::pair<double, double>> Clip(Vec2 a, Vec2 b, const BoundingBox& box) {
  double from = 0;
  double to = 1;
  const auto clip = [&](double start, double along, double lower, double upper) {
    if (along == 0) {
      if (start < lower || start > upper) to = -1;
      return;
    }
    const auto [enters, leaves] = std::minmax({(lower - start) / along, (upper - start) / along});
    from = std::max(from, enters);
    to = std::min(to, leaves);
  };
  clip(a.x, b.x - a.x, box.lower.x, box.upper.x);
  clip(a.y, b.y - a.y, box.lower.y, box.upper.y);
  if (from > to) return std::nullopt;
  return std::pair(from, to);
}

// Looks for the deepest common point of two bodies.
class PairSearch {
 public:
  PairSearch(const PlacedRegion& region1, const PlacedRegion& region2, double fineness, double limit)
      : regions_{&region1, &region2}, fineness_(fineness) {
    deepest_.depth = limit;
  }

  // A contact's points, which lie no deeper than its gap says.
  void Try(const Constraint& contact, std::span<const Body> bodies) {
    crosses_ = crosses_ || contact.nominal_gap < 0;
    if (-contact.nominal_gap <= deepest_.depth) return;
    const ClosestPoints closest = FindClosestPoints(contact, bodies);
    TryPoint(0, regions_[0]->x + closest.R1);
    TryPoint(1, regions_[1]->x + closest.R2);
  }

  // Samples of both outlines, and the deepest points of bodies whose outlines are nearly the same.
  void Sample() {
    // Chains first, which show whether the other body crosses them.
    const std::size_t first = regions_[1]->region->has_chain() ? 1 : 0;
    SampleOutline(first);
    if (crosses_ || !regions_[first]->region->has_chain()) SampleOutline(1 - first);
    if (is_found_) Refine();
    if (!is_found_ && !ShareInnerPoint()) return;
    for (const PlacedRegion* of : regions_) {
      const std::optional<Vec2> deepest = of->region->DeepestPoint();
      if (deepest) TryCommon(of->ToWorld(*deepest));
    }
  }

  // The deepest overlap of the bodies 0 and 1.
  std::optional<BodyOverlap> Deepest() const { return is_found_ ? std::optional(deepest_) : std::nullopt; }

 private:
  static constexpr double kCloser = 16;
  static constexpr double kClosest = 1e-6;

  const PlacedRegion& Other(std::size_t own) const { return *regions_[1 - own]; }

  void Note(std::size_t own, int edge, int other_edge, double depth) {
    is_found_ = true;
    deepest_.depth = depth;
    deepest_.edge1 = own == 0 ? edge : other_edge;
    deepest_.edge2 = own == 0 ? other_edge : edge;
    sampled_.reset();
  }

  // A point of one body's outline.
  void TryPoint(std::size_t own, Vec2 p) {
    const OutlineRegion::Place place = Other(own).At(p, 0);
    if (place.depth > deepest_.depth && (crosses_ || !place.on_chain)) {
      Note(own, regions_[own]->At(p, 0).edge, place.edge, place.depth);
    }
  }

  // Any point.
  void TryCommon(Vec2 p) {
    const OutlineRegion::Place place1 = regions_[0]->At(p, 0);
    const OutlineRegion::Place place2 = regions_[1]->At(p, 0);
    if (std::min(place1.depth, place2.depth) <= 0 || place1.on_chain || place2.on_chain) return;
    const double depth = std::max(place1.depth, place2.depth);
    if (depth > deepest_.depth) Note(0, place1.edge, place2.edge, depth);
  }

  bool ShareInnerPoint() const {
    const auto holds = [this](std::size_t own) {
      const std::optional<Vec2>& inner = regions_[own]->region->inner_point();
      if (!inner) return false;
      const double accuracy = std::min(Accuracy(), regions_[own]->region->spacing() / 4);
      const OutlineRegion::Place place = Other(own).At(regions_[own]->ToWorld(*inner), accuracy);
      return place.depth > accuracy && !place.on_chain;
    };
    return holds(0) || holds(1);
  }

  void SampleOutline(std::size_t own) {
    const PlacedRegion& other = Other(own);
    // The other body's box as this one's frame has it.
    const BoundingBox box_in_frame =
        AroundCorners(other.region->box(), [&](Vec2 corner) { return regions_[own]->ToBody(other.ToWorld(corner)); });
    const BoundingBox near = Inflated(box_in_frame, {}, fineness_);
    const OutlineRegion& region = *regions_[own]->region;
    region.tree().Visit([&](const BoundingBox& box, std::size_t first, std::size_t count) {
      if (!Overlap(box, near) || IsShallow(own, box)) return false;
      if (count == 1) SampleChord(own, region.chords()[first], near, other.region->spacing());
      return true;
    });
  }

  // Whether no point of a box of one body's frame can lie deeper in the other than what is known: depths change by no
  // more than points move. That an open chain runs through the other body is to be seen at any depth; across its own
  // ends the depth jumps.
  bool IsShallow(std::size_t own, const BoundingBox& box) const {
    if (Other(own).region->has_chain()) return false;
    const double known = regions_[own]->region->has_chain() ? 0 : deepest_.depth;
    const double reach = Norm(box.upper - box.lower) / 2 + Accuracy();
    const Vec2 middle = regions_[own]->ToWorld(0.5 * (box.lower + box.upper));
    return Other(own).At(middle, Accuracy(), known - reach).depth + reach <= known;
  }
  double Accuracy() const { return fineness_ / 8; }

  void SampleChord(std::size_t own, const OutlineRegion::Chord& chord, const BoundingBox& near, double spacing) {
    constexpr double kMost = 256;
    const EnclosedPiece& piece = chord.piece;
    const auto part = Clip(piece.begin, piece.end, near);
    if (!part) return;
    const auto [from, to] = *part;
    const double count = std::clamp(std::ceil((to - from) * piece.chord() / spacing), 2.0, kMost);
    const double step = (to - from) / count * (piece.s_end - piece.s_begin);
    for (double k = 0; k <= count; ++k) {
      const double s = piece.s_begin + from * (piece.s_end - piece.s_begin) + k * step;
      TrySample(own, chord, s, std::abs(step));
    }
  }

  void TrySample(std::size_t own, const OutlineRegion::Chord& chord, double s, double step) {
    const Vec2 p = regions_[own]->ToWorld(CurvePoint(*chord.piece.curve, s));
    const bool on_chain = regions_[own]->region->is_on_chain(chord.edge);
    const double known = on_chain && !crosses_ ? 0 : deepest_.depth;
    const OutlineRegion::Place rough = Other(own).At(p, Accuracy(), known - Accuracy());
    crosses_ = crosses_ || (on_chain && rough.depth > Accuracy());
    if (rough.depth <= deepest_.depth - Accuracy() || (rough.on_chain && !crosses_)) return;
    // Closer looks cost more, and most samples need none.
    for (double accuracy = Accuracy() / kCloser; accuracy > kClosest * fineness_; accuracy /= kCloser) {
      if (Other(own).At(p, accuracy, deepest_.depth - accuracy).depth <= deepest_.depth - accuracy) return;
    }
    const OutlineRegion::Place place = Other(own).At(p, 0);
    if (place.depth <= deepest_.depth) return;
    Note(own, chord.edge, place.edge, place.depth);
    sampled_ = Sampled{own, &chord, s, step};
  }

  // Moves the deepest sample along its edge to where the depth is greatest.
  void Refine() {
    if (!sampled_) return;
    const Sampled sampled = *sampled_;
    const OutlineCurve& curve = *sampled.chord->piece.curve;
    const auto [low, high] = std::minmax(sampled.chord->piece.s_begin, sampled.chord->piece.s_end);
    constexpr double kGolden = 0.6180339887498949;
    constexpr int kSteps = 40;
    double from = std::max(low, sampled.s - sampled.step);
    double to = std::min(high, sampled.s + sampled.step);
    const auto at = [&](double s) {
      return Other(sampled.own).At(regions_[sampled.own]->ToWorld(CurvePoint(curve, s)), 0);
    };
    for (int k = 0; k < kSteps; ++k) {
      const double s1 = to - kGolden * (to - from);
      const double s2 = from + kGolden * (to - from);
      (at(s1).depth > at(s2).depth ? to : from) = at(s1).depth > at(s2).depth ? s2 : s1;
    }
    const OutlineRegion::Place place = at(from + (to - from) / 2);
    if (place.depth > deepest_.depth) Note(sampled.own, sampled.chord->edge, place.edge, place.depth);
  }

  struct Sampled {
    std::size_t own = 0;
    const OutlineRegion::Chord* chord = nullptr;
    double s = 0;
    double step = 0;
  };

  std::array<const PlacedRegion*, 2> regions_;
  double fineness_;
  bool crosses_ = false;  // an open chain runs through the other body
  bool is_found_ = false;
  BodyOverlap deepest_;
  std::optional<Sampled> sampled_;  // where the deepest point is a sample
};

// Whether boxes overlap by as much as an overlap of bodies of that depth needs.
bool IsDeep(const BoundingBox& p, const BoundingBox& q, double depth) {
  const auto is_deep = [depth](double lower1, double upper1, double lower2, double upper2) {
    const double need = std::min({depth, upper1 - lower1, upper2 - lower2});
    return std::min(upper1, upper2) - std::max(lower1, lower2) >= need * (1 - 1e-9);
  };
  return is_deep(p.lower.x, p.upper.x, q.lower.x, q.upper.x) && is_deep(p.lower.y, p.upper.y, q.lower.y, q.upper.y);
}

}  // namespace

OverlapFinder::OverlapFinder(std::span<const Outline> outlines, double fineness) : fineness_(fineness) {
  regions_.reserve(outlines.size());
  for (const Outline& outline : outlines) regions_.emplace_back(outline, fineness);
}

std::vector<BodyOverlap> OverlapFinder::Find(std::span<const Body> bodies, std::span<const Constraint> contacts,
                                             std::span<const std::pair<int, int>> excluded, double limit) const {
  std::vector<PlacedRegion> placed;
  std::vector<int> index;
  std::vector<BoundingBox> boxes;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (regions_[i].empty()) continue;
    placed.emplace_back(regions_[i], bodies[i]);
    index.push_back(static_cast<int>(i));
    boxes.push_back(placed.back().Bounds());
  }
  std::map<std::pair<int, int>, std::vector<const Constraint*>> known;
  for (const Constraint& contact : contacts) known[{contact.body1, contact.body2}].push_back(&contact);

  std::vector<BodyOverlap> overlaps;
  for (const auto& [a, b] : FindOverlappingPairs(boxes)) {
    const auto first = static_cast<std::size_t>(a);
    const auto second = static_cast<std::size_t>(b);
    const std::pair pair(index[first], index[second]);
    const bool both_fixed =
        bodies[static_cast<std::size_t>(pair.first)].fixed && bodies[static_cast<std::size_t>(pair.second)].fixed;
    if (both_fixed || std::binary_search(excluded.begin(), excluded.end(), pair)) continue;
    const double thin = std::min(regions_[static_cast<std::size_t>(pair.first)].half_thickness(),
                                 regions_[static_cast<std::size_t>(pair.second)].half_thickness());
    const double least = std::min(limit, thin / 2);
    if (!IsDeep(boxes[first], boxes[second], least)) continue;
    PairSearch search(placed[first], placed[second], fineness_, least);
    if (const auto found = known.find(pair); found != known.end()) {
      for (const Constraint* contact : found->second) search.Try(*contact, bodies);
    }
    search.Sample();
    if (std::optional<BodyOverlap> overlap = search.Deepest()) {
      overlap->body1 = pair.first;
      overlap->body2 = pair.second;
      overlaps.push_back(*overlap);
    }
  }
  return overlaps;
}

double OverlapFinder::DepthAt(std::span<const Body> bodies, int body1, Vec2 p1, int body2, Vec2 p2, double most) const {
  const auto depth = [&](double accuracy) {
    const auto at = [&](int body, Vec2 p) {
      const auto i = static_cast<std::size_t>(body);
      return PlacedRegion(regions_[i], bodies[i]).At(p, accuracy).depth;
    };
    return std::max({at(body2, p1), at(body1, p2), 0.0});
  };
  // Mostly it is the contact's own depth, for which a less than close look is enough.
  constexpr double kSame = 1e-2;
  return depth(kSame * most) >= (1 - 2 * kSame) * most ? most : std::min(most, depth(0));
}

}  // namespace lcpbench
