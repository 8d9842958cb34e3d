#include "engine/edit/history.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

#include "engine/cloud/attribute_bytes.hpp"
#include "engine/core/check.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {

namespace {

// Before the states: the slide.
std::vector<std::byte> contentOf(const PointStroke& stroke) {
  std::vector<std::byte> bytes = stroke.slide ? bytesIn(*stroke.slide) : std::vector<std::byte>();
  const auto states = std::as_bytes(std::span(stroke.points));
  bytes.insert(bytes.end(), states.begin(), states.end());
  return bytes;
}
std::span<const std::byte> contentOf(const ShapeStroke& stroke) { return std::as_bytes(std::span(stroke.places)); }
std::vector<std::byte> contentOf(const PresenceStroke& stroke) {
  const std::vector<std::uint64_t> words = stroke.points.words();
  const auto bytes = std::as_bytes(std::span(words));
  return {bytes.begin(), bytes.end()};
}
std::vector<std::byte> contentOf(const AttributeChange& change) { return bytesIn(change); }

std::uint64_t sizeOfContent(const auto& stroke) { return contentOf(stroke).size(); }
std::uint64_t sizeOfContent(const PointStroke& stroke) { return std::as_bytes(std::span(stroke.points)).size(); }
std::uint64_t sizeOfContent(const PresenceStroke& stroke) { return stroke.points.bytes(); }
std::uint64_t sizeOfContent(const AttributeChange& change) { return bytesOf(change); }

// What stands before the content of a change in a file. It ends with the program, and so needs no version.
struct Head {
  std::uint64_t kind = 0, version = 0, received = 0;
  std::uint64_t layer = 0;  // of strokes, and 1; 0: none
  std::uint64_t slideBytes = 0, isGiven = 0;
};

template <class Items>
Items itemsIn(std::span<const std::byte> bytes) {
  using Item = typename Items::value_type;
  static_assert(std::is_trivially_copyable_v<Item>);
  Items items(bytes.size() / sizeof(Item));
  if (!items.empty()) std::memcpy(items.data(), bytes.data(), items.size() * sizeof(Item));
  return items;
}

PointSet setOf(std::span<const PointState> states) {
  const auto of = [&](std::size_t begin, std::size_t end) {
    return PointSet::of(states.subspan(begin, end - begin), [](const PointState& state) { return state.number; });
  };
  const auto join = [](PointSet& all, const PointSet& part) { return all.add(part), std::move(all); };
  return parallelReduce(states.size(), 0, PointSet(), of, join);
}

// Calls carry(), between exchange() and, if it fails, another one.
bool carried(auto&& exchange, auto&& carry) {
  exchange();
  bool isCarried = false;
  try {
    isCarried = carry();
  } catch (...) {
    exchange();
    throw;
  }
  if (!isCarried) exchange();
  return isCarried;
}

}  // namespace

std::uint64_t bytesOf(const HistoryChange& change) {
  return sizeof change + std::visit([](const auto& what) { return sizeOfContent(what); }, change.what);
}

std::vector<std::byte> pack(const HistoryChange& change) {
  const auto* const stroke = std::get_if<PointStroke>(&change.what);
  const auto* const presence = std::get_if<PresenceStroke>(&change.what);
  Head head{change.what.index(), change.version, stroke ? stroke->received : presence ? presence->received : 0};
  if (stroke && stroke->layer) head.layer = *stroke->layer + std::uint64_t{1};
  if (stroke) head.isGiven = stroke->isGiven;
  if (stroke && stroke->slide) head.slideBytes = bytesIn(*stroke->slide).size();
  return std::visit(
      [&](const auto& what) {
        const auto content = contentOf(what);
        std::vector<std::byte> bytes(sizeof head + content.size());
        std::memcpy(bytes.data(), &head, sizeof head);
        if (!content.empty()) std::memcpy(bytes.data() + sizeof head, content.data(), content.size());
        return bytes;
      },
      change.what);
}

bool unpack(std::span<const std::byte> bytes, HistoryChange& change) {
  Head head;
  if (bytes.size() < sizeof head) return false;
  std::memcpy(&head, bytes.data(), sizeof head);
  const auto content = bytes.subspan(sizeof head);
  change = {.what = PointStroke(), .version = head.version};
  if (head.kind == 0) {
    if (head.slideBytes > content.size()) return false;
    PointStroke stroke{.points = itemsIn<BareVector<PointState>>(content.subspan(head.slideBytes)),
                       .received = head.received,
                       .isGiven = head.isGiven != 0};
    if (head.layer > 0) stroke.layer = static_cast<std::uint32_t>(head.layer - 1);
    AttributeChange slide;
    if (head.slideBytes > 0) {
      if (!readChange(content.first(head.slideBytes), slide)) return false;
      stroke.slide = std::get<StrokeLayerChange>(std::move(slide));
    }
    change.what = std::move(stroke);
  } else if (head.kind == 1)
    change.what = ShapeStroke{itemsIn<std::vector<RestPlace>>(content)};
  else if (head.kind == 2) {
    const auto words = itemsIn<std::vector<std::uint64_t>>(content);
    std::span<const std::uint64_t> left = words;
    auto& presence = change.what.emplace<PresenceStroke>();
    presence.received = head.received;
    return presence.points.read(left) && left.empty();
  } else
    return readChange(content, change.what.emplace<AttributeChange>());
  return true;
}

History::History(PointStates points, const UndoBudget& budget)
    : points_(std::move(points)), list_(budget), slot_(budget.bytes ? points_.size() : 0) {}

void History::follow(const EditBatch& batch, bool hasLast) {
  const std::span<const PointState> all = batch.points;
  std::size_t begin = 0;
  for (const EditMark& mark : batch.marks) {
    PALPATE_CHECK(begin <= mark.at && mark.at <= all.size());
    const auto states = all.subspan(begin, mark.at - begin);
    const bool isKnown = hasLast && !states.empty() && mark.at == all.size();
    switch (mark.kind) {
      case EditMark::Kind::stroke:
        if (isKnown || (!(layers_ && layers_->open()) && addPresence(states))) break;
        addToStroke(states);
        endStroke();
        break;
      case EditMark::Kind::change:
        endStroke();  // in case its end was not marked
        if (!isKnown) points_.set(states);
        break;
      case EditMark::Kind::part:
      case EditMark::Kind::attribute:  // which no state belongs to
      case EditMark::Kind::undone:
      case EditMark::Kind::redone:
        addToStroke(states);
        break;
      case EditMark::Kind::received:
        receive(states);
        break;
    }
    begin = mark.at;
  }
  addToStroke(all.subspan(begin));
}

void History::follow(std::vector<ShapeStroke> strokes) {
  for (ShapeStroke& stroke : strokes) {
    ++strokes_;
    list_.make({std::move(stroke), std::exchange(version_, ++lastVersion_)}, [](HistoryChange&) {});
  }
}

void History::make(AttributeChange change, const std::function<void(AttributeChange&)>& exchange) {
  PALPATE_CHECK(!inStroke_);
  const bool isInFile = !std::holds_alternative<MaskFlip>(change) && !std::holds_alternative<StrokeLayerChange>(change);
  slid_.reset();
  list_.make({std::move(change), version_}, [&](HistoryChange& made) {
    exchange(std::get<AttributeChange>(made.what));
    if (isInFile) version_ = ++lastVersion_;
  });
}

void History::receive(std::span<const PointState> states) {
  bool isCounted = false;
  for (const PointState& state : states) {
    const std::uint64_t point = state.number;
    const bool isChange = points_.knows(point);  // else it is the point's first state
    points_.set(state);
    if (!isChange) continue;
    slid_.reset();
    if (!std::exchange(isCounted, true)) ++received_;
    if (!list_.keepsAny()) continue;
    const std::size_t at = points_.indexOf(point);
    if (at >= lastReceived_.size()) lastReceived_.resize(points_.size(), 0);
    lastReceived_[at] = received_;
    if (!isInStroke(point)) continue;
    // From now on the stroke's edits of this point start from the received state.
    open_.points[slot_[at]] = open_.points.back();
    slot_[points_.indexOf(open_.points.back().number)] = slot_[at];
    open_.points.pop_back();
  }
}

bool History::addPresence(std::span<const PointState> states) {
  const auto isFlip = [&](const PointState& state) {
    PointState was = points_[state.number];
    was.gone = !was.gone;
    return points_.knows(state.number) && isSameToTheBit(was, state);
  };
  if (inStroke_ || states.empty() || !list_.keepsAny() || !std::ranges::all_of(states, isFlip)) return false;
  PresenceStroke stroke{.points = PointSet::of(states, [](const PointState& state) { return state.number; }),
                        .received = received_};
  if (stroke.points.count() != states.size()) return false;  // some twice: the last state of each counts
  slid_.reset();
  list_.make({std::move(stroke), version_}, [&](HistoryChange&) { points_.set(states); });
  version_ = ++lastVersion_;
  ++strokes_;
  return true;
}

void History::beginStroke() {
  if (std::exchange(inStroke_, true)) return;
  list_.begin();
  keepsStroke_ = list_.keepsAny();
  openVersion_ = version_;
  slid_.reset();
}

void History::addToStroke(std::span<const PointState> states) {
  if (states.empty()) return;
  beginStroke();
  version_ = ++lastVersion_;
  for (const PointState& state : states) {
    const bool isKept = keepsStroke_ || (layers_ && layers_->open());
    if (isKept && !isInStroke(state.number)) keepBefore(state.number);
    points_.set(state);
  }
}

void History::keepBefore(std::uint64_t point) {
  if (keepsStroke_)
    keepsStroke_ = list_.makeRoom(sizeof(HistoryChange) + (open_.points.size() + 1) * sizeof(PointState));
  if (!keepsStroke_ && !(layers_ && layers_->open())) {
    open_ = {};
    return;
  }
  const std::size_t at = points_.indexOf(point);
  if (at >= slot_.size()) slot_.resize(at + 1);
  slot_[at] = static_cast<std::uint32_t>(open_.points.size());
  open_.points.push_back(points_[point]);
}

void History::endStroke() {
  if (!std::exchange(inStroke_, false)) return;
  ++strokes_;
  if (layers_ && layers_->open()) {
    open_.layer = layers_->open();
    layers_->record(*open_.layer, open_.points, points_);
  }
  if (keepsStroke_) {
    open_.received = received_;
    open_.points.shrink_to_fit();
    list_.add({std::move(open_), openVersion_});
  } else {
    list_.addTooLarge();
  }
  open_ = {};
}

bool History::isOthers(std::uint64_t point, std::uint64_t received) const {
  const std::size_t at = points_.indexOf(point);
  return at < lastReceived_.size() && lastReceived_[at] > received;
}

bool History::carryPresence(const PointSet& points, const CarryMany& carry) {
  return carried([&] { points_.flip(points); },
                 [&] { return carry(points, [&] { return presenceChanges(points, points_); }); });
}

bool History::carryStates(BareVector<PointState>& states, PointSet points, bool hasAbsent, const CarryMany& carry) {
  if (hasAbsent) {
    const auto isAbsent = [&](std::size_t i) { return states[i].gone && points_[states[i].number].gone; };
    for (const std::uint64_t absent :
         parallelCollect(states.size(), 0, isAbsent, [&](std::size_t i) { return states[i].number; }))
      points.set(absent, false);
  }
  const auto changes = [&] {
    std::vector<PointChange> made;
    made.reserve(states.size());
    for (const PointState& from : states)
      if (!hasAbsent || points.test(from.number)) made.push_back({.from = from, .to = points_[from.number]});
    return made;
  };
  return carried([&] { points_.exchange(states); }, [&] { return points.empty() || carry(points, changes); });
}

void History::changePresence(const PointSet& points, const CarryMany& carry) {
  PALPATE_CHECK(!inStroke_);
  slid_.reset();
  list_.make({PresenceStroke{.points = points, .received = received_}, version_},
             [&](HistoryChange&) { carryPresence(points, carry); });
  version_ = ++lastVersion_;
  ++strokes_;
}

void History::changeMany(BareVector<PointState> states, const CarryMany& carry) {
  PALPATE_CHECK(!inStroke_);
  slid_.reset();
  PointStroke made{.points = std::move(states), .received = received_, .isGiven = true};
  if (layers_) made.layer = layers_->open();
  list_.make({std::move(made), version_}, [&](HistoryChange& change) {
    auto& stroke = std::get<PointStroke>(change.what);
    carryStates(stroke.points, setOf(stroke.points), false, carry);
    if (stroke.layer) layers_->record(*stroke.layer, stroke.points, points_);
  });
  version_ = ++lastVersion_;
  ++strokes_;
}

void History::slide(StrokeLayerChange& change, const PointLock* lock, const CarryMany& carry,
                    std::optional<std::span<const PointState>> recorded) {
  PALPATE_CHECK(layers_ && !inStroke_);
  const bool isContinued = slid_ && change.moves == StrokeLayerChange::Points::slideContinued;
  SlidPoints slid = layers_->slide(change, points_, lock);
  BareVector<PointState>& states = slid.states;
  if (recorded) {
    std::erase_if(states, [&](const PointState& to) { return !to.gone || !points_[to.number].gone; });
    for (const PointState& to : *recorded) points_.set(points_[to.number]);  // all are known from now on
    states.insert(states.end(), recorded->begin(), recorded->end());
  }
  if (recorded) slid.points = setOf(states), slid.hasAbsent = true;
  bool isSeen = false;
  const auto exchange = [&] {
    PALPATE_CHECK(
        carryStates(states, slid.points, slid.hasAbsent, [&](const PointSet& points, const MadeChanges& changes) {
          isSeen = true;
          return carry(points, changes);
        }));
    layers_->exchange(change);
  };
  if (isContinued) {
    list_.extend([&](HistoryChange& made) {
      auto& kept = std::get<PointStroke>(made.what).points;
      PointSet more = slid.points;
      more.remove(*slid_);
      kept.reserve(kept.size() + more.count());
      exchange();
      for (const PointState& state : more.empty() ? std::span<const PointState>() : states)
        if (more.test(state.number)) kept.push_back(state);
    });
    slid.points.add(*slid_);
  } else {
    list_.make({PointStroke{.received = received_}, version_}, [&](HistoryChange& made) {
      exchange();
      std::get<PointStroke>(made.what) = {
          .points = std::move(states), .received = received_, .slide = std::move(change)};
    });
    ++strokes_;
  }
  if (isSeen) version_ = ++lastVersion_;
  slid_ = list_.last() ? std::optional(std::move(slid.points)) : std::nullopt;
}

std::vector<PointChange> presenceChanges(const PointSet& points, const PointStates& after) {
  std::vector<PointChange> changes;
  changes.reserve(points.count());
  points.forEach([&](std::uint64_t point) {
    const PointState to = after[point];
    changes.push_back({.from = to, .to = to});
    changes.back().from.gone = !to.gone;
  });
  return changes;
}

bool History::carryOut(PresenceStroke& stroke, const Carriers& carriers) {
  PointSet points = stroke.points;
  if (!lastReceived_.empty())
    stroke.points.forEach([&](std::uint64_t point) {
      if (isOthers(point, stroke.received)) points.set(point, false);
    });
  const auto byChanges = [&](const PointSet&, const MadeChanges& changes) { return carriers.points(changes()); };
  if (!points.empty() && !carryPresence(points, carriers.many ? carriers.many : CarryMany(byChanges))) return false;
  stroke = {.points = std::move(points), .received = received_};
  return true;
}

bool History::carryOut(PointStroke& stroke, const Carriers& carriers) {
  BareVector<PointState> left;
  BareVector<PointState>& states = lastReceived_.empty() ? stroke.points : left;
  if (&states == &left)
    for (const PointState& to : stroke.points)
      if (!isOthers(to.number, stroke.received)) left.push_back(to);
  if (stroke.slide) layers_->observe(stroke.slide->number, points_);
  bool isSeen = false;
  const auto carry = [&](const PointSet& points, const MadeChanges& changes) {
    isSeen = true;
    return carriers.many ? carriers.many(points, changes) : carriers.points(changes());
  };
  if (!carryStates(states, setOf(states), stroke.slide.has_value(), carry)) return false;
  if (&states == &left) stroke.points = std::move(left);
  stroke.received = received_;
  if (layers_) followInLayer(stroke, isSeen, carriers);
  return true;
}

// A stroke that is undone is one more stroke of its layer, from its end to its begin.
void History::followInLayer(PointStroke& stroke, bool isSeen, const Carriers& carriers) {
  using Points = StrokeLayerChange::Points;
  if (stroke.slide) layers_->exchange(*stroke.slide);
  if (stroke.layer) layers_->record(*stroke.layer, stroke.points, points_);
  if (!carriers.layers || (!stroke.slide && !stroke.layer)) return;
  const std::uint32_t number = stroke.slide ? stroke.slide->number : *stroke.layer;
  carriers.layers({.number = number,
                   .set = (*layers_)[number],
                   .open = layers_->open(),
                   .moves = !isSeen        ? Points::none
                            : stroke.slide ? Points::slide
                                           : Points::strokes});
}

bool History::carryOut(HistoryChange& change, const Carriers& carriers) {
  auto* const stroke = std::get_if<PointStroke>(&change.what);
  auto* const shape = std::get_if<ShapeStroke>(&change.what);
  auto* const presence = std::get_if<PresenceStroke>(&change.what);
  const bool done = stroke     ? carryOut(*stroke, carriers)
                    : presence ? carryOut(*presence, carriers)
                    : shape    ? carriers.shape(*shape)
                               : carriers.attributes(std::get<AttributeChange>(change.what));
  if (!done) return false;
  slid_.reset();
  std::swap(version_, change.version);
  return true;
}

bool History::undo(const Carriers& carriers) {
  PALPATE_CHECK(!inStroke_);
  return list_.undo([&](HistoryChange& change) { return carryOut(change, carriers); });
}

bool History::redo(const Carriers& carriers) {
  PALPATE_CHECK(!inStroke_);
  return list_.redo([&](HistoryChange& change) { return carryOut(change, carriers); });
}

bool History::takeBack(const Carriers& carriers) {
  if (!undo(carriers)) return false;
  list_.begin();  // discards it
  --strokes_;
  return true;
}

StrokeCounts History::counts() const {
  return {strokes_, list_.dropped(), list_.tooLarge(), list_.undoCount(), list_.redoCount(), version()};
}

}  // namespace palpate
