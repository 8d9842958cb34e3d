#include "apps/view/viewer.hpp"

#include <filesystem>
#include <utility>

#include "apps/cli/stop_by_signal.hpp"
#include "engine/core/error.hpp"

namespace palpate {

Viewer::Viewer(Context& context, Window& window, Device& sight, const ViewOptions& options)
    : context_(context),
      window_(window),
      settings_{.brush = options.brush, .feel = options.feel},
      messages_(context.log()),
      gui_(window),
      panels_(gui_),
      screen_(window, sight, gui_, options.presentation),
      document_({context, window, sight, settings_, messages_}, options.session, options.script.empty()),
      shown_(sight),
      ownCamera_(options.session),
      hands_(parts(options.held), options.script.empty()),
      commands_(parts(options.held), hands_),
      report_(parts(options.held), hands_, commands_, pace_, brushNotes_),
      held_(options.held),
      script_(options.script, options.session.live.clock != nullptr),
      keepsPlace_(options.script.empty()) {
  ViewSettings& view = settings_.view;
  view.up = upNamed(options.look.up);
  view.unit = unitNamed(options.look.unit);
  view.resolution = options.resolution;
  view.color = options.color;
  view.light = options.light;
  view.guides = options.guides;
  // A script begins with the settings that it has written itself, and shows no first steps.
  const std::optional<KeptSettings> kept = KeptSettings::read();
  kept_ = kept.value_or(KeptSettings{.firstSteps = options.script.empty()});
  view.dark = options.dark.value_or(kept_.dark);
  view.text_percent = options.text_percent.value_or(kept_.text_percent);
  view.firstSteps = kept_.firstSteps;
  // A script with its own clock need not wait for the display.
  if (script_.hasOwnClock()) view.waitsForDisplay = false;
  hands_.followDevice();
  document_.offer(options.models);
  if (!options.models.empty()) document_.open(options.models.front());
}

ViewerParts Viewer::parts(HeldDevice& held) {
  return {context_, window_, settings_, messages_, gui_, panels_, screen_, document_, shown_, viewpoint_, held};
}

Viewer::~Viewer() { screen_.waitForLast(); }

void Viewer::run() {
  while (!isClosed_ && !StopBySignal::requested()) step();
  commands_.cleaning().cancel();
  keepThumbnail();
  if (const auto place = window_.place(); place && keepsPlace_) {
    kept_.place = place;
    kept_.write();
  }
  document_.close(!isClosed_);
  if (isClosed_) return;
  if (document_.session() && document_.session()->isChanged())
    messages_.say("unsaved changes of " + document_.file() + " are kept, and offered when the window is opened again");
}

void Viewer::step() {
  // Events are taken once the last picture is finished, not before: the next one shows what came until then.
  screen_.waitForLast();
  pace_.finish();
  const std::vector<WindowEvent> events = window_.takeEvents(wait_s());
  if (!events.empty()) pace_.wake();
  for (const TimedEvent& timed : hands_.takeEvents(events, script_.clock_s())) {
    if (std::holds_alternative<MouseEvent>(timed.event)) pace_.noteMouse(script_.clock_s() - timed.time_s);
    hands_.setNow(timed.time_s);
    handle(timed.event);
  }
  const double sinceLast_s = pace_.begin();
  if (const auto push = hands_.pointing().takePush(messages_)) handle(*push);
  playScript(sinceLast_s);
  hands_.setNow(script_.clock_s());
  load();
  const double dt_s = script_.hasOwnClock() ? ScriptPlayer::kStep_s : sinceLast_s;
  messages_.dropOld();
  hands_.followDevice();
  followSession();
  hands_.followTool();
  // No stroke continues behind a question.
  if (document_.asks())
    hands_.pointing().letGo(hands_.pointed());
  else
    hands_.pointing().move(dt_s, settings_.view, hands_.pointed());
  if (WindowSession* session = document_.session()) session->drawUntil(hands_.events().known_s(script_.known_s()));
  playTicks();
  hands_.walk(dt_s);
  const bool isShown = draw(dt_s);
  if (!document_.isLeaving() && commands_.takeClosing())
    document_.leave("the window closes", [this] { isClosed_ = true; });
  keepSettings();
  pace_.end(isShown, shown_.picture().isNew());
  shown_.picture().noteTime(pace_.last_ms());
}

void Viewer::handle(const WindowEvent& event) { commands_.carryOut(hands_.handle(event)); }

void Viewer::load() {
  const Document::Opened opened = document_.load([this] { rest(); }, [this] { letGo(); });
  if (opened == Document::Opened::anotherModel) welcome();
  if (opened == Document::Opened::sameModel) hands_.pointing().putDownAgain();
}

// A script goes on with each frame; what other threads bring, and pads, is looked for as often as the display
// refreshes.
double Viewer::wait_s() {
  const WindowSession* session = document_.session();
  const bool moves = session && (session->config().moves() || session->config().model.join || session->isPlaying());
  if (!script_.isOver() && script_.hasOwnClock()) return 0;
  return !hands_.events().isEmpty()
             ? 0
             : pace_.wait_s(moves || hands_.pointing().mayMove() || hands_.isWalking() || document_.isBusy() ||
                            commands_.cleaning().isRunning() || !script_.isOver() ||
                            held_.stage() != HeldDevice::Stage::mouse || held_.isLooking());
}

bool Viewer::scriptWaits() const {
  const bool saves = script_.hasOwnClock() && document_.session() && document_.session()->isSaving();
  const bool isUnseen = script_.isAboutToPress() && !hands_.events().hasSeen();
  return ((document_.isBusy() || commands_.cleaning().isRunning() || shown_.mesh().isAnnounced() || saves) &&
          !script_.isImpatient()) ||
         isUnseen;
}

void Viewer::playScript(double sinceLast_s) {
  const bool isFinishing = hands_.isFinishing();
  if (script_.isOver() || (script_.hasOwnClock() && !screen_.wasShown())) return;
  if (!isFinishing && (scriptWaits() || !hands_.events().isEmpty())) return;
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
  hands_.setNow(timed.time_s);
  messages_.tryTo([&] {
    if (const auto* event = std::get_if<WindowEvent>(&action)) {
      if (std::holds_alternative<MouseEvent>(*event)) pace_.noteMouse(script_.clock_s() - timed.time_s);
      handle(*event);
    }
    if (const auto* tap = std::get_if<TapAction>(&action)) hands_.events().add(tap->events, timed.time_s, timed.time_s);
    if (const auto* resize = std::get_if<ResizeAction>(&action)) window_.resize(resize->size_px);
    if (const auto* minimise = std::get_if<MinimiseAction>(&action)) window_.minimise(minimise->on);
    if (const auto* picture = std::get_if<ScreenshotAction>(&action)) screen_.keep(picture->file);
    if (const auto* state = std::get_if<StateAction>(&action)) report_.writeState(state->file);
    if (const auto* command = std::get_if<ViewCommand>(&action)) commands_.carryOut(*command);
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

// The GPU draws nothing of the present model until the next one is there: its last picture stays.
void Viewer::rest() {
  commands_.cleaning().cancel();
  hands_.pointing().endStroke(hands_.pointed());
  screen_.waitForLast();
  keepThumbnail();
  shown_.forget();
  brushNotes_.forget();
}

// Another model replaces the present one.
void Viewer::letGo() {
  hands_.pointing().letGo(hands_.pointed());
  rest();
  settings_.view.mesh = false;
}

void Viewer::welcome() {
  WindowSession& session = *document_.session();
  session.setForces(settings_.forcesOn);
  if (!panels_.hasRoomBeside(window_.size_px().x)) settings_.view.panels = false;
  commands_.fitCamera();
  hands_.events().forgetSeen();
  panels_.closeFiles();  // the dialogue belonged to the model before
  commands_.forgetWhereError();
  hands_.measure().belongTo(session.file(), session.model().cloud.origin);
  if (const MeasuredDistance* const distance = hands_.measure().chosen())
    messages_.say(fmt::format("touch scale: {}, {}, is {:.6g} mm long in the hand", distance->name,
                              lengthText(distance->length(), settings_.view.unitOf(session.model())),
                              session.model().scale.toMm(distance->length())));
}

// Follows a change of the document's file, e.g. after it is saved under another name.
void Viewer::followName() {
  if (document_.file() == named_) return;
  named_ = document_.file();
  hands_.measure().beCalled(named_);
  window_.setTitle(std::filesystem::path(named_).filename().string() + " - palpate");
}

void Viewer::keepSettings() {
  window_.setFullScreen(settings_.view.fullScreen);
  KeptSettings now = KeptSettings::of(settings_.view);
  now.place = kept_.place;
  if (now == kept_ || gui_.isBusy()) return;
  kept_ = now;
  kept_.write();
}

// For the start screen, while its picture is there.
void Viewer::keepThumbnail() {
  const ModelPicture& picture = shown_.picture();
  if (!document_.shown() || !screen_.isVisible() || !picture.hasSize(screen_.size_px())) return;
  screen_.waitForLast();
  messages_.tryTo([&] {
    panels_.thumbnails().keep(document_.file(), picture.frame().readColor(),
                              free_px_ / static_cast<double>(picture.shrink()));
  });
}

void Viewer::sayLost(const std::string& failure) {
  const WindowSession* session = document_.session();
  if (!session || !session->hasLostDevice()) return messages_.sayError(failure + "; edits are kept and can be saved");
  held_.lose();
  messages_.sayError(failure + "; the mouse moves the stylus now, and Device in the panel holds it again");
}

void Viewer::followSession() {
  WindowSession* session = document_.session();
  if (!session || document_.isGivingWay()) return;
  if (const auto failure = session->follow()) sayLost(*failure);
  document_.follow();
  messages_.tryTo([&] { commands_.followCleaning(*session); });
  followName();
  brushNotes_.notePaint(*session, settings_.view, messages_);
  brushNotes_.noteBlocked(*session, hands_.now_s());
  brushNotes_.noteBack(*session, messages_);
  shown_.follow(*session, settings_.view, hands_.measure(), messages_);
}

void Viewer::playTicks() {
  WindowSession* session = document_.session();
  if (!script_.hasOwnClock() || !session || document_.isGivingWay()) return;
  if (const auto failure = session->tickUntil(script_.time_s())) sayLost(*failure);
}

}  // namespace palpate
