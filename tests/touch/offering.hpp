// A follower of a back end's edits that also offers it changes of others, with checks of both.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/edit/history.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// Offers random changes of points and tracks their outcome.
class Offering {
 public:
  Offering(TouchBackend& touch, const PointCloud& cloud, std::uint32_t seed)
      : touch_(touch), cloud_(cloud), history_(cloud, {1 << 26}), shown_(statesOf(cloud)), dice_(seed) {
    touch.edits()->keep();
  }

  /// Receives the edits and checks them against the offer.
  void follow() {
    EditBatch batch;
    touch_.edits()->take(batch);
    std::size_t begin = 0;
    for (const EditMark& mark : batch.marks) {
      const std::span states = std::span(batch.points).subspan(begin, mark.at - begin);
      if (mark.kind == EditMark::Kind::received) reported(states);
      if (mark.kind == EditMark::Kind::change) ++changes_;
      parts_ += mark.kind == EditMark::Kind::part;
      begin = mark.at;
    }
    for (const PointState& state : batch.points) shown_[state.number] = state;
    history_.follow(batch);
  }

  /// Offers `count` points selected by `chosen`: moved by up to `way`, removed, or restored.
  template <class Chosen>
  bool offer(std::size_t count, float way, Chosen&& chosen) {
    if (isOffered_) return false;
    std::vector<PointChange> changes;
    std::uniform_real_distribution<float> to(-way, way);
    std::vector<bool> named(shown_.size());
    for (std::size_t i = 0; i < 50 * count && changes.size() < count; ++i) {
      const PointState& point = shown_[dice_() % shown_.size()];
      if (named[point.number] || !chosen(point)) continue;
      named[point.number] = true;
      PointChange change{point, point};
      if (point.gone || dice_() % 5 == 0) change.to.gone = !change.to.gone;
      if (!change.to.gone) change.to.position += Vec3(to(dice_), to(dice_), to(dice_));
      changes.push_back(change);
    }
    return offerThese(changes);
  }
  bool offerThese(std::vector<PointChange> changes) {
    if (!touch_.edits()->offer(changes, changes_)) return false;
    offered_ = std::move(changes);
    isOffered_ = true;
    ++offers_;
    return true;
  }

  void checkEnd() {
    follow();
    PointCloud ended = cloud_;
    touch_.readBack(ended);
    const PointCloud expected = editedCloud(cloud_, history_.points());
    CHECK(ended.positions == expected.positions);
    CHECK(ended.normals == expected.normals);
    CHECK(ended.colors == expected.colors);
  }

  const History& history() const { return history_; }
  std::span<const PointState> shown() const { return shown_; }
  bool isOffered() const { return isOffered_; }
  std::size_t offers() const { return offers_; }
  std::size_t reports() const { return reports_; }
  std::size_t parts() const { return parts_; }
  std::size_t taken() const { return taken_; }  ///< applied changes
  std::size_t left() const { return left_; }    ///< changes not applied
  std::size_t lastTaken() const { return lastTaken_; }

 private:
  void reported(std::span<const PointState> states) {
    CHECK(isOffered_);
    isOffered_ = false;
    ++reports_;
    lastTaken_ = states.size();
    taken_ += states.size();
    left_ += offered_.size() - states.size();
    for (const PointState& state : states) CHECK(std::ranges::count(offered_, state, &PointChange::to) == 1);
  }

  TouchBackend& touch_;
  const PointCloud& cloud_;
  History history_;
  std::vector<PointState> shown_;
  std::mt19937 dice_;
  std::vector<PointChange> offered_;
  bool isOffered_ = false;
  std::uint64_t changes_ = 0;
  std::size_t offers_ = 0, reports_ = 0, parts_ = 0, taken_ = 0, left_ = 0, lastTaken_ = 0;
};

}  // namespace palpate
