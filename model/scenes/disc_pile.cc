// disc-pile: discs of many sizes and masses, dropped one after the other into a box.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr Range kRadius{0.06, 0.15};
constexpr double kWeight = 0.2 * kGravity;  ///< times the root of the number of layers [m/s^2]
constexpr double kBoxAspect = 1.2;  ///< width of the box over that of a square which holds the discs side by side
/// Least gap between bodies that are not listed as touching, over the smaller radius: far above rounding.
constexpr double kClearance = 1e-6;

struct Disc {
  Vec2 c;
  double r = 0;
};

/// What a disc comes to rest on: a disc (index >= 0) or a side of the box.
enum Support : int { kFloor = -1, kLeftWall = -2, kRightWall = -3, kNothing = -4 };

struct Resting {
  Vec2 c;
  int support1 = kNothing;
  int support2 = kNothing;
};

/// Drops discs into the box 0 <= x <= width, y >= 0. A grid of cells two largest radii wide finds neighbours, so that a
/// drop costs O(1) beside the search for the surface, which remembers each column's height.
class Pile {
 public:
  explicit Pile(double width) : width_(width), columns_(static_cast<std::size_t>(std::max(1.0, width / kCell)) + 1) {}

  const std::vector<Disc>& discs() const { return discs_; }

  /// Where a disc of radius r let fall at x comes to rest; nothing where that touches a third body.
  std::optional<Resting> Drop(double r, double x, double floor_direction) const {
    Vec2 at{x, std::numeric_limits<double>::infinity()};
    int left_behind = kNothing;
    for (int step = 0; step < kMaxSteps; ++step) {
      const int hit = Fall(r, left_behind, &at);
      if (hit == kFloor) return Accept(r, RollOnFloor(r, at, floor_direction));
      const double direction = at.x < discs_[Idx(hit)].c.x ? -1 : 1;
      Resting rest;
      left_behind = RollOver(r, hit, direction, &at, &rest);
      if (left_behind == kNothing) return Accept(r, rest);
    }
    return std::nullopt;
  }

  void Add(const Disc& disc) {
    const auto column = ColumnOf(disc.c.x);
    const auto row = RowOf(disc.c.y);
    if (columns_[column].size() <= row) columns_[column].resize(row + 1);
    columns_[column][row].push_back(static_cast<int>(discs_.size()));
    discs_.push_back(disc);
  }

 private:
  static constexpr double kCell = 2 * kRadius.high;
  static constexpr int kMaxSteps = 1000;

  static std::size_t Idx(int i) { return static_cast<std::size_t>(i); }
  std::size_t ColumnOf(double x) const {
    return std::min(static_cast<std::size_t>(std::max(0.0, x) / kCell), columns_.size() - 1);
  }
  static std::size_t RowOf(double y) { return static_cast<std::size_t>(std::max(0.0, y) / kCell); }

  /// Calls visit(k) for every disc whose centre is in that box (and some more).
  template <typename Visit>
  void ForDiscs(Vec2 low, Vec2 high, Visit visit) const {
    for (std::size_t column = ColumnOf(low.x); column <= ColumnOf(high.x); ++column) {
      const auto& cells = columns_[column];
      for (std::size_t row = RowOf(low.y); row <= RowOf(high.y) && row < cells.size(); ++row) {
        for (const int k : cells[row]) visit(k);
      }
    }
  }

  /// Lets the disc fall straight down from *at to the first body below (not `left_behind`).
  int Fall(double r, int left_behind, Vec2* at) const {
    int hit = kFloor;
    double y = r;
    const std::size_t first = ColumnOf(at->x - kCell);
    const std::size_t last = ColumnOf(at->x + kCell);
    for (std::size_t column = first; column <= last; ++column) {
      const auto& cells = columns_[column];
      std::size_t row = cells.size();
      if (at->y < static_cast<double>(row) * kCell) row = std::min(row, RowOf(at->y) + 1);
      while (row-- > 0) {
        // Nothing in this cell or below can hold the disc higher than this.
        if (static_cast<double>(row + 1) * kCell + kRadius.high + r < y) break;
        for (const int k : cells[row]) {
          const Disc& other = discs_[Idx(k)];
          const double reach = r + other.r;
          const double dx = at->x - other.c.x;
          if (k == left_behind || dx * dx >= reach * reach) continue;
          const double top = other.c.y + std::sqrt(reach * reach - dx * dx);
          if (top <= at->y && top > y) {
            y = top;
            hit = k;
          }
        }
      }
    }
    at->y = y;
    return hit;
  }

  /// On the floor, rolling towards `direction`: the first disc or wall in the way.
  Resting RollOnFloor(double r, Vec2 at, double direction) const {
    Resting rest{at, kFloor, direction < 0 ? kLeftWall : kRightWall};
    rest.c = {direction < 0 ? r : width_ - r, r};
    // A disc that it meets lies in the two lowest rows of cells.
    ForDiscs({std::min(at.x, rest.c.x) - kCell, 0}, {std::max(at.x, rest.c.x) + kCell, 1.5 * kCell}, [&](int k) {
      const Disc& other = discs_[Idx(k)];
      const double reach = r + other.r;
      const double dy = other.c.y - r;
      if (direction * (other.c.x - at.x) < 0 || dy * dy >= reach * reach) return;
      const double x = other.c.x - direction * std::sqrt(reach * reach - dy * dy);
      if (direction * (rest.c.x - x) <= 0) return;
      rest.c.x = x;
      rest.support2 = k;
    });
    return rest;
  }

  /// Rolls down over disc `pivot` and whatever it meets on the way. Returns kNothing with *rest filled where it comes
  /// to rest on two supports, else the disc at whose side it leaves, falling from *at.
  int RollOver(double r, int pivot, double direction, Vec2* at, Resting* rest) const {
    int previous = kNothing;
    for (int step = 0; step < kMaxSteps; ++step) {
      const Disc& over = discs_[Idx(pivot)];
      const double reach = r + over.r;
      Vec2 next{over.c.x + direction * reach, over.c.y};
      int hit = kNothing;
      // On the way down both x and y are monotonic: the first obstacle is the highest.
      const auto consider = [&](Vec2 p, int k) {
        if (direction * (p.x - over.c.x) <= 0 || p.y >= at->y || p.y < next.y) return;
        next = p;
        hit = k;
      };
      if (r > over.c.y) {
        const double dy = r - over.c.y;
        if (dy < reach) consider({over.c.x + direction * std::sqrt(reach * reach - dy * dy), r}, kFloor);
      }
      const double wall_x = direction < 0 ? r : width_ - r;
      const double wall_dx = direction * (wall_x - over.c.x);
      if (wall_dx >= 0 && wall_dx < reach) {
        consider({wall_x, over.c.y + std::sqrt(reach * reach - wall_dx * wall_dx)},
                 direction < 0 ? kLeftWall : kRightWall);
      }
      const double around = reach + r + kRadius.high;
      ForDiscs(over.c - Vec2{around, around}, over.c + Vec2{around, around}, [&](int k) {
        if (k == pivot || k == previous) return;
        const Disc& other = discs_[Idx(k)];
        const double other_reach = r + other.r;
        const double distance = Norm(other.c - over.c);
        if (distance >= reach + other_reach || distance + other_reach <= reach) return;
        const CircleMeeting meeting = MeetingOf(over.c, reach, other.c, other_reach);
        if (meeting.square <= 0) return;
        consider(meeting.Left(), k);
        consider(meeting.Right(), k);
      });
      *at = next;
      if (hit == kNothing) return pivot;
      const bool blocked = hit < 0 || direction * (discs_[Idx(hit)].c.x - next.x) >= 0;
      if (blocked) {
        *rest = {next, pivot, hit};
        return kNothing;
      }
      previous = pivot;
      pivot = hit;
    }
    return pivot;
  }

  /// The place if it is clear of everything but its two supports.
  std::optional<Resting> Accept(double r, const Resting& rest) const {
    const auto supports = [&rest](int k) { return rest.support1 == k || rest.support2 == k; };
    const double clear = kClearance * kRadius.low;
    if (!supports(kFloor) && rest.c.y - r < clear) return std::nullopt;
    if (!supports(kLeftWall) && rest.c.x - r < clear) return std::nullopt;
    if (!supports(kRightWall) && width_ - r - rest.c.x < clear) return std::nullopt;
    bool free = true;
    const double around = r + kRadius.high + clear;
    ForDiscs(rest.c - Vec2{around, around}, rest.c + Vec2{around, around}, [&](int k) {
      const Disc& other = discs_[Idx(k)];
      if (!supports(k) && Norm(rest.c - other.c) - r - other.r < clear) free = false;
    });
    if (!free) return std::nullopt;
    return rest;
  }

  double width_;
  std::vector<Disc> discs_;
  /// columns_[x cell][y cell] lists discs by their centres.
  std::vector<std::vector<std::vector<int>>> columns_;
};

/// The first body is the box.
class PileScene final : public SceneBuilder {
 public:
  using SceneBuilder::SceneBuilder;

  void Build() override {
    const int count = rows_ / 2;
    width_ = (kRadius.low + kRadius.high) * std::max(3.0, kBoxAspect * std::sqrt(static_cast<double>(count)));
    Pile pile(width_);
    AddFixed("box");

    Disc crest{{width_ / 2, 0}, 0};  // the highest disc; before the first, a point of the floor
    int crest_support = kFloor;
    constexpr int kMaxTries = 10000;
    for (int i = 0; i < count; ++i) {
      const double r = random_.Uniform(kRadius);
      std::optional<Resting> rest;
      for (int attempt = 0; !rest && attempt < kMaxTries; ++attempt) {
        const double direction = random_.Sign();
        rest = pile.Drop(r, random_.Uniform(r, width_ - r), direction);
      }
      if (!rest) throw std::logic_error("disc-pile: no place for disc " + std::to_string(i));
      const Disc disc{rest->c, r};
      pile.Add(disc);
      const int body = AddDisc(disc);
      Rest(body, rest->support1);
      Rest(body, rest->support2);
      if (disc.c.y + disc.r > crest.c.y + crest.r) {
        crest = disc;
        crest_support = i;
      }
    }
    if (rows_ % 2 == 1) {
      // Smaller than the disc that it stands on, so that it clears the walls.
      const double r = crest_support == kFloor ? kRadius.low : random_.Uniform(0.5, 0.9) * crest.r;
      crest = {crest.c + Vec2{0, crest.r + r}, r};
      Rest(AddDisc(crest), crest_support);
    }
    const double height = crest.c.y + crest.r;
    Get(0).outline = Polyline({{width_, height}, {width_, 0}, {}, {0, height}});
  }

  void Load() override {
    const int pairs = rows_ / 2;
    const double layers = std::sqrt(1.0 + pairs);
    Apply({.weight = kWeight / std::sqrt(layers), .gust = kGravity});
  }

  void Launch(World* world) override { Stir(world, kStir, seed_); }

 private:
  int AddDisc(const Disc& disc) {
    // Densities from 20 to 320: with the radii, masses spread over a factor 100.
    // One draw per statement: within an expression the order of evaluation is the compiler's choice, and with it the
    // bits.
    const double share = random_.Uniform(1, 2);
    const double density = 20 * share * static_cast<double>(1 << random_.Integer(4));
    Body body = MakeDisc(disc.c, disc.r, density);
    // Nothing depends on a disc's angle; a nonzero one exercises the frames.
    body.theta = random_.Uniform(-kPi, kPi);
    return Add("disc", std::move(body));
  }

  void Rest(int body, int support) {
    if (support >= 0) {
      Touch(body, support + 1);
    } else {
      Touch(body, 0, Side(support));
    }
  }

  StraightEdge Side(int support) const {
    if (support == kFloor) return {{width_, 0}, {}};
    if (support == kLeftWall) return {{}, {0, 1}};
    return {{width_, 1}, {width_, 0}};
  }

  double width_ = 0;
};

}  // namespace

extern const SceneFamily kDiscPile{
    "disc-pile", "Pile of discs of many sizes and masses in a box",
    "Isostatic, masses spread by up to a factor 100: A is nonsingular but ill-conditioned, which tells "
    "methods whose speed depends on conditioning from direct ones.",
    &Make<PileScene>};

}  // namespace lcpbench
