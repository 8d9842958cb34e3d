// A cloud cut into bricks, and a hand on the CPU that has only some of them.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/touch/cpu_touch.hpp"
#include "haptics/sharing/brick_touch.hpp"
#include "tests/scenes.hpp"

namespace palpate {

/// The bricks of all points that are not removed.
class BricksOf {
 public:
  BricksOf(std::span<const PointState> points, const BrickGrid& grid) : grid_(grid) {
    for (const PointState& point : points) {
      if (point.gone) continue;
      auto& brick = all_[grid.keyAt(DVec3(point.position))];
      if (!brick) brick = std::make_shared<Brick>();
      brick->ids.push_back(point.number);
      brick->positions.push_back(point.position);
      brick->normals.push_back(point.normal);
      brick->colors.push_back(point.color);
    }
  }
  /// An empty brick where there are no points.
  std::shared_ptr<const Brick> at(BrickKey key) const {
    const auto there = all_.find(key);
    return there == all_.end() ? std::make_shared<Brick>() : there->second;
  }
  /// As a server sends it.
  PointBlock block(BrickKey key) const { return blockOf(at(key)); }
  /// Those within a box that `has` accepts.
  BrickUpdate around(const DVec3& low, const DVec3& high, const std::function<bool(const IVec3&)>& has = {}) const {
    BrickUpdate update;
    grid_.boxOf(low, high).forEach([&](const IVec3& brick) {
      const BrickKey key = BrickGrid::keyOf(brick);
      if (!has || has(brick)) update.bricks.emplace_back(key, block(key));
    });
    return update;
  }
  /// All of a box, with nothing still to be received.
  BrickUpdate whole(const DVec3& low, const DVec3& high) const {
    BrickUpdate update = around(low, high);
    update.whole = true;
    return update;
  }

 private:
  BrickGrid grid_;
  std::map<BrickKey, std::shared_ptr<Brick>> all_;
};

/// A hand that has those bricks of a scene that a test gives to its source.
struct BrickHand {
  struct How {
    double edge_radii = 3, widening = 1, timeout_s = 30;
    std::optional<BrushOptions> brush = {};
    std::string fixed = {};
  };
  /// `store`: has the bricks, in place of the test; null: the test gives them.
  BrickHand(const Scene& scene, const How& how, PointStore* store = nullptr)
      : source(store ? BrickSource({.points = 2 * scene.cloud.size()}, *store)
                     : BrickSource({.edge = how.edge_radii * scene.radius, .points = 2 * scene.cloud.size()})),
        bricks(statesOf(scene.cloud), source.grid()) {
    PointCloud few;  // never felt
    few.origin = scene.cloud.origin;
    few.positions = {scene.cloud.positions[0]};
    few.normals = {scene.cloud.normals[0]};
    touch = std::make_unique<BrickTouch>(
        source,
        std::make_unique<CpuTouch>(
            few, CpuTouchOptions{.radius = scene.radius,
                                 .widening = how.widening,
                                 .threads = 1,
                                 .source = &source,
                                 .extent = PointExtent{.bounds = boundsOf(scene.cloud), .points = scene.cloud.size()}}),
        BrickTouchOptions{.radius = scene.radius,
                          .widening = how.widening,
                          .origin = scene.cloud.origin,
                          .timeout_s = how.timeout_s,
                          .brush = how.brush,
                          .fixed = how.fixed});
  }
  BrickSource source;
  BricksOf bricks;
  std::unique_ptr<BrickTouch> touch;
};

/// States of the points that were edited since the last call.
inline std::vector<PointState> madeStates(BrickSource& source) {
  std::vector<sharing::MadeState> made;
  source.takeMade(made);
  std::vector<PointState> states;
  for (const sharing::MadeState& each : made) states.push_back(each.state);
  return states;
}

inline bool isSameContact(const Contact& a, const Contact& b) {
  return a.proxy == b.proxy && a.normal == b.normal && a.touching == b.touching && a.valid == b.valid &&
         a.neighbours == b.neighbours;
}

}  // namespace palpate
