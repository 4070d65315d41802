#include "support/file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "support/input_error.h"

namespace lcpbench {
namespace {

std::string ThisProcess() {
  std::array<char, 256> host{};
  gethostname(host.data(), host.size() - 1);
  return "process " + std::to_string(getpid()) + " on host " + host.data();
}

// What the holder wrote; it may not have come to that yet, or found the disk full.
std::string HolderOf(int file) {
  std::array<char, 320> text{};
  const ssize_t count = pread(file, text.data(), text.size(), 0);
  const std::string holder(text.data(), count > 0 ? static_cast<std::size_t>(count) : 0);
  return holder.empty() || holder.back() != '\n' ? "another process" : holder.substr(0, holder.find('\n'));
}

}  // namespace

FileLock::FileLock(const std::string& path) : file_(open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  if (file_ < 0) throw InputError(path + ": cannot be written: " + std::strerror(errno));
  if (flock(file_, LOCK_EX | LOCK_NB) != 0) {
    const int error = errno;
    const std::string holder = HolderOf(file_);
    close(file_);
    throw InputError(path + (error == EWOULDBLOCK ? ": is locked by " + holder
                                                  : std::string(": cannot be locked: ") + std::strerror(error)));
  }
  const std::string text = ThisProcess() + "\n";
  // Only for the words above: the lock holds without it.
  if (ftruncate(file_, 0) == 0) [[maybe_unused]]
    const ssize_t written = pwrite(file_, text.data(), text.size(), 0);
}

FileLock::~FileLock() { close(file_); }

}  // namespace lcpbench
