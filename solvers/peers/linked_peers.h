#pragma once

#include "solvers/peers/peer_library.h"

namespace lcpbench {

// Peers that may also be linked into a program beside others, as peer-portfolio links them, for they live in one
// process with them and their licences let them (BSD or LGPL, Zlib; ALGLIB's is the GPL, which is then that of the
// program). Each is a library of its own, lcpbench_linked_<folder>, of which the peer's worker is made, too: both run
// the same code. Not for several threads.

/// Where lcpbench_linked_ode is linked.
PeerLibrary OdeLibrary();
/// Where lcpbench_linked_bullet is linked.
PeerLibrary BulletLibrary();
/// Where lcpbench_linked_alglib is linked.
PeerLibrary AlglibLibrary();

}  // namespace lcpbench
