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
/// Of one recording and size class: so that no scene of many bodies that never meet outweighs the others.
inline constexpr std::size_t kPartsOfRecording = 4;
inline constexpr std::size_t kIslandsOfRecording = 16;

/// The islands of at most kMostIslandRows rows of all steps of a recording, at the velocity level: none with b = 0 or
/// A = 0, no two with the same content. They are in the order of their content hashes but for turns of their bases; of
/// a size class there are kIslandsOfRecording of kPartsOfRecording bases at most. The choice looks at no solver and at
/// no answer. Bodies that are in one island in any step of the recording are of one part; islands of different parts
/// never share a body. The part of most bodies has the scene's own base "<engine>-<scene>", which the whole scene has;
/// other parts
/// "<engine>-<scene>-body<k>", k being their first body.
/// @param folder  that `path` is relative to
std::vector<RecordedIsland> ChooseIslands(const std::string& folder, const std::string& path);

}  // namespace lcpbench
