#include "engine/io/range_coder.hpp"

#include <algorithm>

namespace palpate {

namespace {

constexpr std::uint32_t kWhole = 0x80000000u;  // shares are computed from counts with 31 bits

std::uint32_t longer(std::uint32_t cycle, std::uint32_t longest) { return std::min(5 * cycle / 4, longest); }

constexpr std::uint32_t kBehindCells = 8;
void fillCells(std::uint16_t* cells, std::uint32_t shares) {
  const std::uint64_t four = shares * 0x0001000100010001u;
  std::memcpy(cells, &four, sizeof four);
  std::memcpy(cells + 4, &four, sizeof four);
}

}  // namespace

void BitModel::update() {
  constexpr std::uint32_t kMaxCounted = 1u << 13, kLongestCycle = 64;
  all_ += cycle_;
  if (all_ > kMaxCounted) {  // halve the weight of old counts
    all_ = (all_ + 1) / 2;
    zeros_ = (zeros_ + 1) / 2;
    if (zeros_ == all_) ++all_;
  }
  zeroShare_ = zeros_ * (kWhole / all_) >> (31 - kShift);
  cycle_ = longer(cycle_, kLongestCycle);
  untilUpdate_ = cycle_;
}

SymbolModel::SymbolModel(unsigned symbols) {
  // About as many cells as symbols, so that few searches need more than one step.
  const auto bits = static_cast<unsigned>(std::bit_width(symbols - 1));
  const std::size_t cells = (std::size_t{1} << bits) + 2 + kBehindCells, behind = symbols + kBehind;
  last_ = static_cast<std::uint16_t>(symbols - 1);
  sharesAt_ = static_cast<std::uint16_t>(cells);
  countsAt_ = static_cast<std::uint16_t>(cells + behind);
  cellShift_ = static_cast<std::uint16_t>(kShift - bits);
  words_.assign(cells + behind + symbols, 0);
  words_[0] = sharesAt_;
  std::fill_n(words_.begin() + sharesAt_ + symbols, kBehind, std::uint16_t{0xffff});
  std::fill_n(words_.begin() + countsAt_, symbols, std::uint16_t{1});
  cycle_ = symbols;
  update();
  cycle_ = (symbols + 6) / 2;
  untilUpdate_ = cycle_;
}

void SymbolModel::update() {
  constexpr std::uint32_t kMaxCounted = 1u << 15;
  const std::uint32_t symbols = last_ + 1u;
  std::uint16_t *const cells = words_.data(), *const sums = cells + sharesAt_, *const counts = cells + countsAt_;
  all_ += cycle_;
  if (all_ > kMaxCounted) {
    all_ = 0;
    for (std::uint32_t k = 0; k < symbols; ++k) {
      counts[k] = static_cast<std::uint16_t>((counts[k] + 1) / 2);
      all_ += counts[k];
    }
  }
  const std::uint32_t scale = kWhole / all_;
  std::uint32_t sum = 0, cell = 1;
  for (std::uint32_t k = 0; k < symbols; ++k) {
    sums[k] = static_cast<std::uint16_t>(scale * sum >> (31 - kShift));
    sum += counts[k];
    // Fills the cells that begin in the previous symbol, several at once and possibly too many; the following symbols
    // overwrite the excess. This avoids a branch on their unpredictable number.
    const std::uint32_t end = (sums[k] >> cellShift_) + 1u;
    for (std::uint32_t from = cell; from < end; from += kBehindCells) fillCells(cells + from, sharesAt_ + k - 1);
    cell = end;
  }
  for (const std::uint32_t end = (1u << (kShift - cellShift_)) + 2; cell < end; cell += kBehindCells)
    fillCells(cells + cell, std::uint32_t{sharesAt_} + last_);  // a share may be 2^15 and more
  cycle_ = longer(cycle_, 8 * (symbols + 6));
  untilUpdate_ = cycle_;
}

void RangeEncoder::carry() {
  auto at = bytes_.end();
  while (*--at == std::byte{0xff}) *at = std::byte{0};
  *at = static_cast<std::byte>(static_cast<unsigned>(*at) + 1);
}

std::vector<std::byte> RangeEncoder::finish() {
  // A value inside the interval in as few bytes as possible, followed by the bytes that the decoder reads ahead.
  const bool wide = length_ > 2 * kShortest;
  if (wide)
    narrow(kShortest, kShortest >> 1);
  else
    narrow(kShortest >> 1, kShortest >> 9);
  bytes_.insert(bytes_.end(), wide ? 3 : 2, std::byte{0});
  return std::move(bytes_);
}

}  // namespace palpate
