#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <span>
#include <string>
#include <vector>

#include "solvers/lcp/problem.h"
#include "support/array_index.h"

/// Internal to solvers/.
namespace lcpbench {

/// WhyUnsupported of methods for contacts with up to one friction row each.
inline std::string WhyNotPlanar(const LcpProblem& problem, bool takes_sliding = false) {
  std::vector<Index> normals;
  for (const FrictionRow& row : problem.friction_rows()) {
    if (row.slip != 0 && !takes_sliding) return "sliding rows";
    normals.push_back(row.normal);
  }
  std::ranges::sort(normals);
  const bool has_two = std::ranges::adjacent_find(normals) != normals.end();
  return has_two ? "several friction rows of a contact" : "";
}

/// How rows are relaxed [docs/friction.md section 1]: J_n + mu J_t and J_n - mu J_t, with forces a+ and a-, take the
/// place of a contact's normal and friction row; f_n = a+ + a-, f_t = mu (a+ - a-). Other rows stay as they are.
class RelaxedRows {
 public:
  /// J_normal + factor J_tangent; tangent < 0: the one row alone.
  struct Row {
    Index normal, tangent;
    double factor;
  };

  /// @param n         rows, friction rows among them
  /// @param friction  up to one a contact, none sliding
  void Set(Index n, std::span<const FrictionRow> friction) {
    tangent_.assign(At(n), -1);
    is_tangent_.assign(At(n), 0);
    for (size_t k = 0; k < friction.size(); ++k) {
      is_tangent_[At(friction[k].row)] = 1;
      if (friction[k].mu != 0) tangent_[At(friction[k].normal)] = static_cast<Index>(k);
    }
    rows_.clear();
    for (Index i = 0; i < n; ++i) {
      if (is_tangent_[At(i)] != 0) continue;
      const Index k = tangent_[At(i)];
      if (k < 0) {
        rows_.push_back({i, -1, 0});
        continue;
      }
      const FrictionRow& of = friction[At(k)];
      rows_.push_back({i, of.row, of.mu});
      rows_.push_back({i, of.row, -of.mu});
    }
  }
  /// For up to so many rows.
  void Reserve(Index max_rows) {
    tangent_.reserve(At(max_rows));
    is_tangent_.reserve(At(max_rows));
    rows_.reserve(At(max_rows));
  }

  const std::vector<Row>& rows() const { return rows_; }           ///< n or fewer
  Index size() const { return static_cast<Index>(rows_.size()); }  ///< of rows()
  /// The load of a row of the relaxation, from the loads of all rows.
  static double Load(const Row& row, const Eigen::VectorXd& b) {
    return row.tangent < 0 ? b[row.normal] : b[row.normal] + row.factor * b[row.tangent];
  }
  /// a+- of forces, clipped to their cones.
  static double StartOf(const Row& row, const Eigen::VectorXd& f) {
    return row.tangent < 0 ? f[row.normal] : std::max((f[row.normal] + f[row.tangent] / row.factor) / 2, 0.0);
  }
  /// Entries of f, n or more, of the forces `relaxed`.
  void GetForces(const double* relaxed, Eigen::VectorXd* f) const {
    f->head(static_cast<Index>(tangent_.size())).setZero();
    for (const Row& row : rows_) {
      const double force = *relaxed++;
      (*f)[row.normal] += force;
      if (row.tangent >= 0) (*f)[row.tangent] += row.factor * force;
    }
  }

 private:
  std::vector<Index> tangent_;    // by normal row: in `friction`, -1: none with mu > 0
  std::vector<char> is_tangent_;  // by row
  std::vector<Row> rows_;
};

}  // namespace lcpbench
