#include "benchmarks/collection/input_files.h"

#include <filesystem>
#include <fstream>
#include <iostream>
#include <optional>

#include "benchmarks/collection/gzip_input.h"
#include "support/exit_status.h"
#include "support/input_error.h"

namespace lcpbench {
void ReadEachLine(const std::string& path,
                  const std::function<void(const std::string& line, const std::string& where)>& handle) {
  const bool standard_input = path == "-";
  const std::string name = standard_input ? "<stdin>" : path;
  std::ifstream file;
  if (!standard_input) {
    if (std::filesystem::is_directory(path)) throw InputError(path + ": is a folder, expected a file");
    file.open(path);
    if (!file) throw InputError(path + ": cannot be opened for reading");
  }
  std::istream& source = standard_input ? std::cin : file;
  std::optional<GzipBuffer> gzip;
  if (LooksLikeGzip(source)) gzip.emplace(source);
  std::istream decompressed(gzip ? &*gzip : nullptr);
  std::istream& input = gzip ? decompressed : source;
  std::string line;
  std::size_t number = 0;
  bool any = false;
  while (std::getline(input, line)) {
    // Data that break off within a line: the line is no one's mistake.
    if (input.eof() && gzip && !gzip->error().empty()) break;
    ++number;
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    any = true;
    handle(line, name + ":" + std::to_string(number));
  }
  if (gzip && !gzip->error().empty()) throw InputError(name + ": " + gzip->error());
  if (!any) throw InputError(name + ": is empty, expected JSON lines");
}

int ForEachLine(const std::vector<std::string>& files,
                const std::function<void(const std::string& line, const std::string& where)>& handle) {
  int status = 0;
  const auto tell = [&status](const InputError& error) {
    std::cerr << "lcpbench: " << error.what() << std::endl;
    status = kMisuse;
  };
  for (const std::string& path : files) {
    try {
      ReadEachLine(path, [&](const std::string& line, const std::string& where) {
        try {
          handle(line, where);
        } catch (const InputError& error) {
          tell(error);
        }
      });
    } catch (const InputError& error) {
      tell(error);
    }
  }
  return status;
}

}  // namespace lcpbench
