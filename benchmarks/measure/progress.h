#pragma once

#include <string>

namespace lcpbench {

/// A progress bar on standard error with elapsed and remaining time. On a terminal one line that redraws itself;
/// elsewhere (a log) one line per tenth.
class ProgressBar {
 public:
  /// @param total  the sum of the weights of all steps, > 0
  ProgressBar(std::string title, double total);
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// A step of this weight is done; `label` says what comes or came.
  void Advance(double weight, const std::string& label);

 private:
  void Draw(const std::string& label);

  std::string title_;
  double total_;
  double done_ = 0;
  double start_;
  double last_drawn_ = -1;
  int last_tenth_ = -1;
  bool terminal_;
};

}  // namespace lcpbench
