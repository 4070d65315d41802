#include "support/subprocess.h"

#include <fcntl.h>
#include <poll.h>
#include <sched.h>
#include <sys/prctl.h>
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
#include <mutex>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "support/cancellation.h"
#include "support/clock.h"

namespace lcpbench {
namespace {

// Waits until the descriptor is ready or the time has come.
bool WaitFor(int fd, short events, double until) {
  const double longest = Cancellation::IsPossible() ? Cancellation::kPeriod : 3600;  // s; poll's timeout is an int
  for (;;) {
    Cancellation::Check();
    const double left = until - SteadyNow();
    if (left <= 0) return false;
    pollfd entry{fd, events, 0};
    const int ready = poll(&entry, 1, static_cast<int>(std::ceil(1000 * std::min(left, longest))));
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
    throw std::system_error(errno, std::generic_category(), "no socket");
  }
  return ends;
}

constexpr std::size_t kMostGroups = 256;  // beyond so many, the guard does not know a group

// A process that is told of the groups, > 0 where one begins and < 0 where it ends, and kills those that are left when
// this process is gone, however it ended: also by SIGKILL, or the keys of a terminal, which reach its foreground group
// only.
[[noreturn]] void StandGuard(int socket) {
  sigset_t all;
  sigfillset(&all);
  sigprocmask(SIG_SETMASK, &all, nullptr);
  setpgid(0, 0);
  // Nobody waits for the end of a file that only the guard has open.
  if (socket > 0) close_range(0, static_cast<unsigned>(socket) - 1, 0);
  close_range(static_cast<unsigned>(socket) + 1, ~0U, 0);
  std::array<pid_t, kMostGroups> left{};
  pid_t told = 0;
  for (;;) {
    const ssize_t got = read(socket, &told, sizeof told);
    if (got < 0 && errno == EINTR) continue;
    if (got != sizeof told) break;
    const auto place = std::find(left.begin(), left.end(), told > 0 ? 0 : -told);
    if (place != left.end()) *place = std::max(told, 0);
  }
  for (const pid_t leader : left) {
    if (leader > 0) kill(-leader, SIGKILL);
  }
  _exit(0);
}

int guard = -1;  // the socket to it

// The guard starts with the first group; where the system has no process for it, with a later one, and until then
// PR_SET_PDEATHSIG has to do, which reaches what this process started itself.
void TellGuard(pid_t told) {
  static std::mutex mutex;
  const std::lock_guard lock(mutex);
  std::array<int, 2> ends{-1, -1};
  if (guard < 0 && socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends.data()) == 0) {
    const pid_t started = fork();
    if (started == 0) StandGuard(ends[0]);
    // Here too: who kills this process' group before the guard has run must not kill the guard with it.
    if (started > 0) setpgid(started, started);
    close(ends[0]);
    if (started > 0) {
      guard = ends[1];
    } else {
      close(ends[1]);
    }
  }
  send(guard, &told, sizeof told, MSG_NOSIGNAL);
}

// In the child of vfork, which has the memory of its parent, but handlers of signals of its own.
void ForgetHandlers() {
  for (int signal = 1; signal < NSIG; ++signal) {
    struct sigaction action = {};
    if (sigaction(signal, nullptr, &action) != 0 || action.sa_handler == SIG_IGN) continue;
    action = {};
    action.sa_handler = SIG_DFL;
    sigaction(signal, &action, nullptr);
  }
  struct sigaction ignored = {};
  ignored.sa_handler = SIG_IGN;
  sigaction(SIGTTOU, &ignored, nullptr);
}

// Becomes the program, in the child of vfork. Only system calls: another thread may hold any lock.
// @return errno where that fails
int Become(const SubprocessOptions& options, char** arguments, int socket, pid_t parent, const sigset_t& signals) {
  setpgid(0, 0);
  ForgetHandlers();
  sigprocmask(SIG_SETMASK, &signals, nullptr);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(1);  // it ended before the line above
  if (options.cpu >= 0) {
    cpu_set_t only;
    CPU_ZERO(&only);
    CPU_SET(static_cast<std::size_t>(options.cpu), &only);
    sched_setaffinity(0, sizeof only, &only);
  }
  const auto limit = [](auto resource, rlim_t value) {
    const rlimit both{value, value};
    setrlimit(resource, &both);
  };
  if (!options.core_file) limit(RLIMIT_CORE, 0);
  if (dup2(socket, STDIN_FILENO) < 0 || dup2(socket, STDOUT_FILENO) < 0) return errno;
  execvp(arguments[0], arguments);
  return errno;
}

}  // namespace

Transfer WriteAll(int fd, const void* data, std::size_t size, double until) {
  return MoveAll(fd, POLLOUT, static_cast<const char*>(data), size, until, WriteSome);
}

Transfer ReadAll(int fd, void* data, std::size_t size, double until) {
  return MoveAll(fd, POLLIN, static_cast<char*>(data), size, until, read);
}

Subprocess::Subprocess(const SubprocessOptions& options) {
  std::vector<std::string> words = options.command;
  std::vector<char*> arguments;
  arguments.reserve(words.size() + 1);
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  const std::array<int, 2> ends = SocketPair();
  socket_ = ends[0];
  // No handler of this process is to run in the child while they share the memory.
  sigset_t all;
  sigset_t before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);
  sigset_t signals = before;
  if (options.block_interrupts) {
    sigaddset(&signals, SIGINT);
    sigaddset(&signals, SIGTERM);
  }
  const pid_t parent = getpid();
  volatile int error = 0;
  // posix_spawn cannot ask for PR_SET_PDEATHSIG.
  pid_ = vfork();  // NOLINT(clang-analyzer-security.insecureAPI.vfork,bugprone-unsafe-functions)
  if (pid_ == 0) {
    error = Become(options, arguments.data(), ends[1], parent, signals);
    _exit(1);
  }
  if (pid_ < 0) error = errno;
  if (pid_ > 0 && error == 0) TellGuard(pid_);
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
  close(ends[1]);
  if (error != 0) {
    if (pid_ > 0) waitpid(pid_, nullptr, 0);
    close(socket_);
    const std::string what = "'" + words[0] + "' cannot be started";
    if (pid_ < 0) throw std::system_error(error, std::generic_category(), what);
    throw std::runtime_error(what + ": " + std::strerror(error));
  }
  if (options.memory_limit > 0 && !SanitizerReservesMemory()) {
    const rlimit both{options.memory_limit, options.memory_limit};
    prlimit(pid_, RLIMIT_AS, &both, nullptr);
  }
}

Subprocess::Subprocess(const std::function<void(int socket)>& body) {
  const std::array<int, 2> ends = SocketPair();
  socket_ = ends[0];
  pid_ = fork();
  if (pid_ == 0) {
    setpgid(0, 0);
    close(std::exchange(guard, -1));
    close(ends[0]);
    body(ends[1]);
    _exit(0);
  }
  const int error = errno;
  close(ends[1]);
  if (pid_ > 0) {
    setpgid(pid_, pid_);  // here too: whoever comes first
    TellGuard(pid_);
  }
  if (pid_ < 0) {
    close(socket_);
    throw std::system_error(error, std::generic_category(), "no child process");
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
  const bool for_ever = limit_s == std::numeric_limits<double>::infinity();
  while (pid_ > 0 && SteadyNow() < until) {
    // Its number is its group's for as long as it is not waited for.
    siginfo_t ended = {};
    const int failed = waitid(P_PID, static_cast<id_t>(pid_), &ended, WEXITED | WNOWAIT | (for_ever ? 0 : WNOHANG));
    if (failed != 0 ? errno != EINTR : ended.si_pid == pid_) break;
    if (!for_ever) usleep(kPause);
  }
  if (pid_ <= 0) return status_;
  kill(-pid_, SIGKILL);
  while (waitpid(pid_, &status_, 0) < 0 && errno == EINTR) {
  }
  TellGuard(-pid_);
  pid_ = -1;
  return status_;
}

std::string DescribeEnd(int status) {
  if (!WIFSIGNALED(status)) return "ended with exit status " + std::to_string(WEXITSTATUS(status));
  const int signal = WTERMSIG(status);
  return "was killed by signal " + std::to_string(signal) + " (" + strsignal(signal) + ")";
}

bool WasKilled(int status) {
  return WIFSIGNALED(status) && (WTERMSIG(status) == SIGKILL || WTERMSIG(status) == SIGTERM);
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
