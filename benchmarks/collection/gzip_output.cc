#include "benchmarks/collection/gzip_output.h"

#include <zlib.h>

#include <algorithm>

#include "support/input_error.h"

namespace lcpbench {

void WriteGzipFile(const std::string& path, const std::string& text) {
  gzFile file = gzopen(path.c_str(), "wb9");
  if (file == nullptr) throw InputError(path + ": cannot be opened for writing");
  constexpr size_t kPortion = size_t{1} << 20U;
  bool good = true;
  for (size_t at = 0; good && at < text.size(); at += kPortion) {
    const auto length = static_cast<unsigned>(std::min(kPortion, text.size() - at));
    good = gzwrite(file, text.data() + at, length) == static_cast<int>(length);
  }
  good = gzclose(file) == Z_OK && good;
  if (!good) throw InputError(path + ": writing failed");
}

}  // namespace lcpbench
