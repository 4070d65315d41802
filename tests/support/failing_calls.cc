// Preloaded (LD_PRELOAD) into a command that is tested: one of its system calls, or allocations, fails.
//
//     LCPBENCH_FAULT="KIND K ERROR COUNT"
//
// The K-th of its calls of KIND from main on fails with errno ERROR; with ERROR 0 the process is killed there
// (SIGKILL), a write after half of it. When the process ends by itself, the number of these calls is written to the
// file COUNT.
//     write   also pwrite, writev, send      read    readv; files    fsync   also fdatasync
//     tell    write to standard error
//     rename                                 fork    also vfork      malloc  whatever allocates
// Programs that the process starts are left alone.

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstddef>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#ifdef __clang__
// These are the C library's own names.
#pragma clang diagnostic ignored "-Wreserved-identifier"
#endif

namespace {

char kind[16];
long which = 0;
int error = 0;
char count_file[4096];
bool is_on = false;
long calls = 0;

bool IsTheOne(const char* of_kind) {
  return is_on && std::strcmp(kind, of_kind) == 0 && __atomic_add_fetch(&calls, 1, __ATOMIC_RELAXED) == which;
}

// @return whether the call is to fail, with errno set
bool Fails(const char* of_kind) {
  if (!IsTheOne(of_kind)) return false;
  if (error == 0) kill(getpid(), SIGKILL);
  errno = error;
  return true;
}

bool WriteFails(int file, const void* data, std::size_t size) {
  if (!IsTheOne(file == STDERR_FILENO ? "tell" : "write")) return false;
  if (error == 0) {
    syscall(SYS_write, file, data, size / 2);
    kill(getpid(), SIGKILL);
  }
  errno = error;
  return true;
}

// A call on a socket may fail because its other end has ended.
bool IsRegular(int file) {
  struct stat found {};
  return fstat(file, &found) == 0 && S_ISREG(found.st_mode);
}

// The function that this library stands before.
template <typename Function>
Function Next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

pid_t (*real_vfork)() noexcept = nullptr;
int (*real_main)(int, char**, char**) = nullptr;

void TellCount() {
  const int file = static_cast<int>(syscall(SYS_openat, AT_FDCWD, count_file, O_WRONLY | O_CREAT | O_TRUNC, 0644));
  char text[32];
  const int size = std::snprintf(text, sizeof text, "%ld\n", calls);
  syscall(SYS_write, file, text, size);
}

int Main(int argc, char** argv, char** environment) {
  const char* fault = getenv("LCPBENCH_FAULT");
  const bool is_asked =
      fault != nullptr && std::sscanf(fault, "%15s %ld %d %4095s", kind, &which, &error, count_file) == 4;
  unsetenv("LCPBENCH_FAULT");
  unsetenv("LD_PRELOAD");
  is_on = is_asked;
  const int status = real_main(argc, argv, environment);
  is_on = false;
  if (is_asked) TellCount();
  return status;
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int argc, char** argv, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  real_main = main;
  real_vfork = Next<pid_t (*)() noexcept>("vfork");
  const auto next = Next<decltype(&__libc_start_main)>("__libc_start_main");
  return next(&Main, argc, argv, init, fini, rtld_fini, stack_end);
}

ssize_t write(int file, const void* data, std::size_t size) {
  return WriteFails(file, data, size) ? -1 : syscall(SYS_write, file, data, size);
}
ssize_t pwrite(int file, const void* data, std::size_t size, off_t at) {
  return WriteFails(file, data, size) ? -1 : syscall(SYS_pwrite64, file, data, size, at);
}
ssize_t pwrite64(int file, const void* data, std::size_t size, off64_t at) {
  return WriteFails(file, data, size) ? -1 : syscall(SYS_pwrite64, file, data, size, at);
}
ssize_t writev(int file, const iovec* parts, int count) {
  const bool fails = count > 0 && WriteFails(file, parts->iov_base, parts->iov_len);
  return fails ? -1 : syscall(SYS_writev, file, parts, count);
}
ssize_t send(int file, const void* data, std::size_t size, int flags) {
  return WriteFails(file, data, size) ? -1 : syscall(SYS_sendto, file, data, size, flags, nullptr, 0);
}

ssize_t read(int file, void* data, std::size_t size) {
  return IsRegular(file) && Fails("read") ? -1 : syscall(SYS_read, file, data, size);
}
ssize_t readv(int file, const iovec* parts, int count) {
  return IsRegular(file) && Fails("read") ? -1 : syscall(SYS_readv, file, parts, count);
}

int fsync(int file) { return Fails("fsync") ? -1 : static_cast<int>(syscall(SYS_fsync, file)); }
int fdatasync(int file) { return Fails("fsync") ? -1 : static_cast<int>(syscall(SYS_fdatasync, file)); }
int rename(const char* from, const char* to) noexcept {
  return Fails("rename") ? -1 : static_cast<int>(syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

pid_t fork() noexcept {
  static const auto next = Next<pid_t (*)()>("fork");
  return Fails("fork") ? -1 : next();
}
// Optimised to a jump: the child of vfork must not return from a function that its parent is in.
pid_t vfork() noexcept { return Fails("fork") ? -1 : real_vfork(); }

// What the program's own malloc and the C library's take memory from.
void* __libc_malloc(std::size_t size) {
  static const auto next = Next<decltype(&__libc_malloc)>("__libc_malloc");
  return Fails("malloc") ? nullptr : next(size);
}
void* __libc_calloc(std::size_t count, std::size_t size) {
  static const auto next = Next<decltype(&__libc_calloc)>("__libc_calloc");
  return Fails("malloc") ? nullptr : next(count, size);
}
void* __libc_realloc(void* old, std::size_t size) {
  static const auto next = Next<decltype(&__libc_realloc)>("__libc_realloc");
  return Fails("malloc") ? nullptr : next(old, size);
}
void* __libc_memalign(std::size_t alignment, std::size_t size) {
  static const auto next = Next<decltype(&__libc_memalign)>("__libc_memalign");
  return Fails("malloc") ? nullptr : next(alignment, size);
}
}
