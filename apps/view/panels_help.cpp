// The part of Panels that explains: tooltips, and the list of all keys.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>

#include "apps/view/help_search.hpp"
#include "apps/view/panels.hpp"

namespace palpate {

std::string Panels::shortenedTo(const std::string& text, const std::function<bool(const std::string&)>& fits) {
  if (fits(text)) return text;
  constexpr ImWchar kEllipsis = 0x2026;
  const char* const end = ImGui::GetFont()->FindGlyphNoFallback(kEllipsis) ? "\u2026" : "...";
  const auto startsLetter = [&](std::size_t at) { return (static_cast<unsigned char>(text[at]) & 0xc0U) != 0x80U; };
  std::size_t low = 0, high = text.size();  // of bytes that fit, and that do not
  while (low + 1 < high) {
    const std::size_t middle = (low + high) / 2;
    std::size_t cut = middle;
    while (cut > 0 && !startsLetter(cut)) --cut;
    (fits(text.substr(0, cut) + end) ? low : high) = middle;
  }
  while (low > 0 && !startsLetter(low)) --low;
  return text.substr(0, low) + end;
}

std::string Panels::shortened(const std::string& text, float width) const {
  return shortenedTo(
      text, [&](const std::string& shown) { return ImGui::CalcTextSize(shown.c_str()).x <= width + kRounding_px; });
}

std::string Panels::shortenedLines(const std::string& text, float wrap, float height) const {
  return shortenedTo(text, [&](const std::string& shown) {
    return ImGui::CalcTextSize(shown.c_str(), nullptr, false, wrap).y <= height + kRounding_px;
  });
}

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

// Keys, commands and settings; typed words filter them, and Enter or a click does what is chosen.
void Panels::drawHelp(WindowSettings& settings) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const DVec2 size(std::min(em(44), display.x - em(1)), std::min(em(36), display.y - em(1)));
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSize({static_cast<float>(size.x), static_cast<float>(size.y)});
  bool& isOpen = settings.view.help;
  ImGui::Begin("Help", &isOpen, ImGuiWindowFlags_NoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse);
  const auto pressed = [](int key, bool repeats = false) { return ImGui::IsKeyPressed(key, repeats); };
  if (ImGui::IsWindowAppearing()) {
    searched_ = {};
    found_ = 0;
    ImGui::SetKeyboardFocusHere();
  } else if (pressed(GLFW_KEY_ESCAPE) || pressed(GLFW_KEY_F1)) {
    isOpen = false;
  }
  ImGui::PushItemWidth(-em(7));
  if (ImGui::InputTextWithHint("##search", "search: type a word", searched_.data(), searched_.size())) found_ = 0;
  noted("search", false);
  ImGui::PopItemWidth();
  ImGui::SameLine();
  if (button("First steps")) settings.view.firstSteps = true, isOpen = false;
  const std::vector<HelpEntry> entries = helpFor(settings.tool, searched_.data());
  const auto count = static_cast<std::size_t>(std::ranges::count_if(entries, &HelpEntry::isCommand));
  if (pressed(GLFW_KEY_DOWN, true) && found_ + 1 < count) ++found_;
  if (pressed(GLFW_KEY_UP, true) && found_ > 0) --found_;
  const bool isEntered = pressed(GLFW_KEY_ENTER) || pressed(GLFW_KEY_KP_ENTER);
  ImGui::BeginChild("entries");
  if (entries.empty()) ImGui::TextDisabled("nothing has this word");
  std::size_t number = 0;
  for (const HelpEntry& entry : entries) {
    const bool isFound = searched_[0] && entry.isCommand() && number == found_;
    if (entry.isCommand()) ++number;
    if (drawHelpEntry(entry, isFound) || (isFound && isEntered)) {
      isOpen = false;
      carryOut(entry, settings);
    }
  }
  ImGui::EndChild();
  ImGui::End();
}

// Returns whether it was clicked.
bool Panels::drawHelpEntry(const HelpEntry& entry, bool isFound) {
  const float column = em(13.5);
  const float wrap = ImGui::GetContentRegionMax().x - em(0.5);
  const float height = ImGui::CalcTextSize(entry.effect.c_str(), nullptr, false, wrap - column).y;
  const ImVec2 at = ImGui::GetCursorPos();
  ImGui::PushID(&entry);
  bool isClicked = false;
  if (entry.isCommand())
    isClicked = noted(entry.effect, ImGui::Selectable("##entry", isFound, 0, {0, height}));
  else
    ImGui::Dummy({1, height});
  if (isFound && !ImGui::IsItemVisible()) ImGui::SetScrollHereY();
  const ImVec2 after = ImGui::GetCursorPos();
  ImGui::PopID();
  ImGui::SetCursorPos(at);
  ImGui::PushTextWrapPos(column - em(0.5));
  ImGui::PushStyleColor(ImGuiCol_Text, ink(entry.isCommand() ? Tone::mark : Tone::faint));
  ImGui::TextUnformatted(entry.keys.c_str());
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
  ImGui::SetCursorPos({column, at.y});
  ImGui::PushTextWrapPos(wrap);
  ImGui::TextUnformatted(entry.effect.c_str());
  ImGui::PopTextWrapPos();
  ImGui::SetCursorPos({at.x, std::max(after.y, ImGui::GetCursorPosY())});
  return isClicked;
}

void Panels::carryOut(const HelpEntry& entry, WindowSettings& settings) {
  if (!entry.section.empty()) {
    settings.view.panels = true;
    settings.view.opens = entry.section;
  }
  if (entry.tool) settings.tool = *entry.tool;
  for (const KeyAction& action : entry.actions) {
    if (const auto* command = std::get_if<ViewCommand>(&action)) commands_.push_back(*command);
    if (const auto* set = std::get_if<std::function<void(WindowSettings&)>>(&action)) (*set)(settings);
  }
}

}  // namespace palpate
