#include <algorithm>
#include <cmath>
#include <vector>

#include "model/scenes/picture_parts.h"
#include "model/scenes/svg_text.h"

namespace lcpbench {
namespace {

/// One force on the page; the two rows of a pin give one.
struct Force {
  Vec2 from;
  Vec2 to;
  double newtons = 0;
};

bool IsContact(const Picture& picture, const RowInfo& row) {
  return picture.system.constraints[static_cast<std::size_t>(row.constraint)].type == ConstraintType::kContact;
}

/// Whether the force on body 2 is shown: of a fixed body it would say nothing.
bool OnBody2(const Picture& picture, const RowInfo& row) {
  const Constraint& constraint = picture.system.constraints[static_cast<std::size_t>(row.constraint)];
  return picture.system.bodies[static_cast<std::size_t>(constraint.body1)].fixed;
}

/// Where the row's force acts on the body it is shown on.
Vec2 PointOf(const Picture& picture, const RowInfo& row) {
  const ConstraintType type = picture.system.constraints[static_cast<std::size_t>(row.constraint)].type;
  const bool distant = type == ConstraintType::kRod || type == ConstraintType::kRope;
  return picture.layout.ToPage(distant ? (OnBody2(picture, row) ? row.p2 : row.p1) : 0.5 * (row.p1 + row.p2));
}

std::vector<Force> CollectForces(const Picture& picture) {
  std::vector<Force> forces;
  if (picture.arrow_scale == 0) return forces;
  const auto& rows = picture.lcp.rows;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Vec2 total = (*picture.f)[static_cast<Index>(i)] * rows[i].n;
    if (rows[i].axis == 'x' && i + 1 < rows.size() && rows[i + 1].axis == 'y') {
      total = total + (*picture.f)[static_cast<Index>(i + 1)] * rows[i + 1].n;
      ++i;
    }
    if (OnBody2(picture, rows[i])) total = -total;
    const Vec2 length = picture.arrow_scale * Vec2{total.x, -total.y};
    constexpr double kVisible = 0.5;  // [px]
    if (!IsFinite(length) || Norm(length) < kVisible) continue;
    const Vec2 from = PointOf(picture, rows[i]);
    forces.push_back({from, from + length, Norm(total)});
  }
  return forces;
}

void AppendNormal(const Picture& picture, const RowInfo& row, std::string* out) {
  const Vec2 p = PointOf(picture, row);
  const Vec2 half = (2.2 * picture.mark) * Vec2{row.n.x, -row.n.y};
  *out += "<path d=\"M" + Px(p - half) + "L" + Px(p + half) + "\" stroke=\"" + std::string(kInkColor) +
          "\" stroke-width=\"" + Px(std::max(0.4, 0.6 * picture.line)) + "\"/>\n";
}

std::string MarkId(const Picture& picture, RowKind kind) {
  return picture.id + "-mark" + std::to_string(static_cast<int>(kind));
}

/// An axis-parallel box on the page, for keeping labels apart.
struct Box {
  Vec2 low;
  Vec2 high;
  bool Meets(const Box& other) const {
    return low.x < other.high.x && other.low.x < high.x && low.y < other.high.y && other.low.y < high.y;
  }
};

/// Values beside the arrows' heads, each where it meets nothing else; left out where there is no such place.
class ForceLabels {
 public:
  ForceLabels(const Picture& picture, const std::vector<Force>& forces) {
    page_ = {{0, 0}, {picture.layout.width * picture.layout.strips, picture.layout.height}};
    for (const Force& force : forces) {
      // A slanted arrow as a chain of boxes; the box of the whole would shut out half the picture.
      constexpr int kPieces = 8;
      for (int k = 0; k <= kPieces; ++k) {
        const Vec2 p = force.from + (static_cast<double>(k) / kPieces) * (force.to - force.from);
        taken_.push_back({p - Vec2{3, 3}, p + Vec2{3, 3}});
      }
    }
    for (const RowInfo& row : picture.lcp.rows) {
      const Vec2 p = PointOf(picture, row);
      const Vec2 reach{1.5 * picture.mark, 1.5 * picture.mark};
      taken_.push_back({p - reach, p + reach});
    }
  }

  void Append(const Force& force, std::string* out) {
    constexpr double kHeight = 12;
    constexpr double kCharacter = 6.2;
    const std::string text = Short(force.newtons) + " N";
    const Vec2 half{kCharacter * static_cast<double>(text.size()) / 2 + 1, kHeight / 2};
    const Vec2 along = (1 / Norm(force.to - force.from)) * (force.to - force.from);
    const double beyond = std::abs(along.x) * half.x + std::abs(along.y) * half.y + 4;
    const double beside = std::abs(along.y) * half.x + std::abs(along.x) * half.y + 6;
    for (const Vec2 offset : {beyond * along, beside * Perp(along), -beside * Perp(along)}) {
      const Vec2 at = force.to + offset;
      const Box box{at - half, at + half};
      const bool inside = box.low.x >= page_.low.x && box.low.y >= page_.low.y && box.high.x <= page_.high.x &&
                          box.high.y <= page_.high.y;
      if (!inside || std::any_of(taken_.begin(), taken_.end(), [&](const Box& other) { return box.Meets(other); })) {
        continue;
      }
      taken_.push_back(box);
      *out += "<text x=\"" + Px(at.x) + "\" y=\"" + Px(at.y + 4) +
              "\" text-anchor=\"middle\" font-size=\"11\" fill=\"#9A4300\" stroke=\"#FFFFFF\" stroke-width=\"2.5\" "
              "paint-order=\"stroke\">" +
              text + "</text>\n";
      return;
    }
  }

 private:
  Box page_;
  std::vector<Box> taken_;
};

}  // namespace

void AppendArrow(Vec2 from, Vec2 to, double width, std::string_view color, std::string* out) {
  const Vec2 along = to - from;
  const double length = Norm(along);
  if (!(length > 0)) return;
  const Vec2 unit = (1 / length) * along;
  const double head = std::min(4 * width, 0.6 * length);
  const Vec2 neck = to - head * unit;
  const Vec2 side = (0.45 * head) * Perp(unit);
  *out += "<path d=\"M" + Px(from) + "L" + Px(neck) + "\" stroke=\"" + std::string(color) + "\" stroke-width=\"" +
          Px(width) + "\" stroke-linecap=\"butt\"/><path d=\"M" + Px(to) + "L" + Px(neck + side) + "L" +
          Px(neck - side) + "Z\" fill=\"" + std::string(color) + "\"/>\n";
}

std::string MarkShape(RowKind kind, double radius) {
  const std::string stroke = "\" stroke-width=\"" + Px(std::max(0.5, 0.3 * radius)) + "\"/>";
  const std::string disc = "<circle r=\"" + Px(radius) + "\" fill=\"";
  switch (kind) {
    case RowKind::kPlain:
      return disc + "#777777\"/>";
    case RowKind::kActive:
      return disc + std::string(kForceColor) + "\"/>";
    case RowKind::kDegenerate:
      return disc + "#FFFFFF\" stroke=\"" + std::string(kForceColor) + stroke;
    case RowKind::kOpen: {
      const std::string h = Px(1.35 * radius);
      return "<path d=\"M0 -" + h + "L" + h + " 0L0 " + h + "L-" + h + " 0Z\" fill=\"#FFFFFF\" stroke=\"" +
             std::string(kInkColor) + stroke;
    }
    case RowKind::kJoint:
      break;
  }
  return {};
}

void AppendMarks(const Picture& picture, std::string* out) {
  // Once each: a scene may have thousands of rows.
  for (const RowKind kind : kRowKinds) {
    if (kind == RowKind::kJoint) continue;
    *out += "<g id=\"" + MarkId(picture, kind) + "\">" + MarkShape(kind, picture.mark) + "</g>\n";
  }
}

void AppendRows(const Picture& picture, std::string* out) {
  const auto& rows = picture.lcp.rows;
  for (const RowInfo& row : rows) {
    if (IsContact(picture, row)) AppendNormal(picture, row, out);
  }
  std::vector<Force> forces = CollectForces(picture);
  for (const Force& force : forces) AppendArrow(force.from, force.to, picture.arrow, kForceColor, out);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!IsContact(picture, rows[i])) continue;
    const Vec2 p = PointOf(picture, rows[i]);
    *out += "<use href=\"#" + MarkId(picture, picture.kinds[i]) + "\" x=\"" + Px(p.x) + "\" y=\"" + Px(p.y) + "\"/>\n";
  }
  // The largest first: they say most.
  constexpr std::size_t kMaxLabels = 40;
  constexpr double kSmallestLabelled = 30;  // body size [px]
  const bool readable = picture.layout.body_size == 0 || picture.layout.body_size >= kSmallestLabelled;
  if (forces.size() > kMaxLabels || !readable) return;
  ForceLabels labels(picture, forces);
  std::stable_sort(forces.begin(), forces.end(), [](const Force& a, const Force& b) { return a.newtons > b.newtons; });
  for (const Force& force : forces) labels.Append(force, out);
}

}  // namespace lcpbench
