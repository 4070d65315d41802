#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <istream>
#include <string>
#include <string_view>

namespace lcpbench {

/// The words of a text file and their lines, for readers of formats that are words with spaces between them. Every
/// refusal is an InputError `name:line: expected ..., found ...`. Memory: one line.
class TextWords {
 public:
  /// @param input  not owned; must outlive this
  /// @param name   of the file, for error texts
  TextWords(std::istream& input, std::string name);

  /// Goes to the next line. @returns false at the end of the file
  bool NextLine();
  /// The next line that is neither blank nor begins with `comment`.
  bool NextData(char comment);
  /// The next word of this line, "" at its end.
  std::string_view Word();

  /// Word() as a number. @throws InputError for a word that is not a number, or outside the range
  std::int64_t Integer(std::int64_t least, std::int64_t most, const std::string& what);
  /// Word() as a finite number. @throws InputError for any other word
  double Number();
  /// @throws InputError where Word() is another one; "" for the end of the line
  void Expect(std::string_view expected);

  /// This line as a whole.
  const std::string& Line() const { return line_; }
  /// @throws InputError on this line
  [[noreturn]] void Reject(const std::string& expected, std::string_view found) const;
  /// @throws InputError: the file ends where `expected` should be
  [[noreturn]] void RejectEnd(const std::string& expected) const;

 private:
  std::string Place() const;

  std::istream& input_;
  std::string name_;
  std::string line_;
  std::string_view rest_;
  std::size_t number_ = 0;
};

/// 17 significant digits: reading gives the same bits.
std::string RoundTripDigits(double value);

/// Writes a new file, as TextOrGzipOutput does, with its errors
void WriteFile(const std::string& path, const std::function<void(std::ostream&)>& write);

}  // namespace lcpbench
