#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include "solvers/lcp/solver.h"
#include "solvers/linear_algebra/scaled_system.h"

namespace lcpbench {

/// What happened below an IpmSolver, for tests and tuning.
struct IpmStatistics {
  std::int64_t analyses = 0;        ///< symbolic, in the latest Prepare; 0 if those of the problem before serve
  std::int64_t factorizations = 0;  ///< numeric, in the latest Solve
  std::int64_t interior_steps = 0;  ///< of these, interior-point steps
  std::int64_t pivots = 0;          ///< of these, active sets tried
  bool body_space = false;          ///< the systems live on the bodies
  double fill = 0;                  ///< entries of L
  double factor_flops = 0;          ///< of one factorisation
};

/// One solve of the `ipm` backend: limits, counters and the best iterate so far, shared by its two methods.
class IpmRun {
 public:
  /// Those of IpmOptions.
  struct Own {
    double proximal;
    int correctors;
    bool self_check;
  };

  IpmRun(ScaledSystem& system, const Own& own, const LcpOptions& options, IpmStatistics& statistics)
      : system_(system),
        own_(own),
        options_(options),
        deadline_(options),
        limit_(options.max_iterations > 0 ? options.max_iterations : kDefaultLimit),
        statistics_(statistics),
        best_f_(Eigen::VectorXd::Zero(system.size())) {}

  ScaledSystem& system() { return system_; }
  /// Weight of the proximal term.
  double proximal() const { return own_.proximal; }
  int correctors() const { return own_.correctors; }
  const LcpOptions& options() const { return options_; }
  IpmStatistics& statistics() { return statistics_; }

  /// Factorises A^ + diag(theta) if the limits allow it. False: limit_hit() or a breakdown told by system().why().
  bool Factorize(const Eigen::VectorXd& theta) {
    if (limit_hit()) return false;
    if (statistics_.factorizations >= limit_) {
      status_ = LcpStatus::kIterationLimit;
      return false;
    }
    if (NoTimeForAnother()) {
      status_ = LcpStatus::kTimeLimit;
      return false;
    }
    ++statistics_.factorizations;
    return system_.Factorize(theta);
  }
  /// Seconds until the limit; false where none are left.
  bool TimeLeft(double* seconds) const {
    *seconds = options_.time_limit_s - deadline_.Elapsed();
    return *seconds > 0;
  }
  /// True once a limit has stopped a factorisation; limit_status() says which.
  bool limit_hit() const { return status_ != LcpStatus::kNotRun; }
  LcpStatus limit_status() const { return status_; }

  /// Whether f (in the problem's units, w fresh) meets the tier; remembers the iterate of least rho,
  /// one that meets the tier before all that do not.
  bool Accept(const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
    const double rho = system_.Rho(f, w);
    const double tolerance = kMargin * options_.tolerance;
    const bool meets = own_.self_check ? system_.Meets(tolerance, f, w) : rho <= tolerance;
    if (meets == accepted_ ? rho < best_rho_ : meets) {
      best_f_ = f;
      best_rho_ = rho;
    }
    accepted_ = accepted_ || meets;
    return meets;
  }
  /// The same for f^ in scaled variables, with w summed in extended precision; *w becomes the scaled gaps.
  bool AcceptScaled(const Eigen::VectorXd& scaled_f, Eigen::VectorXd* w) {
    const Eigen::VectorXd f = scaled_f.cwiseProduct(system_.force_unit());
    system_.GapsExtended(f, true, w);
    const bool meets = Accept(f, *w);
    *w = w->cwiseQuotient(system_.gap_unit());
    return meets;
  }
  const Eigen::VectorXd& best_f() const { return best_f_; }
  double best_rho() const { return best_rho_; }
  /// Whether best_f() meets the tier.
  bool accepted() const { return accepted_; }

 private:
  // A factorisation cannot be interrupted, so none is begun that would end late by more than kAllowedOvershoot, if it
  // takes as long as the one before with all that followed.
  bool NoTimeForAnother() {
    if (!std::isfinite(options_.time_limit_s)) return false;
    const double now = deadline_.Elapsed();
    const double lap = last_factorization_ < 0 ? 0.0 : now - last_factorization_;
    last_factorization_ = now;
    return now >= options_.time_limit_s || now + lap > (1 + kAllowedOvershoot) * options_.time_limit_s;
  }

  static constexpr double kAllowedOvershoot = 0.1;
  static constexpr std::int64_t kDefaultLimit = 500;
  // Our residual and the verdict's differ by rounding; a claim must hold in both.
  static constexpr double kMargin = 0.9;

  ScaledSystem& system_;
  const Own own_;
  const LcpOptions& options_;
  Deadline deadline_;
  std::int64_t limit_;
  IpmStatistics& statistics_;
  LcpStatus status_ = LcpStatus::kNotRun;
  double last_factorization_ = -1;  // when it began [s]
  Eigen::VectorXd best_f_;
  bool accepted_ = false;
  double best_rho_ = std::numeric_limits<double>::infinity();
};

}  // namespace lcpbench
