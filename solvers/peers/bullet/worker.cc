// What the worker of Bullet serves.

#include "solvers/peers/linked_peers.h"

namespace lcpbench {

PeerLibrary ThisPeerLibrary() { return BulletLibrary(); }

}  // namespace lcpbench
