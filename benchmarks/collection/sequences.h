#pragma once

#include <functional>

#include "benchmarks/collection/manifest.h"
#include "model/motion/motion.h"

namespace lcpbench {

/// Lets a scene move under forces from exact arithmetic, rounded once (exact_solver.h), so that the problems met have
/// the same bits on every machine, and calls `handle` with every problem that SequenceWriter would write: of a step's
/// acceleration problems the first, impacts and time steps all. The problem is given an id of its own,
/// "<scene>-n<rows>-s<seed>-motion-<number from 0>".
/// @param start  its changes are none
/// @return "" or why the motion ended before its time
/// @throws InputError as StartScene
std::string ForEachSequenceProblem(
    const Recipe& start, int steps,
    const std::function<void(const LcpProblem& problem, const MotionProblem& met)>& handle);

/// Counts and hashes the problems of a sequence.
/// @throws InputError where the motion ends before its time, and as above
SequenceEntry MeasureSequence(const Recipe& start, int steps);

}  // namespace lcpbench
