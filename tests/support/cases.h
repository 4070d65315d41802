#pragma once

#include "tests/support/test.h"

namespace lcpbench {

/// How many cases a test tries: `few`, or as many as the environment variable says (`make test-long`).
inline int Cases(const char* variable, int few) {
  const char* many = std::getenv(variable);
  return many != nullptr ? std::atoi(many) : few;
}

}  // namespace lcpbench
