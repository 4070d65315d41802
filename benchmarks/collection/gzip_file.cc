#include "benchmarks/collection/gzip_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <memory>
#include <new>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "support/exit_status.h"
#include "support/input_error.h"
#include "support/printable.h"
#include "support/text_file.h"

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

}  // namespace

LineReader::LineReader(const std::string& path)
    : name_(path == "-" ? "<stdin>" : path), file_(Open(path), &gzclose_r), block_(kBlock) {
  if (!file_) throw InputError(path + ": cannot be opened for reading");
}

bool LineReader::Next(std::string* line) {
  line->clear();
  bool any = false;
  std::size_t checked = kAlwaysRead;
  while (at_ < end_ || Fill()) {
    any = true;
    const char* begin = block_.data() + at_;
    const char* stop = std::find(begin, static_cast<const char*>(block_.data()) + end_, '\n');
    line->append(begin, stop);
    if (line->size() >= checked) {
      RequireMemory(kMemoryPerByte * static_cast<double>(line->size()),
                    name_ + ":" + std::to_string(number_ + 1) + ": a line of this length");
      checked = 2 * line->size();
    }
    at_ = static_cast<std::size_t>(stop - block_.data()) + 1;
    if (at_ <= end_) break;  // else the line goes on in the next block
  }
  if (any) ++number_;
  return any;
}

bool LineReader::Fill() {
  const int count = gzread(file_.get(), block_.data(), static_cast<unsigned>(block_.size()));
  int status = Z_OK;
  const char* message = gzerror(file_.get(), &status);
  if (count < 0) throw InputError(name_ + ": the gzip data are damaged, " + message);
  if (count == 0 && status == Z_BUF_ERROR) throw InputError(name_ + ": the gzip data end early");
  at_ = 0;
  end_ = static_cast<std::size_t>(count);
  return count > 0;
}

void WriteGzipFile(const std::string& path, const std::string& text) {
  constexpr int kLargestWindow = MAX_WBITS + 16;  // zlib's way to ask for gzip
  constexpr int kUsualMemory = 8;
  z_stream deflation{};
  if (deflateInit2(&deflation, Z_BEST_COMPRESSION, Z_DEFLATED, kLargestWindow, kUsualMemory, Z_DEFAULT_STRATEGY) !=
      Z_OK)
    throw std::bad_alloc();
  const std::unique_ptr<z_stream, decltype(&deflateEnd)> end(&deflation, &deflateEnd);
  TextOutput file(path);
  std::vector<char> packed(kBlock);
  for (std::size_t at = 0, size = 0; at <= text.size(); at += kBlock) {
    size = std::min(kBlock, text.size() - at);
    // zlib does not write there.
    deflation.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(text.data()) + at);
    deflation.avail_in = static_cast<uInt>(size);
    do {
      deflation.next_out = reinterpret_cast<Bytef*>(packed.data());
      deflation.avail_out = static_cast<uInt>(kBlock);
      deflate(&deflation, at + kBlock > text.size() ? Z_FINISH : Z_NO_FLUSH);
      file.stream().write(packed.data(), static_cast<std::streamsize>(kBlock - deflation.avail_out));
    } while (deflation.avail_out == 0);
  }
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

int TellRefusal(const std::function<void()>& act, bool aloud) {
  try {
    act();
    return 0;
  } catch (const InputError& error) {
    if (aloud) std::cerr << "lcpbench: " << Printable(error.what()) << std::endl;
    return kMisuse;
  }
}

int ForEachLine(const std::vector<std::string>& files,
                const std::function<void(const std::string& line, const std::string& where)>& handle) {
  constexpr int kMostTold = 10;
  int status = 0;
  for (const std::string& path : files) {
    int refused = 0;
    const int of_file = TellRefusal([&] {
      ReadEachLine(path, [&](const std::string& line, const std::string& where) {
        const int of_line = TellRefusal([&] { handle(line, where); }, refused < kMostTold);
        refused += of_line != 0 ? 1 : 0;
        status |= of_line;
      });
    });
    status |= of_file;
    if (refused > kMostTold) {
      std::cerr << "lcpbench: " << Printable(path == "-" ? "<stdin>" : path) << ": and " << refused - kMostTold
                << " more" << std::endl;
    }
  }
  return status;
}

}  // namespace lcpbench
