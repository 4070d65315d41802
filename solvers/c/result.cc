#include <algorithm>
#include <cstddef>
#include <cstring>
#include <string>

#include "solvers/c/guard.h"
#include "solvers/c/handles.h"
#include "solvers/c/lcpbench.h"
#include "solvers/lcp/verify.h"

namespace lcpbench {
namespace {

// The two enumerations count alike, so that a status is converted by its number.
static_assert(static_cast<int>(LcpStatus::kNotRun) == LCPBENCH_NOT_RUN);
static_assert(static_cast<int>(LcpStatus::kSolved) == LCPBENCH_SOLVED);
static_assert(static_cast<int>(LcpStatus::kInfeasible) == LCPBENCH_INFEASIBLE);
static_assert(static_cast<int>(LcpStatus::kIterationLimit) == LCPBENCH_ITERATION_LIMIT);
static_assert(static_cast<int>(LcpStatus::kTimeLimit) == LCPBENCH_TIME_LIMIT);
static_assert(static_cast<int>(LcpStatus::kNumericalFailure) == LCPBENCH_NUMERICAL_FAILURE);
static_assert(static_cast<int>(LcpStatus::kUnsupported) == LCPBENCH_UNSUPPORTED);

// Size in version 0.1: what programs compiled against it pass. Members that are added later come behind it.
constexpr std::size_t kFirstVerdict = offsetof(lcpbench_verdict, ray_reason) + sizeof(lcpbench_verdict::ray_reason);

bool IsStatus(lcpbench_status status) { return status >= LCPBENCH_NOT_RUN && status <= LCPBENCH_UNSUPPORTED; }

template <std::size_t kSize>
void CopyText(const std::string& text, char (&target)[kSize]) {
  const std::size_t length = std::min(text.size(), kSize - 1);
  std::memcpy(target, text.data(), length);
  target[length] = '\0';
}

void Judge(const LcpProblem& problem, const LcpResult& result, double tolerance, lcpbench_verdict* target,
           std::size_t size, double* w) {
  RequireNotNull(target, "verdict", "where to write");
  RequireStructSize(size, kFirstVerdict, "lcpbench_verdict");
  if (!(tolerance > 0 && tolerance < 1)) {
    throw InputError("tolerance is " + std::to_string(tolerance) + ", expected a number in (0, 1)");
  }
  const Verdict found = Verify(problem, result, tolerance);
  const Metrics& m = found.metrics;
  lcpbench_verdict verdict = {};
  verdict.requested = found.requested;
  verdict.passes = found.passes ? 1 : 0;
  verdict.false_success = found.false_success ? 1 : 0;
  verdict.false_infeasible = found.false_infeasible ? 1 : 0;
  verdict.best_tier = found.best_tier;
  verdict.rho = m.rho;
  verdict.backward_error = m.backward_error;
  verdict.natural_residual = m.natural_residual;
  verdict.primal_infeasibility = m.primal_infeasibility;
  verdict.dual_infeasibility = m.dual_infeasibility;
  verdict.complementarity = m.complementarity;
  verdict.gap = m.gap;
  verdict.energy_bound = m.energy_bound;
  verdict.energy_shift = m.energy_shift;
  verdict.answer_floor = m.answer_floor;
  CopyText(found.reason, verdict.reason);
  if (found.farkas.has_value()) {
    verdict.has_ray = 1;
    verdict.ray_accepted = found.farkas->accepted ? 1 : 0;
    verdict.ray_b_dot_y = found.farkas->b_dot_y;
    verdict.ray_null_residual = found.farkas->null_residual;
    CopyText(found.farkas->reason, verdict.ray_reason);
  }
  CopyOut(verdict, target, size);
  if (w != nullptr) std::copy(m.w.begin(), m.w.end(), w);
}

void RequireResult(const lcpbench_result* result) { RequireNotNull(result, "result", "a result"); }

}  // namespace
}  // namespace lcpbench

using lcpbench::Guard;
using lcpbench::InputError;

lcpbench_error lcpbench_result_create(lcpbench_result** result) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(result, "result", "the address of a pointer");
    *result = new lcpbench_result();
  });
}

lcpbench_error lcpbench_result_status(const lcpbench_result* result, lcpbench_status* status) {
  return Guard(__func__, [&] {
    lcpbench::RequireResult(result);
    lcpbench::RequireNotNull(status, "status", "where to write");
    *status = static_cast<lcpbench_status>(result->result.status);
  });
}

lcpbench_error lcpbench_result_iterations(const lcpbench_result* result, int64_t* iterations) {
  return Guard(__func__, [&] {
    lcpbench::RequireResult(result);
    lcpbench::RequireNotNull(iterations, "iterations", "where to write");
    *iterations = result->result.iterations;
  });
}

lcpbench_error lcpbench_result_f(const lcpbench_result* result, const double** f, int64_t* n) {
  return Guard(__func__, [&] {
    lcpbench::RequireResult(result);
    lcpbench::RequireNotNull(f, "f", "where to write a pointer");
    lcpbench::RequireNotNull(n, "n", "where to write");
    *n = result->result.f.size();
    *f = *n == 0 ? nullptr : result->result.f.data();
  });
}

lcpbench_error lcpbench_result_detail(const lcpbench_result* result, const char** detail) {
  return Guard(__func__, [&] {
    lcpbench::RequireResult(result);
    lcpbench::RequireNotNull(detail, "detail", "where to write a pointer");
    *detail = result->result.detail.c_str();
  });
}

lcpbench_error lcpbench_result_farkas_ray(const lcpbench_result* result, const double** ray, int64_t* n) {
  return Guard(__func__, [&] {
    lcpbench::RequireResult(result);
    lcpbench::RequireNotNull(ray, "ray", "where to write a pointer");
    lcpbench::RequireNotNull(n, "n", "where to write");
    const auto& known = result->result.farkas_ray;
    *n = known.has_value() ? known->size() : 0;
    *ray = *n == 0 ? nullptr : known->data();
  });
}

const char* lcpbench_status_key(lcpbench_status status) {
  // Keys are literals, which end in a zero.
  return lcpbench::IsStatus(status) ? ToString(static_cast<lcpbench::LcpStatus>(status)).data() : "unknown";
}

void lcpbench_result_free(lcpbench_result* result) { delete result; }

lcpbench_error lcpbench_verify_result(const lcpbench_problem* problem, const lcpbench_result* result, double tolerance,
                                      lcpbench_verdict* verdict, size_t size, double* w) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(problem, "problem", "a problem");
    lcpbench::RequireResult(result);
    if (result->result.status == lcpbench::LcpStatus::kNotRun) {
      throw InputError("result is empty, expected one of a solve");
    }
    if (result->result.f.size() != problem->problem.size()) {
      throw InputError("result has " + std::to_string(result->result.f.size()) +
                       " forces, expected the problem's n = " + std::to_string(problem->problem.size()));
    }
    lcpbench::Judge(problem->problem, result->result, tolerance, verdict, size, w);
  });
}

lcpbench_error lcpbench_verify(const lcpbench_problem* problem, const double* f, int64_t f_size, lcpbench_status claim,
                               const double* ray, double tolerance, lcpbench_verdict* verdict, size_t size, double* w) {
  return Guard(__func__, [&] {
    lcpbench::RequireNotNull(problem, "problem", "a problem");
    const lcpbench::Index n = problem->problem.size();
    if (f_size != n) {
      throw InputError("f_size is " + std::to_string(f_size) + ", expected the problem's n = " + std::to_string(n));
    }
    if (n > 0) lcpbench::RequireNotNull(f, "f", "n numbers");
    if (!lcpbench::IsStatus(claim)) {
      throw InputError("claim is " + std::to_string(claim) + ", expected a lcpbench_status");
    }
    lcpbench::LcpResult result;
    result.status = static_cast<lcpbench::LcpStatus>(claim);
    if (n > 0) result.f = Eigen::Map<const Eigen::VectorXd>(f, n);
    if (ray != nullptr && n > 0) result.farkas_ray = Eigen::Map<const Eigen::VectorXd>(ray, n);
    lcpbench::Judge(problem->problem, result, tolerance, verdict, size, w);
  });
}
