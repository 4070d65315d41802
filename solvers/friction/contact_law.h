#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

/// Internal to solvers/friction/: the formulas of one contact, in scaled variables [docs/friction.md sections 4, 5].
namespace lcpbench {

/// Where a contact or a bounded row stands on the graph of its law.
enum class RowMode : unsigned char {
  kOpen,    ///< f = 0; of a contact
  kClosed,  ///< w_n = 0; f_t follows from f_n (sliding), or is 0
  kStick,   ///< w = 0; of a bounded row: between its bounds
  kUp,      ///< slips with w_t >= 0, f_t = -mu f_n; of a bounded row: at its lower bound
  kDown,    ///< slips with w_t <= 0, f_t = mu f_n; of a bounded row: at its upper bound
};

/// The direction in which a contact slips, the sign of w_t; `given` where the mode does not say it (kClosed: that of a
/// sliding row).
inline int SlipOf(RowMode mode, int given) { return mode == RowMode::kUp ? 1 : mode == RowMode::kDown ? -1 : given; }

/// Numbers of the laws of contacts.
struct ContactLaw {
  /// As the verifier's: forces up to this part of a contact's loads are rounding; rho is relative to no less than that
  /// part of all loads.
  static constexpr double kPartOfLoad = 0x1p-46;
  static constexpr double kLeastScale = 0x1p-20;
  /// Roundings of a sum over a row, beside one for each term.
  static constexpr double kTermsBesideRows = 64;

  static double Square(double x) { return x * x; }

  /// Of a contact that can stick, by phi - omega [Alart, Curnier 1991].
  static RowMode ModeOf(double mu, double normal, double along) {
    if (!(normal > 0)) return RowMode::kOpen;
    if (std::abs(along) <= mu * normal) return RowMode::kStick;
    return along < 0 ? RowMode::kUp : RowMode::kDown;
  }
  /// Of a friction force in the mode of its contact: within its cone, exactly at its wall where the contact slips.
  static double Friction(RowMode mode, double most, double force) {
    return mode == RowMode::kUp ? -most : mode == RowMode::kDown ? most : std::clamp(force, -most, most);
  }
  /// What rho sums of a friction row.
  static double Residual(double mu, double normal, double along, double gap) {
    const double most = mu * std::max(normal, 0.0);
    return along - std::clamp(along - gap, -most, most);
  }
  /// By how much the gap of a friction row is wrong, whose force is within its cone by the last bit; negative: right.
  static double Defect(double most, double along, double gap) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    const double stick = std::abs(along) <= most ? std::abs(gap) : kInfinity;
    const double up = along == -most ? -gap : kInfinity;
    const double down = along == most ? gap : kInfinity;
    return std::min({stick, up, down});
  }
  /// S of the loads of unilateral, bilateral and bounded rows, of friction rows as far as friction answers them, and of
  /// all, each summed up in squares.
  static double Scale(double plain, double answered, double all) {
    const double scale = std::max(std::sqrt(plain + answered), kLeastScale * std::sqrt(all));
    return scale == 0 ? 1 : scale;
  }
};

}  // namespace lcpbench
