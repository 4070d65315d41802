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
  constexpr int kWidth = 30;
  const double now = SteadyNow();
  const double fraction = done_ / total_;
  const bool finished = done_ >= total_;
  const double elapsed = now - start_;
  const std::string remaining = fraction > 0.01 ? Clock(elapsed / fraction - elapsed) : "?";
  if (terminal_) {
    if (!finished && now - last_drawn_ < kRedrawInterval) return;
    last_drawn_ = now;
    const int filled = static_cast<int>(fraction * kWidth);
    std::fprintf(stderr, "\r\033[K%s [%s%s] %3.0f%%  elapsed %s  remaining %s  %s", title_.c_str(),
                 std::string(static_cast<std::size_t>(filled), '#').c_str(),
                 std::string(static_cast<std::size_t>(kWidth - filled), '.').c_str(), 100 * fraction,
                 Clock(elapsed).c_str(), remaining.c_str(), label.c_str());
    std::fflush(stderr);
    return;
  }
  const int tenth = static_cast<int>(fraction * 10);
  if (tenth == last_tenth_) return;
  last_tenth_ = tenth;
  std::fprintf(stderr, "%s %3.0f%%  elapsed %s  remaining %s  %s\n", title_.c_str(), 100 * fraction,
               Clock(elapsed).c_str(), remaining.c_str(), label.c_str());
}

}  // namespace lcpbench
