#include "support/printable.h"

#include "tests/support/test.h"

namespace lcpbench {
namespace {

TEST(Printable, ControlCharactersAndWhatIsNoUtf8AreEscaped) {
  const std::pair<std::string, std::string> kCases[] = {
      {"", ""},
      {"disc-pile ~ \"x\" \\", "disc-pile ~ \"x\" \\"},
      {"Ärger ρ € 😀", "Ärger ρ € 😀"},
      {"\x1b[31mred\x1b[0m", "\\x1b[31mred\\x1b[0m"},
      {"a\nb\tc\rd\x07", "a\\nb\\tc\\rd\\x07"},
      {std::string("\0x", 2), "\\x00x"},
      {"\x7f", "\\x7f"},
      {"\xc2\x9b", "\\xc2\\x9b"},                   // CSI in one character
      {"\xe2\x80\xa8", "\\xe2\\x80\\xa8"},          // a line separator
      {"\xff\xc3", "\\xff\\xc3"},                   // no UTF-8, and its beginning alone
      {"\xc0\x8a", "\\xc0\\x8a"},                   // a newline in two bytes
      {"\xed\xa0\x80", "\\xed\\xa0\\x80"},          // half a surrogate pair
      {"\xf4\x90\x80\x80", "\\xf4\\x90\\x80\\x80"}  // beyond Unicode
  };
  for (const auto& [text, shown] : kCases) EXPECT_EQ(Printable(text), shown);
  EXPECT_EQ(Excerpt("a\n", 2), "a\\n");
  EXPECT_EQ(Excerpt("a\nb", 2), "a\\n...");
}

}  // namespace
}  // namespace lcpbench
