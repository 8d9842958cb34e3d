#include "engine/edit/attribute_bytes.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>

namespace palpate {

namespace {

// Before the words of the points, and the values of a field behind those.
struct ChangeHead {
  std::uint64_t isField = 0, layer = 0, number = 0;
};
constexpr std::size_t kChangeHead = sizeof(ChangeHead) / sizeof(std::uint64_t);

}  // namespace

std::uint64_t bytesOf(const AttributeChange& change) {
  if (const auto* const flip = std::get_if<MaskFlip>(&change)) return flip->points.bytes();
  const auto& field = std::get<FieldChange>(change);
  return field.points.bytes() + field.values.size();
}

std::vector<std::byte> bytesIn(const AttributeChange& change) {
  const auto* const flip = std::get_if<MaskFlip>(&change);
  const auto* const field = std::get_if<FieldChange>(&change);
  const ChangeHead head = flip ? ChangeHead{0, flip->layer, static_cast<std::uint64_t>(flip->role)}
                               : ChangeHead{1, field->layer, field->field};
  const std::vector<std::uint64_t> points = (flip ? flip->points : field->points).words();
  std::vector<std::byte> bytes(sizeof head);
  std::memcpy(bytes.data(), &head, sizeof head);
  const auto add = [&](std::span<const std::byte> more) { bytes.insert(bytes.end(), more.begin(), more.end()); };
  add(std::as_bytes(std::span(points)));
  if (field) add(field->values);
  return bytes;
}

bool readChange(std::span<const std::byte> bytes, AttributeChange& change) {
  std::vector<std::uint64_t> words(bytes.size() / sizeof(std::uint64_t));
  if (words.size() < kChangeHead) return false;
  std::memcpy(words.data(), bytes.data(), words.size() * sizeof(std::uint64_t));
  std::array<std::uint64_t, kChangeHead> first;
  std::copy_n(words.begin(), kChangeHead, first.begin());
  const auto head = std::bit_cast<ChangeHead>(first);
  std::span<const std::uint64_t> rest = std::span<const std::uint64_t>(words).subspan(kChangeHead);
  PointSet points;
  if (!points.read(rest)) return false;
  const auto layer = static_cast<std::uint16_t>(head.layer);
  if (head.isField == 0) {
    change = MaskFlip{layer, static_cast<MaskRole>(head.number), std::move(points)};
    return true;
  }
  const auto values = bytes.subspan((words.size() - rest.size()) * sizeof(std::uint64_t));
  change =
      FieldChange{layer, static_cast<std::uint32_t>(head.number), std::move(points), {values.begin(), values.end()}};
  return true;
}

}  // namespace palpate
