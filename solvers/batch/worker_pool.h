#pragma once

#include <barrier>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

/// Internal to solvers/batch/.
namespace lcpbench {

/// Threads that wait between calls. Only construction allocates.
class WorkerPool {
 public:
  /// @param threads  >= 1, the calling one among them
  explicit WorkerPool(int threads) : start_(threads), done_(threads) {
    for (int worker = 1; worker < threads; ++worker) {
      threads_.emplace_back([this, worker] {
        for (start_.arrive_and_wait(); job_ != nullptr; start_.arrive_and_wait()) {
          Call(worker);
          done_.arrive_and_wait();
        }
      });
    }
  }
  ~WorkerPool() {
    job_ = nullptr;
    start_.arrive_and_wait();
    for (std::thread& thread : threads_) thread.join();
  }
  WorkerPool(const WorkerPool&) = delete;
  WorkerPool& operator=(const WorkerPool&) = delete;

  /// job(w) once for every w in [0, threads), worker 0 on the calling thread; returns when all have. The first
  /// exception of any is thrown again here.
  void Run(const std::function<void(int worker)>& job) {
    job_ = &job;
    start_.arrive_and_wait();
    Call(0);
    done_.arrive_and_wait();
    if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
  }

 private:
  void Call(int worker) {
    try {
      (*job_)(worker);
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
    }
  }

  std::barrier<> start_, done_;
  const std::function<void(int)>* job_ = nullptr;  // written before start_ by the caller alone; none: end
  std::mutex mutex_;
  std::exception_ptr error_;
  std::vector<std::thread> threads_;
};

}  // namespace lcpbench
