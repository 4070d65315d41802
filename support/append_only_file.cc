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
#include "support/output_error.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

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
      // The most characters of a line that are shown, to fit a terminal.
      constexpr std::size_t kLongest = 200;
      throw InputError(where + ": expected " + expected + ", found " + Excerpt(error.what(), kLongest));
    }
    bytes += line.size() + 1;
  }
  // Else what was not read would be taken for a torn line.
  if (lines.bad()) throw InputError(path + ": reading failed after line " + std::to_string(number));
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
  on_disk_ = static_cast<off_t>(whole);
}

AppendOnlyFile::~AppendOnlyFile() {
  if (file_ >= 0) close(file_);
}

void AppendOnlyFile::Append(const std::vector<nlohmann::ordered_json>& lines) {
  std::string text;
  for (const nlohmann::ordered_json& line : lines)
    text += line.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
  // One call: what a killed campaign leaves is whole lines, and at most a torn one at the end.
  const off_t before = lseek(file_, 0, SEEK_END);
  std::size_t written = 0;
  while (written < text.size()) {
    const ssize_t count = write(file_, text.data() + written, text.size() - written);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) CutAndFail(before, count < 0 ? errno : ENOSPC);
    written += static_cast<std::size_t>(count);
  }
  if (SteadyNow() - synchronised_ >= kSecondsBetweenSynchronisations) Synchronise();
}

void AppendOnlyFile::Synchronise() {
  // A disk that fails here may have forgotten any of it, and would not say so again. EINVAL: it knows no such thing.
  if (fdatasync(file_) != 0 && errno != EINVAL) CutAndFail(on_disk_, errno);
  on_disk_ = lseek(file_, 0, SEEK_END);
  synchronised_ = SteadyNow();
}

// Where that fails, too, a torn line is cut off when the file is opened again.
void AppendOnlyFile::CutAndFail(off_t size, int error) {
  [[maybe_unused]] const bool is_cut = size >= 0 && ftruncate(file_, size) == 0;
  throw OutputError(path_, error);
}

}  // namespace lcpbench
