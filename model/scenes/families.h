#pragma once

#include <cstdint>

#include "model/system.h"
#include "model/world.h"

namespace lcpbench {

// The generators behind scene.cc's table; what each family is and tells apart stands in its source file. All take
// rows >= 1 and any seed, and use + - * / sqrt and SinCos only, so that the same seed gives the same bits everywhere.

ContactSystem GenerateDiscsInV(int rows, std::uint64_t seed);
World StartDiscsInV(int rows, std::uint64_t seed);
ContactSystem GenerateDiscPile(int rows, std::uint64_t seed);
World StartDiscPile(int rows, std::uint64_t seed);
ContactSystem GenerateDiscTrack(int rows, std::uint64_t seed);
World StartDiscTrack(int rows, std::uint64_t seed);
ContactSystem GenerateBoxesAndDiscs(int rows, std::uint64_t seed);
World StartBoxesAndDiscs(int rows, std::uint64_t seed);
ContactSystem GenerateRockers(int rows, std::uint64_t seed);
World StartRockers(int rows, std::uint64_t seed);
ContactSystem GenerateOvalsInBowl(int rows, std::uint64_t seed);
World StartOvalsInBowl(int rows, std::uint64_t seed);
ContactSystem GenerateRollerBearing(int rows, std::uint64_t seed);
World StartRollerBearing(int rows, std::uint64_t seed);
ContactSystem GenerateRoundedWall(int rows, std::uint64_t seed);
World StartRoundedWall(int rows, std::uint64_t seed);
ContactSystem GenerateTallStacks(int rows, std::uint64_t seed);
World StartTallStacks(int rows, std::uint64_t seed);
ContactSystem GenerateBilliardsBreak(int rows, std::uint64_t seed);
World StartBilliardsBreak(int rows, std::uint64_t seed);

// Mechanisms: one-problem form, and the world that starts moving.

ContactSystem GenerateGearTrain(int rows, std::uint64_t seed);
World StartGearTrain(int rows, std::uint64_t seed);
ContactSystem GenerateCamFollower(int rows, std::uint64_t seed);
World StartCamFollower(int rows, std::uint64_t seed);
ContactSystem GenerateNewtonsCradle(int rows, std::uint64_t seed);
World StartNewtonsCradle(int rows, std::uint64_t seed);
ContactSystem GenerateChainOfLinks(int rows, std::uint64_t seed);
World StartChainOfLinks(int rows, std::uint64_t seed);
ContactSystem GenerateSpinningDrum(int rows, std::uint64_t seed);
World StartSpinningDrum(int rows, std::uint64_t seed);
ContactSystem GenerateOvalTrain(int rows, std::uint64_t seed);
World StartOvalTrain(int rows, std::uint64_t seed);

}  // namespace lcpbench
