#include "benchmarks/measure/text_table.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "support/number_text.h"

namespace lcpbench {
namespace {

// Columns, not bytes: µ has two of those.
std::string Padded(const std::string& text, size_t width) {
  const auto columns = static_cast<size_t>(std::count_if(
      text.begin(), text.end(), [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }));
  return columns < width ? text + std::string(width - columns, ' ') : text;
}

}  // namespace

std::string TimeText(double seconds) {
  if (!std::isfinite(seconds)) return "-";
  for (const auto& [unit, name] : {std::pair{1e-9, " ns"}, {1e-6, " µs"}, {1e-3, " ms"}}) {
    if (seconds < 999.5 * unit) return FormatNumber(seconds / unit, "%.3g") + name;
  }
  return FormatNumber(seconds, "%.3g") + " s";
}

std::string FormatTable(const std::vector<std::vector<std::string>>& rows) {
  std::vector<size_t> widths;
  for (const auto& row : rows) {
    widths.resize(std::max(widths.size(), row.size()));
    for (size_t k = 0; k < row.size(); ++k) widths[k] = std::max(widths[k], row[k].size());
  }
  std::string text;
  for (const auto& row : rows) {
    std::string line = " ";
    for (size_t k = 0; k < row.size(); ++k) line += " " + (k + 1 < row.size() ? Padded(row[k], widths[k] + 1) : row[k]);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + "\n";
  }
  return text;
}

}  // namespace lcpbench
