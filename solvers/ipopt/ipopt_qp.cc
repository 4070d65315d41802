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

class IpoptQpEngine {
 public:
  explicit IpoptQpEngine(const IpoptQpOptions& options) : options_(options) {}

  std::string WhyUnsupported(const LcpProblem& problem) const;
  void Prepare(const LcpProblem& problem);
  void Solve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) {
    runner_.Solve(problem, options, options_.self_check, result);
  }

 private:
  const IpoptQpOptions options_;
  std::vector<Formulation> formulations_;
  ipopt::Runner runner_;
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

std::string IpoptQpEngine::WhyUnsupported(const LcpProblem& problem) const {
  if (options_.form == IpoptQpOptions::Form::kLifted && !problem.has_factors()) {
    return "the lifted form needs a problem given by factors";
  }
  if (!problem.IsNumericallySymmetric()) return "A is not symmetric, so the LCP is not the optimality of a QP";
  return {};
}

void IpoptQpEngine::Prepare(const LcpProblem& problem) {
  using Form = IpoptQpOptions::Form;
  const ScaledLcp scaled(problem);
  std::vector<Formulation>& forms = formulations_;
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
  runner_.Prepare(scaled, forms);
}

template class EngineSolver<IpoptQpOptions, IpoptQpEngine>;

}  // namespace lcpbench
