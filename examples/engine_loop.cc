// A small planar engine on StepSolver: loaded discs, whose centre of mass is beside their centre, fall into a round
// bowl. Without friction, and without bounce.
//
// Each step of h seconds takes what StepSolver asks for from the bodies as they are (Stewart and Trinkle 1996):
//     v^ = v + h g,   w = J M^-1 J^T p + b,   b = J v^ + gap / h,   0 <= p perp w >= 0,
//     v  = v^ + M^-1 J^T p,   x = x + h v
// with p the impulses [N s], and h w the gaps after the step to first order. A step undoes kMostUndone of a depth at
// most. Each contact starts from its impulse of the step before.
//
// Prints a line a second, first with warm starts and then without: they save most of the pivots.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <vector>

#include "solvers/step/step_solver.h"

constexpr double kStep = 1.0 / 240, kGravity = -9.81;  // [s], [m/s^2]
constexpr double kBowl = 3;                            // radius of the bowl about the origin [m]
constexpr double kMostUndone = 3e-3;                   // [m], a hundredth of the smallest disc's width

struct Disc {
  double radius, mass, inertia;  // inertia about the centre of mass
  double offset;                 // from the centre of mass to the disc's centre, along the body's x axis [m]
  double x, y, angle = 0;        // of the centre of mass
  double v[3] = {0, 0, 0};       // x, y, rotation

  double CentreX() const { return x + offset * std::cos(angle); }
  double CentreY() const { return y + offset * std::sin(angle); }
  // No point of the disc is faster.
  double Speed() const { return std::hypot(v[0], v[1]) + std::abs(v[2]) * (radius + offset); }
};

class Engine {
 public:
  Engine(const std::vector<Disc>& bodies, bool warm_start)
      : discs(bodies), warm_start_(warm_start), impulse_of_(bodies.size() * bodies.size()) {
    const auto count = static_cast<lcpbench::Index>(bodies.size());
    solver_.Reserve(8 * count, count);
    for (const Disc& disc : bodies) {
      inverse_mass_.insert(inverse_mass_.end(), {1 / disc.mass, 1 / disc.mass, 1 / disc.inertia});
    }
  }

  // False where the step's problem was not solved.
  bool Step() {
    for (Disc& disc : discs) disc.v[1] += kStep * kGravity;
    FindContacts();
    const bool is_solved = contacts == 0 || Solve();
    for (Disc& disc : discs) {
      disc.x += kStep * disc.v[0];
      disc.y += kStep * disc.v[1];
      disc.angle += kStep * disc.v[2];
    }
    return is_solved;
  }

  double Energy() const {
    double energy = 0;
    for (const Disc& disc : discs) {
      energy += disc.mass * (disc.v[0] * disc.v[0] + disc.v[1] * disc.v[1]) / 2 - disc.mass * kGravity * disc.y +
                disc.inertia * disc.v[2] * disc.v[2] / 2;
    }
    return energy;
  }

  std::vector<Disc> discs;
  std::size_t contacts = 0;    // of the last step
  double deepest = 0;          // overlap so far [m]
  std::int64_t solves = 0;     // so far
  std::int64_t warm_rows = 0;  // of these, with an impulse to start from
  std::int64_t pivots = 0;

 private:
  // Every pair is looked at: a larger engine has a broad phase here.
  void FindContacts() {
    body_.clear(), J_.clear(), b_.clear();
    double reach = 0;  // two discs approach by less in a step, also where impulses make them faster
    for (const Disc& disc : discs) reach = std::max(reach, 3 * kStep * disc.Speed());
    for (std::size_t i = 0; i < discs.size(); ++i) {
      const double x = discs[i].CentreX(), y = discs[i].CentreY(), distance = std::hypot(x, y);
      const double gap = kBowl - distance - discs[i].radius;
      if (gap < reach) AddContact(i, i, -x / distance, -y / distance, gap);
      for (std::size_t j = 0; j < i; ++j) {
        const double dx = x - discs[j].CentreX(), dy = y - discs[j].CentreY(), apart = std::hypot(dx, dy);
        const double between = apart - discs[i].radius - discs[j].radius;
        if (between < reach) AddContact(i, j, dx / apart, dy / apart, between);
      }
    }
    contacts = b_.size();
  }

  // The unit normal (nx, ny) points to disc i, from disc j or, where j is i, from the bowl.
  void AddContact(std::size_t i, std::size_t j, double nx, double ny, double gap) {
    const bool is_bowl = i == j;
    deepest = std::max(deepest, -gap);
    double w = std::max(gap, -kMostUndone) / kStep;
    body_.insert(body_.end(), {static_cast<std::int32_t>(i), is_bowl ? -1 : static_cast<std::int32_t>(j)});
    for (const double side : {1.0, -1.0}) {
      const Disc& disc = side > 0 ? discs[i] : discs[j];
      // The contact lies on the line through the disc's centre along n, so that the arm is the offset.
      const double arm = disc.offset * (std::cos(disc.angle) * ny - std::sin(disc.angle) * nx);
      for (double number : {side * nx, side * ny, side * arm}) {
        if (side < 0 && is_bowl) number = 0;
        w += number * disc.v[J_.size() % 3];
        J_.push_back(number);
      }
    }
    b_.push_back(w);
  }

  bool Solve() {
    start_.resize(contacts);
    f_.resize(contacts);
    for (std::size_t k = 0; k < contacts; ++k) {
      start_[k] = ImpulseOf(k);
      warm_rows += warm_start_ && start_[k] > 0 ? 1 : 0;
    }
    lcpbench::StepRows rows;
    rows.rows = static_cast<lcpbench::Index>(contacts);
    rows.bodies = static_cast<lcpbench::Index>(discs.size());
    rows.body = body_.data();
    rows.J = J_.data();
    rows.b = b_.data();
    rows.inverse_mass = inverse_mass_.data();
    const lcpbench::StepAnswer answer = solver_.Solve(rows, warm_start_ ? start_.data() : nullptr, f_.data());
    ++solves;
    pivots += answer.iterations;
    std::fill(impulse_of_.begin(), impulse_of_.end(), 0);  // contacts that opened start from 0 when they close again
    for (std::size_t k = 0; k < contacts; ++k) {
      ImpulseOf(k) = f_[k];
      for (std::size_t side = 0; side < 2; ++side) {
        if (body_[2 * k + side] < 0) continue;
        const auto body = static_cast<std::size_t>(body_[2 * k + side]);
        for (std::size_t c = 0; c < 3; ++c) {
          discs[body].v[c] += inverse_mass_[3 * body + c] * J_[6 * k + 3 * side + c] * f_[k];
        }
      }
    }
    return answer.status == lcpbench::LcpStatus::kSolved;
  }

  // By the pair of bodies; the bowl's contact of disc i stands at (i, i).
  double& ImpulseOf(std::size_t contact) {
    const auto i = static_cast<std::size_t>(body_[2 * contact]);
    const std::size_t j = body_[2 * contact + 1] < 0 ? i : static_cast<std::size_t>(body_[2 * contact + 1]);
    return impulse_of_[i * discs.size() + j];
  }

  bool warm_start_;
  lcpbench::StepSolver solver_;
  std::vector<std::int32_t> body_;
  std::vector<double> J_, b_, f_, start_, inverse_mass_, impulse_of_;
};

// `count` discs in rows of five, a little apart, light and heavy ones by turns.
std::vector<Disc> DropDiscs(int count) {
  std::vector<Disc> discs;
  for (int k = 0; k < count; ++k) {
    Disc disc{.radius = 0.15 + 0.02 * (k % 4), .mass = 1.0 + k % 3, .inertia = 0, .offset = 0.05, .x = 0, .y = 0};
    disc.inertia = disc.mass * (disc.radius * disc.radius / 2 - disc.offset * disc.offset);
    disc.angle = k;
    disc.x = 0.5 * (k % 5 - 2) + 0.01 * (k % 7) - disc.offset * std::cos(disc.angle);
    disc.y = -1 + 0.5 * (k / 5) - disc.offset * std::sin(disc.angle);
    discs.push_back(disc);
  }
  return discs;
}

int main() {
  constexpr int kSeconds = 5, kDiscs = 30;
  bool holds = true;
  for (const bool warm_start : {true, false}) {
    Engine engine(DropDiscs(kDiscs), warm_start);
    std::printf("%s starts\n  time  contacts  deepest overlap  energy    solves  pivots  rows started warm\n",
                warm_start ? "warm" : "cold");
    for (int second = 1; second <= kSeconds; ++second) {
      const double before = engine.Energy();
      for (int k = 0; k < static_cast<int>(1 / kStep); ++k) holds = engine.Step() && holds;
      holds = holds && engine.Energy() < before && engine.deepest < kMostUndone;
      std::printf("  %d s   %8zu  %12.2g mm  %7.2f J  %6lld  %6lld  %17lld\n", second, engine.contacts,
                  1e3 * engine.deepest, engine.Energy(), static_cast<long long>(engine.solves),
                  static_cast<long long>(engine.pivots), static_cast<long long>(engine.warm_rows));
    }
  }
  return holds ? 0 : 1;
}
