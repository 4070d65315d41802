#include "model/scenes/picture.h"
#include "model/outline_piece.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "model/scenes/picture_layout.h"
#include "model/scenes/svg_text.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

// Okabe-Ito colours; edges and contacts share none.
constexpr std::string_view kStraightColor = "#0072B2";
constexpr std::string_view kConvexColor = "#009E73";
constexpr std::string_view kConcaveColor = "#CC79A7";
constexpr std::string_view kActiveColor = "#D55E00";
constexpr std::string_view kInk = "#222222";
constexpr std::string_view kBodyFill = "#F1F3F5";
constexpr std::string_view kJointColor = "#E69F00";

// All in pixels.
constexpr double kTitleHeight = 40;
constexpr double kLegendLine = 24;
constexpr double kLegendArrow = 70;
constexpr double kCharacterWidth = 6.6;

/// The largest of 1, 2, 5 times a power of ten that is <= value > 0.
double RoundDown(double value) {
  double decade = 1;
  while (decade > value && decade > 1e-300) decade /= 10;
  while (decade * 10 <= value && decade < 1e300) decade *= 10;
  for (const double step : {5.0, 2.0}) {
    if (step * decade <= value) return step * decade;
  }
  return decade;
}

enum class RowKind { kPlain, kActive, kOpen, kDegenerate, kJoint };
constexpr std::array kRowKinds{RowKind::kPlain, RowKind::kActive, RowKind::kOpen, RowKind::kDegenerate,
                               RowKind::kJoint};

std::string_view ColorOf(EdgeKind kind) {
  switch (kind) {
    case EdgeKind::kStraight:
      return kStraightColor;
    case EdgeKind::kConvex:
      return kConvexColor;
    case EdgeKind::kConcave:
      return kConcaveColor;
  }
  return kInk;
}

class Drawing {
 public:
  Drawing(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd* f, const Eigen::VectorXd* w)
      : system_(system), lcp_(lcp), f_(f), layout_(MakeLayout(system, lcp)), id_(Identifier(system.name)) {
    Classify(w);
    hatch_ = std::clamp(0.4 * layout_.body_size, 4.0, 9.0);
    // Neither small bodies nor crowded rows shall drown in marks.
    const double area =
        layout_.width * layout_.drawing_height() / static_cast<double>(std::max<std::size_t>(1, lcp.rows.size()));
    const double spacing = std::sqrt(area);
    mark_ = std::clamp(std::min(0.06 * layout_.body_size, 0.09 * spacing), 0.9, 4.5);
    line_ = std::clamp(std::min(0.03 * layout_.body_size, 0.04 * spacing), 0.4, 1.8);
    arrow_ = std::clamp(std::min(0.035 * layout_.body_size, 0.05 * spacing), 0.8, 2.2);
    if (f != nullptr && f->size() > 0) {
      double largest = 0;
      for (Index i = 0; i < f->size(); ++i) {
        if (std::isfinite((*f)[i])) largest = std::max(largest, std::abs((*f)[i]));
      }
      if (largest > 0) arrow_scale_ = std::clamp(0.8 * layout_.body_size, 8.0, 80.0) / largest;
    }
  }

  std::string Render() {
    const std::string legend = Legend();
    const double page_height = kTitleHeight + layout_.drawing_height() + legend_height_ + kPagePadding;
    out_ += "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + Px(kPageWidth) + " " + Px(page_height) +
            "\" width=\"" + Px(kPageWidth) + "\" height=\"" + Px(page_height) +
            "\" font-family=\"Helvetica, Arial, sans-serif\">\n";
    out_ += "<title>" + Escape(system_.name) + "</title>\n";
    Definitions();
    out_ += "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n";
    Title();
    for (int strip = 0; strip < layout_.strips; ++strip) {
      const double x = (kPageWidth - layout_.width) / 2;
      const double y = kTitleHeight + strip * (layout_.height + kStripGap);
      out_ += "<svg x=\"" + Px(x) + "\" y=\"" + Px(y) + "\" width=\"" + Px(layout_.width) + "\" height=\"" +
              Px(layout_.height) + "\" viewBox=\"" + Px(strip * layout_.width) + " 0 " + Px(layout_.width) + " " +
              Px(layout_.height) + "\" overflow=\"hidden\"><use href=\"#" + id_ + "-scene\"/></svg>\n";
    }
    out_ += legend;
    out_ += "</svg>\n";
    return std::move(out_);
  }

 private:
  // ---- what is shown
  // -------------------------------------------------------------------------------------------------

  void Classify(const Eigen::VectorXd* w) {
    const auto n = static_cast<Index>(lcp_.rows.size());
    kinds_.assign(lcp_.rows.size(), RowKind::kPlain);
    const bool solved = f_ != nullptr && w != nullptr;
    // In one unit, sqrt(A_ii) f and w / sqrt(A_ii), so that rows and the two sides compare.
    Eigen::VectorXd force(solved ? n : 0);
    Eigen::VectorXd motion(solved ? n : 0);
    for (Index i = 0; solved && i < n; ++i) {
      const double diagonal = lcp_.problem.DiagonalA()[i];
      const double root = diagonal > 0 ? std::sqrt(diagonal) : 1;
      force[i] = root * (*f_)[i];
      motion[i] = (*w)[i] / root;
    }
    constexpr double kZero = 1e-9;
    const double threshold =
        solved && n > 0 ? kZero * std::max(force.cwiseAbs().maxCoeff(), motion.cwiseAbs().maxCoeff()) : 0;
    for (Index i = 0; i < n; ++i) {
      RowKind& kind = kinds_[static_cast<std::size_t>(i)];
      if (lcp_.rows[static_cast<std::size_t>(i)].bilateral) {
        kind = RowKind::kJoint;
      } else if (solved) {
        kind = std::max(force[i], motion[i]) <= threshold ? RowKind::kDegenerate
               : force[i] > motion[i]                     ? RowKind::kActive
                                                          : RowKind::kOpen;
      }
      ++counts_[static_cast<std::size_t>(kind)];
    }
  }

  // ---- page
  // ----------------------------------------------------------------------------------------------------------

  void Title() {
    int movable = 0;
    for (const Body& body : system_.bodies) movable += body.fixed ? 0 : 1;
    out_ += "<text x=\"" + Px(kPagePadding) + "\" y=\"26\" font-size=\"16\" font-weight=\"bold\" fill=\"" +
            std::string(kInk) + "\">" + Escape(system_.name) +
            "<tspan font-weight=\"normal\" font-size=\"13\" dx=\"14\" fill=\"#555555\">" + std::to_string(movable) +
            (movable == 1 ? " movable body, " : " movable bodies, ") + std::to_string(lcp_.rows.size()) +
            (lcp_.rows.size() == 1 ? " row" : " rows") + "</tspan></text>\n";
  }

  void Definitions() {
    out_ += "<defs>\n<pattern id=\"" + id_ +
            "-hatch\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(45)\">"
            "<rect width=\"6\" height=\"6\" fill=\"#ECECEC\"/>"
            "<line x1=\"0\" y1=\"0\" x2=\"0\" y2=\"6\" stroke=\"#9A9A9A\" stroke-width=\"1.6\"/></pattern>\n";
    for (const RowKind kind : kRowKinds) {
      // Symbols are drawn once: a scene may have thousands of rows.
      out_ += "<g id=\"" + MarkId(kind) + "\">" + MarkShape(kind, mark_) + "</g>\n";
    }
    out_ += "<g id=\"" + id_ + "-scene\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n";
    for (const bool fixed : {true, false}) {
      for (const Body& body : system_.bodies) {
        if (body.fixed == fixed) DrawBody(body);
      }
    }
    for (std::size_t i = 0; i < lcp_.rows.size(); ++i) DrawTick(i);
    for (std::size_t i = 0; i < lcp_.rows.size(); ++i) DrawForce(i);
    for (std::size_t i = 0; i < lcp_.rows.size(); ++i) DrawMark(i);
    out_ += "</g>\n</defs>\n";
  }

  // ---- bodies
  // --------------------------------------------------------------------------------------------------------

  void DrawBody(const Body& body) {
    out_ += "<g><title>" + Escape(body.name);
    if (body.fixed) {
      out_ += ", fixed";
    } else {
      out_ += ", " + Short(body.mass) + " kg, v = (" + Short(body.v.x) + ", " + Short(body.v.y) + ") m/s, " +
              Short(body.omega) + " rad/s";
    }
    out_ += "</title>";
    if (body.fixed) {
      for (const OutlineEdge& piece : body.outline) Hatch(body, piece);
    } else if (body.outline.size() > 1 || (body.outline.size() == 1 && !IsFullCircle(body.outline[0]))) {
      std::string path;
      for (const OutlineEdge& piece : body.outline) path += PiecePath(body, piece, 0, path.empty() ? "M" : "L");
      out_ += "<path d=\"" + path + "Z\" fill=\"" + std::string(kBodyFill) + "\"/>";
    }
    for (const OutlineEdge& piece : body.outline) {
      const bool filled = !body.fixed && body.outline.size() == 1 && IsFullCircle(piece);
      const std::string style = " fill=\"" + (filled ? std::string(kBodyFill) : "none") + "\" stroke=\"" +
                                std::string(ColorOf(KindOf(piece))) + "\" stroke-width=\"" +
                                Px(body.fixed ? std::max(line_, 1.2) : line_) + "\"/>";
      shown_edges_[static_cast<std::size_t>(KindOf(piece))] = true;
      if (IsFullCircle(piece)) {
        const auto& arc = std::get<ArcEdge>(piece.edge);
        const Vec2 center = layout_.ToPage(ToWorld(body, arc.center));
        out_ += "<circle cx=\"" + Px(center.x) + "\" cy=\"" + Px(center.y) + "\" r=\"" +
                Px(arc.radius * layout_.scale) + "\"" + style;
      } else {
        out_ += "<path d=\"" + PiecePath(body, piece, 0, "M") + "\"" + style;
      }
    }
    if (!body.fixed && layout_.body_size > 24) DrawCenterOfMass(layout_.ToPage(body.x));
    out_ += "</g>\n";
  }

  /// The piece, moved by `depth` pixels into the material, as path commands; backwards where depth > 0, so that a band
  /// is the piece followed by its moved copy. `move` is the command that leads to its start.
  std::string PiecePath(const Body& body, const OutlineEdge& piece, double depth, std::string_view move) const {
    const bool backwards = depth > 0;
    const double begin = backwards ? piece.s_end : piece.s_begin;
    const double end = backwards ? piece.s_begin : piece.s_end;
    if (!std::holds_alternative<StraightEdge>(piece.edge) && !std::holds_alternative<ArcEdge>(piece.edge)) {
      return SampledPath(body, piece, begin, end, depth, move);
    }
    OutlineEdge moved = piece;
    const double inward = depth / layout_.scale;
    if (auto* line = std::get_if<StraightEdge>(&moved.edge)) {
      const Vec2 along = line->b - line->a;
      const Vec2 shift = (inward / std::max(Norm(along), std::numeric_limits<double>::min())) * Perp(along);
      line->a = line->a + shift;
      line->b = line->b + shift;
    } else {
      auto& arc = std::get<ArcEdge>(moved.edge);
      arc.radius = std::max(0.0, arc.radius + (arc.side == Side::kConvex ? -inward : inward));
    }
    std::string path = std::string(move) + Px(layout_.ToPage(ToWorld(body, PieceAt(moved, begin))));
    if (const auto* arc = std::get_if<ArcEdge>(&moved.edge)) {
      // In halves, so that neither is ever more than 180 degrees; y is flipped, so counter-clockwise is sweep 0.
      const std::string radius = Px(arc->radius * layout_.scale);
      for (const double s : {(begin + end) / 2, end}) {
        path.append("A").append(radius).append(" ").append(radius).append(end > begin ? " 0 0 0 " : " 0 0 1 ");
        path.append(Px(layout_.ToPage(ToWorld(body, PieceAt(moved, s)))));
      }
    } else {
      path += "L" + Px(layout_.ToPage(ToWorld(body, PieceAt(moved, end))));
    }
    return path;
  }

  /// As PiecePath, for curves that SVG has no command for: a polygon fine enough for the eye.
  std::string SampledPath(const Body& body, const OutlineEdge& piece, double begin, double end, double depth,
                          std::string_view move) const {
    constexpr int kSegments = 96;
    const double travel = piece.s_end > piece.s_begin ? 1 : -1;
    std::string path(move);
    for (int k = 0; k <= kSegments; ++k) {
      const double s = begin + (end - begin) * k / kSegments;
      const Vec2 along = travel * CurveDirection(piece.edge, s);
      const Vec2 inward = (1 / std::max(Norm(along), std::numeric_limits<double>::min())) * Perp(along);
      const Vec2 point = PieceAt(piece, s) + (depth / layout_.scale) * inward;
      if (k > 0) path += "L";
      path += Px(layout_.ToPage(ToWorld(body, point)));
    }
    return path;
  }

  void Hatch(const Body& body, const OutlineEdge& piece) {
    const std::string move = IsFullCircle(piece) ? "M" : "L";
    out_ += "<path d=\"" + PiecePath(body, piece, 0, "M") + PiecePath(body, piece, hatch_, move) +
            "Z\" fill-rule=\"evenodd\" fill=\"url(#" + id_ + "-hatch)\"/>";
  }

  void DrawCenterOfMass(Vec2 p) {
    const double arm = std::clamp(0.04 * layout_.body_size, 1.5, 4.0);
    out_ += "<path d=\"M" + Px(p - Vec2{arm, 0}) + "L" + Px(p + Vec2{arm, 0}) + "M" + Px(p - Vec2{0, arm}) + "L" +
            Px(p + Vec2{0, arm}) + "\" stroke=\"#888888\" stroke-width=\"0.8\"/>";
  }

  // ---- rows
  // ----------------------------------------------------------------------------------------------------------

  Vec2 ContactPoint(std::size_t i) const {
    const RowInfo& row = lcp_.rows[i];
    return layout_.ToPage(0.5 * (row.p1 + row.p2));
  }
  /// On the page, y down.
  Vec2 Normal(std::size_t i) const { return {lcp_.rows[i].n.x, -lcp_.rows[i].n.y}; }

  void DrawTick(std::size_t i) {
    const Vec2 p = ContactPoint(i);
    const Vec2 half = (2.2 * mark_) * Normal(i);
    out_ += "<path d=\"M" + Px(p - half) + "L" + Px(p + half) + "\" stroke=\"" + std::string(kInk) +
            "\" stroke-width=\"" + Px(std::max(0.4, 0.6 * line_)) + "\"/>\n";
  }

  void DrawForce(std::size_t i) {
    if (f_ == nullptr || arrow_scale_ == 0) return;
    const double length = (*f_)[static_cast<Index>(i)] * arrow_scale_;
    if (!std::isfinite(length) || std::abs(length) < 0.5) return;
    const Vec2 p = ContactPoint(i);
    const Vec2 n = (length < 0 ? -1.0 : 1.0) * Normal(i);
    Arrow(&out_, p, p + std::abs(length) * n);
  }

  void Arrow(std::string* out, Vec2 from, Vec2 to) const {
    const Vec2 along = to - from;
    const double length = Norm(along);
    const Vec2 unit = (1 / length) * along;
    const double head = std::min(4 * arrow_, 0.6 * length);
    const Vec2 neck = to - head * unit;
    const Vec2 side = (0.45 * head) * Perp(unit);
    *out += "<path d=\"M" + Px(from) + "L" + Px(neck) + "\" stroke=\"" + std::string(kActiveColor) +
            "\" stroke-width=\"" + Px(arrow_) + "\" stroke-linecap=\"butt\"/><path d=\"M" + Px(to) + "L" +
            Px(neck + side) + "L" + Px(neck - side) + "Z\" fill=\"" + std::string(kActiveColor) + "\"/>\n";
  }

  void DrawMark(std::size_t i) {
    const Vec2 p = ContactPoint(i);
    out_ += "<use href=\"#" + MarkId(kinds_[i]) + "\" x=\"" + Px(p.x) + "\" y=\"" + Px(p.y) + "\"/>\n";
  }

  std::string MarkId(RowKind kind) const { return id_ + "-mark" + std::to_string(static_cast<int>(kind)); }

  /// Filled disc: active; open diamond: separating; open disc: both zero; square: joint; grey disc: not solved.
  static std::string MarkShape(RowKind kind, double r) {
    const std::string outline = "\" stroke-width=\"" + Px(std::max(0.5, 0.3 * r)) + "\"/>";
    const std::string disc = "<circle r=\"" + Px(r) + "\" fill=\"";
    switch (kind) {
      case RowKind::kPlain:
        return disc + "#777777\"/>";
      case RowKind::kActive:
        return disc + std::string(kActiveColor) + "\"/>";
      case RowKind::kDegenerate:
        return disc + "#FFFFFF\" stroke=\"" + std::string(kActiveColor) + outline;
      case RowKind::kOpen: {
        const std::string h = Px(1.35 * r);
        return "<path d=\"M0 -" + h + "L" + h + " 0L0 " + h + "L-" + h + " 0Z\" fill=\"#FFFFFF\" stroke=\"" +
               std::string(kInk) + outline;
      }
      case RowKind::kJoint:
        return "<rect x=\"" + Px(-r) + "\" y=\"" + Px(-r) + "\" width=\"" + Px(2 * r) + "\" height=\"" + Px(2 * r) +
               "\" fill=\"" + std::string(kJointColor) + "\" stroke=\"" + std::string(kInk) + outline;
    }
    return {};
  }

  // ---- legend
  // --------------------------------------------------------------------------------------------------------

  /// Places items from left to right, in as many lines as they need.
  class Flow {
   public:
    explicit Flow(double top) : y_(top + kLegendLine / 2) {}
    /// An item with a symbol `symbol_width` wide; the symbol is drawn by `draw(centre left end)`.
    template <typename Draw>
    void Add(double symbol_width, const std::string& text, Draw draw) {
      const double width = symbol_width + 8 + kCharacterWidth * static_cast<double>(text.size());
      if (x_ > kPagePadding && x_ + width > kPageWidth - kPagePadding) {
        x_ = kPagePadding;
        y_ += kLegendLine;
      }
      draw(&out_, Vec2{x_, y_});
      out_ += "<text x=\"" + Px(x_ + symbol_width + 7) + "\" y=\"" + Px(y_ + 4.5) + "\" font-size=\"13\" fill=\"" +
              std::string(kInk) + "\">" + Escape(text) + "</text>\n";
      x_ += width + 22;
    }
    std::string out_;
    double bottom() const { return y_ + kLegendLine / 2; }

   private:
    double x_ = kPagePadding;
    double y_;
  };

  std::string Legend() {
    const double top = kTitleHeight + layout_.drawing_height() + 14;
    Flow flow(top);
    for (const Body& body : system_.bodies) {
      for (const OutlineEdge& piece : body.outline) shown_edges_[static_cast<std::size_t>(KindOf(piece))] = true;
    }
    static constexpr std::array<const char*, 3> kEdgeNames{"straight edge", "convex arc", "concave arc"};
    for (std::size_t kind = 0; kind < kEdgeNames.size(); ++kind) {
      if (!shown_edges_[kind]) continue;
      flow.Add(24, kEdgeNames[kind], [&](std::string* out, Vec2 p) {
        *out += "<path d=\"M" + Px(p) + "h24\" stroke=\"" + std::string(ColorOf(static_cast<EdgeKind>(kind))) +
                "\" stroke-width=\"2.4\"/>";
      });
    }
    static constexpr std::array<const char*, 5> kRowNames{"contact", "active, f > 0", "separating, w > 0", "f = w = 0",
                                                          "joint row"};
    for (const RowKind kind : kRowKinds) {
      const auto k = static_cast<std::size_t>(kind);
      if (counts_[k] == 0) continue;
      flow.Add(12, std::string(kRowNames[k]) + " (" + std::to_string(counts_[k]) + ")", [&](std::string* out, Vec2 p) {
        *out += "<g transform=\"translate(" + Px(p + Vec2{6, 0}) + ")\"><path d=\"M0 -9v18\" stroke=\"" +
                std::string(kInk) + "\" stroke-width=\"1\"/>" + MarkShape(kind, 4.2) + "</g>";
      });
    }
    if (arrow_scale_ > 0) {
      const double force = RoundDown(kLegendArrow / arrow_scale_);
      const double length = force * arrow_scale_;
      flow.Add(length, Short(force) + " N on body 1", [&](std::string* out, Vec2 p) {
        Arrow(out, p, p + Vec2{length, 0});
      });
    }
    const double distance = RoundDown(90 / layout_.scale);
    const double bar = distance * layout_.scale;
    flow.Add(bar, Short(distance) + " m", [&](std::string* out, Vec2 p) {
      *out += "<path d=\"M" + Px(p) + "m0 -4v8m0 -4h" + Px(bar) + "m0 -4v8\" stroke=\"" + std::string(kInk) +
              "\" stroke-width=\"1.4\" fill=\"none\"/>";
    });
    legend_height_ = flow.bottom() - (kTitleHeight + layout_.drawing_height());
    return std::move(flow.out_);
  }

  const ContactSystem& system_;
  const AssembledLcp& lcp_;
  const Eigen::VectorXd* f_;
  Layout layout_;
  std::string id_;
  std::vector<RowKind> kinds_;
  std::array<int, kRowKinds.size()> counts_{};
  std::array<bool, 3> shown_edges_{};
  double arrow_ = 1;        ///< stroke width of forces [px]
  double line_ = 1;         ///< stroke width of edges [px]
  double hatch_ = 9;        ///< depth of the hatching of fixed bodies [px]
  double mark_ = 3;         ///< radius of a contact's mark [px]
  double arrow_scale_ = 0;  ///< [px/N]
  double legend_height_ = 0;
  std::string out_;
};

}  // namespace

std::string RenderSvg(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd* f,
                      const Eigen::VectorXd* w) {
  const auto rows = static_cast<Index>(lcp.rows.size());
  for (const Eigen::VectorXd* values : {f, w}) {
    if (values != nullptr && values->size() != rows) {
      throw InputError("picture of " + system.name + ": expected " + std::to_string(rows) + " values, found " +
                       std::to_string(values->size()));
    }
  }
  return Drawing(system, lcp, f, w).Render();
}

}  // namespace lcpbench
