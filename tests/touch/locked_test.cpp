// Points that brushes leave as they are, on each back end.
#include "engine/core/named_values.hpp"
#include "engine/edit/history.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate::locked_test {

namespace {

// A noisy sphere of radius 50 about the origin, so that there is something to smooth.
PointCloud noisySphere(const Scene& scene) {
  PointCloud cloud = scene.cloud;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.positions[i] *= 1 + 2e-3f * (static_cast<float>(i * 2654435761u % 1000) / 500 - 1);
  cloud.colors.assign(cloud.size(), {10, 20, 30, 255});
  return cloud;
}

class Sculptor {
 public:
  Sculptor(TouchBackend& touch, const PointCloud& cloud) : touch_(touch), history_(cloud, {1 << 26}) {
    touch.edits()->keep();
  }
  // Into the top, across it, and out again.
  void stroke() {
    const int ticks = onCpuOrGpu(120, 60);
    const auto pose = [&](double x, double z) { touch_.query({.time_s = time_s_ += 1e-3, .hip = {x, 0, z}}, 0); };
    for (int i = 0; i <= ticks; ++i) {
      const double t = static_cast<double>(i) / ticks;
      pose(-6 + 12 * t, 52 - 6 * std::min(1.0, 4 * t));
    }
    for (int i = 0; i < 4; ++i) pose(6, 47 + 3 * i);
    follow();
  }
  void follow() {
    touch_.finish();
    EditBatch batch;
    touch_.edits()->take(batch);
    history_.follow(batch);
  }
  const PointStates& points() const { return history_.points(); }
  History& history() { return history_; }

 private:
  TouchBackend& touch_;
  History history_;
  double time_s_ = 0;
};

std::size_t changedAmong(const PointSet& points, const PointStates& before, const PointStates& after) {
  std::size_t changed = 0;
  points.forEach([&](std::uint64_t point) { changed += !isSameToTheBit(before[point], after[point]); });
  return changed;
}

}  // namespace

TEST_CASE_FIXTURE(OnBackEndInCore,
                  "every brush leaves locked points as they are, to the bit, beside those it changes") {
  const Scene scene = makeScene("sphere", 8'000);
  const PointCloud cloud = noisySphere(scene);
  PointSet locked, free = PointSet::range(0, cloud.size());
  for (std::uint64_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].x < 0) locked.set(i);
  free.remove(locked);
  for (const auto& [name, kind] : kBrushKinds) {
    CAPTURE(name);
    const auto touch =
        make(cloud, {.radius = scene.radius,
                     .brush = BrushOptions{.kind = kind, .yieldDepth = 0.3, .pushRate = 0.5, .radius = 8},
                     .paintable = true});
    Sculptor sculptor(*touch, cloud);
    const PointStates before = sculptor.points();
    touch->edits()->lock(locked);
    sculptor.stroke();
    const PointStates after = sculptor.points();
    CHECK(changedAmong(locked, before, after) == 0);
    CHECK(changedAmong(free, before, after) > 5);
    // A new point descends from one that may change.
    for (const PointState& state : after)
      if (state.number >= cloud.size() && !state.gone) CHECK_FALSE(locked.test(state.parent));
    touch->edits()->lock({});
    sculptor.stroke();
    CHECK(changedAmong(locked, after, sculptor.points()) > 5);
  }
}

TEST_CASE_FIXTURE(OnBackEndInCore,
                  "a lock in the middle of a stroke ends it, and requests that are left touch nothing locked") {
  const Scene scene = makeScene("sphere", 8'000);
  const auto touch = make(
      scene.cloud, {.radius = scene.radius, .brush = BrushOptions{.yieldDepth = 0.3, .pushRate = 0.5, .radius = 8}});
  Sculptor sculptor(*touch, scene.cloud);
  for (int i = 0; i < onCpuOrGpu(80, 40); ++i)
    touch->query({.time_s = 1e-3 * i, .hip = {0, 0, 51 - onCpuOrGpu(0.1, 0.2) * i}}, 0);
  const PointSet all = PointSet::range(0, scene.cloud.size());
  touch->edits()->lock(all);
  sculptor.follow();
  CHECK(sculptor.history().counts().strokes == 1);
  const PointStates before = sculptor.points();
  for (int i = 0; i < 40; ++i) touch->query({.time_s = 1 + 1e-3 * i, .hip = {3, 0, 51 - 0.2 * i}}, 0);
  sculptor.follow();
  CHECK(changedAmong(all, before, sculptor.points()) == 0);
}

TEST_CASE_FIXTURE(OnBackEnd, "a lock without points, of all, and of a cloud that cannot be edited") {
  const Scene scene = makeScene("sphere", 1'000);
  const auto touch = make(scene.cloud, {.radius = scene.radius, .brush = BrushOptions{.yieldDepth = 0.3, .radius = 8}});
  touch->edits()->lock({});
  touch->edits()->lock(PointSet::range(0, scene.cloud.size()));
  touch->edits()->lock({});
  const Contact contact = touch->query({.time_s = 0, .hip = {0, 0, 52}}, 0);
  CHECK(contact.valid);
}

}  // namespace palpate::locked_test
