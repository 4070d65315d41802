#pragma once

namespace lcpbench {

/// Thrown where the work of this thread is interrupted. No std::exception, so that nobody who takes those as failures
/// of a method goes on with another one.
struct Cancelled {};

/// Whether somebody may want the work of this thread to end before its time, as Ctrl-C in Python does. By thread, so
/// that it reaches whatever a call does.
class Cancellation {
 public:
  static constexpr double kPeriod = 0.05;  ///< how often is asked [s]

  /// Until it goes, Check asks `happened` at most every kPeriod seconds, for the first time after one. Asking may take
  /// a while. Scopes may lie within each other: the inner one counts.
  class Scope {
   public:
    /// @param happened  not owned; `context` is its argument. nullptr: nobody may
    Scope(bool (*happened)(void*), void* context) : happened_(happened), context_(context), outer_(current_) {
      current_ = happened == nullptr ? nullptr : this;
    }
    ~Scope() { current_ = outer_; }
    Scope(const Scope&) = delete;
    Scope& operator=(const Scope&) = delete;

   private:
    friend class Cancellation;
    void Look();

    bool (*const happened_)(void*);
    void* const context_;
    Scope* const outer_;
    double next_ = 0;  // 0: the clock was not read yet, which short work should not pay for
    bool is_over_ = false;
  };

  /// Whether Check may throw.
  static bool IsPossible() { return current_ != nullptr; }

  /// To be called every few milliseconds; a clock read where IsPossible, else nothing.
  /// @throws Cancelled
  static void Check() {
    if (current_ != nullptr) current_->Look();
  }

 private:
  static inline thread_local Scope* current_ = nullptr;
};

}  // namespace lcpbench
