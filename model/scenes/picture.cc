#include "model/scenes/picture.h"

#include <algorithm>
#include <cmath>

#include "model/scenes/picture_parts.h"
#include "model/scenes/svg_text.h"
#include "solvers/lcp/input_error.h"

namespace lcpbench {
namespace {

constexpr double kTitleHeight = 40;  // [px]

std::string Count(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

void AppendTitle(const Picture& picture, const std::string& caption, std::string* out) {
  const auto movable = std::count_if(picture.system.bodies.begin(), picture.system.bodies.end(),
                                     [](const Body& body) { return !body.fixed; });
  std::string text = Count(static_cast<std::size_t>(movable), "movable body", "movable bodies") + ", " +
                     Count(picture.lcp.rows.size(), "row", "rows");
  if (!caption.empty()) text += ", " + caption;
  *out += "<text x=\"" + Px(kPagePadding) + "\" y=\"26\" font-size=\"16\" font-weight=\"bold\" fill=\"" +
          std::string(kInkColor) + "\">" + Escape(picture.system.name) +
          "<tspan font-weight=\"normal\" font-size=\"13\" dx=\"14\" fill=\"#555555\">" + Escape(text) +
          "</tspan></text>\n";
}

/// Where springs and dampers are fastened, world frame.
std::vector<Vec2> EndsOf(const ContactSystem& system, const Loads* loads) {
  std::vector<Vec2> ends;
  const auto add = [&](const auto& connectors) {
    for (const auto& connector : connectors) {
      for (const Attachment& end : {connector.end1, connector.end2}) {
        ends.push_back(ToWorld(system.bodies[static_cast<std::size_t>(end.body)], end.point));
      }
    }
  };
  if (loads == nullptr) return ends;
  add(loads->springs);
  add(loads->dampers);
  return ends;
}

/// The scene once, as a definition that every strip is a window on.
void AppendScene(const Picture& picture, std::string* out) {
  *out += "<defs>\n";
  AppendPatterns(picture, out);
  AppendMarks(picture, out);
  *out += "<g id=\"" + picture.id + "-scene\" stroke-linejoin=\"round\" stroke-linecap=\"round\">\n";
  AppendBodies(picture, out);
  AppendConnectors(picture, out);
  AppendRows(picture, out);
  *out += "</g>\n</defs>\n";
}

std::string Render(const Picture& picture, const std::string& caption) {
  const Layout& layout = picture.layout;
  std::string legend;
  const double legend_top = kTitleHeight + layout.drawing_height() + 14;
  const double page_height = legend_top + AppendLegend(picture, legend_top, &legend) + kPagePadding;

  std::string out = "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 " + Px(kPageWidth) + " " +
                    Px(page_height) + "\" width=\"" + Px(kPageWidth) + "\" height=\"" + Px(page_height) +
                    "\" font-family=\"Helvetica, Arial, sans-serif\">\n";
  out += "<title>" + Escape(picture.system.name) + "</title>\n";
  AppendScene(picture, &out);
  out += "<rect width=\"100%\" height=\"100%\" fill=\"#FFFFFF\"/>\n";
  AppendTitle(picture, caption, &out);
  for (int strip = 0; strip < layout.strips; ++strip) {
    const double x = (kPageWidth - layout.width) / 2;
    const double y = kTitleHeight + strip * (layout.height + kStripGap);
    out += "<svg x=\"" + Px(x) + "\" y=\"" + Px(y) + "\" width=\"" + Px(layout.width) + "\" height=\"" +
           Px(layout.height) + "\" viewBox=\"" + Px(strip * layout.width) + " 0 " + Px(layout.width) + " " +
           Px(layout.height) + "\" overflow=\"hidden\"><use href=\"#" + picture.id + "-scene\"/></svg>\n";
  }
  return out + legend + "</svg>\n";
}

}  // namespace

Picture::Picture(const ContactSystem& drawn, const AssembledLcp& assembled, const Eigen::VectorXd* forces,
                 const Eigen::VectorXd* accelerations, const Loads* drawn_loads)
    : system(drawn),
      lcp(assembled),
      f(forces),
      loads(drawn_loads),
      layout(MakeLayout(drawn, assembled, EndsOf(drawn, drawn_loads))),
      id(Identifier(drawn.name)) {
  Classify(accelerations);
  hatch = std::clamp(0.4 * layout.body_size, 4.0, 9.0);
  connector = std::clamp(0.09 * layout.body_size, 1.2, 6.0);
  // Neither small bodies nor crowded rows shall drown in marks.
  const double area =
      layout.width * layout.drawing_height() / static_cast<double>(std::max<std::size_t>(1, lcp.rows.size()));
  const double spacing = std::sqrt(area);
  const double crowd = layout.body_size > 0 ? std::min(layout.body_size, 1.5 * spacing) : 1.5 * spacing;
  mark = std::clamp(0.06 * crowd, 0.9, 4.5);
  line = std::clamp(0.045 * crowd, 0.4, 1.8);
  arrow = std::clamp(0.05 * crowd, 0.8, 2.2);
  if (f == nullptr) return;
  double largest = 0;
  for (Index i = 0; i < f->size(); ++i) {
    if (std::isfinite((*f)[i])) largest = std::max(largest, std::abs((*f)[i]));
  }
  if (largest > 0) arrow_scale = std::clamp(crowd, 8.0, 80.0) / largest;
}

void Picture::Classify(const Eigen::VectorXd* w) {
  const auto n = static_cast<Index>(lcp.rows.size());
  kinds.assign(lcp.rows.size(), RowKind::kPlain);
  const bool solved = f != nullptr && w != nullptr && n > 0;
  // In one unit, sqrt(A_ii) f and w / sqrt(A_ii), so that rows and the two sides compare.
  Eigen::VectorXd force(solved ? n : 0);
  Eigen::VectorXd motion(solved ? n : 0);
  for (Index i = 0; i < force.size(); ++i) {
    const double diagonal = lcp.problem.DiagonalA()[i];
    const double root = diagonal > 0 ? std::sqrt(diagonal) : 1;
    force[i] = root * (*f)[i];
    motion[i] = (*w)[i] / root;
  }
  constexpr double kZero = 1e-9;
  const double threshold = solved ? kZero * std::max(force.cwiseAbs().maxCoeff(), motion.cwiseAbs().maxCoeff()) : 0;
  for (Index i = 0; i < n; ++i) {
    RowKind& kind = kinds[static_cast<std::size_t>(i)];
    if (lcp.rows[static_cast<std::size_t>(i)].bilateral) {
      kind = RowKind::kJoint;
    } else if (solved) {
      kind = std::max(force[i], motion[i]) <= threshold ? RowKind::kDegenerate
             : force[i] > motion[i]                     ? RowKind::kActive
                                                        : RowKind::kOpen;
    }
  }
}

std::string RenderSvg(const ContactSystem& system, const AssembledLcp& lcp, const Eigen::VectorXd* f,
                      const Eigen::VectorXd* w, const PictureExtras& extras) {
  const auto rows = static_cast<Index>(lcp.rows.size());
  for (const Eigen::VectorXd* values : {f, w}) {
    if (values != nullptr && values->size() != rows) {
      throw InputError("picture of " + system.name + ": expected " + std::to_string(rows) + " values, found " +
                       std::to_string(values->size()));
    }
  }
  return Render(Picture(system, lcp, f, w, extras.loads), extras.caption);
}

}  // namespace lcpbench
