#include "model/scenes/oval_front.h"

#include <algorithm>
#include <cmath>

#include "model/scenes/parts.h"

namespace lcpbench {
namespace {

/// Least gap between an oval and what it does not rest on, over the largest semi-axis: far above rounding.
constexpr double kClearance = 1e-6;
constexpr double kLeastCross = 0.15;  ///< supports whose normals are closer to parallel hold nothing [sine]
constexpr int kMaxNewton = 60;
constexpr int kMaxRefusals = 50;  ///< ovals that a pocket may refuse before it is left empty

/// n turned by about `angle` (exactly by 2 atan(angle / 2)), a unit vector again.
Vec2 Turned(Vec2 n, double angle) {
  const double half = angle / 2;
  const double square = half * half;
  return Normalized((1 - square) * n + (2 * half) * Perp(n));
}

/// The normal at which s(n) is stationary, from a start whose basin it is: s' / slope by `evaluate`, which returns
/// {s, s', -s'' (> 0 near the answer)}, the sign such that s is to be made larger.
struct Jet {
  double s;
  double first;
  double bending;
};
template <class Evaluate>
Vec2 Climb(Vec2 n, Evaluate evaluate) {
  constexpr double kLongest = 0.5;
  constexpr double kConverged = 1e-15;
  Jet jet = evaluate(n);
  for (int i = 0; i < kMaxNewton; ++i) {
    double step = jet.bending > 0 ? jet.first / jet.bending : (jet.first < 0 ? -kLongest : kLongest);
    step = std::clamp(step, -kLongest, kLongest);
    if (std::abs(step) <= kConverged) break;
    Vec2 to = Turned(n, step);
    Jet there = evaluate(to);
    constexpr double kTrusted = 1e-5;  // close to the top rounding decides whether s rises: take Newton's word there
    while (there.s < jet.s && std::abs(step) > kTrusted) {
      step /= 2;
      to = Turned(n, step);
      there = evaluate(to);
    }
    // No progress left but rounding's.
    if (std::abs(step) <= kTrusted && std::abs(there.first) >= std::abs(jet.first)) break;
    n = to;
    jet = there;
  }
  return n;
}

}  // namespace

OvalSupport SupportOf(const PlacedOval& oval, Vec2 n) {
  const double along = Dot(n, oval.u);
  const double across = Cross(oval.u, n);
  const double a2 = oval.a * oval.a;
  const double b2 = oval.b * oval.b;
  const double h = std::sqrt(a2 * along * along + b2 * across * across);
  const Vec2 arm = (a2 * along / h) * oval.u + (b2 * across / h) * Perp(oval.u);
  return {arm, h, a2 * b2 / (h * h * h)};
}

OvalGap GapBetween(const PlacedOval& oval, const PlacedOval& other) {
  const Vec2 between = oval.c - other.c;
  const auto evaluate = [&](Vec2 n) {
    // Ovals are symmetric about their centres: the support towards -n is the same with the arm reversed.
    const OvalSupport x = SupportOf(oval, n);
    const OvalSupport y = SupportOf(other, n);
    const double s = Dot(n, between) - x.h - y.h;
    return Jet{s, Dot(Perp(n), between - x.arm - y.arm), s + x.radius + y.radius};
  };
  const Vec2 n = Climb(Normalized(between), evaluate);
  return {evaluate(n).s, n};
}

OvalGap GapInside(const PlacedOval& oval, double bowl_radius) {
  const auto evaluate = [&](Vec2 outward) {
    const OvalSupport x = SupportOf(oval, outward);
    const double s = Dot(outward, oval.c) + x.h;
    return Jet{s, Dot(Perp(outward), oval.c + x.arm), s - x.radius};
  };
  const Vec2 outward = Climb(Norm(oval.c) > 0 ? Normalized(oval.c) : oval.u, evaluate);
  return {bowl_radius - evaluate(outward).s, -outward};
}

OvalFront::OvalFront(double bowl_radius, double largest)
    : bowl_radius_(bowl_radius),
      largest_(largest),
      clearance_(kClearance * largest),
      cells_(static_cast<std::size_t>(bowl_radius / largest) + 2),
      grid_(cells_ * cells_) {}

void OvalFront::AddFirst(PlacedOval oval, Vec2 down) {
  oval.c = bowl_radius_ * down - SupportOf(oval, down).arm;
  InsertBetween(kLeftBowl, kRightBowl, oval);
}

std::optional<OvalSupports> OvalFront::Add(PlacedOval oval) {
  constexpr int kMaxMoves = 100;
  constexpr int kReach = 50;  // how far along the chain an overlapped oval is looked for
  while (!pockets_.empty()) {
    const Pocket pocket = pockets_.top();
    if (Next(pocket.left) == pocket.right && refusals_ < kMaxRefusals) break;
    pockets_.pop();
    refusals_ = 0;
  }
  if (pockets_.empty()) return std::nullopt;
  int left = pockets_.top().left;
  int right = pockets_.top().right;
  ++refusals_;
  for (int i = 0; i < kMaxMoves; ++i) {
    if (!PlaceInPocket(left, right, &oval)) return std::nullopt;
    const int hit = FindOverlap(oval, left, right);
    if (hit == kNone) {
      Bury(left, right);
      InsertBetween(left, right, oval);
      refusals_ = 0;
      return OvalSupports{left, right};
    }
    int before = left;
    int after = right;
    for (int step = 0; step < kReach && before != hit && after != hit; ++step) {
      if (before != kLeftBowl) before = Previous(before);
      if (after != kRightBowl) after = Next(after);
    }
    if (before != hit && after != hit) return std::nullopt;
    (before == hit ? left : right) = hit;
  }
  return std::nullopt;
}

std::optional<int> OvalFront::AddOnCrest(PlacedOval oval) {
  const Vec2 up{0, 1};
  const auto top = [&](int k) { return Oval(k).c.y + SupportOf(Oval(k), up).h; };
  std::vector<std::pair<double, int>> chain;
  for (int k = Next(kLeftBowl); k != kRightBowl; k = Next(k)) chain.emplace_back(-top(k), k);
  std::sort(chain.begin(), chain.end());
  for (const auto& [height, k] : chain) {
    oval.c = Oval(k).c + SupportOf(Oval(k), up).arm + SupportOf(oval, up).arm;
    if (FindOverlap(oval, k, k) != kNone) continue;
    Insert(oval);
    return k;
  }
  return std::nullopt;
}

/// Into the chain, and with it the two pockets at its sides.
void OvalFront::InsertBetween(int left, int right, const PlacedOval& oval) {
  const int inserted = Insert(oval);
  for (const auto& [from, to] : {std::pair{left, inserted}, {inserted, right}}) {
    (from == kLeftBowl ? first_ : next_[static_cast<std::size_t>(from)]) = to;
    (to == kRightBowl ? last_ : previous_[static_cast<std::size_t>(to)]) = from;
    PushPocket(from, to);
  }
}

/// Takes those between two of the chain out of it.
void OvalFront::Bury(int left, int right) {
  for (int k = Next(left); k != right;) {
    const int after = Next(k);
    next_[static_cast<std::size_t>(k)] = kNone;
    k = after;
  }
}

void OvalFront::PushPocket(int left, int right) {
  const auto y = [this](int k) { return Oval(k).c.y; };
  const double height = left == kLeftBowl ? y(right) : right == kRightBowl ? y(left) : (y(left) + y(right)) / 2;
  pockets_.push({height, left, right});
}

OvalGap OvalFront::GapTo(const PlacedOval& oval, int k) const {
  return k < 0 ? GapInside(oval, bowl_radius_) : GapBetween(oval, Oval(k));
}

/// The upper intersection of the circles on which the centre would lie if all were discs of the same areas.
Vec2 OvalFront::GuessCenter(const PlacedOval& oval, int left, int right) const {
  const double r = std::sqrt(oval.a * oval.b);
  const auto circle = [&](int k) -> std::pair<Vec2, double> {
    if (k < 0) return {{}, bowl_radius_ - r};
    return {Oval(k).c, r + std::sqrt(Oval(k).a * Oval(k).b)};
  };
  const auto [p, p_reach] = circle(left);
  const auto [q, q_reach] = circle(right);
  CircleMeeting meeting = MeetingOf(p, p_reach, q, q_reach);
  meeting.square = std::max(meeting.square, r * r / 4);
  // The bowl's centre is above the pocket, an oval's below.
  return left < 0 || right < 0 ? meeting.Right() : meeting.Left();
}

/// Moves the oval's centre to where it touches both. False where it does not come to rest between them.
bool OvalFront::PlaceInPocket(int left, int right, PlacedOval* oval) const {
  if (left < 0 && right < 0) return false;
  oval->c = GuessCenter(*oval, left, right);
  double last_length = 2 * bowl_radius_;
  for (int i = 0; i < kMaxNewton; ++i) {
    const OvalGap gap1 = GapTo(*oval, left);
    const OvalGap gap2 = GapTo(*oval, right);
    const double cross = Cross(gap1.n, gap2.n);
    if (!(cross > kLeastCross)) return false;
    // The gaps' gradients by the centre are the normals.
    const Vec2 step{-(gap1.d * gap2.n.y - gap2.d * gap1.n.y) / cross, -(gap2.d * gap1.n.x - gap1.d * gap2.n.x) / cross};
    const double length = Norm(step);
    const double longest = oval->b / 2;
    oval->c = oval->c + (length > longest ? longest / length : 1.0) * step;
    constexpr double kRounding = 1e-14;  // steps shrink by their squares until only rounding is left of them
    if (length <= kRounding * bowl_radius_ && length >= last_length / 4) return true;
    if (length == 0) return true;
    last_length = length;
  }
  return false;
}

/// Something else that the oval is not clear of, that which overlaps it deepest; of the bowl, the side where the oval
/// is.
int OvalFront::FindOverlap(const PlacedOval& oval, int support1, int support2) const {
  int hit = kNone;
  double least = clearance_;
  if (support1 >= 0 && support2 >= 0) {
    const double out = bowl_radius_ - Norm(oval.c) - oval.a;
    const double d = out > clearance_ ? out : GapInside(oval, bowl_radius_).d;
    if (d < least) {
      hit = oval.c.x < 0 ? kLeftBowl : kRightBowl;
      least = d;
    }
  }
  const double reach = oval.a + largest_ + clearance_;
  for (std::size_t i = CellOf(oval.c.x - reach); i <= CellOf(oval.c.x + reach); ++i) {
    for (std::size_t j = CellOf(oval.c.y - reach); j <= CellOf(oval.c.y + reach); ++j) {
      for (const int k : grid_[i * cells_ + j]) {
        if (k == support1 || k == support2) continue;
        if (Norm(oval.c - Oval(k).c) > oval.a + Oval(k).a + clearance_) continue;
        const double d = GapBetween(oval, Oval(k)).d;
        if (d < least) {
          hit = k;
          least = d;
        }
      }
    }
  }
  return hit;
}

int OvalFront::Insert(const PlacedOval& oval) {
  const int k = static_cast<int>(ovals_.size());
  ovals_.push_back(oval);
  next_.push_back(kNone);
  previous_.push_back(kNone);
  grid_[CellOf(oval.c.x) * cells_ + CellOf(oval.c.y)].push_back(k);
  return k;
}

std::size_t OvalFront::CellOf(double coordinate) const {
  const double from_edge = std::max(0.0, coordinate + bowl_radius_);
  return std::min(static_cast<std::size_t>(from_edge / (2 * largest_)), cells_ - 1);
}

}  // namespace lcpbench
