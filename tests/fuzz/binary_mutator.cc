// How libFuzzer changes binary files.

#include <algorithm>
#include <random>
#include <string>

#include "tests/fuzz/binary_mutation.h"
#include "tests/fuzz/libfuzzer.h"

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  std::mt19937_64 random(seed);
  constexpr unsigned kOneInThisIsFree = 8;
  if (random() % kOneInThisIsFree == 0) return LLVMFuzzerMutate(data, size, max_size);
  const std::string after = lcpbench::OverwrittenBytes(std::string(data, data + size), &random);
  std::copy(after.begin(), after.end(), data);
  return after.size();
}
