// The blocks that a client has received from its server, as a store of points.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "engine/cloud/point_store.hpp"

namespace palpate {

/// Bricks come as the link requests them, which knows what its BrickSource lacks.
class ReceivedBricks final : public PointStore {
 public:
  explicit ReceivedBricks(const BrickGrid& grid) : grid_(grid) {}

  /// `block`: with the checksum of its sender.
  void receive(BrickKey key, PointBlock block) {
    block.version = ++version_;
    blocks_[key] = std::move(block);
    news_.insert(key);
  }
  void drop(BrickKey key) {
    if (blocks_.erase(key) > 0) news_.insert(key);
  }
  void clear() {
    for (const auto& [key, block] : blocks_) news_.insert(key);
    blocks_.clear();
  }

  const BrickGrid& grid() const override { return grid_; }
  void want(std::span<const BrickKey>) override {}
  std::optional<PointBlock> get(BrickKey key) const override {
    const auto there = blocks_.find(key);
    return there == blocks_.end() ? std::nullopt : std::optional(there->second);
  }
  void takeNews(std::vector<BrickKey>& keys) override {
    keys.insert(keys.end(), news_.begin(), news_.end());
    news_.clear();
  }
  void refuse(BrickKey key) override {
    blocks_.erase(key);
    isRefused_ = true;
  }
  /// Blocks were refused since the last call: they have to be requested again.
  bool takeRefused() { return std::exchange(isRefused_, false); }

 private:
  BrickGrid grid_;
  std::map<BrickKey, PointBlock> blocks_;
  std::set<BrickKey> news_;
  std::uint64_t version_ = 0;
  bool isRefused_ = false;
};

}  // namespace palpate
