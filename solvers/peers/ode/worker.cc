// What the worker of ODE serves.

#include "solvers/peers/linked_peers.h"

namespace lcpbench {

PeerLibrary ThisPeerLibrary() { return OdeLibrary(); }

}  // namespace lcpbench
