#include "benchmarks/collection/input_files.h"

#include <iostream>

#include "benchmarks/collection/gzip_file.h"
#include "support/exit_status.h"
#include "support/input_error.h"

namespace lcpbench {

void ReadEachLine(const std::string& path,
                  const std::function<void(const std::string& line, const std::string& where)>& handle) {
  LineReader reader(path);
  std::string line;
  bool any = false;
  while (reader.Next(&line)) {
    if (line.find_first_not_of(" \t\r") == std::string::npos) continue;
    any = true;
    handle(line, reader.name() + ":" + std::to_string(reader.number()));
  }
  if (!any) throw InputError(reader.name() + ": is empty, expected JSON lines");
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
