// The part of Viewer that reports its state: to the panels, and to a script.
#include <algorithm>
#include <array>

#include "apps/cli/picture.hpp"
#include "apps/cli/presence_json.hpp"
#include "apps/view/viewer.hpp"
#include "engine/core/atomic_file.hpp"

namespace palpate {

namespace {

std::string_view nameIn(const auto& names, auto value) {
  for (const auto& [name, each] : names)
    if (value == each) return name;
  return {};
}

// The other participants of the joined session.
Json othersOf(const WindowSession& session) {
  Json others = Json::object();
  if (const SharedFollower* const shared = session.shared()) {
    const SharedCounts counts = shared->counts();
    others = {{"sent", counts.sent},
              {"received", counts.received},
              {"delivered", counts.delivered},
              {"same", counts.same},
              {"silent_s", counts.silent_s},
              {"age_s", counts.age_s},
              {"force_share", counts.force},
              {"round_trip_ms", counts.link.roundTrip_ms ? Json(*counts.link.roundTrip_ms) : Json(nullptr)},
              {"lost_percent", counts.link.lost_percent ? Json(*counts.link.lost_percent) : Json(nullptr)}};
  }
  if (const FarCloud* const far = session.far()) others["restarts"] = far->counts().restarts;
  others["hands"] = toJson(session.presence()->hands());
  others["cameras"] = toJson(session.presence()->cameras());
  return others;
}

void addModel(Json& state, const Document& document, const ViewSettings& view) {
  const WindowSession& session = *document.session();
  const TickHistory& history = session.history();
  const TraceRow row = history.rows().empty() ? TraceRow{} : history.rows().back();
  const Journal& journal = session.journal();
  const BrushSettings& brush = session.brushSettings();
  state["model"] = document.file();
  state["mm_per_unit"] = session.model().scale.mm_per_unit;
  state["points"] = journal.present();
  state["tool"] = brush.kind ? nameIn(kBrushKinds, *brush.kind) : "feel";
  state["surface"] = nameIn(kSurfaceKinds, session.feel().surface);
  state["up"] = nameOf(view.upOf(session.model()));
  state["color"] = nameIn(kColorNames, view.color);
  state["brush_radius_mm"] = brush.radius_mm;
  if (const SimulationControl* const simulation = session.simulation())
    for (const SimulationParameter& parameter : simulation->parameters())
      state["parameters"][parameter.name] = parameter.value;
  if (session.presence()) state["others"] = othersOf(session);
  state["strokes"] = session.strokes().strokes;
  state["undo_count"] = session.strokes().undoCount;
  state["edits"] = session.edits();
  state["changed"] = session.isChanged();
  state["save_file"] = document.saveFile();
  state["recording"] = session.isRecording();
  state["hip"] = vectorJson(row.hip);
  state["proxy"] = vectorJson(row.proxy);
  state["contact"] = row.contact;
  state["penetration_mm"] = row.penetration_mm;
  state["force_N"] = vectorJson(row.force_N);
  double peak_N = 0;
  for (const TraceRow& each : history.rows()) peak_N = std::max(peak_N, glm::length(each.force_N));
  state["peak_force_N"] = peak_N;
  state["ticks"] = history.ticks();
  state["missed_ticks"] = history.missed();
  state["step_us"] = {{"p50", history.step_us().quantile_us(0.5)}, {"p999", history.step_us().quantile_us(0.999)}};
  state["forces_on"] = session.forcesOn();
  state["backend"] = session.backendName();
}

std::string_view nameOf(HeldDevice::Stage stage) {
  constexpr std::array<std::string_view, 4> kNames{"mouse", "opening", "held", "tested"};
  return kNames[static_cast<std::size_t>(stage)];
}

Json toJson(const HeldDevice& held) {
  Json json{{"name", held.name()},
            {"stage", nameOf(held.stage())},
            {"said", held.said()},
            {"instruction", held.test() ? instructionOf(held.test()->stage()) : ""},
            {"offers", Json::array()}};
  if (held.offers())
    for (const DeviceOffer& offer : *held.offers())
      json["offers"].push_back(
          {{"device", offer.device}, {"name", offer.name}, {"state", offer.state}, {"fix", offer.mend}});
  if (const OpenedDevice* const opened = held.opened()) {
    json["model"] = opened->facts.model;
    json["serial"] = opened->facts.serial;
    json["axes"] = opened->axes.text();
    json["remembered"] = opened->remembered.inWords();
  }
  if (const auto seen = held.state()) {
    json["position_mm"] = vectorJson(seen->position);
    json["buttons"] = seen->buttons;
    json["renders_force"] = seen->rendersForce;
  }
  if (held.found()) {
    const auto stiffness = held.found()->offeredStiffness_N_per_mm();
    json["found_stiffness_N_per_mm"] = stiffness ? Json(*stiffness) : Json(nullptr);
  }
  return json;
}

Json toJson(const PlaceInfo& info) {
  Json attributes = Json::object();
  for (const auto& [name, value] : info.attributes) attributes[name] = value;
  return {{"place", vectorJson(info.place)},
          {"point", info.point ? Json(*info.point) : Json(nullptr)},
          {"position", vectorJson(info.position)},
          {"normal", vectorJson(info.normal)},
          {"attributes", attributes},
          {"stiffness_N_per_mm", info.stiffness_N_mm ? Json(*info.stiffness_N_mm) : Json(nullptr)},
          {"stiffness_of", info.stiffnessOf}};
}

}  // namespace

// The bar is drawn with the panels: in the model's picture it would be coarse while something moves.
ViewStatus::ScaleBar Viewer::scaleOfPicture() const {
  const PictureSize size{screen_.size_px().x, screen_.size_px().y};
  const double length = scaleBarLength(viewpoint_.camera(), size);
  const double width_px = length * viewpoint_.camera().focal_px(size.height) / viewpoint_.targetDistance();
  return {.width_px = width_px, .length = length};
}

std::optional<DVec2> Viewer::middleOfMeasure_px() const {
  if (!measure_.distance()) return std::nullopt;
  const DVec3 middle = 0.5 * (measure_.places()[0] + measure_.places()[1]);
  const auto at = viewpoint_.camera().project(middle, DVec2(screen_.size_px()));
  return at ? std::optional(DVec2(*at)) : std::nullopt;
}

// placeInfo() iterates over all points: called only once per picked position.
void Viewer::findPlaceInfo() {
  if (!document_.session() || measure_.places().empty()) picked_.info.reset();
  if (picked_.version == measure_.version() || !document_.session()) return;
  picked_.version = measure_.version();
  if (!measure_.places().empty()) picked_.info = placeInfo(*document_.session(), measure_.places().back());
}

ViewStatus Viewer::status() {
  const ViewSettings& view = settings_.view;
  const WindowSession* session = document_.session();
  const Loader& loader = document_.loader();
  ViewStatus status;
  status.session = session;
  if (loader.isLoading()) {
    status.loading = loader.progress();
    status.loadingWhat = loader.stage();
  }
  status.remarks = messages_.remarks();
  status.errors = messages_.errors();
  status.models = document_.offered();
  status.recent = document_.recent().files();
  status.gone = document_.recent().gone();
  status.measured = measure_.distance();
  findPlaceInfo();
  status.picked = picked_.info;
  if (session) {
    status.model = document_.file();
    if (const SimulationControl* const simulation = session->simulation()) {
      status.parameters = simulation->parameters();
      status.simulationPaused = simulation->isPaused();
    }
    if (const SharedPresence* const presence = session->presence())
      status.others = {.counts = {}, .hands = presence->hands(), .cameras = presence->cameras()};
    if (const SharedFollower* const shared = session->shared()) status.others->counts = shared->counts();
    status.upright = session->model().upright;
    status.up = view.upOf(session->model());
    status.isUpTurned = view.up.has_value();
    status.unit = view.unitOf(session->model());
    if (view.scaleBar && screen_.size_px().x > 0) status.scaleBar = scaleOfPicture();
    status.measuredAt_px = middleOfMeasure_px();
    if (view.color == ColorBy::height) status.heights = heightsOf(session->model(), view.upOf(session->model()));
  }
  status.changesQuestion = document_.changesQuestion();
  status.saveQuestion = document_.saveQuestion();
  status.leftQuestion = document_.leftQuestion();
  status.saveFile = document_.saveFile();
  status.stylus = pointing_.holdsStylus();
  status.held = &held_;
  status.gpu = screen_.sight().name();
  status.meshTime_ms = shown_.mesh().time_ms();
  status.meshTriangles = shown_.mesh().triangleCount();
  status.pictures_ms = &pace_.times_ms();
  status.fps = pace_.fps();
  if (pace_.count() > 0 && screen_.size_px().x > 0) {
    screen_.waitForLast();
    status.passes = shown_.picture().passes(screen_.list());
  }
  return status;
}

void Viewer::writeState(const std::string& file) {
  const Camera& camera = viewpoint_.camera();
  Json state{{"model", nullptr},
             {"points", 0},
             {"camera",
              {{"eye", vectorJson(camera.eye)}, {"target", vectorJson(camera.target)}, {"up", vectorJson(camera.up)}}},
             {"size", {screen_.size_px().x, screen_.size_px().y}},
             {"tool", nullptr},
             {"stylus", pointing_.isTouching()},
             {"mesh_triangles", shown_.mesh().triangleCount()},
             {"fps", pace_.fps()},
             {"pictures", pace_.count()},
             {"pictures_of_model", shown_.picture().made()},
             {"cameras_shown", shown_.lines().cameras()},
             {"measured", document_.session() && measure_.distance() ? Json(*measure_.distance()) : Json(nullptr)},
             {"picked", picked_.info ? toJson(*picked_.info) : Json(nullptr)},
             {"picked_depth", shown_.picture().picked().depth},
             {"asks_about_changes", document_.asksAboutChanges()},
             {"question", document_.changesQuestion()},
             {"asks_how_to_save", document_.saveQuestion().has_value()},
             {"asks_about_strokes", document_.leftQuestion().has_value()},
             {"last_message", messages_.last()},
             {"messages", messages_.remarks()},
             {"errors", messages_.errors()},
             {"panels", settings_.view.panels},
             {"measuring", settings_.view.measures},
             {"device", toJson(held_)}};
  if (document_.session()) addModel(state, document_, settings_.view);
  AtomicFile out(file);
  out.write(state.dump(2) + "\n");
  out.commit();
}

}  // namespace palpate
