#include "benchmarks/collection/format_program.h"

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "build_info.h"
#include "solvers/io/gzip_file.h"
#include "solvers/io/json_lines.h"
#include "support/input_error.h"
#include "support/python_program.h"
#include "support/subprocess.h"

namespace lcpbench {
namespace {

class FormatProgram {
 public:
  // Problem or file that the program answers with. @throws InputError with its refusal, or `place: ` and how it ended
  std::string Exchange(const std::string& request, const std::string& place) {
    if (!process_) Start(place);
    constexpr double kForever = std::numeric_limits<double>::infinity();
    char kind = 0;
    std::uint64_t size = 0;
    std::string answer;
    const auto receive = [&](void* to, std::uint64_t count) {
      return ReadAll(process_->socket(), to, count, kForever) == Transfer::kDone;
    };
    bool is_whole = WriteAll(process_->socket(), request.data(), request.size(), kForever) == Transfer::kDone &&
                    receive(&kind, 1) && receive(&size, sizeof size);
    if (is_whole && kind != '+' && kind != '-') {
      process_.reset();
      throw InputError(
          place + ": what the program of formats answers is not understood: does its Python print something first?");
    }
    if (is_whole) {
      answer.resize(size);
      is_whole = receive(answer.data(), size);
    }
    if (!is_whole) {
      const std::string end = DescribeEnd(process_->WaitOrKill(1));
      process_.reset();
      throw InputError(place + ": the program of formats " + end);
    }
    if (kind != '+') throw InputError(answer);
    return answer;
  }

 private:
  void Start(const std::string& place) {
    SubprocessOptions start;
    try {
      start.command = PythonCommand(kFormatProgramFromProgram, kFormatProgram);
      process_.emplace(start);
    } catch (const std::runtime_error& error) {
      throw InputError(place + ": " + error.what());
    }
  }

  std::optional<Subprocess> process_;
};

// @param place  of refusals
std::string ExchangeWithProgram(const std::string& request, const std::string& place) {
  static FormatProgram program;
  return program.Exchange(request, place);
}

}  // namespace

LcpProblem ReadWithPython(const std::string& path, const ReadingOptions& options) {
  nlohmann::json chosen = {{"box_friction", options.box_friction}, {"without_friction", options.without_friction}};
  if (!options.fclib_triplets.empty()) chosen["fclib_triplets"] = options.fclib_triplets;
  if (options.symmetrize) chosen["most_asymmetry"] = *options.symmetrize;
  // A path may be any bytes: they follow the request.
  const nlohmann::json request = {{"read", path.size()}, {"options", chosen}};
  return ParseLcpRecord(ExchangeWithProgram(request.dump() + "\n" + path, path), path).problem;
}

void WriteWithPython(const LcpProblem& problem, const std::string& format, const std::string& path) {
  const std::string is_dense = problem.given_form() == MatrixForm::kDense ? "true" : "false";
  const std::string file = ExchangeWithProgram("{\"write\":\"" + format + "\",\"is_dense\":" + is_dense +
                                                   ",\"problem\":" + FormatLcpRecord(problem, true) + "}\n",
                                               path);
  TextOrGzipOutput output(path);
  output.Write(file);
  output.Close();
}

}  // namespace lcpbench
