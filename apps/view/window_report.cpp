#include "apps/view/window_report.hpp"

#include <algorithm>

#include "apps/cli/picture.hpp"
#include "apps/view/window_state.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/counted.hpp"

namespace palpate {

// The bar is drawn with the panels: in the model's picture it would be coarse while something moves.
ViewStatus::ScaleBar WindowReport::scaleOfPicture() const {
  const PictureSize size{parts_.screen.size_px().x, parts_.screen.size_px().y};
  const double length = scaleBarLength(parts_.viewpoint.camera(), size);
  const double width_px = length / parts_.viewpoint.camera().pixelSize(parts_.viewpoint.targetDistance(), size.height);
  return {.width_px = width_px, .length = length};
}

// placeInfo() iterates over all points: called only once per picked position.
void WindowReport::findPlaceInfo() {
  if (!parts_.document.session() || hands_.measure().picked().empty()) picked_.info.reset();
  if (picked_.version == hands_.measure().version() || !parts_.document.session()) return;
  picked_.version = hands_.measure().version();
  if (!hands_.measure().picked().empty())
    picked_.info = placeInfo(*parts_.document.session(), hands_.measure().picked().back());
}

std::vector<std::string> WindowReport::notices() {
  std::vector<std::string> notices;
  if (!parts_.document.saving().empty()) notices.push_back("saving " + parts_.document.saving());
  if (const WindowSession* const session = parts_.document.shown()) {
    const SelectionCounts& counts = selection_.of(*session);
    if (counts.hidden > 0)
      notices.push_back(counted(counts.hidden, "point is hidden", "points are hidden") +
                        " (S, then Shift+H shows all)");
    if (counts.locked > 0)
      notices.push_back(counted(counts.locked, "point is locked", "points are locked") + " (Ctrl+Shift+M unlocks all)");
  }
  if (const WindowSession* const session = parts_.document.shown();
      session && !session->recentTicks().rows().empty() && session->recentTicks().rows().back().hot)
    notices.emplace_back("less force: the motors of the device are warm; lift it for a few seconds");
  if (!parts_.settings.forcesOn) notices.emplace_back("forces off (Backspace)");
  return notices;
}

ViewStatus WindowReport::status() {
  const ViewSettings& view = parts_.settings.view;
  const WindowSession* session = parts_.document.shown();
  const Loader& loader = parts_.document.loader();
  ViewStatus status;
  status.session = session;
  if (loader.isLoading()) {
    status.loading = loader.progress();
    status.loadingWhat = loader.stage();
    status.isStoppable = parts_.document.isStoppable();
  }
  if (commands_.cleaning().isRunning() && !status.loading) {
    status.loading = commands_.cleaning().share().value_or(ViewStatus::kUnknown);
    status.loadingWhat = commands_.cleaning().stage();
    status.isStoppable = true;
  }
  status.remarks = parts_.messages.remarks();
  status.notices = notices();
  status.blocked = brushNotes_.blocked();
  status.errors = parts_.messages.errors();
  status.models = parts_.document.offered();
  status.recent = parts_.document.recent().files();
  status.gone = parts_.document.recent().gone();
  status.measure = &hands_.measure();
  findPlaceInfo();
  status.picked = picked_.info;
  if (session) {
    status.model = parts_.document.file();
    status.views = commands_.views().of(status.model);
    if (const SimulationControl* const simulation = session->session().simulation()) {
      status.parameters = simulation->parameters();
      status.simulationPaused = simulation->isPaused();
    }
    if (const SharedPresence* const presence = session->session().presence())
      status.others = {.counts = {}, .hands = presence->hands(), .cameras = presence->cameras()};
    if (const SharedFollower* const shared = session->session().shared()) status.others->counts = shared->counts();
    const Upright& upright = session->model().upright;
    status.upFound = upright.up;
    status.orientation = view.up ? fmt::format("up {}, as chosen", nameOf(*view.up))
                                 : fmt::format("up {} {}, front {}", nameOf(upright.up), nameOf(upright.sureness),
                                               nameOf(upright.frontSureness));
    status.orientationWhy = view.up ? "as chosen" : upright.why;
    status.unit = view.unitOf(session->model());
    status.lengths = view.shownLength(*session);
    if (view.scaleBar && parts_.screen.size_px().x > 0) status.scaleBar = scaleOfPicture();
    status.selection = selection_.of(*session);
    status.measures =
        hands_.measure().labelsIn(parts_.viewpoint.camera(), parts_.screen.size_px(), status.unit, view.measures);
    status.labels = parts_.shown.guides().labelsIn(parts_.viewpoint.camera(), parts_.screen.size_px());
    status.legend = parts_.shown.legend(*session, view);
    status.field = parts_.shown.field();
    status.fields = fieldNames(session->model().cloud, session->attributes().fields());
    status.whereError = commands_.whereError();
    if (hands_.pointing().isTouching()) status.onTime_percent = session->recentTicks().onTime_percent();
  }
  if (!parts_.gui.wantsMouse()) findUnder(status);
  status.picture_ms = picture_ms();
  status.changesQuestion = parts_.document.changesQuestion();
  status.isChanged = parts_.document.isChanged();
  status.mayBeSaved = parts_.document.mayBeSaved();
  status.saveQuestion = parts_.document.saveQuestion();
  status.memoryQuestion = parts_.document.memoryQuestion();
  status.leftQuestion = parts_.document.leftQuestion();
  status.saveFile = parts_.document.saveFile();
  if (parts_.settings.tool == WindowTool::select && !parts_.gui.wantsMouse())
    status.outline = hands_.select().drawn(parts_.settings.select, hands_.pointed());
  status.volume = hands_.drawnVolume();
  status.stylus = hands_.pointing().holdsStylus();
  if (session && session->isDrawing() && !session->recentTicks().rows().empty())
    status.pressed_N = glm::length(session->recentTicks().rows().back().force_N);
  status.brush = hands_.brushHint();
  status.held = &parts_.held;
  status.gpu = parts_.screen.sight().name();
  status.meshTime_ms = parts_.shown.mesh().time_ms();
  status.meshTriangles = parts_.shown.mesh().triangleCount();
  status.pictures_ms = &pace_.times_ms();
  status.fps = pace_.fps();
  if (pace_.count() > 0 && parts_.screen.size_px().x > 0) {
    parts_.screen.waitForLast();
    status.passes = parts_.shown.picture().passes(parts_.screen.list());
  }
  return status;
}

void WindowReport::findUnder(ViewStatus& status) const {
  if (!status.session) return;
  const Pick& pick = parts_.shown.picture().picked();
  const DVec2 size_px(parts_.screen.size_px());
  const auto at = parts_.viewpoint.placeAt(pick.place_px, pick.depth, size_px);
  if (!at) return;
  status.under = status.session->model().cloud.origin + *at;
  constexpr double kPartOfPixel = 0.1;
  status.under_resolution = std::max(resolutionOf(status.session->bounds()),
                                     kPartOfPixel * parts_.viewpoint.camera().pixelSize(pick.depth, size_px.y));
}

// It follows only new pictures of the model, twice a second at most, so that a window at rest stays at rest.
double WindowReport::picture_ms() {
  constexpr double kBetween_s = 0.5;
  const std::uint64_t made = parts_.shown.picture().made();
  if (std::exchange(pictures_.made, made) == made || hands_.now_s() < pictures_.next_s) return pictures_.shown_ms;
  pictures_.next_s = hands_.now_s() + kBetween_s;
  std::vector<float> times_ms(pace_.times_ms().begin(), pace_.times_ms().end());
  if (times_ms.size() < 3) return 0;  // the first ones also compile shaders
  std::ranges::nth_element(times_ms, times_ms.begin() + static_cast<std::ptrdiff_t>(times_ms.size() / 2));
  return pictures_.shown_ms = double{times_ms[times_ms.size() / 2]};
}

void WindowReport::writeState(const std::string& file) {
  const WindowState state{
      .document = parts_.document,
      .tool = parts_.settings.tool,
      .brush = parts_.settings.brush,
      .brushHint = hands_.brushHint(),
      .select = parts_.settings.select,
      .selection = parts_.document.shown() ? selection_.of(*parts_.document.shown()) : SelectionCounts(),
      .draws = hands_.select().isDrawing(),
      .volume = hands_.drawnVolume(),
      .view = parts_.settings.view,
      .field = parts_.document.shown() ? parts_.shown.field() : nullptr,
      .whereError = commands_.whereError(),
      .messages = parts_.messages,
      .notices = notices(),
      .panels = parts_.panels,
      .blocked = brushNotes_.blocked(),
      .camera = parts_.viewpoint.camera(),
      .size_px = parts_.screen.size_px(),
      .scale = parts_.gui.scale(),
      .stylus = hands_.pointing().isTouching(),
      .meshTriangles = parts_.shown.mesh().triangleCount(),
      .pace = pace_,
      .passes = parts_.shown.picture().passes(parts_.screen.list()),
      .picturesOfModel = parts_.shown.picture().made(),
      .camerasShown = parts_.shown.lines().cameras(),
      .measure = hands_.measure(),
      .picked = picked_.info,
      .pickedDepth = parts_.shown.picture().picked().depth,
      .held = parts_.held};
  AtomicFile out(file);
  out.write(toJson(state).dump(2) + "\n");
  out.commit();
}

}  // namespace palpate
