#include "benchmarks/collection/gzip_input.h"

#include <zlib.h>

#include <array>
#include <cstddef>

namespace lcpbench {
namespace {

constexpr std::size_t kBlock = std::size_t{1} << 16U;
// zlib: the largest window, and a gzip header.
constexpr int kGzipWindowBits = 15 + 16;
constexpr int kFirstGzipByte = 0x1f;

}  // namespace

struct GzipBuffer::State {
  std::istream& source;
  z_stream stream{};
  std::array<char, kBlock> compressed{};
  std::array<char, kBlock> plain{};
  // At the end of a gzip member, where the data may end.
  bool at_boundary = false;
};

GzipBuffer::GzipBuffer(std::istream& source) : state_(new State{source}) {
  if (inflateInit2(&state_->stream, kGzipWindowBits) != Z_OK) error_ = "no memory to decompress";
}

GzipBuffer::~GzipBuffer() { inflateEnd(&state_->stream); }

GzipBuffer::int_type GzipBuffer::underflow() {
  State& state = *state_;
  z_stream& stream = state.stream;
  stream.next_out = reinterpret_cast<Bytef*>(state.plain.data());
  stream.avail_out = static_cast<uInt>(state.plain.size());
  while (error_.empty() && stream.avail_out == state.plain.size()) {
    if (stream.avail_in == 0) {
      state.source.read(state.compressed.data(), static_cast<std::streamsize>(state.compressed.size()));
      stream.next_in = reinterpret_cast<Bytef*>(state.compressed.data());
      stream.avail_in = static_cast<uInt>(state.source.gcount());
    }
    if (stream.avail_in == 0) {
      if (!state.at_boundary) error_ = "the gzip data end early";
      break;
    }
    if (state.at_boundary) inflateReset(&stream);
    const int status = inflate(&stream, Z_NO_FLUSH);
    state.at_boundary = status == Z_STREAM_END;
    if (status != Z_OK && status != Z_STREAM_END && status != Z_BUF_ERROR) {
      error_ = std::string("the gzip data are damaged") + (stream.msg == nullptr ? "" : ", " + std::string(stream.msg));
    }
  }
  const std::size_t count = state.plain.size() - stream.avail_out;
  setg(state.plain.data(), state.plain.data(), state.plain.data() + count);
  return count == 0 ? traits_type::eof() : traits_type::to_int_type(state.plain[0]);
}

bool LooksLikeGzip(std::istream& input) { return input.peek() == kFirstGzipByte; }

}  // namespace lcpbench
