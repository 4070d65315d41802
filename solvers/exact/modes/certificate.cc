#include "solvers/exact/modes/certificate.h"

#include <utility>

#include "solvers/exact/modes/mode_search.h"

namespace lcpbench {
namespace {

// What answers of both kinds have.
template <typename Answer>
Certificate CertificateOf(Answer answer, std::string status, std::string fault, bool is_known) {
  Certificate certificate;
  certificate.status = std::move(status);
  certificate.certified = is_known && fault.empty();
  certificate.fault = std::move(fault);
  certificate.f = std::move(answer.f);
  certificate.w = std::move(answer.w);
  certificate.ray = std::move(answer.ray);
  certificate.f_unique = answer.f_unique;
  certificate.detail = std::move(answer.detail);
  return certificate;
}

}  // namespace

Certificate Certify(const ExactLcp& problem, const CertifyOptions& options) {
  if (!problem.is_plain()) {
    ModeAnswer answer = SolveByModes(problem, options.modes);
    const bool is_solved = answer.status == LcpReference::Status::kSolved;
    Certificate certificate =
        CertificateOf(answer,
                      is_solved         ? "solved"
                      : answer.complete ? "infeasible"
                                        : "unknown",
                      is_solved ? FindFaultOfModes(problem, answer.modes, answer.f) : "", is_solved || answer.complete);
    certificate.complete = answer.complete;
    certificate.w_unique = answer.w_unique;
    certificate.steps = answer.tried;
    certificate.modes = std::move(answer.modes);
    certificate.pieces = std::move(answer.pieces);
    certificate.components = answer.components;
    return certificate;
  }
  ExactAnswer answer = SolveExactly(problem, options.plain);
  const bool is_solved = answer.status == ExactAnswer::Status::kSolved;
  Certificate certificate = CertificateOf(answer, ToString(answer.status), FindFault(problem, answer),
                                          is_solved || answer.status == ExactAnswer::Status::kInfeasible);
  certificate.complete = certificate.certified;
  if (is_solved) certificate.w_unique = true;
  certificate.steps = answer.pivots;
  certificate.f_least_norm = std::move(answer.f_least_norm);
  certificate.rank = answer.rank;
  certificate.rank_is_proved = answer.rank_is_proved;
  certificate.nullity_on_active = answer.nullity_on_active;
  certificate.degenerate = std::move(answer.degenerate);
  return certificate;
}

}  // namespace lcpbench
