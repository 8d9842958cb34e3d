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

  void receive(BrickKey key, std::shared_ptr<const Brick> points) {
    const std::uint64_t checksum = checksumOf(*points);
    blocks_[key] = {.points = std::move(points), .version = ++version_, .checksum = checksum};
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

 private:
  BrickGrid grid_;
  std::map<BrickKey, PointBlock> blocks_;
  std::set<BrickKey> news_;
  std::uint64_t version_ = 0;
};

}  // namespace palpate
