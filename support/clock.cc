#include "support/clock.h"

#include <chrono>

namespace lcpbench {

double SteadyNow() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace lcpbench
