// How libFuzzer changes JSON: by LCPBENCH_MUTATED, MutatedTree of a whole file or MutatedLine of one of its lines.

#include <algorithm>
#include <string>

#include "model/scenes/random.h"
#include "tests/fuzz/libfuzzer.h"
#include "tests/fuzz/scene_mutation.h"

// Bytes changed at random are hardly ever JSON: most mutations are made on the tree of values.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  lcpbench::Random random(seed);
  constexpr double kShareOfTrees = 0.8;
  if (random.Uniform() < kShareOfTrees) {
    const std::string before(data, data + size);
    const std::string after = lcpbench::LCPBENCH_MUTATED(before, &random);
    if (after != before && after.size() <= max_size) {
      std::copy(after.begin(), after.end(), data);
      return after.size();
    }
  }
  return LLVMFuzzerMutate(data, size, max_size);
}
