// The part of Panels that shows a picked position and the distance of two.
#include <imgui.h>

#include "apps/view/panels.hpp"
#include "engine/cloud/length_text.hpp"

namespace palpate {

void Panels::drawPlace(const PlaceInfo& info) {
  const auto row = [](const char* name, const std::string& value) { ImGui::TextWrapped("%s %s", name, value.c_str()); };
  // One line per axis, so that no number is broken at the panel's edge.
  const auto place = [](const std::string& what, const DVec3& at, double resolution) {
    ImGui::TextUnformatted(what.c_str());
    for (int axis = 0; axis < 3; ++axis)
      ImGui::Text("   %c %s", "xyz"[axis], coordinateText(at[axis], resolution).c_str());
  };
  place("position", info.place, info.resolution);
  if (info.point) {
    place(fmt::format("point {}", *info.point), info.position, info.positionResolution);
    row("normal", fmt::format("{:.4f}, {:.4f}, {:.4f}", info.normal.x, info.normal.y, info.normal.z));
  }
  for (const auto& [name, value] : info.attributes) row(name.c_str(), value);
  if (info.stiffness_N_mm)
    row("stiffness", fmt::format("{:.3g} N/mm in the hand: {}", *info.stiffness_N_mm, info.stiffnessOf));
  else
    row("stiffness", info.stiffnessOf);
}

void Panels::drawDistances(const ViewStatus& status) {
  using What = MeasureCommand::What;
  for (const MeasuredDistance& distance : status.measure->distances()) {
    ImGui::PushID(distance.name.c_str());
    post(button(distance.name.c_str(), em(6.5)), MeasureCommand{What::show, distance.name});
    help("chooses this distance, and looks at it");
    ImGui::SameLine();
    ImGui::TextUnformatted(lengthText(distance.length(), status.unit).c_str());
    ImGui::PopID();
  }
  if (status.measure->distances().empty()) return;
  if (const MeasuredDistance* const distance = status.measure->chosen()) {
    post(button("Forget"), MeasureCommand{What::forget, distance->name});
    help("removes " + distance->name);
    ImGui::SameLine();
  }
  post(button("Save CSV"), WindowCommand::saveMeasures);
  help("writes all distances beside the model: names, coordinates of the file, lengths, heights");
}

void Panels::drawMeasure(const ViewStatus& status, ViewSettings& view) {
  if (view.measures) ImGui::SetNextItemOpen(true);
  if (!header("Measure")) return;
  checkbox("pick two positions", view.measures);
  help("D: the left button picks positions on the model; rotate the view beside the model, or with another button");
  if (const MeasuredDistance* const distance = status.measure->chosen(); distance && status.session) {
    const auto text = [&](double length) { return lengthText(length, status.unit); };
    const UpAxis up = view.upOf(status.session->model());
    ImGui::TextWrapped("%s: %s", distance->name.c_str(), text(distance->length()).c_str());
    ImGui::TextWrapped("height %s, across %s", text(distance->height(up)).c_str(), text(distance->across(up)).c_str());
    help("of the second position over the first, along the up axis, and the rest of the way");
    if (fieldAndButton("name", distanceName_, "Rename")) {
      commands_.emplace_back(MeasureCommand{MeasureCommand::What::rename, distance->name, distanceName_.data()});
      distanceName_[0] = 0;
    }
    post(fieldAndButton("true length, mm", trueLength_, "Set"), SetTrueLength{trueLength_.data()});
    help(
        "opens the model again at the touch scale that gives the measured distance this length; saved files "
        "contain it (mm_per_unit)");
  } else {
    ImGui::TextDisabled(view.measures ? "click two positions on the model" : "nothing is measured");
  }
  drawDistances(status);
  if (status.picked) {
    drawPlace(*status.picked);
    post(button("Copy"), WindowCommand::copyPlaces);
    help("Ctrl+C: copies the picked positions, one per line");
  }
}

}  // namespace palpate
