#include "tests/solvers/friction/friction_suite.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "tests/solvers/test_problems.h"

namespace lcpbench {
namespace {

using Point = Eigen::Vector2d;

constexpr double kGravity = 9.81;
constexpr double kStep = 0.01;

// Bodies and rows of one time step; body -1 is the ground.
class World {
 public:
  int Body(Point at, double mass, double inertia, Eigen::Vector3d velocity = Eigen::Vector3d::Zero()) {
    at_.push_back(at);
    for (const double m : {mass, mass, inertia}) inverse_mass_.push_back(1 / m);
    velocity_.push_back(velocity);
    force_.emplace_back(0, -kGravity * mass);
    return static_cast<int>(at_.size()) - 1;
  }
  int Box(Point at, double width, double height, double density = 1) {
    const double m = density * width * height;
    return Body(at, m, m * (width * width + height * height) / 12);
  }
  int Disc(Point at, double radius, Eigen::Vector3d velocity = Eigen::Vector3d::Zero()) {
    const double m = std::numbers::pi * radius * radius;
    return Body(at, m, m * radius * radius / 2, velocity);
  }
  double mass(int body) const { return 1 / inverse_mass_[static_cast<size_t>(3 * body)]; }
  void Push(int body, Point force) { force_[static_cast<size_t>(body)] += force; }

  // The normal points from body 2 to body 1.
  void Contact(int body1, int body2, Point at, Point normal, double mu, double gap = 0) {
    normal.normalize();
    AddRow(body1, body2, at, normal, gap / kStep);
    const Index row = rows_ - 1;
    AddRow(body1, body2, at, {-normal.y(), normal.x()}, 0);
    bounds_.friction.push_back({row + 1, row, mu});
  }
  void Pin(int body1, int body2, Point at) {
    for (const Point& axis : {Point(1, 0), Point(0, 1)}) {
      AddRow(body1, body2, at, axis, 0);
      bilateral_.push_back(rows_ - 1);
    }
  }
  Index contacts() const { return static_cast<Index>(bounds_.friction.size()); }

  LcpProblem Problem(const std::string& id) const {
    const SparseMatrix J = MatrixOf(rows_, static_cast<Index>(inverse_mass_.size()), entries_);
    const Eigen::VectorXd W =
        Eigen::Map<const Eigen::VectorXd>(inverse_mass_.data(), static_cast<Index>(inverse_mass_.size()));
    Eigen::VectorXd v(W.size());
    for (size_t k = 0; k < at_.size(); ++k) {
      v.segment<3>(static_cast<Index>(3 * k)) = velocity_[k];
      v.segment<2>(static_cast<Index>(3 * k)) += kStep * inverse_mass_[3 * k] * force_[k];
    }
    const Eigen::VectorXd b = J * v + Eigen::Map<const Eigen::VectorXd>(c_.data(), rows_);
    RowBounds bounds = RowBounds::WithBilateralRows(rows_, bilateral_);
    bounds.friction = bounds_.friction;
    return LcpProblem::FromFactors(id, J, W, b, bounds);
  }

 private:
  void AddRow(int body1, int body2, Point at, Point axis, double c) {
    for (const auto& [body, sign] : {std::pair(body1, 1.0), std::pair(body2, -1.0)}) {
      if (body < 0) continue;
      const Point arm = at - at_[static_cast<size_t>(body)];
      const double turn = arm.x() * axis.y() - arm.y() * axis.x();
      int column = 3 * body;
      for (const double entry : {axis.x(), axis.y(), turn}) {
        if (entry != 0) entries_.emplace_back(static_cast<int>(rows_), column, sign * entry);
        ++column;
      }
    }
    c_.push_back(c);
    ++rows_;
  }

  std::vector<Point> at_, force_;
  std::vector<Eigen::Vector3d> velocity_;
  std::vector<double> inverse_mass_, c_;
  Triplets entries_;
  std::vector<Index> bilateral_;
  RowBounds bounds_;
  Index rows_ = 0;
};

class Suite {
 public:
  Suite(unsigned seed, Index most) : random_(seed), most_(most) {}

  std::vector<LcpProblem> Make() {
    for (const double mu : {0.1, 0.3, 0.6, 1.0}) {
      mu_ = mu;
      for (const int k : {1, 2, 5, 10, 20, 50, 100, 250, 1000}) {
        Stack(k, 0, 0);
        Stack(k, 0.4, 0);
        Stack(k, 0, 1);
        Ramp(k);
      }
      for (const auto& [columns, rows] :
           {std::pair(2, 2), {3, 3}, {4, 5}, {6, 6}, {8, 7}, {15, 15}, {25, 25}, {35, 35}}) {
        Wall(columns, rows, 0);
        Wall(columns, rows, 2);
      }
      for (const int k : {2, 5, 10, 25, 50, 100, 250, 1000, 2000}) {
        Pile(k, 0.1);
        Pile(k, 3);
      }
      for (const int layers : {1, 2, 4, 8, 16}) Wedge(layers);
      for (const int k : {3, 5, 9, 15, 31, 61, 99, 249, 999}) {
        Arch(k, 0);
        Arch(k, 3);
      }
      for (const int levels : {1, 2, 3, 5, 7, 15, 30}) CardHouse(levels);
      for (const int k : {1, 3, 10, 30, 100, 300, 1000}) {
        Chain(k, 2);
        Chain(k, 0.7);
      }
      for (const int k : {1, 3, 10, 40, 250, 1000}) Rods(k);
    }
    return std::move(problems_);
  }

 private:
  double Uniform(double from, double to) { return std::uniform_real_distribution<>(from, to)(random_); }
  double Normal() { return std::normal_distribution<>()(random_); }
  Eigen::Vector3d Velocity(double size) { return size * Eigen::Vector3d(Normal(), Normal(), Normal()); }
  void Add(const World& world, const std::string& name) {
    if (world.contacts() <= most_) problems_.push_back(world.Problem(name + "-" + std::to_string(mu_).substr(0, 3)));
  }

  void Stack(int k, double angle, double pull) {
    World world;
    const Eigen::Rotation2D<double> turn(-angle);
    for (int i = 0; i < k; ++i) {
      const int body = world.Box(turn * Point(0, i + 0.5), 1, 1, std::exp(0.3 * Normal()));
      if (i == k / 2) world.Push(body, turn * Point(pull * kGravity * world.mass(body), 0));
      for (const double x : {-0.5, 0.5}) world.Contact(body, body - 1, turn * Point(x, i), turn * Point(0, 1), mu_);
    }
    Add(world, "stack-" + std::to_string(k) + (angle > 0 ? "-slope" : pull > 0 ? "-pulled" : ""));
  }

  void Ramp(int k) {
    World world;
    const Eigen::Rotation2D<double> turn(-0.3);
    const Point down = turn * Point(1, 0);
    for (int i = 0; i < k; ++i) {
      const Point v = Uniform(-0.2, 0.2) * down;
      const int body = world.Disc(turn * Point(i, 0.5), 0.5, {v.x(), v.y(), Uniform(-1, 1)});
      world.Contact(body, -1, turn * Point(i, 0), turn * Point(0, 1), mu_);
      if (i > 0) world.Contact(body, body - 1, turn * Point(i - 0.5, 0.5), down, mu_);
    }
    Add(world, "ramp-" + std::to_string(k));
  }

  void Wall(int columns, int rows, double push) {
    World world;
    std::vector<std::vector<int>> bricks;
    for (int r = 0; r < rows; ++r) {
      const int shift = r % 2;
      bricks.emplace_back();
      for (int c = 0; c < columns - shift; ++c) {
        const Point at(2 * c + shift, r + 0.5);
        const int body = world.Box(at, 2, 1, std::exp(0.3 * Normal()));
        bricks.back().push_back(body);
        if (r == rows - 1 && c == 0) world.Push(body, {push * kGravity * world.mass(body), 0});
        for (const double x : {-1.0, 0.0, 0.0, 1.0}) {
          if (r == 0 && x == 0) continue;
          const bool is_left = x < 0 || (x == 0 && ++half_ % 2 == 1);
          const int below = c - (shift == 0 ? 1 : 0) + (is_left ? 0 : 1);
          if (r > 0 && (below < 0 || below >= static_cast<int>(bricks[static_cast<size_t>(r - 1)].size()))) continue;
          const int support = r == 0 ? -1 : bricks[static_cast<size_t>(r - 1)][static_cast<size_t>(below)];
          world.Contact(body, support, {at.x() + x, static_cast<double>(r)}, {0, 1}, mu_);
        }
      }
    }
    Add(world, "wall-" + std::to_string(columns) + "x" + std::to_string(rows) + (push > 0 ? "-pushed" : ""));
  }

  // Discs in rows, each upon two of the row below, between walls; slightly different radii would leave gaps, which are
  // told as such.
  void Pile(int k, double speed) {
    World world;
    const int width = std::max(2, static_cast<int>(std::sqrt(k)));
    const double height = std::sqrt(3) / 2;
    std::vector<std::pair<int, Point>> below, row;
    for (int made = 0, level = 0; made < k; ++level) {
      const int count = std::min(k - made, width - level % 2);
      row.clear();
      for (int c = 0; c < count; ++c, ++made) {
        const Point at(c + 0.5 * (level % 2), 0.5 + height * level);
        const int body = world.Disc(at, 0.5, Velocity(speed));
        if (level == 0) world.Contact(body, -1, at - Point(0, 0.5), {0, 1}, mu_);
        for (const auto& [other, place] : below) {
          if ((at - place).norm() < 1 + 1e-9) world.Contact(body, other, (at + place) / 2, at - place, mu_);
        }
        if (c > 0 && Uniform(0, 1) < 0.5) {
          world.Contact(body, row.back().first, at - Point(0.5, 0), {1, 0}, mu_, Uniform(0, 1e-3));
        }
        if (c == 0 && level % 2 == 0) world.Contact(body, -1, at - Point(0.5, 0), {1, 0}, mu_);
        if (c + 1 == width && level % 2 == 0) world.Contact(body, -1, at + Point(0.5, 0), {-1, 0}, mu_);
        row.emplace_back(body, at);
      }
      below = row;
    }
    Add(world, (speed > 1 ? "drum-" : "pile-") + std::to_string(k));
  }

  // Discs that grow upwards between two walls.
  void Wedge(int layers) {
    World world;
    const double angle = 0.3, ratio = (1 + std::sin(angle)) / (1 - std::sin(angle));
    double radius = 0.5, y = 0.5 / std::sin(angle);
    for (int k = 0; k < layers; ++k) {
      const double m = std::numbers::pi * radius * radius / std::pow(ratio, 2 * k);
      const int body = world.Body({0, y}, m, m * radius * radius / 2, Velocity(0.3));
      for (const double side : {1.0, -1.0}) {
        const Point normal(side * std::cos(angle), std::sin(angle));
        world.Contact(body, -1, Point(0, y) - radius * normal, normal, mu_);
      }
      if (k > 0) world.Contact(body, body - 1, {0, y - radius}, {0, 1}, mu_);
      y += radius * (1 + ratio);
      radius *= ratio;
    }
    Add(world, "wedge-" + std::to_string(layers));
  }

  void Arch(int k, double load) {
    World world;
    const double inner = 1, outer = 1.3, turn = std::numbers::pi / k;
    const double area = 0.5 * (outer * outer - inner * inner) * turn;
    const double centre = 2.0 / 3 * (std::pow(outer, 3) - std::pow(inner, 3)) / (outer * outer - inner * inner) *
                          std::sin(turn / 2) / (turn / 2);
    for (int i = 0; i < k; ++i) {
      const double a = (i + 0.5) * turn;
      world.Body(centre * Point(std::cos(a), std::sin(a)), area,
                 area * ((outer * outer + inner * inner) / 2 - centre * centre));
      if (i == k / 3) world.Push(i, {0, -load * kGravity * area});
    }
    for (int i = 0; i <= k; ++i) {
      const Point radial(std::cos(i * turn), std::sin(i * turn)), along(-radial.y(), radial.x());
      for (const double r : {inner, outer}) world.Contact(i < k ? i : -1, i - 1, r * radial, along, mu_);
    }
    Add(world, "arch-" + std::to_string(k) + (load > 0 ? "-loaded" : ""));
  }

  // Tents of leaning cards, plates between the levels.
  void CardHouse(int levels) {
    World world;
    const double lean = 0.35, height = std::cos(lean), half = std::sin(lean), mass = 0.1;
    std::vector<std::array<int, 2>> tents;
    std::vector<int> plates;  // of the level below, between tents k and k + 1
    for (int level = 0; level < levels; ++level) {
      tents.clear();
      std::vector<int> next;
      for (int k = 0; k < levels - level; ++k) {
        const Point foot((level + 1) * half + 2 * half * k, level * height);
        std::array<int, 2> cards{};
        for (const int side : {0, 1}) {
          const double sign = 2 * side - 1;
          cards[static_cast<size_t>(side)] = world.Body(foot + Point(sign * half / 2, height / 2), mass, mass / 12);
          const int support = level == 0 ? -1 : plates[static_cast<size_t>(k)];
          world.Contact(cards[static_cast<size_t>(side)], support, foot + Point(sign * half, 0), {0, 1}, mu_);
        }
        world.Contact(cards[1], cards[0], foot + Point(0, height), {1, 0}, mu_);
        tents.push_back(cards);
        if (k == 0) continue;
        const int plate = world.Body(foot + Point(-half, height), mass, mass * half * half / 3);
        world.Contact(plate, tents[static_cast<size_t>(k - 1)][1], foot + Point(-2 * half, height), {0, 1}, mu_);
        world.Contact(plate, cards[0], foot + Point(0, height), {0, 1}, mu_);
        next.push_back(plate);
      }
      plates = next;
    }
    Add(world, "card-house-" + std::to_string(levels));
  }

  void Chain(int k, double pull) {
    World world;
    double weight = 0;
    for (int i = 0; i < k; ++i) {
      const int body = world.Box({1.5 * i, 0.5}, 1, 1, std::exp(0.5 * Normal()));
      weight += kGravity * world.mass(body);
      for (const double x : {-0.5, 0.5}) world.Contact(body, -1, {1.5 * i + x, 0}, {0, 1}, mu_);
      if (i > 0) world.Pin(body, body - 1, {1.5 * i - 0.75, 0.5});
    }
    world.Push(0, {-pull * weight * mu_, 0});
    Add(world, "chain-" + std::to_string(k) + (pull > 1 ? "-pulled" : ""));
  }

  void Rods(int k) {
    World world;
    for (int i = 0; i < k; ++i) {
      const double angle = Uniform(0.2, 1.3);
      const Point centre(3 * i, std::sin(angle));
      const int body = world.Body(centre, 1, 1.0 / 3, Velocity(2));
      world.Contact(body, -1, centre - Point(std::cos(angle), std::sin(angle)), {0, 1}, mu_);
      if (i > 0 && Uniform(0, 1) < 0.7) {
        world.Contact(body, body - 1, centre - Point(1, 0), {1, 0.3 * Normal()}, mu_);
      }
    }
    Add(world, "rods-" + std::to_string(k));
  }

  std::mt19937 random_;
  const Index most_;
  double mu_ = 0;
  int half_ = 0;
  std::vector<LcpProblem> problems_;
};

}  // namespace

std::vector<LcpProblem> StructuredFrictionProblems(unsigned seed, Index most_contacts) {
  return Suite(seed, most_contacts).Make();
}

LcpProblem RandomFrictionProblem(unsigned seed, Index most_contacts) {
  std::mt19937 random(seed);
  const auto uniform = [&](double from, double to) { return std::uniform_real_distribution<>(from, to)(random); };
  const auto pick = [&](int count) { return std::uniform_int_distribution<>(0, count - 1)(random); };
  World world;
  const int contacts = 1 + pick(static_cast<int>(most_contacts));
  const int bodies = 1 + pick(contacts);
  std::vector<Point> at;
  for (int k = 0; k < bodies; ++k) {
    at.emplace_back(uniform(-2, 2), uniform(-2, 2));
    const double mass = std::pow(10, uniform(-2, 2));
    world.Body(at.back(), mass, mass * uniform(0.1, 1), {uniform(-1, 1), uniform(-1, 1), uniform(-1, 1)});
  }
  const double most_mu = std::pow(10, uniform(-1, 0.7));
  for (int k = 0; k < contacts; ++k) {
    const int one = pick(bodies), other = pick(bodies + 1) - 1;
    const double angle = uniform(0, 2 * std::numbers::pi);
    const Point place = at[static_cast<size_t>(one)] + Point(uniform(-1, 1), uniform(-1, 1));
    world.Contact(one, other == one ? -1 : other, place, {std::cos(angle), std::sin(angle)}, uniform(0, most_mu),
                  uniform(0, 1) < 0.7 ? 0 : uniform(0, 0.01));
  }
  if (bodies > 2 && pick(4) == 0) world.Pin(0, 1, (at[0] + at[1]) / 2);
  return world.Problem("random-" + std::to_string(seed));
}

}  // namespace lcpbench
