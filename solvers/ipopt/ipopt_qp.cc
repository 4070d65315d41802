#include "solvers/ipopt/ipopt_qp.h"

#include <string>
#include <vector>

#include "solvers/ipopt/ipopt_common.h"

namespace lcpbench {
namespace {

using ipopt::Formulation;
using ipopt::QuadraticProgram;
using ipopt::ScaledLcp;
using ipopt::Start;

// Variables f; Hessian A. At a solution grad = A f + b = z = w.
Formulation ContactForm(const ScaledLcp& scaled) {
  const LcpProblem& problem = scaled.problem();
  const Index n = scaled.size();
  Formulation form;
  form.name = "contact";
  QuadraticProgram& program = form.program;
  for (Index i = 0; i < n; ++i) {
    program.nonnegative.push_back(!problem.is_bilateral(i));
    for (SparseMatrix::InnerIterator it(problem.SparseA(), i); it && it.col() <= i; ++it) {
      program.hessian.Add(i, it.col(), it.value() * scaled.InverseRoot(i) * scaled.InverseRoot(it.col()));
    }
  }
  program.c.setZero(n);
  form.start = [](const Eigen::VectorXd& f, const Eigen::VectorXd& w) { return Start{f, w, Eigen::VectorXd()}; };
  return form;
}

// Variables (f, v); constraints S^T f - v = 0 with multipliers y; 1/2 v.v + b.f. At a solution y = v and b + S y = z =
// w.
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
    for (SparseMatrix::InnerIterator it(S, i); it; ++it) program.jacobian.Add(it.col(), i, it.value());
  }
  for (Index k = 0; k < bodies; ++k) {
    program.nonnegative.push_back(false);
    program.jacobian.Add(k, n + k, -1.0);
    program.hessian.Add(n + k, n + k, 1.0);
  }
  program.c.setZero(n + bodies);
  program.d.setZero(bodies);
  form.start = [S](const Eigen::VectorXd& f, const Eigen::VectorXd& w) {
    const Index rows = f.size();
    Start start;
    start.y = S.transpose() * f;
    start.x.resize(rows + S.cols());
    start.x << f, start.y;
    start.z.setZero(rows + S.cols());
    start.z.head(rows) = w;
    return start;
  };
  return form;
}

}  // namespace

struct IpoptQpSolver::Workspace {
  std::vector<Formulation> formulations;
  ipopt::Runner runner;
};

IpoptQpOptions IpoptQpOptions::FromSettings(const Settings& settings) {
  SettingsReader reader("ipopt-qp", settings);
  IpoptQpOptions options;
  const std::string form = reader.Choice("form", "auto", {"auto", "contact", "lifted"});
  if (form == "contact") options.form = Form::kContact;
  if (form == "lifted") options.form = Form::kLifted;
  options.self_check = reader.SelfCheck();
  reader.Finish();
  return options;
}

IpoptQpSolver::IpoptQpSolver(IpoptQpOptions options) : options_(options), work_(std::make_unique<Workspace>()) {}
IpoptQpSolver::~IpoptQpSolver() = default;

std::string IpoptQpSolver::WhyUnsupported(const LcpProblem& problem) const {
  if (options_.form == IpoptQpOptions::Form::kLifted && !problem.has_factors()) {
    return "the lifted form needs a problem given by factors";
  }
  if (!problem.IsNumericallySymmetric()) return "A is not symmetric, so the LCP is not the optimality of a QP";
  return {};
}

void IpoptQpSolver::DoPrepare(const LcpProblem& problem) {
  using Form = IpoptQpOptions::Form;
  const ScaledLcp scaled(problem);
  std::vector<Formulation>& forms = work_->formulations;
  forms.clear();
  if (options_.form != Form::kAuto) {
    forms.push_back(options_.form == Form::kLifted ? LiftedForm(scaled) : ContactForm(scaled));
  } else if (!problem.has_factors()) {
    forms.push_back(ContactForm(scaled));
  } else if (scaled.LiftedIsSparser()) {
    forms.push_back(LiftedForm(scaled));  // A alone, dense, may not fit in memory
  } else {
    forms.push_back(ContactForm(scaled));
    forms.push_back(LiftedForm(scaled));
  }
  work_->runner.Prepare(scaled, forms);
}

void IpoptQpSolver::DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
  work_->runner.Solve(problem, options, options_.self_check, result);
}

}  // namespace lcpbench
