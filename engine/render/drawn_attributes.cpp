#include "engine/render/drawn_attributes.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/gpu/device.hpp"

namespace palpate {

void DrawnAttributes::follow(std::span<const AttributeChange> changes) {
  if (changes.empty()) return;
  device_.throughputQueue().finish();  // which may still read them
  for (const AttributeChange& change : changes)
    if (const auto* const flipped = std::get_if<MaskFlip>(&change)) flip(*flipped);
}

void DrawnAttributes::flip(const MaskFlip& flip) {
  const auto role = static_cast<std::size_t>(flip.role);
  if (role >= masks_.size() || flip.points.empty()) return;
  ++changes_;
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

void DrawnAttributes::show(std::span<const float> numbers) {
  device_.throughputQueue().finish();
  if (!values_) values_.emplace(Buffer::of<float>(device_, count_, Memory::upload, "drawn numbers"));
  const std::span<float> seen = values_->mapped<float>();
  const std::size_t given = std::min(seen.size(), numbers.size());
  std::ranges::copy(numbers.first(given), seen.begin());
  std::ranges::fill(seen.subspan(given), std::nanf(""));
}

void DrawnAttributes::set(std::span<const std::pair<std::uint64_t, float>> numbers) {
  if (!values_ || numbers.empty()) return;
  device_.throughputQueue().finish();
  const std::span<float> seen = values_->mapped<float>();
  for (const auto& [point, number] : numbers)
    if (point < seen.size()) seen[point] = number;
}

void DrawnAttributes::showNone() {
  device_.throughputQueue().finish();
  values_.reset();
}

void DrawnAttributes::showLock(std::span<const std::uint8_t> weights) {
  device_.throughputQueue().finish();
  if (weights.empty()) return lock_.reset();
  if (!lock_) lock_.emplace(Buffer::of<std::uint32_t>(device_, count_ / 4 + 1, Memory::upload, "drawn lock"));
  const std::span<std::uint8_t> seen = lock_->mapped<std::uint8_t>();
  const std::size_t given = std::min(seen.size(), weights.size());
  std::ranges::copy(weights.first(given), seen.begin());
  std::ranges::fill(seen.subspan(given), std::uint8_t{0});
}

const Buffer* DrawnAttributes::mask(MaskRole role) const {
  const auto number = static_cast<std::size_t>(role);
  return number < masks_.size() && masks_[number].count > 0 ? &*masks_[number].bits : nullptr;
}

std::uint64_t DrawnAttributes::bytes() const {
  std::uint64_t bytes = (values_ ? values_->bytes() : 0) + (lock_ ? lock_->bytes() : 0);
  for (const Mask& mask : masks_) bytes += mask.bits ? mask.bits->bytes() : 0;
  return bytes;
}

}  // namespace palpate
