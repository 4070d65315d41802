// disc-pile: discs of many sizes and masses, dropped one after the other into a box.
//
// An odd count is closed by a disc that stands on the crest of the pile: one row.
//
// In motion: upright, every body stirred a little (scene_builder.h), settling.

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <vector>

#include "model/scenes/scene_builder.h"

namespace lcpbench {
namespace {

constexpr double kMinRadius = 0.06;
constexpr double kMaxRadius = 0.15;
/// In-plane gravity times the square root of the number of layers [m/s^2]: an inclined plane, on which weights do not
/// outgrow the random gusts as the pile gets higher.
constexpr double kWeight = 0.2 * kGravity;
/// Width of the box over that of a square which holds the discs side by side.
constexpr double kBoxAspect = 1.2;
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
  static constexpr double kCell = 2 * kMaxRadius;
  static constexpr int kMaxSteps = 1000;

  static std::size_t Idx(int i) { return static_cast<std::size_t>(i); }
  std::size_t ColumnOf(double x) const {
    return std::min(static_cast<std::size_t>(std::max(0.0, x) / kCell), columns_.size() - 1);
  }
  static std::size_t RowOf(double y) { return static_cast<std::size_t>(std::max(0.0, y) / kCell); }

  /// Calls visit(k) for every disc whose centre is within `reach` of c in x and y (and some more).
  template <typename Visit>
  void ForNeighbours(Vec2 c, double reach, Visit visit) const {
    const std::size_t last_column = ColumnOf(c.x + reach);
    const std::size_t first_row = RowOf(c.y - reach);
    const std::size_t last_row = RowOf(c.y + reach);
    for (std::size_t column = ColumnOf(c.x - reach); column <= last_column; ++column) {
      const auto& cells = columns_[column];
      for (std::size_t row = first_row; row <= last_row && row < cells.size(); ++row) {
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
        if (static_cast<double>(row + 1) * kCell + kMaxRadius + r < y) break;
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
    const auto column_count = columns_.size();
    for (std::size_t column = ColumnOf(at.x - direction * kCell); column < column_count;
         direction < 0 ? --column : ++column) {
      const auto& cells = columns_[column];
      for (std::size_t row = 0; row < std::min<std::size_t>(2, cells.size()); ++row) {
        for (const int k : cells[row]) {
          const Disc& other = discs_[Idx(k)];
          const double reach = r + other.r;
          const double dy = other.c.y - r;
          if (direction * (other.c.x - at.x) < 0 || dy * dy >= reach * reach) continue;
          const double x = other.c.x - direction * std::sqrt(reach * reach - dy * dy);
          if (direction * (rest.c.x - x) > 0) {
            rest.c.x = x;
            rest.support2 = k;
          }
        }
      }
      // A hit in this column or the next ends the search: later columns lie behind it.
      if (direction * (static_cast<double>(column) * kCell - rest.c.x) > 2 * kCell) break;
    }
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
      ForNeighbours(over.c, reach + r + kMaxRadius, [&](int k) {
        if (k == pivot || k == previous) return;
        const Disc& other = discs_[Idx(k)];
        const double other_reach = r + other.r;
        const Vec2 between = other.c - over.c;
        const double distance = Norm(between);
        if (distance >= reach + other_reach || distance + other_reach <= reach) return;
        // Circles of radius reach about the pivot and other_reach about the other disc.
        const double along = (reach * reach - other_reach * other_reach + distance * distance) / (2 * distance);
        const double square = reach * reach - along * along;
        if (square <= 0) return;
        const Vec2 unit = (1 / distance) * between;
        const Vec2 foot = over.c + along * unit;
        const Vec2 side = std::sqrt(square) * Perp(unit);
        consider(foot + side, k);
        consider(foot - side, k);
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
    const double clear = kClearance * kMinRadius;
    if (!supports(kFloor) && rest.c.y - r < clear) return std::nullopt;
    if (!supports(kLeftWall) && rest.c.x - r < clear) return std::nullopt;
    if (!supports(kRightWall) && width_ - r - rest.c.x < clear) return std::nullopt;
    bool free = true;
    ForNeighbours(rest.c, r + kMaxRadius + clear, [&](int k) {
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
    width_ = (kMinRadius + kMaxRadius) * std::max(3.0, kBoxAspect * std::sqrt(static_cast<double>(count)));
    Pile pile(width_);
    Add("box", MakeFixed("box"));

    Disc crest{{width_ / 2, 0}, 0};  // the highest disc; before the first, a point of the floor
    int crest_support = kFloor;
    constexpr int kMaxTries = 10000;
    for (int i = 0; i < count; ++i) {
      const double r = random_.Uniform(kMinRadius, kMaxRadius);
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
      const double r = crest_support == kFloor ? kMinRadius : random_.Uniform(0.5, 0.9) * crest.r;
      crest = {crest.c + Vec2{0, crest.r + r}, r};
      Rest(AddDisc(crest), crest_support);
    }
    const double height = crest.c.y + crest.r;
    Get(0).outline = {WholeEdge({width_, height}, {width_, 0}), WholeEdge({width_, 0}, {}), WholeEdge({}, {0, height})};
  }

  void Load() override {
    const int count = rows_ / 2;
    const double layers = std::sqrt(1.0 + count);
    ApplyLoads(&system_, {.weight = kWeight / std::sqrt(layers), .gust = kGravity}, &random_);
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
    radii_.push_back(disc.r);
    return Add("disc", std::move(body));
  }

  void Rest(int body, int support) {
    if (support >= 0) {
      Touch(body, Circle(Radius(body)), support + 1, Circle(Radius(support + 1)));
    } else {
      Touch(body, Circle(Radius(body)), 0, Side(support));
    }
  }

  double Radius(int body) const { return radii_[static_cast<std::size_t>(body) - 1]; }
  StraightEdge Side(int support) const {
    if (support == kFloor) return {{width_, 0}, {}};
    if (support == kLeftWall) return {{}, {0, 1}};
    return {{width_, 1}, {width_, 0}};
  }

  double width_ = 0;
  std::vector<double> radii_;
};

}  // namespace

extern const SceneFamily kDiscPile{
    "disc-pile",
    "Pile of discs of many sizes and masses in a box",
    "Isostatic, masses spread by up to a factor 100: A is nonsingular but ill-conditioned, which tells "
    "methods whose speed depends on conditioning from direct ones.",
    &Make<PileScene>,
    MotionLevel::kVelocity,
    1e-3};

}  // namespace lcpbench
