// The part of Panels that explains: tooltips, and the list of all keys.
#include <imgui.h>

#include <algorithm>

#include "apps/view/panels.hpp"

namespace palpate {

void Panels::help(const std::string& text) const {
  if (!helps_ || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const ImVec2 display = ImGui::GetIO().DisplaySize, padding = ImGui::GetStyle().WindowPadding;
  const float gap = em(kMargin_em), left = ImGui::GetWindowPos().x - gap,
              right = ImGui::GetWindowPos().x + ImGui::GetWindowWidth() + gap;
  const float wrap = std::min(em(24), display.x - 2 * (gap + padding.x));
  const ImVec2 inner = ImGui::CalcTextSize(text.c_str(), nullptr, false, wrap);
  const float width = inner.x + 2 * padding.x, height = inner.y + 2 * padding.y;
  const bool fitsBeside = display.x - right >= width || left >= width;
  const float x = display.x - right >= width ? right
                  : left >= width            ? left - width
                                             : std::max(0.0f, std::min(ImGui::GetItemRectMin().x, display.x - width));
  const float below = ImGui::GetItemRectMax().y + gap, above = ImGui::GetItemRectMin().y - gap - height;
  const float y = fitsBeside ? std::min(ImGui::GetItemRectMin().y, display.y - height)
                             : (below + height <= display.y ? below : above);
  ImGui::SetNextWindowPos({x, y});
  ImGui::BeginTooltip();
  ImGui::PushTextWrapPos(padding.x + wrap);
  ImGui::TextUnformatted(text.c_str());
  ImGui::PopTextWrapPos();
  ImGui::EndTooltip();
}

void Panels::drawHelp(ViewSettings& view) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  const float width = std::min(em(39), display.x - em(1));
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, display.y - em(1)});
  ImGui::SetNextWindowBgAlpha(1);
  ImGui::Begin("Help", &view.help, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
  static constexpr std::array<std::pair<const char*, const char*>, 24> kRows{
      {{"hold Space", "the mouse is the stylus: move over the model"},
       {"Space + left button", "press into the model, and sculpt with a brush"},
       {"Space + wheel", "deeper, or less deep"},
       {"T", "keep the stylus without holding Space"},
       {"left drag", "rotate the view about the point under the cursor"},
       {"middle drag, Shift + left", "move the view"},
       {"wheel", "zoom to the cursor"},
       {"double click", "look at the point under the cursor"},
       {"R;  X  Y  Z", "reset the view;  look along an axis (Shift: from behind)"},
       {"Ctrl+1 to Ctrl+7", "look at the front, back, left, right, top, bottom, or isometric"},
       {"1 to 8", "feel, push, carve, inflate, smooth, grab, paint, flatten"},
       {"[  ]", "smaller, larger brush"},
       {"Ctrl+Z,  Ctrl+Shift+Z", "undo, redo"},
       {"Ctrl+S, Ctrl+Shift+S, Ctrl+O", "save;  to another file;  open a file"},
       {"Backspace", "forces off, and on again"},
       {"M", "triangles (marching cubes), or points"},
       {"D,  F", "measure between two positions,  cameras on and off"},
       {"Ctrl+C", "copy the picked positions, with all their digits"},
       {"K,  .", "pause or continue a depth camera;  next frame"},
       {"K,  N", "pause or continue water or sand;  restart it"},
       {"P,  C", "picture of the model to a file,  curves on and off"},
       {"Tab", "panels on and off"},
       {"Esc", "close a list, an error or help;  put the stylus away;  end measuring"},
       {"H,  Q", "this help,  quit"}}};
  if (ImGui::BeginTable("keys", 2)) {
    ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch);
    for (const auto& [keys, what] : kRows) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(keys);
      ImGui::TableNextColumn();
      ImGui::TextWrapped("%s", what);
    }
    ImGui::EndTable();
  }
  ImGui::TextWrapped(
      "Gamepad: left stick moves, right stick or triggers change the depth, A holds the stylus, B releases it.");
  ImGui::TextWrapped("3D mouse: its cap moves the model; after the first button it moves the stylus.");
  ImGui::End();
}

}  // namespace palpate
