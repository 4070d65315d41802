#pragma once

#include "solvers/peers/protocol/protocol.h"
#include "support/subprocess.h"

namespace lcpbench {

/// Writes one frame, as WriteAll.
Transfer WriteFrame(int fd, MessageType type, const Bytes& payload, double until);
/// Reads one frame, as ReadAll. The type is kNone where the header is none of the protocol's or promises more than
/// kLargestPayload. Memory grows with what arrives, not with what the header promises.
Transfer ReadFrame(int fd, MessageType* type, Bytes* payload, double until);

}  // namespace lcpbench
