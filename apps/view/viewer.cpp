#include "apps/view/viewer.hpp"

#include <algorithm>
#include <utility>

#include "apps/touch.hpp"
#include "engine/cloud/point_cloud.hpp"
#include "engine/cloud/saving.hpp"
#include "engine/core/atomic_file.hpp"
#include "engine/render/camera_motion.hpp"

namespace palpate {

namespace {

constexpr double kMessage_s = 6;  // that a message is shown
// Of a script in real time in one picture: slow machines play it slowly, not coarsely.
constexpr double kLongestStep_s = 0.1;
constexpr double kIdle_s = 0.02;  // wait for events while nothing is shown

}  // namespace

Viewer::Viewer(Context& context, Window& window, Device& sight, ViewOptions options)
    : context_(context),
      window_(window),
      sight_(sight),
      options_(std::move(options)),
      gui_(window),
      panels_(gui_),
      panelPass_(sight, gui_.texture(), gui_.texture_px()),
      presenter_(makePresenter(window, sight, options_.presentation, true)),
      list_(sight, sight.window(), "picture", CommandList::Timing::passes),
      shown_(sight, 0, Memory::device, "shown"),
      pick_(sight, sizeof(float), Memory::readback, "picked depth"),
      loader_(context, sight),
      tool_(options_.tool),
      feel_(options_.feel) {
  view_.up = upNamed(options_.look.up);
  view_.unit = unitNamed(options_.look.unit);
  // Under a script the display's pace means nothing, and it has saved what it wants to keep unless it says `ask`.
  if (!options_.script.empty()) view_.waitsForDisplay = false;
  asks_ = options_.script.empty();
  view_.plots = double(options_.size_px.x) >= panels_.roomyWidth_px();
  if (options_.script.empty() && !options_.session.device) spaceMouse_.emplace();
  if (!options_.models.empty()) open(options_.models.front());
}

Viewer::~Viewer() { presenter_->waitForLast(); }

void Viewer::run() {
  while (!isClosed_) step();
}

void Viewer::step() {
  const bool visible = window_.size_px().x > 0 && window_.size_px().y > 0;
  for (const WindowEvent& event : window_.takeEvents(visible ? 0 : kIdle_s)) handle(event);
  listenToSpaceMouse();
  playScript();
  load();
  static constexpr double kFirst_s = 1.0 / 60;
  const double dt_s = ownClock()             ? kScriptStep_s
                      : pictures_ms_.empty() ? kFirst_s
                                             : static_cast<double>(pictures_ms_.back()) * 1e-3;
  const Stopwatch watch;
  followSession();
  moveStylus(dt_s);
  playTicks();
  draw(dt_s);
  if (closes_ && !afterQuestion_) {
    closes_ = false;
    leave([this] { isClosed_ = true; });
  }
  pictures_ms_.push_back(static_cast<float>(watch.elapsed_us() * 1e-3));
  if (std::exchange(madeScene_, false)) {
    scene_ms_ = pictures_ms_.back();
    passesAreNew_ = true;
  }
  constexpr std::size_t kCurve = 300;
  if (pictures_ms_.size() > kCurve) pictures_ms_.pop_front();
  ++pictures_;
  constexpr double kSmooth = 0.1;
  const double now = 1e3 / std::max(1e-3, double{pictures_ms_.back()});
  fps_ = fps_ > 0 ? fps_ + kSmooth * (now - fps_) : now;
}

void Viewer::playScript() {
  const auto& script = options_.script;
  if (nextAction_ >= script.size()) return;
  const auto waits = [&] {
    const bool savesFirst = afterQuestion_ && isSavingForIt_;  // another model follows, or the end
    const bool saves = ownClock() && session_ && session_->isSaving();
    return (loader_.isLoading() || announcesMesh_ || (savesFirst && !saveQuestion_) || saves) && !impatient_;
  };
  if (waits() || (ownClock() && !wasShown_)) return;
  const bool clicks = looks_ > 0 || nextAction_ < clickEnd_;  // that takes no time
  if (pictures_ > 0 && !clicks)
    scriptTime_s_ += ownClock() ? kScriptStep_s : std::min(kLongestStep_s, double{pictures_ms_.back()} * 1e-3);
  while (nextAction_ < script.size() && script[nextAction_].time_s <= scriptTime_s_) {
    const ScriptAction action = script[nextAction_++].action;
    act(action);
    // What follows finds the model loaded, and each press of a button a picture that has seen the one before.
    if (waits()) return;
    if (const auto* event = std::get_if<WindowEvent>(&action))
      if (std::holds_alternative<ButtonEvent>(*event) || std::holds_alternative<KeyEvent>(*event)) return;
    if (std::holds_alternative<ScreenshotAction>(action) || std::holds_alternative<ClickAction>(action)) return;
  }
}

void Viewer::act(const ScriptAction& action) {
  tryTo([&] {
    if (const auto* event = std::get_if<WindowEvent>(&action)) handle(*event);
    if (const auto* resize = std::get_if<ResizeAction>(&action)) window_.resize(resize->size_px);
    if (const auto* minimise = std::get_if<MinimiseAction>(&action)) window_.minimise(minimise->on);
    if (const auto* picture = std::get_if<ScreenshotAction>(&action)) screenshot(picture->file);
    if (const auto* state = std::get_if<StateAction>(&action)) writeState(state->file);
    if (const auto* save = std::get_if<SaveAction>(&action); save && session_) session_->save(save->file);
    if (const auto* record = std::get_if<RecordAction>(&action); record && session_)
      record->file.empty() ? session_->endRecording() : session_->record(record->file);
    if (const auto* replay = std::get_if<ReplayAction>(&action); replay && session_) playLog(replay->file);
    if (const auto* impatient = std::get_if<ImpatientAction>(&action)) impatient_ = impatient->on;
    if (std::holds_alternative<AskAction>(action)) asks_ = true;
    if (const auto* click = std::get_if<ClickAction>(&action)) this->click(click->name);
  });
}

// As a person does it: scrolls and goes there, presses and lets go, and then looks at what comes of it.
void Viewer::click(const std::string& name) {
  const auto place_px = panels_.placeOf(name);
  panels_.scrollTo(place_px ? std::string() : name);
  if (!place_px) {
    constexpr int kLooks = 20;  // in as many pictures: it may be about to come
    if (++looks_ < kLooks) {
      --nextAction_;
      return;
    }
    looks_ = 0;
    panels_.scrollTo({});
    throw Error("'{}' cannot be clicked: nothing of that name is shown in the panels", name);
  }
  looks_ = 0;
  handle(MouseEvent{*place_px});
  constexpr std::size_t kPictures = 4;  // one pressed; a panel that opens has its place after two more
  clickEnd_ = nextAction_ + kPictures;
  for (std::size_t i = 0; i < kPictures; ++i) {
    TimedAction button;
    button.time_s = scriptTime_s_;
    button.action = WindowEvent(ButtonEvent{MouseButton::left, i == 0});
    options_.script.insert(options_.script.begin() + static_cast<std::ptrdiff_t>(nextAction_ + i), button);
  }
}

void Viewer::tryTo(const std::function<void()>& act) {
  try {
    act();
  } catch (const DeviceLost&) {
    throw;
  } catch (const std::exception& error) {
    say(error.what());
  }
}

void Viewer::say(const std::string& message) {
  lastMessage_ = message;
  messages_.push_back({message, {}});
  context_.log().say("{}", message);
  constexpr std::size_t kMost = 5;
  if (messages_.size() > kMost) messages_.pop_front();
}

void Viewer::playLog(const std::string& log) {
  for (const std::string& sentence : session_->play(log)) say(log + ": " + sentence);
}

void Viewer::open(const std::string& file) {
  leave([this, file] {
    SessionOptions options = options_.session;
    options.model.file = file;
    loader_.open(options, tool_, feel_);
  });
}

void Viewer::leave(std::function<void()> then) {
  if (!session_ || !session_->isChanged() || !asks_) return then();
  saveQuestion_.reset();
  afterQuestion_ = std::move(then);
  isSavingForIt_ = session_->isSaving();  // what that leaves out is asked about afterwards
  if (window_.isMinimised()) window_.minimise(false);
}

void Viewer::load() {
  if (!loader_.isLoading()) return;
  for (const std::string& remark : loader_.takeRemarks()) {
    lastMessage_ = remark;
    messages_.push_back({remark, {}});
  }
  if (loader_.isRead() && session_) install(nullptr);
  if (loader_.isRead()) loader_.build();
  auto result = loader_.take();
  if (!result) return;
  if (result->session) {
    recent_.add(result->session->file());
    install(std::move(result->session));
  } else if (!result->failure.empty()) {
    std::erase(options_.models, loader_.file());  // nobody is offered it again
    say(result->failure);
  }
}

void Viewer::install(std::unique_ptr<Session> session) {
  holdStylus(false);
  presenter_->waitForLast();
  mesh_.reset();
  scene_.reset();
  tryTo([&] {
    if (session_) session_->endRecording();
  });
  session_ = std::move(session);
  view_.mesh = false;
  drag_ = Drag::none;
  toolRemark_.clear();
  saveQuestion_.reset();
  if (!session_) return;
  saveFile_ = session_->file();
  session_->setForces(forcesOn_);
  inStroke_ = false;
  fitCamera();
  const Upright& upright = session_->model().upright;
  if (!view_.up) say(fmt::format("up is {}: {}", nameOf(upright.up), upright.why));
  window_.setTitle(std::filesystem::path(session_->file()).filename().string() + " - palpate");
}

void Viewer::fitCamera() {
  fittedUp_ = view_.up;
  if (!session_) return;
  const DVec2 window = glm::max(DVec2(window_.size_px()), DVec2(1)), free = panels_.freeWidth_px(view_, window.x);
  camera_ = Camera::fitting(session_->model().shownBounds(), (free.y - free.x) / window.y, 45, up(),
                            framingOf(session_->model(), up()).margin);
  camera_.center.x = freeCenter(window.x);
}

UpAxis Viewer::up() const { return view_.up.value_or(session_ ? session_->model().upright.up : UpAxis::y); }

LengthUnit Viewer::unit() const {
  if (view_.unit || !session_) return view_.unit.value_or(LengthUnit::unknown);
  return unitSaidIn(session_->model().cloud.storedAs.comments);
}

void Viewer::sayLost(const std::string& failure) { say(failure + "; what was done is kept and can be saved"); }

void Viewer::followSession() {
  while (!messages_.empty() && messages_.front().since.elapsed_s() > kMessage_s) messages_.pop_front();
  if (!session_ || loader_.isRead()) return;
  const auto failure = session_->follow();
  edited_ = session_->takeBatch();
  if (failure) sayLost(*failure);
  if (const auto fault = session_->takeRecordingFault()) say(*fault);
  if (const auto saved = session_->takeSaved()) {
    const std::string kept = saved->kept.empty() ? "" : "; what was there before is " + saved->kept;
    say(saved->failure.empty() ? saved->file + " is saved" + kept : saved->failure);
    // Where the points have changed since, or could not be written, nothing is left behind.
    if (std::exchange(isSavingForIt_, false) && !(saved->failure.empty() && session_->isChanged())) {
      const auto then = std::exchange(afterQuestion_, nullptr);
      if (saved->failure.empty() && then) then();
    }
  }
  showPaint();
  updateMesh();
}

void Viewer::playTicks() {
  if (!ownClock() || !session_ || loader_.isRead()) return;
  if (const auto failure = session_->tickUntil(scriptTime_s_)) sayLost(*failure);
}

void Viewer::saveTo(const std::string& file) {
  session_->save(file);
  say("saving " + file);
}

void Viewer::save() {
  if (session_->isSaving()) return saveTo(saveFile_);  // which says so
  std::error_code ignored;
  if (!session_->isChanged() && std::filesystem::exists(saveFile_, ignored))
    return say(saveFile_ + " has the points as they are; there is nothing to save");
  const FileInTheWay inTheWay = fileInTheWay(saveFile_);
  if (!inTheWay.losesSomething()) return saveTo(saveFile_);
  saveQuestion_ = SaveQuestion{.loses = inTheWay.sentence(),
                               .beside = nameBeside(saveFile_).string(),
                               .kept = AtomicFile::nameToKeep(saveFile_).string()};
  if (!asks_) return answer({.saveBeside = true});
  if (window_.isMinimised()) window_.minimise(false);
}

// What is painted is to be seen.
void Viewer::showPaint() {
  const bool begins = session_->journal().inStroke() && !inStroke_;
  inStroke_ = session_->journal().inStroke();
  if (!begins || session_->tool().brush != BrushKind::paint || view_.color == ColorBy::rgb) return;
  view_.color = ColorBy::rgb;
  say("coloured by the points' own colours, which show what is painted");
}

void Viewer::answer(const ViewWishes& wishes) {
  if (wishes.discard && afterQuestion_) std::exchange(afterQuestion_, nullptr)();
  if (wishes.cancel) {
    afterQuestion_ = nullptr;
    saveQuestion_.reset();
    isSavingForIt_ = false;
  }
  if (!(wishes.saveBeside || wishes.saveOver) || !saveQuestion_ || !session_) return;
  if (wishes.saveBeside) saveFile_ = saveQuestion_->beside;
  saveQuestion_.reset();
  tryTo([&] { saveTo(saveFile_); });
}

void Viewer::obey(const ViewWishes& wishes) {
  answer(wishes);
  if (!wishes.open.empty()) open(wishes.open);
  if (wishes.quit) closes_ = true;
  if (!session_) return;
  tryTo([&] {
    if (wishes.saveFirst) {
      isSavingForIt_ = true;
      if (!session_->isSaving()) save();
    }
    if (wishes.undo) session_->undo();
    if (wishes.redo) session_->redo();
    if (wishes.save) save();
    if (!wishes.saveAs.empty()) saveTo(wishes.saveAs);
    if (!wishes.record.empty()) {
      session_->record(wishes.record);
      say("recording to " + wishes.record);
    }
    if (wishes.endRecording) session_->endRecording();
    if (!wishes.play.empty()) playLog(wishes.play);
    if (wishes.endPlaying) session_->endPlaying();
    if (wishes.exportTicks) exportTicks();
    if (wishes.screenshot) screenshot("");
  });
  if (wishes.resetView) fitCamera();
  if (wishes.axis) camera_ = alongAxis(camera_, *wishes.axis, true, up());
}

void Viewer::applySettings() {
  gui_.setDark(view_.dark);
  if (view_.up != fittedUp_) fitCamera();
  if (!session_ || gui_.isBusy()) return;  // not in the middle of a drag
  session_->setForces(forcesOn_);
  tryTo([&] {
    const bool recorded = session_->isRecording();
    session_->setTool(tool_);
    session_->setFeel(feel_);
    if (recorded && !session_->isRecording()) say("the recording has ended: a log has one tool");
  });
  remarkOnTool();
}

// Once for each tool that edits nothing, and again with each press of it.
void Viewer::remarkOnTool() {
  const ToolSettings& tool = session_->tool();
  const Model& model = session_->model();
  const std::string remark =
      tool.brush ? tooSmallTool(tool.radius_mm, model.scale.toMm(model.spacing), "its radius (key ])") : std::string();
  if (remark != std::exchange(toolRemark_, remark) && !remark.empty()) say(remark);
}

void Viewer::exportTicks() {
  const auto& rows = session_->history().rows();
  Trace trace{.rows = {rows.begin(), rows.end()}, .virtualTime = false};
  const std::string file = freeName("-ticks", "csv");
  writeTraceCsv(file, trace);
  say(fmt::format("{} ticks are in {}", rows.size(), file));
}

void Viewer::writeState(const std::string& file) {
  const auto vec = [](const DVec3& v) { return Json{v.x, v.y, v.z}; };
  Json state{{"model", session_ ? Json(session_->file()) : Json(nullptr)},
             {"points", 0},
             {"camera", {{"eye", vec(camera_.eye)}, {"target", vec(camera_.target)}, {"up", vec(camera_.up)}}},
             {"size", {presenter_->size_px().x, presenter_->size_px().y}},
             {"tool", nullptr},
             {"stylus", stylus_ || options_.session.device},
             {"mesh_triangles", mesh_ ? mesh_->triangleCount() : 0},
             {"fps", fps_},
             {"pictures", pictures_},
             {"pictures_of_model", scenes_},
             {"picked_depth", picked_.depth},
             {"asks_about_changes", asksAboutChanges()},
             {"asks_how_to_save", saveQuestion_.has_value()},
             {"last_message", lastMessage_}};
  if (session_) {
    const TickHistory& history = session_->history();
    const TraceRow row = history.rows().empty() ? TraceRow{} : history.rows().back();
    const Journal& journal = session_->journal();
    const auto there = std::ranges::count_if(journal.points(), [](const PointState& point) { return !point.gone(); });
    state["model"] = session_->file();
    state["points"] = there;
    state["tool"] = "feel";
    for (const auto& [name, kind] : kBrushKinds)
      if (session_->tool().brush == kind) state["tool"] = name;
    for (const auto& [name, kind] : kSurfaceKinds)
      if (session_->feel().surface == kind) state["surface"] = name;
    state["up"] = nameOf(up());
    for (const auto& [name, color] : kColorNames)
      if (view_.color == color) state["color"] = name;
    state["tool_radius_mm"] = session_->tool().radius_mm;
    state["strokes"] = journal.strokes();
    state["undoable"] = journal.undoable();
    state["edits"] = session_->edits();
    state["changed"] = session_->isChanged();
    state["save_file"] = saveFile_;
    state["recording"] = session_->isRecording();
    state["hip"] = vec(row.hip);
    state["proxy"] = vec(row.proxy);
    state["contact"] = row.contact;
    state["penetration_mm"] = row.penetration_mm;
    state["force_N"] = vec(row.force_N);
    double peak_N = 0;
    for (const TraceRow& each : history.rows()) peak_N = std::max(peak_N, glm::length(each.force_N));
    state["peak_force_N"] = peak_N;
    state["ticks"] = history.ticks();
    state["missed_ticks"] = history.missed();
    state["step_us"] = {{"p50", history.step_us().quantile_us(0.5)}, {"p999", history.step_us().quantile_us(0.999)}};
    state["forces_on"] = session_->forcesOn();
    state["backend"] = session_->backendName();
  }
  AtomicFile out(file);
  out.write(state.dump(2) + "\n");
  out.commit();
}

}  // namespace palpate
