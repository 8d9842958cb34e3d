#include "apps/view/panels.hpp"

#include <imgui.h>

#include <algorithm>
#include <cmath>

namespace palpate {

namespace {

constexpr std::size_t kCurve = 300;         // values across a plot, and
constexpr std::size_t kTicksPerValue = 10;  // ticks that each stands for, by the largest of them

bool drag(const char* label, double& value, float speed, double least, double most, const char* format) {
  return ImGui::DragScalar(label, ImGuiDataType_Double, &value, speed, &least, &most, format,
                           ImGuiSliderFlags_AlwaysClamp);
}

void help(const char* text) {
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("%s", text);
}

template <class Names, class Value>
bool choose(const char* label, const Names& names, Value& value) {
  bool changed = false;
  const char* now = "";
  for (const auto& [name, each] : names)
    if (each == value) now = name.data();
  if (!ImGui::BeginCombo(label, now)) return false;
  for (const auto& [name, each] : names)
    if (ImGui::Selectable(name.data(), each == value) && each != value) {
      value = each;
      changed = true;
    }
  ImGui::EndCombo();
  return changed;
}

constexpr std::array<std::pair<std::string_view, ColorBy>, 4> kColors{
    {{"colour", ColorBy::rgb}, {"normal", ColorBy::normal}, {"depth", ColorBy::depth}, {"height", ColorBy::height}}};

// The last ticks, thinned to what a plot can show.
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

void plot(const char* what, const std::vector<float>& curve, float least, float height) {
  const float largest = curve.empty() ? 0.0f : *std::ranges::max_element(curve);
  const float top = std::max(least, largest);
  const std::string label = fmt::format("{}   {:.3g}", what, curve.empty() ? 0.0f : curve.back());
  ImGui::PlotLines("##curve", curve.data(), static_cast<int>(curve.size()), 0, label.c_str(), 0, top,
                   {ImGui::GetContentRegionAvail().x, height});
  help(fmt::format("0 to {:.3g}; the last {} s", top, kCurve * kTicksPerValue / 1000).c_str());
}

}  // namespace

ViewWishes Panels::draw(const ViewStatus& status, ViewSettings& view, ToolSettings& tool, FeelSettings& feel,
                        bool& forcesOn) {
  ViewWishes wishes;
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({em(0.6), em(0.6)});
  ImGui::SetNextWindowSizeConstraints({em(18.5), 0}, {em(18.5), display.y - em(1.2)});
  ImGui::Begin("palpate", nullptr,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar);
  ImGui::PushItemWidth(em(8));
  drawModel(status, wishes);
  if (status.session) {
    drawTool(status, tool, view, wishes);
    drawFeel(status, feel, forcesOn);
    drawLook(status, view, wishes);
    drawSession(status, wishes);
  }
  ImGui::PopItemWidth();
  ImGui::End();
  if (view.plots && status.session) drawPlots(status, view, wishes);
  if (view.help) drawHelp(view);
  drawMessages(status, view);
  drawQuestion(status, wishes);
  return wishes;
}

void Panels::drawModel(const ViewStatus& status, ViewWishes& wishes) {
  if (status.session) {
    ImGui::TextUnformatted(std::filesystem::path(status.model).filename().c_str());
    help(status.model.c_str());
    ImGui::TextDisabled("%zu points, 1 unit = %.4g mm", status.session->model().cloud.size(),
                        status.session->model().scale.mm_per_unit);
  } else if (!status.loading) {
    ImGui::TextUnformatted("Drop a point cloud (PLY) here");
  }
  if (status.loading) {
    ImGui::TextUnformatted(status.loadingWhat.c_str());
    ImGui::ProgressBar(static_cast<float>(*status.loading), {-1, 0});
  }
  if (!ImGui::CollapsingHeader("Open", status.session || status.loading ? 0 : ImGuiTreeNodeFlags_DefaultOpen)) return;
  ImGui::PushItemWidth(em(11.5));
  const bool entered =
      ImGui::InputTextWithHint("##open", "file.ply", open_.data(), open_.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  ImGui::PopItemWidth();
  ImGui::SameLine();
  if ((ImGui::Button("Open##file") || entered) && open_[0]) wishes.open = open_.data();
  const auto list = [&](std::span<const std::string> files) {
    for (const std::string& file : files) {
      ImGui::PushID(file.c_str());
      if (ImGui::Selectable(std::filesystem::path(file).filename().c_str(), file == status.model)) wishes.open = file;
      help(file.c_str());
      ImGui::PopID();
    }
  };
  list(status.models);
  if (!status.recent.empty()) ImGui::TextDisabled("recent");
  list(status.recent);
}

void Panels::drawTool(const ViewStatus& status, ToolSettings& tool, ViewSettings& view, ViewWishes& wishes) {
  if (!ImGui::CollapsingHeader("Tool", ImGuiTreeNodeFlags_DefaultOpen)) return;
  const auto button = [&](const char* name, std::optional<BrushKind> kind) {
    const bool chosen = tool.brush == kind;
    if (chosen) ImGui::PushStyleColor(ImGuiCol_Button, ImGui::GetStyleColorVec4(ImGuiCol_ButtonActive));
    if (ImGui::Button(name, {em(3.75), 0})) tool.brush = kind;
    if (chosen) ImGui::PopStyleColor();
  };
  button("feel", std::nullopt);
  int column = 1;
  for (const auto& [name, kind] : kBrushKinds) {
    if (column++ % 4 != 0) ImGui::SameLine();
    button(name.data(), kind);
  }
  if (tool.brush) {
    drag("radius", tool.radius_mm, 0.1f, 0.5, 30, "%.1f mm");
    help("[ and ]");
    if (tool.brush == BrushKind::push)
      drag("speed", tool.beta, 0.005f, 0, 1, "%.2f");
    else
      drag("strength", tool.strength, 0.01f, 0, 1, "%.2f");
    drag("yields at", tool.tau_mm, 0.02f, 0, 5, "%.2f mm");
    help("how deep the stylus stands in the surface before it gives way");
    if (tool.brush == BrushKind::paint) {
      float color[3];
      for (std::size_t k = 0; k < 3; ++k) color[k] = static_cast<float>(tool.color[k]) / 255;
      if (ImGui::ColorEdit3("paint", color, ImGuiColorEditFlags_NoInputs))
        for (std::size_t k = 0; k < 3; ++k) tool.color[k] = static_cast<std::uint8_t>(std::lround(color[k] * 255));
    }
  }
  drag("press", view.press_mm, 0.05f, 0.1, 20, "%.1f mm");
  help("how deep the hand means to go while the button is down; turn the wheel meanwhile for more or less");
  ImGui::Checkbox("follow the surface", &view.followsSurface);
  help("off: the stylus moves in one plane before the eye, and the wheel moves it in depth");
  const Journal& journal = status.session->journal();
  ImGui::BeginDisabled(journal.undoable() == 0);
  if (ImGui::Button("Undo", {em(3.75), 0})) wishes.undo = true;
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::BeginDisabled(journal.redoable() == 0);
  if (ImGui::Button("Redo", {em(3.75), 0})) wishes.redo = true;
  ImGui::EndDisabled();
  ImGui::SameLine();
  ImGui::TextDisabled("%llu strokes", static_cast<unsigned long long>(journal.strokes()));
}

void Panels::drawFeel(const ViewStatus& status, FeelSettings& feel, bool& forcesOn) {
  if (!ImGui::CollapsingHeader("Feel")) return;
  ImGui::Checkbox("forces on", &forcesOn);
  help("Backspace");
  choose("surface", kSurfaceKinds, feel.surface);
  if (status.session->backendName() == "vulkan") choose("query", kQueryMethods, feel.method);
  drag("stiffness", feel.stiffness_N_per_mm, 0.01f, 0, 5, "%.2f N/mm");
  drag("damping", feel.damping_N_s_per_mm, 0.0001f, 0, 0.02, "%.4f N s/mm");
  drag("friction", feel.friction, 0.01f, 0, 2, "%.2f");
  drag("at most", feel.maxForce_N, 0.02f, 0, kTouchPeakForce_N, "%.2f N");
  ImGui::TextDisabled("%s", status.session->machine().c_str());
}

void Panels::drawLook(const ViewStatus& status, ViewSettings& view, ViewWishes& wishes) {
  if (!ImGui::CollapsingHeader("Look")) return;
  choose("colour by", kColors, view.color);
  drag("disc radius", view.discRadius_mm, 0.01f, 0, 5, view.discRadius_mm > 0 ? "%.2f mm" : "auto");
  ImGui::Checkbox("triangles", &view.mesh);
  help("marching cubes (M); touched blocks follow while you sculpt");
  if (view.mesh) {
    ImGui::SameLine();
    int exponent = static_cast<int>(std::lround(std::log2(view.lattice / 64)));
    ImGui::PushItemWidth(em(5));
    if (ImGui::Combo("lattice", &exponent, "64\000128\000256\000512\000\000")) view.lattice = 64 << exponent;
    ImGui::PopItemWidth();
    ImGui::TextDisabled("%llu triangles, last change %.1f ms", static_cast<unsigned long long>(status.meshTriangles),
                        status.meshTime_ms);
  }
  ImGui::Checkbox("smooth outlines", &view.smoothOutlines);
  ImGui::SameLine();
  ImGui::Checkbox("scale", &view.scaleBar);
  ImGui::Checkbox("dark", &view.dark);
  ImGui::SameLine();
  ImGui::Checkbox("wait for display", &view.waitsForDisplay);
  if (ImGui::Button("Reset")) wishes.resetView = true;
  help("R");
  for (int axis = 0; axis < 3; ++axis) {
    ImGui::SameLine();
    if (ImGui::Button(std::array{"X", "Y", "Z"}[static_cast<std::size_t>(axis)])) wishes.axis = axis;
  }
  ImGui::SameLine();
  if (ImGui::Button("Picture")) wishes.screenshot = true;
  help("P");
}

void Panels::drawSession(const ViewStatus& status, ViewWishes& wishes) {
  if (!ImGui::CollapsingHeader("Save and record")) return;
  const Session& session = *status.session;
  ImGui::BeginDisabled(!session.isChanged() || session.isSaving());
  if (ImGui::Button("Save")) wishes.save = true;
  ImGui::EndDisabled();
  help(("writes " + status.model).c_str());
  ImGui::SameLine();
  if (session.isSaving())
    ImGui::TextDisabled("saving...");
  else
    ImGui::TextDisabled("%s", session.isChanged() ? "changed" : "as in the file");
  ImGui::InputTextWithHint("##save", "other.ply", saveAs_.data(), saveAs_.size());
  ImGui::SameLine();
  if (ImGui::Button("Save as") && saveAs_[0]) wishes.saveAs = saveAs_.data();
  ImGui::InputTextWithHint("##log", "session.log", log_.data(), log_.size());
  ImGui::SameLine();
  if (session.isRecording()) {
    if (ImGui::Button("Stop##record")) wishes.endRecording = true;
  } else if (ImGui::Button("Record") && log_[0]) {
    wishes.record = log_.data();
  }
  help("a recording can be run again with palpate replay");
  ImGui::SameLine();
  if (session.isPlaying()) {
    if (ImGui::Button("Stop##play")) wishes.endPlaying = true;
  } else if (ImGui::Button("Play") && log_[0]) {
    wishes.play = log_.data();
  }
}

void Panels::drawPlots(const ViewStatus& status, ViewSettings& view, ViewWishes& wishes) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x - em(0.6), em(0.6)}, ImGuiCond_Always, {1, 0});
  ImGui::SetNextWindowSize({em(18), 0});
  ImGui::Begin("Curves", &view.plots, ImGuiWindowFlags_NoMove | ImGuiWindowFlags_NoResize);
  const TickHistory& history = status.session->history();
  if (!paused_)
    curves_ = {curveOf(history.rows(), [](const TraceRow& row) { return glm::length(row.force_N); }),
               curveOf(history.rows(), [](const TraceRow& row) { return row.penetration_mm; }),
               curveOf(history.rows(), [](const TraceRow& row) { return row.step_us; })};
  const float height = em(3.4);
  const auto curve = [&](const char* what, const std::vector<float>& values, float least) {
    ImGui::PushID(what);
    plot(what, values, least, height);
    ImGui::PopID();
  };
  curve("force, N", curves_.force_N, 1);
  curve("penetration, mm", curves_.penetration_mm, 1);
  curve("tick, us", curves_.step_us, 100);
  const std::vector<float> pictures(status.pictures_ms->begin(), status.pictures_ms->end());
  curve("picture, ms", pictures, 16);
  ImGui::Text("tick p50 %.0f us, p99.9 %.0f us", history.step_us().quantile_us(0.5),
              history.step_us().quantile_us(0.999));
  ImGui::Text("missed %llu of %llu", static_cast<unsigned long long>(history.missed()),
              static_cast<unsigned long long>(history.ticks()));
  ImGui::Text("%.0f pictures a second", status.fps);
  ImGui::TextDisabled("%s", status.gpu.c_str());
  if (ImGui::TreeNode("passes, us on the GPU")) {
    for (const PassRecord& pass : status.passes)
      if (pass.gpu_us > 0) ImGui::Text("%-24.24s %8.0f", pass.name.c_str(), pass.gpu_us);
    ImGui::TreePop();
  }
  if (ImGui::Button(paused_ ? "Go on" : "Pause")) paused_ = !paused_;
  ImGui::SameLine();
  if (ImGui::Button("Export CSV")) wishes.exportTicks = true;
  help("the last minute of ticks");
  ImGui::End();
}

void Panels::drawHelp(ViewSettings& view) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  ImGui::Begin("Help", &view.help, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
  static constexpr std::array<std::pair<const char*, const char*>, 17> kRows{
      {{"hold Space", "the mouse is the stylus: move over the model"},
       {"Space + left button", "press into the model, and sculpt with a tool"},
       {"Space + wheel", "deeper, or less deep"},
       {"T", "keep the stylus without holding Space"},
       {"left drag", "turn the view about what is under the cursor"},
       {"middle drag, Shift + left", "move the view"},
       {"wheel", "zoom to the cursor"},
       {"double click", "look at what is under the cursor"},
       {"R;  X  Y  Z", "reset the view;  look along an axis (Shift: from behind)"},
       {"1 to 7", "feel, push, carve, inflate, smooth, grab, paint"},
       {"[  ]", "smaller, larger tool"},
       {"Ctrl+Z,  Ctrl+Shift+Z", "undo, redo"},
       {"Ctrl+S", "save"},
       {"Backspace", "forces off, and on again"},
       {"M", "triangles (marching cubes), or points"},
       {"P,  C", "picture to a file,  curves on and off"},
       {"H,  Q", "this help,  quit"}}};
  if (ImGui::BeginTable("keys", 2)) {
    for (const auto& [keys, what] : kRows) {
      ImGui::TableNextRow();
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(keys);
      ImGui::TableNextColumn();
      ImGui::TextUnformatted(what);
    }
    ImGui::EndTable();
  }
  ImGui::TextDisabled("A gamepad: left stick moves, right stick or triggers go in depth, A holds the stylus.");
  ImGui::End();
}

void Panels::drawMessages(const ViewStatus& status, const ViewSettings& view) {
  std::vector<std::string> lines = status.messages;
  if (status.stylus) lines.insert(lines.begin(), "stylus: press with the left button");
  if (lines.empty() && status.session && !view.help) lines.push_back("hold Space to touch,  H for help");
  if (lines.empty()) return;
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y - em(0.8)}, ImGuiCond_Always, {0.5f, 1});
  ImGui::Begin("messages", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoInputs |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
  ImGui::PushTextWrapPos(0.7f * display.x);
  for (const std::string& line : lines) ImGui::TextUnformatted(line.c_str());
  ImGui::PopTextWrapPos();
  ImGui::End();
}

void Panels::drawQuestion(const ViewStatus& status, ViewWishes& wishes) {
  if (status.asksAboutChanges && !ImGui::IsPopupOpen("Changes")) ImGui::OpenPopup("Changes");
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({display.x / 2, display.y / 2}, ImGuiCond_Always, {0.5f, 0.5f});
  if (!ImGui::BeginPopupModal("Changes", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove)) return;
  ImGui::Text("%s has changed since it was saved.", std::filesystem::path(status.model).filename().c_str());
  wishes.saveFirst = ImGui::Button("Save");
  ImGui::SameLine();
  wishes.discard = ImGui::Button("Do not save");
  ImGui::SameLine();
  wishes.cancel = ImGui::Button("Cancel");
  if (wishes.saveFirst || wishes.discard || wishes.cancel || !status.asksAboutChanges) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

}  // namespace palpate
