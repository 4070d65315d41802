// The Open Dynamics Engine's Dantzig code with an updated LDL^T factor, dxSolveLCP.
//
// ODE has no public way to it: the library exports the function, but no installed header declares it, so the
// declarations below repeat what version 0.16.2 exports. (b, x) and (lower, upper) are interleaved, rows of A padded to
// a multiple of four. Its work arrays come from an arena, an internal class that the caller makes: five pointers, of
// which this function reads and advances the first only.
//
// The function returns nothing. When a step has no positive length, it leaves the remaining rows at zero, prints "LCP
// internal error" through ODE's message handler and returns: that message is its claim of failure, and read as such.

#include <ode/ode.h>

#include <Eigen/Core>
#include <cstdarg>
#include <cstddef>
#include <limits>
#include <vector>

#include "solvers/peers/dantzig_peer.h"
#include "solvers/peers/peer_library.h"

/// Hands out memory from `next` on. Its owner sets `next` back to `begin` before each use.
class dxWorldProcessMemArena {  // NOLINT(readability-identifier-naming): the linker looks for this name
 public:
  void* next = nullptr;
  void* begin = nullptr;
  void* end = nullptr;
  void* buffer = nullptr;
  const void* manager = nullptr;  // who frees the buffer: not the function called here
};
std::size_t dxEstimateSolveLCPMemoryReq(unsigned int rows, bool w_is_given);
void dxSolveLCP(dxWorldProcessMemArena* arena, unsigned int rows, dReal* A, dReal* b_and_x, dReal* w,
                unsigned int unbounded_first, dReal* lower_and_upper, int* findex);

namespace lcpbench {
namespace {

static_assert(sizeof(dReal) == sizeof(double), "ODE was built for single precision");
static_assert(dInfinity == std::numeric_limits<double>::infinity(), "ODE compares bounds with its own infinity");

// State of the call that runs: a process solves one problem at a time, and ODE's handler takes no context.
struct CallState {
  std::vector<double> b_and_x;
  std::vector<double> lower_and_upper;
  std::vector<std::byte, Eigen::aligned_allocator<std::byte>> memory;
  dxWorldProcessMemArena arena;
  bool failed = false;
};
CallState& State() {
  static CallState state;
  return state;
}

void NoteFailure(int number, const char* /*text*/, std::va_list /*arguments*/) {
  if (number == d_ERR_LCP) State().failed = true;
}

void Interleave(const DantzigProblem& p) {
  CallState& state = State();
  const auto rows = static_cast<std::size_t>(p.rows);
  state.failed = false;
  state.b_and_x.resize(2 * rows);
  state.lower_and_upper.resize(2 * rows);
  for (std::size_t i = 0; i < rows; ++i) {
    state.b_and_x[2 * i] = p.b[i];
    state.b_and_x[2 * i + 1] = p.x[i];
    state.lower_and_upper[2 * i] = p.lower[i];
    state.lower_and_upper[2 * i + 1] = p.upper[i];
  }
  state.memory.resize(dxEstimateSolveLCPMemoryReq(static_cast<unsigned int>(p.rows), true));
  state.arena.buffer = state.arena.begin = state.arena.next = state.memory.data();
  state.arena.end = state.memory.data() + state.memory.size();
}

bool CallDantzig(const DantzigProblem& p) {
  CallState& state = State();
  dxSolveLCP(&state.arena, static_cast<unsigned int>(p.rows), p.A, state.b_and_x.data(), p.w, 0,
             state.lower_and_upper.data(), p.findex);
  return !state.failed;
}

void TakeForces(const DantzigProblem& p) {
  const CallState& state = State();
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.rows); ++i) p.x[i] = state.b_and_x[2 * i + 1];
  if (!p.has_friction) return;
  for (std::size_t i = 0; i < static_cast<std::size_t>(p.rows); ++i) p.upper[i] = state.lower_and_upper[2 * i + 1];
}

std::unique_ptr<LcpSolver> Make(std::string_view key, SettingsReader* reader) {
  return std::make_unique<DantzigPeer>(key, reader,
                                       DantzigPeer::Code{&PadToFour, &CallDantzig, &Interleave, &TakeForces});
}

}  // namespace

PeerLibrary ThisPeerLibrary() {
  dSetMessageHandler(&NoteFailure);
  // The library does not tell its version at run time; that of its header, which the build demands to be 0.16.2.
  return {dODE_VERSION, &Make};
}

}  // namespace lcpbench
