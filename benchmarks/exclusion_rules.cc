#include "benchmarks/exclusion_rules.h"

#include <array>
#include <cstdio>

namespace lcpbench {
namespace {

// Which solver is given how much is settled here, before any run: by what its method costs, not by how it fares.
constexpr std::string_view kDensePivoting = "dense pivoting, O(n^3) and n^2 numbers";
constexpr std::string_view kDenseMatrix = "works on the dense matrix, n^2 numbers";
constexpr std::array kSizeLimits{
    SizeLimit{"dantzig", 5000, kDensePivoting},
    SizeLimit{"lemke", 2000, kDensePivoting},
    SizeLimit{"bullet-dantzig", 1000, kDensePivoting},
    SizeLimit{"bullet-lemke", 300, "dense tableau, O(n^2) a pivot"},
    SizeLimit{"ode", 1000, kDensePivoting},
    SizeLimit{"dart", 1000, kDenseMatrix},
    SizeLimit{"siconos-lexicolemke", 300, kDensePivoting},
    SizeLimit{"siconos-avi", 300, kDensePivoting},
    SizeLimit{"siconos-newton-fb", 300, kDenseMatrix},
    SizeLimit{"siconos-pgs", 300, kDenseMatrix},
    SizeLimit{"cgal-qp", 30, "exact rational arithmetic"},
    SizeLimit{"clp", 1000, "reduced gradients without a limit of their own"},
};

// Is `solver` the key itself or a variant of it?
bool Names(std::string_view key, std::string_view solver) {
  return solver.starts_with(key) && (solver.size() == key.size() || solver[key.size()] == '-');
}

}  // namespace

std::span<const SizeLimit> SizeLimits() { return kSizeLimits; }

std::string SizeRefusal(const SolverEntry& solver, Index size) {
  for (const SizeLimit& limit : kSizeLimits) {
    if (size > limit.largest && Names(limit.solver, solver.base.empty() ? solver.key : solver.base)) {
      return "not above n = " + std::to_string(limit.largest) + ": " + std::string(limit.reason);
    }
  }
  return {};
}

std::string OutOfTimeRule(double tier) {
  char text[64];
  std::snprintf(text, sizeof text, "out of time at the looser tier %.0e", tier);
  return text;
}

}  // namespace lcpbench
