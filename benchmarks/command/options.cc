#include "benchmarks/command/options.h"

#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <utility>

#include "build_info.h"
#include "solvers/registry.h"
#include "support/input_error.h"

namespace lcpbench {
namespace {

// One a flag, so that arguments may follow it.
void AddRepeated(CLI::App& command, const char* name, std::vector<std::string>* values, const char* description) {
  command.add_option(name, *values, description)->allow_extra_args(false);
}

// What stands before and after the first '='; neither is empty.
std::pair<std::string, std::string> Divided(const std::string& pair, const char* option, const char* expected) {
  const auto equals = pair.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == pair.size()) {
    throw InputError(std::string(option) + ": expected " + expected + ", found '" + pair + "'");
  }
  return {pair.substr(0, equals), pair.substr(equals + 1)};
}

// A command that begins with a plain word names its program by it; of any other the shell says what is missing.
void RequireProgram(const std::string& key, const std::string& command) {
  const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./+,:@%-";
  const std::size_t begin = command.find_first_not_of(' ');
  if (begin == std::string::npos) throw InputError("--external " + key + ": expected a program");
  const std::size_t end = command.find_first_not_of(plain, begin);
  if (end != std::string::npos && command[end] != ' ') return;
  const std::string program = command.substr(begin, end == std::string::npos ? end : end - begin);
  const auto is_there = [](const std::string& path) {
    std::error_code none;
    return std::filesystem::is_regular_file(path, none) && access(path.c_str(), X_OK) == 0;
  };
  bool found = is_there(program);
  if (program.find('/') == std::string::npos) {
    const char* path = std::getenv("PATH");
    const std::vector<std::string> folders = CLI::detail::split(path == nullptr ? "/usr/bin:/bin" : path, ':');
    found = std::any_of(folders.begin(), folders.end(), [&](const std::string& folder) {
      return is_there((folder.empty() ? "." : folder) + "/" + program);
    });
  }
  if (!found)
    throw InputError("--external " + key + ": '" + program + "' cannot be run: there is no such executable file");
}

}  // namespace

CLI::Validator Expect(const std::string& expected, const std::function<bool(double)>& holds) {
  const auto check = [=](const std::string& text) {
    double value = 0;
    const bool good = CLI::detail::lexical_cast(text, value) && holds(value);
    return good ? std::string() : "expected " + expected + ", found '" + text + "'";
  };
  return {check, ""};
}

CLI::Validator AtLeast(int least) {
  return Expect("a number >= " + std::to_string(least), [least](double value) { return value >= least; });
}

CLI::Validator PositiveSeconds() {
  return Expect("seconds > 0", [](double value) { return value > 0; });
}

CLI::Validator Tolerance() {
  return Expect("a number in (0, 1)", [](double value) { return value > 0 && value < 1; });
}

void AddToleranceOption(CLI::App& command, double* tolerance) {
  command.add_option("--tolerance", *tolerance, "Bound on rho, the scaled natural residual")->check(Tolerance());
}

void AddReadingOptions(CLI::App& command, ReadingOptions* reading) {
  command
      .add_option(
          "--fclib-triplets", reading->fclib_triplets,
          "Whether p of FCLib's triplets has rows (rows-first, fclib.h) or columns (columns-first, Siconos) [default: "
          "what the ranges of the indices allow; refused where both fit]")
      ->check(CLI::IsMember({"rows-first", "columns-first"}));
  command.add_flag("--without-friction", reading->without_friction,
                   "Read problems without their friction rows, of FCLib's and Siconos' contacts the normal rows alone");
  command.add_flag(
      "--box-friction", reading->box_friction,
      "Bound the force of each tangent of FCLib's and Siconos' contacts in space, whose friction is that of "
      "a disc");
  command
      .add_option("--symmetrize", reading->symmetrize,
                  "Where A is symmetric but for this (0 to 1, relative to the diagonal), take (A + A^T) / 2; the "
                  "amount is noted as `symmetrized`")
      ->check(Expect("a number from 0 to 1", [](double bound) { return bound >= 0 && bound <= 1; }));
}

void AddCpuOption(CLI::App& command, int* cpu) {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  std::string numbers;
  for (int k = 0; k < CPU_SETSIZE; ++k) {
    if (CPU_ISSET(k, &allowed)) numbers += (numbers.empty() ? "" : ", ") + std::to_string(k);
  }
  const auto may_use = [allowed](double k) {
    return k >= 0 && k < CPU_SETSIZE && CPU_ISSET(static_cast<std::size_t>(k), &allowed);
  };
  command.add_option("--cpu", *cpu, "The processor that solves are kept on")
      ->check(Expect("a processor that this process may use, one of " + numbers, may_use));
}

void AddTimeLimitOption(CLI::App& command, double* time_limit_s) {
  command.add_option("--time-limit", *time_limit_s, "Seconds per problem")->check(PositiveSeconds());
}

std::vector<CLI::Option*> SceneOptions::AddSizeAndSeed(CLI::App& command) {
  return {command.add_option("--size", size, "Of a scene family: number of rows n at the start")->check(AtLeast(1)),
          command.add_option("--seed", seed, "Of a scene family: the same seed gives the same scene, bit for bit")
              ->check(AtLeast(0))};
}

void SceneOptions::AddFriction(CLI::App& command) {
  command.add_option("--friction", friction, "Coefficient of friction of every contact [default: the scene's own]")
      ->default_str("")
      ->check(Expect("a number from 0 to 1e6", [](double mu) { return mu >= 0 && mu <= kMostFriction; }));
}

void SceneOptions::AddLevel(CLI::App& command) {
  command.add_option("--level", level, "acceleration or velocity [default: the scene's own]");
}

void SceneOptions::AddStep(CLI::App& command) {
  command.add_option("--dt", step, "Seconds per step [default: the scene's own]")->check(PositiveSeconds());
}

void SceneOptions::AddBudget(CLI::App& command) {
  command
      .add_option("--budget", budget_s,
                  "Seconds for the motion, and for a picture's answer; what takes longer is stopped")
      ->default_str("")
      ->check(PositiveSeconds());
}

MovingScene SceneOptions::Load() const {
  MovingScene loaded = LoadScene(scene, size, seed);
  if (!level.empty()) loaded.level = MotionLevelFromString(level);
  if (step > 0) loaded.step = step;
  if (friction >= 0) SetFriction(friction, &loaded);
  return loaded;
}

std::pair<ContactSystem, AssembledLcp> SceneOptions::LoadProblem() const {
  const MovingScene moving = Load();
  ContactSystem system = LoadInstant(scene, size, seed, moving.level);
  if (friction >= 0) SetFriction(friction, &system);
  AssembledLcp lcp = AssembleInstant(system, moving.step);
  return {std::move(system), std::move(lcp)};
}

void AddSettingsOption(CLI::App& command, std::vector<std::string>* pairs) {
  AddRepeated(command, "--set", pairs, "Option of the solver itself, NAME=VALUE; may be repeated");
}

Settings ParseSettings(const std::vector<std::string>& pairs) {
  Settings settings;
  for (const std::string& pair : pairs) {
    const auto equals = pair.find('=');
    if (equals == std::string::npos || equals == 0) {
      throw InputError("--set: expected NAME=VALUE, found '" + pair + "'");
    }
    const std::string name = pair.substr(0, equals);
    if (!settings.emplace(name, pair.substr(equals + 1)).second) {
      throw InputError("--set: expected every name once, found '" + name + "' twice");
    }
  }
  return settings;
}

void NamedSolvers::Declare(CLI::App& command) {
  command.add_option("--start-limit", start_limit_s, "Seconds that a program of --external has for its start")
      ->check(PositiveSeconds());
  AddRepeated(command, "--external", &externals,
              "A solver of your own: KEY=COMMAND, a program that speaks the protocol of "
              "solvers/peers/protocol/protocol.h; may be repeated");
  AddRepeated(command, "--variant", &variants,
              "KEY=SOLVER[,NAME=VALUE]...: a solver with other settings under a key of its own; may be repeated");
}

void NamedSolvers::Register() const {
  for (const std::string& external : externals) {
    const auto [key, program] = Divided(external, "--external", "KEY=COMMAND");
    // "$@" hands on the settings.
    RequireProgram(key, program);
    RegisterExternalSolver(key, {"/bin/sh", "-c", "exec " + program + " \"$@\"", "lcpbench"}, start_limit_s);
  }
  RegisterVariants(variants);
}

std::vector<std::string> NamedSolvers::Words() const {
  std::vector<std::string> words = {"--start-limit", std::to_string(start_limit_s)};
  for (const std::string& external : externals) words.insert(words.end(), {"--external", external});
  for (const std::string& variant : variants) words.insert(words.end(), {"--variant", variant});
  return words;
}

void RegisterVariants(const std::vector<std::string>& variants) {
  for (const std::string& variant : variants) {
    const auto [key, rest] = Divided(variant, "--variant", "KEY=SOLVER[,NAME=VALUE]...");
    std::vector<std::string> pairs = CLI::detail::split(rest, ',');
    const std::string base = pairs.front();
    pairs.erase(pairs.begin());
    RegisterSolverVariant(key, base, ParseSettings(pairs));
  }
}

}  // namespace lcpbench
