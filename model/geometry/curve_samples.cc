#include "model/geometry/curve_samples.h"

#include <algorithm>
#include <numbers>

#include "model/geometry/trig.h"

namespace lcpbench {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

}  // namespace

std::vector<double> CurveSamples(const SmoothCurve& curve, const std::vector<Vec2>& outward_normals) {
  std::vector<double> samples;
  samples.reserve(kCurveSamples + curve.ends().size() + 2 * outward_normals.size() + 1);
  const double begin = curve.is_oval() ? -kTwoPi / 2 : -SmoothCurve::kEndSlack;
  const double span = curve.is_oval() ? kTwoPi : 1 + 2 * SmoothCurve::kEndSlack;
  const int intervals = curve.is_oval() ? kCurveSamples : kCurveSamples - 1;
  for (int i = 0; i < kCurveSamples; ++i) samples.push_back(begin + span * i / intervals);
  for (const double end : curve.ends()) samples.push_back(end);
  for (const Vec2 n : outward_normals) {
    for (const double tau : curve.WithNormal(n)) samples.push_back(tau);
  }
  std::sort(samples.begin(), samples.end());
  if (curve.is_oval()) samples.push_back(samples.front() + kTwoPi);
  return samples;
}

std::vector<Vec2> EvenDirections() {
  std::vector<Vec2> directions;
  directions.reserve(kCurveSamples);
  for (int i = 0; i < kCurveSamples; ++i) {
    const Rotation r = SinCos(kTwoPi * i / kCurveSamples);
    directions.push_back({r.cos, r.sin});
  }
  return directions;
}

std::vector<Vec2> FacingNormals(const SmoothCurve& curve) {
  const std::vector<double> samples = CurveSamples(curve, {});
  std::vector<Vec2> normals;
  normals.reserve(samples.size());
  for (const double tau : samples) normals.push_back(-ToVec2(curve.At(curve.Place(tau)).N));
  return normals;
}

double NarrowedSignChange(double low, double high, const std::function<double(double)>& f) {
  constexpr int kBisections = 30;
  const bool negative = f(low) < 0;
  for (int i = 0; i < kBisections; ++i) {
    const double middle = low + (high - low) / 2;
    if ((f(middle) < 0) == negative) {
      low = middle;
    } else {
      high = middle;
    }
  }
  return low + (high - low) / 2;
}

}  // namespace lcpbench
