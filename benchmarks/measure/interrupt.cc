#include "benchmarks/measure/interrupt.h"

namespace lcpbench {
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
