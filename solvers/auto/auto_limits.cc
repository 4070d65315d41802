#include "solvers/auto/auto_limits.h"

#include <algorithm>

#include "support/number_text.h"

namespace lcpbench {

std::string WithDefaults(std::string_view words) {
  std::string text;
  while (true) {
    const std::size_t open = words.find('{');
    text += words.substr(0, open);
    if (open == std::string_view::npos) return text;
    const std::size_t close = words.find('}', open);
    const auto* const limit =
        std::ranges::find(kAutoLimits, words.substr(open + 1, close - open - 1), &AutoLimit::name);
    text += NumberText(limit->Of(kDefaultLimits));
    words.remove_prefix(close + 1);
  }
}

std::string AutoLimitsAsMarkdown() {
  std::string text = "| limit | default | from | to | unit | meaning |\n| --- | ---: | ---: | ---: | --- | --- |\n";
  for (const AutoLimit& limit : kAutoLimits) {
    text.append("| `").append(limit.name).append("` | ").append(NumberText(limit.Of(kDefaultLimits)));
    text.append(" | ").append(NumberText(limit.least)).append(" | ").append(NumberText(limit.most));
    text.append(" | ").append(limit.unit).append(" | ").append(limit.meaning).append(" |\n");
  }
  return text;
}

}  // namespace lcpbench
