#include "model/motion/row_matching.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <tuple>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <variant>

namespace lcpbench {
namespace {

// All numbers of a feature.
auto Fields(const Vertex& p) { return std::tie(p.p.x, p.p.y); }
auto Fields(const StraightEdge& e) { return std::tie(e.a.x, e.a.y, e.b.x, e.b.y); }
auto Fields(const ArcEdge& e) { return std::tie(e.center.x, e.center.y, e.radius, e.side); }
auto Fields(const EllipseEdge& e) { return std::tie(e.center.x, e.center.y, e.a, e.b, e.phi, e.side); }
auto Fields(const SuperellipseEdge& e) { return std::tie(e.center.x, e.center.y, e.a, e.b, e.m, e.phi, e.side); }
auto Fields(const BezierEdge& e) {
  const auto& P = e.P;
  return std::tie(P[0].x, P[0].y, P[1].x, P[1].y, P[2].x, P[2].y, P[3].x, P[3].y);
}

// Features are constants of their bodies, so that equal bytes are equal features.
class KeyText {
 public:
  template <typename... Values>
  void Add(const Values&... values) {
    (AddBytes(static_cast<double>(values)), ...);
  }
  void AddFeature(const Feature& feature) {
    Add(feature.index());
    std::visit(
        [this](const auto& kind) { std::apply([this](const auto&... fields) { Add(fields...); }, Fields(kind)); },
        feature);
  }
  std::string Take() { return std::move(text_); }

 private:
  void AddBytes(double value) {
    char bytes[sizeof value];
    std::memcpy(bytes, &value, sizeof value);
    text_.append(bytes, sizeof value);
  }

  std::string text_;
};

std::string KeyOf(const Constraint& constraint, char axis) {
  KeyText key;
  key.Add(constraint.type, axis, constraint.body1, constraint.body2);
  key.AddFeature(constraint.feature1);
  key.AddFeature(constraint.feature2);
  return key.Take();
}

}  // namespace

bool IsSameFeature(const Feature& a, const Feature& b) {
  if (a.index() != b.index()) return false;
  return std::visit(
      [&b](const auto& kind) { return Fields(kind) == Fields(std::get<std::decay_t<decltype(kind)>>(b)); }, a);
}

std::vector<std::optional<int>> RowMatching::Follow(const ContactSystem& system, const std::vector<RowInfo>& rows) {
  std::unordered_map<std::string, std::pair<std::vector<int>, std::vector<int>>> places;  // before, now
  for (std::size_t i = 0; i < keys_.size(); ++i) places[keys_[i]].first.push_back(static_cast<int>(i));
  std::vector<std::string> keys;
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
