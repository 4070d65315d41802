#include "support/append_only_file.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>

#include "support/clock.h"
#include "support/input_error.h"
#include "support/json_field.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

using Json = nlohmann::ordered_json;

// Some disks take longer for one than most solves do.
constexpr double kSecondsBetweenSynchronisations = 2;

}  // namespace

std::uintmax_t ReadJsonLines(const std::string& path, const std::string& expected,
                             const std::function<void(const nlohmann::json& line, const std::string& text)>& take) {
  std::ifstream lines(path);
  if (!lines) throw InputError(path + ": cannot be opened for reading");
  std::uintmax_t bytes = 0;
  std::size_t number = 0;
  for (std::string line; std::getline(lines, line) && !lines.eof();) {
    const std::string where = path + ":" + std::to_string(++number);
    const nlohmann::json json = ParseJsonObject(line, where);
    try {
      take(json, line);
    } catch (const nlohmann::json::exception&) {
      throw InputError(where + ": expected " + expected + ", found another line");
    } catch (const InputError& error) {
      // Of what the file says, so much as a line of a terminal takes.
      constexpr std::size_t kLongest = 200;
      const std::string found = Printable(error.what());
      throw InputError(where + ": expected " + expected + ", found " + found.substr(0, kLongest));
    }
    bytes += line.size() + 1;
  }
  return bytes;
}

AppendOnlyFile::AppendOnlyFile(const std::string& path, const std::string& expected,
                               const std::function<void(const nlohmann::json& line)>& take)
    : path_(path) {
  std::uintmax_t whole = 0;
  if (std::filesystem::exists(path)) {
    whole = ReadJsonLines(path, expected, [&take](const nlohmann::json& line, const std::string&) { take(line); });
  }
  std::error_code error;
  if (std::filesystem::exists(path) && std::filesystem::file_size(path) > whole) {
    std::filesystem::resize_file(path, whole, error);
  }
  file_ = open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (file_ < 0 || error) throw InputError(path + ": cannot be written: " + std::strerror(errno));
}

AppendOnlyFile::~AppendOnlyFile() {
  if (file_ >= 0) close(file_);
}

void AppendOnlyFile::Append(const std::vector<Json>& lines) {
  std::string text;
  for (const Json& line : lines) text += line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
  // One call: what a killed campaign leaves is whole lines, and at most a torn one at the end.
  const off_t before = lseek(file_, 0, SEEK_END);
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = write(file_, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) {
      const std::string reason = count < 0 ? std::strerror(errno) : "nothing was written";
      // Where that fails, too, the torn line is cut off when the file is opened again.
      const bool is_cut = written == 0 || before < 0 || ftruncate(file_, before) == 0;
      throw InputError(path_ + ": writing failed: " + reason + (is_cut ? "" : ", its last line is torn"));
    }
    written += static_cast<std::size_t>(count);
  }
  const double now = SteadyNow();
  if (now - synchronised_ >= kSecondsBetweenSynchronisations) {
    fdatasync(file_);
    synchronised_ = now;
  }
}

}  // namespace lcpbench
