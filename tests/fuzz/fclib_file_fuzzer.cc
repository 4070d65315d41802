// Any bytes keep the law of tests/fuzz/fclib_law.h.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>

#include "tests/fuzz/fclib_law.h"
#include "tests/fuzz/hdf5_mutation.h"

// What libFuzzer calls, and its own mutator, which it offers.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed);
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string broken = lcpbench::BrokenFclibLaw(std::string(data, data + size));
  if (broken.empty()) return 0;
  std::fprintf(stderr, "%s\n", broken.c_str());
  std::abort();
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  std::mt19937_64 random(seed);
  constexpr unsigned kOneInThisIsFree = 8;
  if (random() % kOneInThisIsFree == 0) return LLVMFuzzerMutate(data, size, max_size);
  const std::string after = lcpbench::OverwrittenBytes(std::string(data, data + size), &random);
  std::copy(after.begin(), after.end(), data);
  return after.size();
}
