// Whether a stroke goes on from where it has brought a point, on each back end.
#include "engine/core/named_values.hpp"
#include "engine/edit/history.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"
#include "tests/touch/back_end.hpp"

namespace palpate::accumulate_test {

namespace {

class Resting : public OnBackEndInCore {
 public:
  // How far the point on the top of a sphere was moved by a brush that presses 2 mm deep there for so many ticks, mm;
  // and the points as they are then.
  std::pair<double, std::vector<PointState>> rest(const BrushOptions& brush, int ticks) const {
    const auto touch = make(scene_.cloud, {.radius = scene_.radius, .brush = brush});
    History history(scene_.cloud, {1 << 26});
    touch->edits()->keep();
    double time_s = 0;
    for (int i = 0; i < ticks; ++i)
      touch->query({.time_s = time_s += 1e-3, .hip = {0, 0, std::max(48.0, 51 - 0.2 * i)}}, 0);
    touch->finish();
    EditBatch batch;
    touch->edits()->take(batch);
    history.follow(batch);
    double most = 0;
    for (std::size_t i = 0; i < scene_.cloud.size(); ++i) {
      const PointState& now = history.points()[i];
      if (!now.gone) most = std::max<double>(most, glm::distance(now.position, scene_.cloud.positions[i]));
    }
    const PointStates& points = history.points();
    return {most, {points.begin(), points.end()}};
  }

 private:
  const Scene scene_ = makeScene("sphere", 4'000);
};

BrushOptions brush(BrushKind kind, bool accumulates) {
  return {.kind = kind, .yieldDepth = 0.3, .pushRate = 0.5, .radius = 8, .strength = 1, .accumulate = accumulates};
}

}  // namespace

TEST_CASE_FIXTURE(Resting, "inflate raises points once, by as much as the hand presses, or on and on") {
  const int once = onCpuOrGpu(600, 400);
  const double raised = rest(brush(BrushKind::inflate, false), once).first;
  CHECK(raised > 0.5);
  CHECK(raised < 2.1);
  const double more = rest(brush(BrushKind::inflate, true), once).first;
  CHECK(more > 1.3 * raised);
  // It goes on with the time.
  CHECK(rest(brush(BrushKind::inflate, true), 2 * once).first > 1.4 * more);
  CHECK(rest(brush(BrushKind::inflate, false), 2 * once).first == within(raised, 0.2));
}

TEST_CASE_FIXTURE(Resting, "brushes that follow the hand do the same with it, bit by bit") {
  for (const auto& [name, kind] : kBrushKinds) {
    if (kind == BrushKind::inflate || kind == BrushKind::paint) continue;
    CAPTURE(name);
    const auto once = rest(brush(kind, false), 60).second, again = rest(brush(kind, true), 60).second;
    REQUIRE(once.size() == again.size());
    for (std::size_t i = 0; i < once.size(); ++i) CHECK(isSameToTheBit(once[i], again[i]));
  }
}

}  // namespace palpate::accumulate_test
