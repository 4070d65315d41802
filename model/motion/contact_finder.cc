#include "model/motion/contact_finder.h"

#include <algorithm>
#include <map>
#include <tuple>

#include "model/contact/contact_row.h"
#include "model/contact/path.h"

namespace lcpbench {
namespace {

// Features are constants of their bodies, so that equal numbers are equal features.
std::vector<double> KeyOf(const Constraint& constraint, char axis) {
  std::vector<double> key = {static_cast<double>(constraint.body1), static_cast<double>(constraint.body2),
                             static_cast<double>(constraint.type), static_cast<double>(axis)};
  for (const Feature& feature : {constraint.feature1, constraint.feature2}) {
    const std::vector<double> numbers = NumbersOf(feature);
    key.insert(key.end(), numbers.begin(), numbers.end());
  }
  return key;
}

}  // namespace

ContactFinder::ContactFinder(const World& world, const StopCheck* check) : check_(check) {
  for (const Body& body : world.bodies) outlines_.push_back(OutlineOf(body));
  for (const Constraint& joint : world.joints) joined_.push_back(std::minmax(joint.body1, joint.body2));
  std::sort(joined_.begin(), joined_.end());
}

std::vector<Constraint> ContactFinder::Find(std::span<const Body> bodies, double tolerance, double penetration) const {
  return DetectContacts(bodies, outlines_, {tolerance, penetration, joined_, check_});
}

bool ContactFinder::AreJoined(int i, int j) const {
  return std::binary_search(joined_.begin(), joined_.end(), std::pair(i, j));
}

Extent ExtentOf(std::span<const NormalSpan> spans) {
  if (spans.empty()) return {};
  BoundingBox all = spans[0].Bounds();
  for (const NormalSpan& span : spans) all = Union(all, span.Bounds());
  const Vec2 far{std::max(-all.lower.x, all.upper.x), std::max(-all.lower.y, all.upper.y)};
  return {Norm(far), std::min(all.upper.x - all.lower.x, all.upper.y - all.lower.y)};
}

double LeastWidth(const World& world, std::span<const Extent> extents) {
  double least = 0;
  for (std::size_t i = 0; i < extents.size(); ++i) {
    const double width = extents[i].width;
    if (!world.bodies[i].fixed && width > 0 && (least == 0 || width < least)) least = width;
  }
  return least;
}

void FollowPathJoints(std::span<const Body> bodies, std::span<Constraint> constraints) {
  for (Constraint& joint : constraints) {
    if (joint.type != ConstraintType::kPathJoint) continue;
    if (!joint.path.empty()) {
      FollowPath(bodies, &joint);
      continue;
    }
    const bool curve1 = IsSearched(joint.feature1);
    const bool curve2 = IsSearched(joint.feature2);
    if (!curve1 && !curve2) continue;
    const ClosestPoints closest = FindClosestPoints(joint, bodies, Regularity::kNonzeroD);
    if (curve1) joint.s1 = closest.s1;
    if (curve2) joint.s2 = closest.s2;
  }
}

std::vector<std::optional<int>> RowMatching::Follow(const ContactSystem& system, const std::vector<RowInfo>& rows) {
  std::map<std::vector<double>, std::pair<std::vector<int>, std::vector<int>>> places;  // before, now
  for (std::size_t i = 0; i < keys_.size(); ++i) places[keys_[i]].first.push_back(static_cast<int>(i));
  std::vector<std::vector<double>> keys;
  std::vector<Vec2> normals;
  keys.reserve(rows.size());
  normals.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const RowInfo& row = rows[i];
    keys.push_back(KeyOf(system.constraints[static_cast<std::size_t>(row.constraint)], row.axis));
    normals.push_back(row.n);
    if (const auto found = places.find(keys.back()); found != places.end()) {
      found->second.second.push_back(static_cast<int>(i));
    }
  }

  std::vector<std::optional<int>> previous(rows.size());
  std::vector<std::tuple<double, int, int>> candidates;  // distance, before, now
  for (const auto& [key, pair] : places) {
    candidates.clear();
    for (const int before : pair.first) {
      for (const int now : pair.second) {
        const Vec2 turned = normals[static_cast<std::size_t>(now)] - normals_[static_cast<std::size_t>(before)];
        candidates.emplace_back(Dot(turned, turned), before, now);
      }
    }
    std::sort(candidates.begin(), candidates.end());
    std::vector<int> taken;
    for (const auto& [distance, before, now] : candidates) {
      std::optional<int>& match = previous[static_cast<std::size_t>(now)];
      if (match || std::find(taken.begin(), taken.end(), before) != taken.end()) continue;
      match = before;
      taken.push_back(before);
    }
  }
  keys_ = std::move(keys);
  normals_ = std::move(normals);
  return previous;
}

}  // namespace lcpbench
