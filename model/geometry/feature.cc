#include "model/geometry/feature.h"

#include <limits>
#include <numbers>
#include <type_traits>

#include "support/input_error.h"
#include "support/number_text.h"

namespace lcpbench {
namespace {

std::string Text(double value) { return NumberText(value); }
std::string Text(const std::array<Vec2, 4>& P) {
  return Text(P[0]) + ", " + Text(P[1]) + ", " + Text(P[2]) + ", " + Text(P[3]);
}

// Calls visit(number) for all numbers of a feature.
template <class Visit>
void ForEachNumber(const Feature& feature, const Visit& visit) {
  const auto take = [&](const char* /*name*/, const auto& value) {
    if constexpr (requires { value.x; }) {
      visit(value.x);
      visit(value.y);
    } else if constexpr (requires { value[0].x; }) {
      for (const Vec2 p : value) {
        visit(p.x);
        visit(p.y);
      }
    } else {
      visit(static_cast<double>(value));
    }
  };
  std::visit([&](const auto& e) { ForEachField(e, take); }, feature);
}

// What is wrong with the range of a piece whose s is an angle; "" if nothing is.
std::string WhyInvalidAngles(double s_begin, double s_end, Side side) {
  // Angles of many turns would have lost their digits.
  constexpr double kMaxAngle = 1e3;
  constexpr double kFullTurn = 2 * std::numbers::pi * (1 + 4 * std::numeric_limits<double>::epsilon());
  if ((s_begin < s_end) != (side == Side::kConvex)) {
    return side == Side::kConvex ? "a convex edge runs counter-clockwise: expected s_begin < s_end"
                                 : "a concave edge runs clockwise: expected s_begin > s_end";
  }
  if (std::max(std::abs(s_begin), std::abs(s_end)) > kMaxAngle) return "angles must lie within -1000..1000 rad";
  return std::abs(s_end - s_begin) <= kFullTurn ? "" : "the edge runs over more than one full turn";
}

}  // namespace

std::string Text(Vec2 p) { return "(" + NumberText(p.x) + ", " + NumberText(p.y) + ")"; }

std::string WhyInvalid(const OutlinePiece& piece) {
  const auto [curve, s_begin, s_end] = piece;
  if (!(std::isfinite(s_begin) && std::isfinite(s_end))) return "a curve parameter is not finite";
  std::string why = WhyInvalid(ToFeature(curve));
  if (!why.empty()) return why;
  if (s_begin == s_end) return "zero-length edge: s_begin = s_end";
  return std::visit(
      [begin = s_begin, end = s_end](const auto& e) -> std::string {
        if constexpr (std::decay_t<decltype(e)>::kIsAngle) return WhyInvalidAngles(begin, end, e.side);
        if (begin > end) return "the material is on the left of increasing s: expected s_begin < s_end";
        return begin >= 0 && end <= 1 ? "" : "the parameter range must lie within 0..1";
      },
      curve);
}

Feature ToFeature(const OutlineCurve& curve) {
  return std::visit([](const auto& edge) -> Feature { return edge; }, curve);
}

bool IsSearched(const Feature& feature) {
  return std::visit(Overloaded{[](const Vertex&) { return false; },
                               [](const auto& curve) { return curve.kKind == CurveKind::kSearched; }},
                    feature);
}

double Reach(const OutlinePiece& piece) {
  const double angle = std::max({1.0, std::abs(piece.s_begin), std::abs(piece.s_end)});
  return std::visit([angle](const auto& e) { return e.Reach(angle); }, piece.edge);
}

std::vector<double> EnclosedCuts(const OutlinePiece& piece) {
  const auto [curve, s_begin, s_end] = piece;
  return std::visit(
      [begin = s_begin, end = s_end](const auto& e) {
        if constexpr (requires { e.EnclosedCuts(begin, end); }) return e.EnclosedCuts(begin, end);
        constexpr double kRoundingSlack = 1 - 1e-12;  // a full turn makes four parts, not five
        const double quarters = std::abs(end - begin) / (std::numbers::pi / 2);
        const double parts = std::max(2.0, std::ceil(quarters * kRoundingSlack));
        std::vector<double> cuts;
        for (double k = 0; k < parts; ++k) cuts.push_back(begin + (end - begin) * k / parts);
        cuts.push_back(end);
        return cuts;
      },
      curve);
}

Enclosure Enclose(const OutlineCurve& curve, double s_begin, double s_end) {
  const Vec2 begin = CurvePoint(curve, s_begin);
  const Vec2 end = CurvePoint(curve, s_end);
  const auto enclose = [&](const auto& e) -> Enclosure {
    if constexpr (requires { e.Enclose(s_begin, s_end, begin, end); }) return e.Enclose(s_begin, s_end, begin, end);
    const double sense = s_begin < s_end ? 1 : -1;
    const Vec2 first = sense * UnitOrZero(e.Direction(s_begin));
    const Vec2 second = sense * UnitOrZero(e.Direction(s_end));
    // A triangle whose tangents turn by t is at most chord / 2 tan(t / 2) high. That has no rounding errors for small
    // t, where the tangents' intersection would have few digits left.
    constexpr double kParallel = 1e-12;
    const double sine = Cross(first, second);
    const double cosine = Dot(first, second);
    double height = std::numeric_limits<double>::infinity();
    if (cosine >= 0) height = Norm(end - begin) / 2 * std::abs(sine) / (1 + cosine);
    if (std::abs(sine) > kParallel) {
      const double reach = Cross(end - begin, second) / sine;
      height = std::min(height, DistanceToSegment(begin + reach * first, begin, end));
    }
    return {height, first, second};
  };
  return std::visit(enclose, curve);
}

OutlinePiece Transformed(const OutlinePiece& piece, double angle, Vec2 shift) {
  const Rotation rotation = SinCos(angle);
  OutlinePiece moved = piece;
  ForEachPoint(moved.edge, [&](Vec2& c) { c = Rotate(rotation, c) + shift; });
  std::visit(
      [&](auto& e) {
        if constexpr (requires { e.phi; }) {
          e.phi += angle;
        } else if constexpr (std::decay_t<decltype(e)>::kIsAngle) {
          moved.s_begin += angle;
          moved.s_end += angle;
        }
      },
      moved.edge);
  return moved;
}

std::vector<double> NumbersOf(const Feature& feature) {
  std::vector<double> numbers = {static_cast<double>(feature.index())};
  ForEachNumber(feature, [&](double number) { numbers.push_back(number); });
  return numbers;
}

std::string WhyInvalid(const Feature& feature) {
  bool finite = true;
  ForEachNumber(feature, [&](double number) { finite = finite && std::isfinite(number); });
  if (!finite) return "a number is not finite";
  return std::visit([](const auto& e) { return e.WhyInvalid(); }, feature);
}

void RequireValid(const Feature& feature) {
  const std::string why = WhyInvalid(feature);
  if (!why.empty()) throw InputError("invalid geometry, " + why + ": " + Describe(feature));
}

void RequireValidPiece(const OutlinePiece& piece, const std::string& where) {
  const std::string why = WhyInvalid(piece);
  if (!why.empty()) throw InputError(where + " (" + Describe(ToFeature(piece.edge)) + "): " + why);
}

std::string Describe(const Feature& feature) {
  return std::visit(
      [](const auto& e) {
        std::string text = e.kName;
        if constexpr (requires { e.side; }) text = (e.side == Side::kConvex ? "convex " : "concave ") + text;
        const bool is_named = IsVertex(e) || requires { e.side; };
        const char* before = is_named ? " with " : " edge with ";
        ForEachField(e, [&](const std::string& name, const auto& value) {
          if constexpr (!std::is_same_v<decltype(value), const Side&>) text += before + name + " " + Text(value);
          before = ", ";
        });
        return text;
      },
      feature);
}

}  // namespace lcpbench
