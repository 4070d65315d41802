#pragma once

#include <condition_variable>
#include <cstdint>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

/// Internal to solvers/batch/.
namespace lcpbench {

/// Threads that wait between calls. Only construction allocates.
class WorkerPool {
 public:
  /// @param threads  >= 1, the calling one among them
  explicit WorkerPool(int threads);
  ~WorkerPool();
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  using Job = void (*)(void* context, int worker);
  /// job(context, w) once for every w in [0, threads), worker 0 on the calling thread; returns when all have. The first
  /// exception of any is thrown again here.
  void Run(Job job, void* context);

 private:
  void Wait(int worker);
  void Call(Job job, void* context, int worker);

  std::mutex mutex_;
  std::condition_variable start_, done_;
  std::uint64_t generation_ = 0;
  std::size_t running_ = 0;
  bool stop_ = false;
  Job job_ = nullptr;
  void* context_ = nullptr;
  std::exception_ptr error_;
  std::vector<std::thread> threads_;
};

}  // namespace lcpbench
