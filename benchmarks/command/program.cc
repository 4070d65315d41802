#include "benchmarks/command/program.h"

#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <iostream>
#include <new>
#include <string>
#include <system_error>
#include <vector>

#include "solvers/lcp/memory_budget.h"
#include "solvers/linear_algebra/loaded_blas.h"
#include "support/exit_status.h"
#include "support/input_error.h"
#include "support/output_error.h"
#include "support/printable.h"
#include "support/text_file.h"

// Takes the place of OpenBLAS's own, which asks the environment when it is loaded, before any code of this program: a
// thread that it starts then spins without end where memory is short.
extern "C" int openblas_num_threads_env() { return 1; }

namespace lcpbench {
namespace {

// CLI11's own words, where they do not say what was expected.
std::string Reworded(const CLI::App& failed, const CLI::Error& error) {
  std::string text = error.what();
  if (error.get_exit_code() == static_cast<int>(CLI::ExitCodes::ExtrasError)) {
    return "unexpected: " + CLI::detail::join(failed.remaining(true), " ");
  }
  if (text.starts_with("A subcommand")) return "expected a command";
  if (error.get_name() == "ArgumentMismatch" && text.ends_with(" missing")) {
    return text.substr(0, text.find(':')) + ": expected a value";
  }
  if (error.get_name() == "ConversionError") {  // Could not convert: --size = 1e9
    const auto colon = text.find(": ");
    const auto equals = text.find(" = ", colon);
    if (equals == std::string::npos) return text;
    const std::string value = text.substr(equals + 3);
    double number = 0;
    return text.substr(colon + 2, equals - colon - 2) + ": expected a " +
           (CLI::detail::lexical_cast(value, number) ? "whole " : "") + "number, found '" + value + "'";
  }
  if (const auto set = text.find(" not in {"); set != std::string::npos) {  // --level: x not in {velocity,acceleration}
    const auto colon = text.find(": ");
    return text.substr(0, colon) + ": expected one of " + text.substr(set + 9, text.size() - set - 10) + ", found '" +
           text.substr(colon + 2, set - colon - 2) + "'";
  }
  return text;
}

// Starts the program anew with the widest kernels of OpenBLAS that the processor can run and that are right, where it
// chose narrower ones. A choice in the environment stays; workers have that of their host.
void ChooseBlasKernels(char** argv) {
  constexpr const char* kChoice = "OPENBLAS_CORETYPE";
  constexpr const char* kTried = "LCPBENCH_BLAS_KERNELS_TRIED";  // set in a program that was started anew: how many
  const char* const before = std::getenv(kTried);
  const std::size_t tried = before == nullptr ? 0 : std::strtoul(before, nullptr, 10);
  unsetenv(kTried);
  try {
    if (before == nullptr ? std::getenv(kChoice) != nullptr || !HasNarrowBlasKernels() : BlasIsRight()) return;
  } catch (const MemoryRefusal&) {
    return;  // what needs no BLAS runs
  }
  const std::vector<std::string> kernels = RunnableBlasKernels();
  if (tried > kernels.size()) return;
  if (tried < kernels.size()) {
    setenv(kChoice, kernels[tried].c_str(), 1);
  } else {
    unsetenv(kChoice);
  }
  setenv(kTried, std::to_string(tried + 1).c_str(), 1);
  execv("/proc/self/exe", argv);
  unsetenv(kTried);
}

}  // namespace

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
  setenv("OPENBLAS_NUM_THREADS", "1", 1);  // of workers, whose libraries would start threads that spin
  app.failure_message([](const CLI::App* failed, const CLI::Error& error) {
    return Printable(failed->get_name() + ": " + Reworded(*failed, error)) + " (see --help)\n";
  });
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kMisuse;
  }
  ChooseBlasKernels(argv);
  return std::nullopt;
}

}  // namespace lcpbench
