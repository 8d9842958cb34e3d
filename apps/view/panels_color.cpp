// The part of Panels about what the points are coloured by, and its legend beside the model.
#include <imgui.h>

#include <algorithm>
#include <cmath>

#include "apps/view/panels.hpp"
#include "engine/cloud/las_classes.hpp"
#include "engine/core/counted.hpp"

namespace palpate {

namespace {

ImU32 colorOf(const Vec3& color, float opacity = 1) { return ImGui::GetColorU32({color.x, color.y, color.z, opacity}); }

}  // namespace

void Panels::drawColor(const ViewStatus& status, WindowSettings& settings) {
  if (!header("Colours")) return;
  ColorConfig& color = settings.view.color;
  std::vector<std::pair<std::string_view, std::string>> names{
      {"colour", "rgb"}, {"material", "material"}, {"normal", "normal"}, {"depth", "depth"}, {"height", "height"}};
  for (const std::string& name : status.fields)
    if (!valueNamed(kColorNames, name)) names.emplace_back(name, name);
  if (choose("colour by", names, color.by)) {
    color.range = "auto";
    colorRange_ = {};
    if (color.by == kClassification || color.map == ColorMap::classes) color.map.reset();
  }
  help("material: without the colours of the file, as the material in Look is by itself");
  if (color.by == "rgb" || color.by == "material" || color.by == "normal") return;
  choose("map", kColorMapChoices, color.map);
  if (color.source() && color.map == ColorMap::classes) color.map.reset();
  if (status.field) drawField(*status.field, color);
}

void Panels::drawField(const ColoredField& field, ColorConfig& color) {
  drawHistogram(field, color);
  const std::pair<double, double> range = field.range(color);
  const float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
  ImGui::PushItemWidth(2 * width);
  const std::string now = field.text(range.first) + ',' + field.text(range.second);
  const bool isEntered = this->field(now.c_str(), colorRange_, "range");
  ImGui::PopItemWidth();
  help("LOW,HIGH: the numbers at the ends of the colours, or percentiles, as 2%,98%");
  if (post(isEntered && colorRange_[0], SetColorRange{colorRange_.data()})) colorRange_ = {};
  ImGui::SameLine();
  if (button("Auto##range", width)) color.range = "auto";
  help("from the 2nd to the 98th percentile; of classes all");
  const FieldStatistics& all = field.statistics();
  ImGui::TextDisabled(
      "%s%s", counted(all.count, "number").c_str(),
      field.missing() > 0 ? fmt::format(", {} without", counted(field.missing(), "point")).c_str() : "");
  if (all.count > 0) {
    const auto row = [](const std::string& text) { ImGui::TextDisabled("%s", text.c_str()); };
    row(fmt::format("{} to {}", field.text(all.min), field.text(all.max)));
    row(fmt::format("mean {}, median {}", field.meanText(), field.text(all.percentiles[3])));
    row(fmt::format("standard deviation {:.4g}", all.deviation));
  }
  const ImGuiIO& io = ImGui::GetIO();
  post(button("Select range"), SelectWhere{.condition = {}, .adds = io.KeyShift, .removes = io.KeyCtrl});
  help("selects the points in the range. Shift adds, Ctrl removes, both keep what is in both");
  ImGui::SameLine();
  ImGui::TextUnformatted(counted(field.countIn(range), "point").c_str());
}

// Bars in the colours of the numbers. The mouse drags the nearer end of the range.
void Panels::drawHistogram(const ColoredField& field, ColorConfig& color) {
  const std::vector<float>& counts = field.histogram();
  if (counts.empty()) return;
  const float width = ImGui::GetContentRegionAvail().x, height = em(4);
  const ImVec2 from = ImGui::GetCursorScreenPos();
  ImGui::InvisibleButton("histogram", {width, height});
  noted("histogram", false);
  help("drag an end of the range; the bars show the numbers of the shown points");
  const auto ends = field.extent();
  const double first = ends.first, last = ends.second;
  const double extent = std::max(last - first, 1e-300);
  auto [low, high] = field.range(color);
  const auto shareOf = [&](double number) {
    return static_cast<float>(std::clamp((number - first) / extent, 0.0, 1.0));
  };
  if (ImGui::IsItemActivated()) {
    const double at = double{(ImGui::GetIO().MousePos.x - from.x) / width};
    dragsLow_ = std::abs(at - double{shareOf(low)}) < std::abs(at - double{shareOf(high)});
  }
  if (ImGui::IsItemActive()) {
    const double share = std::clamp(double{(ImGui::GetIO().MousePos.x - from.x) / width}, 0.0, 1.0);
    const double exact = first + share * extent, at = field.isWhole() ? std::round(exact) : exact;
    (dragsLow_ ? low : high) = dragsLow_ ? std::min(at, high) : std::max(at, low);
    color.range = field.text(low) + ',' + field.text(high);
  }
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(from, {from.x + width, from.y + height}, ImGui::GetColorU32(ImGuiCol_FrameBg));
  const float most = *std::ranges::max_element(counts), piece = width / static_cast<float>(counts.size());
  for (std::size_t k = 0; k < counts.size(); ++k) {
    const double middle = first + (static_cast<double>(k) + 0.5) / static_cast<double>(counts.size()) * extent;
    const bool isIn = middle >= low && middle <= high;
    const Vec3 shown = shared::numberColor(static_cast<std::uint32_t>(color.mapOf()), static_cast<float>(middle),
                                           static_cast<float>(low), static_cast<float>(high));
    // Few points beside many would be lost on a linear scale.
    const float share = counts[k] > 0 ? std::max(0.02f, std::sqrt(counts[k] / most)) : 0;
    const float left = from.x + piece * static_cast<float>(k);
    list.AddRectFilled({left, from.y + height * (1 - 0.92f * share)},
                       {left + std::max(1.0f, piece - 1), from.y + height}, colorOf(shown, isIn ? 1.0f : 0.3f));
  }
  for (const double end : {low, high}) {
    const float x = from.x + width * shareOf(end);
    list.AddLine({x, from.y}, {x, from.y + height}, ImGui::GetColorU32(ImGuiCol_Text), em(0.12));
  }
}

// At the right edge, above the scale.
void Panels::drawLegend(const Legend& legend) {
  const float line = ImGui::GetTextLineHeight(), step = 1.25f * line;
  const float width = em(1), right = static_cast<float>(free_px_.y) - em(1.5), left = right - width,
              foot = bottom_px_ - em(4.5);
  const float entries = step * static_cast<float>(legend.entries.size());
  const bool isRamp = !legend.marks.empty();
  const float bottom = foot - entries - (isRamp && entries > 0 ? 0.5f * line : 0);
  const float top = isRamp ? std::max(em(2), bottom - em(12)) : bottom;
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  // A plate under it all, so that it is read over any model.
  const auto widthOf = [](const std::string& text) { return ImGui::CalcTextSize(text.c_str()).x; };
  float widest = widthOf(legend.heading) - em(1);
  for (const Legend::Mark& mark : legend.marks) widest = std::max(widest, widthOf(mark.text));
  for (const Legend::Entry& entry : legend.entries) widest = std::max(widest, widthOf(entry.text));
  list.AddRectFilled({left - widest - em(1), top - 1.8f * line}, {right + em(0.5), foot + 0.7f * line},
                     ImGui::GetColorU32(ImGuiCol_WindowBg, 0.75f), em(0.3));
  constexpr int kPieces = 48;
  for (int k = 0; isRamp && k < kPieces; ++k) {
    const Vec3 color =
        shared::rampColor(static_cast<std::uint32_t>(legend.map), (static_cast<float>(k) + 0.5f) / kPieces);
    const float y = std::round(glm::mix(bottom, top, static_cast<float>(k) / kPieces));
    const float end = std::round(glm::mix(bottom, top, static_cast<float>(k + 1) / kPieces));
    list.AddRectFilled({left, end}, {right, y}, colorOf(color));
  }
  const ImU32 ink = ImGui::GetColorU32(ImGuiCol_Text);
  const auto write = [&](const std::string& text, float x, float y) {
    const float begin = std::round(x - widthOf(text));
    list.AddText({begin, std::round(y)}, ink, text.c_str());
    corner_px_ = glm::min(corner_px_, DVec2(begin, y));
  };
  for (const Legend::Mark& mark : legend.marks) {
    const float y = glm::mix(bottom, top, static_cast<float>(mark.share));
    list.AddLine({left - em(0.3), y}, {left, y}, ink);
    write(mark.text, left - em(0.5), y - 0.5f * line);
  }
  float at = foot - entries;
  for (const Legend::Entry& entry : legend.entries) {
    list.AddRectFilled({left, at + 0.12f * line}, {right, at + 0.88f * line}, colorOf(entry.color));
    write(entry.text, left - em(0.5), at);
    at += step;
  }
  write(legend.heading, right, top - 1.5f * line);
}

}  // namespace palpate
