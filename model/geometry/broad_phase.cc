#include "model/geometry/broad_phase.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "support/input_error.h"

namespace lcpbench {
namespace {

// A box as the sweep sees it: `along` the axis of the sweep and `across` it.
struct SweepBox {
  double along_lower = 0;
  double along_upper = 0;
  double across_lower = 0;
  double across_upper = 0;
  int index = 0;
  std::size_t first_strip = 0;
};

void RequireValid(std::span<const BoundingBox> boxes) {
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    const BoundingBox& box = boxes[i];
    if (!IsFinite(box.lower) || !IsFinite(box.upper) || box.lower.x > box.upper.x || box.lower.y > box.upper.y) {
      throw InputError("bounding box " + std::to_string(i) + " must be finite with lower <= upper");
    }
  }
}

// The value that the given share of values lies below. Reorders the values.
double Quantile(double share, std::vector<double>* values) {
  const auto position = static_cast<std::ptrdiff_t>(share * static_cast<double>(values->size() - 1));
  std::nth_element(values->begin(), values->begin() + position, values->end());
  return (*values)[static_cast<std::size_t>(position)];
}

// How boxes lie along one axis. Halves are taken before differences, which must not overflow.
struct Spread {
  double half_low = 0;     // half of where boxes begin, but for outliers
  double half_length = 0;  // half the length over which they begin, but for outliers
  double resolution = 0;   // that length in boxes side by side: high is good for the sweep
};

Spread Measure(std::span<const BoundingBox> boxes, double Vec2::*axis) {
  constexpr double kOutliers = 0.02;
  constexpr double kTypicalShare = 0.75;
  std::vector<double> half_sizes;
  std::vector<double> begins;
  for (const BoundingBox& box : boxes) {
    half_sizes.push_back(box.upper.*axis / 2 - box.lower.*axis / 2);
    begins.push_back(box.lower.*axis);
  }
  const double half_low = Quantile(kOutliers, &begins) / 2;
  const double half_length = Quantile(1 - kOutliers, &begins) / 2 - half_low;
  const double half_size = Quantile(kTypicalShare, &half_sizes);
  return {half_low, half_length, half_size > 0 ? half_length / half_size : half_length};
}

}  // namespace

std::vector<std::pair<int, int>> FindOverlappingPairs(std::span<const BoundingBox> boxes) {
  RequireValid(boxes);
  std::vector<std::pair<int, int>> pairs;
  if (boxes.empty()) return pairs;
  const Spread x = Measure(boxes, &Vec2::x);
  const Spread y = Measure(boxes, &Vec2::y);
  const bool along_x = x.resolution >= y.resolution;
  const Spread& over = along_x ? y : x;
  double Vec2::*along = along_x ? &Vec2::x : &Vec2::y;
  double Vec2::*across = along_x ? &Vec2::y : &Vec2::x;
  // Those boxes that the sweep is passing through, by strips about one box wide, but no more than a long box may cross.
  const double count = std::floor(std::min(over.resolution, std::sqrt(static_cast<double>(boxes.size())))) + 1;
  std::vector<std::vector<SweepBox>> strips(static_cast<std::size_t>(count));
  // Monotone, so that overlapping boxes share a strip; outliers go to the first or the last.
  const auto strip_at = [&](double place) -> std::size_t {
    if (!(over.half_length > 0)) return 0;
    return static_cast<std::size_t>(std::clamp((place / 2 - over.half_low) / over.half_length * count, 0.0, count - 1));
  };
  std::vector<SweepBox> sorted;
  for (const BoundingBox& b : boxes) {
    sorted.push_back({b.lower.*along, b.upper.*along, b.lower.*across, b.upper.*across, static_cast<int>(sorted.size()),
                      strip_at(b.lower.*across)});
  }
  std::sort(sorted.begin(), sorted.end(),
            [](const SweepBox& p, const SweepBox& q) { return p.along_lower < q.along_lower; });
  for (const SweepBox& box : sorted) {
    const std::size_t last_strip = strip_at(box.across_upper);
    for (std::size_t strip = box.first_strip; strip <= last_strip; ++strip) {
      std::erase_if(strips[strip], [&](const SweepBox& other) {
        if (other.along_upper < box.along_lower) return true;
        const bool overlap = other.across_lower <= box.across_upper && box.across_lower <= other.across_upper;
        // A pair that shares several strips is found in the first of them.
        if (overlap && strip == std::max(box.first_strip, other.first_strip)) {
          if (pairs.size() == kMostPairs) {
            throw InputError("too much lies at one place: more than " + std::to_string(kMostPairs) +
                             " pairs of bounding boxes overlap");
          }
          pairs.push_back(std::minmax(box.index, other.index));
        }
        return false;
      });
      strips[strip].push_back(box);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

}  // namespace lcpbench
