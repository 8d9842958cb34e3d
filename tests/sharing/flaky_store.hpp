// A store of points that has only some of them at a time, and damages a few.
#pragma once

#include <random>
#include <unordered_set>

#include "engine/cloud/point_store.hpp"

namespace palpate {

/// Of the wanted blocks of another store, each comes with every second look, in no order. One in eight comes damaged;
/// it is repaired when it is refused, unless `staysDamaged`.
class FlakyStore final : public PointStore {
 public:
  FlakyStore(PointStore& whole, unsigned seed, bool staysDamaged = false)
      : whole_(whole), random_(seed), staysDamaged_(staysDamaged) {}

  const BrickGrid& grid() const override { return whole_.grid(); }
  void want(std::span<const BrickKey> keys) override {
    wanted_.assign(keys.begin(), keys.end());
    whole_.want(keys);
  }
  std::optional<PointBlock> get(BrickKey key) const override {
    if (!here_.contains(key)) {
      ++notHere_;
      return std::nullopt;
    }
    auto block = whole_.get(key);
    if (block && damaged_.contains(key)) block->checksum ^= 1;
    return block;
  }
  void takeNews(std::vector<BrickKey>& keys) override {
    whole_.takeNews(keys);
    for (const BrickKey key : wanted_) {
      if (random_() % 2 == 0 || here_.contains(key)) continue;
      keys.push_back(key);
      here_.insert(key);
      if (random_() % 8 == 0 && damaged_.insert(key).second) ++damages_;
    }
  }
  void refuse(BrickKey key) override {
    ++refusals_;
    here_.erase(key);
    if (!staysDamaged_) damaged_.erase(key);
  }
  std::size_t refusals() const { return refusals_; }
  std::size_t damages() const { return damages_; }
  std::size_t notHere() const { return notHere_; }
  bool isDamaged(BrickKey key) const { return damaged_.contains(key); }

 private:
  PointStore& whole_;
  std::mt19937 random_;
  bool staysDamaged_;
  std::vector<BrickKey> wanted_;
  std::unordered_set<BrickKey> here_, damaged_;
  std::size_t damages_ = 0, refusals_ = 0;
  mutable std::size_t notHere_ = 0;
};

}  // namespace palpate
