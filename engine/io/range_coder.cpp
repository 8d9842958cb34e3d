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

SymbolModel::SymbolModel(unsigned symbols) : counts_(symbols, 1), sums_(symbols) {
  constexpr unsigned kFewCells = 3;
  unsigned bits = 0;
  if (symbols > 16)
    for (bits = kFewCells; symbols > 1u << (bits + 2);) ++bits;
  cellShift_ = kShift - bits;
  cells_.resize((std::size_t{1} << bits) + 2);
  cycle_ = symbols;
  update();
  cycle_ = (symbols + 6) / 2;
  untilUpdate_ = cycle_;
}

void SymbolModel::update() {
  constexpr std::uint32_t kMostCounted = 1u << 15;
  const auto symbols = static_cast<std::uint32_t>(counts_.size());
  all_ += cycle_;
  if (all_ > kMostCounted) {
    all_ = 0;
    for (std::uint32_t& count : counts_) all_ += count = (count + 1) / 2;
  }
  const std::uint32_t scale = kWhole / all_;
  std::uint32_t sum = 0;
  std::size_t cell = 0;
  for (std::uint32_t k = 0; k < symbols; ++k) {
    sums_[k] = scale * sum >> (31 - kShift);
    sum += counts_[k];
    for (const std::size_t begin = sums_[k] >> cellShift_; cell < begin;)
      cells_[++cell] = static_cast<std::uint16_t>(k - 1);
  }
  cells_[0] = 0;
  while (cell + 1 < cells_.size()) cells_[++cell] = static_cast<std::uint16_t>(symbols - 1);
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
