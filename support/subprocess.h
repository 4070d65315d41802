#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace lcpbench {

/// How a transfer ended: all of it is done, the other end is closed, or time is up.
enum class Transfer { kDone, kClosed, kTimeout };

/// Writes all bytes to a socket or pipe, or gives up at `until` (SteadyNow() seconds, may be infinite). A reader of a
/// socket that is gone is kClosed, never a signal.
Transfer WriteAll(int fd, const void* data, std::size_t size, double until);
/// Reads so many bytes, as WriteAll.
Transfer ReadAll(int fd, void* data, std::size_t size, double until);

/// A program to run. Limits of memory are not kept under sanitizers, which reserve more than any limit.
struct SubprocessOptions {
  std::vector<std::string> command;  ///< program (looked up in PATH unless it holds a slash) and its arguments
  std::uint64_t memory_limit = 0;    ///< address space [bytes]; 0 for none
  int cpu = -1;                      ///< the processor it is kept on; -1: any
  bool block_interrupts = false;     ///< SIGINT and SIGTERM to the whole process group do not reach it
  bool core_file = true;             ///< whether a crash may leave one
};

/// A child process and the socket to it, which is its standard input and output.
///
/// No child outlives its use. It leads a process group of its own, which is killed (SIGKILL) with all that the child
/// started where WaitOrKill ends, so also where the object ends; the child is waited for. A program is killed by the
/// system where the thread that started it ends, however that happens; its group by a process that waits for the end of
/// this one, SIGKILL too. Nothing reaches what left the group (setsid).
class Subprocess {
 public:
  /// Starts a program; without fork, as libraries of this process may hold locks and have handlers for it. Signals are
  /// as at the start of this process, but SIGTTOU is ignored: the terminal is the parent's group's.
  /// @throws std::system_error where the system gives no process, std::runtime_error where it has no such program
  explicit Subprocess(const SubprocessOptions& options);
  /// Forks: the child runs `body` with its end of the socket, and ends with status 0. It has what memory and files this
  /// process has, but one thread only.
  /// @throws std::system_error where the system gives no process
  explicit Subprocess(const std::function<void(int socket)>& body);
  ~Subprocess();
  Subprocess(const Subprocess&) = delete;
  Subprocess& operator=(const Subprocess&) = delete;

  /// The id of the child and of its group; -1 after its end was waited for.
  pid_t pid() const { return pid_; }
  /// For WriteAll and ReadAll.
  int socket() const { return socket_; }
  /// The next line without its end. Not to be mixed with ReadAll.
  Transfer ReadLine(std::string* line, double until);
  /// Waits for its end, at most so long [s], and kills it then; what it started is killed in any case.
  /// @return the status as waitpid gives it; 0 where this program leaves its children to the system
  int WaitOrKill(double limit_s);
  /// As WaitOrKill at once. Harmless where it has ended.
  int Kill() { return WaitOrKill(0); }

 private:
  pid_t pid_ = -1;
  int socket_ = -1;
  int status_ = 0;
  std::string buffer_;
};

/// "was killed by signal 11 (Segmentation fault)" or "ended with exit status 3", of a status as WaitOrKill gives it.
std::string DescribeEnd(int status);

/// Whether SIGKILL or SIGTERM ended it. Where this program did not send them, that says nothing of what it was doing.
bool WasKilled(int status);

/// Whether a sanitizer runs that reserves terabytes of address space, so that it cannot be limited.
bool SanitizerReservesMemory();

}  // namespace lcpbench
