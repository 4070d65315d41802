#include "benchmarks/measure/progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "solvers/lcp/solver.h"

namespace lcpbench {
namespace {

std::string Clock(double seconds) {
  const int whole = static_cast<int>(std::lround(std::max(0.0, seconds)));
  char text[32];
  std::snprintf(text, sizeof text, "%d:%02d", whole / 60, whole % 60);
  return text;
}

}  // namespace

ProgressBar::ProgressBar(std::string title, double total)
    : title_(std::move(title)), total_(total), start_(SteadyNow()), terminal_(isatty(STDERR_FILENO) != 0) {
  Draw("");
}

ProgressBar::~ProgressBar() {
  if (terminal_) std::fputc('\n', stderr);
}

void ProgressBar::Advance(double weight, const std::string& label) {
  done_ = std::min(total_, done_ + weight);
  Draw(label);
}

void ProgressBar::Draw(const std::string& label) {
  constexpr double kRedrawInterval = 0.1;  // s; a bar that redraws more often costs more than it tells
  constexpr std::size_t kWidth = 30;
  const double now = SteadyNow();
  const double fraction = done_ / total_;
  const int tenth = static_cast<int>(fraction * 10);
  if (terminal_ ? done_ < total_ && now - last_drawn_ < kRedrawInterval : tenth == last_tenth_) return;
  last_drawn_ = now;
  last_tenth_ = tenth;
  const double elapsed = now - start_;
  const std::string remaining = fraction > 0.01 ? Clock(elapsed / fraction - elapsed) : "?";
  const auto filled = static_cast<std::size_t>(fraction * kWidth);
  const std::string bar = " [" + std::string(filled, '#') + std::string(kWidth - filled, '.') + "]";
  std::fprintf(stderr, "%s%s%s %3.0f%%  elapsed %s  remaining %s  %s%s", terminal_ ? "\r\033[K" : "", title_.c_str(),
               terminal_ ? bar.c_str() : "", 100 * fraction, Clock(elapsed).c_str(), remaining.c_str(), label.c_str(),
               terminal_ ? "" : "\n");
  std::fflush(stderr);
}

namespace {

volatile std::sig_atomic_t received = 0;

void Note(int signal) { received = signal; }

}  // namespace

Interruption::Interruption() {
  received = 0;
  struct sigaction action = {};
  action.sa_handler = &Note;
  sigemptyset(&action.sa_mask);
  action.sa_flags = static_cast<int>(SA_RESETHAND) | SA_RESTART;
  sigaction(SIGINT, &action, &interrupt_before_);
  sigaction(SIGTERM, &action, &terminate_before_);
}

Interruption::~Interruption() {
  sigaction(SIGINT, &interrupt_before_, nullptr);
  sigaction(SIGTERM, &terminate_before_, nullptr);
}

bool Interruption::Requested() { return received != 0; }

void Interruption::Check() {
  if (Requested()) throw Interrupted();
}

int Interruption::ExitStatus() { return 128 + received; }

}  // namespace lcpbench
