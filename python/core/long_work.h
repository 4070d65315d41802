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
#include "support/interruption.h"

namespace lcpbench::python {

/// Whether signals come to this thread. Needs the GIL the first time.
bool IsMainThread();
/// Lets Python look at signals: whether a handler has raised, as that of Ctrl-C does. Takes the GIL.
bool HasSignalRaised(void* unused = nullptr);

/// Runs work that needs no GIL, without it. On the main thread what a signal's handler raises ends the work.
/// @throws what the work throws, and what the handler raised
template <typename Work>
void WithoutGil(Work work) {
  bool (*const look)(void*) = IsMainThread() ? &HasSignalRaised : nullptr;
  try {
    const nanobind::gil_scoped_release release;
    const Interruption::Scope scope(look, nullptr);
    work();
  } catch (...) {
    if (PyErr_Occurred() != nullptr) throw nanobind::python_error();
    throw;
  }
  // Libraries may have taken the interruption for a failure of their own.
  if (PyErr_Occurred() != nullptr) throw nanobind::python_error();
}

/// The same for work that may go on for long without a look at what interrupts it, as libraries do. It has a thread of
/// its own, which is left where it is interrupted, and ends at its next look. So it must own all that it uses.
/// @param is_short  a thread would cost too much
template <typename Work>
auto Abandonable(bool is_short, Work work) {
  std::optional<decltype(work())> made;
  if (is_short || !IsMainThread()) {
    WithoutGil([&] { made = work(); });
    return *std::move(made);
  }
  const auto is_left = std::make_shared<std::atomic<bool>>(false);
  std::packaged_task<decltype(work())()> task([work = std::move(work), is_left]() mutable {
    const auto look = [](void* flag) { return static_cast<std::atomic<bool>*>(flag)->load(); };
    const Interruption::Scope scope(look, is_left.get());
    return work();
  });
  auto answer = task.get_future();
  WithoutGil([&] {
    std::thread(std::move(task)).detach();
    try {
      constexpr std::chrono::milliseconds kLook(20);
      while (answer.wait_for(kLook) != std::future_status::ready) Interruption::Check();
    } catch (const Interrupted&) {
      *is_left = true;
      throw;
    }
    made = answer.get();
  });
  return *std::move(made);
}

/// Of work on a problem that takes some milliseconds.
inline bool IsShort(const LcpProblem& problem) { return problem.size() <= 200; }

/// Waits for the turn of a thread with an object that threads share. Within WithoutGil.
inline std::unique_lock<std::timed_mutex> TakeTurn(std::timed_mutex& mutex) {
  std::unique_lock turn(mutex, std::try_to_lock);
  while (!turn.owns_lock()) {
    Interruption::Check();
    if (turn.try_lock_for(std::chrono::duration<double>(Interruption::kPeriod))) break;
  }
  return turn;
}

}  // namespace lcpbench::python
