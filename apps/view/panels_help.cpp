// The part of Panels that explains: tooltips, and the list of all keys.
#include <imgui.h>

#include <algorithm>

#include "apps/view/key_table.hpp"
#include "apps/view/panels.hpp"
#include "engine/core/named_values.hpp"

namespace palpate {

void Panels::help(const std::string& text) const {
  if (!helps_ || !ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const ImVec2 display = ImGui::GetIO().DisplaySize, padding = ImGui::GetStyle().WindowPadding;
  const float gap = em(kMargin_em), left = ImGui::GetWindowPos().x - gap,
              right = ImGui::GetWindowPos().x + ImGui::GetWindowWidth() + gap;
  const float beside = std::max(display.x - right, left) - 2 * padding.x;
  const float wrap = std::min(em(24), beside >= em(9) ? beside : display.x - 2 * (gap + padding.x));
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

void Panels::drawHelp(WindowSettings& settings) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  const float width = std::min(em(39), display.x - em(1));
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, display.y - em(1)});
  ImGui::SetNextWindowBgAlpha(1);
  ImGui::Begin("Help", &settings.view.help, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
  ImGui::TextDisabled("%s", std::string(nameOf(kWindowTools, settings.tool)).c_str());
  if (ImGui::BeginTable("keys", 2)) {
    ImGui::TableSetupColumn("keys", ImGuiTableColumnFlags_WidthFixed);
    ImGui::TableSetupColumn("what", ImGuiTableColumnFlags_WidthStretch);
    for (const KeyRow& row : keyRows()) {
      if (!row.appliesTo(settings.tool)) continue;
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(row.keys.c_str());
      ImGui::TableNextColumn();
      ImGui::TextWrapped("%s", row.effect.c_str());
    }
    ImGui::EndTable();
  }
  ImGui::TextWrapped(
      "Gamepad: left stick moves, right stick or triggers change the depth, A holds the stylus, B releases it.");
  ImGui::TextWrapped("3D mouse: its cap moves the model; after the first button it moves the stylus.");
  ImGui::End();
}

}  // namespace palpate
