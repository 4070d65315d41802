#include "solvers/peers/protocol/channel.h"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cmath>
#include <cstring>

#include "solvers/lcp/solver.h"

namespace lcpbench {
namespace {

constexpr std::size_t kHeaderSize = sizeof(std::uint32_t) + sizeof(std::uint64_t);
// Payloads grow by this much at a time, so that a promise alone allocates little.
constexpr std::size_t kChunk = std::size_t{1} << 22U;

// Waits until the descriptor is ready or the time has come.
bool WaitFor(int fd, short events, double until) {
  constexpr double kLongest = 3600;  // s; poll's timeout is an int
  for (;;) {
    const double left = until - SteadyNow();
    if (left <= 0) return false;
    pollfd entry{fd, events, 0};
    const int ready = poll(&entry, 1, static_cast<int>(std::ceil(1000 * std::min(left, kLongest))));
    if (ready > 0) return true;
    if (ready < 0 && errno != EINTR) return true;  // the read or write will say what is wrong
  }
}

// A blocking write() of more than the buffer holds would ignore the deadline.
ssize_t WriteSome(int fd, const char* data, std::size_t size) {
  const ssize_t sent = send(fd, data, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (sent < 0 && errno == ENOTSOCK) return write(fd, data, std::min<std::size_t>(size, PIPE_BUF));
  return sent;
}

}  // namespace

Channel::Outcome Channel::WriteAll(const char* data, std::size_t size, double until) {
  while (size > 0) {
    if (!WaitFor(write_fd_, POLLOUT, until)) return Outcome::kTimeout;
    const ssize_t written = WriteSome(write_fd_, data, size);
    if (written < 0) {
      if (errno == EINTR || errno == EAGAIN) continue;
      return Outcome::kClosed;
    }
    data += written;
    size -= static_cast<std::size_t>(written);
  }
  return Outcome::kDone;
}

Channel::Outcome Channel::ReadAll(char* data, std::size_t size, double until) {
  while (size > 0) {
    if (!WaitFor(read_fd_, POLLIN, until)) return Outcome::kTimeout;
    const ssize_t got = read(read_fd_, data, size);
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got <= 0) return Outcome::kClosed;
    data += got;
    size -= static_cast<std::size_t>(got);
  }
  return Outcome::kDone;
}

Channel::Outcome Channel::Write(MessageType type, const Bytes& payload, double until) {
  char header[kHeaderSize];
  const auto length = static_cast<std::uint64_t>(payload.size());
  std::memcpy(header, &type, sizeof type);
  std::memcpy(header + sizeof type, &length, sizeof length);
  const Outcome outcome = WriteAll(header, kHeaderSize, until);
  return outcome == Outcome::kDone ? WriteAll(payload.data(), payload.size(), until) : outcome;
}

Channel::Outcome Channel::Read(MessageType* type, Bytes* payload, double until) {
  char header[kHeaderSize];
  Outcome outcome = ReadAll(header, kHeaderSize, until);
  if (outcome != Outcome::kDone) return outcome;
  std::uint32_t code = 0;
  std::uint64_t length = 0;
  std::memcpy(&code, header, sizeof code);
  std::memcpy(&length, header + sizeof code, sizeof length);
  const bool known = code >= static_cast<std::uint32_t>(MessageType::kHello) &&
                     code <= static_cast<std::uint32_t>(MessageType::kPassReply);
  if (!known || length > kLargestPayload) return Outcome::kBroken;
  *type = static_cast<MessageType>(code);
  payload->clear();
  while (outcome == Outcome::kDone && payload->size() < length) {
    const std::size_t begin = payload->size();
    const std::size_t size = std::min<std::size_t>(kChunk, static_cast<std::size_t>(length) - begin);
    payload->resize(begin + size);
    outcome = ReadAll(payload->data() + begin, size, until);
  }
  return outcome;
}

}  // namespace lcpbench
