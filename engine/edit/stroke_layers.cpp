#include "engine/edit/stroke_layers.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "engine/core/check.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kNone = StrokeLayerPoint::kNone;
constexpr std::uint64_t kPage = 4096;

bool hasNoEffect(const StrokeLayerPoint& strokes) {
  return isSameToTheBit(strokes.before, strokes.after) || (strokes.before.gone && strokes.after.gone);
}

bool isInserted(const StrokeLayerPoint& first, const StrokeLayerPoint& last) {
  return first.before.gone && !last.after.gone;
}

// Of a point that does not exist at and below zero.
double effective(double strength, bool isInserted) { return isInserted ? std::max(strength, 0.0) : strength; }

Vec3 unitOr(const DVec3& v, const Vec3& otherwise) {
  const double length = glm::length(v);
  return length > 1e-6 ? Vec3(v / length) : otherwise;
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

DVec3 mixed(const Vec3& a, const Vec3& b, double strength) { return DVec3(a) + strength * (DVec3(b) - DVec3(a)); }

// Between the states before and after strokes; whether the point exists is up to the caller.
PointState between(const PointState& before, const PointState& after, double strength) {
  if (strength == 0) return before;
  if (strength == 1) return after;
  PointState at = after;
  at.position = Vec3(mixed(before.position, after.position, strength));
  at.normal = unitOr(mixed(before.normal, after.normal, strength), after.normal);
  at.color = mixedColor(before.color, after.color, strength);
  return at;
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

bool StrokeLayers::Layer::changesPresence(std::uint32_t index) const {
  return first(index).before.gone != points[index].after.gone;
}

bool StrokeLayers::Layer::removes(std::uint32_t index, double strength) const {
  if (!changesPresence(index)) return false;
  return points[index].after.gone ? strength >= kRemovesFrom : strength <= 0;
}

void StrokeLayers::Layer::extend(const PointState& from, const PointState& to, const PointStates& present) {
  toggles.reset();
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
  }
  return sum;
}

bool StrokeLayers::fits(const StrokeLayerChange& change) const {
  const bool isMade = change.isPresent && change.number == layers_.size();
  if (change.layer != 0 || change.number > layers_.size()) return false;
  if (!change.isPresent && std::size_t{change.number} + 1 != layers_.size()) return false;
  if (change.isPresent && !isMade && !change.points.empty()) return false;
  if (!(change.set.strength >= kMinLayerStrength && change.set.strength <= kMaxLayerStrength)) return false;
  const std::size_t count = change.isPresent ? layers_.size() + isMade : layers_.size() - 1;
  if (change.open && *change.open >= count) return false;
  for (std::size_t i = 0; i < change.points.size(); ++i) {
    const StrokeLayerPoint& point = change.points[i];
    if (point.before.number != point.after.number || (point.earlier != kNone && point.earlier >= i)) return false;
  }
  return true;
}

void StrokeLayers::exchange(StrokeLayerChange& change) {
  PALPATE_CHECK(fits(change));
  change.moves = StrokeLayerChange::Points::none;
  if (!change.isPresent) {
    change.set = std::move(layers_.back().set);
    change.points = std::move(layers_.back().points);
    layers_.pop_back();
    change.isPresent = true;
  } else if (change.number < layers_.size()) {
    std::swap(change.set, layers_[change.number].set);
  } else {
    Layer made{.set = change.set};
    for (std::uint32_t i = 0; i < change.points.size(); ++i) made.setLast(change.points[i].after.number, i);
    made.points = std::move(change.points);
    layers_.push_back(std::move(made));
    change.points.clear();
    change.isPresent = false;
  }
  std::swap(change.open, open_);
}

std::vector<AttributeChange> StrokeLayers::all() const {
  std::vector<AttributeChange> changes;
  for (std::uint32_t i = 0; i < layers_.size(); ++i) {
    StrokeLayerChange made{.number = i, .set = layers_[i].set, .points = layers_[i].points};
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

bool StrokeLayers::isRemovedByOthers(std::uint64_t point, const Layer& than) const {
  return std::ranges::any_of(layers_, [&](const Layer& layer) {
    const std::uint32_t index = &layer == &than ? kNone : layer.last(point);
    return index != kNone && layer.removes(index, layer.set.shown());
  });
}

const std::vector<std::uint32_t>& StrokeLayers::Layer::toggling() {
  if (toggles) return *toggles;
  toggles.emplace();
  for (std::uint32_t i = 0; i < points.size(); ++i)
    if (isLast(i) && changesPresence(i)) toggles->push_back(i);
  return *toggles;
}

void StrokeLayers::observe(std::uint32_t number, const PointStates& present) {
  Layer& layer = layers_[number];
  for (const std::uint32_t i : layer.toggling()) {
    if (layer.removes(i, layer.set.shown())) continue;
    const std::uint64_t point = layer.points[i].after.number;
    const bool isGone = present[point].gone;
    if (isGone == removed_.test(point) || isRemovedByOthers(point, layer)) continue;
    removed_.set(point, isGone);
  }
}

PointState StrokeLayers::slid(const Layer& layer, std::uint32_t index, double from, double to,
                              const PointState& present) {
  const StrokeLayerPoint& last = layer.points[index];
  const PointState& before = layer.first(index).before;
  const bool inserted = isInserted(layer.first(index), last);
  from = effective(from, inserted);
  to = effective(to, inserted);
  const PointState expected = between(before, last.after, from), then = between(before, last.after, to);
  PointState next = present;
  if (last.earlier == kNone && isSameBits(present.position, expected.position)) {
    next.position = then.position;
  } else {
    DVec3 displacement{0};
    for (std::uint32_t i = index; i != kNone; i = layer.points[i].earlier)
      displacement += DVec3(layer.points[i].after.position) - DVec3(layer.points[i].before.position);
    next.position = Vec3(DVec3(present.position) + (to - from) * displacement);
  }
  if (isSameBits(present.normal, expected.normal))
    next.normal = then.normal;
  else
    next.normal = unitOr(DVec3(present.normal) + DVec3(then.normal) - DVec3(expected.normal), present.normal);
  if (present.color == expected.color) next.color = then.color;
  return next;
}

std::size_t StrokeLayers::slide(const StrokeLayerChange& to, const PointStates& present,
                                std::vector<PointChange>& changes) {
  observe(to.number, present);
  const Layer& layer = layers_[to.number];
  const double was = layer.set.shown(), next = to.set.shown();
  changes.resize(layer.points.size());
  std::atomic<std::size_t> unchanged = 0, unseen = 0;
  parallelFor(changes.size(), 0, [&](std::size_t begin, std::size_t end) {
    std::size_t same = 0, gone = 0;
    for (std::size_t i = begin; i < end; ++i) {
      const auto index = static_cast<std::uint32_t>(i);
      const std::uint64_t point = layer.points[i].after.number;
      changes[i] = {};
      if (!layer.isLast(index)) {
        ++same;
        continue;
      }
      const PointState from = present[point];
      PointState then = slid(layer, index, was, next, from);
      if (layer.changesPresence(index))
        then.gone = layer.removes(index, next) || removed_.test(point) || isRemovedByOthers(point, layer);
      changes[i] = {from, then};
      same += isSameToTheBit(from, then);
      gone += from.gone && then.gone;
    }
    unchanged += same;
    unseen += gone;
  });
  if (unchanged > 0)
    std::erase_if(changes, [](const PointChange& change) { return isSameToTheBit(change.from, change.to); });
  if (unseen == 0) return 0;
  const auto isSeen = [](const PointChange& change) { return !change.from.gone || !change.to.gone; };
  return static_cast<std::size_t>(changes.end() - std::partition(changes.begin(), changes.end(), isSeen));
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
  return change;
}

}  // namespace palpate
