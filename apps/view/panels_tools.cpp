// The part of Panels at the edges of the window: the tools at the left, and the status line.
#include <imgui.h>

#include <algorithm>
#include <cmath>
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

DVec2 Panels::freeWidth_px(const ViewSettings& view, double width_px) const {
  const DVec2 all(0, width_px);
  if (!view.panels) return all;
  const DVec2 besidePanel(double{em(kTools_em)}, width_px - double{em(kPanel_em + 2 * kMargin_em)});
  const DVec2 between = view.plots ? besidePanel - DVec2(0, double{em(kCurves_em + 2 * kMargin_em)}) : besidePanel;
  // Where too little is left between panel and curves, the model is centred behind the curves, then behind the panel
  // too.
  for (const DVec2& free : {between, besidePanel})
    if (free.y - free.x >= double{em(kModel_em)}) return free;
  return all;
}

bool Panels::hasRoomBeside(double width_px) const {
  return width_px >= double{em(kTools_em + kPanel_em + 2 * kMargin_em + kModel_em)};
}

std::vector<Panels::Tool> Panels::toolsOf(const ViewStatus& status, WindowSettings& settings) {
  const bool selects = settings.tool == WindowTool::select, looks = settings.tool == WindowTool::look,
             measures = settings.view.measures;
  const auto use = [&settings](WindowTool tool) { return [&settings, tool] { settings.use(tool); }; };
  std::vector<Tool> tools{
      {"Sculpt", icon::kSculpt, "Shift+S", "hold Space: the mouse is the stylus (1 to 8 choose what it does)",
       !selects && !looks && !measures, use(WindowTool::sculpt)},
      {"Select", icon::kSelect, "S", "the left button selects points", selects, use(WindowTool::select)},
      {"Only look", icon::kLook, "V", "the mouse only moves the view", looks && !measures, use(WindowTool::look)},
      {"Ruler", icon::kMeasure, selects ? "Shift+D" : "D", "the left button picks the two ends of a distance", measures,
       [&settings, selects] {
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
      tools.push_back({name, drawn, name, "looks along this axis (with Shift from behind)", false,
                       posts(LookAlong{axis, ImGui::GetIO().KeyShift})});
    tools.push_back({"Without perspective", icon::kOrthographic, "Ctrl+8", "lengths can be compared wherever they are",
                     settings.view.orthographic,
                     [&settings] { settings.view.orthographic = !settings.view.orthographic; }});
    tools.push_back({"Picture", icon::kPicture, "P", "writes a picture of the model, without panels, to a file", false,
                     posts(WindowCommand::screenshot)});
  } else {
    tools.push_back({"feel", icon::kFeel, "1", "touches the surface and leaves it as it is",
                     !settings.brush.sculpts && !measures, [&settings] {
                       settings.use(WindowTool::sculpt);
                       settings.brush.sculpts = false;
                     }});
    for (std::size_t k = 0; k < kBrushes.size(); ++k) {
      const BrushTraits& each = kBrushes[k];
      tools.push_back(
          {each.name.data(), icon::kOfBrushes[k], std::to_string(k + 2), whatItDoes(each),
           settings.brush.sculpts && !measures && status.brush.kind.value_or(settings.brush.kind) == each.kind,
           [&settings, kind = each.kind] {
             settings.use(WindowTool::sculpt);
             settings.brush.kind = kind;
             settings.brush.sculpts = true;
           }});
    }
  }
  return tools;
}

// What the mouse does, and below the line the tools for that. Where they have no room together they scroll between two
// arrows.
void Panels::drawTools(const ViewStatus& status, WindowSettings& settings) {
  tools_ = toolsOf(status, settings);
  const float gap = em(0.15), width = em(kTools_em - 2 * kEdge_em), room = bottom_px_ - 2 * em(kEdge_em);
  const float line = em(0.5), rows = static_cast<float>(tools_.size());
  const float fitting = (room - line - 2 * gap) / rows - gap;
  const bool fits = fitting >= em(1.1);
  const float side = fits ? std::min(fitting, em(2.2)) : em(1.7), arrow = em(1);
  ImGui::SetNextWindowPos({em(kEdge_em), em(kEdge_em)});
  ImGui::SetNextWindowSize({width, std::min(room, rows * (side + gap) + line + gap)});
  ImGui::PushStyleVar(ImGuiStyleVar_WindowPadding, {gap, gap});
  ImGui::PushStyleVar(ImGuiStyleVar_ItemSpacing, {0, gap});
  ImGui::Begin("tools", nullptr, ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoNav);
  const float column = std::floor(width - 2 * gap);
  const DVec2 size_px(column, side), arrow_px(column, arrow);
  const auto draw = [&] {
    constexpr std::size_t kModes = 4;
    std::string lit;
    for (std::size_t k = 0; k < tools_.size(); ++k) {
      if (k == kModes) {
        const ImVec2 at = ImGui::GetCursorScreenPos();
        ImGui::GetWindowDrawList()->AddLine({at.x + 2 * gap, at.y + 0.5f * line - gap},
                                            {at.x + width - 4 * gap, at.y + 0.5f * line - gap}, ink(Tone::faint),
                                            em(0.07));
        ImGui::Dummy({1, line - gap});
      }
      drawToolButton(tools_[k], size_px);
      if (tools_[k].isOn) lit = tools_[k].name;
      if (tools_[k].isOn && lit != litTool_ && k >= kModes) ImGui::SetScrollHereY();
    }
    litTool_ = lit;
  };
  if (fits) {
    draw();
  } else {
    const float page = room - 2 * (arrow + 2 * gap);
    const auto scrolls = [&](const char* name, std::string_view icon, float by, bool isEnd) {
      ImGui::BeginDisabled(isEnd);
      drawToolButton({name, icon, {}, "by a click, or by the wheel", false, [&, by] { scrollTools_ = by; }}, arrow_px);
      ImGui::EndDisabled();
    };
    scrolls("Tools above", icon::kUp, -0.8f * page, toolsAt_[0] <= 0);
    ImGui::BeginChild("column", {column, page}, false, ImGuiWindowFlags_NoScrollbar);
    draw();
    if (scrollTools_ != 0) ImGui::SetScrollY(ImGui::GetScrollY() + std::exchange(scrollTools_, 0.0f));
    toolsAt_ = {ImGui::GetScrollY(), ImGui::GetScrollMaxY()};
    ImGui::EndChild();
    scrolls("Tools below", icon::kDown, 0.8f * page, toolsAt_[0] >= toolsAt_[1]);
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
  const float side = std::min(height - em(0.2), em(1.35));
  const float left = tool.key.empty() ? 0.5f * (width - side) : em(0.1);
  drawIcon(list, tool.icon, {at.x + left, at.y + 0.5f * (height - side)}, side,
           ImGui::GetColorU32(ImGui::ColorConvertU32ToFloat4(ink(Tone::text))));
  drawKey(tool, {at.x + width - em(0.05), at.y + height});
  help(fmt::format("{}{}: {}", tool.name, tool.key.empty() ? "" : " (" + tool.key + ")", tool.text));
}

// The last letter of the key, with an arrow for Shift or a roof for Ctrl; `end`: the lower right corner.
void Panels::drawKey(const Tool& tool, const ImVec2& end) const {
  if (tool.key.empty()) return;
  const std::string letter = tool.key.substr(tool.key.rfind('+') + 1);
  const ImVec2 size = ImGui::CalcTextSize(letter.c_str());
  const ImU32 color = ink(tool.isOn ? Tone::mark : Tone::faint);
  ImDrawList& list = *ImGui::GetWindowDrawList();
  const float x = std::round(end.x - size.x), y = std::round(end.y - size.y);
  list.AddText({x, y}, color, letter.c_str());
  const float side = em(0.62);
  const std::string_view with = tool.key.starts_with("Shift+")  ? icon::kShift
                                : tool.key.starts_with("Ctrl+") ? icon::kControl
                                                                : std::string_view();
  if (!with.empty()) drawIcon(list, with, {end.x - side, std::round(y - 0.75f * side)}, side, color);
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
