#include "model/geometry/smooth_curve.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "model/geometry/feature.h"

namespace lcpbench {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;
using Wide = DoubleDouble;

}  // namespace

template <class T>
void SmoothCurve::SetFrame(const PlacedFeature& placed, const BezierEdge& bezier, Angles angles) {
  auto& frame = std::get<Frame<T>>(frames_);
  const VecOf<T> body = TurnOf<T>(placed.rotation, placed.theta, angles);
  if (is_oval_) {
    frame.turn = Turn(body, TurnOf<T>(SinCos(oval_.phi), oval_.phi, angles));
    frame.offset = Turn(body, Lift<T>(oval_.center));
  } else {
    for (std::size_t i = 0; i < bezier.P.size(); ++i) frame.P[i] = Turn(body, Lift<T>(bezier.P[i]));
  }
}

SmoothCurve::SmoothCurve(const PlacedFeature& placed, Angles angles) {
  BezierEdge bezier;
  std::visit(Overloaded{[&](const EllipseEdge& e) { oval_ = e.Shape(); },
                        [&](const SuperellipseEdge& e) { oval_ = e.Shape(); },
                        [&](const BezierEdge& e) {
                          bezier = e;
                          is_oval_ = false;
                        },
                        [](const Vertex&) {}, [](const StraightEdge&) {}, [](const ArcEdge&) {}},
             placed.feature);
  SetFrame<double>(placed, bezier, angles);
  SetFrame<Wide>(placed, bezier, angles);
  if (is_oval_) {
    size_ = std::max(oval_.a, oval_.b);
    // The least curvature of the ellipse with these semi-axes.
    if (oval_.m > 2) curvature_floor_ = std::min(oval_.a, oval_.b) / (size_ * size_);
    return;
  }
  const auto& P = std::get<Frame<double>>(frames_).P;
  size_ = Norm(P[1] - P[0]) + Norm(P[2] - P[1]) + Norm(P[3] - P[2]);
  curvature_floor_ = 1 / size_;
  ends_ = BezierEdge{P}.Inflections();
}

CurvePlace<Wide> SmoothCurve::FromParameter(double s) const {
  if (!is_oval_) return {s, 0.0};
  const Rotation r = SinCos(s);
  if (!oval_.by_polar_angle) return LiftRotation<Wide>(r);
  return Unit(VecOf<Wide>{TwoProduct(oval_.b, r.cos), TwoProduct(oval_.a, r.sin)});
}

double SmoothCurve::Parameter(const CurvePlace<Wide>& place) const {
  if (!is_oval_) return place.x.hi;
  return oval_.by_polar_angle ? std::atan2(oval_.b * place.y.hi, oval_.a * place.x.hi)
                              : std::atan2(place.y.hi, place.x.hi);
}

CurvePlace<double> SmoothCurve::Place(double tau) const {
  return is_oval_ ? LiftRotation<double>(SinCos(tau)) : CurvePlace<double>{tau, 0};
}

CurvePlace<Wide> SmoothCurve::WidePlace(double tau) const {
  return is_oval_ ? LiftRotation<Wide>(SinCos(tau)) : CurvePlace<Wide>{tau, 0.0};
}

CurvePlace<Wide> SmoothCurve::Moved(const CurvePlace<Wide>& place, Wide step) const {
  if (!is_oval_) {
    const Wide s = place.x + step;
    if (s < -kBezierMargin) return {-kBezierMargin, 0.0};
    if (s > 1 + kBezierMargin) return {1 + kBezierMargin, 0.0};
    return {s, 0.0};
  }
  const Wide half = Wide(0.5) * step;
  const Wide square = half * half;
  const Wide norm = Wide(1) + square;
  return Turn(VecOf<Wide>{(Wide(1) - square) / norm, step / norm}, place);
}

std::vector<double> SmoothCurve::WithNormal(Vec2 n) const {
  const auto& frame = std::get<Frame<double>>(frames_);
  if (!is_oval_) return BezierEdge{frame.P}.WithNormal(n, kEndSlack);
  return {oval_.TauWithNormal(Rotate({frame.turn.x, -frame.turn.y}, SignOf(oval_.side) * n))};
}

int SmoothCurve::Piece(double tau) const {
  int piece = 0;
  for (std::size_t i = 1; i + 1 < ends_.size(); ++i) piece += tau > ends_[i] ? 1 : 0;
  return piece;
}

std::vector<double> SmoothCurve::Samples(const std::vector<Vec2>& outward_normals) const {
  std::vector<double> samples;
  samples.reserve(kSamples + ends_.size() + 2 * outward_normals.size() + 1);
  const double begin = is_oval_ ? -kTwoPi / 2 : -kEndSlack;
  const double span = is_oval_ ? kTwoPi : 1 + 2 * kEndSlack;
  const int intervals = is_oval_ ? kSamples : kSamples - 1;
  for (int i = 0; i < kSamples; ++i) samples.push_back(begin + span * i / intervals);
  samples.insert(samples.end(), ends_.begin(), ends_.end());
  for (const Vec2 n : outward_normals) {
    for (const double tau : WithNormal(n)) samples.push_back(tau);
  }
  std::sort(samples.begin(), samples.end());
  if (is_oval_) samples.push_back(samples.front() + kTwoPi);
  return samples;
}

std::vector<Vec2> SmoothCurve::FacingNormals() const {
  std::vector<Vec2> normals;
  for (const double tau : Samples({})) normals.push_back(-At(Place(tau)).N);
  return normals;
}

}  // namespace lcpbench
