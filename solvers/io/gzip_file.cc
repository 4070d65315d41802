#include "solvers/io/gzip_file.h"

#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <new>
#include <string_view>
#include <vector>

#include "solvers/io/file_ending.h"
#include "solvers/lcp/memory_budget.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// What a line of JSON takes once it is parsed: a value of 16 bytes for every number, of two bytes at the least.
constexpr double kMemoryPerByte = 10;
constexpr std::size_t kAlwaysRead = std::size_t{1} << 22U;  // [bytes]
constexpr std::size_t kBlock = std::size_t{1} << 16U;

gzFile Open(const std::string& path) {
  if (path == "-") return gzdopen(dup(STDIN_FILENO), "rb");
  std::error_code no_folder;
  if (std::filesystem::is_directory(path, no_folder)) throw InputError(path + ": is a folder, expected a file");
  return gzopen(path.c_str(), "rb");
}

std::string NameOf(const std::string& path) { return path == "-" ? "<stdin>" : path; }

}  // namespace

class TextInput::Buffer : public std::streambuf {
 public:
  explicit Buffer(const std::string& path) : name_(NameOf(path)), file_(Open(path), &gzclose_r), block_(kBlock) {
    if (!file_) throw InputError(path + ": cannot be opened for reading");
  }

 protected:
  int_type underflow() override {
    const int count = gzread(file_.get(), block_.data(), static_cast<unsigned>(block_.size()));
    int status = Z_OK;
    const char* message = gzerror(file_.get(), &status);
    if (count < 0) throw InputError(name_ + ": the gzip data are damaged, " + message);
    if (count == 0 && status == Z_BUF_ERROR) throw InputError(name_ + ": the gzip data end early");
    if (count == 0) return traits_type::eof();
    CheckLine({block_.data(), static_cast<std::size_t>(count)});
    setg(block_.data(), block_.data(), block_.data() + count);
    return traits_type::to_int_type(block_.front());
  }

 private:
  // The line that goes on at the end of what was read: its reader keeps it.
  void CheckLine(std::string_view read) {
    lines_ += static_cast<std::size_t>(std::count(read.begin(), read.end(), '\n'));
    const std::size_t end = read.rfind('\n');
    if (end != std::string_view::npos) {
      length_ = 0;
      checked_ = kAlwaysRead;
      read.remove_prefix(end + 1);
    }
    length_ += read.size();
    if (length_ < checked_) return;
    RequireMemory(kMemoryPerByte * static_cast<double>(length_),
                  name_ + ":" + std::to_string(lines_ + 1) + ": a line of this length");
    checked_ = 2 * length_;
  }

  std::string name_;
  std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
  std::vector<char> block_;
  std::size_t lines_ = 0;
  std::size_t length_ = 0;  // of the line that goes on
  std::size_t checked_ = kAlwaysRead;
};

TextInput::TextInput(const std::string& path) : std::istream(nullptr), buffer_(std::make_unique<Buffer>(path)) {
  rdbuf(buffer_.get());
  exceptions(std::ios::badbit);
}

TextInput::~TextInput() = default;

LineReader::LineReader(const std::string& path) : name_(NameOf(path)), input_(path) {}

bool LineReader::Next(std::string* line) {
  const bool any = static_cast<bool>(std::getline(input_, *line));
  if (any) ++number_;
  return any;
}

class TextOrGzipOutput::Deflation : public std::streambuf {
 public:
  explicit Deflation(std::ostream* to) : to_(to), block_(kBlock), packed_(kBlock) {
    constexpr int kLargestWindow = MAX_WBITS + 16;  // zlib's way to ask for gzip
    constexpr int kUsualMemory = 8;
    if (deflateInit2(&state_, Z_BEST_COMPRESSION, Z_DEFLATED, kLargestWindow, kUsualMemory, Z_DEFAULT_STRATEGY) !=
        Z_OK) {
      throw std::bad_alloc();
    }
    setp(block_.data(), block_.data() + block_.size());
  }
  ~Deflation() override { deflateEnd(&state_); }

  void Deflate(int flush) {
    state_.next_in = reinterpret_cast<Bytef*>(pbase());
    state_.avail_in = static_cast<uInt>(pptr() - pbase());
    do {
      state_.next_out = reinterpret_cast<Bytef*>(packed_.data());
      state_.avail_out = static_cast<uInt>(packed_.size());
      deflate(&state_, flush);
      to_->write(packed_.data(), static_cast<std::streamsize>(packed_.size() - state_.avail_out));
    } while (state_.avail_out == 0);
    setp(block_.data(), block_.data() + block_.size());
  }

 protected:
  int_type overflow(int_type c) override {
    Deflate(Z_NO_FLUSH);
    if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
    return traits_type::not_eof(c);
  }

 private:
  std::ostream* to_;
  z_stream state_{};
  std::vector<char> block_, packed_;
};

TextOrGzipOutput::TextOrGzipOutput(const std::string& path) : file_(path) {
  if (!EndingOf(path).is_gzip) return;
  deflation_ = std::make_unique<Deflation>(&file_.stream());
  deflated_.rdbuf(deflation_.get());
  deflated_.exceptions(std::ios::badbit);
}

TextOrGzipOutput::~TextOrGzipOutput() = default;

std::ostream& TextOrGzipOutput::stream() { return deflation_ ? deflated_ : file_.stream(); }

void TextOrGzipOutput::Write(const std::string& text) {
  if (!deflation_) return file_.Write(text);
  deflated_ << text;
}

void TextOrGzipOutput::Finish() {
  if (deflation_) deflation_->Deflate(Z_FINISH);
  file_.stream() << std::flush;
}

void TextOrGzipOutput::Close() {
  Finish();
  file_.Close();
}

void WriteGzipFile(const std::string& path, const std::string& text) {
  TextOrGzipOutput file(path);
  file.Write(text);
  file.Finish();
  file.Synchronise();
  file.Close();
}

void ReadEachLine(const std::string& path,
                  const std::function<void(const std::string& line, const std::string& where)>& handle) {
  LineReader reader(path);
  std::string line;
  bool any = false;
  while (reader.Next(&line)) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    any = true;
    handle(line, reader.name() + ":" + std::to_string(reader.number()));
  }
  if (!any) throw InputError(reader.name() + ": is empty, expected JSON lines");
}

}  // namespace lcpbench
