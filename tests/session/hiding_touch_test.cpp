// How points are hidden: few by changes, many by a replacement, and each appears as it vanished.
#include "haptics/session/hiding_touch.hpp"

#include <doctest/doctest.h>

#include <random>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/edit/history.hpp"
#include "tests/scenes.hpp"
#include "tests/session/backend_kind.hpp"
#include "tests/session/session_scene.hpp"

namespace palpate::hiding_touch_test {

namespace {

/// A stream of edits without a back end: what exists in it, and what a reader of its log sees.
class Points final : public TouchDecorator, private EditStream {
 public:
  explicit Points(std::size_t points, bool replaces)
      : TouchDecorator(nullptr), exists(points, true), seen(points, true), replaces_(replaces) {}
  EditStream* edits() noexcept override { return this; }

  std::vector<bool> exists, seen;
  std::size_t changed = 0, replaced = 0, wrong = 0;

 private:
  void keep() override {}
  void take(EditBatch& batch) override {
    const std::size_t before = batch.points.size();
    for (const PointState& state : last_) batch.points.push_back(state);
    if (!last_.empty()) batch.marks.push_back({before + last_.size(), EditMark::Kind::change});
    last_.clear();
  }
  EditProgress progress() const noexcept override { return {}; }
  void change(std::span<const PointChange> changes) override {
    for (const PointChange& each : changes) {
      wrong += exists[each.from.number] == each.from.gone || each.from.gone == each.to.gone;
      exists[each.to.number] = seen[each.to.number] = !each.to.gone;
      last_.push_back(each.to);
    }
    changed += changes.size();
  }
  bool replace(const PointSet& points, std::span<const PointState> states, const PointSet& without) override {
    if (!replaces_) return false;
    points.forEach([&](std::uint64_t i) { exists[i] = !states[i].gone && !without.test(i); });
    ++replaced;
    return true;
  }
  bool offer(std::span<const PointChange>, std::uint64_t) override { return false; }
  std::size_t mostOffered() const override { return 0; }

  std::vector<PointState> last_;
  bool replaces_;
};

}  // namespace

TEST_CASE("whatever is hidden and shown, exactly the shown points exist, and a reader of the log misses none of them") {
  constexpr std::size_t kCount = 2'000;
  for (const bool replaces : {true, false}) {
    auto made = std::make_unique<Points>(kCount, replaces);
    Points& points = *made;
    HidingTouch hiding(std::move(made));
    std::vector<PointState> states;
    for (std::size_t i = 0; i < kCount; ++i) states.push_back({.gone = i % 17 == 3, .number = i, .parent = i});
    for (std::size_t i = 0; i < kCount; ++i) points.exists[i] = points.seen[i] = !states[i].gone;
    std::mt19937 random(7);
    PointSet hidden;
    for (int step = 0; step < 60; ++step) {
      PointSet flip;
      const std::size_t count = random() % 3 == 0 ? 800 : 20, begin = random() % kCount;
      for (std::size_t i = begin; i < std::min(kCount, begin + count); ++i) flip.set(i);
      hidden.flip(flip);
      if (step % 15 == 14) hidden = {};
      hiding.edits()->hide(hidden, [&]() -> std::span<const PointState> { return states; });
      EditBatch batch;
      hiding.edits()->take(batch);
      CHECK(batch.empty());
      std::size_t wrong = 0, missed = 0;
      for (std::size_t i = 0; i < kCount; ++i) {
        const bool shown = !states[i].gone && !hidden.test(i);
        wrong += points.exists[i] != shown;
        missed += shown && !points.seen[i];
      }
      REQUIRE(wrong == 0);
      REQUIRE(missed == 0);
    }
    CHECK(points.wrong == 0);
    CHECK(points.changed > 100);
    CHECK((points.replaced > 10) == replaces);
  }
}

TEST_CASE("points that vanish and reappear at once are reported as by changes, and hidden ones stay hidden") {
  constexpr std::size_t kCount = 2'000;
  auto made = std::make_unique<Points>(kCount, true);
  Points& points = *made;
  HidingTouch hiding(std::move(made));
  EditStream& edits = *hiding.edits();
  std::vector<PointState> states;
  for (std::size_t i = 0; i < kCount; ++i) states.push_back({.number = i, .parent = i});
  edits.hide(PointSet::range(900, 1'100), [&]() -> std::span<const PointState> { return states; });
  EditBatch batch;
  edits.take(batch);
  const std::uint64_t reported = edits.progress().states;
  const auto flip = [&](const PointSet& flipped) {
    flipped.forEach([&](std::uint64_t point) { states[point].gone = !states[point].gone; });
    return edits.changeMany(flipped, states);
  };
  // Few are left to change().
  CHECK_FALSE(flip(PointSet::range(0, 20)));
  flip(PointSet::range(0, 20));
  PointSet many = PointSet::range(3, 1'000);
  many.set(1'999);
  for (int step = 1; step <= 2; ++step) {
    REQUIRE(flip(many));
    CHECK(edits.progress().states - reported == static_cast<std::uint64_t>(step) * many.count());
    batch.clear();
    edits.take(batch);
    REQUIRE(batch.points.size() == many.count());
    CHECK(batch.marks == std::vector<EditMark>{{many.count(), EditMark::Kind::change}});
    CHECK(batch.hasMoreThanLog);
    std::size_t wrong = 0, next = 0;
    many.forEach([&](std::uint64_t point) { wrong += !(batch.points[next++] == states[point]); });
    for (std::size_t i = 0; i < kCount; ++i) wrong += points.exists[i] != (!states[i].gone && (i < 900 || i >= 1'100));
    CHECK(wrong == 0);
  }
  CHECK(points.changed == 0);
}

}  // namespace palpate::hiding_touch_test
