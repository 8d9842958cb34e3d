// A follower of a back end's edits that also offers it changes of others, with checks of both.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/edit/journal.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// Offers random changes of points and tracks their outcome.
class Offering {
 public:
  Offering(TouchBackend& touch, const PointCloud& cloud, std::uint32_t seed)
      : touch_(touch), cloud_(cloud), journal_(cloud, 1 << 26), shown_(statesOf(cloud)), dice_(seed) {
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
    for (const PointState& state : batch.points) shown_[state.number()] = state;
    journal_.follow(batch);
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
      if (named[point.number()] || !chosen(point)) continue;
      named[point.number()] = true;
      PointChange change{point, point};
      if (point.gone() || dice_() % 5 == 0) change.to.id ^= PointState::kGone;
      if (!change.to.gone()) change.to.position += Vec3(to(dice_), to(dice_), to(dice_));
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
    const PointCloud expected = editedCloud(cloud_, journal_.points());
    CHECK(ended.positions == expected.positions);
    CHECK(ended.normals == expected.normals);
    CHECK(ended.colors == expected.colors);
  }

  const Journal& journal() const { return journal_; }
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
  Journal journal_;
  std::vector<PointState> shown_;
  std::mt19937 dice_;
  std::vector<PointChange> offered_;
  bool isOffered_ = false;
  std::uint64_t changes_ = 0;
  std::size_t offers_ = 0, reports_ = 0, parts_ = 0, taken_ = 0, left_ = 0, lastTaken_ = 0;
};

/// Strokes on the top of a sphere of 50 about the origin, while others change points elsewhere, or there as well.
inline void checkOffersAmidStrokes(TouchBackend& touch, const PointCloud& cloud, bool everywhere, std::uint32_t seed) {
  REQUIRE(touch.edits()->mostOffered() >= 64);
  Offering others(touch, cloud, seed);
  constexpr int kTicks = 60, kStrokes = 3;
  std::size_t elsewhere = 0, takenElsewhere = 0;
  bool isElsewhere = true;
  for (int i = 0; i < kStrokes * kTicks; ++i) {
    const double phase = (i % kTicks) / (0.5 * kTicks), depth = 3 * (phase < 1 ? phase : 2 - phase);
    const double time_s = 1e-3 * i + 0.5 * (i / kTicks);  // far enough apart to be strokes
    touch.query({.time_s = time_s, .hip = {6.0 * (i / kTicks), 0, 51 - depth}}, 0);
    if (i % 3 == 0) {
      const std::size_t before = others.taken();
      others.follow();
      if (isElsewhere && !others.isOffered()) takenElsewhere += others.taken() - before;
    }
    if (others.isOffered()) continue;
    // The hand reaches down to about 40 on the upper half.
    isElsewhere = !everywhere || i % 2 == 0;
    const auto chosen = [&](const PointState& point) { return (point.position.z < 20) == isElsewhere; };
    if (others.offer(40, 2, chosen) && isElsewhere) elsewhere += 40;
  }
  touch.finish();
  others.checkEnd();
  // Only a change that removes the ground under a hand may end its stroke.
  if (everywhere)
    CHECK(others.journal().strokes() > 0);
  else
    CHECK(others.journal().strokes() == kStrokes);
  CHECK(others.offers() > 50);
  CHECK(others.parts() > 10);
  CHECK(others.taken() > 1000);
  // Away from the hand all changes are applied as offered.
  CHECK(takenElsewhere > 500);
  CHECK(takenElsewhere + 40 >= elsewhere);
}

/// A change whose point has another state is not applied; after a change by another party none is; both are reported.
inline void checkOffersThatAreLate(TouchBackend& touch, const PointCloud& cloud) {
  Offering others(touch, cloud, 3);
  double time_s = 0;
  const auto rest = [&] {
    touch.query({.time_s = time_s += 1e-3, .hip = {0, 0, 200}}, 0);
    touch.query({.time_s = time_s += 1e-3, .hip = {0, 0, 200}}, 0);
    others.follow();
  };
  rest();
  const auto state = [&](std::uint32_t point) { return others.shown()[point]; };
  const auto moved = [&](std::uint32_t point, float z) {
    PointChange change{state(point), state(point)};
    change.to.position.z += z;
    return change;
  };
  // Points 1 and 2 are far from the positions that two of the changes state.
  PointChange wrong = moved(1, 5), gone = moved(2, 0);
  wrong.from.position += Vec3(30, 30, 30);
  wrong.to.color = 0xff112233;  // a change not applied does not paint either
  gone.from.position += Vec3(-30, 0, 7);
  gone.to.id |= PointState::kGone;
  REQUIRE(others.offerThese({moved(0, 5), wrong, gone, moved(3, -5)}));
  CHECK_FALSE(touch.edits()->offer({}, 0));  // one at a time
  rest();
  CHECK(others.reports() == 1);
  CHECK(others.lastTaken() == 2);
  CHECK(state(1) == statesOf(cloud)[1]);
  CHECK(state(2) == statesOf(cloud)[2]);
  CHECK(state(0).position.z == cloud.positions[0].z + 5);

  // Removed, and restored as it was.
  PointChange away = moved(7, 0);
  away.to.id |= PointState::kGone;
  REQUIRE(others.offerThese({away}));
  rest();
  CHECK(others.lastTaken() == 1);
  CHECK(state(7).gone());
  // Restored by another change meanwhile: the offer must not duplicate the point.
  std::swap(away.from, away.to);
  touch.edits()->change(std::vector{away});
  REQUIRE(others.offerThese({away}));
  rest();
  CHECK(others.reports() == 3);
  CHECK(others.lastTaken() == 0);
  CHECK(state(7) == statesOf(cloud)[7]);
  REQUIRE(others.offerThese({moved(7, 3)}));
  rest();
  CHECK(others.lastTaken() == 1);
  touch.finish();
  others.checkEnd();
  // An offer above the maximum is rejected.
  CHECK_FALSE(touch.edits()->offer(std::vector<PointChange>(touch.edits()->mostOffered() + 1, moved(9, 1)), 1));
}

}  // namespace palpate
