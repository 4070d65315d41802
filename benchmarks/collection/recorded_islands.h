#pragma once

#include <string>
#include <vector>

#include "benchmarks/collection/manifest.h"
#include "benchmarks/collection/recording.h"

namespace lcpbench {

/// An island of a recorded step that may become a problem of the collection.
struct RecordedIsland {
  RecordedProblem made;
  RecordingSource source;
  std::string base;
};

/// Size classes above this many rows take no islands but the largest of a scene (build.h).
inline constexpr Index kMostIslandRows = 30;
/// Most parts and islands that one recording gives to a size class, so that a scene of many bodies that never meet does
/// not outweigh the others.
inline constexpr std::size_t kPartsOfRecording = 4;
inline constexpr std::size_t kIslandsOfRecording = 16;

/// The islands of at most kMostIslandRows rows of all steps of a recording at a level: none with b = 0 or A = 0, no two
/// with the same content. They are in the order of their content hashes, except that their bases take
/// turns; a size class has at most kIslandsOfRecording of them, from kPartsOfRecording bases. The choice looks at no
/// solver and at no answer. Bodies that are in one island in any step of the recording are of one part; islands of
/// different parts never share a body. The part with the most bodies has the base of the whole scene,
/// "<engine>-<scene>"; other parts have
/// "<engine>-<scene>-body<k>", where k is their first body.
/// @param folder  that `path` is relative to
std::vector<RecordedIsland> ChooseIslands(const std::string& folder, const std::string& path,
                                          RecordedLevel level = RecordedLevel::kVelocity);

}  // namespace lcpbench
