#include <sys/mman.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "solvers/peers/protocol/protocol.h"
#include "solvers/peers/protocol/worker.h"
#include "support/subprocess.h"
#include "tests/fuzz/error_law.h"
#include "tests/fuzz/laws.h"

namespace lcpbench {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

class MemoryFile {
 public:
  explicit MemoryFile(const std::string& bytes = {}) : descriptor_(memfd_create("frames", MFD_CLOEXEC)) {
    if (descriptor_ < 0) throw std::runtime_error(std::strerror(errno));
    WriteAll(descriptor_, bytes.data(), bytes.size(), kForever);
    Rewind();
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;
  ~MemoryFile() { close(descriptor_); }

  int descriptor() const { return descriptor_; }
  void Rewind() const { lseek(descriptor_, 0, SEEK_SET); }

 private:
  int descriptor_;
};

struct Frame {
  MessageType type = MessageType::kNone;
  Bytes payload;
};

// Up to the first that is none.
std::vector<Frame> Frames(const MemoryFile& file) {
  std::vector<Frame> frames;
  file.Rewind();
  for (Frame frame;;) {
    const Transfer outcome = ReadFrame(file.descriptor(), &frame.type, &frame.payload, kForever);
    if (outcome != Transfer::kDone || frame.type == MessageType::kNone) break;
    frames.push_back(frame);
  }
  file.Rewind();
  return frames;
}

// What is sent is not to be solved here: f is the start, or b.
class Echo : public LcpSolver {
 protected:
  void DoPrepare(const LcpProblem& /*problem*/) override {}
  void DoSolve(const LcpProblem& problem, const LcpOptions& options, LcpResult* result) override {
    result->f = options.initial_f != nullptr ? *options.initial_f : problem.b();
    result->status = LcpStatus::kIterationLimit;
    result->detail = "echo";
  }
};

// One end of a conversation: what the readers of the next frame have to know of the frames before.
class Listener {
 public:
  // What is wrong with the frame: "" if it is read and written with the same length, and read again the same, or
  // refused in one line.
  std::string BrokenLaw(const Frame& frame) {
    std::string broken;
    for (const std::uint32_t version : {1U, 2U, kProtocolVersion}) {
      try {
        broken += BrokenRoundTrip(frame, version);
      } catch (const std::exception& error) {
        broken += BrokenErrorLaw(error.what(), "protocol: ");
      }
    }
    return broken;
  }

 private:
  template <typename Decode, typename... Version>
  static std::string Compare(const Bytes& payload, const Decode& decode, Version... version) {
    const Bytes written = Encode(decode(payload), version...);
    if (written.size() != payload.size()) return "another length";
    return Encode(decode(written), version...) == written ? "" : "another message";
  }

  std::string BrokenRoundTrip(const Frame& frame, std::uint32_t version) {
    const Bytes& payload = frame.payload;
    switch (frame.type) {
      case MessageType::kHello:
        return Compare(payload, DecodeHello);
      case MessageType::kProblem: {
        const auto decode = [version](const Bytes& bytes) { return DecodeProblem(bytes, version); };
        rows_ = decode(payload).rows;
        return Compare(payload, decode, version);
      }
      case MessageType::kOtherB:
        return Compare(payload, [this](const Bytes& bytes) { return DecodeOtherB(bytes, rows_); });
      case MessageType::kPrepared:
        return Compare(payload, DecodePrepared);
      case MessageType::kSolve: {
        const auto decode = [&](const Bytes& bytes) { return DecodeSolve(bytes, rows_, version); };
        return Compare(payload, decode, version);
      }
      case MessageType::kResult: {
        const auto decode = [&](const Bytes& bytes) { return DecodeResult(bytes, rows_, version); };
        return Compare(payload, decode, version);
      }
      case MessageType::kStream: {
        const auto decode = [version](const Bytes& bytes) { return DecodeStream(bytes, version); };
        stream_ = decode(payload);
        pass_ = {};
        return Compare(payload, decode, version);
      }
      case MessageType::kPass:
        pass_ = DecodePass(payload, stream_);
        return Compare(payload, [this](const Bytes& bytes) { return DecodePass(bytes, stream_); });
      case MessageType::kPassReply:
        return Compare(payload, [this](const Bytes& bytes) { return DecodePassReply(bytes, pass_, stream_); });
      default:
        return {};
    }
  }

  Index rows_ = 0;
  std::vector<ProblemArrays> stream_;
  PassRequest pass_;
};

std::string BrokenAnswer(const Frame& question, const Frame& answer, Listener* host) {
  const MessageType expected = question.type == MessageType::kSolve  ? MessageType::kResult
                               : question.type == MessageType::kPass ? MessageType::kPassReply
                                                                     : MessageType::kLoaded;
  if (answer.type != expected) return "another answer";
  host->BrokenLaw(question);
  return host->BrokenLaw(answer);
}

}  // namespace

std::string BrokenProtocolLaw(const std::string& bytes) {
  const MemoryFile sent(bytes), answered;
  const std::vector<Frame> frames = Frames(sent);
  Listener listener;
  for (const Frame& frame : frames) {
    if (std::string broken = listener.BrokenLaw(frame); !broken.empty()) return broken;
  }
  Hello hello;
  hello.name = "echo";
  try {
    ServeFrames(sent.descriptor(), answered.descriptor(), hello, [] { return std::make_unique<Echo>(); });
  } catch (const std::bad_alloc&) {
    return "a message asks for more memory than there is";
  } catch (const std::exception& error) {
    if (std::string broken = BrokenErrorLaw(error.what(), ""); !broken.empty()) return broken;
  }
  const std::vector<Frame> answers = Frames(answered);
  if (answers.empty() || answers.front().type != MessageType::kHello) return "no hello";
  if (answers.size() > frames.size() + 1) return "more answers than questions";
  Listener host;
  for (std::size_t k = 0; k + 1 < answers.size(); ++k) {
    if (std::string broken = BrokenAnswer(frames[k], answers[k + 1], &host); !broken.empty()) return broken;
  }
  return {};
}

}  // namespace lcpbench
