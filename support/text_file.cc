#include "support/text_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <utility>

#include "support/input_error.h"
#include "support/output_error.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

constexpr const char* kBeside = ".lcpbench-";

[[noreturn]] void Refuse(const std::string& path, int error) {
  throw InputError(path + ": cannot be written: " + std::strerror(error));
}

[[noreturn]] void RefuseOrFail(const std::string& path, int error) {
  if (error == ENOSPC || error == EDQUOT || error == EIO) throw OutputError(path, error);
  Refuse(path, error);
}

// Where symbolic links lead to, whether something is there or not.
fs::path Target(const std::string& path) {
  constexpr int kMostLinks = 40;
  fs::path target = path;
  std::error_code none;
  for (int links = 0; fs::is_symlink(target, none); ++links) {
    if (links == kMostLinks) Refuse(path, ELOOP);
    target = target.parent_path() / fs::read_symlink(target, none);
  }
  return target;
}

bool IsBelow(const std::string& path, const char* folder) {
  return fs::absolute(path).lexically_normal().string().starts_with(folder);
}

mode_t NewMode() {
  const mode_t mask = umask(0);
  umask(mask);
  return 0666 & ~mask;
}

}  // namespace

std::string ReadTextFile(const std::string& path, std::size_t most_bytes) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  try {
    std::string text;
    for (std::istreambuf_iterator<char> byte(file), end; byte != end; ++byte) {
      if (text.size() == most_bytes) {
        throw InputError(path + ": longer than " + std::to_string(most_bytes >> 20U) + " MiB");
      }
      text += *byte;
    }
    return text;
  } catch (const std::ios_base::failure& failure) {
    throw InputError(path + ": cannot be read: " + failure.code().message());
  }
}

void RemoveUnfinished(const std::string& folder) {
  std::error_code none;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, none)) {
    if (entry.path().filename().string().starts_with(kBeside)) fs::remove(entry.path(), none);
  }
}

void WriteTextFile(const std::string& path, const std::string& text) {
  TextOutput file(path);
  file.Write(text);
  file.Close();
}

DescriptorBuffer::DescriptorBuffer(int descriptor, std::string name)
    : descriptor_(descriptor), name_(std::move(name)), block_(std::size_t{1} << 16U, '\0') {
  setp(block_.data(), block_.data() + block_.size());
}

DescriptorBuffer::int_type DescriptorBuffer::overflow(int_type c) {
  sync();
  if (!traits_type::eq_int_type(c, traits_type::eof())) sputc(traits_type::to_char_type(c));
  return traits_type::not_eof(c);
}

int DescriptorBuffer::sync() {
  const char* begin = pbase();
  const char* const end = pptr();
  setp(block_.data(), block_.data() + block_.size());
  while (begin < end) {
    const ssize_t count = write(descriptor_, begin, static_cast<std::size_t>(end - begin));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) throw OutputError(name_, count < 0 ? errno : ENOSPC);
    begin += count;
  }
  return 0;
}

CheckedStandardOutput::CheckedStandardOutput()
    : buffer_(STDOUT_FILENO, "standard output"), before_(std::cout.rdbuf(&buffer_)) {
  // Else the next file that is opened would be taken for it. The wrong way round: what uses it fails.
  const int ways[] = {O_WRONLY, O_RDONLY, O_RDWR};
  for (int standard = STDIN_FILENO; standard <= STDERR_FILENO; ++standard) {
    if (fcntl(standard, F_GETFD) >= 0) continue;
    if (open("/dev/null", ways[standard]) != standard) std::abort();  // the least that is free
  }
  std::cout.exceptions(std::ios::badbit);
  std::cerr.tie(nullptr);  // who writes to one need not know what became of the other
}

CheckedStandardOutput::~CheckedStandardOutput() {
  std::cout.exceptions(std::ios::goodbit);
  std::cout.rdbuf(before_);
}

TextOutput::TextOutput(const std::string& path) : name_(path == "-" ? "standard output" : path) {
  if (path == "-") return;
  Open(path);
  buffer_ = std::make_unique<DescriptorBuffer>(descriptor_, name_);
  file_.rdbuf(buffer_.get());
  file_.exceptions(std::ios::badbit);
}

TextOutput::~TextOutput() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!beside_.empty()) unlink(beside_.c_str());
}

void TextOutput::Open(const std::string& path) {
  const fs::path target = Target(path);
  struct stat found {};
  const bool exists = stat(target.c_str(), &found) == 0;
  if (exists && S_ISDIR(found.st_mode)) Refuse(path, EISDIR);
  if (exists && access(target.c_str(), W_OK) != 0) Refuse(path, errno);
  if ((exists && !S_ISREG(found.st_mode)) || IsBelow(path, "/dev/") || IsBelow(path, "/proc/")) {
    descriptor_ = open(path.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
    if (descriptor_ < 0) RefuseOrFail(path, errno);
    return;
  }
  std::string beside = (target.parent_path() / (kBeside + std::string("XXXXXX"))).string();
  descriptor_ = mkostemp(beside.data(), O_CLOEXEC);
  if (descriptor_ < 0) RefuseOrFail(path, errno);
  target_ = target.string();
  beside_ = beside;
  fchmod(descriptor_, exists ? found.st_mode & 07777U : NewMode());
}

std::ostream& TextOutput::stream() { return buffer_ ? file_ : std::cout; }

void TextOutput::Write(const std::string& text) { stream() << text << std::flush; }

void TextOutput::Synchronise() {
  stream() << std::flush;
  if (!beside_.empty() && fsync(descriptor_) != 0 && errno != EINVAL) throw OutputError(name_, errno);
}

void TextOutput::Close() {
  stream() << std::flush;
  if (descriptor_ < 0) return;
  // Some file systems tell only now.
  if (close(std::exchange(descriptor_, -1)) != 0) throw OutputError(name_, errno);
  if (beside_.empty()) return;
  if (rename(beside_.c_str(), target_.c_str()) != 0) throw OutputError(name_, errno);
  beside_.clear();
}

}  // namespace lcpbench
