#include "solvers/peers/protocol/channel.h"

#include <algorithm>
#include <cstring>

namespace lcpbench {
namespace {

constexpr std::size_t kHeaderSize = sizeof(std::uint32_t) + sizeof(std::uint64_t);
// Payloads grow by this much at a time, so that a promise alone allocates little.
constexpr std::size_t kChunk = std::size_t{1} << 22U;

}  // namespace

Transfer WriteFrame(int fd, MessageType type, const Bytes& payload, double until) {
  char header[kHeaderSize] = {};
  const auto length = static_cast<std::uint64_t>(payload.size());
  std::memcpy(header, &type, sizeof type);
  std::memcpy(header + sizeof type, &length, sizeof length);
  const Transfer outcome = WriteAll(fd, header, kHeaderSize, until);
  return outcome == Transfer::kDone ? WriteAll(fd, payload.data(), payload.size(), until) : outcome;
}

Transfer ReadFrame(int fd, MessageType* type, Bytes* payload, double until) {
  char header[kHeaderSize] = {};
  Transfer outcome = ReadAll(fd, header, kHeaderSize, until);
  std::uint32_t code = 0;
  std::uint64_t length = 0;
  std::memcpy(&code, header, sizeof code);
  std::memcpy(&length, header + sizeof code, sizeof length);
  const bool known = code <= static_cast<std::uint32_t>(MessageType::kPassReply) && length <= kLargestPayload;
  *type = known ? static_cast<MessageType>(code) : MessageType::kNone;
  payload->clear();
  while (outcome == Transfer::kDone && *type != MessageType::kNone && payload->size() < length) {
    const std::size_t begin = payload->size();
    const std::size_t size = std::min<std::size_t>(kChunk, static_cast<std::size_t>(length) - begin);
    payload->resize(begin + size);
    outcome = ReadAll(fd, payload->data() + begin, size, until);
  }
  return outcome;
}

}  // namespace lcpbench
