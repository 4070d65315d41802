#include "solvers/friction/relaxation.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "solvers/friction/contact_rows.h"
#include "solvers/lcp/law_metrics.h"
#include "solvers/lcp/verify.h"
#include "support/array_index.h"

namespace lcpbench {
namespace {

// J_normal + factor J_tangent; tangent < 0: the normal row, or a joint.
struct RelaxedRow {
  Index normal, tangent;
  double factor;
};

std::vector<RelaxedRow> RelaxRows(const LcpProblem& problem) {
  const Index n = problem.size();
  std::vector<const FrictionRow*> tangent(At(n), nullptr);
  std::vector<char> is_tangent(At(n), 0);
  for (const FrictionRow& row : problem.friction_rows()) {
    is_tangent[At(row.row)] = 1;
    if (row.mu != 0) tangent[At(row.normal)] = &row;
  }
  std::vector<RelaxedRow> relaxed;
  for (Index i = 0; i < n; ++i) {
    if (is_tangent[At(i)] != 0) continue;
    if (const FrictionRow* row = tangent[At(i)]; row != nullptr) {
      relaxed.push_back({i, row->row, row->mu});
      relaxed.push_back({i, row->row, -row->mu});
    } else {
      relaxed.push_back({i, -1, 0});
    }
  }
  return relaxed;
}

// As J of `arrays`, columns ascending.
void SumRows(const SparseMatrix& J, const std::vector<RelaxedRow>& rows, ProblemArrays* arrays) {
  arrays->row_start.assign(1, 0);
  arrays->column.clear();
  arrays->value.clear();
  const auto add = [&](Index column, double value) {
    arrays->column.push_back(static_cast<int>(column));
    arrays->value.push_back(value);
  };
  for (const RelaxedRow& row : rows) {
    SparseMatrix::InnerIterator normal(J, row.normal);
    for (SparseMatrix::InnerIterator along(J, row.tangent < 0 ? 0 : row.tangent); row.tangent >= 0 && along; ++along) {
      while (normal && normal.col() < along.col()) {
        add(normal.col(), normal.value());
        ++normal;
      }
      const bool is_same = normal && normal.col() == along.col();
      add(along.col(), row.factor * along.value() + (is_same ? normal.value() : 0));
      if (is_same) ++normal;
    }
    for (; normal; ++normal) add(normal.col(), normal.value());
    arrays->row_start.push_back(static_cast<int>(arrays->value.size()));
  }
}

SparseMatrix MatrixOf(const std::vector<RelaxedRow>& rows, Index n) {
  std::vector<Eigen::Triplet<double, int>> entries;
  for (size_t k = 0; k < rows.size(); ++k) {
    const int row = static_cast<int>(k);
    entries.emplace_back(row, static_cast<int>(rows[k].normal), 1);
    if (rows[k].tangent >= 0) entries.emplace_back(row, static_cast<int>(rows[k].tangent), rows[k].factor);
  }
  SparseMatrix P(static_cast<Index>(rows.size()), n);
  P.setFromTriplets(entries.begin(), entries.end());
  return P;
}

}  // namespace

RelaxationOptions RelaxationOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("relaxation", settings);
  reader.Finish();
  return {};
}

class RelaxationEngine {
 public:
  explicit RelaxationEngine(const RelaxationOptions& options) : plain_(options.make_plain()) {}
  static constexpr bool kTakesFriction = true;

  std::string WhyUnsupported(const LcpProblem& problem) const {
    for (const FrictionRow& row : problem.friction_rows()) {
      if (row.slip != 0) return "sliding rows";
    }
    return ContactRows::WhyUnsupported(problem);
  }

  // Whatever `auto` prepares, it prepares in its solve: of rows on two bodies next to nothing.
  void Prepare(const LcpProblem& problem) {
    if (problem.is_plain()) return plain_->Prepare(problem);
    rows_ = RelaxRows(problem);
    const auto m = static_cast<Index>(rows_.size());
    if (problem.has_factors()) {
      SumRows(problem.J(), rows_, &arrays_);
      arrays_.form = MatrixForm::kFactors;
      arrays_.columns = problem.J().cols();
      arrays_.inverse_mass.assign(problem.inverse_mass().begin(), problem.inverse_mass().end());
    } else {
      const SparseMatrix P = MatrixOf(rows_, problem.size()), transposed = P.transpose();
      const Eigen::VectorXd b = P * problem.b();
      const bool is_dense = problem.given_form() == MatrixForm::kDense;
      arrays_ = ProblemArrays::Of(is_dense ? LcpProblem::FromDense("", (P * problem.DenseA()) * transposed, b)
                                           : LcpProblem::FromSparse("", (P * problem.SparseA()) * transposed, b));
    }
    arrays_.id = problem.id();
    arrays_.rows = m;
    arrays_.facts = Facts(problem);
    arrays_.b.resize(At(m));
    arrays_.bilateral.resize(At(m));
    for (size_t k = 0; k < rows_.size(); ++k) arrays_.bilateral[k] = problem.is_bilateral(rows_[k].normal) ? 1 : 0;
  }

  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    if (problem.is_plain()) return plain_->Solve(problem, options, result);
    result->model = FrictionModel::kRelaxation;
    LcpOptions of_relaxed = options;
    Eigen::VectorXd start;
    if (options.initial_f != nullptr) {
      start = StartOf(*options.initial_f);
      of_relaxed.initial_f = &start;
    }
    const Eigen::VectorXd& b = problem.b();
    for (size_t k = 0; k < rows_.size(); ++k) {
      const RelaxedRow& row = rows_[k];
      arrays_.b[k] = row.tangent < 0 ? b[row.normal] : b[row.normal] + row.factor * b[row.tangent];
    }
    // From arrays `auto` may be asked twice, and would count its limit anew.
    if (std::isfinite(options.time_limit_s)) {
      plain_->Solve(LcpProblem::FromArrays(arrays_), of_relaxed, &inner_);
    } else {
      plain_->SolveArrays(arrays_, of_relaxed, &inner_);
    }
    result->status = inner_.status;
    result->iterations = inner_.iterations;
    result->detail = inner_.detail;
    result->f.setZero(problem.size());
    for (size_t k = 0; k < rows_.size(); ++k) {
      const double force = inner_.f[static_cast<Index>(k)];
      result->f[rows_[k].normal] += force;
      if (rows_[k].tangent >= 0) result->f[rows_[k].tangent] += rows_[k].factor * force;
    }
    if (inner_.status == LcpStatus::kInfeasible) {
      result->status = LcpStatus::kNumericalFailure;
      result->detail = "the relaxed problem has no solution";
    } else if (inner_.status == LcpStatus::kSolved) {
      // The tolerance is relative to another load there.
      problem.ComputeW(result->f, &gaps_);
      const double residual = RelaxationResidual(problem, result->f, gaps_);
      if (residual <= options.tolerance || residual <= RoundingFloor(problem, result->f)) return;
      result->status = LcpStatus::kNumericalFailure;
      result->detail = "the relaxed answer is not within the tolerance";
    }
  }

 private:
  // The rank may differ, and so may uniqueness.
  static MatrixFacts Facts(const LcpProblem& problem) {
    MatrixFacts facts = problem.facts();
    facts.rank.reset();
    facts.f_unique.reset();
    return facts;
  }

  // a+- of forces clipped to their cones.
  Eigen::VectorXd StartOf(const Eigen::VectorXd& f) const {
    Eigen::VectorXd start(static_cast<Index>(rows_.size()));
    for (size_t k = 0; k < rows_.size(); ++k) {
      const RelaxedRow& row = rows_[k];
      start[static_cast<Index>(k)] =
          row.tangent < 0 ? f[row.normal] : std::max((f[row.normal] + f[row.tangent] / row.factor) / 2, 0.0);
    }
    return start;
  }

  std::vector<RelaxedRow> rows_;
  ProblemArrays arrays_;
  const std::unique_ptr<LcpSolver> plain_;
  LcpResult inner_;
  Eigen::VectorXd gaps_;
};

template class EngineSolver<RelaxationOptions, RelaxationEngine>;

}  // namespace lcpbench
