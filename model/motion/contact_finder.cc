#include "model/motion/contact_finder.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "model/contact/contact_row.h"
#include "model/contact/path.h"
#include "model/detection/normal_span.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// A share of the least width: overlaps deeper than this are found without their contacts,
constexpr double kFineness = 0.125;
// contacts are searched to this depth, at least, to find the others;
constexpr double kSearchedDepth = 0.25;
// overlaps without a contact that are shallower than this are left alone;
constexpr double kUnseen = 1e-3;
// and what counts as touching.
constexpr double kTouching = 1e-9;
// Contacts that are shallower than this are as deep as their gap says: whether a corner is beside an edge or on it is
// no matter then.
constexpr double kNoMatter = 1e-5;
// A contact undoes an overlap if it is as deep as this part of it, or leaves no more of it.
constexpr double kAsDeep = 0.5;

// Six digits.
std::string ShortText(double value) {
  constexpr int kDigits = 6;
  std::array<char, 32> text{};
  char* const end = text.data() + text.size();
  return {text.data(), std::to_chars(text.data(), end, value, std::chars_format::general, kDigits).ptr};
}

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

Extent ExtentOf(const std::vector<NormalSpan>& spans) {
  if (spans.empty()) return {};
  BoundingBox all = spans[0].Bounds();
  for (const NormalSpan& span : spans) all = Union(all, span.Bounds());
  const Vec2 far{std::max(-all.lower.x, all.upper.x), std::max(-all.lower.y, all.upper.y)};
  return {Norm(far), std::min(all.upper.x - all.lower.x, all.upper.y - all.lower.y)};
}

// Whether parting at `shallow` parts `deep` as well: see WithoutGhosts.
bool IsGhostBeside(const RowInfo& deep, const RowInfo& shallow) {
  constexpr double kSameWay = 0.9;  // cosine of the angle between normals
  // A corner's contact lies on both faces that meet there: behind them but for rounding.
  const double slack = 0.1 * -deep.d;
  return shallow.d > deep.d && Dot(deep.n, shallow.n) < kSameWay && Dot(shallow.p2 - deep.p2, deep.n) <= slack &&
         Dot(shallow.p1 - deep.p1, deep.n) >= -slack && shallow.axis != 't';
}

}  // namespace

ContactFinder::ContactFinder(const World& world, const StopCheck* check) : check_(check) {
  for (const Body& body : world.bodies) {
    outlines_.push_back(OutlineOf(body));
    extents_.push_back(ExtentOf(NormalSpans(outlines_.back(), Rotation{})));
    const double width = extents_.back().width;
    if (!body.fixed && width > 0 && (least_width_ == 0 || width < least_width_)) least_width_ = width;
  }
  if (least_width_ > 0) overlaps_ = std::make_unique<const OverlapFinder>(outlines_, kFineness * least_width_);
  for (const Constraint& joint : world.joints) joined_.push_back(std::minmax(joint.body1, joint.body2));
  std::sort(joined_.begin(), joined_.end());
}

std::vector<Constraint> ContactFinder::Find(std::span<const Body> bodies, double tolerance, double penetration) const {
  return DetectContacts(bodies, outlines_, {tolerance, penetration, joined_, check_});
}

bool ContactFinder::AreJoined(int i, int j) const {
  return std::binary_search(joined_.begin(), joined_.end(), std::pair(i, j));
}

std::vector<BodyOverlap> ContactFinder::FindOverlaps(std::span<const Body> bodies, std::span<const Constraint> contacts,
                                                     double limit) const {
  if (!overlaps_) return {};
  return overlaps_->Find(bodies, contacts, joined_, limit);
}

double ContactFinder::DepthAt(std::span<const Body> bodies, const Constraint& contact, Vec2 p1, Vec2 p2,
                              double d) const {
  if (-d <= kNoMatter * least_width_) return -d;
  return overlaps_->DepthAt(bodies, contact.body1, p1, contact.body2, p2, -d);
}

bool ContactFinder::Undoes(std::span<const Body> bodies, const Constraint& contact, const BodyOverlap& overlap) const {
  const double enough = kAsDeep * overlap.depth;
  const bool same_bodies = contact.body1 == overlap.body1 && contact.body2 == overlap.body2;
  if (!same_bodies || contact.nominal_gap > -enough) return false;
  const ClosestPoints closest = FindClosestPoints(contact, bodies);
  std::vector<Body> parted(bodies.begin(), bodies.end());
  Body& body1 = parted[static_cast<std::size_t>(contact.body1)];
  const Body& body2 = parted[static_cast<std::size_t>(contact.body2)];
  if (DepthAt(bodies, contact, body1.x + closest.R1, body2.x + closest.R2, closest.d) >= enough) return true;
  // The points are in the other body's outline where flush sides overlap: only parting shows what the contact does.
  body1.x = body1.x - closest.d * closest.n;
  const std::vector<BodyOverlap> left = FindOverlaps(parted, {}, enough);
  return std::none_of(left.begin(), left.end(), [&](const BodyOverlap& other) {
    return other.body1 == overlap.body1 && other.body2 == overlap.body2 && other.depth > enough;
  });
}

std::vector<BodyOverlap> ContactFinder::FindUntreatable(std::span<const Body> bodies, double least,
                                                        double treated) const {
  if (!overlaps_) return {};
  std::optional<std::vector<Constraint>> contacts;
  const auto find_contacts = [&] {
    contacts.emplace();
    try {
      *contacts = Find(bodies, kTouching * least_width_, std::max(treated, kSearchedDepth * least_width_));
    } catch (const InputError&) {
      // What is singular is refused where its contacts are used.
    }
  };
  // Overlaps deeper than this are found by themselves.
  if (least < kFineness * least_width_) find_contacts();
  std::vector<BodyOverlap> overlaps =
      FindOverlaps(bodies, contacts ? *contacts : std::vector<Constraint>(), std::min(least, treated));
  if (!overlaps.empty() && !contacts) find_contacts();
  std::erase_if(overlaps, [&](const BodyOverlap& overlap) {
    return overlap.depth <= treated && std::any_of(contacts->begin(), contacts->end(), [&](const Constraint& contact) {
             return contact.nominal_gap >= -treated && Undoes(bodies, contact, overlap);
           });
  });
  return overlaps;
}

void ContactFinder::RequireShallow(const World& world, std::string_view level, double limit) const {
  const std::vector<BodyOverlap> overlaps = FindUntreatable(world.bodies, kUnseen * least_width_, limit);
  const auto deepest = std::max_element(overlaps.begin(), overlaps.end(),
                                        [](const auto& a, const auto& b) { return a.depth < b.depth; });
  if (deepest == overlaps.end()) return;
  const std::string expected =
      deepest->depth > limit ? "expected at most " + ShortText(limit) + " m" : "expected a contact to part them by";
  throw InputError("scene '" + world.name + "': " + OverlapText(world, *deepest) + "; " + expected +
                   " at the start of a motion at the " + std::string(level) + " level");
}

std::string OverlapText(const World& world, const BodyOverlap& overlap) {
  const auto text = [&](int body, int edge) {
    return "'" + world.bodies[static_cast<std::size_t>(body)].name + "' (edge " + std::to_string(edge) + ")";
  };
  return "bodies " + text(overlap.body1, overlap.edge1) + " and " + text(overlap.body2, overlap.edge2) +
         " overlap by " + ShortText(overlap.depth) + " m";
}

std::vector<Constraint> WithoutGhosts(const ContactSystem& system, const std::vector<RowInfo>& rows, double doubtful) {
  const auto constraint = [&](const RowInfo& row) -> const Constraint& {
    return system.constraints[static_cast<std::size_t>(row.constraint)];
  };
  const auto first = std::find_if(rows.begin(), rows.end(),
                                  [&](const RowInfo& row) { return constraint(row).type == ConstraintType::kContact; });
  std::vector<Constraint> contacts;
  // Contacts come after the joints, and those of one pair of bodies follow each other.
  for (auto begin = first; begin != rows.end();) {
    const auto end = std::find_if(begin, rows.end(), [&](const RowInfo& row) {
      return constraint(row).body1 != constraint(*begin).body1 || constraint(row).body2 != constraint(*begin).body2;
    });
    for (auto row = begin; row != end; ++row) {
      if (row->axis == 't') continue;
      const bool ghost = row->d < -doubtful &&
                         std::any_of(begin, end, [&](const RowInfo& other) { return IsGhostBeside(*row, other); });
      if (!ghost) contacts.push_back(constraint(*row));
    }
    begin = end;
  }
  return contacts;
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
