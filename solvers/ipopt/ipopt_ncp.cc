#include "solvers/ipopt/ipopt_ncp.h"

#include <string>
#include <utility>
#include <vector>

#include "solvers/ipopt/ipopt_common.h"

namespace lcpbench {
namespace {

using ipopt::Formulation;
using ipopt::QuadraticProgram;
using ipopt::ScaledLcp;
using ipopt::Start;

// Appends w of the unilateral rows as variables with the entries -w in constraints 0..n-1; returns those rows.
std::vector<Index> AddGaps(const ScaledLcp& scaled, QuadraticProgram* program) {
  std::vector<Index> rows;
  for (Index i = 0; i < scaled.size(); ++i) {
    if (scaled.problem().is_bilateral(i)) continue;
    program->jacobian.Add(i, static_cast<Index>(program->nonnegative.size()), -1.0);
    program->nonnegative.push_back(true);
    rows.push_back(i);
  }
  return rows;
}

// The parts of a start that both forms share: x and z are (f, middle, w), of which `middle` has no bounds. The
// stationarity of w asks for multipliers -z_w = -f of the constraints w = ...; that of f for z_f = w.
Start StartWithGaps(const Eigen::VectorXd& f, const Eigen::VectorXd& w, const Eigen::VectorXd& middle,
                    const std::vector<Index>& rows) {
  const Index n = f.size();
  const Index gaps = n + middle.size();
  Start start;
  start.x.resize(gaps + static_cast<Index>(rows.size()));
  start.z.setZero(start.x.size());
  start.x.head(n) = f;
  start.x.segment(n, middle.size()) = middle;
  start.z.head(n) = w;
  for (size_t k = 0; k < rows.size(); ++k) {
    start.x[gaps + static_cast<Index>(k)] = w[rows[k]];
    start.z[gaps + static_cast<Index>(k)] = f[rows[k]];
  }
  start.y.resize(n + middle.size());
  start.y.head(n) = -f;
  start.y.tail(middle.size()) = middle;
  return start;
}

// Variables (f, w); constraints A f - w = -b; objective f.(A f + b).
Formulation ContactForm(const ScaledLcp& scaled) {
  const LcpProblem& problem = scaled.problem();
  const Index n = scaled.size();
  const SparseMatrix& A = problem.SparseA();
  const SparseMatrix transpose = A.transpose();
  const SparseMatrix twice = A + transpose;
  const auto scale = [&](Index i, Index j) { return scaled.InverseRoot(i) * scaled.InverseRoot(j); };
  Formulation form;
  form.name = "contact";
  QuadraticProgram& program = form.program;
  for (Index i = 0; i < n; ++i) {
    program.nonnegative.push_back(!problem.is_bilateral(i));
    for (SparseMatrix::InnerIterator it(A, i); it; ++it) {
      program.jacobian.Add(i, it.col(), it.value() * scale(i, it.col()));
    }
    for (SparseMatrix::InnerIterator it(twice, i); it && it.col() <= i; ++it) {
      program.hessian.Add(i, it.col(), it.value() * scale(i, it.col()));
    }
  }
  std::vector<Index> rows = AddGaps(scaled, &program);
  program.c.setZero(static_cast<Index>(program.nonnegative.size()));
  program.d.setZero(n);
  form.has_gap_constraints = true;
  form.start = [rows = std::move(rows)](const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
    return StartWithGaps(f, w, Eigen::VectorXd(), rows);
  };
  return form;
}

// Variables (f, v, w); constraints S v - w = -b and S^T f - v = 0, whose multipliers at a solution are -f and v;
// objective v.v + b.f.
Formulation LiftedForm(const ScaledLcp& scaled) {
  const LcpProblem& problem = scaled.problem();
  const Index n = scaled.size();
  const SparseMatrix S = scaled.Factor();
  const Index bodies = S.cols();
  Formulation form;
  form.name = "lifted";
  QuadraticProgram& program = form.program;
  for (Index i = 0; i < n; ++i) {
    program.nonnegative.push_back(!problem.is_bilateral(i));
    for (SparseMatrix::InnerIterator it(S, i); it; ++it) {
      program.jacobian.Add(i, n + it.col(), it.value());
      program.jacobian.Add(n + it.col(), i, it.value());
    }
  }
  for (Index k = 0; k < bodies; ++k) {
    program.nonnegative.push_back(false);
    program.jacobian.Add(n + k, n + k, -1.0);
    program.hessian.Add(n + k, n + k, 2.0);
  }
  std::vector<Index> rows = AddGaps(scaled, &program);
  program.c.setZero(static_cast<Index>(program.nonnegative.size()));
  program.d.setZero(n + bodies);
  form.has_gap_constraints = true;
  form.start = [rows = std::move(rows), S](const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
    return StartWithGaps(f, w, S.transpose() * f, rows);
  };
  return form;
}

}  // namespace

class IpoptNcpEngine {
 public:
  explicit IpoptNcpEngine(const IpoptNcpOptions& options) : options_(options) {}

  std::string WhyUnsupported(const LcpProblem& problem) const;
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    runner_.Solve(problem, options, options_.self_check, result);
  }

 private:
  const IpoptNcpOptions options_;
  std::vector<Formulation> formulations_;
  ipopt::Runner runner_;
};

IpoptNcpOptions IpoptNcpOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("ipopt-ncp", settings);
  IpoptNcpOptions options;
  const std::string form = reader.Choice("form", "auto", {"auto", "contact", "lifted"});
  if (form == "contact") options.form = Form::kContact;
  if (form == "lifted") options.form = Form::kLifted;
  options.self_check = reader.SelfCheck();
  reader.Finish();
  return options;
}

std::string IpoptNcpEngine::WhyUnsupported(const LcpProblem& problem) const {
  if (options_.form == IpoptNcpOptions::Form::kLifted && !problem.has_factors()) {
    return "the lifted form needs a problem given by factors";
  }
  return {};
}

void IpoptNcpEngine::Prepare(const LcpProblem& problem) {
  using Form = IpoptNcpOptions::Form;
  const ScaledLcp scaled(problem);
  std::vector<Formulation>& forms = formulations_;
  forms.clear();
  const bool dense = scaled.LiftedIsSparser();  // then A may not fit in memory
  if (options_.form == Form::kContact || (options_.form == Form::kAuto && !dense)) {
    forms.push_back(ContactForm(scaled));
  }
  if (options_.form == Form::kLifted || (options_.form == Form::kAuto && problem.has_factors())) {
    forms.push_back(LiftedForm(scaled));
  }
  runner_.Prepare(scaled, forms);
}

template class EngineSolver<IpoptNcpOptions, IpoptNcpEngine>;

}  // namespace lcpbench
