#include "benchmarks/command/program.h"

#include <cerrno>
#include <csignal>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <system_error>

#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/library_threads.h"
#include "support/exit_status.h"
#include "support/input_error.h"
#include "support/output_error.h"
#include "support/printable.h"
#include "support/text_file.h"

namespace lcpbench {

int RunProgram(const std::string& name, const std::function<int()>& run) {
  const auto tell = [&name](const std::string& what, int status) {
    std::cerr << name << ": " << what << std::endl;
    return status;
  };
  std::signal(SIGXFSZ, SIG_IGN);  // a limit of a file's size is reported as a full disk is
  try {
    const CheckedStandardOutput checked;
    const int status = run();
    std::cout << std::flush;
    return status;
  } catch (const OutputError& error) {
    return error.error() == EPIPE ? kBrokenPipe : tell(error.what(), kLostOutput);
  } catch (const InputError& error) {
    return tell(Printable(error.what()), kMisuse);
  } catch (const MemoryRefusal& refusal) {
    return tell(Printable(refusal.what()), kMisuse);
  } catch (const std::filesystem::filesystem_error& error) {
    return tell(Printable(error.path1().string()) + ": " + error.code().message(), kMisuse);
  } catch (const std::bad_alloc&) {
    return tell("not enough memory", kMisuse);
  } catch (const std::system_error& error) {  // the system gives no process, or a file ends in an error
    return tell(Printable(error.what()), kMisuse);
  } catch (const std::exception& error) {
    return tell("internal error: " + Printable(error.what()), 1);
  }
}

std::optional<int> ParseCommandLine(CLI::App& app, int argc, char** argv) {
  // Not first of all: where libgomp gets no memory it ends the process with a line of its own.
  LimitLibraryThreads(1);
  app.failure_message([](const CLI::App* failed, const CLI::Error& error) {
    return Printable(failed->get_name() + ": " + error.what()) + " (see --help)\n";
  });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kMisuse;
  }
  return std::nullopt;
}

}  // namespace lcpbench
