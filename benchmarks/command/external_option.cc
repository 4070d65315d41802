#include "benchmarks/command/external_option.h"

#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {

std::shared_ptr<std::vector<std::string>> AddExternalOption(CLI::App& command) {
  auto pairs = std::make_shared<std::vector<std::string>>();
  command
      .add_option("--external", *pairs,
                  "A solver of your own: KEY=COMMAND, a program that speaks the protocol of "
                  "solvers/peers/protocol/protocol.h; may be repeated")
      ->allow_extra_args(false);  // one a flag, so that arguments may follow it
  return pairs;
}

void RegisterExternals(const std::vector<std::string>& pairs) {
  for (const std::string& pair : pairs) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size()) {
      throw InputError("--external: expected KEY=COMMAND, found '" + pair + "'");
    }
    // "$@" hands on the settings.
    RegisterExternalSolver(pair.substr(0, equals),
                           {"/bin/sh", "-c", "exec " + pair.substr(equals + 1) + " \"$@\"", "lcpbench"});
  }
}

}  // namespace lcpbench
