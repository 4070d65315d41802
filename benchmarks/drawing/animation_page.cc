#include "benchmarks/drawing/animation_page.h"

#include <map>
#include <string_view>

#include "animation_template.h"
#include "benchmarks/drawing/animation_data.h"
#include "benchmarks/drawing/svg_text.h"

namespace lcpbench {
namespace {

/// Replaces every {{name}} once; what is put in is not searched again.
std::string Fill(std::string_view text, const std::map<std::string, std::string, std::less<>>& values) {
  std::string filled;
  while (true) {
    const std::size_t begin = text.find("{{");
    const std::size_t end = begin == std::string_view::npos ? begin : text.find("}}", begin);
    if (end == std::string_view::npos) return filled.append(text);
    filled.append(text.substr(0, begin));
    filled.append(values.find(text.substr(begin + 2, end - begin - 2))->second);
    text.remove_prefix(end + 2);
  }
}

/// As the text of a script element, which "</script" would end.
std::string ScriptText(const nlohmann::ordered_json& json) {
  std::string text;
  for (const char c : json.dump()) {
    if (c == '<') {
      text += "\\u003c";
    } else {
      text += c;
    }
  }
  return text;
}

}  // namespace

std::string RenderAnimationPage(const Animation& animation) {
  const AnimationData data = PackAnimation(animation);
  return Fill(kAnimationPage, {{"title", Escape(animation.world.name)},
                               {"style", kAnimationStyle},
                               {"scene", ScriptText(data.scene)},
                               {"frames", data.frames},
                               {"script", std::string(kAnimationData) + kAnimationDrawing + kAnimationPlot +
                                              kAnimationPlayer + kAnimationSelftest}});
}

}  // namespace lcpbench
