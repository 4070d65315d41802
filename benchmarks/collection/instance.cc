#include "benchmarks/collection/instance.h"

#include <utility>

namespace lcpbench {

Instance InstanceOf(ContactSystem system) {
  AssembledLcp assembled = AssembleContactLcp(system);
  return {std::move(system), std::move(assembled.rows), std::move(assembled.problem)};
}

}  // namespace lcpbench
