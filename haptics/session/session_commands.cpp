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

void requireFinite(std::string_view name, const PointState& state) {
  if (!isFinite(state.position)) throw Error("{}: point {} would be infinitely far away", name, state.number);
}

std::size_t countIn(const std::string& content) {
  std::size_t count = 0;
  std::from_chars(content.data(), content.data() + content.size(), count);
  return count;
}

}  // namespace

// After a fault of a device the back end is sound.
void Session::takeEdits() {
  const bool hasEnded = live_ && live_->hasEnded();
  if (!hasEnded || live_->fault().empty() || live_->deviceFailed()) backend_->finish();
  relay_.catchUp();
}

void Session::pause() {
  if (live_ && live_->pause()) takeEdits();
}

void Session::resume() {
  if (live_ && live_->fault().empty()) live_->resume();
}

// For a recording alone: JSON takes memory.
std::string Session::textFor(const SessionConfig& config) const {
  return recording() ? configText(config) : std::string();
}

void Session::setBrush(const std::optional<BrushConfig>& brush) {
  SessionConfig next = config_;
  next.brush = brush;
  next = checked(std::move(next), kind_);
  const std::optional<BrushOptions> options = brushOf(brush, model());
  between([&] {
    std::string text = textFor(next);
    backend_->setBrush(options);
    config_ = std::move(next);
    channel_.note(LoggedCommand::Kind::brush, std::move(text));
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
  if (isSame && !simulation() && channel_.isFree()) {
    const auto tick = channel_.post([&next](RunningLoop& loop) noexcept { return loop.setForce(next.force); });
    config_ = std::move(next);
    if (pulled_) pulled_->setForce(config_.force);
    if (tick) channel_.add(*tick, {.kind = LoggedCommand::Kind::contact, .content = std::move(text)});
    return;
  }
  between([&] {
    if (!isSame) backend_->setContact(next.surface.kind, next.surface.friction, kind_.methodOf(next.backend));
    config_ = std::move(next);
    if (live_ && simulation()) backend_->begin(true, springs(live_->hands()));
    if (pulled_) pulled_->setForce(config_.force);
    channel_.note(LoggedCommand::Kind::contact, std::move(text));
  });
}

void Session::setParameter(std::string_view name, double value) {
  if (!simulation()) throw Error("{}: the model is not simulated", name);
  simulation()->set(name, value);
  config_.model.matter = config_.model.matter->with(name, value);
  if (!recording()) return;
  if (const auto tick = channel_.post([](RunningLoop& loop) noexcept { return loop.noteCommand(); }))
    channel_.add(*tick, {.kind = LoggedCommand::Kind::parameter, .content = fmt::format("{} {}", name, value)});
}

void Session::setFrames(Frames frames) {
  if (!player()) return;
  between([&] {
    constexpr std::array<const char*, 3> kNames{"play", "pause", "step"};
    if (frames == Frames::play) player()->play(next_s());
    if (frames == Frames::pause) player()->pause(next_s());
    if (frames == Frames::step) player()->step();
    channel_.note(LoggedCommand::Kind::frames, kNames[static_cast<std::size_t>(frames)]);
  });
}

UndoneStrokes Session::undo(std::size_t strokes, std::size_t redo) {
  require(Action::undo, "undo");
  return between([&] {
    if (!history()) throw Error("a session without a history has no strokes to undo");
    const UndoneStrokes done = relay_.undo(strokes, redo);
    if (done.undone > 0) channel_.note(LoggedCommand::Kind::undo, std::to_string(done.undone));
    if (done.redone > 0) channel_.note(LoggedCommand::Kind::redo, std::to_string(done.redone));
    return done;
  });
}

// A stroke that has ended before the edits are taken in is not in progress; one that ends with the loan is.
bool Session::cancelStroke(const std::function<void()>& rest) {
  require(Action::undo, "cancel");
  if (!history()) throw Error("a session without a history has no stroke to cancel");
  relay_.catchUp();
  const std::uint64_t before = history()->counts().strokes;
  return between([&] {
    if (rest) rest();
    if (!live_ || !live_->isStarted()) {
      backend_->finish();
      relay_.catchUp();
    }
    const StrokeCounts counts = history()->counts();
    if (counts.strokes == before) return false;
    backend_->awaitRelease();
    if (counts.undoCount == 0 || !relay_.takeBack())
      throw Error("the stroke is larger than the memory for undo, and stays");
    channel_.note(LoggedCommand::Kind::cancel, {});
    return true;
  });
}

const LayerAttributes& Session::attributesFor(Action action, std::string_view what) const {
  require(action, what);
  if (!pointHistory()) throw Error("{}: the session does not follow its points", what);
  return scene_.layers[0].attributes;
}

void Session::change(AttributeChange change) {
  constexpr std::array<std::pair<Action, const char*>, std::variant_size_v<AttributeChange>> kActionOf{
      {{Action::select, "select"}, {Action::field, "field"}, {Action::field, "field"}, {Action::layer, "layer"}}};
  const char* const what = kActionOf[change.index()].second;
  const LayerAttributes& attributes = attributesFor(kActionOf[change.index()].first, what);
  between([&] {
    if (!attributes.fits(change)) throw Error("a recorded change of a {} does not fit; the session differs", what);
    auto* const layer = std::get_if<StrokeLayerChange>(&change);
    if (layer && layer->moves != StrokeLayerChange::Points::none)
      relay_.slide(std::move(*layer));
    else
      relay_.change(std::move(change));
    channel_.note(LoggedCommand::Kind::attribute, {});
  });
}

void Session::setMask(MaskRole role, const PointSet& points) {
  const LayerAttributes& attributes = attributesFor(Action::select, "select");
  if (role == MaskRole::locked && attributes.hasLockField(model().cloud)) {
    std::vector<std::uint8_t> weights(history()->points().size());
    points.forEach([&](std::uint64_t point) {
      if (point < weights.size()) weights[point] = PointLock::kWhole;
    });
    return setLockWeights(weights);
  }
  between([&] {
    MaskFlip flip{.role = role, .points = attributes.mask(role)};
    flip.points.flip(points);
    if (!flip.points.empty()) change(std::move(flip));
  });
}

std::vector<std::uint8_t> Session::lockWeights() const {
  return attributesFor(Action::select, "lock").lockWeights(model().cloud, history()->points());
}

std::size_t Session::lockedByFile() const {
  const LayerAttributes& attributes = scene_.layers[0].attributes;
  if (!attributes.hasLockField(model().cloud)) return 0;
  return static_cast<std::size_t>(std::ranges::count_if(
      attributes.lockWeights(model().cloud, PointStates(model().cloud)), [](std::uint8_t own) { return own > 0; }));
}

void Session::setLockWeights(std::span<const std::uint8_t> given) {
  const LayerAttributes& attributes = attributesFor(Action::select, "lock");
  between([&] {
    const PointStates& states = history()->points();
    const std::size_t points = states.size();
    if (given.size() < model().cloud.size() || given.size() > points)
      throw Error("lock: {} weights for {} points", given.size(), points);
    std::vector<std::uint8_t> weights(given.begin(), given.end());
    weights.resize(points);  // a point that was undone is its own parent
    for (std::size_t point = given.size(); point < points; ++point) weights[point] = weights[states[point].parent];
    const bool hasField = attributes.hasLockField(model().cloud);
    PointSet locked, changed;
    std::vector<std::byte> values;
    const std::vector<std::uint8_t> had = hasField ? lockWeights() : std::vector<std::uint8_t>(points);
    bool isInPart = false;
    for (std::size_t point = 0; point < points; ++point) {
      if (weights[point] == PointLock::kWhole) locked.set(point);
      isInPart = isInPart || (weights[point] > 0 && weights[point] < PointLock::kWhole);
      if (weights[point] == had[point]) continue;
      changed.set(point);
      values.push_back(std::byte{weights[point]});
    }
    if (!hasField && !isInPart) return setMask(MaskRole::locked, locked);
    if (!changed.empty()) setField(kLockField, ScalarType::u8, changed, std::move(values));
  });
}

std::uint32_t Session::fieldNamed(std::string_view name, ScalarType type) {
  const LayerAttributes& attributes = attributesFor(Action::field, name);
  if (const auto number = attributes.fieldNamed(name)) return *number;
  return between([&] {
    FieldPresence made = initialField(model().cloud, history()->points(), name, type, attributes.fields().size());
    const std::uint32_t number = made.field;
    change(std::move(made));
    return number;
  });
}

void Session::setField(std::uint32_t field, const PointSet& points, std::vector<std::byte> values) {
  const std::vector<Field>& fields = attributesFor(Action::field, "field").fields();
  if (field >= fields.size())
    throw Error("field: the model has {} fields, and none with number {}", fields.size(), field);
  between([&] {
    const Attribute& had = fields[field].values;
    const std::size_t bytes = sizeOf(had.type);
    if (points.end() * bytes > had.data.size())
      throw Error("{}: the model has no point {}", had.name, points.end() - 1);
    if (points.count() * bytes != values.size())
      throw Error("{}: {} points require {} bytes, not {}", had.name, points.count(), points.count() * bytes,
                  values.size());
    if (!points.empty()) change(FieldChange{.field = field, .points = points, .values = std::move(values)});
  });
}

void Session::setField(std::string_view name, ScalarType type, const PointSet& points, std::vector<std::byte> values) {
  const LayerAttributes& attributes = attributesFor(Action::field, name);
  const auto requireType = [&](ScalarType has) {
    if (has != type) throw Error("{}: its values are {}, not {}", name, plyName(has), plyName(type));
  };
  between([&] {
    if (const auto number = attributes.fieldNamed(name)) {
      requireType(attributes.fields()[*number].values.type);
      return setField(*number, points, std::move(values));
    }
    FieldPresence made = initialField(model().cloud, history()->points(), name, type, attributes.fields().size());
    requireType(static_cast<ScalarType>(made.type));
    const std::size_t bytes = sizeOf(type);
    made.values.resize(made.points * bytes);
    if (points.end() > made.points || points.count() * bytes != values.size())
      throw Error("{}: {} values for {} points, the last of which is {}", name, values.size() / bytes, points.count(),
                  points.end() - 1);
    auto next = values.begin();
    points.forEach([&](std::uint64_t point) {
      std::copy_n(next, bytes, made.values.begin() + static_cast<std::ptrdiff_t>(point * bytes));
      next += static_cast<std::ptrdiff_t>(bytes);
    });
    change(std::move(made));
  });
}

void Session::setStrokeLayer(std::uint32_t number, StrokeLayer set, bool isOpen, bool continues) {
  const StrokeLayers& layers = attributesFor(Action::layer, "layer").strokeLayers();
  if (number > layers.size())
    throw Error("layer: the model has {} layers, and none with number {}", layers.size(), number);
  if (number < layers.size() && layers[number].isMerged)
    throw Error("layer {}: its strokes were merged into the model", layers[number].name);
  if (!(set.strength >= kMinLayerStrength && set.strength <= kMaxLayerStrength))
    throw Error("layer {}: the strength must be from {} to {}, not {}", set.name, kMinLayerStrength, kMaxLayerStrength,
                set.strength);
  between([&] {
    using Points = StrokeLayerChange::Points;
    StrokeLayerChange change{.number = number, .set = std::move(set), .open = layers.open()};
    if (isOpen) {
      change.open = number;
      change.set.strength = 1;
      change.set.isHidden = false;
    } else if (change.open == number) {
      change.open.reset();
    }
    if (number < layers.size()) change.set.held = layers[number].held;
    if (number < layers.size() && layers[number] == change.set && layers.open() == change.open) return;
    if (number < layers.size() && layers[number].shown() != change.set.shown())
      change.moves = continues ? Points::slideContinued : Points::slide;
    this->change(std::move(change));
  });
}

void Session::changePoints(const PointSet& points, const PointsAction& action) {
  constexpr std::array<std::pair<Action, const char*>, std::variant_size_v<PointsAction>> kActionOf{
      {{Action::carve, "remove"}, {Action::paint, "paint"}, {Action::sculpt, "move"}, {Action::sculpt, "set"}}};
  const char* const name = kActionOf[action.index()].second;
  attributesFor(kActionOf[action.index()].first, name);
  validate(action);
  between([&] {
    const PointStates& present = history()->points();
    const auto note = [&] {
      channel_.note(LoggedCommand::Kind::points, recording() ? bytesIn(action, points) : std::string());
    };
    if (std::holds_alternative<RemovePoints>(action)) {
      const PointSet there = existing(points, present);
      if (there.empty()) return;
      relay_.changePresence(there);
      return note();
    }
    const auto* const set = std::get_if<SetPoints>(&action);
    if (!set) {
      BareVector<PointState> after = statesAfter(points, present, action);
      for (const PointState& to : after) requireFinite(name, to);
      if (after.empty()) return;
      relay_.changeMany(std::move(after));
      return note();
    }
    std::vector<PointChange> changes;
    std::uint64_t next = present.size();
    for (const PointState& to : set->states) {
      if (to.number > next || to.parent >= present.size())
        throw Error("{}: the model has {} points, and no point {}", name, present.size(),
                    to.number > next ? to.number : to.parent);
      if (to.number == next) require(Action::insertPoints, name), ++next;
      requireFinite(name, to);
      if (const PointState from = present[to.number]; from != to) changes.push_back({.from = from, .to = to});
    }
    if (changes.empty()) return;
    relay_.setPoints(changes);
    note();
  });
}

EditBatch Session::attributeHistory() {
  const Abilities can = abilities();
  return pointHistory() && can.allow(Action::select) ? relay_.attributeHistory() : EditBatch();
}

void Session::followAgain(const EditBatch& edits) {
  if (edits.empty()) return;
  relay_.followAgain(edits);
  const PointStates before(model().cloud);
  std::vector<PointChange> changes;
  for (const PointState& state : history()->points()) {
    const PointState from = before[state.number];
    if (!(from == state)) changes.push_back({from, state});
  }
  if (!changes.empty()) backend_->edits()->change(changes);
  catchUp();
  relay_.applyMasks();
}

std::shared_ptr<PlayedStream> Session::releaseStream(double time_s) {
  if (!player()) return nullptr;
  backend_->finish();
  player()->hold(time_s);
  return std::make_shared<PlayedStream>(std::exchange(*stream_, {}));
}

void Session::repeat(const LoggedCommand& command) {
  using Kind = LoggedCommand::Kind;
  switch (command.kind) {
    case Kind::begin:
      return;
    case Kind::lend:
      return channel_.lend();
    case Kind::back:
      return between([] {});
    case Kind::undo:
      undo(countIn(command.content), 0);
      return;
    case Kind::redo:
      undo(0, countIn(command.content));
      return;
    case Kind::cancel:
      cancelStroke();
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
    case Kind::attribute:
      return;  // change()
    case Kind::points: {
      if (const auto read = readPointsAction(command.content)) changePoints(read->second, read->first);
      return;  // else the log is damaged
    }
  }
}

}  // namespace palpate
