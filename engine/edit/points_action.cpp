#include "engine/edit/points_action.hpp"

#include <array>
#include <cmath>
#include <cstring>
#include <span>
#include <type_traits>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/core/packed_state.hpp"
#include "engine/core/point_words.hpp"
#include "engine/core/tool_shape.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMoveNumbers = 8;
using MoveNumbers = std::array<double, kMoveNumbers>;

MoveNumbers numbersOf(const MovePoints& move) {
  const DQuat& q = move.rotation;
  return {q.w, q.x, q.y, q.z, move.scale, move.offset.x, move.offset.y, move.offset.z};
}

template <class Item>
bool take(std::string_view& bytes, Item& item) {
  static_assert(std::is_trivially_copyable_v<Item>);
  if (bytes.size() < sizeof item) return false;
  std::memcpy(&item, bytes.data(), sizeof item);
  bytes.remove_prefix(sizeof item);
  return true;
}

void append(std::string& bytes, const void* from, std::size_t size) {
  bytes.append(static_cast<const char*>(from), size);
}

}  // namespace

PointState stateAfter(const PointState& state, const PointsAction& action) {
  PointState after = state;
  if (std::holds_alternative<RemovePoints>(action)) after.gone = true;
  if (const auto* const paint = std::get_if<PaintPoints>(&action)) after.color = paint->color;
  if (const auto* const move = std::get_if<MovePoints>(&action)) {
    after.position = Vec3((*move)(DVec3(state.position)));
    if (move->rotation != DQuat(1, 0, 0, 0)) after.normal = Vec3(move->rotation * DVec3(state.normal));
  }
  return after;
}

BareVector<PointState> statesAfter(const PointSet& points, const PointStates& present, const PointsAction& action) {
  const PointWords changed = wordsWhere(points, [&](std::uint64_t point) {
    const PointState state = present[point];
    return !state.gone && stateAfter(state, action) != state;
  });
  BareVector<PointState> states(changed.points);
  parallelFor(changed.words.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      changed.words[i].forEach(
          [&](std::uint64_t point, std::uint64_t k) { states[k] = stateAfter(present[point], action); });
  });
  return states;
}

void validate(const PointsAction& action) {
  const auto* const move = std::get_if<MovePoints>(&action);
  if (!move) return;
  for (const double number : numbersOf(*move))
    if (!std::isfinite(number)) throw UsageError("points cannot be moved by numbers that are not finite");
  if (!isTurn(move->rotation)) throw UsageError("points can only be rotated by a unit quaternion");
  if (!(move->scale > 0)) throw UsageError("points can only be scaled by a positive factor, not by {}", move->scale);
}

std::string bytesIn(const PointsAction& action, const PointSet& points) {
  std::string bytes;
  const std::uint64_t kind = action.index();
  append(bytes, &kind, sizeof kind);
  if (const auto* const paint = std::get_if<PaintPoints>(&action)) {
    const std::uint64_t color = paint->color;
    append(bytes, &color, sizeof color);
  }
  if (const auto* const move = std::get_if<MovePoints>(&action)) {
    const MoveNumbers numbers = numbersOf(*move);
    append(bytes, &numbers, sizeof numbers);
  }
  if (const auto* const set = std::get_if<SetPoints>(&action)) {
    const std::uint64_t count = set->states.size();
    append(bytes, &count, sizeof count);
    for (const PointState& state : set->states) {
      const PackedState packed = packedState(state);
      append(bytes, &packed, sizeof packed);
    }
  }
  const std::vector<std::uint64_t> words = points.words();
  if (!words.empty()) append(bytes, words.data(), words.size() * sizeof words[0]);
  return bytes;
}

std::optional<std::pair<PointsAction, PointSet>> readPointsAction(std::string_view bytes) {
  std::uint64_t kind = 0, color = 0, count = 0;
  MoveNumbers n{};
  if (!take(bytes, kind) || kind >= std::variant_size_v<PointsAction>) return std::nullopt;
  PointsAction action;
  if (kind == PointsAction(PaintPoints()).index()) {
    if (!take(bytes, color)) return std::nullopt;
    action = PaintPoints{static_cast<std::uint32_t>(color)};
  } else if (kind == PointsAction(MovePoints()).index()) {
    if (!take(bytes, n)) return std::nullopt;
    action = MovePoints{{n[0], n[1], n[2], n[3]}, n[4], {n[5], n[6], n[7]}};
  } else if (kind == PointsAction(SetPoints()).index()) {
    if (!take(bytes, count) || count > bytes.size() / sizeof(PackedState)) return std::nullopt;
    SetPoints set;
    PackedState packed;
    while (set.states.size() < count && take(bytes, packed)) set.states.push_back(stateOf(packed));
    action = std::move(set);
  }
  std::vector<std::uint64_t> words(bytes.size() / sizeof(std::uint64_t));
  if (!words.empty()) std::memcpy(words.data(), bytes.data(), words.size() * sizeof words[0]);
  std::span<const std::uint64_t> left = words;
  PointSet points;
  if (!points.read(left)) return std::nullopt;
  return std::pair{action, std::move(points)};
}

}  // namespace palpate
