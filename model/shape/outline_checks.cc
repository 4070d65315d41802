#include "model/shape/outline_checks.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "model/geometry/broad_phase.h"
#include "model/shape/mass_properties.h"
#include "model/shape/outline_meeting.h"
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
// Comparisons of pieces, per outline and per edge, before edges count as too near to be told apart.
constexpr int kBudget = 1000000;
constexpr int kBudgetPerEdge = 1000;

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
    return PieceName(outline_, loop, piece) + " (" + DescribeCurve(outline_.loops[loop][piece].edge) + ")";
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
      const std::size_t before = pieces_[loop].size();
      if (!AppendEnclosed(outline_.loops[loop][piece], &pieces_[loop])) {
        Refuse(Name(loop, piece), "the curve's derivative vanishes (a cusp or coincident control points)");
      }
      for (std::size_t k = before; k < pieces_[loop].size(); ++k) owners_.push_back({loop, piece, k});
    });
  }

  void CheckSize() {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    Vec2 lower{kInfinity, kInfinity};
    Vec2 upper{-kInfinity, -kInfinity};
    for (const auto& loop : pieces_) {
      for (const EnclosedPiece& piece : loop) {
        for (const Vec2 p : {piece.begin(), piece.end()}) {
          lower = {std::min(lower.x, p.x), std::min(lower.y, p.y)};
          upper = {std::max(upper.x, p.x), std::max(upper.y, p.y)};
        }
      }
    }
    extent_ = Norm(upper - lower);
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
    double length = 0;
    for (std::size_t k = 0; k < owners_.size(); ++k) {
      const Owner& owner = owners_[k];
      length += At(owner).chord();
      const bool more =
          k + 1 < owners_.size() && owners_[k + 1].loop == owner.loop && owners_[k + 1].piece == owner.piece;
      if (more) continue;
      if (!(length > Tolerance(kMinEdgeLength))) {
        Refuse(Name(owner), "zero-length edge (shorter than 1e-8 of the outline's extent)");
      }
      length = 0;
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

  void CheckMeetings() const {
    const double touch = Tolerance(kTouchTolerance);
    const double joint = Tolerance(kMinEdgeLength);
    std::vector<BoundingBox> boxes;
    boxes.reserve(owners_.size());
    for (const Owner& owner : owners_) boxes.push_back(At(owner).Bounds(touch));
    int budget = kBudget + kBudgetPerEdge * edges_;
    for (const auto& [i, j] : FindOverlappingPairs(boxes)) {
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
      const double area = LoopMoments(outline_.loops[loop], pieces_[loop][0].begin()).area;
      if (loop == 0 && !(area > 0)) {
        Refuse(Name(loop, 0), "the outer boundary runs clockwise, expected counter-clockwise");
      }
      if (loop > 0 && !(area < 0)) Refuse(Name(loop, 0), "a hole runs counter-clockwise, expected clockwise");
    }
  }

  void CheckNesting() const {
    const double touch = Tolerance(kTouchTolerance);
    for (std::size_t hole = 1; hole < pieces_.size(); ++hole) {
      const Vec2 point = pieces_[hole][0].begin();
      if (WindingNumber(pieces_[0], point, touch) != 1) Refuse(LoopName(outline_, hole), "outside the outer boundary");
      for (std::size_t other = 1; other < pieces_.size(); ++other) {
        if (other != hole && WindingNumber(pieces_[other], point, touch) != 0) {
          Refuse(LoopName(outline_, hole), "lies inside hole " + std::to_string(other));
        }
      }
    }
  }

  void CheckAspectRatio() const {
    // The smaller principal second moment is 1e-12 of the larger at the limit: it has four digits left, and the limit
    // gets as much slack.
    constexpr double kLimit = kMaxAspectRatio * (1 + 1e-3);
    const MassProperties properties = ComputeMassProperties(outline_, 1);
    const AreaMoments m = OutlineMoments(outline_, properties.center);
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
  double reach_ = 0;
  double extent_ = 0;
  double rounding_ = 0;
  int edges_ = 0;
};

}  // namespace

void RequireValid(const Outline& outline) { OutlineCheck(outline).Run(); }

}  // namespace lcpbench
