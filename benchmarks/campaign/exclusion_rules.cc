#include "benchmarks/campaign/exclusion_rules.h"

#include <cstdio>
#include <optional>

namespace lcpbench {
namespace {

struct ClassLimit {
  int largest;  // rows
  std::string_view reason;
};

// Settled here, before any run: by what a method costs, not by how it fares.
std::optional<ClassLimit> LimitOf(MethodClass method_class) {
  switch (method_class) {
    case MethodClass::kDenseMatrix:
      return ClassLimit{5000, "works on the dense matrix, n^2 numbers"};
    case MethodClass::kExactArithmetic:
      return ClassLimit{30, "exact rational arithmetic"};
    case MethodClass::kAnySize:
      break;
  }
  return std::nullopt;
}

}  // namespace

std::vector<SizeLimit> SizeLimits() {
  std::vector<SizeLimit> limits;
  for (const SolverEntry& solver : AllSolvers()) {
    const std::optional<ClassLimit> limit = LimitOf(solver.method_class);
    if (limit) limits.push_back({solver.key, limit->largest, limit->reason});
  }
  return limits;
}

std::string SizeRefusal(const SolverEntry& solver, Index size) {
  const std::optional<ClassLimit> limit = LimitOf(solver.method_class);
  if (!limit || size <= limit->largest) return {};
  return "not above n = " + std::to_string(limit->largest) + ": " + std::string(limit->reason);
}

std::string OutOfTimeRule(double tier) {
  char text[64];
  std::snprintf(text, sizeof text, "out of time at the looser tier %.0e", tier);
  return text;
}

}  // namespace lcpbench
