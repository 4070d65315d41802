#include "support/number_text.h"

#include <array>
#include <charconv>

namespace lcpbench {

std::string NumberText(double value) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), value).ptr};
}

}  // namespace lcpbench
