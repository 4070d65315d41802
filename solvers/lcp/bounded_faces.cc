#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "solvers/lcp/solver.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

// Faces before the descent that cannot cycle.
constexpr int kExchanges = 12;
// The descent mostly holds several rows a face; more faces than this would be a cycle of steps without length.
constexpr Index kFacesPerRow = 4;
constexpr Index kMoreFaces = 100;
// Bounds above this times |D^-1/2 b|_2, in D^1/2 f, would only round the load away.
constexpr double kFarBound = 1e3;
// In the right face the solver's tolerance, which is relative to the load of the face, falls by this, so often.
constexpr double kTighten = 1e-2;
constexpr int kTightenings = 3;
constexpr double kLeastTolerance = 1e-15;
// Entries of D^1/2 y of a ray below this part of the largest are rounding of zeros.
constexpr double kNoise = 1e-9;
// Rows whose bounds are met so shortly after the first one's are held with it.
constexpr double kTogether = 1e-12;

double Root(double diagonal) { return diagonal > 0 ? std::sqrt(diagonal) : 1.0; }

// One solve, as LcpSolver::SolvesByFaces says.
class FaceSearch {
 public:
  FaceSearch(LcpSolver* solver, const LcpProblem& problem, const LcpOptions& options, LcpResult* result)
      : solver_(*solver),
        problem_(problem),
        options_(options),
        result_(*result),
        deadline_(options),
        tolerance_(options.tolerance) {}

  void Search() {
    Start();
    const auto rows = static_cast<Index>(rows_.size());
    for (faces_ = 0; faces_ < kExchanges + kMoreFaces + kFacesPerRow * rows; ++faces_) {
      if (deadline_.Expired()) return End(LcpStatus::kTimeLimit, "");
      const bool is_probe = std::exchange(is_probe_, false);
      if (!SolveFace(is_probe)) return;
      const bool is_ray = inner_.status == LcpStatus::kInfeasible;
      if (!is_ray && !is_probe && Judge()) return End(LcpStatus::kSolved, inner_.detail);
      const bool is_limit =
          !is_probe && (inner_.status == LcpStatus::kIterationLimit || inner_.status == LcpStatus::kTimeLimit);
      if (is_limit || inner_.status == LcpStatus::kUnsupported || (is_ray && !inner_.farkas_ray)) {
        return End(is_ray ? LcpStatus::kNumericalFailure : inner_.status, inner_.detail);
      }
      if (is_ray) TakeRay();
      if (faces_ < kExchanges ? Exchange(is_ray) : Descend(is_ray)) {
        if (faces_ + 1 == kExchanges) StartDescent();
        continue;
      }
      if (is_ray) return EndWithRay();
      is_probe_ = inner_.status == LcpStatus::kNumericalFailure && !is_probe;
      if (is_probe_) continue;
      if (tightenings_++ == kTightenings) return End(LcpStatus::kNumericalFailure, inner_.detail);
      tolerance_ = std::max(kTighten * tolerance_, std::min(kLeastTolerance, options_.tolerance));
    }
    End(LcpStatus::kIterationLimit, "faces come again");
  }

 private:
  // How a bounded row enters the face: +1 unilateral at its lower bound, -1 at its upper one, 0 as a joint.
  struct Row {
    BoundedRow bounds;
    int side = 0;
    bool is_held = false;  // at the bound of its side
    double bound() const { return side > 0 ? bounds.lower : bounds.upper; }
    bool is_fixed() const { return bounds.lower == bounds.upper; }
  };

  // By where a step of the natural map leads from the clipped start.
  void Start() {
    x_ = options_.initial_f != nullptr ? *options_.initial_f : Eigen::VectorXd::Zero(problem_.size());
    for (const BoundedRow& bounds : problem_.bounded_rows()) rows_.push_back({bounds});
    Clip(&x_);
    has_trial_ = options_.initial_f != nullptr;
    trial_ = x_;
    result_.f = x_;
    problem_.ComputeW(x_, &w_);
    const Eigen::VectorXd& D = problem_.DiagonalA();
    double load = 0;
    for (Index i = 0; i < D.size(); ++i) load = std::hypot(load, problem_.b()[i] / Root(D[i]));
    for (Row& row : rows_) {
      const auto& [i, lower, upper] = row.bounds;
      const double root = Root(D[i]);
      const double aim = x_[i] - w_[i] / (root * root);
      row.side = aim - lower <= upper - aim ? 1 : -1;
      row.is_held = row.is_fixed();
      if (!row.is_held && !(std::abs(row.bound()) * root <= kFarBound * load)) row.side = 0;
    }
  }

  void Clip(Eigen::VectorXd* f) const {
    for (const auto& [bounds, side, is_held] : rows_) {
      (*f)[bounds.row] = std::clamp((*f)[bounds.row], bounds.lower, bounds.upper);
    }
  }

  // The plain problem of the face, and its answer: trial_ or a ray. False where the result says how the solve ends.
  // @param is_probe  with all bounds of the face at 0: its rays are the same, and far bounds do not hide them
  bool SolveFace(bool is_probe) {
    const Index n = problem_.size();
    std::vector<int> sign(static_cast<size_t>(n), 1);
    base_.setZero(n);
    RowBounds bounds;
    bounds.bilateral.assign(static_cast<size_t>(n), 0);
    for (const Index i : problem_.bilateral_rows()) bounds.bilateral[static_cast<size_t>(i)] = 1;
    for (const Row& row : rows_) {
      const Index i = row.bounds.row;
      if (row.side != 0 && !is_probe) base_[i] = row.bound();
      if (row.side == 0) bounds.bilateral[static_cast<size_t>(i)] = 1;
      sign[static_cast<size_t>(i)] = row.is_held ? 0 : row.side < 0 ? -1 : 1;
    }
    Index m = 0;
    std::vector<Eigen::Triplet<double, int>> entries;
    for (Index i = 0; i < n; ++i) {
      const int s = sign[static_cast<size_t>(i)];
      if (s == 0) continue;
      bounds.bilateral[static_cast<size_t>(m)] = bounds.bilateral[static_cast<size_t>(i)];
      entries.emplace_back(static_cast<int>(m++), static_cast<int>(i), s);
    }
    bounds.bilateral.resize(static_cast<size_t>(m));
    P_.resize(m, n);
    P_.setFromTriplets(entries.begin(), entries.end());
    problem_.ComputeW(base_, &w_);

    LcpOptions rest = options_;
    rest.tolerance = tolerance_;
    rest.time_limit_s = deadline_.Remaining();
    if (options_.max_iterations > 0) rest.max_iterations = options_.max_iterations - result_.iterations;
    if (options_.max_iterations > 0 && rest.max_iterations <= 0) {
      End(LcpStatus::kIterationLimit, "");
      return false;
    }
    start_ = P_ * (trial_ - base_);
    for (Index k = 0; k < m; ++k) {
      if (bounds.bilateral[static_cast<size_t>(k)] == 0) start_[k] = std::max(start_[k], 0.0);
    }
    rest.initial_f = has_trial_ && !is_probe ? &start_ : nullptr;
    solver_.Solve(problem_.WithRows(P_, P_ * w_, std::move(bounds)), rest, &inner_);
    result_.iterations += inner_.iterations;
    if (inner_.factor_s >= 0) result_.factor_s = std::max(result_.factor_s, 0.0) + inner_.factor_s;
    if (inner_.status != LcpStatus::kInfeasible && !is_probe) {
      trial_ = base_ + P_.transpose() * inner_.f;
      has_trial_ = true;
    }
    return true;
  }

  // Whether the clipped trial passes; keeps the best one.
  bool Judge() {
    candidate_ = trial_;
    Clip(&candidate_);
    const Metrics metrics = ComputeMetrics(problem_, candidate_);
    const bool passes = PassesTier(metrics, options_.tolerance);
    if (passes || metrics.rho < least_rho_) {
      least_rho_ = metrics.rho;
      result_.f = candidate_;
    }
    return passes;
  }

  void TakeRay() {
    ray_ = P_.transpose() * *inner_.farkas_ray;
    double largest = 0;
    const Eigen::VectorXd& D = problem_.DiagonalA();
    for (Index i = 0; i < ray_.size(); ++i) largest = std::max(largest, Root(D[i]) * std::abs(ray_[i]));
    for (const Row& row : rows_) {
      double& y = ray_[row.bounds.row];
      if (Root(D[row.bounds.row]) * std::abs(y) <= kNoise * largest) y = 0;
    }
  }

  // The bound that the trial, or the ray in the end, passes and the face does not have: +1 the upper one, -1 the lower
  // one, 0 none.
  int Beyond(const Row& row, bool is_ray) const {
    const auto& [i, lower, upper] = row.bounds;
    if (row.is_held) return 0;
    const bool is_above = is_ray ? ray_[i] > 0 && std::isfinite(upper) : trial_[i] > upper;
    const bool is_below = is_ray ? ray_[i] < 0 && std::isfinite(lower) : trial_[i] < lower;
    if (is_above && row.side >= 0) return 1;
    return is_below && row.side <= 0 ? -1 : 0;
  }

  // True if some row was, as in Descend.
  bool Exchange(bool is_ray) {
    bool any = false;
    for (Row& row : rows_) {
      const int beyond = Beyond(row, is_ray);
      if (beyond == 0) continue;
      row.side = -beyond;
      any = true;
    }
    return any;
  }

  void StartDescent() {
    x_ = result_.f;
    for (Row& row : rows_) {
      if (x_[row.bounds.row] == row.bounds.lower) row.side = 1;
      if (x_[row.bounds.row] == row.bounds.upper) row.side = -1;
    }
  }

  // From x_ to the answer of the face, or along the ray, up to the first bound.
  bool Descend(bool is_ray) {
    direction_ = is_ray ? ray_ : trial_ - x_;
    const auto length_to = [&](const Row& row, int beyond) {
      const double bound = beyond > 0 ? row.bounds.upper : row.bounds.lower;
      return std::max((bound - x_[row.bounds.row]) / direction_[row.bounds.row], 0.0);
    };
    double length = std::numeric_limits<double>::infinity();
    for (const Row& row : rows_) {
      if (const int beyond = Beyond(row, is_ray); beyond != 0) length = std::min(length, length_to(row, beyond));
    }
    if (!std::isfinite(length)) return !is_ray && LetGo();
    for (Row& row : rows_) {
      const int beyond = Beyond(row, is_ray);
      if (beyond == 0 || length_to(row, beyond) > length * (1 + kTogether)) continue;
      row.side = -beyond;
      row.is_held = true;
    }
    x_ += length * direction_;
    for (const Row& row : rows_) {
      if (row.is_held) x_[row.bounds.row] = row.bound();
    }
    return true;
  }

  bool LetGo() {
    x_ = trial_;
    problem_.ComputeW(x_, &w_);
    bool any = false;
    for (Row& row : rows_) {
      if (!row.is_held || row.is_fixed() || row.side * w_[row.bounds.row] >= 0) continue;
      row.is_held = false;
      any = true;
    }
    return any;
  }

  void EndWithRay() {
    const bool is_proof = VerifyFarkasRay(problem_, ray_).accepted;
    if (is_proof) result_.farkas_ray = ray_;
    End(is_proof ? LcpStatus::kInfeasible : LcpStatus::kNumericalFailure, is_proof ? "" : "no proven ray");
  }

  void End(LcpStatus status, const std::string& detail) {
    result_.status = status;
    result_.detail = detail;
    if (faces_ > 0) result_.detail += (detail.empty() ? "" : "; ") + std::to_string(faces_ + 1) + " faces";
  }

  LcpSolver& solver_;
  const LcpProblem& problem_;
  const LcpOptions& options_;
  LcpResult& result_;
  const Deadline deadline_;
  double tolerance_;
  int tightenings_ = 0;
  Index faces_ = 0;
  std::vector<Row> rows_;
  SparseMatrix P_;     // rows of the face from those of the problem, with their signs
  Eigen::VectorXd x_;  // within all bounds
  Eigen::VectorXd base_, w_, trial_, candidate_, ray_, direction_;
  Eigen::VectorXd start_;
  bool has_trial_ = false;
  bool is_probe_ = false;  // the next face
  double least_rho_ = std::numeric_limits<double>::infinity();
  LcpResult inner_;
};

}  // namespace

void LcpSolver::SolveByFaces(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  FaceSearch(this, problem, options, result).Search();
}

}  // namespace lcpbench
