#include "solvers/batch/worker_pool.h"

#include <utility>

namespace lcpbench {

WorkerPool::WorkerPool(int threads) {
  for (int worker = 1; worker < threads; ++worker) threads_.emplace_back([this, worker] { Wait(worker); });
}

WorkerPool::~WorkerPool() {
  {
    const std::lock_guard lock(mutex_);
    stop_ = true;
  }
  start_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

void WorkerPool::Call(Job job, void* context, int worker) {
  try {
    job(context, worker);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    if (!error_) error_ = std::current_exception();
  }
}

void WorkerPool::Wait(int worker) {
  std::uint64_t seen = 0;
  for (;;) {
    std::unique_lock lock(mutex_);
    start_.wait(lock, [&] { return stop_ || generation_ != seen; });
    if (stop_) return;
    seen = generation_;
    const Job job = job_;
    void* const context = context_;
    lock.unlock();
    Call(job, context, worker);
    lock.lock();
    if (--running_ == 0) done_.notify_one();
  }
}

void WorkerPool::Run(Job job, void* context) {
  if (!threads_.empty()) {
    const std::lock_guard lock(mutex_);
    job_ = job;
    context_ = context;
    running_ = threads_.size();
    ++generation_;
  }
  start_.notify_all();
  Call(job, context, 0);
  std::unique_lock lock(mutex_);
  done_.wait(lock, [this] { return running_ == 0; });
  if (error_) std::rethrow_exception(std::exchange(error_, nullptr));
}

}  // namespace lcpbench
