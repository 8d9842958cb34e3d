// Points that brushes leave as they are, on each back end.
#include <numbers>

#include "engine/core/named_values.hpp"
#include "engine/edit/history.hpp"
#include "tests/near.hpp"
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

// The points before and after a stroke.
struct Stroke {
  PointStates before, after;
  double depth() const {  // mean displacement of the points under the middle of the stroke
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < before.size(); ++i) {
      if (after[i].gone || before[i].position.z < 0) continue;
      if (std::hypot(before[i].position.x, before[i].position.y) > 3) continue;
      sum += glm::distance(before[i].position, after[i].position);
      ++count;
    }
    return count == 0 ? 0 : sum / static_cast<double>(count);
  }
  std::size_t gone() const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < before.size(); ++i) count += after[i].gone;
    return count;
  }
};

class InPart : public OnBackEndInCore {
 public:
  Stroke stroke(BrushKind kind, std::vector<std::uint8_t> weights) const {
    const auto touch =
        make(cloud_, {.radius = scene_.radius,
                      .brush = BrushOptions{.kind = kind, .yieldDepth = 0.3, .pushRate = 0.5, .radius = 8},
                      .paintable = true});
    Sculptor sculptor(*touch, cloud_);
    Stroke stroke{.before = sculptor.points(), .after = sculptor.points()};
    PointLock lock{.weights = std::move(weights)};
    for (std::size_t i = 0; i < lock.weights.size(); ++i)
      if (lock.weights[i] == PointLock::kWhole) lock.points.set(i);
    touch->edits()->lock(lock);
    sculptor.stroke();
    stroke.after = sculptor.points();
    return stroke;
  }
  std::vector<std::uint8_t> all(std::uint8_t weight) const { return std::vector<std::uint8_t>(cloud_.size(), weight); }
  const PointCloud& cloud() const { return cloud_; }

 private:
  const Scene scene_ = makeScene("sphere", 8'000);
  const PointCloud cloud_ = noisySphere(scene_);
};

}  // namespace

TEST_CASE_FIXTURE(InPart, "a brush moves points that are locked in part by the rest of what it moves free ones") {
  for (const BrushKind kind :
       {BrushKind::push, BrushKind::inflate, BrushKind::smooth, BrushKind::flatten, BrushKind::grab}) {
    CAPTURE(traitsOf(kind).name);
    const double whole = stroke(kind, {}).depth();
    CHECK(whole > 0.03);
    for (const int weight : {51, 127, 204, 250}) {
      CAPTURE(weight);
      const double rest = stroke(kind, all(static_cast<std::uint8_t>(weight))).depth();
      CHECK(rest / whole == within(1 - weight / 255.0, kind == BrushKind::smooth ? 0.15 : 0.06));
    }
  }
}

TEST_CASE_FIXTURE(InPart, "carve cuts what is locked by half at most, and nothing else") {
  const Stroke free = stroke(BrushKind::carve, {}), half = stroke(BrushKind::carve, all(127));
  CHECK(free.depth() > 0.5);
  CHECK(half.gone() == free.gone());
  CHECK(half.depth() == free.depth());
  const Stroke more = stroke(BrushKind::carve, all(128));
  CHECK(changedAmong(PointSet::range(0, cloud().size()), more.before, more.after) == 0);
}

TEST_CASE_FIXTURE(InPart, "paint colours less what is locked more") {
  const auto painted = [&](std::uint8_t weight) {
    const Stroke stroke = this->stroke(BrushKind::paint, all(weight));
    double sum = 0;
    for (std::size_t i = 0; i < cloud().size(); ++i)
      for (std::size_t k = 0; k < 3; ++k)
        sum += std::abs(unpackedColor(stroke.after[i].color)[k] - unpackedColor(stroke.before[i].color)[k]);
    return sum;
  };
  const double whole = painted(0), less = painted(200), hardly = painted(254);
  CHECK(whole > 1000);
  CHECK(less < 0.9 * whole);
  CHECK(less > 0.1 * whole);
  CHECK(hardly < 0.3 * whole);
}

TEST_CASE_FIXTURE(InPart, "along a soft rim a stroke becomes less, and none of what is wholly locked changes") {
  std::vector<std::uint8_t> weights(cloud().size());
  PointSet locked;
  for (std::size_t i = 0; i < cloud().size(); ++i) {
    const double share = std::clamp((cloud().positions[i].x + 5.0) / 10, 0.0, 1.0);
    weights[i] = static_cast<std::uint8_t>(std::lround(255 * share));
    if (weights[i] == PointLock::kWhole) locked.set(i);
  }
  for (const auto& [name, kind] : kBrushKinds) {
    CAPTURE(name);
    const Stroke stroke = this->stroke(kind, weights);
    CHECK(changedAmong(locked, stroke.before, stroke.after) == 0);
    CHECK(changedAmong(PointSet::range(0, cloud().size()), stroke.before, stroke.after) > 5);
  }
}

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
    touch->edits()->lock({.points = locked});
    sculptor.stroke();
    const PointStates after = sculptor.points();
    CHECK(changedAmong(locked, before, after) == 0);
    CHECK(changedAmong(free, before, after) > 5);
    touch->edits()->lock({});
    sculptor.stroke();
    CHECK(changedAmong(locked, after, sculptor.points()) > 5);
  }
}

TEST_CASE_FIXTURE(OnBackEndInCore, "a stroke beside a lock fills the cliff with points that are locked as its rim is") {
  const Scene scene = makeScene("sphere", 8'000);
  const double spacing = std::sqrt(4 * std::numbers::pi * 50 * 50 / 8'000);
  PointSet locked;
  for (std::uint64_t i = 0; i < scene.cloud.size(); ++i)
    if (scene.cloud.positions[i].y > 0) locked.set(i);
  for (const BrushKind kind : {BrushKind::push, BrushKind::carve}) {
    CAPTURE(traitsOf(kind).name);
    const auto touch = make(
        scene.cloud,
        {.radius = scene.radius, .brush = BrushOptions{.kind = kind, .yieldDepth = 0.3, .pushRate = 0.5, .radius = 8}});
    Sculptor sculptor(*touch, scene.cloud);
    const PointStates before = sculptor.points();
    touch->edits()->lock({.points = locked});
    sculptor.stroke();
    const PointStates after = sculptor.points();
    CHECK(changedAmong(locked, before, after) == 0);
    // Without them the floor would grow on under what is locked.
    std::size_t inCliff = 0, below = 0;
    for (const PointState& state : after) {
      if (state.gone || state.number < scene.cloud.size()) continue;
      inCliff += locked.test(state.parent);
      below += state.position.y > spacing && glm::length(state.position) < 49;
    }
    CHECK(inCliff > 3);
    CHECK(below == 0);
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
  touch->edits()->lock({.points = all});
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
  touch->edits()->lock({.points = PointSet::range(0, scene.cloud.size())});
  touch->edits()->lock({});
  const Contact contact = touch->query({.time_s = 0, .hip = {0, 0, 52}}, 0);
  CHECK(contact.valid);
}

}  // namespace palpate::locked_test
