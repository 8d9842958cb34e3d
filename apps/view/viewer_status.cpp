// The part of Viewer that reports its state: to the panels, and to a script.
#include "apps/cli/picture.hpp"
#include "apps/view/viewer.hpp"
#include "apps/view/window_state.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/core/counted.hpp"

namespace palpate {

// The bar is drawn with the panels: in the model's picture it would be coarse while something moves.
ViewStatus::ScaleBar Viewer::scaleOfPicture() const {
  const PictureSize size{screen_.size_px().x, screen_.size_px().y};
  const double length = scaleBarLength(viewpoint_.camera(), size);
  const double width_px = length / viewpoint_.camera().pixelSize(viewpoint_.targetDistance(), size.height);
  return {.width_px = width_px, .length = length};
}

// placeInfo() iterates over all points: called only once per picked position.
void Viewer::findPlaceInfo() {
  if (!document_.session() || measure_.picked().empty()) picked_.info.reset();
  if (picked_.version == measure_.version() || !document_.session()) return;
  picked_.version = measure_.version();
  if (!measure_.picked().empty()) picked_.info = placeInfo(*document_.session(), measure_.picked().back());
}

std::vector<std::string> Viewer::notices() {
  std::vector<std::string> notices;
  if (!document_.saving().empty()) notices.push_back("saving " + document_.saving());
  if (const WindowSession* const session = document_.shown()) {
    const SelectionCounts& counts = selection_.of(*session);
    if (counts.hidden > 0)
      notices.push_back(counted(counts.hidden, "point is hidden", "points are hidden") +
                        " (S, then Shift+H shows all)");
  }
  if (!settings_.forcesOn) notices.emplace_back("forces off (Backspace)");
  return notices;
}

ViewStatus Viewer::status() {
  const ViewSettings& view = settings_.view;
  const WindowSession* session = document_.shown();
  const Loader& loader = document_.loader();
  ViewStatus status;
  status.session = session;
  if (loader.isLoading()) {
    status.loading = loader.progress();
    status.loadingWhat = loader.stage();
    status.isStoppable = document_.isStoppable();
  }
  if (clean_.isRunning() && !status.loading) {
    status.loading = ViewStatus::kUnknown;
    status.loadingWhat = clean_.stage();
    status.isStoppable = true;
  }
  status.remarks = messages_.remarks();
  status.notices = notices();
  status.blocked = brushNotes_.blocked();
  status.errors = messages_.errors();
  status.models = document_.offered();
  status.recent = document_.recent().files();
  status.gone = document_.recent().gone();
  status.measured = measure_.distance();
  findPlaceInfo();
  status.picked = picked_.info;
  if (session) {
    status.model = document_.file();
    status.views = views_.of(status.model);
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
    if (view.scaleBar && screen_.size_px().x > 0) status.scaleBar = scaleOfPicture();
    status.selection = selection_.of(*session);
    status.measuredAt_px = measure_.middle_px(viewpoint_.camera(), screen_.size_px());
    status.legend = shown_.legend(*session, view);
    status.field = shown_.field();
    status.fields = fieldNames(session->model().cloud, session->attributes().fields());
    status.whereError = whereError_;
  }
  status.changesQuestion = document_.changesQuestion();
  status.isChanged = document_.isChanged();
  status.mayBeSaved = document_.mayBeSaved();
  status.saveQuestion = document_.saveQuestion();
  status.memoryQuestion = document_.memoryQuestion();
  status.leftQuestion = document_.leftQuestion();
  status.saveFile = document_.saveFile();
  if (settings_.tool == WindowTool::select && !gui_.wantsMouse())
    status.outline = select_.drawn(settings_.select, pointed());
  status.volume = drawnVolume();
  status.stylus = pointing_.holdsStylus();
  status.brush = brushHint();
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

DrawnVolume Viewer::drawnVolume() {
  const SelectShape shape = settings_.select.shape;
  if (settings_.tool != WindowTool::select || !document_.session() || !isVolume(shape)) return {};
  return select_.volume().drawn(shape, pointed());
}

void Viewer::writeState(const std::string& file) {
  const WindowState state{.document = document_,
                          .tool = settings_.tool,
                          .brush = settings_.brush,
                          .brushHint = brushHint(),
                          .select = settings_.select,
                          .selection = document_.shown() ? selection_.of(*document_.shown()) : SelectionCounts(),
                          .draws = select_.isDrawing(),
                          .volume = drawnVolume(),
                          .view = settings_.view,
                          .field = document_.shown() ? shown_.field() : nullptr,
                          .whereError = whereError_,
                          .messages = messages_,
                          .notices = notices(),
                          .blocked = brushNotes_.blocked(),
                          .camera = viewpoint_.camera(),
                          .size_px = screen_.size_px(),
                          .stylus = pointing_.isTouching(),
                          .meshTriangles = shown_.mesh().triangleCount(),
                          .fps = pace_.fps(),
                          .pictures = pace_.count(),
                          .picturesOfModel = shown_.picture().made(),
                          .camerasShown = shown_.lines().cameras(),
                          .measured = measure_.distance(),
                          .picked = picked_.info,
                          .pickedDepth = shown_.picture().picked().depth,
                          .held = held_};
  AtomicFile out(file);
  out.write(toJson(state).dump(2) + "\n");
  out.commit();
}

}  // namespace palpate
