#include "engine/render/drawn_attributes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/gpu/device.hpp"

namespace palpate {

void DrawnAttributes::follow(std::span<const AttributeChange> changes) {
  if (changes.empty()) return;
  device_.throughputQueue().finish();  // which may still read them
  for (const AttributeChange& change : changes) {
    if (const auto* const flipped = std::get_if<MaskFlip>(&change))
      flip(*flipped);
    else if (const auto* const of = std::get_if<FieldChange>(&change))
      set(*of);
    else if (std::get<FieldPresence>(change).field == field_)
      field_.reset();  // another one has its number, if any
  }
}

void DrawnAttributes::flip(const MaskFlip& flip) {
  const auto role = static_cast<std::size_t>(flip.role);
  if (role >= masks_.size() || flip.points.empty()) return;
  Mask& mask = masks_[role];
  if (!mask.bits) {
    mask.words.resize(count_ / 64 + 1);
    mask.bits.emplace(Buffer::of<std::uint64_t>(device_, mask.words.size(), Memory::upload, "drawn mask"));
    std::ranges::fill(mask.bits->mapped<std::uint64_t>(), 0);
  }
  const std::span<std::uint64_t> seen = mask.bits->mapped<std::uint64_t>();
  flip.points.forWords([&](std::uint64_t k, std::uint64_t flipped) {
    if (k >= seen.size()) return;
    std::uint64_t& word = mask.words[k];
    mask.count -= static_cast<std::uint64_t>(std::popcount(word));
    seen[k] = word ^= flipped;
    mask.count += static_cast<std::uint64_t>(std::popcount(word));
  });
}

void DrawnAttributes::set(const FieldChange& change) {
  if (field_ != change.field) return;
  const std::vector<float> values = floatsOf(type_, change.values);
  const std::span<float> seen = values_->mapped<float>();
  auto next = values.begin();
  change.points.forEach([&](std::uint64_t point) {
    const float value = *next++;
    if (point < seen.size()) seen[point] = value;
  });
}

void DrawnAttributes::show(std::uint32_t number, const Field* field) {
  device_.throughputQueue().finish();
  field_.reset();
  if (!field) return;
  if (!values_) values_.emplace(Buffer::of<float>(device_, count_, Memory::upload, "drawn field"));
  std::vector<float> values = floatsOf(field->values.type, field->values.data);
  values.resize(count_, std::nanf(""));
  std::ranges::copy(values, values_->mapped<float>().begin());
  field_ = number;
  type_ = field->values.type;
}

const Buffer* DrawnAttributes::mask(MaskRole role) const {
  const auto number = static_cast<std::size_t>(role);
  return number < masks_.size() && masks_[number].count > 0 ? &*masks_[number].bits : nullptr;
}

std::uint64_t DrawnAttributes::bytes() const {
  std::uint64_t bytes = values_ ? values_->bytes() : 0;
  for (const Mask& mask : masks_) bytes += mask.bits ? mask.bits->bytes() : 0;
  return bytes;
}

}  // namespace palpate
