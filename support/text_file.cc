#include "support/text_file.h"

#include <iostream>
#include <iterator>

#include "support/input_error.h"

namespace lcpbench {

std::string ReadTextFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw InputError(path + ": cannot be opened for reading");
  return {std::istreambuf_iterator<char>(file), {}};
}

void WriteTextFile(const std::string& path, const std::string& text) { TextOutput(path).Write(text); }

TextOutput::TextOutput(const std::string& path) : name_(path == "-" ? "standard output" : path) {
  if (path != "-") file_.open(path, std::ios::binary);
  if (!file_) throw InputError(path + ": cannot be written");
}

std::ostream& TextOutput::stream() { return file_.is_open() ? file_ : std::cout; }

void TextOutput::Write(const std::string& text) {
  if (!(stream() << text << std::flush)) throw InputError(name_ + ": cannot be written");
}

}  // namespace lcpbench
