#include "apps/view/panels.hpp"

#include <imgui.h>
#include <imgui_internal.h>

#include <algorithm>
#include <cmath>

#include "engine/cloud/length_text.hpp"
#include "engine/core/counted.hpp"
#include "haptics/session/settings.hpp"

namespace palpate {

namespace {

template <class Section>
const Range& sliderOf(std::string_view name) {
  return settingNamed<Section>(name).slider;
}

}  // namespace

bool Panels::noted(std::string_view name, bool result) {
  const ImVec2 from = ImGui::GetItemRectMin(), to = ImGui::GetItemRectMax();
  const ImVec2 middle(0.5f * (from.x + to.x), 0.5f * (from.y + to.y));
  name = name.substr(0, name.find("##"));
  if (to.x > ImGui::GetWindowDrawList()->GetClipRectMax().x + kRounding_px) cut_.emplace(name);
  // A control that is cut off at the panel's edge is scrolled into view first.
  if (ImGui::IsItemVisible() && ImGui::IsRectVisible(middle, {middle.x + 1, middle.y + 1}))
    places_.insert_or_assign(std::string(name), DVec2(middle.x, middle.y));
  else if (name == scrollTo_)
    ImGui::SetScrollHereY();
  return result;
}

bool Panels::post(bool chosen, const ViewCommand& command) {
  if (chosen) commands_.push_back(command);
  return chosen;
}

void Panels::scrollTo(const std::string& name) { scrollTo_ = name; }

std::optional<DVec2> Panels::placeOf(const std::string& name) const {
  const auto found = places_.find(name);
  if (found == places_.end()) return std::nullopt;
  return found->second;
}

bool Panels::button(const char* name, float width) {
  const float padding = 2 * ImGui::GetStyle().FramePadding.x;
  std::string shown(name, ImGui::FindRenderedTextEnd(name));
  if (width > 0) shown = shortened(shown, width - padding);
  ImGui::PushID(name);
  const bool isPressed = noted(name, ImGui::Button(shown.c_str(), {width, 0}));
  ImGui::PopID();
  if (!std::string_view(name).starts_with(shown)) help(name);
  noteText(name, shown.c_str(), ImGui::GetItemRectSize().x - padding);
  return isPressed;
}

void Panels::noteText(std::string_view name, const char* text, float room) {
  if (ImGui::CalcTextSize(text, nullptr, true).x > room + kRounding_px) cut_.emplace(name.substr(0, name.find("##")));
}

float Panels::widthBesideLabel(const char* label) {
  const float own = ImGui::CalcTextSize(label, nullptr, true).x, gap = ImGui::GetStyle().ItemInnerSpacing.x;
  const float width =
      own > 0 ? std::min(ImGui::CalcItemWidth(), ImGui::GetContentRegionAvail().x - own - gap) : ImGui::CalcItemWidth();
  ImGui::SetNextItemWidth(width);
  return width;
}

float Panels::roomBeside(const char* button) const {
  const ImGuiStyle& style = ImGui::GetStyle();
  return ImGui::GetContentRegionAvail().x - style.ItemSpacing.x - ImGui::CalcTextSize(button, nullptr, true).x -
         2 * style.FramePadding.x;
}

bool Panels::fieldAndButton(const char* hint, std::array<char, 512>& text, const char* does) {
  ImGui::SetNextItemWidth(roomBeside(does));
  const bool isEntered = field(hint, text);
  ImGui::SameLine();
  return (button(does) || isEntered) && text[0];
}

bool Panels::flowing(const char* name, bool isFirst) {
  const ImGuiStyle& style = ImGui::GetStyle();
  const float width = ImGui::CalcTextSize(name, nullptr, true).x + 2 * style.FramePadding.x;
  const float end = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
  if (!isFirst && ImGui::GetItemRectMax().x + style.ItemSpacing.x + width <= end) ImGui::SameLine();
  return button(name);
}

bool Panels::checkbox(const char* name, bool& on) { return noted(name, ImGui::Checkbox(name, &on)); }

bool Panels::header(const char* name, bool open) {
  if (!opens_.empty()) ImGui::SetNextItemOpen(opens_ == name);
  const bool isOpen = noted(name, ImGui::CollapsingHeader(name, open ? ImGuiTreeNodeFlags_DefaultOpen : 0));
  if (opens_ == name) ImGui::SetScrollHereY(0);
  const auto section = std::ranges::find(kSections, name);
  if (section == kSections.end()) return isOpen;
  const std::string key = fmt::format("F{}", section - kSections.begin() + 2);
  const ImVec2 end = ImGui::GetItemRectMax(), size = ImGui::CalcTextSize(key.c_str());
  const ImVec2 at{std::round(end.x - size.x - em(0.4)), std::round(end.y - size.y - ImGui::GetStyle().FramePadding.y)};
  ImGui::GetWindowDrawList()->AddText(at, ImGui::GetColorU32(ink(Tone::faint)), key.c_str());
  return isOpen;
}

bool Panels::drag(const char* name, double& value, float speed, const Range& range, const char* format) {
  std::array<char, 64> shown{};
  ImGui::DataTypeFormatString(shown.data(), static_cast<int>(shown.size()), ImGuiDataType_Double, &value, format);
  noteText(name, shown.data(), widthBesideLabel(name));
  return noted(name, ImGui::DragScalar(name, ImGuiDataType_Double, &value, speed, &range.min, &range.max, format,
                                       ImGuiSliderFlags_AlwaysClamp));
}

// Field for a length in the hand, with three digits; `text` replaces the number if it is not empty.
bool Panels::dragLength(const char* name, double& value_mm, double speed_mm, const Range& range_mm,
                        const ViewStatus& status, const char* text) {
  const auto& [perMm, unit] = status.lengths;
  const Range range{perMm * range_mm.min, perMm * range_mm.max};
  double value = perMm * value_mm;
  const double size = value > 0 ? value : range.max;
  const int decimals = std::clamp(kFewLengthDigits - 1 - static_cast<int>(std::floor(std::log10(size))), 0, 15);
  const std::string shown = unit.starts_with('%') ? "%% of model" : unit;  // shorter, so that it fits
  const std::string format = *text ? text : fmt::format("%.{}f {}", decimals, shown);
  const bool changed = drag(name, value, static_cast<float>(perMm * speed_mm), range, format.c_str());
  if (changed) value_mm = std::clamp(value / perMm, range_mm.min, range_mm.max);
  return changed;
}

// Text field, named by its hint unless it has another name. Returns whether Enter was pressed in it.
bool Panels::field(const char* hint, std::array<char, 512>& text, const char* name) {
  if (!name) name = hint;
  noteText(name, hint, ImGui::CalcItemWidth() - 2 * ImGui::GetStyle().FramePadding.x);
  ImGui::PushID(name);
  const bool entered =
      ImGui::InputTextWithHint("##text", hint, text.data(), text.size(), ImGuiInputTextFlags_EnterReturnsTrue);
  ImGui::PopID();
  return noted(name, entered);
}

bool Panels::beginList(const char* label, const char* shown) {
  noteText(label, shown, widthBesideLabel(label) - ImGui::GetFrameHeight() - ImGui::GetStyle().FramePadding.x);
  const bool isOpen = ImGui::BeginCombo(label, shown);
  if (!isOpen) noted(label, false);
  return isOpen;
}

bool Panels::chooseWord(const char* label, std::span<const std::string_view> words, std::size_t& chosen) {
  const std::size_t before = chosen;
  if (!beginList(label, chosen < words.size() ? words[chosen].data() : "")) return false;
  for (std::size_t k = 0; k < words.size(); ++k)
    if (noted(words[k], ImGui::Selectable(words[k].data(), k == before))) chosen = k;
  ImGui::EndCombo();
  return chosen != before;
}

ViewCommands Panels::draw(const ViewStatus& status, WindowSettings& settings) {
  ViewSettings& view = settings.view;
  places_.clear();
  cut_.clear();
  tools_.clear();
  messagesShare_ = 0;
  noteLetters(status);
  if (status.others && status.others->counts)
    link_.add(*status.others->counts);
  else
    link_.clear();
  helps_ = !view.help && !view.firstSteps;
  opens_ = std::exchange(view.opens, {});
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const bool isStart = !status.session && !status.loading;
  bottom_px_ = view.panels && status.session ? display.y - em(kStatus_em) : display.y;
  free_px_ = freeWidth_px(view, double{display.x});
  corner_px_ = {free_px_.y, double{bottom_px_}};
  if (isStart && !view.firstSteps) drawStart(status, view);
  if (view.panels && !isStart) drawPanel(status, settings);
  statusLine_.clear();
  if (view.panels && status.session) {
    drawTools(status, settings);
    drawStatusLine(status);
  }
  if (status.scaleBar) drawScale(*status.scaleBar, status.unit);
  for (const PictureLabel& label : status.measures) drawDistance(label);
  drawOutline(status.outline);
  drawBrushHint(status.brush);
  drawVolume(status.volume);
  if (status.legend) drawLegend(*status.legend);
  drawLabels(status.labels);
  if (view.panels && view.plots && status.session) drawPlots(status, view);
  drawErrors(status);
  view.help ? drawHelp(settings) : drawMessages(status, settings);
  if (view.firstSteps) drawFirstSteps(view);
  drawQuestions(status);
  drawFiles(status);
  return std::exchange(commands_, {});
}

void Panels::drawPanel(const ViewStatus& status, WindowSettings& settings) {
  const ImVec2 display = ImGui::GetIO().DisplaySize;
  const float width = std::min(em(kPanel_em), display.x - em(2 * kMargin_em));
  ImGui::SetNextWindowPos({display.x - width - em(kMargin_em), em(kMargin_em)});
  ImGui::SetNextWindowSizeConstraints({width, 0}, {width, bottom_px_ - em(2 * kMargin_em)});
  ImGui::Begin("palpate", nullptr,
               ImGuiWindowFlags_NoMove | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoTitleBar);
  constexpr float kPage = 0.8f;  // of the panel's height
  if (const int pages = std::exchange(settings.view.scrolls, 0); pages != 0)
    ImGui::SetScrollY(ImGui::GetScrollY() + static_cast<float>(pages) * kPage * ImGui::GetWindowHeight());
  ImGui::PushItemWidth(em(9.2));
  ImGui::PushTextWrapPos(0);
  drawModel(status);
  drawDevice(status);
  if (status.session) {
    drawTool(status, settings);
    drawClean(status, settings.clean);
    drawColor(status, settings);
    drawFeel(status, settings.feel, settings.forcesOn);
    drawMatter(status);
    drawOthers(status);
    drawLook(status, settings.view);
    drawMeasure(status, settings.view);
    drawSession(status);
  }
  ImGui::PopTextWrapPos();
  ImGui::PopItemWidth();
  ImGui::End();
}

void Panels::drawModel(const ViewStatus& status) {
  if (status.session) {
    const float room = ImGui::GetContentRegionAvail().x;
    ImGui::TextUnformatted(shortened(std::filesystem::path(status.model).filename().string(), room).c_str());
    help(status.model);
    post(button("Turn"), WindowCommand::turnModel);
    help("U: by 90 degrees, clockwise; up is " + status.orientationWhy);
    ImGui::SameLine();
    ImGui::TextDisabled("%s", status.orientation.c_str());
    const Model& model = status.session->model();
    const double side = model.container() ? model.container()->longestSide() : status.session->longestSide();
    ImGui::TextDisabled("feels %.3g mm long (%.3g %s)", model.scale.toMm(side), side, nameOf(status.unit).data());
    help("change it with --mm-per-unit or Measure; default: the file's scale, else the longest side is 100 mm");
  }
  if (status.loading) {
    ImGui::TextUnformatted(status.loadingWhat.c_str());
    // Where the progress is unknown, the bar shows that the work goes on.
    if (*status.loading == ViewStatus::kUnknown)
      ImGui::ProgressBar(static_cast<float>(std::fmod(ImGui::GetTime(), 1)), {-1, 0}, "");
    else
      ImGui::ProgressBar(static_cast<float>(*status.loading), {-1, 0});
    if (status.isStoppable) post(button("Cancel##reading"), WindowCommand::stopReading);
    if (status.isStoppable) help("Esc");
  }
  if (!header("Models")) return;
  if (button("Browse...")) browse(FileTask::open);
  help("Ctrl+O");
  post(fieldAndButton("file.ply", open_, "Open##file"), FileCommand{FileTask::open, open_.data()});
  const auto list = [&](std::span<const std::string> files) {
    for (const std::string& file : files) {
      ImGui::PushID(file.c_str());
      const std::string name = std::filesystem::path(file).filename().string();
      const std::string shown = shortened(name, ImGui::GetContentRegionAvail().x);
      post(noted(name, ImGui::Selectable(shown.c_str(), file == status.model)), FileCommand{FileTask::open, file});
      help(file);
      ImGui::PopID();
    }
  };
  list(status.models);
  if (!status.recent.empty()) ImGui::TextDisabled("recent");
  list(status.recent);
  for (const std::string& file : status.gone) {
    const std::string name = std::filesystem::path(file).filename().string();
    ImGui::TextDisabled("%s", shortened(name + " is missing", ImGui::GetContentRegionAvail().x).c_str());
    help(file + " no longer exists");
  }
}

void Panels::drawTool(const ViewStatus& status, WindowSettings& settings) {
  if (!header("Tool", true)) return;
  if (settings.tool == WindowTool::sculpt) drawBrush(status, settings.brush, settings.view), drawLayers(status);
  if (settings.tool == WindowTool::select) drawSelect(status, settings);
  const StrokeCounts counts = status.session->session().strokes();
  ImGui::BeginDisabled(counts.undoCount == 0);
  post(button("Undo", em(4)), ModelCommand::undo);
  ImGui::EndDisabled();
  help("Ctrl+Z: undoes the last stroke or change");
  ImGui::SameLine();
  ImGui::BeginDisabled(counts.redoCount == 0);
  post(button("Redo", em(4)), ModelCommand::redo);
  ImGui::EndDisabled();
  help("Ctrl+Shift+Z");
  ImGui::SameLine();
  ImGui::TextDisabled("%s", counted(counts.undoCount, "change").c_str());
}

void Panels::drawBrush(const ViewStatus& status, BrushSettings& brush, ViewSettings& view) {
  if (brush.sculpts) {
    dragLength("size", brush.radius_mm, 0.1, sliderOf<BrushConfig>("radius_mm"), status);
    help("radius of the brush; [ and ] change it, or F and a motion of the mouse");
    const bool isPush = brushHas(brush.kind, shared::kUsesPushRate);
    if (!isPush) drag("strength", brush.strength, 0.01f, sliderOf<BrushConfig>("strength"), "%.2f");
    if (!isPush) help("fraction of the effect per tick; 0: none, 1: all (Shift+F)");
    if (brushHas(brush.kind, shared::kMayBuildUp)) {
      checkbox("accumulate", brush.accumulate);
      help("raises the surface on where a stroke passes again, or rests; off: once, by as much as the stylus presses");
    }
    drawSymmetry(brush.symmetry);
    if (brushHas(brush.kind, shared::kPaintsPoints)) {
      float color[3];
      for (std::size_t k = 0; k < 3; ++k) color[k] = static_cast<float>(brush.color[k]) / 255;
      if (noted("colour to paint", ImGui::ColorEdit3("colour to paint", color, ImGuiColorEditFlags_NoInputs)))
        for (std::size_t k = 0; k < 3; ++k) brush.color[k] = static_cast<std::uint8_t>(std::lround(color[k] * 255));
    }
  }
  dragLength("depth", view.press_mm, 0.05, {0.1, 20}, status);
  help("target depth while the button is down; the wheel changes it");
  checkbox("follow the surface", view.followsSurface);
  help("off: the stylus moves in a plane parallel to the screen, and the wheel changes its depth");
  if (brush.sculpts && noted("more", ImGui::TreeNode("more"))) {
    const bool isPush = brushHas(brush.kind, shared::kUsesPushRate);
    if (isPush) drag("speed", brush.pushRate, 0.005f, sliderOf<BrushConfig>("push_rate"), "%.2f");
    if (isPush) help("fraction of the path to the stylus by which the surface yields per tick");
    if (!brushHas(brush.kind, shared::kHasShaft)) {
      choose("falloff", kFalloffs, brush.falloff);
      help("how the effect decreases towards the rim: not at all, or as (1 - r^2) to the power of 1, 2 or 5");
    }
    drag("steady", view.string_px, 0.5f, {0, 200}, "%.0f px");
    help("steadies strokes of the mouse: it pulls the stylus by a string of this length; 0: it does not");
    dragLength("resistance", brush.yieldDepth_mm, 0.02, sliderOf<BrushConfig>("yield_depth_mm"), status);
    help("depth of the stylus below the surface from which the surface yields");
    ImGui::TreePop();
  }
}

void Panels::drawSymmetry(std::string& symmetry) {
  constexpr std::array<std::string_view, 4> kAxes{"off", "x", "y", "z"};
  std::size_t chosen = symmetry.empty() ? 0 : kAxes.size();
  for (std::size_t k = 1; k < kAxes.size(); ++k)
    if (symmetry == kAxes[k]) chosen = k;
  const bool isPlane = chosen == kAxes.size();
  std::vector<std::string_view> words(kAxes.begin(), kAxes.end());
  if (isPlane) words.emplace_back("plane");
  if (chooseWord("symmetry", words, chosen) && chosen < kAxes.size())
    symmetry = chosen == 0 ? std::string() : std::string(kAxes[chosen]);
  help(
      "each edit is also made mirrored, at the plane through the middle of the model; for another plane: Select, "
      "plane (D), Mirror here");
}

void Panels::drawFeel(const ViewStatus& status, FeelSettings& feel, bool& forcesOn) {
  if (!header("Feel")) return;
  checkbox("forces on", forcesOn);
  help("Backspace");
  choose("surface", kSurfaceKinds, feel.surface);
  help("average: fastest; sphere: sinks in less on curved surfaces; sharp: keeps edges");
  drag("stiffness", feel.stiffness_N_per_mm, 0.01f, sliderOf<ForceOptions>("stiffness_N_per_mm"), "%.2f N/mm");
  help("force per mm of depth in the surface, measured in the hand");
  drag("hand gain", feel.handGain, 0.005f, sliderOf<ForceOptions>("hand_gain"), "%.2f");
  help("motion of the stylus for a motion of the device in the hand; G: 1, 1/2, 1/4");
  drag("friction", feel.friction, 0.01f, sliderOf<SurfaceConfig>("friction"), "%.2f");
  help("0: no friction; from 1 on the stylus hardly slides");
  if (!noted("more", ImGui::TreeNode("more##feel"))) return;
  if (status.session->backendName() == "vulkan") choose("query", builtMethods(), feel.method);
  drag("damping", feel.damping_N_s_per_mm, 0.0001f, sliderOf<ForceOptions>("damping_N_s_per_mm"), "%.4f N s/mm");
  drag("maximum force", feel.maxForce_N, 0.02f, sliderOf<ForceOptions>("max_N"), "%.2f N");
  ImGui::TextDisabled("%s", status.session->session().machine().c_str());
  ImGui::TreePop();
}

void Panels::drawMatter(const ViewStatus& status) {
  if (status.parameters.empty() || !header("Matter", true)) return;
  post(button(status.simulationPaused ? "Continue##matter" : "Pause##matter", em(4)), ModelCommand::pause);
  help("K");
  ImGui::SameLine();
  post(button("Restart"), ModelCommand::restart);
  help("N");
  for (const SimulationParameter& parameter : status.parameters) {
    double value = parameter.value;
    const auto speed = static_cast<float>((parameter.high - parameter.low) / 1000);
    if (drag(parameter.label.c_str(), value, speed, {parameter.low, parameter.high},
             ("%.4g " + parameter.unit).c_str()))
      commands_.emplace_back(SetParameter{parameter.name, value});
    help("takes effect at the next step");
  }
}

void Panels::drawSession(const ViewStatus& status) {
  if (!header("Save and record")) return;
  const WindowSession& session = *status.session;
  ImGui::BeginDisabled(!status.mayBeSaved);
  post(button("Save"), ModelCommand::save);
  ImGui::EndDisabled();
  help("writes " + status.saveFile);
  ImGui::SameLine();
  if (session.isSaving())
    ImGui::TextDisabled("saving...");
  else
    ImGui::TextDisabled("%s", status.isChanged ? "changed" : status.mayBeSaved ? "not saved" : "as in the file");
  const auto isThere = [](const char* file) {
    std::error_code ignored;
    return file[0] != 0 && std::filesystem::exists(file, ignored);
  };
  const std::string where = "a name without a folder is in " + std::filesystem::current_path().string();
  const bool replaces = isThere(saveAs_.data());
  const char* const does = replaces ? "Replace" : "Save as";
  ImGui::SetNextItemWidth(roomBeside(does));
  const bool entered = field("other.ply", saveAs_);
  help(where);
  ImGui::SameLine();
  post((button(does) || (entered && !replaces)), FileCommand{FileTask::saveAs, saveAs_.data()});
  if (replaces) ImGui::TextWrapped("%s", whatIsReplaced(saveAs_.data(), status).c_str());
  if (button("Save to...")) browse(FileTask::saveAs);
  help("Ctrl+Shift+S");
  ImGui::SetNextItemWidth(roomBeside("Record") + roomBeside("Play") - ImGui::GetContentRegionAvail().x);
  field("session.log", log_);
  help(where);
  ImGui::SameLine();
  if (session.isRecording()) {
    post(button("Stop##record"), ModelCommand::endRecording);
    help("ends the recording");
  } else {
    const bool isThereLog = isThere(log_.data());
    ImGui::BeginDisabled(isThereLog);
    post(button("Record"), FileCommand{FileTask::record, log_.data()});
    ImGui::EndDisabled();
    help(isThereLog ? "this file exists: Play plays it" : "records the hand; Play, or palpate replay, runs it again");
  }
  ImGui::SameLine();
  if (session.isPlaying()) {
    post(button("Stop##play"), ModelCommand::endPlaying);
  } else {
    post(button("Play"), FileCommand{FileTask::play, log_.data()});
  }
}

}  // namespace palpate
