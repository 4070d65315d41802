#include "support/subprocess.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <climits>
#include <cmath>
#include <csignal>
#include <cstring>
#include <limits>
#include <stdexcept>

#include "support/clock.h"

extern char** environ;

namespace lcpbench {
namespace {

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

// Calls `move` until all bytes have gone.
template <typename Byte, typename Move>
Transfer MoveAll(int fd, short events, Byte* data, std::size_t size, double until, Move move) {
  while (size > 0) {
    if (!WaitFor(fd, events, until)) return Transfer::kTimeout;
    const ssize_t moved = move(fd, data, size);
    if (moved < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (moved <= 0) return Transfer::kClosed;
    data += moved;
    size -= static_cast<std::size_t>(moved);
  }
  return Transfer::kDone;
}

std::array<int, 2> SocketPair() {
  std::array<int, 2> ends{-1, -1};
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) != 0) {
    throw std::runtime_error(std::string("no socket: ") + std::strerror(errno));
  }
  return ends;
}

}  // namespace

Transfer WriteAll(int fd, const void* data, std::size_t size, double until) {
  return MoveAll(fd, POLLOUT, static_cast<const char*>(data), size, until, WriteSome);
}

Transfer ReadAll(int fd, void* data, std::size_t size, double until) {
  return MoveAll(fd, POLLIN, static_cast<char*>(data), size, until, read);
}

Subprocess::Subprocess(const SubprocessOptions& options) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const std::array<int, 2> ends = SocketPair();
  socket_ = ends[0];
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  if (options.block_interrupts) {
    sigset_t blocked;
    pthread_sigmask(SIG_SETMASK, nullptr, &blocked);
    sigaddset(&blocked, SIGINT);
    sigaddset(&blocked, SIGTERM);
    posix_spawnattr_setsigmask(&attributes, &blocked);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  }
  std::vector<std::string> words = options.command;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  // What is spawned inherits the processors of this thread.
  cpu_set_t before;
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(static_cast<std::size_t>(std::max(options.cpu, 0)), &only);
  const bool is_kept = options.cpu >= 0 && sched_getaffinity(0, sizeof before, &before) == 0 &&
                       sched_setaffinity(0, sizeof only, &only) == 0;
  const int error = posix_spawnp(&pid_, arguments[0], &actions, &attributes, arguments.data(), environ);
  if (is_kept) sched_setaffinity(0, sizeof before, &before);
  posix_spawn_file_actions_destroy(&actions);
  posix_spawnattr_destroy(&attributes);
  close(ends[1]);
  if (error != 0) {
    close(socket_);
    throw std::runtime_error("'" + words[0] + "' cannot be started: " + std::strerror(error));
  }
  const auto limit = [this](auto resource, std::uint64_t value) {
    const rlimit both{value, value};
    prlimit(pid_, resource, &both, nullptr);
  };
  if (options.memory_limit > 0 && !SanitizerReservesMemory()) limit(RLIMIT_AS, options.memory_limit);
  if (!options.core_file) limit(RLIMIT_CORE, 0);
}

Subprocess::Subprocess(const std::function<void(int socket)>& body) {
  const std::array<int, 2> ends = SocketPair();
  socket_ = ends[0];
  pid_ = fork();
  if (pid_ == 0) {
    close(ends[0]);
    body(ends[1]);
    _exit(0);
  }
  const int error = errno;
  close(ends[1]);
  if (pid_ < 0) {
    close(socket_);
    throw std::runtime_error(std::string("no child process: ") + std::strerror(error));
  }
}

Subprocess::~Subprocess() {
  Kill();
  close(socket_);
}

Transfer Subprocess::ReadLine(std::string* line, double until) {
  std::size_t searched = 0;
  for (;;) {
    const std::size_t end = buffer_.find('\n', searched);
    if (end != std::string::npos) {
      line->assign(buffer_, 0, end);
      buffer_.erase(0, end + 1);
      return Transfer::kDone;
    }
    searched = buffer_.size();
    if (!WaitFor(socket_, POLLIN, until)) return Transfer::kTimeout;
    std::array<char, 65536> bytes;
    const ssize_t count = read(socket_, bytes.data(), bytes.size());
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count <= 0) return Transfer::kClosed;
    buffer_.append(bytes.data(), static_cast<std::size_t>(count));
  }
}

int Subprocess::WaitOrKill(double limit_s) {
  constexpr int kPause = 1000;  // microseconds
  const double until = SteadyNow() + limit_s;
  bool killed = false;
  while (pid_ > 0) {
    killed = killed || SteadyNow() >= until;
    if (killed) kill(pid_, SIGKILL);
    const bool wait_here = killed || limit_s == std::numeric_limits<double>::infinity();
    const pid_t ended = waitpid(pid_, &status_, wait_here ? 0 : WNOHANG);
    if (ended == pid_ || (ended < 0 && errno != EINTR)) pid_ = -1;
    if (ended == 0) usleep(kPause);
  }
  return status_;
}

std::string DescribeEnd(int status) {
  if (!WIFSIGNALED(status)) return "ended with exit status " + std::to_string(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  return "was killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
}

bool SanitizerReservesMemory() {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
  return true;
#endif
#endif
  return false;
}

}  // namespace lcpbench
