#include "support/csv.h"

#include <cerrno>
#include <stdexcept>

#include "support/input_error.h"
#include "support/number_text.h"
#include "support/output_error.h"

namespace lcpbench {
namespace {

std::string Quoted(const std::string& cell) {
  if (cell.find_first_of(",\"\n\r") == std::string::npos) return cell;
  std::string quoted = "\"";
  for (const char c : cell) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

}  // namespace

CsvWriter::CsvWriter(const std::string& path, const std::vector<std::string>& columns)
    : path_(path), file_(path), columns_(columns.size()) {
  if (!file_) throw InputError(path + ": cannot be opened for writing");
  Row(columns);
}

void CsvWriter::Row(const std::vector<std::string>& cells) {
  if (cells.size() != columns_) throw std::logic_error("CsvWriter: a row must have as many cells as columns");
  for (std::size_t i = 0; i < cells.size(); ++i) file_ << (i == 0 ? "" : ",") << Quoted(cells[i]);
  errno = 0;
  file_ << '\n' << std::flush;
  if (!file_) throw OutputError(path_, errno != 0 ? errno : EIO);
}

std::string CsvWriter::Cell(double value) { return NumberText(value); }

}  // namespace lcpbench
