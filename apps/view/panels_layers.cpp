// The part of Panels for layers of strokes.
#include <imgui.h>

#include <string>

#include "apps/view/panels.hpp"

namespace palpate {

void Panels::drawLayers(const ViewStatus& status) {
  if (!status.session->session().abilities().allow(Action::layer)) return;
  using What = LayerCommand::What;
  const StrokeLayers& layers = status.session->attributes().strokeLayers();
  const bool isOpen = layers.open().has_value();
  if (post(button(isOpen ? "End layer" : "New layer", em(5.5)), LayerCommand{What::addOrClose, layerName_.data()}))
    layerName_ = {};
  help(isOpen ? "L: later strokes are in no layer"
              : "L: the strokes from now on are a layer; its strength slides after the fact, and it can be hidden");
  if (!isOpen) {
    ImGui::SameLine();
    ImGui::SetNextItemWidth(-1);
    if (post(field("layer name", layerName_), LayerCommand{What::add, layerName_.data()})) layerName_ = {};
  }
  for (auto number = static_cast<std::uint32_t>(layers.size()); number-- > 0;)
    if (!layers[number].isMerged) drawLayer(layers, number);
}

void Panels::drawLayer(const StrokeLayers& layers, std::uint32_t number) {
  using What = LayerCommand::What;
  const StrokeLayer& layer = layers[number];
  const std::string& name = layer.name;
  ImGui::PushID(static_cast<int>(number));
  bool isShown = !layer.isHidden;
  const bool isSwitched = noted("show " + name, ImGui::Checkbox("##show", &isShown));
  post(isSwitched, LayerCommand{isShown ? What::show : What::hide, name});
  help("shows " + name + ", or hides it: the points are as before its strokes");
  ImGui::SameLine();
  const bool isOpen = layers.open() == number;
  post(noted("into " + name, ImGui::RadioButton("##into", isOpen)),
       LayerCommand{isOpen ? What::close : What::open, name});
  help("strokes go into " + name + ", at strength 1; or no longer");
  ImGui::SameLine();
  double strength = layer.strength;
  constexpr double kNone = 0, kAll = 1;
  const float room = roomBeside("Merge");
  const float textRoom = room - 2 * ImGui::GetStyle().FramePadding.x;
  const std::string value = fmt::format("{:.2f}  ", strength);
  const std::string shown = shortened(name, textRoom - ImGui::CalcTextSize(value.c_str()).x);
  std::string format = "%.2f  ";
  for (const char letter : shown) format += letter == '%' ? "%%" : std::string(1, letter);
  ImGui::SetNextItemWidth(room);
  const bool isChanged =
      ImGui::SliderScalar("##strength", ImGuiDataType_Double, &strength, &kNone, &kAll, format.c_str());
  if (ImGui::IsItemActivated()) slides_ = false;
  if (post(noted(name, isChanged), LayerCommand{slides_ ? What::slideFurther : What::slide, name, strength}))
    slides_ = true;
  noteText(name, (value + shown).c_str(), textRoom);
  help(name +
       ": strength of the strokes: with 0 the points are as before them, with 1 as they were made; Ctrl+click: any "
       "number from -1 (the other way) to 2, or less after deep cuts or pulls. What they cut away is gone from 0.5 on. "
       "What other strokes did since stays, and locked points stay as they are");
  ImGui::SameLine();
  post(noted("merge " + name, ImGui::Button("Merge")), LayerCommand{What::merge, name});
  help(name + " becomes part of the model, as strong as it is");
  ImGui::PopID();
}

}  // namespace palpate
