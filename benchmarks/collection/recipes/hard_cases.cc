#include "benchmarks/collection/recipes/hard_cases.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "model/scenes/parts.h"
#include "model/scenes/random.h"

namespace lcpbench {
namespace {

// Lines of discs with all centres on y = 0: normals are (1, 0) and rows of J +-1 exactly. Radii and accelerations are
// multiples of 1/16 and masses powers of two, so that centres and b are exact sums.
constexpr double kGrain = 0x1p-4;

class Line {
 public:
  Line(std::string_view key, int rows, std::uint64_t seed) : random_(seed), system_(EmptyScene(key, rows, seed)) {}

  /// A fixed wall whose face is where the line ends, the line's first body or its last.
  void AddWall(double acceleration) {
    Body wall = MakeFixed(last_ < 0 ? "left wall" : "right wall");
    wall.x = {end_, 0};
    wall.acceleration = {acceleration, 0};
    // Material on the left of the edge: the left wall's face looks right, the right wall's left.
    const StraightEdge face = last_ < 0 ? StraightEdge{{0, -1}, {0, 1}} : StraightEdge{{0, 1}, {0, -1}};
    Append(AddBody(&system_, "wall", std::move(wall)), face, face);
  }

  /// A disc that touches the last body, under a random acceleration of up to `most` along the line [m/s^2].
  int AddDisc(double most) {
    const double radius = kGrain * (4 + random_.Integer(13));
    Body disc = MakeDisc({end_ + radius, 0}, radius, 1);
    disc.mass = std::ldexp(1, random_.Integer(6) - 3);
    disc.inertia = disc.mass * radius * radius / 2;
    const int grains = static_cast<int>(most / kGrain);
    disc.force = {disc.mass * kGrain * (random_.Integer(2 * grains + 1) - grains), 0};
    end_ += 2 * radius;
    const int body = AddBody(&system_, "disc", std::move(disc));
    Append(body, Circle(radius), Circle(radius));
    return body;
  }

  ContactSystem& system() { return system_; }
  double radius_of(int body) const { return end_ - system_.bodies[static_cast<size_t>(body)].x.x; }

 private:
  void Append(int body, const Feature& left_side, const Feature& right_side) {
    if (last_ >= 0) AddContact(&system_, body, left_side, last_, last_side_);
    last_ = body;
    last_side_ = right_side;
  }

  Random random_;
  ContactSystem system_;
  double end_ = 0;
  int last_ = -1;
  Feature last_side_;
};

// The accelerations of all contacts add up to the walls' closing one, < 0, whatever the forces are: (1, ..., 1) is the
// ray, and exact.
ContactSystem Squeezed(std::string_view key, int rows, std::uint64_t seed, double closing) {
  Line line(key, rows, seed);
  line.AddWall(0);
  // One disc at least: two walls face to face have no contact point.
  for (int k = 1; k < std::max(rows, 2); ++k) line.AddDisc(2);
  line.AddWall(-closing);
  return line.system();
}

// Discs on a floor, weighed down, and nothing that pushes them together: sideways f = w = 0, upright f > 0.
ContactSystem IdleLine(int rows, std::uint64_t seed) {
  Line line("idle-line", rows, seed);
  ContactSystem& system = line.system();
  const int floor = AddBody(&system, "floor", MakeFixed("floor"));
  int left = rows;
  bool first = true;
  while (left > 0) {
    const int disc = line.AddDisc(0);
    left -= first ? 0 : 1;
    first = false;
    if (left == 0) break;
    Body& body = system.bodies[static_cast<size_t>(disc)];
    const double radius = line.radius_of(disc);
    body.force = {0, -8 * body.mass};
    AddContact(&system, disc, Circle(radius), floor, StraightEdge{{1, -radius}, {-1, -radius}});
    --left;
  }
  return system;
}

// Two fixed bodies touch beside a line of discs: rows of zeros in J and A, w = b whatever f is; b = 0 on every other.
ContactSystem FixedPairs(int rows, std::uint64_t seed) {
  Line line("fixed-pairs", rows, seed);
  line.AddWall(0);
  const int zero_rows = rows / 2;
  for (int k = 0; k < rows - zero_rows; ++k) line.AddDisc(2);
  ContactSystem& system = line.system();
  for (int k = 0; k < zero_rows; ++k) {
    Body ball = MakeFixed("bolt");
    ball.x = {0, 2.0 + k};
    ball.acceleration = {0, k % 2 == 0 ? 0 : 0.5};
    Body plate = MakeFixed("plate");
    plate.x = {0, 1.5 + k};
    const int upper = AddBody(&system, "bolt", std::move(ball));
    const int lower = AddBody(&system, "plate", std::move(plate));
    AddContact(&system, upper, Circle(0.5), lower, StraightEdge{{1, 0}, {-1, 0}});
  }
  return system;
}

// A beam on more pins than it has degrees of freedom, all loads and arms dyadic: bilateral rows depend on each other,
// and agree exactly.
ContactSystem OverpinnedBeam(int rows, std::uint64_t seed) {
  Random random(seed);
  ContactSystem system = EmptyScene("overpinned-beam", rows, seed);
  const int ground = AddBody(&system, "ground", MakeFixed("ground"));
  Body box = MakeBox({}, 4, 0.5, 1);
  box.mass = 2;
  box.inertia = 4;
  box.force = {kGrain * random.Integer(33), -8};
  box.torque = kGrain * random.Integer(33);
  const int beam = AddBody(&system, "beam", std::move(box));
  // Two contacts beside, so that the pins carry loads that depend on them.
  for (const double x : {-2.0, 2.0}) {
    if (rows < 4) break;
    const int disc = AddBody(&system, "disc", MakeDisc({x, 0.5}, 0.25, 1));
    Body& body = system.bodies[static_cast<size_t>(disc)];
    body.mass = 1;
    body.force = {0, x < 0 ? -4.0 : 1.0};
    AddContact(&system, disc, Circle(0.25), beam, StraightEdge{{2.5, 0.25}, {-2.5, 0.25}});
  }
  const int pins = (rows - static_cast<int>(system.constraints.size())) / 2;
  for (int k = 0; k < pins; ++k) {
    const int from_middle = k - pins / 2;
    const Vec2 point{kGrain * from_middle, 0};
    Constraint pin;
    pin.type = ConstraintType::kPin;
    pin.body1 = beam;
    pin.body2 = ground;
    pin.feature1 = Vertex{point};
    pin.feature2 = Vertex{point};
    system.constraints.push_back(pin);
  }
  return system;
}

constexpr std::array kCases{
    HardCase{"squeezed-row",
             "Discs between closing walls: no forces exist, and methods without rays run on to a limit.",
             [](int rows, std::uint64_t seed) { return Squeezed("squeezed-row", rows, seed, 1); }},
    HardCase{"barely-squeezed-row",
             "The same by a billionth of the loads: a loose tolerance accepts a point of a problem that has none.",
             [](int rows, std::uint64_t seed) { return Squeezed("barely-squeezed-row", rows, seed, 0x1p-30); }},
    HardCase{"idle-line", "Contacts with f = w = 0 among loaded ones: strict complementarity fails, and pivots tie.",
             &IdleLine},
    HardCase{"fixed-pairs", "Rows of zeros in A, half of them with b = 0: division by the diagonal.", &FixedPairs},
    HardCase{"overpinned-beam",
             "Bilateral rows that depend on each other and agree: methods that factorise all joints at once.",
             &OverpinnedBeam},
};

}  // namespace

std::span<const HardCase> AllHardCases() { return kCases; }

}  // namespace lcpbench
