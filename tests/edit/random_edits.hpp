// Random edits of a scene, reproducible by seed, with a mirror on the host that follows only the log.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <random>

#include "tests/edit_gpu/edited_scene.hpp"

namespace palpate {

/// Maximum number of points per edit: enough that a bucket receives more at once than it can hold.
inline constexpr std::uint32_t kManyAtOnce = 400;
/// The same with GPU-assisted validation. An update compares all points that enter a bucket, and lavapipe ends an
/// invocation's loops after 65,535 iterations, including those of address searches: beyond about 150 points valid
/// addresses may be reported as invalid, depending on buffer addresses.
inline constexpr std::uint32_t kFewAtOnce = 100;

/// Edits of every kind, in random order, and their expected results.
class RandomEdits {
 public:
  RandomEdits(EditedScene& scene, std::uint32_t seed, std::uint32_t mostAtOnce)
      : scene_(scene), random_(seed), mostAtOnce_(mostAtOnce), mirror_(scene.points()) {
    nextId_ = scene.live().count();
  }

  void one() {
    const std::uint32_t kind = pick(20);
    if (kind < 8)
      brush();
    else if (kind < 19)
      change();
    else
      scene_.compact();
    auto log = scene_.takeLog();  // unordered within a tick
    std::ranges::sort(log, {}, &PointState::number);
    for (const PointState& state : log) apply(state);
  }
  bool agrees() const { return scene_.points() == mirror_; }
  std::size_t size() const { return mirror_.size(); }
  std::size_t refused() const { return refused_; }

 private:
  std::uint32_t pick(std::uint32_t n) { return std::uniform_int_distribution<std::uint32_t>(0, n - 1)(random_); }
  double signedShare() { return std::uniform_real_distribution<double>(-1, 1)(random_); }
  Vec3 somewhere() { return Vec3(DVec3(signedShare(), signedShare(), signedShare()) * 60.0); }

  void brush() {
    auto at = std::next(mirror_.begin(), pick(static_cast<std::uint32_t>(mirror_.size())));
    const DVec3 outward(at->second.normal);
    const double depth = 0.5 + std::abs(signedShare());
    if (!scene_.brush(DVec3(at->second.position) - depth * outward, depth * outward, EditedScene::How::incremental))
      refuse();
  }

  // Some points move near or far, some are removed, restored or new; half of the time all in one corner, so that
  // buckets grow.
  void change() {
    std::map<std::uint32_t, PointChange> changes;
    const std::uint32_t count = 1 + pick(pick(4) == 0 ? mostAtOnce_ : 20);
    const bool corner = pick(2) == 0;
    const Vec3 center = somewhere();
    for (std::uint32_t i = 0; i < count; ++i) {
      const std::uint32_t kind = pick(8);
      const Vec3 place = corner ? center + 0.02f * somewhere() : somewhere();
      PointState to{.position = place, .normal = Vec3(0, 0, 1)};
      if (kind == 0 && !gone_.empty()) {
        to.number = gone_[pick(static_cast<std::uint32_t>(gone_.size()))];
      } else if (kind == 1 && nextId_ < scene_.live().slots() - 200) {
        to.number = nextId_++;
      } else {
        auto at = std::next(mirror_.begin(), pick(static_cast<std::uint32_t>(mirror_.size())));
        to.number = at->first;
        if (kind == 3) to.position = at->second.position + 0.01f * somewhere();
        if (kind == 4 && mirror_.size() > 100) to.gone = true;
      }
      to.parent = to.number < scene_.live().count() ? to.number : 0;
      const auto before = mirror_.find(to.number);
      const PointState from =
          before != mirror_.end() ? before->second : PointState{.gone = true, .number = to.number, .parent = to.parent};
      if (from.gone && to.gone) continue;
      changes[to.number] = {from, to};
    }
    std::vector<PointChange> given;
    for (const auto& [id, each] : changes) given.push_back(each);
    if (scene_.change(given, EditedScene::How::incremental)) return;
    refuse();
    CHECK(scene_.change(given, EditedScene::How::rebuild));
  }

  // A rejected edit must leave everything unchanged.
  void refuse() {
    ++refused_;
    CHECK(scene_.takeLog().empty());
    CHECK(scene_.faults() == 0);
    CHECK(agrees());
    scene_.compact();
  }

  void apply(const PointState& state) {
    nextId_ = std::max(nextId_, static_cast<std::uint32_t>(state.number) + 1);  // resampling also adds points
    if (state.gone) {
      mirror_.erase(state.number);
      gone_.push_back(state.number);
    } else {
      mirror_[state.number] = state;
      std::erase(gone_, state.number);
    }
  }

  EditedScene& scene_;
  std::mt19937 random_;
  std::uint32_t mostAtOnce_;
  std::map<std::uint32_t, PointState> mirror_;
  std::vector<std::uint32_t> gone_;
  std::uint32_t nextId_ = 0;
  std::size_t refused_ = 0;
};

inline BrushOptions brushOf(BrushKind kind) {
  return {.kind = kind, .yieldDepth = 0.1, .pushRate = 0.5, .radius = 6, .strength = 0.8};
}

}  // namespace palpate
