#include "model/shape/outline.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "model/geometry/broad_phase.h"
#include "model/geometry/enclosed_piece.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// Fourth powers of lengths (second moments of area) must stay within double's range with room for sums of products.
constexpr double kMinExtent = 1e-60;
constexpr double kMaxExtent = 1e60;
// Rounding of an edge's own numbers, in units of epsilon times the lengths they stand for.
constexpr double kRoundingUnits = 16;
// Coordinates so coarse that tolerances come this near to the extent describe no shape.
constexpr double kMaxRelativeTolerance = 1e-4;
// Comparisons of pieces, per outline, per edge and at most, before edges count as too near to be told apart.
constexpr double kBudget = 1e6;
constexpr double kBudgetPerEdge = 1000;
constexpr double kMostComparisons = 1e8;

// The boxes keep segments apart that follow each other on one line, whose sides are mere rounding.
bool Intersect(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  if (!Overlap(BoxOf(a, b), BoxOf(c, d))) return false;
  const double c_side = Cross(b - a, c - a);
  const double d_side = Cross(b - a, d - a);
  const double a_side = Cross(d - c, a - c);
  const double b_side = Cross(d - c, b - c);
  return ((c_side > 0) != (d_side > 0)) && ((a_side > 0) != (b_side > 0));
}

double SegmentDistance(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
  if (Intersect(a, b, c, d)) return 0;
  return std::min(
      {DistanceToSegment(a, c, d), DistanceToSegment(b, c, d), DistanceToSegment(c, a, b), DistanceToSegment(d, a, b)});
}

bool ConesOverlap(const EnclosedPiece& p, const EnclosedPiece& q) {
  // Seen from the joint p runs backwards.
  const Vec2 p1 = -p.enclosure.first;
  const Vec2 p2 = -p.enclosure.second;
  const Vec2 q1 = q.enclosure.first;
  const Vec2 q2 = q.enclosure.second;
  return InCone(p1, q1, q2) || InCone(p2, q1, q2) || InCone(q1, p1, p2) || InCone(q2, p1, p2);
}

// What is known of two pieces.
enum class Meeting {
  kApart,      // proved
  kMeet,       // they come as near as the tolerance
  kUndecided,  // the budget of comparisons is used up
};

// Whether two pieces come nearer to each other than `tolerance` [m].
// @param budget  comparisons left; each takes one
Meeting FindMeeting(const EnclosedPiece& first, const EnclosedPiece& second, double tolerance, double* budget) {
  std::vector<std::pair<EnclosedPiece, EnclosedPiece>> open = {{first, second}};
  while (!open.empty()) {
    if (--*budget < 0) return Meeting::kUndecided;
    const auto [p, q] = open.back();
    open.pop_back();
    const double heights = p.height() + q.height();
    if (SegmentDistance(p.begin, p.end, q.begin, q.end) > heights + tolerance) continue;
    const bool split_p = p.height() >= q.height();
    if (heights <= tolerance || !(split_p ? p : q).can_split()) return Meeting::kMeet;
    if (split_p) {
      open.emplace_back(p.FirstHalf(), q);
      open.emplace_back(p.SecondHalf(), q);
    } else {
      open.emplace_back(p, q.FirstHalf());
      open.emplace_back(p, q.SecondHalf());
    }
  }
  return Meeting::kApart;
}

// The same for q beginning where p ends: whether they meet anywhere else, or leave the joint in the same direction.
// @param joint  pieces shorter than this [m] are not looked into: what then still runs the same way makes a cusp
Meeting FindMeetingBeyondJoint(const EnclosedPiece& first, const EnclosedPiece& second, double tolerance, double joint,
                               double* budget) {
  EnclosedPiece p = first;
  EnclosedPiece q = second;
  while (ConesOverlap(p, q)) {
    if (--*budget < 0) return Meeting::kUndecided;
    const bool split_p = p.chord() >= q.chord();
    if ((split_p ? p : q).chord() <= joint || !(split_p ? p : q).can_split()) return Meeting::kMeet;
    // The half away from the joint against all of the other; the other half goes on.
    const EnclosedPiece away = split_p ? p.FirstHalf() : q.SecondHalf();
    const Meeting meeting = FindMeeting(away, split_p ? q : p, tolerance, budget);
    if (meeting != Meeting::kApart) return meeting;
    if (split_p) {
      p = p.SecondHalf();
    } else {
      q = q.FirstHalf();
    }
  }
  return Meeting::kApart;
}

using PieceTree = RunTree<BoundingBox>;

// How often a closed loop of pieces runs counter-clockwise around a point that is further than `tolerance` from it.
// @param tree  of the pieces' bounds
int WindingNumber(const std::vector<EnclosedPiece>& loop, const PieceTree& tree, Vec2 point, double tolerance) {
  double angle = 0;
  // Only the nearest whole number of turns counts, so that the library's atan2 is exact enough.
  const auto add = [&](Vec2 begin, Vec2 end) {
    const Vec2 from = begin - point;
    const Vec2 to = end - point;
    angle += std::atan2(Cross(from, to), Dot(from, to));
  };
  const auto add_piece = [&](const EnclosedPiece& whole) {
    std::vector<EnclosedPiece> open = {whole};
    while (!open.empty()) {
      const EnclosedPiece piece = open.back();
      open.pop_back();
      // While the point is clear of the enclosure, the piece can be pulled taut onto its chord without passing over it.
      const bool clear = DistanceToSegment(point, piece.begin, piece.end) > piece.height();
      if (!clear && piece.height() > tolerance && piece.can_split()) {
        open.push_back(piece.FirstHalf());
        open.push_back(piece.SecondHalf());
        continue;
      }
      add(piece.begin, piece.end);
    }
  };
  // The same holds of a run of pieces that has the point outside its box.
  tree.Visit([&](const BoundingBox& box, std::size_t first, std::size_t count) {
    if (!Overlap(box, {point, point})) {
      add(loop[first].begin, loop[first + count - 1].end);
      return false;
    }
    if (count == 1) add_piece(loop[first]);
    return true;
  });
  return static_cast<int>(std::lround(angle / (2 * std::numbers::pi)));
}

class OutlineCheck {
 public:
  explicit OutlineCheck(const Outline& outline) : outline_(outline) {}

  void Run() {
    CheckNumbers();
    Enclose();
    CheckSize();
    CheckLengths();
    CheckJoints();
    CheckMeetings();
    CheckWinding();
    CheckNesting();
    CheckAspectRatio();
  }

 private:
  struct Owner {
    std::size_t loop;
    std::size_t piece;
    std::size_t position;  // among the enclosed pieces of its loop
  };

  [[noreturn]] static void Refuse(const std::string& where, const std::string& condition) {
    throw InputError(where + ": " + condition);
  }
  std::string Name(std::size_t loop, std::size_t piece) const {
    return PieceName(outline_, loop, piece) + " (" + Describe(ToFeature(outline_.loops[loop][piece].edge)) + ")";
  }
  std::string Name(const Owner& owner) const { return Name(owner.loop, owner.piece); }

  template <class Check>
  void ForEachPiece(const Check& check) const {
    for (std::size_t loop = 0; loop < outline_.loops.size(); ++loop) {
      for (std::size_t piece = 0; piece < outline_.loops[loop].size(); ++piece) check(loop, piece);
    }
  }

  void CheckNumbers() {
    if (outline_.loops.empty()) throw InputError("outline '" + outline_.name + "' has no outer boundary");
    for (std::size_t loop = 0; loop < outline_.loops.size(); ++loop) {
      if (outline_.loops[loop].empty()) Refuse(LoopName(outline_, loop), "has no edges");
    }
    ForEachPiece([&](std::size_t loop, std::size_t piece) {
      const OutlinePiece& edge = outline_.loops[loop][piece];
      RequireValidPiece(edge, PieceName(outline_, loop, piece));
      const double reach = Reach(edge);
      if (!(reach < kMaxExtent)) Refuse(Name(loop, piece), "lengths must be below 1e60");
      reach_ = std::max(reach_, reach);
      edges_ += 1;
    });
    // Squares of shorter lengths than this could underflow on the way to the checks of size.
    if (reach_ < kMinExtent) Refuse(LoopName(outline_, 0), "lengths must be above 1e-60");
  }

  void Enclose() {
    pieces_.resize(outline_.loops.size());
    ForEachPiece([&](std::size_t loop, std::size_t piece) {
      const OutlinePiece& edge = outline_.loops[loop][piece];
      const std::vector<double> cuts = EnclosedCuts(edge);
      if (cuts.empty()) {
        Refuse(Name(loop, piece), "the curve's derivative vanishes (a cusp or coincident control points)");
      }
      for (std::size_t k = 0; k + 1 < cuts.size(); ++k) {
        owners_.push_back({loop, piece, pieces_[loop].size()});
        pieces_[loop].emplace_back(edge.edge, cuts[k], cuts[k + 1]);
        if (k == 0) lengths_.emplace_back(owners_.back(), 0.0);
        lengths_.back().second += pieces_[loop].back().chord();
      }
    });
  }

  void CheckSize() {
    BoundingBox box{pieces_[0][0].begin, pieces_[0][0].begin};
    for (const auto& loop : pieces_) {
      for (const EnclosedPiece& piece : loop) {
        for (const Vec2 p : {piece.begin, piece.end}) box = Union(box, {p, p});
      }
    }
    extent_ = Norm(box.upper - box.lower);
    if (!(extent_ > kMinExtent)) {
      Refuse(LoopName(outline_, 0), "zero-length edges: the extent must be above 1e-60");
    }
    rounding_ = kRoundingUnits * std::numeric_limits<double>::epsilon() * reach_;
    if (!(rounding_ < kMaxRelativeTolerance * extent_)) {
      Refuse(LoopName(outline_, 0), "the shape is too small for its coordinates and radii: no digits are left");
    }
  }

  // A relative tolerance as a length [m], not below rounding.
  double Tolerance(double relative) const { return std::max(relative * extent_, rounding_); }

  void CheckLengths() const {
    for (const auto& [owner, length] : lengths_) {
      if (length > Tolerance(kMinEdgeLength)) continue;
      Refuse(Name(owner), "zero-length edge (shorter than 1e-8 of the outline's extent)");
    }
  }

  void CheckJoints() const {
    ForEachPiece([&](std::size_t loop, std::size_t piece) {
      const OutlineLoop& pieces = outline_.loops[loop];
      const std::size_t next = (piece + 1) % pieces.size();
      const Vec2 end = CurvePoint(pieces[piece].edge, pieces[piece].s_end);
      const Vec2 begin = CurvePoint(pieces[next].edge, pieces[next].s_begin);
      if (!(Norm(end - begin) <= Tolerance(kClosureTolerance))) {
        Refuse(Name(loop, piece), "open outline: its end does not meet the begin of edge " + std::to_string(next));
      }
    });
  }

  bool IsNext(const Owner& p, const Owner& q) const {
    return p.loop == q.loop && (p.position + 1) % pieces_[p.loop].size() == q.position;
  }

  const EnclosedPiece& At(const Owner& owner) const { return pieces_[owner.loop][owner.position]; }

  // Where they are too many to be looked at, no shape is known.
  std::vector<std::pair<int, int>> PairsNear(const std::vector<BoundingBox>& boxes) const {
    try {
      return FindOverlappingPairs(boxes);
    } catch (const InputError& error) {
      throw InputError("outline '" + outline_.name + "': " + error.what());
    }
  }

  void CheckMeetings() const {
    const double touch = Tolerance(kTouchTolerance);
    const double joint = Tolerance(kMinEdgeLength);
    std::vector<BoundingBox> boxes;
    boxes.reserve(owners_.size());
    for (const Owner& owner : owners_) boxes.push_back(At(owner).Bounds(touch));
    double budget = std::min(kBudget + kBudgetPerEdge * edges_, kMostComparisons);
    for (const auto& [i, j] : PairsNear(boxes)) {
      const Owner& p = owners_[static_cast<std::size_t>(i)];
      const Owner& q = owners_[static_cast<std::size_t>(j)];
      Meeting meeting = Meeting::kApart;
      bool neighbours = true;
      if (IsNext(p, q)) {
        meeting = FindMeetingBeyondJoint(At(p), At(q), touch, joint, &budget);
      } else if (IsNext(q, p)) {
        meeting = FindMeetingBeyondJoint(At(q), At(p), touch, joint, &budget);
      } else {
        neighbours = false;
        meeting = FindMeeting(At(p), At(q), touch, &budget);
      }
      if (meeting == Meeting::kApart) continue;
      const std::string other = p.loop == q.loop && p.piece == q.piece ? "itself" : Name(q);
      if (meeting == Meeting::kUndecided) {
        Refuse(Name(p), "runs too close along " + other + " to be told apart from a self-intersection");
      }
      Refuse(Name(p), "self-intersecting outline: it meets " + other +
                          (neighbours ? " beyond their common vertex, or leaves it in the same direction" : ""));
    }
  }

  void CheckWinding() const {
    for (std::size_t loop = 0; loop < outline_.loops.size(); ++loop) {
      const double area = LoopMoments(outline_.loops[loop], pieces_[loop][0].begin).area;
      if (loop == 0 && !(area > 0)) {
        Refuse(Name(loop, 0), "the outer boundary runs clockwise, expected counter-clockwise");
      }
      if (loop > 0 && !(area < 0)) Refuse(Name(loop, 0), "a hole runs counter-clockwise, expected clockwise");
    }
  }

  void CheckNesting() const {
    if (pieces_.size() == 1) return;
    const double touch = Tolerance(kTouchTolerance);
    std::vector<PieceTree> trees;
    std::vector<BoundingBox> boxes;
    for (const auto& loop : pieces_) {
      std::vector<BoundingBox> bounds;
      for (const EnclosedPiece& piece : loop) bounds.push_back(piece.Bounds(touch));
      trees.emplace_back(bounds, Union);
      boxes.push_back(bounds.front());
      for (const BoundingBox& box : bounds) boxes.back() = Union(boxes.back(), box);
    }
    const auto winding = [&](std::size_t around, std::size_t loop) {
      return WindingNumber(pieces_[around], trees[around], pieces_[loop][0].begin, touch);
    };
    for (std::size_t hole = 1; hole < pieces_.size(); ++hole) {
      if (winding(0, hole) != 1) Refuse(LoopName(outline_, hole), "outside the outer boundary");
    }
    // A hole in another one has its box in the other's.
    for (const auto& [i, j] : PairsNear(boxes)) {
      if (i == 0) continue;
      const auto a = static_cast<std::size_t>(i);
      const auto b = static_cast<std::size_t>(j);
      if (winding(b, a) != 0) Refuse(LoopName(outline_, a), "lies inside hole " + std::to_string(b));
      if (winding(a, b) != 0) Refuse(LoopName(outline_, b), "lies inside hole " + std::to_string(a));
    }
  }

  void CheckAspectRatio() const {
    // The smaller principal second moment is 1e-12 of the larger at the limit: it has four digits left, and the limit
    // gets as much slack.
    constexpr double kLimit = kMaxAspectRatio * (1 + 1e-3);
    const AreaMoments m = ComputeMassProperties(outline_, 1).moments;
    const double mean = (m.xx + m.yy) / 2;
    const double difference = (m.xx - m.yy) / 2;
    const double large = mean + std::sqrt(difference * difference + m.xy * m.xy);
    const double small = (m.xx * m.yy - m.xy * m.xy) / large;
    if (!(large <= kLimit * kLimit * small)) {
      Refuse(LoopName(outline_, 0), "the shape's aspect ratio is beyond the limit of 1e6");
    }
  }

  const Outline& outline_;
  std::vector<std::vector<EnclosedPiece>> pieces_;  // per loop
  std::vector<Owner> owners_;                       // of all pieces, loop after loop
  std::vector<std::pair<Owner, double>> lengths_;   // of the outline's edges
  double reach_ = 0;
  double extent_ = 0;
  double rounding_ = 0;
  double edges_ = 0;
};

}  // namespace

void RequireValid(const Outline& outline) { OutlineCheck(outline).Run(); }

}  // namespace lcpbench
