#include "engine/io/range_coder.hpp"

#include <algorithm>

namespace palpate {

namespace {

constexpr std::uint32_t kWhole = 0x80000000u;  // shares come from counts through 31 bits

std::uint32_t longer(std::uint32_t cycle, std::uint32_t longest) { return std::min(5 * cycle / 4, longest); }

}  // namespace

void BitModel::update() {
  constexpr std::uint32_t kMostCounted = 1u << 13, kLongestCycle = 64;
  all_ += cycle_;
  if (all_ > kMostCounted) {  // what is long past counts half
    all_ = (all_ + 1) / 2;
    zeros_ = (zeros_ + 1) / 2;
    if (zeros_ == all_) ++all_;
  }
  zeroShare_ = zeros_ * (kWhole / all_) >> (31 - kShift);
  cycle_ = longer(cycle_, kLongestCycle);
  untilUpdate_ = cycle_;
}

SymbolModel::SymbolModel(unsigned symbols) {
  // About as many parts as symbols, so that few searches go beyond their first step.
  const auto bits = static_cast<unsigned>(std::bit_width(symbols - 1));
  const std::size_t cells = (std::size_t{1} << bits) + 2, behind = symbols + kBehind;
  last_ = static_cast<std::uint16_t>(symbols - 1);
  countsAt_ = static_cast<std::uint16_t>(behind);
  cellsAt_ = static_cast<std::uint16_t>(behind + symbols);
  cellShift_ = static_cast<std::uint16_t>(kShift - bits);
  words_.assign(behind + symbols + cells, 0);
  std::fill_n(words_.begin() + symbols, kBehind, std::uint16_t{0xffff});
  std::fill_n(words_.begin() + countsAt_, symbols, std::uint16_t{1});
  cycle_ = symbols;
  update();
  cycle_ = (symbols + 6) / 2;
  untilUpdate_ = cycle_;
}

void SymbolModel::update() {
  constexpr std::uint32_t kMostCounted = 1u << 15;
  const std::uint32_t symbols = last_ + 1u;
  std::uint16_t *const sums = words_.data(), *const counts = sums + countsAt_, *const cells = sums + cellsAt_;
  all_ += cycle_;
  if (all_ > kMostCounted) {
    all_ = 0;
    for (std::uint32_t k = 0; k < symbols; ++k) {
      counts[k] = static_cast<std::uint16_t>((counts[k] + 1) / 2);
      all_ += counts[k];
    }
  }
  const std::uint32_t scale = kWhole / all_;
  std::uint32_t sum = 0, cell = 0;
  for (std::uint32_t k = 0; k < symbols; ++k) {
    sums[k] = static_cast<std::uint16_t>(scale * sum >> (31 - kShift));
    sum += counts[k];
    for (const std::uint32_t begin = sums[k] >> cellShift_; cell < begin;)
      cells[++cell] = static_cast<std::uint16_t>(k - 1);
  }
  for (const std::uint32_t last = (1u << (kShift - cellShift_)) + 1; cell < last;)  // a share may be 2^15 and more
    cells[++cell] = static_cast<std::uint16_t>(last_);
  cycle_ = longer(cycle_, 8 * (symbols + 6));
  untilUpdate_ = cycle_;
}

void RangeEncoder::carry() {
  auto at = bytes_.end();
  while (*--at == std::byte{0xff}) *at = std::byte{0};
  *at = static_cast<std::byte>(static_cast<unsigned>(*at) + 1);
}

std::vector<std::byte> RangeEncoder::finish() {
  // A place inside of the interval, in as few bytes as tell it, and then as many as the decoder has read ahead.
  const bool wide = length_ > 2 * kShortest;
  if (wide)
    narrow(kShortest, kShortest >> 1);
  else
    narrow(kShortest >> 1, kShortest >> 9);
  bytes_.insert(bytes_.end(), wide ? 3 : 2, std::byte{0});
  return std::move(bytes_);
}

}  // namespace palpate
