#pragma once

namespace lcpbench {

/// Whether the problem that this thread prepares or solves is the next step of a sequence (LcpSolver::SetInSequence),
/// so that what was found about the structure of the one before is worth a look. By thread, so that it reaches solvers
/// within solvers. Internal to solvers/.
class InSequence {
 public:
  /// For the length of a Prepare or Solve. Within another scope that is on, that of a solver which asks this one, it
  /// stays on.
  class Scope {
   public:
    /// Until it goes, the thread solves steps of a sequence, or not.
    explicit Scope(bool on) : before_(on_) { on_ = on_ || on; }
    ~Scope() { on_ = before_; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    bool before_;
  };

  /// Whether the thread solves steps of a sequence.
  static bool on() { return on_; }

 private:
  static inline thread_local bool on_ = false;
};

}  // namespace lcpbench
