#include <algorithm>
#include <array>
#include <functional>

#include "model/scenes/picture_parts.h"
#include "model/scenes/svg_text.h"

namespace lcpbench {
namespace {

// All in pixels.
constexpr double kLine = 24;
constexpr double kArrow = 70;
constexpr double kBar = 90;
constexpr double kCharacterWidth = 6.6;

/// Draws a symbol whose left end, at half height, is at the given point.
using DrawSymbol = std::function<std::string(Vec2)>;

/// Places items from left to right, in as many lines as they need.
class Flow {
 public:
  Flow(double top, std::string* out) : y_(top + kLine / 2), out_(out) {}

  void Add(double symbol_width, const std::string& text, const DrawSymbol& draw) {
    const double width = symbol_width + 8 + kCharacterWidth * static_cast<double>(text.size());
    if (x_ > kPagePadding && x_ + width > kPageWidth - kPagePadding) {
      x_ = kPagePadding;
      y_ += kLine;
    }
    *out_ += draw({x_, y_}) + "<text x=\"" + Px(x_ + symbol_width + 7) + "\" y=\"" + Px(y_ + 4.5) +
             "\" font-size=\"13\" fill=\"" + std::string(kInkColor) + "\">" + Escape(text) + "</text>\n";
    x_ += width + 20;
  }

  double bottom() const { return y_ + kLine / 2; }

 private:
  double x_ = kPagePadding;
  double y_;
  std::string* out_;
};

std::string Counted(const char* name, std::size_t count) {
  return std::string(name) + " (" + std::to_string(count) + ")";
}

void AddEdges(const Picture& picture, Flow* flow) {
  std::array<bool, kEdgeStyles.size()> shown{};
  for (const Body& body : picture.system.bodies) {
    for (const OutlineEdge& piece : body.outline) shown[static_cast<std::size_t>(KindOf(piece.edge))] = true;
  }
  for (std::size_t kind = 0; kind < shown.size(); ++kind) {
    if (!shown[kind]) continue;
    flow->Add(24, std::string(kEdgeStyles[kind].name), [&](Vec2 p) {
      return "<path d=\"M" + Px(p) + "h24\" stroke=\"" + std::string(kEdgeStyles[kind].color) +
             "\" stroke-width=\"2.4\"/>";
    });
  }
}

void AddBodies(const Picture& picture, Flow* flow) {
  for (const bool driven : {false, true}) {
    const auto count = std::count_if(picture.system.bodies.begin(), picture.system.bodies.end(), [&](const Body& body) {
      return body.fixed && !body.outline.empty() && IsDriven(body) == driven;
    });
    if (count == 0) continue;
    flow->Add(24, driven ? "driven" : "fixed", [&](Vec2 p) {
      return "<rect x=\"" + Px(p.x) + "\" y=\"" + Px(p.y - 6) + "\" width=\"24\" height=\"12\" fill=\"url(#" +
             picture.id + (driven ? "-driven" : "-fixed") + ")\"/>";
    });
  }
}

void AddContacts(const Picture& picture, Flow* flow) {
  static constexpr std::array<const char*, 4> kNames{"contact and normal", "active, f > 0", "separating, w > 0",
                                                     "f = w = 0"};
  std::array<std::size_t, kRowKinds.size()> counts{};
  for (std::size_t i = 0; i < picture.lcp.rows.size(); ++i) {
    const auto constraint = static_cast<std::size_t>(picture.lcp.rows[i].constraint);
    if (picture.system.constraints[constraint].type == ConstraintType::kContact) {
      ++counts[static_cast<std::size_t>(picture.kinds[i])];
    }
  }
  for (std::size_t kind = 0; kind < kNames.size(); ++kind) {
    if (counts[kind] == 0) continue;
    flow->Add(12, Counted(kNames[kind], counts[kind]), [&](Vec2 p) {
      return "<g transform=\"translate(" + Px(p + Vec2{6, 0}) + ")\"><path d=\"M0 -9v18\" stroke=\"" +
             std::string(kInkColor) + "\" stroke-width=\"1\"/>" + MarkShape(static_cast<RowKind>(kind), 4.2) + "</g>";
    });
  }
}

void AddConnectors(const Picture& picture, Flow* flow) {
  constexpr double kLength = 34;
  constexpr double kHalf = 4;
  const auto count = [&](ConstraintType type) {
    return static_cast<std::size_t>(std::count_if(picture.system.constraints.begin(), picture.system.constraints.end(),
                                                  [&](const Constraint& joint) { return joint.type == type; }));
  };
  const auto add = [&](double width, const char* name, std::size_t number, const DrawSymbol& draw) {
    if (number > 0) flow->Add(width, Counted(name, number), draw);
  };
  const Vec2 across{kLength, 0};
  add(10, "pin", count(ConstraintType::kPin), [&](Vec2 p) { return PinShape(p + Vec2{5, 0}, 4); });
  add(16, "path joint", count(ConstraintType::kPathJoint), [&](Vec2 p) {
    return SliderShape(p + Vec2{8, 0}, {0, 1}, 5);
  });
  add(kLength, "rod", count(ConstraintType::kRod), [&](Vec2 p) { return RodShape(p, p + across, 2.4); });
  add(kLength, "rope", count(ConstraintType::kRope), [&](Vec2 p) {
    return RopeShape(p - Vec2{0, 3}, p + across - Vec2{0, 3}, 1.08 * kLength, kHalf);
  });
  if (picture.loads == nullptr) return;
  add(kLength, "spring", picture.loads->springs.size(), [&](Vec2 p) { return SpringShape(p, p + across, kHalf); });
  add(kLength, "damper", picture.loads->dampers.size(), [&](Vec2 p) { return DamperShape(p, p + across, kHalf); });
}

void AddScales(const Picture& picture, Flow* flow) {
  if (picture.arrow_scale > 0) {
    const double force = RoundDown(kArrow / picture.arrow_scale);
    const double length = force * picture.arrow_scale;
    flow->Add(length, Short(force) + " N", [&](Vec2 p) {
      std::string symbol;
      AppendArrow(p, p + Vec2{length, 0}, picture.arrow, kForceColor, &symbol);
      return symbol;
    });
  }
  if (picture.loads != nullptr && Norm(picture.loads->gravity) > 0) {
    const Vec2 g = picture.loads->gravity;
    const Vec2 half = (9 / Norm(g)) * Vec2{g.x, -g.y};
    flow->Add(18, "gravity " + Short(Norm(g)) + " m/s\u00B2", [&](Vec2 p) {
      std::string symbol;
      AppendArrow(p + Vec2{9, 0} - half, p + Vec2{9, 0} + half, 1.4, kInkColor, &symbol);
      return symbol;
    });
  }
  const double distance = RoundDown(kBar / picture.layout.scale);
  const double bar = distance * picture.layout.scale;
  flow->Add(bar, Short(distance) + " m", [&](Vec2 p) {
    return "<path d=\"M" + Px(p) + "m0 -4v8m0 -4h" + Px(bar) + "m0 -4v8\" stroke=\"" + std::string(kInkColor) +
           "\" stroke-width=\"1.4\" fill=\"none\"/>";
  });
}

}  // namespace

double AppendLegend(const Picture& picture, double top, std::string* out) {
  Flow flow(top, out);
  AddEdges(picture, &flow);
  AddBodies(picture, &flow);
  AddContacts(picture, &flow);
  AddConnectors(picture, &flow);
  AddScales(picture, &flow);
  return flow.bottom() - top;
}

}  // namespace lcpbench
