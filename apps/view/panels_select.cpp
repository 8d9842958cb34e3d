// The part of Panels about selected points.
#include <imgui.h>

#include <algorithm>
#include <tuple>
#include <utility>

#include "apps/view/help_search.hpp"
#include "apps/view/panels.hpp"
#include "engine/cloud/las_classes.hpp"
#include "engine/core/counted.hpp"
#include "haptics/session/settings.hpp"

namespace palpate {

namespace {

constexpr std::array<std::pair<std::string_view, bool>, 2> kFloodsBy{{{"by normal", false}, {"by colour", true}}};
constexpr Range kAngles_deg{1, 90};
constexpr Range kRims_mm{0, 50};

}  // namespace

void Panels::drawSelect(const ViewStatus& status, WindowSettings& settings) {
  SelectSettings& select = settings.select;
  if (isBall(select.shape)) {
    dragLength("ball size", select.brush_mm, 0.1, settingNamed<BrushConfig>("radius_mm").slider, status);
    help("radius; [ and ] change it");
  }
  if (select.shape == SelectShape::lock) {
    choose("falloff", kFalloffs, select.falloff);
    help("how the lock decreases towards the rim: not at all, or as (1 - r^2) to the power of 1, 2 or 5");
  }
  if (select.shape == SelectShape::flood) choose("flood##by", kFloodsBy, select.floodsByColor);
  if (select.shape == SelectShape::flood && !select.floodsByColor) {
    drag("angle", select.angle_deg, 0.2f, kAngles_deg, "%.0f degrees");
    help("largest angle between the normals of a point and of the clicked one");
  } else if (select.shape == SelectShape::flood || select.shape == SelectShape::same) {
    widthBesideLabel("difference");
    noted("difference", ImGui::DragInt("difference", &select.colorStep, 0.5f, 0, 255));
    help("of colours: largest difference in red, green and blue, of 255");
  }
  if (isVolume(select.shape)) {
    drawVolumeNumbers(status, select.shape);
  } else if (select.shape != SelectShape::flood && select.shape != SelectShape::same) {
    checkbox("through", select.through);
    help("T: also points behind the first surface");
  }
  drawLabel(select);
  dragLength("soft rim", select.rim_mm, 0.1, kRims_mm, status);
  help("width of the rim around what is locked from now on, in which brushes change points in part; 0: none");
  drawSelected(status, select);
  drawWhere(status);
}

void Panels::drawVolumeNumbers(const ViewStatus& status, SelectShape shape) {
  if (shape == SelectShape::move) {
    bool isEntered = false;
    ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x);
    for (const auto& [hint, text, what] :
         {std::tuple{"move by x,y,z", &way_, "in model units"},
          {"rotate by x,y,z degrees", &angles_, "about the model's axes, in this order, around the middle of the box"},
          {"scale by a factor", &factor_, "around the middle of the box"}}) {
      isEntered |= field(hint, *text);
      help(what);
    }
    ImGui::PopItemWidth();
    if (button("Move") || isEntered) post(true, MoveSelection{way_.data(), angles_.data(), factor_.data()});
    return;
  }
  const DrawnVolume& volume = status.volume;
  if (std::exchange(shownVolume_, volume.numbers) != volume.numbers) {
    volume_ = {};
    std::ranges::copy(volume.numbers.substr(0, volume_.size() - 1), volume_.begin());
  }
  ImGui::PushItemWidth(ImGui::GetContentRegionAvail().x);
  post(field("numbers", volume_), SetVolume{volume_.data()});
  ImGui::PopItemWidth();
  help(shape == SelectShape::box    ? "two corners, x,y,z:x,y,z, as of --crop; empty while it is rotated"
       : shape == SelectShape::ball ? "centre and radius, x,y,z:r"
                                    : "a position and a direction, x,y,z:x,y,z");
  ImGui::BeginDisabled(volume.knobs.empty());
  post(flowing(shape == SelectShape::plane ? "Select this side" : "Select inside", true), SelectVolume{});
  help("Enter; Shift+Enter adds, Ctrl+Enter removes, both keep what is in both");
  if (shape == SelectShape::plane) {
    post(flowing("Other side", false), FlipPlane{});
    post(flowing("Mirror here", false), MirrorAtPlane{});
    help("brushes are mirrored at this plane from now on");
  }
  ImGui::EndDisabled();
}

// The field and the value that the label brush sets, and the button Set value.
void Panels::drawLabel(SelectSettings& select) {
  const float width = (ImGui::GetContentRegionAvail().x - 2 * ImGui::GetStyle().ItemSpacing.x) / 3;
  ImGui::PushItemWidth(2 * width);
  field("field", select.field);
  help("as classification; it is made if the model has no such field");
  ImGui::PopItemWidth();
  ImGui::SameLine();
  ImGui::PushItemWidth(width);
  const bool isEntered = field("value", select.value);
  ImGui::PopItemWidth();
  post(isEntered && select.value[0], SetValue{select.field.data(), select.value.data()});
  if (std::string_view(select.field.data()) != kClassification) return;
  std::vector<std::pair<std::string_view, std::string>> classes;
  for (std::size_t k = 0; k < kLasClasses.size(); ++k) classes.emplace_back(kLasClasses[k], std::to_string(k));
  std::string value = select.value.data();
  if (!choose("class", classes, value)) return;
  select.value = {};
  std::ranges::copy(value, select.value.begin());
}

// Selections by an expression, and as a field.
void Panels::drawWhere(const ViewStatus& status) {
  const ImGuiIO& io = ImGui::GetIO();
  post(fieldAndButton("intensity > 100", where_, "Find"),
       SelectWhere{.condition = where_.data(), .adds = io.KeyShift, .removes = io.KeyCtrl});
  help(
      "selects the points for which this holds, as classification == 2 && z > 3. Shift adds, Ctrl removes, both keep "
      "what is in both");
  if (!status.whereError.empty()) {
    ImGui::PushStyleColor(ImGuiCol_Text, ink(Tone::error));
    ImGui::TextWrapped("%s", status.whereError.c_str());
    ImGui::PopStyleColor();
  }
  ImGui::BeginDisabled(status.selection.selected == 0);
  post(fieldAndButton("name of the field", selectionName_, "Keep"), KeepSelection{selectionName_.data()});
  help("keeps the selection as a field: 1 of its points, 0 of all others; saved with the model");
  ImGui::EndDisabled();
}

void Panels::drawSelected(const ViewStatus& status, SelectSettings& select) {
  const bool isAny = status.selection.selected > 0;
  for (const SelectButton& row : selectButtons()) {
    ImGui::BeginDisabled(row.needs && status.selection.*row.needs == 0);
    post(flowing(row.name, &row == selectButtons().data()), row.command);
    ImGui::EndDisabled();
    help(row.help);
  }
  ImGui::BeginDisabled(!isAny);
  if (flowing("Export...", true)) browse(FileTask::exportSelection);
  help("writes the selected points to a file");
  if (flowing("Separate...", false)) browse(FileTask::separate);
  help("writes them to a file, and removes them here");
  post(flowing("Set value", false) && select.value[0], SetValue{select.field.data(), select.value.data()});
  help("gives the selected points the value above");
  ImGui::EndDisabled();
  checkbox("open beside", select.opensBeside);
  help("what Export and Separate write is opened in another window");
}

// Over the model: dark and light, so that it is seen on any colour.
void Panels::drawOutline(const DrawnOutline& outline) {
  if (outline.corners_px.empty()) return;
  ImDrawList& list = *ImGui::GetForegroundDrawList();
  std::vector<ImVec2> corners;
  for (const DVec2& corner : outline.corners_px)
    corners.emplace_back(static_cast<float>(corner.x), static_cast<float>(corner.y));
  const auto radius = static_cast<float>(outline.ball_px);
  const int count = static_cast<int>(corners.size());
  if (radius > 0 && count > 1) list.AddPolyline(corners.data(), count, IM_COL32(255, 150, 30, 70), 0, 2 * radius);
  for (const auto& [color, thick] :
       {std::pair{IM_COL32(0, 0, 0, 160), em(0.25)}, {IM_COL32(255, 190, 80, 255), em(0.1)}})
    if (radius > 0)
      list.AddCircle(corners.back(), radius, color, 0, thick);
    else
      list.AddPolyline(corners.data(), count, color, outline.isClosed ? ImDrawFlags_Closed : 0, thick);
}

void Panels::drawVolume(const DrawnVolume& volume) {
  ImDrawList& list = *ImGui::GetBackgroundDrawList();
  const auto at = [](const DVec2& place) { return ImVec2(static_cast<float>(place.x), static_cast<float>(place.y)); };
  for (const auto& [color, thick] :
       {std::pair{IM_COL32(0, 0, 0, 140), em(0.2)}, {IM_COL32(255, 190, 80, 255), em(0.08)}})
    for (const DrawnVolume::Line& line : volume.lines) list.AddLine(at(line.from_px), at(line.to_px), color, thick);
  constexpr std::array kAxes{IM_COL32(235, 80, 80, 255), IM_COL32(90, 200, 90, 255), IM_COL32(90, 140, 255, 255)};
  for (const DrawnVolume::Knob& knob : volume.knobs) {
    using Kind = VolumeHandle::Kind;
    const Kind kind = knob.handle.kind;
    const bool isOfAxis = kind != Kind::centre && kind != Kind::size;
    const ImU32 color = isOfAxis ? kAxes[static_cast<std::size_t>(knob.handle.axis)] : IM_COL32(255, 255, 255, 255);
    const float radius = em(knob.isHot ? 0.5 : 0.35);
    // Rings rotate, discs move, and a square makes larger.
    if (kind == Kind::ring) {
      list.AddCircle(at(knob.place_px), radius, IM_COL32(0, 0, 0, 200), 0, em(0.3));
      list.AddCircle(at(knob.place_px), radius, color, 0, em(0.16));
    } else if (kind == Kind::size) {
      const ImVec2 place = at(knob.place_px), low(place.x - radius, place.y - radius),
                   high(place.x + radius, place.y + radius);
      list.AddRectFilled(low, high, color);
      list.AddRect(low, high, IM_COL32(0, 0, 0, 200));
    } else {
      list.AddCircleFilled(at(knob.place_px), radius, color);
      list.AddCircle(at(knob.place_px), radius, IM_COL32(0, 0, 0, 200));
    }
  }
}

}  // namespace palpate
