#pragma once

#include <cstdint>

#include "model/system.h"

namespace lcpbench {

// The generators behind scene.cc's table; what each family is and tells apart stands in its source file. All take
// rows >= 1 and any seed, and use + - * / sqrt and SinCos only, so that the same seed gives the same bits everywhere.

ContactSystem GenerateDiscsInV(int rows, std::uint64_t seed);
ContactSystem GenerateDiscPile(int rows, std::uint64_t seed);
ContactSystem GenerateDiscTrack(int rows, std::uint64_t seed);
ContactSystem GenerateBoxesAndDiscs(int rows, std::uint64_t seed);
ContactSystem GenerateRockers(int rows, std::uint64_t seed);

}  // namespace lcpbench
