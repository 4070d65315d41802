#include "solvers/exact/polyhedron.h"

#include <algorithm>
#include <bitset>
#include <stdexcept>
#include <utility>

namespace lcpbench {
namespace {

Rational Dot(const RationalVector& x, const RationalVector& y) {
  Rational sum = 0;
  for (size_t k = 0; k < x.size(); ++k) {
    if (x[k] != 0 && y[k] != 0) sum += x[k] * y[k];
  }
  return sum;
}

// x += factor y.
void Add(const Rational& factor, const RationalVector& y, RationalVector* x) {
  for (size_t k = 0; k < y.size(); ++k) {
    if (y[k] != 0) (*x)[k] += factor * y[k];
  }
}

// The largest number becomes +-1, so that numbers stay short.
void Normalize(RationalVector* x) {
  Rational largest = 0;
  for (const Rational& value : *x) largest = std::max<Rational>(largest, abs(value));
  if (largest == 0) return;
  for (Rational& value : *x) value /= largest;
}

// The cone of a polyhedron, with a coordinate more that is 1 in its points and 0 in its directions.
class Cone {
 public:
  explicit Cone(Index dimension) {
    for (Index k = 0; k < dimension; ++k) {
      RationalVector line(At(dimension));
      line[At(k)] = 1;
      lines_.push_back(std::move(line));
    }
  }

  // Keeps what has normal.x >= 0.
  void Cut(const RationalVector& normal) {
    const auto crossing =
        std::ranges::find_if(lines_, [&](const RationalVector& line) { return Dot(normal, line) != 0; });
    if (crossing != lines_.end()) {
      CutLine(normal, crossing);
    } else {
      CutRays(normal);
    }
    ++cuts_;
  }

  Polyhedron Points() const {
    Polyhedron points;
    for (const Ray& ray : rays_) {
      RationalVector x = ray.x;
      const Rational last = x.back();
      x.pop_back();
      if (last == 0) {
        points.rays.push_back(std::move(x));
        continue;
      }
      for (Rational& value : x) value /= last;
      points.vertices.push_back(std::move(x));
    }
    for (RationalVector line : lines_) {
      line.pop_back();
      points.lines.push_back(std::move(line));
    }
    return points;
  }

 private:
  using Cuts = std::bitset<kMostHalfspaces + 1>;
  struct Ray {
    RationalVector x;
    Cuts touches;  // cuts with normal.x = 0
  };

  // One direction of a line becomes a ray; everything else moves along it into the plane of the cut.
  void CutLine(const RationalVector& normal, std::vector<RationalVector>::iterator crossing) {
    RationalVector line = std::move(*crossing);
    lines_.erase(crossing);
    const Rational slope = Dot(normal, line);
    if (slope < 0) {
      for (Rational& value : line) value = -value;
    }
    const Rational up = abs(slope);
    for (RationalVector& other : lines_) Add(-Dot(normal, other) / up, line, &other);
    for (Ray& ray : rays_) {
      Add(-Dot(normal, ray.x) / up, line, &ray.x);
      ray.touches.set(cuts_);
    }
    Cuts before;
    for (size_t cut = 0; cut < cuts_; ++cut) before.set(cut);
    rays_.push_back({std::move(line), before});
  }

  void CutRays(const RationalVector& normal) {
    std::vector<Rational> height;
    for (const Ray& ray : rays_) height.push_back(Dot(normal, ray.x));
    std::vector<Ray> kept;
    for (size_t p = 0; p < rays_.size(); ++p) {
      if (height[p] <= 0) continue;
      for (size_t q = 0; q < rays_.size(); ++q) {
        if (height[q] >= 0 || !AreAdjacent(p, q)) continue;
        Ray between{rays_[p].x, rays_[p].touches & rays_[q].touches};
        for (Rational& value : between.x) value *= -height[q];
        Add(height[p], rays_[q].x, &between.x);
        Normalize(&between.x);
        between.touches.set(cuts_);
        kept.push_back(std::move(between));
      }
    }
    for (size_t p = 0; p < rays_.size(); ++p) {
      if (height[p] < 0) continue;
      if (height[p] == 0) rays_[p].touches.set(cuts_);
      kept.push_back(std::move(rays_[p]));
    }
    rays_ = std::move(kept);
  }

  // Whether two extreme rays span a face: no third one lies in all planes that both lie in.
  bool AreAdjacent(size_t p, size_t q) const {
    const Cuts common = rays_[p].touches & rays_[q].touches;
    for (size_t r = 0; r < rays_.size(); ++r) {
      if (r != p && r != q && (rays_[r].touches & common) == common) return false;
    }
    return true;
  }

  std::vector<RationalVector> lines_;
  std::vector<Ray> rays_;
  size_t cuts_ = 0;
};

}  // namespace

Polyhedron Intersect(Index dimension, const std::vector<Halfspace>& halfspaces) {
  if (static_cast<Index>(halfspaces.size()) > kMostHalfspaces)
    throw std::logic_error("Intersect: too many half-spaces");
  Cone cone(dimension + 1);
  RationalVector normal(At(dimension + 1));
  normal.back() = 1;
  cone.Cut(normal);
  for (const Halfspace& halfspace : halfspaces) {
    normal = halfspace.normal;
    normal.push_back(halfspace.constant);
    cone.Cut(normal);
  }
  return cone.Points();
}

}  // namespace lcpbench
