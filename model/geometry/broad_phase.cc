#include "model/geometry/broad_phase.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
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
  int first_strip = 0;
  int last_strip = 0;
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
struct AxisStatistics {
  double low = 0;     // where boxes begin, but for outliers
  double spread = 0;  // over which length they begin, but for outliers
  double size = 0;    // of most boxes

  // In boxes side by side: high is good for the sweep.
  double resolution() const { return size > 0 ? spread / size : spread; }
};

AxisStatistics Measure(std::span<const BoundingBox> boxes, double Vec2::*axis) {
  constexpr double kOutliers = 0.02;
  constexpr double kTypicalShare = 0.75;
  std::vector<double> values;
  values.reserve(boxes.size());
  AxisStatistics found;
  for (const BoundingBox& box : boxes) values.push_back(box.upper.*axis / 2 - box.lower.*axis / 2);
  found.size = 2 * Quantile(kTypicalShare, &values);
  values.clear();
  for (const BoundingBox& box : boxes) values.push_back(box.lower.*axis);
  found.low = Quantile(kOutliers, &values);
  found.spread = 2 * (Quantile(1 - kOutliers, &values) / 2 - found.low / 2);
  return found;
}

class Sweep {
 public:
  explicit Sweep(std::span<const BoundingBox> boxes) {
    const AxisStatistics x = Measure(boxes, &Vec2::x);
    const AxisStatistics y = Measure(boxes, &Vec2::y);
    const bool along_x = x.resolution() >= y.resolution();
    across_ = along_x ? y : x;
    double Vec2::*along = along_x ? &Vec2::x : &Vec2::y;
    double Vec2::*across = along_x ? &Vec2::y : &Vec2::x;
    const double most = static_cast<double>(boxes.size()) + 1;
    const double wanted = across_.resolution() < most ? std::floor(across_.resolution()) + 1 : most;
    strips_.resize(static_cast<std::size_t>(wanted));
    strip_width_ = across_.spread / wanted;
    boxes_.reserve(boxes.size());
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      const BoundingBox& b = boxes[i];
      SweepBox box{b.lower.*along, b.upper.*along, b.lower.*across, b.upper.*across};
      box.index = static_cast<int>(i);
      box.first_strip = StripAt(box.across_lower);
      box.last_strip = StripAt(box.across_upper);
      boxes_.push_back(box);
    }
    std::sort(boxes_.begin(), boxes_.end(), [](const SweepBox& p, const SweepBox& q) {
      return p.along_lower < q.along_lower || (p.along_lower == q.along_lower && p.index < q.index);
    });
  }

  std::vector<std::uint64_t> Run() {
    // A box in so many strips would be copied too often.
    constexpr int kMaxStrips = 8;
    for (const SweepBox& box : boxes_) {
      for (int strip = box.first_strip; strip <= box.last_strip; ++strip) {
        Compare(box, &strips_[static_cast<std::size_t>(strip)], [&](const SweepBox& other) {
          // A pair that shares several strips is found in the first of them.
          return strip == std::max(box.first_strip, other.first_strip);
        });
      }
      Compare(box, &wide_, [](const SweepBox&) { return true; });
      if (box.last_strip - box.first_strip >= kMaxStrips) {
        wide_.push_back(box);
      } else {
        for (int strip = box.first_strip; strip <= box.last_strip; ++strip) {
          strips_[static_cast<std::size_t>(strip)].push_back(box);
        }
      }
    }
    return std::move(pairs_);
  }

 private:
  // Monotone, so that overlapping boxes share a strip; outliers go to the first or the last.
  int StripAt(double across) const {
    if (!(strip_width_ > 0)) return 0;
    const double strip = (across / 2 - across_.low / 2) / strip_width_ * 2;
    return static_cast<int>(std::clamp(strip, 0.0, static_cast<double>(strips_.size() - 1)));
  }

  // Compares with those in the list and drops those that the sweep has left behind.
  template <class Counts>
  void Compare(const SweepBox& box, std::vector<SweepBox>* list, const Counts& counts) {
    std::size_t kept = 0;
    for (std::size_t k = 0; k < list->size(); ++k) {
      const SweepBox& other = (*list)[k];
      if (other.along_upper < box.along_lower) continue;
      if (other.across_lower <= box.across_upper && box.across_lower <= other.across_upper && counts(other)) {
        const auto low = static_cast<std::uint64_t>(std::min(box.index, other.index));
        const auto high = static_cast<std::uint64_t>(std::max(box.index, other.index));
        pairs_.push_back(low << 32U | high);
      }
      if (kept != k) (*list)[kept] = other;
      ++kept;
    }
    list->resize(kept);
  }

  AxisStatistics across_;
  double strip_width_ = 0;
  std::vector<SweepBox> boxes_;  // by where they begin
  std::vector<std::vector<SweepBox>> strips_;
  std::vector<SweepBox> wide_;
  std::vector<std::uint64_t> pairs_;  // i << 32 | j
};

}  // namespace

std::vector<std::pair<int, int>> FindOverlappingPairs(std::span<const BoundingBox> boxes) {
  RequireValid(boxes);
  std::vector<std::pair<int, int>> pairs;
  if (boxes.empty()) return pairs;
  std::vector<std::uint64_t> keys = Sweep(boxes).Run();
  std::sort(keys.begin(), keys.end());
  pairs.reserve(keys.size());
  for (const std::uint64_t key : keys) {
    pairs.emplace_back(static_cast<int>(key >> 32U), static_cast<int>(key & 0xFFFFFFFFU));
  }
  return pairs;
}

}  // namespace lcpbench
