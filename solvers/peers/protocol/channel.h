#pragma once

#include <string>

#include "solvers/peers/protocol/protocol.h"

namespace lcpbench {

/// Frames over a pair of file descriptors (equal for a socket). Owns neither.
class Channel {
 public:
  /// @param read_fd, write_fd  open as long as this object is used
  Channel(int read_fd, int write_fd) : read_fd_(read_fd), write_fd_(write_fd) {}

  /// How a transfer ended: done, the other end is closed, time is up, or no frame of the protocol.
  enum class Outcome { kDone, kClosed, kTimeout, kBroken };

  /// Writes one frame; gives up when `until` (SteadyNow() seconds, may be infinite) has passed. A reader that has gone
  /// is kClosed, never a signal where the descriptor is a socket.
  Outcome Write(MessageType type, const Bytes& payload, double until);
  /// Reads one frame. kBroken: the header is none of the protocol's, or promises more than kLargestPayload. Memory
  /// grows with what arrives, not with what the header promises.
  Outcome Read(MessageType* type, Bytes* payload, double until);

 private:
  Outcome WriteAll(const char* data, std::size_t size, double until);
  Outcome ReadAll(char* data, std::size_t size, double until);

  int read_fd_;
  int write_fd_;
};

}  // namespace lcpbench
