#include "engine/cloud/attribute_bytes.hpp"

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>

#include "engine/cloud/scalar_type.hpp"
#include "engine/core/packed_state.hpp"

namespace palpate {

namespace {

// Before the words of the points and the values of a field, or of the presence of a field, its words and its values.
struct ChangeHead {
  std::uint64_t kind = 0, layer = 0, number = 0;
};
struct PresenceHead {
  std::uint64_t isPresent = 0, type = 0, points = 0, nameBytes = 0, unitBytes = 0;
};

// Of a layer of strokes, before its name and its points.
struct LayerHead {
  std::uint64_t isPresent = 0, isHidden = 0, isMerged = 0;
  double strength = 0;
  std::uint64_t open = 0, moves = 0, nameBytes = 0;
};
// Behind it: how many points are held, and have places, in the numbers of the layout before.
struct LayerCounts {
  std::uint64_t held = 0, places = 0;
};
constexpr std::uint64_t kLayerWithPlaces = 4;  // kind of a change; that without the counts is 3
struct LayerPoint {
  PackedState before, after;
  std::uint32_t earlier = 0;
};

void add(std::vector<std::byte>& bytes, std::span<const std::byte> more) {
  bytes.insert(bytes.end(), more.begin(), more.end());
}
template <class T>
void addValue(std::vector<std::byte>& bytes, const T& value) {
  add(bytes, std::as_bytes(std::span(&value, 1)));
}
void addPoints(std::vector<std::byte>& bytes, const PointSet& points) {
  const std::vector<std::uint64_t> words = points.words();
  add(bytes, std::as_bytes(std::span(words)));
}

/// Reads from the front of bytes.
struct ByteReader {
  std::span<const std::byte> rest;

  template <class T>
  bool take(T& value) {
    if (rest.size() < sizeof value) return false;
    std::memcpy(&value, rest.data(), sizeof value);
    rest = rest.subspan(sizeof value);
    return true;
  }
  bool take(std::string& text, std::uint64_t bytes) {
    if (rest.size() < bytes) return false;
    text.assign(reinterpret_cast<const char*>(rest.data()), bytes);
    rest = rest.subspan(bytes);
    return true;
  }
  bool take(PointSet& points) {
    std::vector<std::uint64_t> words(rest.size() / sizeof(std::uint64_t));
    if (!words.empty()) std::memcpy(words.data(), rest.data(), words.size() * sizeof(std::uint64_t));
    std::span<const std::uint64_t> left = words;
    if (!points.read(left)) return false;
    rest = rest.subspan((words.size() - left.size()) * sizeof(std::uint64_t));
    return true;
  }
  template <class T, class Allocator>
  bool take(std::vector<T, Allocator>& items, std::uint64_t count) {
    static_assert(std::is_trivially_copyable_v<T>);
    if (count > rest.size() / sizeof(T)) return false;
    items.resize(count);
    for (T& item : items)
      if (!take(item)) return false;
    return true;
  }
  std::vector<std::byte> values() const { return {rest.begin(), rest.end()}; }
};

bool readPresence(ByteReader bytes, FieldPresence& made) {
  PresenceHead head;
  if (!bytes.take(head) || head.isPresent > 1 || head.type > static_cast<std::uint64_t>(ScalarType::u64)) return false;
  if (!bytes.take(made.name, head.nameBytes) || !bytes.take(made.unit, head.unitBytes)) return false;
  made.isPresent = head.isPresent == 1;
  made.type = static_cast<std::uint8_t>(head.type);
  made.points = head.points;
  made.values = bytes.values();
  return true;
}

std::uint64_t numberOr(const std::optional<std::uint32_t>& number) {
  return number ? *number : std::numeric_limits<std::uint64_t>::max();
}

bool readLayer(ByteReader bytes, bool hasPlaces, StrokeLayerChange& change) {
  using Points = StrokeLayerChange::Points;
  LayerHead head;
  LayerCounts counts;
  if (!bytes.take(head) || (hasPlaces && !bytes.take(counts)) || !bytes.take(change.set.name, head.nameBytes))
    return false;
  if (!bytes.take(change.set.held, counts.held) || !bytes.take(change.places, counts.places)) return false;
  for (const HeldPoint& point : change.set.held)
    if (!std::isfinite(point.strength)) return false;
  for (const LayerPlace& place : change.places)
    if (place.kind > LayerPlace::Kind::cut) return false;
  if (((head.isPresent | head.isHidden | head.isMerged) >> 1) != 0) return false;
  if (head.moves > static_cast<std::uint64_t>(Points::strokes) || !std::isfinite(head.strength)) return false;
  change.isPresent = head.isPresent == 1;
  change.set.strength = head.strength;
  change.set.isHidden = head.isHidden == 1;
  change.set.isMerged = head.isMerged == 1;
  change.moves = static_cast<Points>(head.moves);
  if (head.open < std::numeric_limits<std::uint32_t>::max()) change.open = static_cast<std::uint32_t>(head.open);
  if (bytes.rest.size() % sizeof(LayerPoint) != 0) return false;
  for (LayerPoint point; bytes.take(point);)
    change.points.push_back({stateOf(point.before), stateOf(point.after), point.earlier});
  return bytes.rest.empty();
}

}  // namespace

std::uint64_t bytesOf(const AttributeChange& change) {
  if (const auto* const layer = std::get_if<StrokeLayerChange>(&change))
    return layer->set.name.size() + layer->points.size() * sizeof layer->points[0] +
           layer->set.held.size() * sizeof(HeldPoint) + layer->places.size() * sizeof(LayerPlace);
  if (const auto* const flip = std::get_if<MaskFlip>(&change)) return flip->points.bytes();
  if (const auto* const of = std::get_if<FieldChange>(&change)) return of->points.bytes() + of->values.size();
  const auto& made = std::get<FieldPresence>(change);
  return made.name.size() + made.unit.size() + made.values.size();
}

std::vector<std::byte> bytesIn(const AttributeChange& change) {
  std::vector<std::byte> bytes;
  const auto addHead = [&](std::uint64_t layer, std::uint64_t number) {
    const bool isLayer = std::holds_alternative<StrokeLayerChange>(change);
    addValue(bytes, ChangeHead{isLayer ? kLayerWithPlaces : change.index(), layer, number});
  };
  if (const auto* const flip = std::get_if<MaskFlip>(&change)) {
    addHead(flip->layer, static_cast<std::uint64_t>(flip->role));
    addPoints(bytes, flip->points);
  } else if (const auto* const of = std::get_if<FieldChange>(&change)) {
    addHead(of->layer, of->field);
    addPoints(bytes, of->points);
    add(bytes, of->values);
  } else if (const auto* const to = std::get_if<StrokeLayerChange>(&change)) {
    const StrokeLayer& set = to->set;
    addHead(to->layer, to->number);
    addValue(bytes, LayerHead{to->isPresent, set.isHidden, set.isMerged, set.strength, numberOr(to->open),
                              static_cast<std::uint64_t>(to->moves), set.name.size()});
    addValue(bytes, LayerCounts{set.held.size(), to->places.size()});
    add(bytes, std::as_bytes(std::span(set.name)));
    add(bytes, std::as_bytes(std::span(set.held)));
    add(bytes, std::as_bytes(std::span(to->places)));
    for (const StrokeLayerPoint& point : to->points)
      addValue(bytes, LayerPoint{packedState(point.before), packedState(point.after), point.earlier});
  } else {
    const auto& made = std::get<FieldPresence>(change);
    addHead(made.layer, made.field);
    addValue(bytes, PresenceHead{made.isPresent, made.type, made.points, made.name.size(), made.unit.size()});
    for (const std::string& text : {made.name, made.unit}) add(bytes, std::as_bytes(std::span(text)));
    add(bytes, made.values);
  }
  return bytes;
}

bool readChange(std::span<const std::byte> bytes, AttributeChange& change) {
  ByteReader reader{bytes};
  ChangeHead head;
  if (!reader.take(head) || head.layer != 0 || head.number > std::numeric_limits<std::uint32_t>::max()) return false;
  const auto number = static_cast<std::uint32_t>(head.number);
  switch (head.kind) {
    case 0: {
      MaskFlip flip{.role = static_cast<MaskRole>(number)};
      if (number >= kMaskRoles || !reader.take(flip.points) || !reader.rest.empty()) return false;
      change = std::move(flip);
      return true;
    }
    case 1: {
      FieldChange of{.field = number};
      if (!reader.take(of.points)) return false;
      of.values = reader.values();
      change = std::move(of);
      return true;
    }
    case 2: {
      FieldPresence made{.field = number};
      if (!readPresence(reader, made)) return false;
      change = std::move(made);
      return true;
    }
    case 3:
    case kLayerWithPlaces: {
      StrokeLayerChange set{.number = number};
      if (!readLayer(reader, head.kind == kLayerWithPlaces, set)) return false;
      change = std::move(set);
      return true;
    }
    default:
      return false;
  }
}

}  // namespace palpate
