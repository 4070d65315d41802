#include "support/printable.h"

#include <array>
#include <cstdint>

namespace lcpbench {
namespace {

// Bytes of the character that `text` begins with; 0 where it is not UTF-8 or cannot be printed.
std::size_t PrintableBytes(std::string_view text) {
  const auto byte = [text](std::size_t k) { return static_cast<std::uint8_t>(text[k]); };
  struct Length {
    std::uint8_t mask, lead;  // of the first byte
    std::uint32_t least;      // shorter forms exist below
  };
  constexpr std::array<Length, 4> kLengths = {
      {{0x80, 0x00, 0x20}, {0xe0, 0xc0, 0x80}, {0xf0, 0xe0, 0x800}, {0xf8, 0xf0, 0x10000}}};
  for (std::size_t bytes = 1; bytes <= kLengths.size() && bytes <= text.size(); ++bytes) {
    const Length& length = kLengths[bytes - 1];
    if ((byte(0) & length.mask) != length.lead) continue;
    std::uint32_t code = byte(0) & static_cast<std::uint8_t>(~length.mask);
    for (std::size_t k = 1; k < bytes; ++k) {
      if ((byte(k) & 0xc0U) != 0x80) return 0;
      code = code << 6U | (byte(k) & 0x3fU);
    }
    const bool is_control = (0x7f <= code && code < 0xa0) || code == 0x2028 || code == 0x2029;
    const bool is_character = length.least <= code && code <= 0x10ffff && (code < 0xd800 || code > 0xdfff);
    return is_character && !is_control ? bytes : 0;
  }
  return 0;
}

}  // namespace

std::string Printable(std::string_view text) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string shown;
  while (!text.empty()) {
    std::size_t bytes = PrintableBytes(text);
    if (bytes > 0) {
      shown += text.substr(0, bytes);
    } else {
      bytes = 1;
      const auto byte = static_cast<std::uint8_t>(text[0]);
      if (byte == '\n' || byte == '\t' || byte == '\r') {
        shown += byte == '\n' ? "\\n" : byte == '\t' ? "\\t" : "\\r";
      } else {
        shown += {'\\', 'x', kDigits[byte >> 4U], kDigits[byte & 0xfU]};
      }
    }
    text.remove_prefix(bytes);
  }
  return shown;
}

std::string Excerpt(std::string_view text, std::size_t longest) {
  return Printable(text.substr(0, longest)) + (text.size() > longest ? "..." : "");
}

}  // namespace lcpbench
