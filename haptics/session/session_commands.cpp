// How commands reach a session: at once where no servo loop runs, else between two ticks of the loop.
#include <algorithm>
#include <array>
#include <charconv>
#include <cstring>
#include <utility>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/motion/depth_player.hpp"
#include "haptics/session/session.hpp"
#include "haptics/session/session_setup.hpp"

namespace palpate {

namespace {

std::size_t countIn(const std::string& content) {
  std::size_t count = 0;
  std::from_chars(content.data(), content.data() + content.size(), count);
  return count;
}

std::string bytesOf(std::span<const double> numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes()};
}

constexpr std::size_t kContactNumbers = 17;

void visitContact(StateNumbers& visit, ProxyTracker::State& state) {
  visit(state.started, state.touching, state.sticks, state.face, state.facing, state.lastHip, state.proxy,
        state.velocity, state.time_s);
}

}  // namespace

template <class Act>
bool Session::onLoop(Act act) {
  if (mailbox_.isOpen()) return mailbox_.post(act);
  if (running_) act();
  return running_ != nullptr;
}

void Session::borrow(bool endsRecording) {
  if (loans_ > 0) {
    ++loans_;
    return;
  }
  notes_.clear();
  const bool had = isLent_;  // by lend()
  isLent_ = onLoop([this, endsRecording]() noexcept { lent_ = running_->lend(endsRecording); });
  ++loans_;
  try {
    if (isLent_ && !had && !endsRecording) addToRecording(lent_.tick, {.kind = LoggedCommand::Kind::lend});
    if (isLent_ || (live_ && live_->isStarted())) takeEdits();
  } catch (...) {
    giveBack();
    throw;
  }
}

// If the loop does not take it back in time, the planes fade, and the next command takes it back.
void Session::giveBack() noexcept {
  if (--loans_ > 0 || !isLent_) return;
  try {
    const RunningLoop::Return with{
        .force = config_.force, .sculpts = config_.brush.has_value(), .recording = recording_.get(), .state = state_};
    std::uint64_t tick = 0;
    isLent_ = false;
    if (!onLoop([this, &with, &tick]() noexcept { tick = running_->takeBack(with); })) return;
    if (!contacts_.empty()) {
      state_.insert(state_.end(), contacts_.begin(), contacts_.end());
      contacts_.clear();
      recording_->add({.tick = tick, .kind = LoggedCommand::Kind::begin, .content = bytesOf(state_)});
      return;
    }
    if (notes_.empty()) notes_.push_back({.kind = LoggedCommand::Kind::back});
    for (LoggedCommand& each : notes_) addToRecording(tick, std::move(each));
  } catch (const std::exception& error) {
    if (log_) log_->warn("{}", error.what());
  }
}

void Session::addToRecording(std::uint64_t tick, LoggedCommand command) {
  if (!recording_) return;
  command.tick = tick;
  recording_->add(std::move(command));
}

void Session::note(LoggedCommand::Kind kind, std::string content) {
  if (recording_) notes_.push_back({.kind = kind, .content = std::move(content)});
}

void Session::lend() {
  isLent_ = onLoop([this]() noexcept { lent_ = running_->lend(false); });
}

// After a fault of a device the back end is sound.
void Session::takeEdits() {
  const bool hasEnded = live_ && live_->hasEnded();
  if (!hasEnded || live_->fault().empty() || live_->deviceFailed()) backend_->finish();
  relay_.catchUp();
}

void Session::park() {
  if (live_ && live_->pause()) takeEdits();
}

void Session::goOn() {
  if (live_ && live_->fault().empty()) resume();
}

void Session::resume() {
  if (live_->isStarted()) return;
  mailbox_.open(live_->clock().get());
  try {
    live_->goOn();
  } catch (...) {
    mailbox_.close();
    throw;
  }
}

// For a recording alone: JSON takes memory.
std::string Session::textFor(const SessionConfig& config) const {
  return recording_ ? configText(config) : std::string();
}

void Session::setBrush(const std::optional<BrushConfig>& brush) {
  SessionConfig next = config_;
  next.brush = brush;
  next = checked(std::move(next), kind_);
  std::optional<BrushOptions> options;
  if (brush) options = brushOptions(*brush, model_->scale);
  between([&] {
    std::string text = textFor(next);
    backend_->setBrush(options);
    config_ = std::move(next);
    note(LoggedCommand::Kind::brush, std::move(text));
  });
}

void Session::setContact(const SurfaceConfig& surface, const ForceOptions& force, const std::string& method) {
  SessionConfig next = config_;
  next.surface = surface;
  next.force = force;
  next.backend.method = method;
  next = checked(std::move(next), kind_);
  validate(force);
  std::string text = textFor(next);
  const bool isSame = next.surface == config_.surface && next.backend == config_.backend;
  if (isSame && !simulation() && loans_ == 0 && !isLent_) {
    std::uint64_t tick = 0;
    const bool isRunning = onLoop([this, &next, &tick]() noexcept { tick = running_->setForce(next.force); });
    config_ = std::move(next);
    if (isRunning) addToRecording(tick, {.kind = LoggedCommand::Kind::contact, .content = std::move(text)});
    return;
  }
  between([&] {
    if (!isSame) backend_->setContact(next.surface.kind, next.surface.friction, kind_.methodOf(next.backend));
    config_ = std::move(next);
    if (live_ && simulation()) backend_->begin(true, springs(live_->hands()));
    note(LoggedCommand::Kind::contact, std::move(text));
  });
}

void Session::setParameter(std::string_view name, double value) {
  if (!simulation()) throw Error("{}: the model is not simulated", name);
  simulation()->set(name, value);
  config_.model.matter = config_.model.matter->with(name, value);
  std::uint64_t tick = 0;
  if (recording_ && onLoop([this, &tick]() noexcept { tick = running_->noteCommand(); }))
    addToRecording(tick, {.kind = LoggedCommand::Kind::parameter, .content = fmt::format("{} {}", name, value)});
}

void Session::setFrames(Frames frames) {
  if (!player()) return;
  between([&] {
    constexpr std::array<const char*, 3> kNames{"play", "pause", "step"};
    if (frames == Frames::play) player()->play(next_s());
    if (frames == Frames::pause) player()->pause(next_s());
    if (frames == Frames::step) player()->step();
    note(LoggedCommand::Kind::frames, kNames[static_cast<std::size_t>(frames)]);
  });
}

UndoneStrokes Session::undo(std::size_t strokes, std::size_t redo) {
  require(Action::undo, "undo");
  return between([&] {
    ShapeStrokes* const shape = backend_->shapeStrokes();
    if (!shape && !journal()) throw Error("a session without a journal has no strokes to undo");
    const UndoneStrokes done =
        shape ? undoStrokes(*shape, strokes, redo)
              : undoStrokes(
                    *backend_->edits(), *relay_.journal(), [this] { relay_.catchUp(); }, strokes, redo);
    if (done.undone > 0) note(LoggedCommand::Kind::undo, std::to_string(done.undone));
    if (done.redone > 0) note(LoggedCommand::Kind::redo, std::to_string(done.redone));
    return done;
  });
}

std::shared_ptr<PlayedStream> Session::releaseStream(double time_s) {
  if (!player()) return nullptr;
  backend_->finish();
  player()->hold(time_s);
  return std::make_shared<PlayedStream>(std::exchange(*stream_, {}));
}

void Session::record(const std::string& file, const OpenHand& hand, RecordingFault onFault, const RunOptions& run) {
  require(Action::record, file);
  if (!journal()) throw Error("{}: a session without a journal cannot be recorded; its end would not be known", file);
  SessionConfig config = config_;
  config.realtime = config.realtime || run.realtime;
  if (run.rate_Hz > 0) config.rate_Hz = run.rate_Hz;
  const Loan loan(*this);
  auto begun = std::make_unique<SessionRecording>(file,
                                                  RecordedSession{.config = config,
                                                                  .built = built_,
                                                                  .paintable = isPaintable_,
                                                                  .points = model_->cloud.size(),
                                                                  .checksum = checksumOf(*model_),
                                                                  .machine = machine_,
                                                                  .palpate = PALPATE_VERSION,
                                                                  .limits = hand.device->limits(),
                                                                  .map = hand.map,
                                                                  .passivity = hand.passivity},
                                                  backend_->edits(), std::move(onFault));
  if (isLent_) beginBetween(*begun);
  recording_ = std::move(begun);
  relay_.setLog(&recording_->writer());
}

// The session and its replay continue from the same states.
void Session::beginBetween(SessionRecording& recording) {
  const std::vector<ProxyTracker::State> contacts = backend_->contacts();
  std::vector<double> numbers(kContactNumbers * contacts.size());
  StateNumbers to = StateNumbers::to(numbers);
  for (ProxyTracker::State contact : contacts) visitContact(to, contact);
  state_.assign(lent_.numbers, 0);
  backend_->restoreContacts(contacts);
  contacts_ = std::move(numbers);
  recording.beginAt(next_s());
}

void Session::restore(std::string_view content, std::vector<double>& loopState) {
  std::vector<double> numbers(content.size() / sizeof(double));
  std::memcpy(numbers.data(), content.data(), numbers.size() * sizeof(double));
  std::vector<ProxyTracker::State> contacts(backend_->contacts().size());
  const std::size_t own = kContactNumbers * contacts.size();
  if (numbers.size() <= own) throw Error("the beginning of the recording does not fit this session");
  StateNumbers from = StateNumbers::from(std::span(numbers).last(own));
  for (ProxyTracker::State& contact : contacts) visitContact(from, contact);
  backend_->restoreContacts(contacts);
  loopState.assign(numbers.begin(), numbers.end() - static_cast<std::ptrdiff_t>(own));
}

std::unique_ptr<SessionRecording> Session::releaseRecording() {
  if (!recording_) return nullptr;
  const Loan loan(*this, true);
  relay_.setLog(nullptr);
  contacts_.clear();
  return std::exchange(recording_, nullptr);
}

void Session::endRecording() {
  const std::unique_ptr<SessionRecording> ended = releaseRecording();
  if (ended) ended->finish(checksumOf(model_->cloud.origin, journal()->points()));
}

void Session::repeat(const LoggedCommand& command) {
  using Kind = LoggedCommand::Kind;
  switch (command.kind) {
    case Kind::begin:
      return;
    case Kind::lend:
      return lend();
    case Kind::back:
      return between([] {});
    case Kind::undo:
      undo(countIn(command.content), 0);
      return;
    case Kind::redo:
      undo(0, countIn(command.content));
      return;
    case Kind::brush:
      return setBrush(parseConfig(command.content).brush);
    case Kind::contact: {
      const SessionConfig next = parseConfig(command.content);
      return setContact(next.surface, next.force, next.backend.method);
    }
    case Kind::parameter: {
      const std::size_t end = command.content.find(' ');
      if (end == std::string::npos) return;
      return setParameter(command.content.substr(0, end), std::stod(command.content.substr(end + 1)));
    }
    case Kind::frames:
      return setFrames(command.content == "play"    ? Frames::play
                       : command.content == "pause" ? Frames::pause
                                                    : Frames::step);
  }
}

}  // namespace palpate
