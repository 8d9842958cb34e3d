#include "apps/view/window_state.hpp"

#include <algorithm>
#include <array>
#include <map>

#include "apps/cli/sharing_results.hpp"
#include "apps/view/theme.hpp"
#include "engine/core/statistics.hpp"

namespace palpate {

namespace {

using Value = std::optional<Json>;

std::string_view nameIn(const auto& names, auto value) {
  for (const auto& [name, each] : names)
    if (value == each) return name;
  return {};
}

std::string_view toolOf(const BrushSettings& brush) { return brush.sculpts ? traitsOf(brush.kind).name : "feel"; }

Json toolsOf(const Panels& panels) {
  Json all = Json::array();
  for (const Panels::Tool& tool : panels.tools())
    all.push_back({{"name", tool.name},
                   {"key", tool.key},
                   {"on", tool.isOn},
                   {"in_view", panels.placeOf(tool.name).has_value()}});
  return all;
}

constexpr Reported<PlaceInfo> kPicked[]{
    {"place", "model units", "picked position", [](const PlaceInfo& p) -> Value { return vectorJson(p.place); }},
    {"point", "", "number of the nearest point; null: the model moves",
     [](const PlaceInfo& p) -> Value { return orNull(p.point); }},
    {"position", "model units", "its position", [](const PlaceInfo& p) -> Value { return vectorJson(p.position); }},
    {"normal", "", "its normal", [](const PlaceInfo& p) -> Value { return vectorJson(p.normal); }},
    {"attributes", "", "its other attributes, by name, as in the file",
     [](const PlaceInfo& p) -> Value {
       Json attributes = Json::object();
       for (const auto& [name, value] : p.attributes) attributes[name] = value;
       return attributes;
     }},
    {"stiffness_N_per_mm", "N/mm", "stiffness that a hand feels there; null: unknown",
     [](const PlaceInfo& p) -> Value { return orNull(p.stiffness_N_mm); }},
    {"stiffness_of", "", "what has this stiffness", field<&PlaceInfo::stiffnessOf>},
};

Json layersOf(const StrokeLayers& layers) {
  Json all = Json::array();
  for (std::uint32_t i = 0; i < layers.size(); ++i)
    if (!layers[i].isMerged)
      all.push_back({{"name", layers[i].name},
                     {"strength", layers[i].strength},
                     {"hidden", layers[i].isHidden},
                     {"open", layers.open() == i},
                     {"points", layers.pointsOf(i)}});
  return all;
}

Json offersOf(const HeldDevice& held) {
  Json offers = Json::array();
  if (held.around())
    for (const DeviceSurvey& kind : *held.around())
      for (const DeviceOffer& offer : kind.offers)
        offers.push_back({{"device", offer.device}, {"name", offer.name}, {"state", offer.state}, {"fix", offer.mend}});
  return offers;
}

Json missingOf(const HeldDevice& held) {
  Json missing = Json::array();
  if (held.around())
    for (const DeviceSurvey& kind : *held.around())
      if (!kind.missing.empty()) missing.push_back({{"device", kind.kind}, {"reason", kind.missing}});
  return missing;
}

template <class Of>
Value ofOpened(const HeldDevice& held, Of&& of) {
  const OpenedDevice* const opened = held.opened();
  return opened ? Value(of(*opened)) : std::nullopt;
}

template <class Of>
Value ofSeen(const HeldDevice& held, Of&& of) {
  const std::optional<DeviceState> seen = held.state();
  return seen ? Value(of(*seen)) : std::nullopt;
}

constexpr Reported<HeldDevice> kDevice[]{
    {"name", "", "device as in --device, or mouse", [](const HeldDevice& h) -> Value { return h.name(); }},
    {"stage", "", "mouse, opening, held or tested",
     [](const HeldDevice& h) -> Value {
       constexpr std::array<std::string_view, 4> kNames{"mouse", "opening", "held", "tested"};
       return kNames[static_cast<std::size_t>(h.stage())];
     }},
    {"said", "", "the newest message about it", [](const HeldDevice& h) -> Value { return h.said(); }},
    {"instruction", "", "of the guided test",
     [](const HeldDevice& h) -> Value { return h.test() ? instructionOf(h.test()->stage()) : ""; }},
    {"offers", "", "devices that are plugged in: device, name, state and fix",
     [](const HeldDevice& h) -> Value { return offersOf(h); }},
    {"missing", "", "kinds of devices of which none was found, each with device and reason",
     [](const HeldDevice& h) -> Value { return missingOf(h); }},
    {"model", "", "its model",
     [](const HeldDevice& h) -> Value { return ofOpened(h, [](const auto& o) { return o.facts.model; }); }},
    {"serial", "", "its serial number",
     [](const HeldDevice& h) -> Value { return ofOpened(h, [](const auto& o) { return o.facts.serial; }); }},
    {"axes", "", "its axes, as in --axes",
     [](const HeldDevice& h) -> Value { return ofOpened(h, [](const auto& o) { return o.axes.text(); }); }},
    {"remembered", "", "settings that are remembered for it",
     [](const HeldDevice& h) -> Value { return ofOpened(h, [](const auto& o) { return o.remembered.inWords(); }); }},
    {"position_mm", "mm", "its position, as the last tick read it",
     [](const HeldDevice& h) -> Value { return ofSeen(h, [](const auto& s) { return vectorJson(s.position); }); }},
    {"buttons", "", "its pressed buttons, one bit each",
     [](const HeldDevice& h) -> Value { return ofSeen(h, [](const auto& s) { return s.buttons; }); }},
    {"renders_force", "", "whether it renders forces",
     [](const HeldDevice& h) -> Value { return ofSeen(h, [](const auto& s) { return s.rendersForce; }); }},
    {"found_stiffness_N_per_mm", "N/mm", "stiffness that the guided test recommends; null: none",
     [](const HeldDevice& h) -> Value {
       return h.found() ? Value(orNull(h.found()->offeredStiffness_N_per_mm())) : std::nullopt;
     }},
};

Json middleOf(const std::deque<float>& times_ms) {
  const Summary all = summarize({times_ms.begin(), times_ms.end()});
  return {{"n", all.count}, {"p50", all.p50}, {"p99", all.p99}};
}

constexpr Reported<WindowState> kWindow[]{
    {"model", "", "open model; null: none",
     [](const WindowState& w) -> Value { return w.session() ? Json(w.document.file()) : Json(nullptr); }},
    {"points", "", "its present points",
     [](const WindowState& w) -> Value { return w.session() ? Json(w.session()->presentPoints()) : Json(0); }},
    {"camera.eye", "model units", "position of the camera",
     [](const WindowState& w) -> Value { return vectorJson(w.camera.eye); }},
    {"camera.target", "model units", "position that it looks at",
     [](const WindowState& w) -> Value { return vectorJson(w.camera.target); }},
    {"camera.up", "", "direction that is up in the picture",
     [](const WindowState& w) -> Value { return vectorJson(w.camera.up); }},
    {"camera.text", "", "all that for palpate render --camera, in the coordinates of the file; null without a model",
     [](const WindowState& w) -> Value {
       const WindowSession* const session = w.document.shown();
       return session ? Json(textOf(w.camera, session->model().cloud.origin)) : Json(nullptr);
     }},
    {"camera.ortho", "model units", "height of the orthographic picture; null: it has perspective",
     [](const WindowState& w) -> Value { return w.camera.isOrthographic() ? Json(w.camera.height) : Json(nullptr); }},
    {"size", "px", "width and height of the window",
     [](const WindowState& w) -> Value {
       return Json{w.size_px.x, w.size_px.y};
     }},
    {"scale", "", "pixels per unit of the panels: of the screen, times the size of text", field<&WindowState::scale>},
    {"tool", "", "brush, or feel; null: no model is open",
     [](const WindowState& w) -> Value {
       return w.session() ? Json(toolOf(w.session()->brushSettings())) : Json(nullptr);
     }},
    {"brush.radius_mm", "mm", "radius of the chosen brush",
     [](const WindowState& w) -> Value { return w.brush.radius_mm; }},
    {"brush.strength", "", "its strength", [](const WindowState& w) -> Value { return w.brush.strength; }},
    {"brush.push_rate", "", "its push rate", [](const WindowState& w) -> Value { return w.brush.pushRate; }},
    {"brush.symmetry", "", "the plane at which it is mirrored, as in --symmetry; empty: it is not",
     [](const WindowState& w) -> Value { return w.brush.symmetry; }},
    {"brush.words", "", "what keys or a drag make of it, as shown at the cursor; empty: nothing",
     [](const WindowState& w) -> Value { return w.brushHint.words; }},
    {"brush.ring", "px", "corners of its ring on the surface under the cursor; empty: it is not shown",
     [](const WindowState& w) -> Value {
       Json corners = Json::array();
       for (const DVec2& corner : w.brushHint.ring_px) corners.push_back({corner.x, corner.y});
       return corners;
     }},
    {"mouse", "", "what the mouse does: sculpting, selecting or looking",
     [](const WindowState& w) -> Value { return nameOf(kWindowTools, w.tool); }},
    {"selection.shape", "", "how it selects",
     [](const WindowState& w) -> Value { return nameOf(kSelectShapes, w.select.shape); }},
    {"selection.through", "", "also behind the first surface",
     [](const WindowState& w) -> Value { return w.select.through; }},
    {"selection.brush_mm", "mm", "radius of its brush",
     [](const WindowState& w) -> Value { return w.select.brush_mm; }},
    {"selection.where_error", "", "what is wrong with the condition of the last selection; empty: nothing",
     [](const WindowState& w) -> Value { return w.whereError; }},
    {"selection.drawn", "", "whether an outline is being drawn", field<&WindowState::draws>},
    {"selection.volume", "",
     "numbers of the box, ball or plane, as the panel shows them; empty: none, or a rotated box",
     [](const WindowState& w) -> Value { return w.volume.numbers; }},
    {"selection.handles", "px", "positions of its handles",
     [](const WindowState& w) -> Value {
       Json places = Json::array();
       for (const DrawnVolume::Knob& knob : w.volume.knobs) places.push_back({knob.place_px.x, knob.place_px.y});
       return places;
     }},
    {"selection.selected", "", "existing points that are selected and shown",
     [](const WindowState& w) -> Value { return w.selection.selected; }},
    {"selection.hidden", "", "existing points that are hidden",
     [](const WindowState& w) -> Value { return w.selection.hidden; }},
    {"selection.locked_in_part", "", "of the locked points, those that are locked in part",
     [](const WindowState& w) -> Value { return w.selection.inPart; }},
    {"selection.locked", "", "existing points that are locked, also in part",
     [](const WindowState& w) -> Value { return w.selection.locked; }},
    {"selection.within", "", "existing points that brushes may change, if not all",
     [](const WindowState& w) -> Value { return w.selection.within; }},
    {"layers", "", "layers of strokes that are not merged, each with name, strength, hidden, open and points",
     [](const WindowState& w) -> Value {
       return w.session() ? layersOf(w.session()->attributes().strokeLayers()) : Json::array();
     }},
    {"stylus", "", "whether the mouse holds the stylus", field<&WindowState::stylus>},
    {"mesh_triangles", "", "triangles shown in place of the points", field<&WindowState::meshTriangles>},
    {"fps", "1/s", "pictures per second", [](const WindowState& w) -> Value { return w.pace.fps(); }},
    {"picture_ms", "ms", "frames of the window in which the model was drawn, the last 300",
     [](const WindowState& w) -> Value { return middleOf(w.pace.times_ms()); }},
    {"mouse_to_picture_ms", "ms",
     "from the oldest motion of the mouse that a picture of the model shows first, until it is finished; the last 300",
     [](const WindowState& w) -> Value { return middleOf(w.pace.mouseToPicture_ms()); }},
    {"passes_ms", "ms", "passes of the model's last picture on the GPU",
     [](const WindowState& w) -> Value {
       std::map<std::string, double> sums_ms;
       for (const PassRecord& pass : w.passes) sums_ms[pass.name] += 1e-3 * pass.gpu_us;
       Json passes = Json::object();
       for (const auto& [name, sum_ms] : sums_ms) passes[name] = sum_ms;
       return passes;
     }},
    {"pictures", "", "pictures so far", [](const WindowState& w) -> Value { return w.pace.count(); }},
    {"pictures_of_model", "", "of them, pictures for which the model was drawn again",
     field<&WindowState::picturesOfModel>},
    {"cameras_shown", "", "cameras drawn in the picture", field<&WindowState::camerasShown>},
    {"measured", "model units", "the chosen distance; null: none",
     [](const WindowState& w) -> Value {
       const MeasuredDistance* const distance = w.session() ? w.measure.chosen() : nullptr;
       return distance ? Json(distance->length()) : Json(nullptr);
     }},
    {"distances", "model units", "measured distances of the model, by name",
     [](const WindowState& w) -> Value {
       Json distances = Json::object();
       for (const MeasuredDistance& distance : w.measure.distances()) distances[distance.name] = distance.length();
       return distances;
     }},
    {"picked", "", "the last picked position; null: none",
     [](const WindowState& w) -> Value { return orNull(partBy(kPicked, w.picked)); }},
    {"picked_depth", "model units", "depth of the model under the cursor; 0: none", field<&WindowState::pickedDepth>},
    {"loading", "", "share of the model that is being opened, 0 to 1; null: none is",
     [](const WindowState& w) -> Value {
       const Loader& loader = w.document.loader();
       return loader.isLoading() ? Json(loader.progress()) : Json(nullptr);
     }},
    {"waits", "", "why strokes are refused until another session answers; empty: they are not",
     [](const WindowState& w) -> Value { return w.document.isGivingWay() ? w.document.whyWaiting() : ""; }},
    {"asks_about_changes", "", "whether a question about unsaved changes is shown",
     [](const WindowState& w) -> Value { return w.document.asksAboutChanges(); }},
    {"question", "", "its text", [](const WindowState& w) -> Value { return w.document.changesQuestion(); }},
    {"asks_how_to_save", "", "whether a question about the file to save to is shown",
     [](const WindowState& w) -> Value { return w.document.saveQuestion().has_value(); }},
    {"asks_about_memory", "", "whether a question about a file that needs more memory than is free is shown",
     [](const WindowState& w) -> Value { return w.document.memoryQuestion().has_value(); }},
    {"asks_about_strokes", "", "whether a question about unsaved strokes of an earlier program is shown",
     [](const WindowState& w) -> Value { return w.document.leftQuestion().has_value(); }},
    {"strokes_left", "", "number of these strokes",
     [](const WindowState& w) -> Value {
       const auto question = w.document.leftQuestion();
       return question ? Json(question->strokes.made) : Json(nullptr);
     }},
    {"strokes_undone", "", "number of undone strokes among them that the saved file contains",
     [](const WindowState& w) -> Value {
       const auto question = w.document.leftQuestion();
       return question ? Json(question->strokes.undone) : Json(nullptr);
     }},
    {"strokes_waiting", "", "number of further programs whose unsaved strokes are asked about next",
     [](const WindowState& w) -> Value {
       const auto question = w.document.leftQuestion();
       return question ? question->waiting : 0;
     }},
    {"last_message", "", "the last message, also when it is no longer shown",
     [](const WindowState& w) -> Value { return w.messages.last(); }},
    {"messages", "", "shown messages", [](const WindowState& w) -> Value { return w.messages.remarks(); }},
    {"notices", "", "messages shown as long as they are true: forces off, saving", field<&WindowState::notices>},
    {"blocked", "", "why nothing under the pressed brush moves: too thin here, or no room here; empty: it moves",
     [](const WindowState& w) -> Value { return w.blocked; }},
    {"errors", "", "shown errors", [](const WindowState& w) -> Value { return w.messages.errors(); }},
    {"status_line", "", "text of the status line; empty: it is not shown",
     [](const WindowState& w) -> Value { return w.panels.statusLine(); }},
    {"cut_off", "", "names of the controls in the panels whose text has no room",
     [](const WindowState& w) -> Value {
       return std::vector<std::string>(w.panels.cut().begin(), w.panels.cut().end());
     }},
    {"tools", "", "the column of tools, each with name, key, on, and whether it is in view",
     [](const WindowState& w) -> Value { return toolsOf(w.panels); }},
    {"messages_share", "%", "part of the area of the model that messages and errors cover",
     [](const WindowState& w) -> Value { return 100 * w.panels.messagesShare(); }},
    {"theme", "", "dark or light", [](const WindowState& w) -> Value { return nameOf(kThemes, w.view.dark); }},
    {"text_size", "%", "size of the panels and their text",
     [](const WindowState& w) -> Value { return w.view.text_percent; }},
    {"help", "", "whether the help is shown", [](const WindowState& w) -> Value { return w.view.help; }},
    {"first_steps", "", "whether the first steps are shown",
     [](const WindowState& w) -> Value { return w.view.firstSteps; }},
    {"panels", "", "whether the panels are shown", [](const WindowState& w) -> Value { return w.view.panels; }},
    {"measuring", "", "whether the left button picks positions",
     [](const WindowState& w) -> Value { return w.view.measures; }},
    {"device", "", "the device that moves the stylus",
     [](const WindowState& w) -> Value { return jsonBy(kDevice, w.held); }},
};

// Texts, since numbers of JSON have no 64 bits.
Json fieldJson(const ColoredField& field, const ColorConfig& color) {
  const auto [low, high] = field.range(color);
  const FieldStatistics& all = field.statistics();
  return {{"low", field.text(low)},     {"high", field.text(high)},   {"in_range", field.countIn({low, high})},
          {"count", all.count},         {"missing", field.missing()}, {"min", field.text(all.min)},
          {"max", field.text(all.max)}, {"mean", field.meanText()},   {"median", field.text(all.percentiles[3])},
          {"deviation", all.deviation}};
}

// What is said only of an open model.
struct OpenModel {
  const WindowSession& session;
  const Document& document;
  const ViewSettings& view;
  const ColoredField* field;
  TraceRow tick;  // the last one
};

constexpr Reported<OpenModel> kModel[]{
    {"mm_per_unit", "mm", "touch scale: millimetres in the hand per unit",
     [](const OpenModel& m) -> Value { return m.session.model().scale.mm_per_unit; }},
    {"surface", "", "felt surface",
     [](const OpenModel& m) -> Value { return nameIn(kSurfaceKinds, m.session.feel().surface); }},
    {"stiffness_N_per_mm", "N/mm", "stiffness of the contact",
     [](const OpenModel& m) -> Value { return m.session.feel().stiffness_N_per_mm; }},
    {"hand_gain", "", "motion of the stylus for a motion of the device",
     [](const OpenModel& m) -> Value { return m.session.feel().handGain; }},
    {"up", "", "up axis", [](const OpenModel& m) -> Value { return nameOf(m.view.upOf(m.session.model())); }},
    {"color", "", "what the points are coloured by: rgb, material, normal, depth, height, or a field",
     [](const OpenModel& m) -> Value { return m.view.color.by; }},
    {"color_map", "", "colours of numbers",
     [](const OpenModel& m) -> Value { return nameOf(kColorMaps, m.view.color.mapOf()); }},
    {"color_field", "", "numbers of the field that colours the points, of those that are shown; null: none does",
     [](const OpenModel& m) -> Value { return m.field ? Json(fieldJson(*m.field, m.view.color)) : Json(nullptr); }},
    {"brush_radius_mm", "mm", "radius of the brush",
     [](const OpenModel& m) -> Value { return m.session.brushSettings().radius_mm; }},
    {"parameters", "", "parameters of a simulation, by name",
     [](const OpenModel& m) -> Value {
       const SimulationControl* const simulation = m.session.session().simulation();
       if (!simulation) return std::nullopt;
       Json all;
       for (const SimulationParameter& parameter : simulation->parameters()) all[parameter.name] = parameter.value;
       return all.is_null() ? std::nullopt : Value(all);
     }},
    {"shared", "", "exchange with the other participants of a joined session",
     [](const OpenModel& m) -> Value {
       return m.session.session().shared() ? Value(toJson(m.session.session().shared()->counts())) : std::nullopt;
     }},
    {"shared.silent_s", "s", "time since the last message",
     [](const OpenModel& m) -> Value {
       return m.session.session().shared() ? Value(m.session.session().shared()->counts().silent_s) : std::nullopt;
     }},
    {"partial", "", "points streamed around the hand (--partial)",
     [](const OpenModel& m) -> Value {
       if (!m.session.session().far()) return std::nullopt;
       return toJson(
           FarReport{.counts = m.session.session().far()->counts(), .ticks = m.session.session().unknownTicks()});
     }},
    {"other_hands", "", "hands of the other participants of a joined session",
     [](const OpenModel& m) -> Value {
       return m.session.session().presence() ? Value(toJson(m.session.session().presence()->hands())) : std::nullopt;
     }},
    {"other_cameras", "", "their cameras",
     [](const OpenModel& m) -> Value {
       return m.session.session().presence() ? Value(toJson(m.session.session().presence()->cameras())) : std::nullopt;
     }},
    {"strokes", "", "strokes made", [](const OpenModel& m) -> Value { return m.session.session().strokes().strokes; }},
    {"undo_count", "", "strokes that can be undone",
     [](const OpenModel& m) -> Value { return m.session.session().strokes().undoCount; }},
    {"edits", "", "changes of points so far", [](const OpenModel& m) -> Value { return m.session.edits(); }},
    {"changed", "", "whether the model differs from what was loaded or saved last",
     [](const OpenModel& m) -> Value { return m.document.isChanged(); }},
    {"save_file", "", "file that it is saved to", [](const OpenModel& m) -> Value { return m.document.saveFile(); }},
    {"recording", "", "whether a session log is recorded",
     [](const OpenModel& m) -> Value { return m.session.isRecording(); }},
    {"hip", "model units", "HIP of the last tick", [](const OpenModel& m) -> Value { return vectorJson(m.tick.hip); }},
    {"proxy", "model units", "its proxy", [](const OpenModel& m) -> Value { return vectorJson(m.tick.proxy); }},
    {"contact", "", "whether it is in contact", [](const OpenModel& m) -> Value { return m.tick.contact; }},
    {"penetration_mm", "mm", "its penetration", [](const OpenModel& m) -> Value { return m.tick.penetration_mm; }},
    {"force_N", "N", "its force", [](const OpenModel& m) -> Value { return vectorJson(m.tick.force_N); }},
    {"peak_force_N", "N", "largest force of the last ticks",
     [](const OpenModel& m) -> Value {
       double peak_N = 0;
       for (const TraceRow& row : m.session.recentTicks().rows()) peak_N = std::max(peak_N, glm::length(row.force_N));
       return peak_N;
     }},
    {"ticks", "", "ticks so far", [](const OpenModel& m) -> Value { return m.session.recentTicks().ticks(); }},
    {"missed_ticks", "", "ticks skipped because their time had passed",
     [](const OpenModel& m) -> Value { return m.session.recentTicks().missed(); }},
    {"step_us.p50", "us", "time from pose read to force ready, median",
     [](const OpenModel& m) -> Value { return m.session.recentTicks().step_us().quantile_us(0.5); }},
    {"step_us.p999", "us", "its 99.9th percentile",
     [](const OpenModel& m) -> Value { return m.session.recentTicks().step_us().quantile_us(0.999); }},
    {"forces_on", "", "whether forces are on", [](const OpenModel& m) -> Value { return m.session.forcesOn(); }},
    {"backend", "", "back end that answers", [](const OpenModel& m) -> Value { return m.session.backendName(); }},
};

}  // namespace

Json toJson(const WindowState& state) {
  Json json = jsonBy(kWindow, state);
  if (const WindowSession* const session = state.session()) {
    const auto& rows = session->recentTicks().rows();
    addBy(json, kModel,
          OpenModel{*session, state.document, state.view, state.field, rows.empty() ? TraceRow{} : rows.back()});
  }
  return json;
}

void listWindowResults(std::vector<ResultFacts>& all) {
  const auto list = [&](std::string_view before, const auto& rows) { listResults(all, "view", before, rows); };
  list("", kWindow);
  list("picked.", kPicked);
  list("device.", kDevice);
  list("", kModel);
  listSharingResults(all, "view");
  listCameraResults(all, "view");
}

}  // namespace palpate
