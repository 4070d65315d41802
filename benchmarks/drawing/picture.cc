#include "benchmarks/drawing/picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "benchmarks/drawing/drawn_scene.h"
#include "benchmarks/drawing/svg.h"
#include "model/geometry/vec2.h"
#include "model/scenes/parts.h"
#include "solvers/lcp/verify.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// All in pixels.
constexpr double kPageWidth = 900;
constexpr double kPagePadding = 20;
constexpr double kTitleHeight = 40;
constexpr double kMaxDrawingHeight = 620;
constexpr double kStripGap = 10;
constexpr double kSmallBody = 24;  ///< smaller ones show no centre of mass

/// What a row is drawn as: grey disc where nothing is solved, filled disc, open diamond, open disc, filled disc of a
/// colour of its own; nothing; the joint's symbol.
enum class RowKind { kPlain, kActive, kOpen, kDegenerate, kSlides, kTangent, kJoint };
/// Names of contacts, by RowKind.
constexpr std::array kContactNames{"contact and normal", "active, f > 0", "separating, w > 0", "f = w = 0", "slides"};

/// How the world is laid out on the page: `strips` windows of equal width, one below the other.
struct Layout {
  double scale = 1;   ///< [px/m]
  Vec2 top_left;      ///< world point at the drawing's upper left corner
  double width = 0;   ///< of one strip [px]
  double height = 0;  ///< of one strip [px]
  int strips = 1;
  double body_size = 0;  ///< median extent of the movable bodies [px]

  /// Measured from the upper left corner of the first strip, as if the strips were side by side.
  Vec2 ToPage(Vec2 p) const { return {(p.x - top_left.x) * scale, (top_left.y - p.y) * scale}; }
  double drawing_height() const { return strips * height + (strips - 1) * kStripGap; }
};

/// Fits what ViewOf says of the bodies and points into kPageWidth x kMaxDrawingHeight. Rows much wider than high are
/// broken into strips.
Layout MakeLayout(const std::vector<Body>& bodies, const std::vector<Vec2>& points) {
  const std::vector<Bounds> bounds = BoundsOf(bodies);
  const Bounds view = ViewOf(bodies, bounds, points);
  const double median = MedianExtent(bodies, bounds);
  const double largest = std::max({ExtentOf(view), median, std::numeric_limits<double>::min()});
  constexpr double kWidth = kPageWidth - 2 * kPagePadding;
  // k strips are k^2 as high in total as one.
  // What is far apart gets no more strips than this, however small its bodies become.
  constexpr double kMostStrips = 500;
  const auto strips_of = [](const Eigen::Vector2d& size) {
    const double strips = std::sqrt(kMaxDrawingHeight * size.x() / (kWidth * size.y()));
    return strips < kMostStrips ? static_cast<int>(strips) : static_cast<int>(kMostStrips);
  };
  // Nor is a row broken whose bodies are large enough in one piece.
  constexpr double kLarge = 60;
  // A few bodies shall not fill the page: at least two median extents in view, with room around them.
  double margin = std::max({0.04 * largest, 0.25 * median, (2 * median - largest) / 2});
  Eigen::Vector2d size = view.sizes().array() + 2 * margin;
  Layout layout;
  if (strips_of(size) > 1 && median * kWidth / size.x() < kLarge) {
    // The margin belongs to the outer ends of the row, and above and below it.
    margin = std::min(margin, 0.1 * (view.sizes().y() + median));
    size = view.sizes().array() + 2 * margin;
    layout.strips = std::max(2, strips_of(size));
    layout.scale = kWidth * layout.strips / size.x();
  } else {
    layout.scale = std::min(kWidth / size.x(), kMaxDrawingHeight / size.y());
  }
  layout.top_left = {view.min().x() - margin, view.max().y() + margin};
  layout.width = size.x() * layout.scale / layout.strips;
  layout.height = size.y() * layout.scale;
  layout.body_size = median * layout.scale;
  return layout;
}

/// World directions as directions of the page.
Vec2 Mirrored(Vec2 v) { return {v.x, -v.y}; }

std::string MarkShape(RowKind kind, double radius) {
  const double width = std::max(0.5, 0.3 * radius);
  const std::string h = Px(1.35 * radius);
  switch (kind) {
    case RowKind::kPlain:
      return SvgCircle({}, radius, {.fill = "#777777"});
    case RowKind::kActive:
      return SvgCircle({}, radius, {.fill = kForceColor});
    case RowKind::kDegenerate:
      return SvgCircle({}, radius, {kForceColor, width, kWhite});
    case RowKind::kSlides:
      return SvgCircle({}, radius, {.fill = kSlideColor});
    case RowKind::kOpen:
      return SvgPath("M0 -" + h + "L" + h + " 0L0 " + h + "L-" + h + " 0Z", {kInkColor, width, kWhite});
    case RowKind::kTangent:
    case RowKind::kJoint:
      break;
  }
  return {};
}

std::string Tooltip(const Body& body) {
  std::string text = body.name + ", ";
  if (!body.fixed) text += Short(body.mass) + " kg, ";
  if (body.fixed && !IsDriven(body)) return text + "fixed";
  if (body.fixed) text += "driven, ";
  if (body.surface_speed != 0) text += "surface at " + Short(body.surface_speed) + " m/s, ";
  return text + "v = (" + Short(body.v.x) + ", " + Short(body.v.y) + ") m/s, " + Short(body.omega) + " rad/s";
}

/// A row is active, separating or degenerate where f and w are given, by their sides in one unit, sqrt(A_ii) f and
/// w / sqrt(A_ii), so that rows and the two sides compare.
/// @param slides  SlidingRows, or empty
std::vector<RowKind> Classify(const AssembledLcp& lcp, const Eigen::VectorXd* f, const Eigen::VectorXd* w,
                              const std::vector<bool>& slides) {
  std::vector<RowKind> kinds(lcp.rows.size(), RowKind::kPlain);
  const bool solved = f != nullptr && w != nullptr && !kinds.empty();
  Eigen::ArrayXd force;
  Eigen::ArrayXd motion;
  if (solved) {
    const Eigen::ArrayXd D = lcp.problem.DiagonalA().array();
    const Eigen::ArrayXd root = (D > 0).select(D.sqrt(), 1);
    force = root * f->array();
    motion = w->array() / root;
  }
  constexpr double kZero = 1e-9;
  const double threshold = solved ? kZero * std::max(force.abs().maxCoeff(), motion.abs().maxCoeff()) : 0;
  for (std::size_t k = 0; k < kinds.size(); ++k) {
    const auto i = static_cast<Index>(k);
    if (lcp.rows[k].bilateral) {
      kinds[k] = RowKind::kJoint;
    } else if (lcp.rows[k].axis == 't') {
      kinds[k] = RowKind::kTangent;
    } else if (!slides.empty() && slides[k]) {
      kinds[k] = RowKind::kSlides;
    } else if (solved) {
      kinds[k] = std::max(force[i], motion[i]) <= threshold ? RowKind::kDegenerate
                 : force[i] > motion[i]                     ? RowKind::kActive
                                                            : RowKind::kOpen;
    }
  }
  return kinds;
}

/// One force on the page.
struct Arrow {
  Vec2 from;
  Vec2 to;
  double newtons = 0;
  std::string_view color;
};

/// Draws the parts of a picture one after the other. Sizes in pixels.
class Picture {
 public:
  Picture(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd* f, const Eigen::VectorXd* w,
          const Loads* loads);
  std::string Render(const std::string& caption);

 private:
  void AddBody(const Body& body);
  void AddDrive(const Body& body);
  void AddConnectors();
  void AddContacts();
  void AddLabels();
  void AddTitle(const std::string& caption);
  std::vector<LegendItem> Legend() const;
  double AddLegend(double top);

  const Body& BodyOf(int index) const { return system_.bodies[static_cast<std::size_t>(index)]; }
  bool IsContact(const RowInfo& row) const {
    const Constraint& constraint = system_.constraints[static_cast<std::size_t>(row.constraint)];
    return constraint.type == ConstraintType::kContact && row.axis == 'n';
  }
  Vec2 PageOf(const Attachment& at) const { return layout_.ToPage(WorldPoint(BodyOf(at.body), at.point)); }
  Vec2 PageOf(const RowInfo& row) const { return layout_.ToPage(PlaceOf(system_, row)); }
  /// From paths in the body's frame to the page.
  std::string TransformOf(const Body& body) const;
  std::string MarkId(RowKind kind) const { return id_ + "-mark" + std::to_string(static_cast<int>(kind)); }
  std::string PatternId(bool driven) const { return id_ + (driven ? "-driven" : "-fixed"); }

  const ContactSystem& system_;
  const AssembledLcp& lcp_;
  const Loads* loads_;
  std::vector<Connector> connectors_;
  std::vector<RowKind> kinds_;
  std::string id_;  ///< prefix of all identifiers
  Layout layout_;
  double line_ = 1;         ///< stroke width of edges
  double mark_ = 3;         ///< radius of a contact's mark
  double arrow_ = 1;        ///< stroke width of forces
  double hatch_ = 9;        ///< depth of the hatching of unbounded bodies
  double connector_ = 4;    ///< half width of springs, dampers and of rods' ends
  double arrow_scale_ = 0;  ///< [px/N]; 0 without forces
  std::vector<Arrow> arrows_;
  std::string cones_;  ///< of friction, as one path
  std::string out_;
};

Picture::Picture(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd* f,
                 const Eigen::VectorXd* w, const Loads* loads)
    : system_(system),
      lcp_(lcp),
      loads_(loads),
      connectors_(ConnectorsOf(system.constraints, loads)),
      id_(Identifier(system.name)) {
  const std::vector<bool> slides =
      f != nullptr && w != nullptr ? SlidingRows(lcp.problem, *f, *w) : std::vector<bool>();
  kinds_ = Classify(lcp, f, w, slides);
  std::vector<Vec2> points;
  for (const RowInfo& row : lcp.rows) points.insert(points.end(), {row.p1, row.p2});
  for (const Connector& connector : connectors_) {
    for (const Attachment& end : {connector.end1, connector.end2}) {
      if (connector.path.empty()) points.push_back(WorldPoint(BodyOf(end.body), end.point));
    }
  }
  layout_ = MakeLayout(system.bodies, points);
  hatch_ = std::clamp(0.4 * layout_.body_size, 4.0, 9.0);
  connector_ = std::clamp(0.09 * layout_.body_size, 1.2, 6.0);
  // Neither small bodies nor crowded rows shall drown in marks.
  const double rows = std::max(1.0, static_cast<double>(lcp.rows.size()));
  const double spacing = 1.5 * std::sqrt(layout_.width * layout_.drawing_height() / rows);
  const double crowd = layout_.body_size > 0 ? std::min(layout_.body_size, spacing) : spacing;
  mark_ = std::clamp(0.06 * crowd, 0.9, 4.5);
  line_ = std::clamp(0.045 * crowd, 0.4, 1.8);
  arrow_ = std::clamp(0.05 * crowd, 0.8, 2.2);
  if (f == nullptr) return;
  double largest = 0;
  for (const double force : *f) largest = std::isfinite(force) ? std::max(largest, std::abs(force)) : largest;
  if (largest == 0) return;
  arrow_scale_ = std::clamp(crowd, 8.0, 80.0) / largest;
  for (const auto& [at, force, slides_here] : ForcesOf(system, lcp.rows, *f, slides)) {
    const Vec2 length = arrow_scale_ * Mirrored(force);
    constexpr double kVisible = 0.5;
    if (IsFinite(length) && Norm(length) >= kVisible) {
      arrows_.push_back(
          {layout_.ToPage(at), layout_.ToPage(at) + length, Norm(force), slides_here ? kSlideColor : kForceColor});
    }
  }
  for (const auto& [at, sides] : ConesOf(system, lcp.rows, *f)) {
    const Vec2 tip = layout_.ToPage(at);
    cones_ += "M" + Px(tip + arrow_scale_ * Mirrored(sides[0])) + "L" + Px(tip) + "L" +
              Px(tip + arrow_scale_ * Mirrored(sides[1])) + "Z";
  }
}

std::string Picture::TransformOf(const Body& body) const {
  const auto [cos, sin] = SinCos(body.theta);
  std::string text;
  for (const double entry : {cos, -sin, -sin, -cos}) text += std::to_string(entry) + " ";
  return " transform=\"matrix(" + text + Px(layout_.ToPage(body.x)) + ")\"";
}

/// Where a driven body is going: an open circle with an arrow head for its spin, a straight arrow for its travel.
void Picture::AddDrive(const Body& body) {
  constexpr double kReach = 13;
  constexpr double kWidth = 1.6;
  const Vec2 at = layout_.ToPage(body.x);
  const double spin = body.omega != 0 ? body.omega : body.alpha;
  const Vec2 travel = Norm(body.v) > 0 ? body.v : body.acceleration;
  if (spin != 0) {
    const auto point = [&](double degrees) {
      const Rotation turn = SinCos(std::copysign(degrees, spin) * kPi / 180);
      return at + kReach * Vec2{turn.cos, -turn.sin};
    };
    out_ +=
        SvgPath("M" + Px(point(30)) + "A" + Px({kReach, kReach}) + " 0 1 " + (spin > 0 ? "0 " : "1 ") + Px(point(300)),
                {kDrivenFill[1], kWidth});
    out_ += SvgArrow(point(295), point(335), kWidth, kDrivenFill[1]);
  }
  if (Norm(travel) > 0) {
    const Vec2 along = (kReach / Norm(travel)) * Mirrored(travel);
    out_ += SvgArrow(at - along, at + 1.6 * along, kWidth, kDrivenFill[1]);
  }
}

void Picture::AddBody(const Body& body) {
  out_ += "<g" + TransformOf(body) + "><title>" + Escape(Tooltip(body)) + "</title>";
  const BodyPaths paths = PathsOf(body, layout_.scale, hatch_);
  const std::string pattern = "url(#" + PatternId(IsDriven(body)) + ")";
  if (!body.outline.empty()) {
    out_ += SvgPath(paths.fill,
                    {.fill = body.fixed ? std::string_view(pattern) : kBodyFill, .more = " fill-rule=\"evenodd\""});
  }
  for (std::size_t kind = 0; kind < paths.edges.size(); ++kind) {
    if (paths.edges[kind].empty()) continue;
    out_ += SvgPath(paths.edges[kind], {kEdgeStyles[kind].color, body.fixed ? std::max(line_, 1.2) : line_});
  }
  double arm = 0;  // of the cross at the centre of mass
  if (!body.fixed && body.outline.empty()) {
    // Only joints and loads hold it.
    arm = std::max(2.0, connector_);
    out_ += SvgCircle({}, arm, {"#888888", 1, kBodyFill});
  } else if (!body.fixed && layout_.scale * ExtentOf(BoundsOf(body)) > kSmallBody) {
    arm = std::clamp(0.04 * layout_.body_size, 1.5, 4.0);
  }
  const std::string a = Px(arm);
  if (arm > 0) out_ += SvgPath("M-" + a + " 0L" + a + " 0M0 -" + a + "L0 " + a, {"#888888", 0.8});
  out_ += "</g>\n";
  if (IsDriven(body)) AddDrive(body);
}

void Picture::AddConnectors() {
  for (const Connector& connector : connectors_) {
    if (connector.path.empty()) continue;
    out_ += SvgPath(PiecesPath(connector.path, layout_.scale),
                    {kSoftInkColor, std::max(0.5, 0.7 * line_), "none",
                     " stroke-dasharray=\"6 3 1 3\"" + TransformOf(BodyOf(connector.end2.body))});
  }
  const double radius = std::max(1.2, 0.8 * connector_);
  for (const Connector& connector : connectors_) {
    const Vec2 from = PageOf(connector.end1);
    const Vec2 to = PageOf(connector.end2);
    if (connector.type == "pin") {
      out_ += PinShape(0.5 * (from + to), radius);
    } else if (connector.path.empty()) {
      out_ += ConnectorShape(connector, from, to, connector_, connector.length * layout_.scale);
    }
  }
  for (const RowInfo& row : lcp_.rows) {
    const Constraint& joint = system_.constraints[static_cast<std::size_t>(row.constraint)];
    if (joint.type == ConstraintType::kPathJoint) out_ += SliderShape(PageOf(row), Mirrored(row.n), radius);
  }
}

void Picture::AddContacts() {
  if (!cones_.empty()) out_ += SvgPath(cones_, {kConeColor, 0.5 * line_, kConeColor, " fill-opacity=\"0.18\""});
  for (const RowInfo& row : lcp_.rows) {
    const Vec2 half = (2.2 * mark_) * Mirrored(row.n);
    if (!IsContact(row)) continue;
    out_ +=
        SvgPath("M" + Px(PageOf(row) - half) + "L" + Px(PageOf(row) + half), {kInkColor, std::max(0.4, 0.6 * line_)});
  }
  for (const Arrow& arrow : arrows_) out_ += SvgArrow(arrow.from, arrow.to, arrow_, arrow.color);
  for (std::size_t i = 0; i < kinds_.size(); ++i) {
    if (!IsContact(lcp_.rows[i])) continue;
    const Vec2 p = PageOf(lcp_.rows[i]);
    out_ += "<use href=\"#" + MarkId(kinds_[i]) + "\" x=\"" + Px(p.x) + "\" y=\"" + Px(p.y) + "\"/>\n";
  }
}

/// Values beside the arrows' heads, each where it meets nothing else; left out where there is no such place.
void Picture::AddLabels() {
  constexpr std::size_t kMaxLabels = 40;
  constexpr double kSmallestLabelled = 30;  // body size
  const bool readable = layout_.body_size == 0 || layout_.body_size >= kSmallestLabelled;
  if (arrows_.size() > kMaxLabels || !readable) return;
  std::vector<Bounds> taken;
  const auto box = [](Vec2 p, Vec2 half) { return Bounds(PointOf(p - half), PointOf(p + half)); };
  // A slanted line as a chain of boxes; the box of the whole would shut out half the picture.
  const auto take_line = [&](Vec2 from, Vec2 to) {
    constexpr int kPieces = 8;
    for (int k = 0; k <= kPieces; ++k) {
      taken.push_back(box(from + (static_cast<double>(k) / kPieces) * (to - from), {3, 3}));
    }
  };
  for (const Arrow& arrow : arrows_) take_line(arrow.from, arrow.to);
  for (const Connector& connector : connectors_) take_line(PageOf(connector.end1), PageOf(connector.end2));
  for (const RowInfo& row : lcp_.rows) taken.push_back(box(PageOf(row), {1.5 * mark_, 1.5 * mark_}));
  const Bounds page(Eigen::Vector2d(0, 0), Eigen::Vector2d(layout_.width * layout_.strips, layout_.height));
  // The largest first: they say most.
  std::stable_sort(arrows_.begin(), arrows_.end(),
                   [](const Arrow& a, const Arrow& b) { return a.newtons > b.newtons; });
  for (const Arrow& arrow : arrows_) {
    constexpr double kHeight = 12;
    constexpr double kCharacter = 7;  // of the wider fonts that stand in for Helvetica
    const std::string text = Short(arrow.newtons) + " N";
    const Vec2 half{kCharacter * static_cast<double>(text.size()) / 2 + 1, kHeight / 2};
    const Vec2 along = Unit(arrow.to - arrow.from);
    const double beyond = std::abs(along.x) * half.x + std::abs(along.y) * half.y + 4;
    const double beside = std::abs(along.y) * half.x + std::abs(along.x) * half.y + 6;
    for (const Vec2 offset : {beyond * along, beside * Perp(along), -beside * Perp(along)}) {
      const Vec2 at = arrow.to + offset;
      const Bounds place = box(at, half);
      const auto meets = [&](const Bounds& other) { return place.intersects(other); };
      if (!page.contains(place) || std::any_of(taken.begin(), taken.end(), meets)) continue;
      taken.push_back(place);
      out_ += SvgText(at + Vec2{0, 4}, 11, text,
                      " text-anchor=\"middle\" fill=\"#9A4300\" stroke=\"#FFFFFF\" stroke-width=\"2.5\""
                      " paint-order=\"stroke\"");
      break;
    }
  }
}

std::vector<LegendItem> Picture::Legend() const {
  constexpr double kArrow = 70;
  constexpr double kBar = 90;
  std::vector<LegendItem> items = LegendOf(system_.bodies, connectors_);
  for (std::size_t kind = 0; kind < kContactNames.size(); ++kind) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < kinds_.size(); ++i) {
      if (IsContact(lcp_.rows[i]) && static_cast<std::size_t>(kinds_[i]) == kind) ++count;
    }
    if (count == 0) continue;
    items.push_back({12,
                     "<g transform=\"translate(6 0)\">" + SvgPath("M0 -9v18", {kInkColor, 1}) +
                         MarkShape(static_cast<RowKind>(kind), 4.2) + "</g>",
                     Counted(kContactNames[kind], count)});
  }
  if (arrow_scale_ > 0) {
    const double force = RoundDown(kArrow / arrow_scale_);
    const double length = force * arrow_scale_;
    items.push_back({length, SvgArrow({}, {length, 0}, arrow_, kForceColor), Short(force) + " N"});
  }
  if (!cones_.empty()) items.push_back(ConeItem());
  if (loads_ != nullptr && Norm(loads_->gravity) > 0) {
    const double g = Norm(loads_->gravity);
    const Vec2 half = (9 / g) * Mirrored(loads_->gravity);
    items.push_back(
        {18, SvgArrow(Vec2{9, 0} - half, Vec2{9, 0} + half, 1.4, kInkColor), "gravity " + Short(g) + " m/s\u00B2"});
  }
  const double distance = RoundDown(kBar / layout_.scale);
  const double bar = distance * layout_.scale;
  items.push_back({bar, SvgPath("M0 -4v8m0 -4h" + Px(bar) + "m0 -4v8", {kInkColor, 1.4}), Short(distance) + " m"});
  return items;
}

/// Places the items from left to right, in as many lines as they need. @return the height of all
double Picture::AddLegend(double top) {
  constexpr double kLine = 24;
  constexpr double kCharacterWidth = 6.6;
  Vec2 at{kPagePadding, top + kLine / 2};
  for (const auto& [symbol_width, symbol, text] : Legend()) {
    const double width = symbol_width + 8 + kCharacterWidth * static_cast<double>(text.size());
    if (at.x > kPagePadding && at.x + width > kPageWidth - kPagePadding) at = {kPagePadding, at.y + kLine};
    out_ += "<g transform=\"translate(" + Px(at) + ")\">" + symbol +
            SvgText({symbol_width + 7, 4.5}, 13, text, " fill=\"" + std::string(kInkColor) + '"') + "</g>\n";
    at.x += width + 20;
  }
  return at.y + kLine / 2 - top;
}

void Picture::AddTitle(const std::string& caption) {
  const auto movable =
      std::count_if(system_.bodies.begin(), system_.bodies.end(), [](const Body& body) { return !body.fixed; });
  const std::size_t rows = lcp_.rows.size();
  out_ += SvgText({kPagePadding, 26}, 16, system_.name, " font-weight=\"bold\" fill=\"" + std::string(kInkColor) + '"');
  out_.erase(out_.rfind("</text>"));
  out_ += "<tspan font-weight=\"normal\" font-size=\"13\" dx=\"14\" fill=\"#555555\">" + std::to_string(movable) +
          (movable == 1 ? " movable body, " : " movable bodies, ") + std::to_string(rows) +
          (rows == 1 ? " row" : " rows") + (caption.empty() ? "" : ", " + Escape(caption)) + "</tspan></text>\n";
}

/// The scene stands there once, as a definition that every strip is a window on.
std::string Picture::Render(const std::string& caption) {
  out_ = "<defs>\n";
  for (const bool driven : {false, true}) {
    const auto& [ground, stripes] = driven ? kDrivenFill : kFixedFill;
    // In the frame of bodies, with y up.
    out_ += "<pattern id=\"" + PatternId(driven) +
            "\" width=\"6\" height=\"6\" patternUnits=\"userSpaceOnUse\" patternTransform=\"rotate(" +
            (driven ? "45" : "-45") + ")\">" + SvgPath("M0 0h6v6h-6Z", {.fill = ground}) +
            SvgPath("M0 0v6", {stripes, 1.6}) + "</pattern>\n";
  }
  // Once each: a scene may have thousands of rows.
  for (std::size_t kind = 0; kind < kContactNames.size(); ++kind) {
    const auto row_kind = static_cast<RowKind>(kind);
    out_ += "<g id=\"" + MarkId(row_kind) + "\">" + MarkShape(row_kind, mark_) + "</g>\n";
  }
  out_ += "<g id=\"" + id_ + "-scene\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n";
  for (const bool fixed : {true, false}) {
    for (const Body& body : system_.bodies) {
      if (body.fixed == fixed) AddBody(body);
    }
  }
  AddConnectors();
  AddContacts();
  AddLabels();
  out_ += "</g>\n</defs>\n<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n";
  AddTitle(caption);
  const std::string size = Px(layout_.width) + "\" height=\"" + Px(layout_.height);
  for (int strip = 0; strip < layout_.strips; ++strip) {
    out_ += "<svg x=\"" + Px((kPageWidth - layout_.width) / 2) + "\" y=\"" +
            Px(kTitleHeight + strip * (layout_.height + kStripGap)) + "\" width=\"" + size + "\" viewBox=\"" +
            Px(strip * layout_.width) + " 0 " + Px({layout_.width, layout_.height}) +
            "\" overflow=\"hidden\"><use href=\"#" + id_ + "-scene\"/></svg>\n";
  }
  const double legend_top = kTitleHeight + layout_.drawing_height() + 14;
  const std::string height = Px(legend_top + AddLegend(legend_top) + kPagePadding);
  const std::string width = Px(kPageWidth);
  return "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + width + " " + height + "\" width=\"" + width +
         "\" height=\"" + height + "\" font-family=\"Helvetica, Arial, sans-serif\">\n<title>" + Escape(system_.name) +
         "</title>\n" + out_ + "</svg>\n";
}

}  // namespace

std::string RenderSvg(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd* f,
                      const Eigen::VectorXd* w, const PictureExtras& extras) {
  const auto rows = static_cast<Index>(lcp.rows.size());
  for (const Eigen::VectorXd* values : {f, w}) {
    if (values != nullptr && values->size() != rows) {
      throw InputError("picture of " + system.name + ": expected " + std::to_string(rows) + " values, found " +
                       std::to_string(values->size()));
    }
  }
  return Picture(system, lcp, f, w, extras.loads).Render(extras.caption);
}

std::optional<PictureSolution> SolveForPicture(const LcpProblem& problem, const std::string& solver_key,
                                               double limit_s) {
  std::vector<std::string> keys = {solver_key};
  if (solver_key.empty()) {
    keys.clear();
    for (const SolverEntry& entry : AllSolvers()) {
      if (entry.available) keys.push_back(entry.key);
    }
    limit_s = std::min(limit_s, kPictureLimit);
  }
  const double end = SteadyNow() + limit_s;
  for (const std::string& key : keys) {
    const std::unique_ptr<LcpSolver> solver = MakeSolver(key);
    if (problem.size() == 0) return std::nullopt;
    LcpResult result;
    LcpOptions options;
    options.time_limit_s = end - SteadyNow();
    if (!(options.time_limit_s > 0)) break;
    solver->Solve(problem, options, &result);
    const Verdict verdict = Verify(problem, result, options.tolerance);
    const bool is_answer = result.f.size() == problem.size() && result.f.allFinite();
    if (!is_answer || (solver_key.empty() && !verdict.passes)) continue;
    const std::string doubt = ": " + std::string(ToString(result.status)) + ", not verified";
    return PictureSolution{result.f, verdict.metrics.w, key + (verdict.passes ? "" : doubt)};
  }
  return std::nullopt;
}

}  // namespace lcpbench
