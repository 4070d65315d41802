#include "benchmarks/collection/each_line.h"

#include <cstddef>
#include <iostream>
#include <set>

#include "solvers/io/gzip_file.h"
#include "support/exit_status.h"
#include "support/input_error.h"
#include "support/json_field.h"
#include "support/printable.h"

namespace lcpbench {
namespace {

void Tell(const std::string& text) { std::cerr << "lcpbench: " << Printable(text) << std::endl; }

// What is refused of one file.
class Refusals {
 public:
  void Add(const std::string& text, const std::string& where) {
    constexpr std::size_t kMostTold = 10;
    const std::string reason = text.starts_with(where) ? text.substr(where.size()) : text;
    if (reasons_.size() < kMostTold && reasons_.insert(reason).second) return Tell(text);
    ++untold_;
  }
  void Close(const std::string& path) const {
    if (untold_ > 0) Tell((path == "-" ? "<stdin>" : path) + ": and " + std::to_string(untold_) + " more");
  }

 private:
  std::set<std::string> reasons_;
  int untold_ = 0;
};

}  // namespace

int TellRefusal(const std::function<void()>& act) {
  try {
    act();
    return 0;
  } catch (const InputError& error) {
    Tell(error.what());
    return kMisuse;
  }
}

int ForEachLine(const std::vector<std::string>& files,
                const std::function<void(const std::string& line, const std::string& where)>& handle) {
  int status = 0;
  for (const std::string& path : files) {
    Refusals refusals;
    bool is_first = true;
    status |= TellRefusal([&] {
      ReadEachLine(path, [&](const std::string& line, const std::string& where) {
        try {
          handle(line, where);
        } catch (const NotJsonError& error) {
          if (is_first) throw InputError(error.what() + std::string("; expected JSON lines, an object on each"));
          refusals.Add(error.what(), where);
          status |= kMisuse;
        } catch (const InputError& error) {
          refusals.Add(error.what(), where);
          status |= kMisuse;
        }
        is_first = false;
      });
    });
    refusals.Close(path);
  }
  return status;
}

}  // namespace lcpbench
