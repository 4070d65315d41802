#include "benchmarks/collection/recipes/instance.h"

#include <utility>

namespace lcpbench {

Instance InstanceOf(ContactSystem system) {
  AssembledLcp assembled = AssembleContactLcp(system);
  return {std::move(system), std::move(assembled.rows), std::move(assembled.problem)};
}

LcpProblem WithId(const LcpProblem& given, std::string id) {
  return LcpProblem::FromFactors(std::move(id), given.J(), given.inverse_mass(), given.b(),
                                 RowBounds::WithBilateralRows(given.size(), given.bilateral_rows()), given.facts());
}

}  // namespace lcpbench
