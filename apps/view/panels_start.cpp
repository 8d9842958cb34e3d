// The part of Panels for the beginning: what to try and the last files without a model, and the first steps.
#include <imgui.h>

#include <algorithm>

#include "apps/view/icons.hpp"
#include "apps/view/panels.hpp"
#include "apps/view/theme.hpp"
#include "apps/view/thumbnails.hpp"
#include "engine/io/cloud_formats.hpp"

namespace palpate {

namespace {

// A picture as rectangles, one for each run of equal pixels: the panels have no other texture than their font.
void drawPicture(ImDrawList& list, const ColorImage& image, const ImVec2& corner, const ImVec2& size) {
  const float across = size.x / static_cast<float>(image.width), down = size.y / static_cast<float>(image.height);
  for (std::uint32_t y = 0; y < image.height; ++y) {
    const auto* const row = image.rgb.data() + std::size_t{y} * image.width;
    const float top = corner.y + down * static_cast<float>(y);
    for (std::uint32_t x = 0, end = 0; x < image.width; x = end) {
      for (end = x + 1; end < image.width && row[end] == row[x];) ++end;
      list.AddRectFilled({corner.x + across * static_cast<float>(x), top},
                         {corner.x + across * static_cast<float>(end), top + down},
                         IM_COL32(row[x][0], row[x][1], row[x][2], 255));
    }
  }
}

}  // namespace

// A button with a picture above its name.
bool Panels::card(const char* name, float width, float picture, const std::function<void(const DVec2&, float)>& draw) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float line = ImGui::GetTextLineHeight(), pad = em(0.4), height = picture + line + 3 * pad;
  const bool isPressed = noted(name, ImGui::InvisibleButton(name, {width, height}));
  ImDrawList& list = *ImGui::GetWindowDrawList();
  list.AddRectFilled(at, {at.x + width, at.y + height},
                     ink(ImGui::IsItemHovered() ? Tone::buttonHovered : Tone::button), em(0.4));
  draw({at.x, at.y + pad}, picture);
  const float text = ImGui::CalcTextSize(name).x;
  ImGui::PushClipRect({at.x + pad, at.y}, {at.x + width - pad, at.y + height}, true);
  list.AddText({std::round(at.x + std::max(pad, 0.5f * (width - text))), std::round(at.y + height - pad - line)},
               ink(Tone::text), name);
  ImGui::PopClipRect();
  return isPressed;
}

void Panels::drawStart(const ViewStatus& status, ViewSettings& view) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  const float width = std::min(em(44), display.x - em(1));
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, display.y - em(1)});
  ImGui::Begin("start", nullptr,
               ImGuiWindowFlags_NoTitleBar | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
  if (button("Browse...")) browse(FileTask::open);
  help("Ctrl+O");
  ImGui::SameLine();
  ImGui::TextUnformatted("or drop a file here");
  help(cloudFormats().namesRead());
  const float gap = ImGui::GetStyle().ItemSpacing.x;
  const float inner = ImGui::GetContentRegionAvail().x, third = (inner - 2 * gap) / 3;
  ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(ink(Tone::faint)), "Three things to try");
  struct Example {
    const char* name;
    std::string_view drawn;
    TryExample what;
    const char* text;
  };
  static constexpr std::array<Example, 3> kExamples{
      {{"Press a ball", icon::kFeel, TryExample::press, "feel it with the mouse, or with a device"},
       {"Carve a sculpture", icon::kOfBrushes[1], TryExample::carve, "cut hollows; Ctrl+Z takes them back"},
       {"Measure a ring", icon::kMeasure, TryExample::measure, "click two positions: their distance is shown"}}};
  for (const Example& each : kExamples) {
    if (&each != kExamples.data()) ImGui::SameLine();
    const auto draw = [&](const DVec2& at, float side) {
      drawIcon(*ImGui::GetWindowDrawList(), each.drawn,
               {static_cast<float>(at.x) + 0.5f * (third - side), static_cast<float>(at.y)}, side, ink(Tone::mark));
    };
    post(card(each.name, third, em(2.6), draw), each.what);
    help(each.text);
  }
  drawLastFiles(status);
  if (button("First steps")) view.firstSteps = true;
  ImGui::End();
}

void Panels::drawLastFiles(const ViewStatus& status) {
  std::vector<std::string> files(status.models.begin(), status.models.end());
  for (const std::string& file : status.recent)
    if (std::ranges::find(files, file) == files.end()) files.push_back(file);
  if (files.empty() && status.gone.empty()) return;
  ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(ink(Tone::faint)), "Last files");
  const float gap = ImGui::GetStyle().ItemSpacing.x, room = ImGui::GetContentRegionAvail().x;
  const int inRow = std::max(1, static_cast<int>((room + gap) / (em(10) + gap)));
  const float width = (room - gap * static_cast<float>(inRow - 1)) / static_cast<float>(inRow);
  int number = 0;
  for (const std::string& file : files) {
    if (number++ % inRow != 0) ImGui::SameLine();
    ImGui::PushID(file.c_str());
    const auto draw = [&](const DVec2& at, float side) {
      const ColorImage* const image = thumbnails_.of(file);
      const float across = side * static_cast<float>(Thumbnails::kWidth) / static_cast<float>(Thumbnails::kHeight);
      const ImVec2 corner(std::round(static_cast<float>(at.x) + 0.5f * (width - across)),
                          std::round(static_cast<float>(at.y)));
      if (image)
        drawPicture(*ImGui::GetWindowDrawList(), *image, corner, {across, side});
      else
        drawIcon(*ImGui::GetWindowDrawList(), icon::kOfShapes[7],
                 {static_cast<float>(at.x) + 0.5f * width - 0.25f * side, corner.y + 0.25f * side}, 0.5f * side,
                 ink(Tone::faint));
    };
    post(card(std::filesystem::path(file).filename().string().c_str(), width, em(5.4), draw),
         FileCommand{FileTask::open, file});
    help(file);
    ImGui::PopID();
  }
  for (const std::string& file : status.gone) {
    ImGui::TextDisabled("%s is missing", std::filesystem::path(file).filename().string().c_str());
    help(file + " no longer exists");
  }
}

// What the mouse does, in three pictures.
void Panels::drawFirstSteps(ViewSettings& view) {
  struct Step {
    const char* key;
    int button;  // of the mouse: left, wheel, or none
    const char* text;
  };
  static constexpr std::array<Step, 3> kSteps{
      {{"", 0, "Drag to rotate the view; turn the wheel to come nearer."},
       {"Space", -1, "Hold Space: the mouse is a stylus in front of the model."},
       {"Space", 0,
        "Press the left button, too: it touches. With a brush (keys 2 to 8) it "
        "sculpts."}}};
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const float width = std::min(em(36), display.x - em(1));
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, display.y - em(1)});
  ImGui::Begin("First steps", &view.firstSteps,
               ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoCollapse);
  if (ImGui::BeginTable("steps", 3, ImGuiTableFlags_SizingStretchSame)) {
    for (const Step& step : kSteps) {
      ImGui::TableNextColumn();
      const ImVec2 at = ImGui::GetCursorScreenPos();
      const float room = ImGui::GetContentRegionAvail().x, side = em(5), middle = at.x + 0.5f * room;
      ImDrawList& list = *ImGui::GetWindowDrawList();
      const float unit = side / 16, left = middle - 0.5f * side + (step.key[0] ? em(2.2) : 0);
      if (step.button == 0)
        list.AddRectFilled({left + 4.3f * unit, at.y + 2.8f * unit}, {left + 8 * unit, at.y + 7 * unit},
                           ink(Tone::accent), unit);
      drawIcon(list, icon::kMouse, {left, at.y}, side, ink(Tone::text));
      list.AddLine({left + 8 * unit, at.y + 2 * unit}, {left + 8 * unit, at.y + 7 * unit}, ink(Tone::text), em(0.1));
      if (step.key[0]) {
        const ImVec2 text = ImGui::CalcTextSize(step.key);
        const ImVec2 from(middle - em(4.6), at.y + 0.5f * side - text.y),
            to(from.x + text.x + em(1.2), from.y + 2 * text.y);
        list.AddRectFilled(from, to, ink(Tone::chosen), em(0.3));
        list.AddText({std::round(from.x + em(0.6)), std::round(from.y + 0.5f * text.y)}, ink(Tone::text), step.key);
      }
      ImGui::Dummy({1, side});
      ImGui::TextWrapped("%s", step.text);
    }
    ImGui::EndTable();
  }
  if (button("Understood")) view.firstSteps = false;
  ImGui::SameLine();
  ImGui::TextColored(ImGui::ColorConvertU32ToFloat4(ink(Tone::faint)), "Help (F1) shows this again.");
  ImGui::End();
}

}  // namespace palpate
