#include "apps/view/viewer.hpp"

#include <fmt/ranges.h>

#include <filesystem>
#include <utility>

#include "apps/cli/stop_by_signal.hpp"
#include "engine/core/error.hpp"

namespace palpate {

Viewer::Viewer(Context& context, Window& window, Device& sight, const ViewOptions& options)
    : window_(window),
      settings_{.brush = options.brush, .feel = options.feel},
      messages_(context.log()),
      gui_(window),
      panels_(gui_),
      screen_(window, sight, gui_, options.presentation),
      held_(options.held),
      document_({context, window, sight, settings_, messages_}, options.session, options.script.empty()),
      shown_(sight),
      ownCamera_(options.session),
      pointing_(window, options.script.empty()),
      script_(options.script, options.session.live.clock != nullptr) {
  ViewSettings& view = settings_.view;
  view.up = upNamed(options.look.up);
  view.unit = unitNamed(options.look.unit);
  view.resolution = options.resolution;
  view.color = options.color;
  view.light = options.light;
  // A script with its own clock need not wait for the display.
  if (script_.hasOwnClock()) view.waitsForDisplay = false;
  followDevice();
  document_.offer(options.models);
  if (!options.models.empty()) document_.open(options.models.front());
}

Viewer::~Viewer() { screen_.waitForLast(); }

void Viewer::run() {
  while (closing_ != Closing::done && !StopBySignal::requested()) step();
  clean_.cancel();
  const bool isDone = closing_ == Closing::done;
  document_.close(!isDone);
  if (isDone) return;
  if (document_.session() && document_.session()->isChanged())
    messages_.say("unsaved changes of " + document_.file() + " are kept, and offered when the window is opened again");
}

void Viewer::step() {
  handleEvents(wait_s());
  const double sinceLast_s = pace_.begin();
  if (const auto push = pointing_.takePush(messages_)) handle(*push);
  playScript(sinceLast_s);
  now_s_ = script_.clock_s();
  load();
  const double dt_s = script_.hasOwnClock() ? ScriptPlayer::kStep_s : sinceLast_s;
  messages_.dropOld();
  followDevice();
  followSession();
  followTool();
  // No stroke continues behind a question.
  if (document_.asks())
    pointing_.letGo(pointed());
  else
    pointing_.move(dt_s, settings_.view, pointed());
  if (WindowSession* session = document_.session()) session->drawUntil(events_.known_s(script_.known_s()));
  playTicks();
  const bool isShown = draw(dt_s);
  if (closing_ == Closing::asked && !document_.isLeaving()) {
    closing_ = Closing::no;
    document_.leave("the window closes", [this] { closing_ = Closing::done; });
  }
  pace_.end(isShown, shown_.picture().isNew());
  shown_.picture().noteTime(pace_.last_ms());
}

void Viewer::load() {
  const Document::Opened opened = document_.load([this] { rest(); }, [this] { letGo(); });
  if (opened == Document::Opened::anotherModel) welcome();
  if (opened == Document::Opened::sameModel) pointing_.putDownAgain();
}

// A script goes on with each frame; what other threads bring, and pads, is looked for as often as the display
// refreshes.
double Viewer::wait_s() {
  const WindowSession* session = document_.session();
  const bool moves = session && (session->config().moves() || session->config().model.join || session->isPlaying());
  if (!script_.isOver() && script_.hasOwnClock()) return 0;
  return !events_.isEmpty()
             ? 0
             : pace_.wait_s(moves || pointing_.mayMove() || document_.isBusy() || clean_.isRunning() ||
                            !script_.isOver() || held_.stage() != HeldDevice::Stage::mouse || held_.isLooking());
}

// The window system does not tell when events came: they are spread over the time since the last look.
void Viewer::handleEvents(double wait_s) {
  const std::vector<WindowEvent> events = window_.takeEvents(wait_s);
  if (!events.empty()) pace_.wake();
  const double from_s = std::exchange(polled_s_, script_.clock_s());
  events_.add(events, from_s, polled_s_);
  if (isFinishing()) return events_.forgetSeen();  // the next press begins on the surface that this stroke leaves
  for (const TimedEvent& timed : events_.takeForPicture()) {
    now_s_ = timed.time_s;
    handle(timed.event);
  }
}

// Whether the button is up, and the stylus still follows the path that was drawn until then: events wait for it, so
// that they do not change the stroke.
bool Viewer::isFinishing() const {
  WindowSession* session = document_.session();
  return session && !document_.isGivingWay() && session->isDrawing() && !session->stroke();
}

void Viewer::handle(const WindowEvent& event) {
  if (std::holds_alternative<ExposeEvent>(event)) screen_.forget();
  if (gui_.feed(event)) return;
  const auto* key = std::get_if<KeyEvent>(&event);
  const bool repeats = key && keyboard_.note(*key);
  if (dragBrush(event, repeats)) return;
  if (key && !gui_.wantsKeys() && !document_.asks() && !panels_.areFilesOpen())
    carryOut(keyboard_.commandsOf(*key, repeats, settings_));
  if (const auto* mouse = std::get_if<MouseEvent>(&event)) {
    pointing_.moveMouse(mouse->place_px, pointed());
    select_.moveTo(mouse->place_px);
  }
  if (std::holds_alternative<MouseEvent>(event) || std::holds_alternative<WheelEvent>(event)) events_.forgetSeen();
  const bool meansModel = document_.session() && !gui_.wantsMouse() && !document_.asks();
  if (const auto* button = std::get_if<ButtonEvent>(&event)) {
    if (!button->down) pointing_.release(button->button, pointed());
    if (!button->down)
      messages_.tryTo([&] {
        const std::string remark = select_.release(button->button, settings_.select, pointed());
        if (!remark.empty()) messages_.say(remark);
      });
    if (const std::string remark = select_.takeRemark(); !remark.empty()) messages_.say(remark);
    if (pointing_.takeMiss()) messages_.say("nothing is measured: the model is not under the cursor");
    if (button->down && document_.isGivingWay() && pointing_.holdsStylus() && !gui_.wantsMouse())
      messages_.say("no stroke: " + document_.whyWaiting());
    if (button->down && meansModel) messages_.tryTo([&] { press(button->button); });
  }
  if (const auto* wheel = std::get_if<WheelEvent>(&event); wheel && meansModel && !select_.isDrawing())
    pointing_.turnWheel(*wheel, pointed());
  if (const auto* drop = std::get_if<DropEvent>(&event); drop && !drop->files.empty()) {
    document_.offer(drop->files);
    document_.open(drop->files.front());
  }
  if (const auto* push = std::get_if<PushEvent>(&event)) carryOut(pointing_.push(*push, pointed()));
  if (std::holds_alternative<CloseEvent>(event)) closing_ = Closing::asked;
}

void Viewer::press(MouseButton button) {
  const SelectTool::Keys keys{
      .shift = keyboard_.isShiftDown(), .control = keyboard_.isControlDown(), .alt = keyboard_.isAltDown()};
  if (settings_.tool == WindowTool::select && select_.press(button, keys, settings_.select, pointed())) return;
  pointing_.press(button, keys.shift, settings_.view, pointed());
}

// The stylus of the mouse, an outline and a measure are each of one tool.
void Viewer::followTool() {
  if (settings_.tool != WindowTool::sculpt && pointing_.holdsStylus()) pointing_.letGo(pointed());
  if (settings_.tool == WindowTool::select && document_.session() && !document_.asks())
    settings_.view.measures = false;
  else
    select_.cancel();
}

bool Viewer::scriptWaits() const {
  const bool saves = script_.hasOwnClock() && document_.session() && document_.session()->isSaving();
  const bool isUnseen = script_.isAboutToPress() && !events_.hasSeen();
  return ((document_.isBusy() || clean_.isRunning() || shown_.mesh().isAnnounced() || saves) &&
          !script_.isImpatient()) ||
         isUnseen;
}

void Viewer::playScript(double sinceLast_s) {
  const bool isFinishing = this->isFinishing();
  if (script_.isOver() || (script_.hasOwnClock() && !screen_.wasShown())) return;
  if (!isFinishing && (scriptWaits() || !events_.isEmpty())) return;
  if (pace_.count() > 0) script_.passPicture(sinceLast_s);
  // An action runs only once the model is loaded, and each button press only after a frame has handled the one before.
  while (!isFinishing && !scriptWaits()) {
    const auto timed = script_.takeDue();
    if (!timed) return;
    act(*timed);
    const ScriptAction& action = timed->action;
    if (const auto* event = std::get_if<WindowEvent>(&action))
      if (std::holds_alternative<ButtonEvent>(*event) || std::holds_alternative<KeyEvent>(*event)) return;
    if (std::holds_alternative<ScreenshotAction>(action) || std::holds_alternative<ClickAction>(action) ||
        std::holds_alternative<AwaitAction>(action) || std::holds_alternative<TapAction>(action))
      return;
  }
}

void Viewer::act(const TimedAction& timed) {
  const ScriptAction& action = timed.action;
  now_s_ = timed.time_s;
  messages_.tryTo([&] {
    if (const auto* event = std::get_if<WindowEvent>(&action)) handle(*event);
    if (const auto* tap = std::get_if<TapAction>(&action)) events_.add(tap->events, timed.time_s, timed.time_s);
    if (const auto* resize = std::get_if<ResizeAction>(&action)) window_.resize(resize->size_px);
    if (const auto* minimise = std::get_if<MinimiseAction>(&action)) window_.minimise(minimise->on);
    if (const auto* picture = std::get_if<ScreenshotAction>(&action)) screen_.keep(picture->file);
    if (const auto* state = std::get_if<StateAction>(&action)) writeState(state->file);
    if (const auto* command = std::get_if<ViewCommand>(&action)) carryOut(*command);
    if (const auto* impatient = std::get_if<ImpatientAction>(&action)) script_.setImpatient(impatient->on);
    if (std::holds_alternative<AskAction>(action)) document_.askFromNowOn();
    if (const auto* click = std::get_if<ClickAction>(&action)) this->click(click->name);
    if (const auto* await = std::get_if<AwaitAction>(&action)) this->await(await->file);
  });
}

// Clicks as a user does: scrolls, moves the cursor, presses, releases, and then waits for the panels to react.
void Viewer::click(const std::string& name) {
  const auto place_px = panels_.placeOf(name);
  panels_.scrollTo(place_px ? std::string() : name);
  if (!place_px) {
    if (script_.lookAgain()) return;
    panels_.scrollTo({});
    throw Error("'{}' cannot be clicked: the panels show no control of that name", name);
  }
  handle(MouseEvent{*place_px});
  script_.pressAndRelease();
}

void Viewer::await(const std::string& file) {
  std::error_code none;
  if (std::filesystem::exists(file, none)) return script_.hasCome();
  if (!script_.awaitAgain()) throw Error("{} did not appear within a minute", file);
}

void Viewer::carryOut(const ViewCommands& commands) {
  for (const ViewCommand& command : commands) {
    bool isCancelled = false;
    messages_.tryTo([&] {
      if (const auto* brush = std::get_if<BrushCommand>(&command))
        isCancelled = carryOut(*brush) && *brush == BrushCommand::cancelStroke;
      else
        carryOut(command);
    });
    if (isCancelled) return;
  }
}

void Viewer::carryOut(const ViewCommand& command) {
  if (const auto* window = std::get_if<WindowCommand>(&command)) carryOut(*window);
  if (const auto* model = std::get_if<ModelCommand>(&command)) document_.carryOut(*model);
  if (const auto* stylus = std::get_if<StylusCommand>(&command)) pointing_.carryOut(*stylus, pointed());
  if (const auto* answer = std::get_if<Answer>(&command)) document_.answer(*answer);
  if (const auto* file = std::get_if<FileCommand>(&command)) carryOut(*file);
  if (const auto* browse = std::get_if<BrowseCommand>(&command)) panels_.browse(browse->task, status());
  if (const auto* device = std::get_if<DeviceCommand>(&command)) carryOut(*device);
  if (const auto* select = std::get_if<SelectCommand>(&command)) carryOut(*select);
  if (const auto* device = std::get_if<ChooseDevice>(&command)) held_.choose(device->device);
  if (const auto* axes = std::get_if<SetDeviceAxes>(&command)) held_.setAxes(axes->text);
  if (const auto* copied = std::get_if<CopyText>(&command)) window_.setClipboard(copied->text);
  WindowSession* session = document_.session();
  if (!session) return;
  const UpAxis up = settings_.view.upOf(session->model());
  const DVec3 front = settings_.view.frontFor(session->model());
  if (const auto* side = std::get_if<ModelSide>(&command)) viewpoint_.lookFrom(*side, up, front);
  if (const auto* look = std::get_if<LookAlong>(&command))
    viewpoint_.lookAlong(look->axis, !look->fromBehind, up, front);
  if (const auto* set = std::get_if<SetParameter>(&command)) session->setParameter(set->name, set->value);
  if (const auto* set = std::get_if<SetValue>(&command)) messages_.say(palpate::carryOut(*set, *session));
  carryOutVolume(command);
  if (const auto* keep = std::get_if<KeepSelection>(&command)) messages_.say(palpate::carryOut(*keep, *session));
  if (const auto* where = std::get_if<SelectWhere>(&command)) carryOut(*where);
  if (const auto* clean = std::get_if<CleanModel>(&command)) clean_.begin(*session, *clean, up);
  if (const auto* range = std::get_if<SetColorRange>(&command)) carryOut(*range);
  if (const auto* view = std::get_if<NamedViewCommand>(&command)) carryOut(*view);
  // Opens the model again at the scale that gives the measure this length.
  if (const auto* length = std::get_if<SetTrueLength>(&command)) document_.openAtScale(measure_.scaleFor(length->text));
}

void Viewer::carryOut(const NamedViewCommand& command) {
  using What = NamedViewCommand::What;
  const std::string& model = document_.file();
  const DVec3& origin = document_.session()->model().cloud.origin;
  if (command.what == What::remember)
    messages_.say("remembered as " + views_.remember(model, {command.name, textOf(viewpoint_.camera(), origin)}));
  if (command.what == What::forget) views_.forget(model, command.name);
  if (command.what != What::show) return;
  for (const NamedView& view : views_.of(model))
    if (view.name == command.name) viewpoint_.set(cameraOf(view.camera, origin, viewpoint_.camera()));
  settings_.view.orthographic = viewpoint_.camera().isOrthographic();
}

void Viewer::carryOut(WindowCommand command) {
  if (command == WindowCommand::quit) closing_ = Closing::asked;
  if (command == WindowCommand::stopReading) document_.stopReading(), clean_.stop();
  if (command == WindowCommand::closeErrors) messages_.closeErrors();
  if (command == WindowCommand::forgetMeasure) measure_.forget();
  if (command == WindowCommand::switchForces) {
    settings_.forcesOn = !settings_.forcesOn;
    if (settings_.forcesOn) messages_.say("forces on");
  }
  if (!document_.session()) return;
  if (command == WindowCommand::copyPlaces) copyPlaces();
  if (command == WindowCommand::resetView) fitCamera();
  if (command == WindowCommand::turnModel) turnModel();
  if (command == WindowCommand::screenshot) savePicture();
}

void Viewer::carryOut(DeviceCommand command) {
  switch (command) {
    case DeviceCommand::look:
      return held_.lookAround();
    case DeviceCommand::test:
      return held_.beginTest();
    case DeviceCommand::endTest:
      return held_.endTest();
    case DeviceCommand::useStiffness:
      return held_.useStiffness();
    case DeviceCommand::useAxes:
      return held_.useAxes();
    case DeviceCommand::closeResult:
      return held_.closeResult();
    case DeviceCommand::forget:
      return held_.forget();
  }
}

void Viewer::carryOut(const FileCommand& command) {
  if (command.file.empty()) throw Error("type the name of a file into the field first");
  if (command.task == FileTask::open) return document_.open(command.file);
  if (!document_.session()) return;
  if (command.task == FileTask::saveAs) document_.saveTo(command.file);
  if (command.task == FileTask::exportMesh) exportMesh(command.file);
  if (command.task == FileTask::exportSelection || command.task == FileTask::separate) {
    messages_.say(
        exportSelection(*document_.session(), document_.file(), command.file, command.task == FileTask::separate));
    if (settings_.select.opensBeside) openInAnotherWindow(command.file);
  }
  if (command.task == FileTask::record) document_.record(command.file);
  if (command.task == FileTask::play) document_.play(command.file);
}

void Viewer::exportMesh(const std::string& file) {
  screen_.waitForLast();
  std::vector<std::string> lost;
  const std::filesystem::path kept = shown_.mesh().write(file, lost);
  if (!lost.empty()) messages_.say(fmt::format("{}: not kept: {}", file, fmt::join(lost, ", ")));
  messages_.say(file + " is written" + (kept.empty() ? "" : "; the old file is kept as " + kept.string()));
}

void Viewer::turnModel() {
  const Model& model = document_.session()->model();
  ViewSettings& view = settings_.view;
  view.front = view.frontFor(model);
  view.up = turnedUp(view.upOf(model), *view.front);
}

// The GPU draws nothing of the present model until the next one is there: its last picture stays.
void Viewer::rest() {
  clean_.cancel();
  pointing_.endStroke(pointed());
  screen_.waitForLast();
  shown_.forget();
  brushNotes_.forget();
}

// Another model replaces the present one.
void Viewer::letGo() {
  pointing_.letGo(pointed());
  rest();
  settings_.view.mesh = false;
}

void Viewer::welcome() {
  WindowSession& session = *document_.session();
  session.setForces(settings_.forcesOn);
  if (!panels_.hasRoomBeside(window_.size_px().x)) settings_.view.panels = false;
  fitCamera();
  events_.forgetSeen();
  panels_.closeFiles();  // the dialogue belonged to the model before
  whereError_.clear();
  measure_.belongTo(session.file());
  if (const auto distance = measure_.distance())
    messages_.say(fmt::format("touch scale: the measured distance, {}, is {:.6g} mm long in the hand",
                              lengthText(*distance, settings_.view.unitOf(session.model())),
                              session.model().scale.toMm(*distance)));
}

// Follows a change of the document's file, e.g. after it is saved under another name.
void Viewer::followName() {
  if (document_.file() == named_) return;
  named_ = document_.file();
  measure_.beCalled(named_);
  window_.setTitle(std::filesystem::path(named_).filename().string() + " - palpate");
}

// One line per position, in the format of --scale-from and --camera.
void Viewer::copyPlaces() {
  const PointCloud& cloud = document_.session()->model().cloud;
  std::string text;
  const double least = resolutionOf(document_.session()->bounds());
  for (const auto& [place, resolution] : measure_.picked())
    text += (text.empty() ? "" : "\n") + coordinateText(cloud.origin + place, std::max(least, resolution), ",");
  if (text.empty()) return messages_.say("no positions to copy: press D and click the model");
  window_.setClipboard(text);
  messages_.say("copied: " + text);
}

void Viewer::fitCamera() {
  const DVec2 window_px = glm::max(DVec2(window_.size_px()), DVec2(1));
  const WindowSession& session = *document_.session();
  const PointSet& hidden = session.attributes().mask(MaskRole::hidden);
  PointCloud present;
  if (session.edits() > 0 || !hidden.empty())
    for (const PointState& state : session.history().points())
      if (!state.gone && !hidden.test(state.number)) present.positions.push_back(state.position);
  viewpoint_.fit(session.model(), present.empty() ? nullptr : &present, settings_.view, window_px,
                 panels_.freeWidth_px(settings_.view, window_px.x));
}

Pointed Viewer::pointed() {
  return {.session = document_.session(),
          .viewpoint = viewpoint_,
          .picked = shown_.picture().picked(),
          .size_px = DVec2(screen_.size_px()),
          .time_s = now_s_,
          .surface =
              [this] {
                screen_.waitForLast();
                return shown_.picture().surface(DVec2(screen_.size_px()));
              },
          .measure = settings_.view.measures ? &measure_ : nullptr,
          .waits = document_.isGivingWay()};
}

void Viewer::sayLost(const std::string& failure) {
  const WindowSession* session = document_.session();
  if (!session || !session->hasLostDevice()) return messages_.sayError(failure + "; edits are kept and can be saved");
  held_.lose();
  messages_.sayError(failure + "; the mouse moves the stylus now, and Device in the panel holds it again");
}

// Between models: one that is being opened has the device of its beginning.
void Viewer::followDevice() {
  const bool mayChange = !document_.loader().isLoading() && !document_.isGivingWay();
  if (!held_.follow(messages_, mayChange)) return;
  messages_.tryTo([&] {
    document_.setDevice(held_.device(), held_.centredFacts());
    pointing_.setDevice(held_.device(), pointed());
  });
  followStiffness(held_.device() ? held_.opened()->remembered.stiffness_N_per_mm : std::nullopt);
}

// A stiffness that is remembered for a device applies while the device is held.
void Viewer::followStiffness(std::optional<double> ofDevice_N_per_mm) {
  double& stiffness_N_per_mm = settings_.feel.stiffness_N_per_mm;
  if (!ofDevice_N_per_mm && !ownStiffness_N_per_mm_) return;
  if (!ofDevice_N_per_mm) {
    stiffness_N_per_mm = *std::exchange(ownStiffness_N_per_mm_, {});
    return;
  }
  if (!ownStiffness_N_per_mm_) ownStiffness_N_per_mm_ = stiffness_N_per_mm;
  stiffness_N_per_mm = *ofDevice_N_per_mm;
}

void Viewer::followSession() {
  WindowSession* session = document_.session();
  if (!session || document_.isGivingWay()) return;
  if (const auto failure = session->follow()) sayLost(*failure);
  document_.follow();
  messages_.tryTo([&] { followCleaning(*session); });
  followName();
  brushNotes_.notePaint(*session, settings_.view, messages_);
  brushNotes_.noteBlocked(*session, now_s_);
  shown_.follow(*session, settings_.view, measure_, messages_);
}

void Viewer::playTicks() {
  WindowSession* session = document_.session();
  if (!script_.hasOwnClock() || !session || document_.isGivingWay()) return;
  if (const auto failure = session->tickUntil(script_.time_s())) sayLost(*failure);
}

}  // namespace palpate
