// The part of Panels beside the main panel: curves, other participants, scale, and the questions.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>
#include <imgui.h>

#include <algorithm>
#include <cctype>
#include <chrono>
#include <cmath>

#include "apps/view/panels.hpp"
#include "apps/view/shown_lines.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/core/counted.hpp"

namespace palpate {

namespace {

constexpr std::size_t kCurve = 300;         // values in a plot
constexpr std::size_t kTicksPerValue = 10;  // ticks per value, which is their maximum

// "5 minutes ago".
std::string ago(std::filesystem::file_time_type then) {
  const auto past = std::filesystem::file_time_type::clock::now() - then;
  long long count = std::max(0ll, static_cast<long long>(std::chrono::floor<std::chrono::minutes>(past).count()));
  const char* unit = "minute";
  for (const auto& [many, next] : {std::pair{60, "hour"}, {24, "day"}}) {
    if (count < many) break;
    count /= many;
    unit = next;
  }
  if (count == 0) return "just now";
  return counted(count, unit) + " ago";
}

// "2 strokes and the undoing of 1 saved stroke".
std::string textOf(const StrokesSince& since) {
  if (since == StrokesSince()) return "selected or hidden points";  // of a saved file, which cannot have them
  if (since.undone == 0) return counted(since.made, "stroke");
  return (since.made > 0 ? counted(since.made, "stroke") + " and " : "") + "the undoing of " +
         counted(since.undone, "saved stroke");
}

// The last ticks, reduced to kCurve values.
std::vector<float> curveOf(const std::deque<TraceRow>& rows, auto&& value) {
  std::vector<float> curve;
  const std::size_t count = std::min(rows.size(), kCurve * kTicksPerValue);
  const std::size_t from = rows.size() - count;
  for (std::size_t i = from; i < rows.size(); i += kTicksPerValue) {
    float largest = 0;
    for (std::size_t k = i; k < std::min(i + kTicksPerValue, rows.size()); ++k)
      largest = std::max(largest, static_cast<float>(value(rows[k])));
    curve.push_back(largest);
  }
  return curve;
}

}  // namespace

// The label is drawn above the curve.
void Panels::plot(const char* what, const std::vector<float>& curve, float least, float height,
                  const std::string& span) const {
  const float largest = curve.empty() ? 0.0f : *std::ranges::max_element(curve);
  const float inner = height - 2 * ImGui::GetStyle().FramePadding.y;
  const float top = std::max(least, largest) * inner / (inner - ImGui::GetFontSize() - em(0.15));
  const float last = curve.empty() ? 0.0f : curve.back();
  const std::string label =
      fmt::format("{}   {}", what, last < 100 ? fmt::format("{:.3g}", last) : fmt::format("{:.0f}", last));
  ImGui::PlotLines("##curve", curve.data(), static_cast<int>(curve.size()), 0, label.c_str(), 0, top,
                   {ImGui::GetContentRegionAvail().x, height});
  help(fmt::format("0 to {:.3g} at most; the last {}", largest, span));
}

void Panels::drawPlots(const ViewStatus& status, ViewSettings& view) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x - em(kPanel_em + 2 * kMargin_em), em(kMargin_em)}, ImGuiCond_Always, {1, 0});
  ImGui::SetNextWindowSize({em(kCurves_em), 0});
  ImGui::Begin("Curves", &view.plots, ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
  const RecentTicks& history = status.session->recentTicks();
  const auto& [perMm, unit] = status.lengths;
  if (!paused_)
    curves_ = {curveOf(history.rows(), [](const TraceRow& row) { return glm::length(row.force_N); }),
               curveOf(history.rows(), [&](const TraceRow& row) { return status.lengths.perMm * row.penetration_mm; }),
               curveOf(history.rows(), [](const TraceRow& row) { return row.step_us; }),
               {status.pictures_ms->begin(), status.pictures_ms->end()}};
  const float height = em(3.4);
  const auto curve = [&](const char* what, const std::vector<float>& values, float least, const std::string& span) {
    ImGui::PushID(what);
    plot(what, values, least, height, span);
    ImGui::PopID();
  };
  const std::string ticks = fmt::format("{} ticks", kCurve * kTicksPerValue);
  curve("force, N", curves_.force_N, 1, ticks);
  curve(fmt::format("penetration, {}", unit).c_str(), curves_.penetration, static_cast<float>(perMm), ticks);
  curve("tick, us", curves_.step_us, 100, ticks);
  curve("frame, ms", curves_.picture_ms, 16, fmt::format("{} frames", curves_.picture_ms.size()));
  ImGui::Text("haptic loop: on time %.3g %%", history.onTime_percent());
  help(fmt::format(
      "{} of {} ticks were late, and left out; a tick took {:.0f} us (p50), {:.0f} us at most but for one "
      "in a thousand (p99.9)",
      history.missed(), history.ticks(), history.step_us().quantile_us(0.5), history.step_us().quantile_us(0.999)));
  ImGui::Text("%s per second", counted(std::lround(status.fps), "frame").c_str());
  ImGui::TextDisabled("%s", status.gpu.c_str());
  drawLink();
  if (noted("GPU passes, us", ImGui::TreeNode("GPU passes, us"))) {
    for (const PassRecord& pass : status.passes)
      if (pass.gpu_us > 0) ImGui::Text("%-24.24s %8.0f", pass.name.c_str(), pass.gpu_us);
    ImGui::TreePop();
  }
  if (button(paused_ ? "Continue" : "Pause")) paused_ = !paused_;
  ImGui::SameLine();
  post(button("Export CSV"), ModelCommand::exportTicks);
  help("writes the last minute of ticks to a file");
  ImGui::End();
}

// Curves of the link of a shared session.
void Panels::drawLink() {
  if (link_.age_ms().empty()) return;
  if (!noted("link", ImGui::TreeNodeEx("link", ImGuiTreeNodeFlags_DefaultOpen))) return;
  const std::string span = fmt::format("{:.0f} s", LinkHistory::kApart_s * static_cast<double>(LinkHistory::kKept));
  const auto curve = [&](const char* what, const std::vector<float>& values, float least, const char* words) {
    ImGui::PushID(what);
    plot(what, values, least, em(2.4), fmt::format("{}: {}", span, words));
    ImGui::PopID();
  };
  curve("round trip, ms", link_.roundTrip_ms(), 10, "median of the last pings to the server");
  curve("lost, %", link_.lost_percent(), 5, "of the last pings, in either direction");
  curve("age of the data, ms", link_.age_ms(), 1000,
        "since the last received message was sent; the force fades beyond 1 s plus 2.5 round trips");
  ImGui::TreePop();
}

// At the lower right, where there is no panel.
void Panels::drawOthers(const ViewStatus& status) {
  if (!status.others || !header("Others", true)) return;
  const auto& [given, hands, cameras] = *status.others;
  const auto line = [this](std::uint32_t number, const std::string& name, const std::string& does) {
    const auto color = colorOfHand(number);
    const ImVec2 at = ImGui::GetCursorScreenPos();
    ImGui::GetWindowDrawList()->AddCircleFilled({at.x + em(0.4), at.y + 0.5f * ImGui::GetTextLineHeight()}, em(0.35),
                                                IM_COL32(color[0], color[1], color[2], 255));
    ImGui::SetCursorPosX(ImGui::GetCursorPosX() + em(1.1));
    ImGui::TextUnformatted(name.c_str());
    ImGui::SameLine();
    ImGui::TextDisabled("%s", does.c_str());
  };
  for (const SeenHand& hand : hands) {
    std::string does = hand.place.touching ? (hand.place.sculpts ? "sculpts" : "touches") : "";
    if (std::ranges::count(cameras, hand.number, &SeenCamera::number) > 0) does += does.empty() ? "looks" : ", looks";
    line(hand.number, hand.name, does);
  }
  for (const SeenCamera& camera : cameras)
    if (std::ranges::count(hands, camera.number, &SeenHand::number) == 0) line(camera.number, camera.name, "looks");
  if (hands.empty() && cameras.empty()) ImGui::TextDisabled("no other participants");
  if (!given) return;
  const SharedCounts& counts = *given;
  if (counts.silent_s > 1) ImGui::Text("no message for %.0f s", counts.silent_s);
  if (counts.force < 1) ImGui::Text("force reduced to %.0f %%", 100 * counts.force);
  if (counts.link.roundTrip_ms)
    ImGui::TextDisabled("round trip %.1f ms, %.0f %% lost", *counts.link.roundTrip_ms,
                        counts.link.lost_percent.value_or(0));
}

void Panels::drawScale(const ViewStatus::ScaleBar& bar, LengthUnit unit) {
  const std::string text = lengthText(bar.length, unit);
  const ImVec2 size = ImGui::CalcTextSize(text.c_str());
  const ImU32 color = ImGui::GetColorU32(ImGuiCol_Text);
  const float width = static_cast<float>(bar.width_px), right = static_cast<float>(free_px_.y) - em(1.5),
              y = std::round(bottom_px_ - em(1.5));
  const float end = em(0.35), thick = em(0.14);
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddLine({right - width, y}, {right, y}, color, thick);
  for (const float x : {right - width, right}) list.AddLine({x, y - end}, {x, y + end}, color, thick);
  const float top = std::round(y - em(0.4) - size.y);
  list.AddText({std::round(right - 0.5f * (width + size.x)), top}, color, text.c_str());
  corner_px_ = glm::min(corner_px_, DVec2(right - std::max(width, 0.5f * (width + size.x)), top));
}

// Moved if necessary so that no panel covers it.
void Panels::drawDistance(const PictureLabel& label) const {
  const std::string& text = label.text;
  const ImVec2 display = ImGui::GetIO().DisplaySize, size = ImGui::CalcTextSize(text.c_str());
  const float padding = em(0.3);
  const auto within = [](double value, double least, double most) {
    return static_cast<float>(std::round(std::max(least, std::min(value, most))));
  };
  const float x =
      within(label.at_px.x - 0.5 * double{size.x}, free_px_.x + double{padding}, free_px_.y - double{size.x + padding});
  const float y = within(label.at_px.y - 0.5 * double{size.y}, double{padding}, double{display.y - size.y - padding});
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  list.AddRectFilled({x - padding, y - padding}, {x + size.x + padding, y + size.y + padding},
                     ImGui::GetColorU32(ImGuiCol_WindowBg), padding);
  list.AddText({x, y}, ImGui::GetColorU32(ImGuiCol_Text), text.c_str());
}

void Panels::drawLabels(const std::vector<PictureLabel>& labels) const {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const float padding = em(0.2);
  LabelRoom room;
  room.reserve(corner_px_ - double{em(0.6)}, {free_px_.y, double{bottom_px_}});  // legend and scale
  for (const PictureLabel& label : labels) {
    const ImVec2 size = ImGui::CalcTextSize(label.text.c_str());
    const float x = std::round(static_cast<float>(label.at_px.x) - 0.5f * size.x),
                y = std::round(static_cast<float>(label.at_px.y) - 0.5f * size.y);
    const ImVec2 low(x - padding, y), high(x + size.x + padding, y + size.y);
    if (!room.admits(label, {low.x, low.y}, {high.x, high.y})) continue;
    list.AddRectFilled(low, high, ImGui::GetColorU32(ImGuiCol_WindowBg, 0.75f), padding);
    list.AddText({x, y}, ImGui::GetColorU32(ImGuiCol_Text), label.text.c_str());
  }
}

void Panels::drawBrushHint(const BrushHint& hint) const {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  std::vector<ImVec2> ring;
  for (const DVec2& corner : hint.ring_px)
    ring.emplace_back(static_cast<float>(corner.x), static_cast<float>(corner.y));
  for (const auto& [color, thick] :
       {std::pair{IM_COL32(0, 0, 0, 140), em(0.2)}, {IM_COL32(255, 190, 80, 255), em(0.08)}})
    if (!ring.empty()) list.AddPolyline(ring.data(), static_cast<int>(ring.size()), color, ImDrawFlags_Closed, thick);
  if (hint.words.empty()) return;
  const ImVec2 display = ImGui::GetIO().DisplaySize, size = ImGui::CalcTextSize(hint.words.c_str());
  const float padding = em(0.3), beside = em(1.4);
  const float x = std::clamp(static_cast<float>(hint.place_px.x) + beside, padding,
                             std::max(padding, display.x - size.x - padding));
  const float y = std::clamp(static_cast<float>(hint.place_px.y) + beside, padding,
                             std::max(padding, display.y - size.y - padding));
  list.AddRectFilled({x - padding, y - padding}, {x + size.x + padding, y + size.y + padding},
                     ImGui::GetColorU32(ImGuiCol_WindowBg), padding);
  list.AddText({x, y}, ImGui::GetColorU32(ImGuiCol_Text), hint.words.c_str());
}

// A letter of the last button's name: its key.
void Panels::underline(const char* name, std::size_t letter) {
  const char* const at = name + letter;
  const ImVec2 from = ImGui::GetItemRectMin(), padding = ImGui::GetStyle().FramePadding;
  const float below = ImGui::GetItemRectMax().y - padding.y,
              left = from.x + padding.x + ImGui::CalcTextSize(name, at).x;
  ImGui::GetWindowDrawList()->AddLine({left, below}, {left + ImGui::CalcTextSize(at, at + 1).x, below},
                                      ImGui::GetColorU32(ImGuiCol_Text));
}

// Pressed by a click, or by the letter, which is underlined and no key of the window.
bool Panels::letterButton(const char* name, char letter) {
  const bool isClicked = button(name);
  underline(name, std::string_view(name).find(letter));
  const bool isTyped = !gui_.wantsKeys() && !ImGui::GetIO().KeyCtrl &&
                       ImGui::IsKeyPressed(std::toupper(static_cast<unsigned char>(letter)), false);
  return isClicked || isTyped;
}

// A question over everything else. `draw` returns whether an answer was chosen.
void Panels::ask(const char* title, bool asks, const std::function<bool()>& draw) {
  if (asks && !ImGui::IsPopupOpen(title)) ImGui::OpenPopup(title);
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  if (!ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove)) return;
  ImGui::PushTextWrapPos(std::min(em(32), 0.8f * display.x));
  const bool isAnswered = asks && draw();
  ImGui::PopTextWrapPos();
  if (isAnswered || !asks) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

// Answered by a click, by Tab or the arrow keys and Enter, by Esc, or by the first letter of an answer, which is
// underlined. The keys that led to the question do not answer it.
bool Panels::answers(std::initializer_list<AnswerButton> buttons) {
  const bool isNew = ImGui::IsWindowAppearing(), mayAnswer = !isNew && !ImGui::GetIO().KeyCtrl;
  const auto pressed = [&](int key) { return mayAnswer && ImGui::IsKeyPressed(key, false); };
  const std::size_t count = buttons.size();
  const bool isBack =
      pressed(GLFW_KEY_LEFT) || pressed(GLFW_KEY_UP) || (pressed(GLFW_KEY_TAB) && ImGui::GetIO().KeyShift);
  const bool isOn = !isBack && (pressed(GLFW_KEY_RIGHT) || pressed(GLFW_KEY_DOWN) || pressed(GLFW_KEY_TAB));
  chosen_ = isNew ? 0 : (chosen_ + (isBack ? count - 1 : isOn ? 1 : 0)) % count;
  const bool isEntered = pressed(GLFW_KEY_ENTER) || pressed(GLFW_KEY_KP_ENTER);
  bool isAnswered = false;
  std::size_t number = 0;
  for (const AnswerButton& each : buttons) {
    if (number > 0) ImGui::SameLine();
    const bool isChosen = number++ == chosen_;
    if (isChosen) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    const bool isClicked = button(each.name);
    if (isChosen) ImGui::PopStyleColor();
    underline(each.name, 0);
    const bool isPressed = (isChosen && isEntered) || (each.isEscape && pressed(GLFW_KEY_ESCAPE)) ||
                           pressed(std::toupper(static_cast<unsigned char>(each.name[0])));
    isAnswered |= !isAnswered && post(isClicked || isPressed, each.answer);
  }
  return isAnswered;
}

void Panels::drawQuestions(const ViewStatus& status) {
  const auto nameOf = [](const std::string& file) { return std::filesystem::path(file).filename().string(); };
  ask("Changes", !status.changesQuestion.empty(), [&] {
    ImGui::TextUnformatted(status.changesQuestion.c_str());
    return answers({{"Save", Answer::saveFirst}, {"Do not save", Answer::discard}, {"Cancel", Answer::cancel, true}});
  });
  ask("How to save", status.saveQuestion.has_value(), [&] {
    ImGui::TextWrapped("%s.", status.saveQuestion->loses.c_str());
    const bool isAnswered =
        answers({{"Save a copy", Answer::saveBeside}, {"Replace", Answer::saveOver}, {"Cancel", Answer::cancel, true}});
    ImGui::TextWrapped("Save a copy: writes %s", nameOf(status.saveQuestion->beside).c_str());
    ImGui::TextWrapped("Replace: overwrites the file; the old one is kept as %s",
                       nameOf(status.saveQuestion->kept).c_str());
    return isAnswered;
  });
  ask("Memory", status.memoryQuestion.has_value(), [&] {
    ImGui::TextWrapped("%s %s. Reading it may make this computer slow, or end palpate.",
                       nameOf(status.memoryQuestion->file.string()).c_str(), status.memoryQuestion->sentence().c_str());
    return answers({{"Do not read it", Answer::cancel, true}, {"Read it", Answer::readAnyway}});
  });
  ask("Strokes", status.leftQuestion.has_value(), [&] {
    const LeftQuestion& question = *status.leftQuestion;
    ImGui::TextWrapped("%s: %s, %s, not saved when the program ended.", nameOf(question.file).c_str(),
                       textOf(question.strokes).c_str(), ago(question.made).c_str());
    if (question.waiting > 0)
      ImGui::TextWrapped("Next: %s of unsaved strokes.", counted(question.waiting, "more set").c_str());
    const bool isAnswered = answers({{"Restore them", Answer::goOnWithLeft},
                                     {"Discard them", Answer::discardLeft},
                                     {"Ask again later", Answer::keepLeft, true}});
    ImGui::TextWrapped("%s", question.file.c_str());
    return isAnswered;
  });
}

}  // namespace palpate
