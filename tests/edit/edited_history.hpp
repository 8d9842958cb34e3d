// Edits that a history follows, as a back end makes them.
#pragma once

#include <algorithm>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/edit/history.hpp"

namespace palpate::history_test {

inline PointCloud coloredCloud(std::size_t count) {
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const auto f = static_cast<float>(i);
    cloud.positions.emplace_back(f, 0.5f * f, -f);
    cloud.normals.emplace_back(0, 0, 1);
    cloud.colors.push_back({static_cast<std::uint8_t>(i), 1, 2, 255});
  }
  return cloud;
}

/// Acts as a back end with random edits: moves, paints, removes, restores, adds.
class Editor {
 public:
  Editor(const PointCloud& cloud, std::uint32_t seed) : points_(statesOf(cloud)), random_(seed) {}

  std::vector<PointState> tick(std::size_t most) {
    std::vector<PointState> states;
    std::vector<bool> named(points_.size() + most);
    for (std::size_t i = random_() % (most + 1); i > 0; --i) {
      const bool adds = random_() % 10 == 0;
      const auto id = static_cast<std::uint32_t>(adds ? points_.size() : random_() % points_.size());
      if (named[id]) continue;
      named[id] = true;
      if (adds) points_.push_back({.number = id, .parent = static_cast<std::uint32_t>(random_() % id)});
      PointState& point = points_[id];
      if (!adds && random_() % 6 == 0) {
        point.gone = !point.gone;
      } else {
        point.position += Vec3(unit_(random_), unit_(random_), unit_(random_));
        point.normal = glm::normalize(Vec3(unit_(random_), unit_(random_), 2));
        point.color = static_cast<std::uint32_t>(random_());
      }
      states.push_back(point);
    }
    return states;
  }
  std::vector<PointState> change(std::span<const PointChange> changes) {
    std::vector<PointState> states;
    for (const PointChange& change : changes) {
      PointState& point = points_[change.to.number];
      CHECK(point == change.from);
      states.push_back(point = change.to);
    }
    return states;
  }
  const std::vector<PointState>& points() const { return points_; }

 private:
  std::vector<PointState> points_;
  std::mt19937 random_;
  std::uniform_real_distribution<float> unit_{-1, 1};
};

inline void append(EditBatch& batch, const std::vector<PointState>& states) {
  batch.points.insert(batch.points.end(), states.begin(), states.end());
}
inline void give(History& history, EditBatch& batch) {
  history.follow(batch);
  batch.clear();
}
inline void mark(EditBatch& batch, EditMark::Kind kind) { batch.marks.push_back({batch.points.size(), kind}); }

// Existing points must be equal in every property; for others it is enough that they do not exist.
inline std::size_t differences(std::span<const PointState> a, std::span<const PointState> b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i) {
    const bool inA = i < a.size() && !a[i].gone, inB = i < b.size() && !b[i].gone;
    different += inA != inB || (inA && a[i] != b[i]);
  }
  return different;
}

inline std::vector<PointState> copyOf(std::span<const PointState> points) { return {points.begin(), points.end()}; }

inline PointState movedTo(float z, PointState point) {
  point.position.z = z;
  return point;
}

inline EditBatch strokeOf(std::uint32_t first, std::uint32_t count, float z) {
  EditBatch batch;
  for (std::uint32_t i = first; i < first + count; ++i) batch.points.push_back({.position = {0, 0, z}, .number = i});
  mark(batch, EditMark::Kind::stroke);
  return batch;
}

}  // namespace palpate::history_test
