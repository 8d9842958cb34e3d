// The part of Panels that shows messages: remarks at the bottom, errors at the top.
#include <imgui.h>

#include <algorithm>
#include <span>

#include "apps/view/held_device.hpp"
#include "apps/view/panels.hpp"
#include "engine/cloud/length_text.hpp"

namespace palpate {

namespace {

std::string measureLine(const ViewStatus& status) {
  const MeasuredDistance* const distance = status.measure->chosen();
  if (!distance) return "measure: click two positions on the model (Esc ends it)";
  return fmt::format("measured: {}", lengthText(distance->length(), status.unit));
}

std::string hintFor(const WindowSettings& settings) {
  if (settings.tool == WindowTool::sculpt) return "hold Space to touch,  H for help";
  if (settings.tool == WindowTool::look) return "drag to look around, arrows walk,  H for help";
  switch (settings.select.shape) {
    case SelectShape::flood:
    case SelectShape::same:
      return "click the model to select what is alike,  F1 for help";
    case SelectShape::label:
      return "draw over points to label them,  F1 for help";
    case SelectShape::lock:
      return "draw over points to lock them, with Ctrl to free them,  F1 for help";
    case SelectShape::box:
    case SelectShape::ball:
    case SelectShape::plane:
      return "click the model, drag the handles, Enter selects,  F1 for help";
    case SelectShape::move:
      return "drag the handles to move the selected points,  F1 for help";
    default:
      return "draw around points to select them,  F1 for help";
  }
}

// The number of newest texts whose lines fit into that height, at least one.
std::size_t countThatFits(std::span<const std::string> texts, float wrap, float height) {
  std::size_t count = 0;
  for (float used = 0; count < texts.size(); ++count) {
    used += ImGui::CalcTextSize(texts[texts.size() - 1 - count].c_str(), nullptr, false, wrap).y;
    if (count > 0) used += ImGui::GetStyle().ItemSpacing.y;
    if (count > 0 && used > height) break;
  }
  return count;
}

}  // namespace

// Notes the letters of all names and texts that may be in any script.
void Panels::noteLetters(const ViewStatus& status) {
  for (const std::span<const std::string> texts :
       {std::span<const std::string>(status.remarks), status.errors, status.models, status.recent, status.gone})
    for (const std::string& text : texts) gui_.noteLetters(text);
  for (const std::string& text : {status.model, status.saveFile, status.loadingWhat}) gui_.noteLetters(text);
  if (const OpenedDevice* const opened = status.held->opened()) gui_.noteLetters(opened->facts.model);
  for (const auto& field : {open_, saveAs_, log_, trueLength_}) gui_.noteLetters(field.data());
  if (status.saveQuestion)
    for (const std::string& text : {status.saveQuestion->loses, status.saveQuestion->beside, status.saveQuestion->kept})
      gui_.noteLetters(text);
  if (status.picked)
    for (const auto& [name, value] : status.picked->attributes) gui_.noteLetters(name);
  if (status.others) {
    for (const SeenHand& hand : status.others->hands) gui_.noteLetters(hand.name);
    for (const SeenCamera& camera : status.others->cameras) gui_.noteLetters(camera.name);
  }
  if (!files_) return;
  for (const auto& field : {files_->name, files_->folder}) gui_.noteLetters(field.data());
  for (const FileBrowser::Entry& entry : files_->browser.entries()) gui_.noteLetters(entry.name);
}

// Beside the scale and the heights, or above them in a narrow window.
void Panels::drawMessages(const ViewStatus& status, const WindowSettings& settings) {
  const ViewSettings& view = settings.view;
  std::vector<std::string> lines = status.remarks;
  if (const DeviceCheckQuery* const test = status.held->test())
    lines.insert(lines.begin(), std::string(instructionOf(test->stage())));
  else if (status.held->device())
    lines.insert(lines.begin(), status.held->opened()->facts.model + ": button 1 sculpts, button 2 is the clutch");
  else if (status.stylus)
    lines.insert(lines.begin(), status.pressed_N ? fmt::format("stylus: pressed, {:.1f} N", *status.pressed_N)
                                                 : "stylus: press with the left button");
  if (view.measures && status.session) lines.insert(lines.begin(), measureLine(status));
  if (!view.panels && status.loading)
    lines.push_back(status.loadingWhat +
                    (*status.loading == ViewStatus::kUnknown ? "" : fmt::format(", {:.0f} %", 100 * *status.loading)) +
                    (status.isStoppable ? " (Esc cancels)" : ""));
  lines.insert(lines.end(), status.notices.begin(), status.notices.end());
  if (!status.blocked.empty()) lines.push_back(status.blocked);
  if (lines.empty() && status.session) lines.push_back(hintFor(settings) + (view.panels ? "" : ",  Tab for panels"));
  if (lines.empty()) return;
  const auto left = static_cast<float>(free_px_.x), end = static_cast<float>(free_px_.y);
  const auto corner = ImVec2(static_cast<float>(corner_px_.x), static_cast<float>(corner_px_.y));
  const bool fitsBeside = corner.x - left >= em(kMessages_em);
  const float right = fitsBeside ? corner.x - em(kMargin_em) : end;
  const float bottom = fitsBeside ? bottom_px_ - em(0.8) : corner.y - em(kMargin_em);
  ImGui::SetNextWindowPos({0.5f * (left + right), bottom}, ImGuiCond_Always, {0.5f, 1});
  ImGui::Begin("messages", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
  const float padding = ImGui::GetStyle().WindowPadding.x;
  const float room = right - left - 2 * (em(kMargin_em) + padding);
  const float wrap = std::max(em(8), fitsBeside ? std::min(room, 0.7f * (end - left)) : room);
  const double share = std::min(kMaxRemarks, kMaxCover - messagesShare_);
  drawTexts(lines, wrap, static_cast<float>(share * modelArea_px2()));
  ImGui::End();
}

// The newest ones, in an area of that size with the padding of the window.
std::size_t Panels::drawTexts(std::span<const std::string> texts, float wrap, float area_px2, float below) {
  const ImVec2 padding = ImGui::GetStyle().WindowPadding;
  const float height = std::max(ImGui::GetTextLineHeight(), area_px2 / (wrap + 2 * padding.x) - 2 * padding.y - below);
  const std::size_t shown = countThatFits(texts, wrap, height);
  ImGui::PushTextWrapPos(padding.x + wrap);
  for (const std::string& text : texts.last(shown)) {
    const std::string begin = shown > 1 ? text : shortenedLines(text, wrap, height);
    ImGui::TextUnformatted(begin.c_str());
    if (begin == text || !ImGui::IsMouseHoveringRect(ImGui::GetItemRectMin(), ImGui::GetItemRectMax(), false)) continue;
    ImGui::BeginTooltip();
    ImGui::PushTextWrapPos(em(24));
    ImGui::TextUnformatted(text.c_str());
    ImGui::PopTextWrapPos();
    ImGui::EndTooltip();
  }
  ImGui::PopTextWrapPos();
  const ImVec2 size = ImGui::GetWindowSize();
  messagesShare_ += double{size.x} * double{size.y} / modelArea_px2();
  return shown;
}

// White on red, in the area that no panel covers, until the user closes them.
void Panels::drawErrors(const ViewStatus& status) {
  if (status.errors.empty()) return;
  const auto left = static_cast<float>(free_px_.x), right = static_cast<float>(free_px_.y);
  ImGui::SetNextWindowPos({0.5f * (left + right), em(kMargin_em)}, ImGuiCond_Always, {0.5f, 0});
  ImGui::PushStyleColor(ImGuiCol_WindowBg, ink(Tone::alarm));
  ImGui::PushStyleColor(ImGuiCol_Text, ink(Tone::alarmText));
  ImGui::PushStyleColor(ImGuiCol_Button, ink(Tone::alarmButton));
  ImGui::Begin("errors", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
  const float wrap = std::clamp(0.8f * (right - left), em(6), em(32));
  const float buttons = ImGui::GetFrameHeight() + ImGui::GetStyle().ItemSpacing.y;
  const std::size_t shown = drawTexts(status.errors, wrap, static_cast<float>(kMaxErrors * modelArea_px2()), buttons);
  post(button("Close"), WindowCommand::closeErrors);
  ImGui::SameLine();
  const std::size_t earlier = status.errors.size() - shown;
  const std::string before = earlier == 0 ? "(Esc)" : fmt::format("(Esc), and {} before", earlier);
  ImGui::TextUnformatted(
      shortened(before, wrap - ImGui::GetItemRectSize().x - ImGui::GetStyle().ItemSpacing.x).c_str());
  ImGui::End();
  ImGui::PopStyleColor(3);
}

}  // namespace palpate
