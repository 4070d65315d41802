// Siconos's solvers for contact with Coulomb friction, behind fc2d_driver in the plane and fc3d_driver in space.
//
// A contact is two rows, n and t, in space with a second tangent without loads; joints are eliminated, on the clock.
// Solvers in space and sweeps in sparse blocks start from z and are asked for in portions, as in siconos.cc; dense
// sweeps in the plane and conjugate gradients begin anew at each call, and are asked for in growing numbers, until the
// time limit; the host ends the others. Iterations are sweeps, steps or pivots, of
// the last call where each begins anew. docs/peers.md has what is known of release 4.4.

#include <FrictionContactProblem.h>
#include <Friction_cst.h>
#include <NonSmoothDrivers.h>
#include <SolverOptions.h>
#define restrict __restrict  // the next header has C's word
#include <fc2d_compute_error.h>
#undef restrict
#include <lcp_cst.h>

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "solvers/friction/relaxed_rows.h"
#include "solvers/lcp/memory_budget.h"
#include "solvers/peers/peer_library.h"
#include "solvers/peers/siconos/siconos_numerics.h"

namespace lcpbench {
namespace {

/// f_J = -A_JJ^+ (b_J + A_JC f_C) leaves the contacts a problem of their own, with the Schur complement for matrix.
class JointElimination {
 public:
  /// Changes *A, which is symmetric, to the Schur complement, with 0 in the rows and columns of joints.
  /// O(joints^2 n + joints n^2)
  void Set(const std::vector<Index>& joints, Eigen::MatrixXd* A) {
    constexpr double kRegular = 1e-12;  // least reciprocal condition number of a Cholesky factor
    joints_ = joints;
    if (joints.empty()) return;
    coupling_ = (*A)(joints, Eigen::all);
    const Eigen::MatrixXd among = coupling_(Eigen::all, joints);
    cholesky_.compute(among);
    is_regular_ = cholesky_.info() == Eigen::Success && cholesky_.rcond() > kRegular;
    if (!is_regular_) orthogonal_.compute(among);
    solved_ = Solve(coupling_);
    A->noalias() -= coupling_.transpose() * solved_;
    (*A)(joints, Eigen::all).setZero();
    (*A)(Eigen::all, joints).setZero();
  }
  /// b of the contacts' problem, of the same length.
  Eigen::VectorXd Reduced(const Eigen::VectorXd& b) {
    if (joints_.empty()) return b;
    of_b_ = Solve(b(joints_));
    return b - coupling_.transpose() * of_b_;
  }
  /// Adds the forces of joints, which are 0 in *f, for the b of the last Reduced.
  void AddForces(Eigen::VectorXd* f) const {
    if (!joints_.empty()) (*f)(joints_) = -(of_b_ + solved_ * *f).eval();
  }

 private:
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& right) const {
    if (is_regular_) return cholesky_.solve(right);
    return orthogonal_.solve(right);
  }

  std::vector<Index> joints_;
  Eigen::MatrixXd coupling_, solved_;  // joints x n: rows of A, and A_JJ^+ times them
  Eigen::VectorXd of_b_;               // A_JJ^+ b_J
  bool is_regular_ = true;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> orthogonal_;  // of redundant joints
};

/// A friction problem in Siconos's form. A contact without a friction row, or with mu = 0, gets a dummy for it, as in
/// space every contact does for its second tangent: of a force and a velocity that are 0, since it is coupled to
/// nothing.
class ContactProblem : public SiconosMatrix {
 public:
  struct Options {
    Storage storage = Storage::kBlocks;
    int dimension = 2;
    /// By powers of two, one a contact, that bring A_nn and the largest |b_i| to about 1: the library has absolute
    /// thresholds, and its measures add the contacts' forces and velocities. The law does not change.
    bool is_scaled = true;
    /// Tangents in units in which all mu are equal: fc2d_tolcp multiplies columns by the mu of their rows' contacts.
    bool has_one_mu = false;
  };

  void Set(const LcpProblem& problem, const Options& options) {
    Clear();
    is_scaled_ = options.is_scaled;
    Order(problem, options);
    const bool has_joints = !problem.bilateral_rows().empty();
    Eigen::MatrixXd A;
    if (has_joints || options.storage == Storage::kDense) {
      RequireDenseMatrices(problem.size(), 3);
      A = problem.DenseA();
    }
    joints_.Set(problem.bilateral_rows(), &A);
    if (options.storage == Storage::kDense) {
      FillDense(A);
    } else {
      FillBlocks(has_joints ? SparseMatrix(A.sparseView()) : problem.SparseA());
    }
    Finish(options.storage);
    problem_ = {.dimension = options.dimension,
                .numberOfContacts = static_cast<int>(mu_.size()),
                .M = matrix(),
                .q = q(),
                .mu = mu_.data()};
  }

  FrictionContactProblem* get() { return &problem_; }
  const FrictionContactProblem* get() const { return &problem_; }
  double NormOfQ() { return Eigen::Map<const Eigen::VectorXd>(q(), size()).norm(); }

  void SetLoads(const Eigen::VectorXd& b) {
    const Eigen::VectorXd reduced = joints_.Reduced(b);
    const double largest = reduced.cwiseAbs().maxCoeff();
    force_unit_ = is_scaled_ && largest > 0 ? std::ldexp(1.0, std::ilogb(largest)) : 1;
    SetB(reduced, 1 / force_unit_);
  }
  Eigen::VectorXd VariablesOf(const Eigen::VectorXd& f) const {
    Eigen::VectorXd z = Eigen::VectorXd::Zero(size());
    for (Index i = 0; i < size(); ++i) {
      const Variable& variable = variables_[static_cast<std::size_t>(i)];
      if (variable.factor != 0) z[i] = f[variable.row] / (variable.factor * force_unit_);
    }
    return z;
  }
  void SetAllForces(const Eigen::VectorXd& z, Eigen::VectorXd* f) const {
    SetForces(z, f, force_unit_);
    joints_.AddForces(f);
  }

 private:
  void Order(const LcpProblem& problem, const Options& options) {
    std::vector<const FrictionRow*> tangents(static_cast<std::size_t>(problem.size()), nullptr);
    double largest_mu = 0;
    for (const FrictionRow& tangent : problem.friction_rows()) {
      if (tangent.mu > 0) tangents[static_cast<std::size_t>(tangent.normal)] = &tangent;
      largest_mu = std::max(largest_mu, tangent.mu);
    }
    mu_.clear();
    const Eigen::VectorXd& diagonal = problem.DiagonalA();
    for (Index row = 0; row < problem.size(); ++row) {
      if (problem.kind(row) != RowKind::kUnilateral) continue;
      const FrictionRow* tangent = tangents[static_cast<std::size_t>(row)];
      const double unit = is_scaled_ && diagonal[row] > 0 ? std::ldexp(1.0, -std::ilogb(diagonal[row]) / 2) : 1;
      variables_.push_back({row, unit});
      double tangent_unit = unit;
      if (tangent != nullptr) {
        if (options.has_one_mu) tangent_unit *= tangent->mu / largest_mu;
        variables_.push_back({tangent->row, tangent_unit});
      }
      const Index last = variables_.back().row;
      const double dummy = diagonal[last] > 0 ? tangent_unit * tangent_unit * diagonal[last] : 1;
      for (int i = tangent == nullptr ? 1 : 2; i < options.dimension; ++i) variables_.push_back({last, 0, dummy});
      ends_.push_back(static_cast<unsigned int>(variables_.size()));
      mu_.push_back(options.has_one_mu ? largest_mu : tangent == nullptr ? 0 : tangent->mu);
    }
  }

  void FillDense(const Eigen::MatrixXd& A) {
    values_.resize(variables_.size() * variables_.size());
    std::size_t at = 0;
    for (const Variable& column : variables_) {
      for (const Variable& row : variables_) {
        const bool is_dummy = &row == &column && row.factor == 0;
        values_[at++] = is_dummy ? row.dummy : row.factor * column.factor * A(row.row, column.row);
      }
    }
  }

  bool is_scaled_ = true;
  double force_unit_ = 1;
  std::vector<double> mu_;
  JointElimination joints_;
  FrictionContactProblem problem_{};
};

struct Method {
  std::string_view key;
  FRICTION_SOLVER solver = SICONOS_FRICTION_2D_NSGS;
  int dimension = 2;
  bool has_tolerance = true;
};
constexpr Method kMethods[] = {
    {"siconos-fc2d-nsgs", SICONOS_FRICTION_2D_NSGS},
    {"siconos-fc2d-cpg", SICONOS_FRICTION_2D_CPG},
    {"siconos-fc2d-lemke", SICONOS_FRICTION_2D_LEMKE, 2, false},
    {"siconos-fc2d-enum", SICONOS_FRICTION_2D_ENUM, 2, false},
    {"siconos-fc3d-nsgs", SICONOS_FRICTION_3D_NSGS, 3},
    {"siconos-fc3d-nsn-ac", SICONOS_FRICTION_3D_NSN_AC, 3},
    {"siconos-fc3d-admm", SICONOS_FRICTION_3D_ADMM, 3},
};

class SiconosContacts : public LcpSolver {
 public:
  SiconosContacts(const Method& method, std::string_view key, SettingsReader* reader) : method_(method) {
    const bool is_library_default = key.ends_with("-default");
    form_.is_scaled = !is_library_default && method.solver != SICONOS_FRICTION_2D_LEMKE;  // has no thresholds
    form_.has_one_mu = !method.has_tolerance;
    form_.dimension = method.dimension;
    const bool has_blocks = method.solver == SICONOS_FRICTION_2D_NSGS || method.dimension == 3;
    most_dense_rows_ = has_blocks ? kMostDenseRows : kAll;
    if (is_library_default || !method.has_tolerance) return;
    tier_ = PeerTier(method.key, reader);
    follows_tier_ = true;
    if (has_blocks) {
      most_dense_rows_ =
          Choose<Index>(reader, "storage", {{"by-size", kMostDenseRows}, {"blocks", 0}, {"dense", kAll}});
    }
  }

  bool TakesFriction() const override { return true; }

  std::string WhyUnsupported(const LcpProblem& problem) const override {
    const auto joints = static_cast<Index>(problem.bilateral_rows().size());
    const auto tangents = static_cast<Index>(problem.friction_rows().size());
    if (joints + tangents == problem.size()) return "no contact";
    if (method_.solver == SICONOS_FRICTION_2D_ENUM && problem.size() - joints - tangents > kMostEnumerated) {
      return "more than " + std::to_string(kMostEnumerated) + " contacts";
    }
    if (joints > 0 && !problem.IsNumericallySymmetric()) return "joints where A is not symmetric";
    return WhyNotPlanar(problem);
  }

 protected:
  void DoPrepare(const LcpProblem& problem) override {
    using Storage = SiconosMatrix::Storage;
    form_.storage = problem.size() > most_dense_rows_ ? Storage::kBlocks : Storage::kDense;
    problem_.Set(problem, form_);
  }

  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    Eigen::VectorXd z, w;
    TimeConversion(options, result, [&] {
      SetOptions(options);
      problem_.SetLoads(problem.b());
      z.setZero(problem_.size());
      if (options.initial_f != nullptr && StartsFromZ()) z = problem_.VariablesOf(*options.initial_f);
      w.setZero(problem_.size());
    });
    SolverOptions& own = own_.get();
    SiconosPortions portions = Portions(own.iparam[SICONOS_IPARAM_MAX_ITER], options.time_limit_s);
    const Deadline deadline(options);
    SilenceLibrary();
    TimeLibraryCall(options, result, [&] {
      SolveInPortions(
          portions, deadline, [&] { return Call(&own, z.data(), w.data()); }, &own, &z, result);
    });
    TimeConversion(options, result, [&] { problem_.SetAllForces(z, &result->f); });
  }

 private:
  static constexpr Index kAll = std::numeric_limits<Index>::max();
  // Three rows a contact in lcp_enum, of which it tries each choice: 2^18, up to 3 s.
  static constexpr Index kMostEnumerated = 6;
  static constexpr Index kMostDenseRows = 200;     // above, sweeps in sparse blocks take less time
  static constexpr double kMeasureOfBlocks = 0.1;  // they compare with the norm of f, too: the same tiers take a tenth

  bool StartsFromZ() const { return method_.dimension == 3 || form_.storage == SiconosMatrix::Storage::kBlocks; }

  SiconosPortions Portions(std::int64_t most, double time_limit_s) const {
    const int cost_power = method_.solver == SICONOS_FRICTION_3D_NSN_AC ? 3 : 2;
    SiconosPortions portions{.most = most, .first = FirstPortion(problem_, cost_power)};
    portions.continues = StartsFromZ();
    if (portions.continues) return portions;
    if (method_.solver == SICONOS_FRICTION_2D_CPG) {
      // Nine of ten that it solves take no more steps. It does not see that it stands at a solution where all stick.
      constexpr std::int64_t kStepsPerRow = 10;
      portions.first = std::min(most, kStepsPerRow * problem_.size());
      portions.growth = 4;
      return portions;
    }
    // A small part of the time, by a low estimate: what needs more than that loses no more than that.
    constexpr double kTimeOfFirst = 0.05;  // s
    portions.first = static_cast<std::int64_t>(std::min(
        std::ceil(static_cast<double>(portions.first) * (time_limit_s / kTimeOfFirst)), static_cast<double>(most)));
    portions.growth = std::numeric_limits<double>::infinity();
    return portions;
  }

  void SetOptions(const LcpOptions& options) {
    SolverOptions* own = own_.Fresh(method_.solver);
    int& most = own->iparam[SICONOS_IPARAM_MAX_ITER];
    if (follows_tier_) {
      const bool is_planar_sweep = method_.dimension == 2 && StartsFromZ();
      own->dparam[SICONOS_DPARAM_TOL] = (is_planar_sweep ? kMeasureOfBlocks : 1) * tier_.Tolerance(options);
      most = tier_.Iterations(options);
    }
    if (method_.solver == SICONOS_FRICTION_2D_ENUM) most = std::numeric_limits<int>::max();
    most = IterationLimit(options, most);
  }

  // ADMM starts from velocities with the sign of its multipliers, which is not that of those that it gives back.
  void TurnVelocities(double* w) const {
    const FrictionContactProblem& problem = *problem_.get();
    for (int i = 0; i < problem.numberOfContacts; ++i, w += 3) {
      w[0] += problem.mu[i] * std::hypot(w[1], w[2]);
      for (int k = 0; k < 3; ++k) w[k] = -w[k];
    }
  }

  int Call(SolverOptions* own, double* z, double* w) {
    if (method_.solver == SICONOS_FRICTION_3D_ADMM) TurnVelocities(w);
    const auto driver = method_.dimension == 3 ? fc3d_driver : fc2d_driver;
    int info = driver(problem_.get(), z, w, own);
    while (method_.solver == SICONOS_FRICTION_2D_ENUM && info != 0 && GoOn(own)) {
      info = driver(problem_.get(), z, w, own);
    }
    switch (method_.solver) {
      case SICONOS_FRICTION_2D_LEMKE:
        // It means to compare these, and returns 0 whatever they are.
        return own->dparam[SICONOS_DPARAM_RESIDU] <= own->dparam[SICONOS_DPARAM_TOL] ? 0 : 1;
      case SICONOS_FRICTION_2D_CPG:
        ++own->iparam[SICONOS_IPARAM_ITER_DONE];  // it tells the number of the last step, from 0
        return info == 0 || IsSolved(own, z, w) ? 0 : info;
      case SICONOS_FRICTION_2D_ENUM:
        own->iparam[SICONOS_IPARAM_ITER_DONE] = own->iparam[SICONOS_LCP_IPARAM_ENUM_CURRENT_ENUM] + 1;
        return info;
      default:
        return info;
    }
  }

  // It ends with the first set of rows whose forces are not negative, right or wrong where the matrix of the set is
  // singular but for rounding. Whether another call may begin behind it; false once it is among those seen.
  static bool GoOn(SolverOptions* own) {
    int& first = own->iparam[SICONOS_LCP_IPARAM_ENUM_SEED];
    const int found = own->iparam[SICONOS_LCP_IPARAM_ENUM_CURRENT_ENUM];
    if (own->iparam[SICONOS_LCP_IPARAM_ENUM_NUMBER_OF_SOLUTIONS] == 0 || found < first) return false;
    own->iparam[SICONOS_LCP_IPARAM_ENUM_NUMBER_OF_SOLUTIONS] = 0;
    first = found + 1;
    return true;
  }

  // By the library's measure, which compares with the norm of f, too, as sweeps in blocks do.
  bool IsSolved(const SolverOptions* own, double* z, double* w) {
    double error = 0;
    const double tolerance = (follows_tier_ ? kMeasureOfBlocks : 1) * own->dparam[SICONOS_DPARAM_TOL];
    return fc2d_compute_error(problem_.get(), z, w, tolerance, problem_.NormOfQ(), &error) == 0;
  }

  Method method_;
  ContactProblem::Options form_;
  Index most_dense_rows_ = kAll;
  bool follows_tier_ = false;
  PeerTier tier_;
  ContactProblem problem_;
  SiconosOptions own_;
};

}  // namespace

std::unique_ptr<LcpSolver> MakeSiconosContacts(std::string_view key, SettingsReader* reader) {
  const auto* method = std::find_if(std::begin(kMethods), std::end(kMethods),
                                    [key](const Method& known) { return key.starts_with(known.key); });
  return std::make_unique<SiconosContacts>(*method, key, reader);
}

}  // namespace lcpbench
