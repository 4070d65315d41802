#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <chrono>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "solvers/lcp/problem.h"
#include "support/cancellation.h"

namespace lcpbench::python {

/// Whether signals come to this thread. Needs the GIL the first time.
bool IsMainThread();
/// Lets Python look at signals: whether a handler has raised, as that of Ctrl-C does. Takes the GIL.
bool HasSignalRaised(void* unused = nullptr);

/// Limits the threads of BLAS and OpenMP; returns how many BLAS reports.
int LimitThreads(int threads);
/// The same in this thread, where that was called: OpenMP's limit is of a thread.
void LimitThreadsAgain();

/// Runs work that needs no GIL, without it. On the main thread what a signal's handler raises ends the work.
/// @throws what the work throws, and what the handler raised
template <typename Work>
void WithoutGil(Work work) {
  bool (*const look)(void*) = IsMainThread() ? &HasSignalRaised : nullptr;
  try {
    const nanobind::gil_scoped_release release;
    const Cancellation::Scope scope(look, nullptr);
    work();
  } catch (...) {
    if (PyErr_Occurred() != nullptr) throw nanobind::python_error();
    throw;
  }
  // Libraries may have taken the interruption for a failure of their own.
  if (PyErr_Occurred() != nullptr) throw nanobind::python_error();
}

/// Work that may go on for long without a look at what interrupts it, as libraries do: where it can be interrupted it
/// has a thread of its own, which is left then, and ends at its next look. So it must own all that it uses.
/// Within WithoutGil.
/// @param is_short  a thread would cost too much
template <typename Work>
auto Leavable(bool is_short, Work work) {
  if (is_short || !Cancellation::IsPossible()) return work();
  const auto is_left = std::make_shared<std::atomic<bool>>(false);
  std::packaged_task<decltype(work())()> task([work = std::move(work), is_left]() mutable {
    const auto look = [](void* flag) { return static_cast<std::atomic<bool>*>(flag)->load(); };
    const Cancellation::Scope scope(look, is_left.get());
    LimitThreadsAgain();
    return work();
  });
  auto answer = task.get_future();
  std::thread(std::move(task)).detach();
  try {
    constexpr std::chrono::milliseconds kLook(20);
    while (answer.wait_for(kLook) != std::future_status::ready) Cancellation::Check();
  } catch (const Cancelled&) {
    *is_left = true;
    throw;
  }
  return answer.get();
}

/// The same, with the GIL.
template <typename Work>
auto LeavableWithoutGil(bool is_short, Work work) {
  std::optional<decltype(work())> made;
  WithoutGil([&] { made = Leavable(is_short, std::move(work)); });
  return *std::move(made);
}

/// Whether what is done with a problem takes some milliseconds, mostly.
inline bool IsShort(const LcpProblem& problem) {
  const bool is_dense = problem.given_form() == MatrixForm::kDense;
  return problem.size() <= (!problem.is_plain() ? 500 : is_dense ? 1000 : 2000);
}

/// Waits for the turn of a thread with an object that threads share. Within WithoutGil.
inline std::unique_lock<std::timed_mutex> TakeTurn(std::timed_mutex& mutex) {
  std::unique_lock turn(mutex, std::try_to_lock);
  while (!turn.owns_lock()) {
    Cancellation::Check();
    if (turn.try_lock_for(std::chrono::duration<double>(Cancellation::kPeriod))) break;
  }
  return turn;
}

}  // namespace lcpbench::python
