// The part of Panels for the look of the model, and for views of it.
#include <imgui.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "apps/view/panels.hpp"
#include "apps/view/session.hpp"

namespace palpate {

// The names are those of the command line; `now`: the value that auto stands for.
template <class Names, class Value>
void Panels::chooseOrAuto(const char* label, const Names& names, std::optional<Value>& value, std::string_view now) {
  const std::string automatic = fmt::format("auto ({})", now);
  const char* shown = automatic.c_str();
  for (const auto& [name, each] : names)
    if (value == each) shown = name.data();
  if (!beginList(label, shown)) return;
  if (noted("auto", ImGui::Selectable("auto", !value))) value.reset();
  for (const auto& [name, each] : names)
    if (noted(name, ImGui::Selectable(name.data(), value == each))) value = each;
  ImGui::EndCombo();
}

void Panels::drawLook(const ViewStatus& status, ViewSettings& view) {
  if (!header("Look")) return;
  chooseOrAuto("up", kUpAxes, view.up, nameOf(status.upFound));
  chooseOrAuto("unit", kLengthUnits, view.unit, nameOf(status.unit));
  help("unit of the file's lengths, for display only; it does not change the scale");
  dragLength("point radius", view.discRadius_mm, 0.01, {0, 5}, status, view.discRadius_mm > 0 ? "" : "auto");
  help("radius of the disc drawn for each point; auto (0): large enough to close the surface");
  drawLight(view.light);
  checkbox("triangles", view.mesh);
  help("marching cubes (M); edited blocks are updated while you sculpt");
  if (view.mesh) {
    int exponent = static_cast<int>(std::lround(std::log2(view.resolution / 32)));
    ImGui::PushItemWidth(em(5));
    if (noted("resolution", ImGui::Combo("resolution", &exponent, "32\00064\000128\000256\000512\000\000")))
      view.resolution = 32 << exponent;
    ImGui::PopItemWidth();
    ImGui::TextDisabled("%llu triangles, last change %.1f ms", static_cast<unsigned long long>(status.meshTriangles),
                        status.meshTime_ms);
    if (status.meshTriangles > 0 && button("Export mesh...")) browse(FileTask::exportMesh);
  }
  checkbox("cameras", view.cameras);
  help("F: the cameras that took the model's pictures, if its files contain them");
  checkbox("antialiasing", view.smoothOutlines);
  help("four samples per pixel; slower");
  ImGui::SameLine();
  checkbox("scale", view.scaleBar);
  choose("theme", kThemes, view.dark);
  choose("text size, %", kTextSizes, view.text_percent);
  help("Ctrl++ and Ctrl+-; Ctrl+0: 100 %");
  checkbox("full screen", view.fullScreen);
  help("F11");
  ImGui::SameLine();
  checkbox("vsync", view.waitsForDisplay);
  help("off: frames are drawn as fast as possible, and may tear");
  checkbox("orthographic", view.orthographic);
  help("Ctrl+8: without perspective, so that lengths can be compared wherever they are");
  for (std::size_t k = 0; k < kGuides.size(); ++k) {
    if (k % 2 != 0) ImGui::SameLine(em(6));
    checkbox(kGuides[k].first.data(), view.guides.*kGuides[k].second);
  }
  help("guides: the box with its lengths, axes with coordinates, squares of a round length on the ground, directions");
  drawSides();
  drawViews(status);
}

// The table's rows, with the names that the command line has.
void Panels::drawLight(LightConfig& light) {
  for (const Setting<LightConfig>& setting : settingsOf(&light)) {
    const auto& member = std::get<WordMember<LightConfig>>(setting.member);
    const std::vector<std::string> names = member.all();
    const std::vector<std::string_view> words(names.begin(), names.end());
    auto chosen = static_cast<std::size_t>(std::ranges::find(words, member.name(light)) - words.begin());
    if (chooseWord(setting.flag.substr(2).data(), words, chosen)) member.choose(light, words[chosen]);
    help(std::string(setting.help));
  }
}

void Panels::drawSides() {
  for (std::size_t k = 0; k < kModelSides.size(); ++k) {
    post(flowing(kModelSides[k].first.data(), k == 0), kModelSides[k].second);
    help(fmt::format("Ctrl+{}: looks at this side of the model, by the up axis", k + 1));
  }
}

// Views that the user has named: each is shown by its button.
void Panels::drawViews(const ViewStatus& status) {
  ImGui::SetNextItemWidth(roomBeside("Remember view"));
  const bool entered = field("name", viewName_, "name of the view");
  ImGui::SameLine();
  if (button("Remember view") || entered) {
    commands_.emplace_back(NamedViewCommand{NamedViewCommand::What::remember, viewName_.data()});
    viewName_[0] = 0;
  }
  help("keeps what you see now under this name, for this model");
  if (status.views.size() > 1) {
    std::string lines;
    for (const NamedText& view : status.views) lines += "# " + view.name + '\n' + view.text + '\n';
    post(button("Copy all views"), CopyText{lines});
    help("copies them as text; in a file, it is a way for a film: palpate render --camera-path FILE -o film.mp4");
  }
  for (const NamedText& view : status.views) {
    ImGui::PushID(view.name.c_str());
    post(button(view.name.c_str(), roomBeside("Forget")), NamedViewCommand{NamedViewCommand::What::show, view.name});
    help("shows this view again; on the command line: render --camera \"" + view.text + "\"");
    ImGui::SameLine();
    post(noted("Forget " + view.name, ImGui::Button("Forget")),
         NamedViewCommand{NamedViewCommand::What::forget, view.name});
    ImGui::PopID();
  }
}

}  // namespace palpate
