#include "apps/view/icons.hpp"

#include <imgui.h>

#include <algorithm>
#include <charconv>
#include <vector>

namespace palpate {

void drawIcon(ImDrawList& list, std::string_view icon, const ImVec2& corner, float side, unsigned color) {
  const float unit = side / 16, thick = std::min(1.25f * unit, 0.14f * ImGui::GetFontSize());
  std::vector<ImVec2> line;
  const auto number = [&] {
    icon.remove_prefix(std::min(icon.find_first_of("0123456789"), icon.size()));
    float value = 0;
    icon.remove_prefix(
        static_cast<std::size_t>(std::from_chars(icon.data(), icon.data() + icon.size(), value).ptr - icon.data()));
    return value;
  };
  const auto point = [&] {
    const float x = number();
    return ImVec2(corner.x + unit * x, corner.y + unit * number());
  };
  const auto finish = [&](bool closed) {
    list.AddPolyline(line.data(), static_cast<int>(line.size()), color, closed ? ImDrawFlags_Closed : 0, thick);
  };
  while (!icon.empty()) {
    const char command = icon.front();
    icon.remove_prefix(1);
    if (command == 'M' || command == 'O' || command == 'D') {
      finish(false);
      line.clear();
    }
    if (command == 'M' || command == 'L') line.push_back(point());
    if (command == 'Z') {
      finish(true);
      if (icon.starts_with('F')) list.AddConvexPolyFilled(line.data(), static_cast<int>(line.size()), color);
      line.clear();
    }
    if (command != 'O' && command != 'D') continue;
    const ImVec2 middle = point();
    const float radius = unit * number();
    command == 'O' ? list.AddCircle(middle, radius, color, 0, thick) : list.AddCircleFilled(middle, radius, color);
  }
  finish(false);
}

}  // namespace palpate
