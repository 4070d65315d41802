#pragma once

#include <istream>
#include <memory>
#include <streambuf>
#include <string>

namespace lcpbench {

/// Decompresses a gzip stream as it is read (RFC 1952, several members in a row included).
class GzipBuffer : public std::streambuf {
 public:
  /// @param source  compressed bytes, not owned; must outlive the buffer
  explicit GzipBuffer(std::istream& source);
  ~GzipBuffer() override;
  GzipBuffer(const GzipBuffer&) = delete;
  GzipBuffer& operator=(const GzipBuffer&) = delete;

  /// Why the data ended early; "" while all is well. An istream shows no more than an end of file.
  const std::string& error() const { return error_; }

 protected:
  int_type underflow() override;

 private:
  struct State;
  std::unique_ptr<State> state_;
  std::string error_;
};

/// True if the next byte of `input` begins a gzip file. Takes nothing from it.
bool LooksLikeGzip(std::istream& input);

}  // namespace lcpbench
