// The incrementally updated index always equals a full build of the same points.
#include "tests/edit/random_edits.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/scenes.hpp"

namespace palpate::index_update_test {

TEST_CASE_FIXTURE(CoreGpuFixture, "an edit that removes points empties their slots and logs them") {
  const Scene scene = makeScene("sphere", 500);
  EditedScene edited(device, scene.cloud, makeHashGrid(Vec3(-50), scene.radius, scene.cloud.size()), scene.radius,
                     brushOf(BrushKind::push));
  std::size_t left = scene.cloud.size();
  for (const std::uint32_t first : {0u, 7u}) {
    std::vector<PointChange> changes;
    for (const auto& [id, point] : edited.points()) {
      if (id % 20 != first) continue;
      PointState to = point;
      if (id % 40 == first)
        to.gone = true;
      else
        to.position = -to.position;
      left -= to.gone;
      changes.push_back({.from = point, .to = to});
    }
    CHECK(edited.change(changes, EditedScene::How::incremental));
    CHECK(edited.faults() == 0);
    CHECK(edited.points().size() == left);
    const std::vector<PointState> log = edited.takeLog();
    CHECK(log.size() == changes.size());
    CHECK(std::ranges::count_if(log, &PointState::gone) == 13);
  }
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "after any edit the index contains every point in its bucket and nothing else" * kMoreInFull) {
  const Scene scene = makeScene("sphere", 2'500);
  const int count = byTier(15, 120);
  for (const BrushKind kind :
       {BrushKind::push, BrushKind::carve, BrushKind::inflate, BrushKind::smooth, BrushKind::flatten}) {
    CAPTURE(static_cast<int>(kind));
    EditedScene edited(device, scene.cloud, makeHashGrid(Vec3(-50), scene.radius, scene.cloud.size()), scene.radius,
                       brushOf(kind));
    RandomEdits edits(edited, 7 + static_cast<std::uint32_t>(kind), kManyAtOnce);
    for (int i = 0; i < count; ++i) {
      edits.one();
      if (i % 10 != 0) continue;
      CHECK(edited.faults() == 0);
      CHECK(edits.agrees());
    }
    CHECK(edited.faults() == 0);
    CHECK(edits.agrees());
    MESSAGE(edits.size() << " points, " << edits.refused() << " refused");
  }
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "the same edits give the same order in every bucket, whatever the GPU's timing" * kMoreInFull) {
  const Scene scene = makeScene("torus", 3'000);
  std::map<std::uint32_t, std::vector<std::uint32_t>> first;
  for (int run = 0; run < 2; ++run) {
    EditedScene edited(device, scene.cloud, makeHashGrid(Vec3(-50), scene.radius, scene.cloud.size()), scene.radius,
                       brushOf(BrushKind::push));
    RandomEdits edits(edited, 99, kFewAtOnce);
    for (int i = 0; i < byTier(30, 100); ++i) edits.one();
    if (run == 0)
      first = edited.buckets();
    else
      CHECK(edited.buckets() == first);
  }
}

}  // namespace palpate::index_update_test
