// The main program of every peer's worker: lcpbench-worker-<peer> KEY [NAME=VALUE ...], started by ExternalSolver.

#include <exception>
#include <iostream>
#include <string>

#include "solvers/external/worker.h"
#include "solvers/lcp/input_error.h"
#include "solvers/peers/peer_library.h"

namespace {

lcpbench::Settings ParseSettings(int argc, char** argv) {
  lcpbench::Settings settings;
  for (int i = 2; i < argc; ++i) {
    const std::string pair = argv[i];
    const auto equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw lcpbench::InputError("expected NAME=VALUE, found '" + pair + "'");
    }
    settings[pair.substr(0, equals)] = pair.substr(equals + 1);
  }
  return settings;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace lcpbench;
  constexpr int kMisuse = 2;
  try {
    const PeerLibrary library = ThisPeerLibrary();
    std::string known;
    for (const PeerSolver& solver : library.solvers) {
      if (argc > 1 && solver.key == argv[1]) {
        const auto make = [&solver, settings = ParseSettings(argc, argv)] { return solver.make(settings); };
        make();  // what is wrong with the settings is said now
        Hello hello;
        hello.name = solver.key;
        hello.library_version = library.version;
        hello.licence = library.licence;
        return RunWorker(hello, make);
      }
      known += (known.empty() ? "" : ", ") + std::string(solver.key);
    }
    throw InputError("expected one of " + known);
  } catch (const InputError& error) {
    std::cerr << argv[0] << ": " << error.what() << std::endl;
    return kMisuse;
  } catch (const std::exception& error) {
    std::cerr << argv[0] << ": internal error: " << error.what() << std::endl;
    return 1;
  }
}
