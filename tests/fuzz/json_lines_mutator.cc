// How libFuzzer changes files of JSON lines.

#include <algorithm>
#include <string>

#include "model/scenes/random.h"
#include "tests/fuzz/libfuzzer.h"
#include "tests/fuzz/scene_mutation.h"

// Most mutations are made on the tree of one line's values.
extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned int seed) {
  lcpbench::Random random(seed);
  constexpr double kShareOfTrees = 0.8;
  if (random.Uniform() < kShareOfTrees) {
    const std::string before(data, data + size);
    const std::string after = lcpbench::MutatedLine(before, &random);
    if (after != before && after.size() <= max_size) {
      std::copy(after.begin(), after.end(), data);
      return after.size();
    }
  }
  return LLVMFuzzerMutate(data, size, max_size);
}
