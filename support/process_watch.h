#pragma once

namespace lcpbench {

/// How long a fixed chain of dependent integer operations takes [s], the shortest of a few runs of 10 us: the inverse
/// of the clock rate, whatever lies in caches. A processor that throttles shows here.
double ProbeSpeed();

/// Processor time of the calling thread [s].
double ThreadTime();

/// How often the calling thread was taken off the processor though it wanted to go on.
long long InvoluntarySwitches();

/// What the machine did to one thread while it ran.
struct Disturbance {
  double probe_s = 0;      ///< ProbeSpeed before or after, the slower one
  double cpu_share = 1;    ///< processor time by wall-clock time; below 1: it waited for others
  long long switches = 0;  ///< that it was taken off the processor though it wanted to go on
};

/// Observes the calling thread from construction to Finish.
class DisturbanceWatch {
 public:
  DisturbanceWatch();
  Disturbance Finish() const;

 private:
  double probe_s_;
  double wall_;
  double cpu_;
  long long switches_;
};

/// Linux: from here on PeakBytes() counts anew. Freed memory is given back first.
void ResetPeak();
/// The most memory of this process that was resident at a time since ResetPeak() [bytes]; 0 where unknown.
double PeakBytes();

}  // namespace lcpbench
