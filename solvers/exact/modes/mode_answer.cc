#include "solvers/exact/modes/mode_answer.h"

#include <algorithm>
#include <boost/multiprecision/mpfr.hpp>
#include <cmath>

#include "solvers/exact/modes/mode_system.h"

namespace lcpbench {

std::string FindFaultOfModes(const ExactLcp& problem, const std::string& modes, const RationalVector& f) {
  if (f.size() != At(problem.size) || modes.size() != f.size()) return "f or modes have another size than the problem";
  const RationalVector w = GapsOf(problem, f);
  for (const Law& law : LawsOf(problem, modes)) {
    const Rational value = ValueOf(law, f, w);
    if (law.is_equation ? value == 0 : value >= 0) continue;
    const LawTerm& term = law.terms.front();
    return std::string(term.is_gap ? "w" : "f") + " of row " + std::to_string(term.row) + " does not obey mode " +
           modes[At(term.row)];
  }
  return {};
}

std::string ModesOf(const ExactLcp& problem, const Eigen::VectorXd& f) {
  const Index n = problem.size;
  std::vector<double> force(At(n)), gap(At(n));  // D^1/2 f, D^-1/2 w
  for (Index i = 0; i < n; ++i) {
    const double diagonal = problem.A[At(i * n + i)].convert_to<double>();
    const double root = diagonal > 0 ? std::sqrt(diagonal) : 1;
    Rational w = problem.b[At(i)];
    for (Index j = 0; j < n; ++j) {
      if (f[j] != 0) w += problem.A[At(i * n + j)] * Rational(f[j]);
    }
    force[At(i)] = root * f[i];
    gap[At(i)] = w.convert_to<double>() / root;
  }
  std::string modes(At(n), 'O');
  for (Index i = 0; i < n; ++i) {
    if (problem.bilateral[At(i)] != 0) {
      modes[At(i)] = 'B';
    } else if (force[At(i)] > gap[At(i)]) {
      modes[At(i)] = 'C';
    }
  }
  for (const ExactFrictionRow& row : problem.friction) {
    const double root_ratio =
        std::sqrt((problem.A[At(row.row * n + row.row)] + 0).convert_to<double>() /
                  std::max(problem.A[At(row.normal * n + row.normal)].convert_to<double>(), 1e-300));
    const double most =
        row.mu.convert_to<double>() * (root_ratio > 0 ? root_ratio : 1) * (force[At(row.normal)] - gap[At(row.normal)]);
    const double trial = force[At(row.row)] - gap[At(row.row)];
    char& mode = modes[At(row.row)];
    if (modes[At(row.normal)] == 'O') {
      mode = 'o';
    } else if (row.slip != 0) {
      mode = 'k';
    } else {
      mode = trial > most ? '-' : trial < -most ? '+' : 'S';
    }
  }
  for (const ExactBoundedRow& row : problem.bounded) {
    const double diagonal = problem.A[At(row.row * n + row.row)].convert_to<double>();
    const double root = diagonal > 0 ? std::sqrt(diagonal) : 1;
    const double trial = (force[At(row.row)] - gap[At(row.row)]) / root;
    char& mode = modes[At(row.row)];
    mode = 'S';
    if (row.lower && trial < row.lower->convert_to<double>()) mode = '+';
    if (row.upper && trial > row.upper->convert_to<double>()) mode = '-';
  }
  return modes;
}

}  // namespace lcpbench
