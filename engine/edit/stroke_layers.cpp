#include "engine/edit/stroke_layers.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "engine/cloud/shortest_rotation.hpp"
#include "engine/core/check.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kNone = StrokeLayerPoint::kNone;
constexpr std::uint64_t kPage = 4096;

bool hasNoEffect(const StrokeLayerPoint& strokes) {
  return isSameToTheBit(strokes.before, strokes.after) || (strokes.before.gone && strokes.after.gone);
}

std::uint32_t mixedColor(std::uint32_t a, std::uint32_t b, double strength) {
  if (a == b || a == 0 || b == 0) return strength < kRemovesFrom ? a : b;
  std::uint32_t mixed = 0;
  for (int shift = 0; shift < 32; shift += 8) {
    const double from = a >> shift & 255u, to = b >> shift & 255u;
    const double value = std::clamp(std::round(from + strength * (to - from)), 0.0, 255.0);
    mixed |= static_cast<std::uint32_t>(value) << shift;
  }
  return mixed;
}

bool isSameBits(const Vec3& a, const Vec3& b) {
  return isSameToTheBit(PointState{.position = a}, PointState{.position = b});
}

}  // namespace

std::uint32_t StrokeLayers::Layer::last(std::uint64_t point) const {
  const std::uint64_t page = point / kPage;
  return page < pages.size() && !pages[page].empty() ? pages[page][point % kPage] : kNone;
}

void StrokeLayers::Layer::setLast(std::uint64_t point, std::uint32_t index) {
  const std::uint64_t page = point / kPage;
  if (page >= pages.size()) pages.resize(page + 1);
  if (pages[page].empty()) pages[page].assign(kPage, kNone);
  pages[page][point % kPage] = index;
}

const StrokeLayerPoint& StrokeLayers::Layer::first(std::uint32_t index) const {
  while (points[index].earlier != kNone) index = points[index].earlier;
  return points[index];
}

PointState StrokeLayers::Layer::before(std::uint64_t point, const PointStates& present) const {
  const std::uint32_t index = last(point);
  return index == kNone ? present[point] : first(index).before;
}

void StrokeLayers::Layer::extend(const PointState& from, const PointState& to, const PointStates& present) {
  shape = {};
  std::uint32_t index = last(to.number);
  while (index != kNone && points[index].earlier != kNone && hasNoEffect(points[index]) &&
         !isSameToTheBit(points[index].after, from))
    index = points[index].earlier;
  if (index != kNone && isSameToTheBit(points[index].after, from)) {
    points[index].after = to;
  } else if (index != kNone && hasNoEffect(points[index])) {
    points[index].before = from;
    points[index].after = to;
  } else {
    points.push_back({.before = from, .after = to, .earlier = index});
    index = static_cast<std::uint32_t>(points.size() - 1);
  }
  setLast(to.number, index);
  if (!points[index].before.gone || to.gone || to.parent == to.number) return;
  PointState& parent = points[index].before = before(to.parent, present);
  parent.number = to.number;
  parent.parent = to.parent;
  parent.gone = true;
}

std::optional<std::uint32_t> StrokeLayers::named(std::string_view name) const {
  for (std::uint32_t i = 0; i < layers_.size(); ++i)
    if (layers_[i].set.name == name && !layers_[i].set.isMerged) return i;
  return std::nullopt;
}

std::size_t StrokeLayers::pointsOf(std::size_t number) const {
  const Layer& layer = layers_[number];
  std::size_t count = 0;
  for (std::uint32_t i = 0; i < layer.points.size(); ++i)
    count += layer.isLast(i) && (layer.points[i].earlier != kNone || !hasNoEffect(layer.points[i]));
  return count;
}

std::uint64_t StrokeLayers::bytes() const {
  std::uint64_t sum = removed_.bytes();
  for (const Layer& layer : layers_) {
    sum += layer.points.capacity() * sizeof(StrokeLayerPoint);
    for (const auto& page : layer.pages) sum += page.capacity() * sizeof page[0];
    sum += layer.shape.bytes();
  }
  return sum;
}

bool StrokeLayers::fits(const StrokeLayerChange& change) const {
  const bool isMade = change.isPresent && change.number == layers_.size();
  if (change.layer != 0 || change.number > layers_.size()) return false;
  if (!change.isPresent && std::size_t{change.number} + 1 != layers_.size()) return false;
  if (change.isPresent && !isMade && !(change.points.empty() && change.places.empty())) return false;
  if (!(change.set.strength >= kMinLayerStrength && change.set.strength <= kMaxLayerStrength)) return false;
  const std::size_t count = change.isPresent ? layers_.size() + isMade : layers_.size() - 1;
  if (change.open && *change.open >= count) return false;
  for (std::size_t i = 0; i < change.points.size(); ++i) {
    const StrokeLayerPoint& point = change.points[i];
    if (point.before.number != point.after.number || (point.earlier != kNone && point.earlier >= i)) return false;
  }
  return std::ranges::is_sorted(change.places, {}, &LayerPlace::number) &&
         std::ranges::is_sorted(change.set.held, {}, &HeldPoint::number);
}

void StrokeLayers::exchange(StrokeLayerChange& change) {
  PALPATE_CHECK(fits(change));
  change.moves = StrokeLayerChange::Points::none;
  if (!change.isPresent) {
    change.set = std::move(layers_.back().set);
    change.points = std::move(layers_.back().points);
    change.places.assign(layers_.back().shape.places().begin(), layers_.back().shape.places().end());
    layers_.pop_back();
    change.isPresent = true;
  } else if (change.number < layers_.size()) {
    Layer& layer = layers_[change.number];
    std::swap(change.set, layer.set);
    if (layer.isWhole()) layer.shape = {};  // found again when it is needed
  } else {
    Layer made{.set = change.set};
    for (std::uint32_t i = 0; i < change.points.size(); ++i) made.setLast(change.points[i].after.number, i);
    made.points = std::move(change.points);
    made.shape = LayerShape(std::move(change.places));
    layers_.push_back(std::move(made));
    change.points.clear();
    change.places.clear();
    change.isPresent = false;
  }
  std::swap(change.open, open_);
}

std::vector<AttributeChange> StrokeLayers::all() const {
  std::vector<AttributeChange> changes;
  for (std::uint32_t i = 0; i < layers_.size(); ++i) {
    StrokeLayerChange made{.number = i, .set = layers_[i].set, .points = layers_[i].points};
    const auto places = layers_[i].shape.places();
    if (!layers_[i].isWhole()) made.places.assign(places.begin(), places.end());
    if (i + 1 == layers_.size()) made.open = open_;
    changes.emplace_back(std::move(made));
  }
  return changes;
}

// Those that the stroke inserted come last, as their parents must have been recorded.
void StrokeLayers::record(std::uint32_t number, std::span<const PointState> before, const PointStates& present) {
  Layer& layer = layers_[number];
  for (const bool inserted : {false, true})
    for (const PointState& from : before) {
      const PointState to = present[from.number];
      if ((from.gone && !to.gone) == inserted && !isSameToTheBit(from, to)) layer.extend(from, to, present);
    }
}

LayerRecord StrokeLayers::Layer::recordOf(std::uint32_t index, const PointStates& present) const {
  const StrokeLayerPoint& last = points[index];
  LayerRecord record{.before = first(index).before, .after = last.after, .present = present[last.after.number]};
  for (std::uint32_t i = index; i != kNone; i = points[i].earlier)
    record.displacement += DVec3(points[i].after.position) - DVec3(points[i].before.position);
  const double strength = strengths().of(last.after.number);
  PointState& at = record.present;
  const auto isAfter = [&] { return last.earlier == kNone && isSameBits(at.position, last.after.position); };
  if (strength != 1) at.position = Vec3(DVec3(at.position) + (1 - strength) * record.displacement);
  record.isUntouched = isAfter();
  return record;
}

void StrokeLayers::findShape(Layer& layer, const PointStates& present) {
  const auto isOf = [](const Layer& each, std::uint64_t point) { return each.last(point) != kNone; };
  const BareVector<LayerRecord> records = parallelCollect(
      layer.pages.size() * kPage, 0, [&](std::uint64_t point) { return isOf(layer, point); },
      [&](std::uint64_t point) {
        LayerRecord record = layer.recordOf(layer.last(point), present);
        record.isOfMany =
            std::ranges::any_of(layers_, [&](const Layer& other) { return &other != &layer && isOf(other, point); });
        return record;
      });
  layer.shape = LayerShape(layerPlaces(records, present));
}

bool StrokeLayers::Layer::removes(std::uint64_t point) const {
  const std::uint32_t index = last(point);
  if (index == kNone) return false;
  if (const std::size_t at = shape.indexOf(point); at < shape.places().size()) return shape.isRemoved(at, strengths());
  return points[index].after.gone && strengths().of(point) == 1;
}

bool StrokeLayers::isRemovedByOthers(std::uint64_t point, const Layer& than) const {
  return std::ranges::any_of(layers_, [&](const Layer& layer) { return &layer != &than && layer.removes(point); });
}

void StrokeLayers::observe(std::uint32_t number, const PointStates& present) {
  Layer& layer = layers_[number];
  if (layer.isWhole() || layer.shape.empty())
    findShape(layer, present);
  else
    layer.shape.addNew(present, layer.strengths());
  layer.shape.findSurroundings();
  layer.shape.findMoving([&](std::uint64_t point) { return layer.last(point) != kNone; });
  const std::span<const std::uint32_t> absent = layer.shape.absentAtSome();
  const auto numberOf = [&](std::size_t k) { return layer.shape.places()[absent[k]].number; };
  const auto isNews = [&](std::size_t k) {
    const std::uint64_t point = numberOf(k);
    return !layer.shape.isRemoved(absent[k], layer.strengths()) && present[point].gone != removed_.test(point) &&
           !isRemovedByOthers(point, layer);
  };
  for (const std::uint64_t point : parallelCollect(absent.size(), 0, isNews, numberOf))
    removed_.set(point, present[point].gone);
}

PointState StrokeLayers::slid(const Layer& layer, std::size_t index, const LayerStrengths& to,
                              const PointState& present) {
  const std::uint64_t point = present.number;
  const LayerStrengths was = layer.strengths();
  const double from = was.of(point), then = to.of(point);
  PointState next = present;
  if (from == then) return next;
  const Vec3 expected = layer.shape.positionAt(index, from), position = layer.shape.positionAt(index, then);
  const bool isThere = isSameBits(present.position, expected);
  next.position = isThere ? position : Vec3(DVec3(present.position) + DVec3(position) - DVec3(expected));
  const Vec3 normal = layer.shape.normalAt(index, then);
  if (isThere) {
    next.normal = normal;
  } else {
    const DVec3 had(layer.shape.normalAt(index, from));
    next.normal = Vec3(shortestRotation(had, DVec3(normal)) * DVec3(present.normal));
  }
  const std::uint32_t last = layer.last(point);
  if (last == kNone) return next;
  const std::uint32_t before = layer.first(last).before.color, after = layer.points[last].after.color;
  const auto colorAt = [&](double strength) {
    return strength == 0 ? before : strength == 1 ? after : mixedColor(before, after, strength);
  };
  if (present.color == colorAt(from)) next.color = colorAt(then);
  return next;
}

// A point that is locked in part goes as much less far, however often.
void StrokeLayers::hold(const LayerShape& shape, const LayerStrengths& was, const PointLock& lock,
                        const PointStates& present, StrokeLayer& set) {
  if (lock.empty() && was.held.empty()) return set.held.clear();
  const auto heldAt = [&](std::size_t i) {
    const std::uint64_t point = shape.places()[i].number;
    const double weight = lock.weightOf(point, present[point].parent), from = was.of(point);
    return HeldPoint{point, weight == 0 ? set.shown() : from + (1 - weight) * (set.shown() - from)};
  };
  const auto isHeld = [&](std::size_t i) { return heldAt(i).strength != set.shown(); };
  const BareVector<HeldPoint> held = parallelCollect(shape.places().size(), 0, isHeld, heldAt);
  set.held.assign(held.begin(), held.end());
}

SlidPoints StrokeLayers::slide(StrokeLayerChange& to, const PointStates& present, const PointLock* lock) {
  observe(to.number, present);
  const Layer& layer = layers_[to.number];
  const LayerShape& shape = layer.shape;
  if (const LayerShape::Range& range = shape.range();
      lock && (to.set.strength < range.low || to.set.strength > range.high))
    throw Error("layer {}: its strength is from {} to {}, since its strokes would turn the surface over beyond that",
                to.set.name, range.low, range.high);
  const std::unordered_map<std::size_t, PointState> absent = shape.absentWithOthers(present, layer.strengths());
  if (lock) hold(shape, layer.strengths(), *lock, present, to.set);
  const LayerStrengths was = layer.strengths(), then{to.set.shown(), to.set.held};
  const std::span<const LayerPlace> places = shape.places();
  const auto next = [&](std::size_t i) {
    const std::uint64_t point = places[i].number;
    const auto at = absent.find(i);
    PointState state = slid(layer, i, then, at == absent.end() ? present[point] : at->second);
    if (places[i].kind != LayerPlace::Kind::kept && was.of(point) != then.of(point))
      state.gone = shape.isRemoved(i, then) || removed_.test(point) || isRemovedByOthers(point, layer);
    return state;
  };
  SlidPoints slid{.states = BareVector<PointState>(shape.moving().size()), .points = {}};
  BareVector<PointState>& states = slid.states;
  struct Counts {
    std::size_t changed = 0, absent = 0;
  };
  const auto isChanged = [&](std::size_t k) { return !isSameToTheBit(present[states[k].number], states[k]); };
  const auto make = [&](std::size_t begin, std::size_t end) {
    Counts counts;
    for (std::size_t k = begin; k < end; ++k) {
      states[k] = next(shape.moving()[k]);
      counts.changed += isChanged(k) ? 1 : 0;
      counts.absent += states[k].gone && present[states[k].number].gone ? 1 : 0;
    }
    return counts;
  };
  const auto sum = [](Counts a, Counts b) { return Counts{a.changed + b.changed, a.absent + b.absent}; };
  const Counts counts = parallelReduce(states.size(), 0, Counts(), make, sum);
  slid.hasAbsent = counts.absent > 0;
  if (counts.changed == states.size()) {
    slid.points = shape.movingPoints();
  } else {
    states = parallelCollect(states.size(), 0, isChanged, [&](std::size_t k) { return states[k]; });
    slid.points = PointSet::of(states, [](const PointState& state) { return state.number; });
  }
  return slid;
}

StrokeLayerChange renumbered(StrokeLayerChange change, std::span<const PointState> states,
                             std::span<const std::uint64_t> numbers) {
  const auto isThere = [&](std::uint64_t point) { return point < states.size() && !states[point].gone; };
  const std::vector<StrokeLayerPoint> had = std::exchange(change.points, {});
  std::vector<std::uint32_t> indices(had.size(), kNone);
  for (std::size_t i = 0; i < had.size(); ++i) {
    StrokeLayerPoint point = had[i];
    if (!isThere(point.after.number)) continue;
    for (PointState* const state : {&point.before, &point.after}) {
      state->number = numbers[state->number];
      state->parent = isThere(state->parent) ? numbers[state->parent] : state->number;
    }
    if (point.earlier != kNone) point.earlier = indices[point.earlier];
    indices[i] = static_cast<std::uint32_t>(change.points.size());
    change.points.push_back(point);
  }
  const auto renumber = [&](auto& each) {
    std::erase_if(each, [&](const auto& point) { return !isThere(point.number); });
    for (auto& point : each) point.number = numbers[point.number];
  };
  renumber(change.places);
  renumber(change.set.held);
  return change;
}

}  // namespace palpate
