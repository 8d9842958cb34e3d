// The part of Panels that cleans the model: the steps of a preparation, each alone.
#include <imgui.h>

#include <algorithm>

#include "apps/view/panels.hpp"
#include "haptics/session/settings.hpp"

namespace palpate {

namespace {

/// A button, and its settings in the table; the first one has the help.
struct CleanRow {
  const char* button;
  std::array<std::string_view, 2> settings;
};
constexpr CleanRow kSelecting[]{{"Duplicates", {"drop_duplicates"}},
                                {"Outliers", {"outlier_neighbours", "outlier_sigma"}},
                                {"Sparse", {"radius_neighbours", "radius_mm"}},
                                {"Subsample", {"subsample_mm"}},
                                {"Random", {"random"}}};
constexpr CleanRow kChanging[]{{"Fill holes", {"fill_holes_mm"}}, {"Level", {"level"}}, {"Upright", {"upright"}}};
constexpr std::array<std::pair<const char*, NormalSource>, 3> kNormals{
    {{"Estimate", NormalSource::estimate}, {"Orient", NormalSource::orient}, {"Flip", NormalSource::flip}}};

// Without what a help for the command line adds, such as that lengths are in mm.
std::string shownHelp(std::string_view help) {
  help = help.substr(0, help.find(';'));
  if (help.ends_with(", mm")) help.remove_suffix(4);
  return std::string(help);
}

}  // namespace

void Panels::drawClean(const ViewStatus& status, CleanSettings& clean) {
  if (!header("Clean")) return;
  const ImGuiIO& io = ImGui::GetIO();
  float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
  for (const CleanRow& row : kSelecting)
    width = std::max(width, ImGui::CalcTextSize(row.button).x + 2 * ImGui::GetStyle().FramePadding.x);
  const auto draw = [&](const CleanRow& row, const std::string& effect) {
    CleanModel command{.step = {}, .adds = io.KeyShift, .removes = io.KeyCtrl};
    if (button(row.button, width)) {
      for (const std::string_view name : row.settings)
        if (!name.empty()) copySetting<Preparation>(settingNamed<Preparation>(name), clean, command.step);
      command.step.dropDuplicates = row.settings[0] == "drop_duplicates";
      command.step.level = row.settings[0] == "level";
      post(true, command);
    }
    help(shownHelp(settingNamed<Preparation>(row.settings[0]).help) + effect);
    const float indent = ImGui::GetStyle().WindowPadding.x + width + ImGui::GetStyle().ItemSpacing.x;
    for (std::size_t k = 0; k < row.settings.size() && !row.settings[k].empty(); ++k) {
      if (k > 0) ImGui::NewLine();
      drawCleanNumber(status, clean, row.settings[k], indent);
    }
  };
  ImGui::BeginDisabled(status.loading.has_value());
  for (const CleanRow& row : kSelecting) draw(row, ". Selects the others. Shift adds, Ctrl removes");
  for (const CleanRow& row : kChanging) draw(row, "");
  ImGui::TextUnformatted("normals");
  for (std::size_t k = 0; k < kNormals.size(); ++k) {
    post(flowing(kNormals[k].first, k == 0), CleanModel{.step = {}, .normals = kNormals[k].second});
    help("of the selected points, or of all if none is selected");
  }
  ImGui::EndDisabled();
}

// The field of a setting, beside the button or below the one before.
void Panels::drawCleanNumber(const ViewStatus& status, CleanSettings& clean, std::string_view name, float indent) {
  const Setting<Preparation>& setting = settingNamed<Preparation>(name);
  const std::string label = "##" + std::string(name);
  const std::string what(name.find('_') == std::string_view::npos ? "points" : name.substr(name.rfind('_') + 1));
  Preparation& values = clean;
  withValue(setting, values, [&](auto& value) {
    using Value = std::remove_cvref_t<decltype(value)>;
    if constexpr (std::is_same_v<Value, bool>) return;
    ImGui::SameLine(indent);
    ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x);
    constexpr double kLargest_mm = 50;
    if constexpr (std::is_same_v<Value, double>) {
      if (setting.unit == "mm")
        dragLength(label.c_str(), value, 0.02, {0.01, kLargest_mm}, status);
      else
        drag(label.c_str(), value, 0.01f, setting.range, ("%.2f " + what).c_str());
    } else if constexpr (std::is_same_v<Value, std::size_t>) {
      const std::size_t low = 1, high = static_cast<std::size_t>(setting.range.max);
      noted(label, ImGui::DragScalar(label.c_str(), ImGuiDataType_U64, &value, 0.1f, &low, &high,
                                     ("%llu " + what).c_str(), ImGuiSliderFlags_AlwaysClamp));
    } else if constexpr (std::is_same_v<Value, WordMember<Preparation>>) {
      choose(label.c_str(), kUpAxes, *clean.upright);
    }
    ImGui::PopItemWidth();
    help(shownHelp(setting.help));
  });
}

}  // namespace palpate
