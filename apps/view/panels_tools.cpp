// The part of Panels at the edges of the window: the tools at the left, and the status line.
#include <imgui.h>

#include <algorithm>
#include <functional>

#include "apps/view/icons.hpp"
#include "apps/view/panels.hpp"
#include "apps/view/theme.hpp"
#include "engine/cloud/length_text.hpp"
#include "engine/core/counted.hpp"

namespace palpate {

namespace {

// With its inverse, which Ctrl gives.
std::string whatItDoes(const BrushTraits& brush) {
  return brush.inverse ? fmt::format("{}; with Ctrl: {}", brush.does, traitsOf(*brush.inverse).name)
                       : fmt::format("{}; no inverse: {}", brush.does, brush.withoutInverse);
}

constexpr std::array<std::pair<const char*, const char*>, kSelectShapes.size()> kShapeHelp{
    {{"R", "drag a rectangle"},
     {"L", "drag around the points"},
     {"P", "click the corners; Enter or a right click closes it, Backspace takes the last one back"},
     {"B", "drag a ball along the surface"},
     {"O", "click a point: selects what is connected with it and alike"},
     {"E", "click a point: selects all of its class, or of its colour where there are no classes"},
     {"A", "drag a ball along the surface: the points under it get the value in the panel"},
     {"Shift+B", "drag a ball along the surface: it locks the points under it, with Ctrl it frees them"},
     {"W", "click the model, or drag from there; drag the handles; Enter selects"},
     {"Shift+W", "click the model, or drag from there; drag the handles; Enter selects"},
     {"D", "click the model; drag the handles; Enter selects the side of the arrow"},
     {"G", "moves, rotates and scales the selected points by handles"}}};

}  // namespace

std::vector<Panels::Tool> Panels::toolsOf(const ViewStatus& status, WindowSettings& settings) {
  const bool selects = settings.tool == WindowTool::select, looks = settings.tool == WindowTool::look;
  const auto use = [&settings](WindowTool tool) { return [&settings, tool] { settings.tool = tool; }; };
  std::vector<Tool> tools{
      {"Sculpt", icon::kSculpt, "", "hold Space: the mouse is the stylus (1 to 8 choose what it does)",
       !selects && !looks, use(WindowTool::sculpt)},
      {"Select", icon::kSelect, "S", "the left button selects points", selects, use(WindowTool::select)},
      {"Only look", icon::kLook, "V", "the mouse only moves the view", looks, use(WindowTool::look)},
      {"Ruler", icon::kMeasure, selects ? "" : "D", "the left button picks the two ends of a distance",
       settings.view.measures, [&settings, selects] {
         if (selects) settings.tool = WindowTool::look;
         settings.view.measures = !settings.view.measures;
       }}};
  if (selects) {
    for (std::size_t k = 0; k < kSelectShapes.size(); ++k) {
      const auto& [name, shape] = kSelectShapes[k];
      const bool draws = shape != SelectShape::label && shape != SelectShape::lock && shape != SelectShape::move;
      tools.push_back(
          {name.data(), icon::kOfShapes[k], kShapeHelp[k].first,
           kShapeHelp[k].second + std::string(draws ? ". Shift adds, Ctrl removes, both keep what is in both" : ""),
           settings.select.shape == shape, [&settings, chosen = shape] { settings.select.shape = chosen; }});
    }
  } else if (looks) {
    const auto posts = [this](const ViewCommand& command) { return [this, command] { commands_.push_back(command); }; };
    tools.push_back({"Reset view", icon::kReset, "R", "shows the whole model", false, posts(WindowCommand::resetView)});
    for (const auto& [name, drawn, axis] :
         {std::tuple{"X", icon::kAxisX, 0}, {"Y", icon::kAxisY, 1}, {"Z", icon::kAxisZ, 2}})
      tools.push_back({name, drawn, "", "looks along this axis (the key of this letter; with Shift from behind)", false,
                       posts(LookAlong{axis, ImGui::GetIO().KeyShift})});
    tools.push_back({"Without perspective", icon::kOrthographic, "Ctrl+8", "lengths can be compared wherever they are",
                     settings.view.orthographic,
                     [&settings] { settings.view.orthographic = !settings.view.orthographic; }});
    tools.push_back({"Picture", icon::kPicture, "P", "writes a picture of the model, without panels, to a file", false,
                     posts(WindowCommand::screenshot)});
  } else {
    tools.push_back({"feel", icon::kFeel, "1", "touches the surface and leaves it as it is", !settings.brush.sculpts,
                     [&settings] { settings.brush.sculpts = false; }});
    for (std::size_t k = 0; k < kBrushes.size(); ++k) {
      const BrushTraits& each = kBrushes[k];
      tools.push_back({each.name.data(), icon::kOfBrushes[k], std::to_string(k + 2), whatItDoes(each),
                       settings.brush.sculpts && status.brush.kind.value_or(settings.brush.kind) == each.kind,
                       [&settings, kind = each.kind] {
                         settings.brush.kind = kind;
                         settings.brush.sculpts = true;
                       }});
    }
  }
  return tools;
}

// What the mouse does, and below the line the tools for that.
void Panels::drawTools(const ViewStatus& status, WindowSettings& settings) {
  constexpr std::size_t kModes = 4;
  const std::vector<Tool> tools = toolsOf(status, settings);
  const float gap = em(0.15), width = em(kTools_em - 2 * kEdge_em), room = bottom_px_ - 2 * em(kEdge_em);
  const float line = em(0.5), rows = static_cast<float>(tools.size());
  const float side = std::clamp((room - line - 2 * gap) / rows - gap, em(1.1), em(2.2));
  ImGui::SetNextWindowPos({em(kEdge_em), em(kEdge_em)});
  ImGui::SetNextWindowSize({width, std::min(room, rows * (side + gap) + line + gap)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {gap, gap});
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, gap});
  ImGui::Begin("tools", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav);
  for (std::size_t k = 0; k < tools.size(); ++k) {
    if (k == kModes) {
      const ImVec2 at = ImGui::GetCursorScreenPos();
      ImGui::GetWindowDrawList()->AddLine({at.x + 2 * gap, at.y + 0.5f * line - gap},
                                          {at.x + width - 4 * gap, at.y + 0.5f * line - gap}, ink(Tone::faint),
                                          em(0.07));
      ImGui::Dummy({1, line - gap});
    }
    drawToolButton(tools[k], {width - 2 * gap, side});
  }
  ImGui::End();
  ImGui::PopStyleVar(2);
}

void Panels::drawToolButton(const Tool& tool, const DVec2& size_px) {
  const auto width = static_cast<float>(size_px.x), height = static_cast<float>(size_px.y);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  if (noted(tool.name, ImGui::InvisibleButton(tool.name, {width, height}))) tool.choose();
  ImDrawList& list = *ImGui::GetWindowDrawList();
  if (tool.isOn || ImGui::IsItemHovered())
    list.AddRectFilled(at, {at.x + width, at.y + height}, ink(tool.isOn ? Tone::chosen : Tone::buttonHovered),
                       em(0.25));
  const float icon = std::min(height - em(0.2), em(1.5));
  drawIcon(list, tool.icon, {at.x + em(0.1), at.y + 0.5f * (height - icon)}, icon, ink(Tone::text));
  const ImVec2 key = ImGui::CalcTextSize(tool.key.c_str());
  if (key.x < em(0.8))  // longer ones are in the tooltip
    list.AddText({std::round(at.x + width - key.x - em(0.05)), std::round(at.y + height - key.y)},
                 ink(tool.isOn ? Tone::mark : Tone::faint), tool.key.c_str());
  help(fmt::format("{}{}: {}", tool.name, tool.key.empty() ? "" : " (" + tool.key + ")", tool.text));
}

// The position under the cursor at the left; what there is, and how fast it is, at the right.
void Panels::drawStatusLine(const ViewStatus& status) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({0, bottom_px_});
  ImGui::SetNextWindowSize({display.x, display.y - bottom_px_});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowRounding, 0);
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {em(0.6), em(0.2)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowMinSize, {1, 1});
  ImGui::Begin("status", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoFocusOnAppearing |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoBringToFrontOnFocus);
  std::string where;
  if (status.under) {
    for (int axis = 0; axis < 3; ++axis)
      where += fmt::format("{} {}   ", "xyz"[axis], coordinateText((*status.under)[axis], status.under_resolution));
    where += nameOf(status.unit);
  }
  ImGui::TextUnformatted(where.c_str());
  std::vector<std::string> facts{counted(status.session->presentPoints(), "point")};
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) facts.push_back(fmt::format("{} {}", count, what));
  };
  add(status.selection.selected, "selected");
  add(status.selection.hidden, "hidden");
  add(status.selection.locked, "locked");
  add(status.selection.inPart, "of them in part");
  add(status.selection.within, "may be changed");
  if (status.onTime_percent) facts.push_back(fmt::format("touch on time {:.0f} %", std::floor(*status.onTime_percent)));
  if (status.picture_ms > 0) facts.push_back(fmt::format("picture {:.0f} ms", status.picture_ms));
  const float room = display.x - em(2.4) - ImGui::CalcTextSize(where.c_str()).x;
  std::string line;
  for (const std::string& fact : facts) {
    std::string longer = line;
    if (!line.empty()) longer += "   ";
    longer += fact;
    if (ImGui::CalcTextSize(longer.c_str()).x > room) break;
    line = longer;
  }
  statusLine_ = where + (where.empty() ? "" : "   ") + line;
  ImGui::SameLine(display.x - em(0.6) - ImGui::CalcTextSize(line.c_str()).x);
  ImGui::TextUnformatted(line.c_str());
  ImGui::End();
  ImGui::PopStyleVar(3);
}

}  // namespace palpate
