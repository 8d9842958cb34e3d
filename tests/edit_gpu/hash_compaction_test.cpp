// Background compaction has the result of a full build, whatever is edited meanwhile.
#include <cmath>

#include "engine/core/clock.hpp"
#include "tests/edit/random_edits.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/scenes.hpp"

namespace palpate::hash_compaction_test {

namespace {

using How = EditedScene::How;

constexpr CompactionOptions kShortSlices{.bucketsPerSlice = 256};
constexpr std::uint32_t kMany = 1000;  // more steps than a compaction of these clouds takes
// At one position, thus in one bucket, which one subgroup updates: GPU-assisted validation searches all buffers at each
// access, and lavapipe ends those loops after 65,535 iterations, so that valid addresses are reported from some 4,000
// points on.
constexpr std::size_t kCrowd = 700;

PointCloud cloudOf(std::vector<Vec3> positions) {
  PointCloud cloud;
  cloud.positions = std::move(positions);
  cloud.normals.assign(cloud.positions.size(), Vec3(0, 0, 1));
  return cloud;
}

struct Compacted {
  Compacted(Device& device, const PointCloud& cloud, const CompactionOptions& options = kShortSlices,
            std::optional<std::uint32_t> spare = std::nullopt)
      : scene(device, cloud, makeHashGrid(Vec3(-50), 2.0, cloud.size()), 2.0, brushOf(BrushKind::push), {},
              kDefaultSort, spare, options) {}

  // Moves these points to positions in other buckets and returns the changes.
  std::vector<PointChange> scatter(std::uint32_t first, std::uint32_t count, float shift) {
    const auto points = scene.points();
    std::vector<PointChange> changes;
    for (std::uint32_t id = first; id < first + count; ++id) {
      PointState to = points.at(id);
      to.position += Vec3(shift, 0, 0);
      changes.push_back({points.at(id), to});
    }
    CHECK(scene.change(changes, How::incremental));
    return changes;
  }

  EditedScene scene;
};

void checkHolds(const EditedScene& scene, const std::map<std::uint32_t, PointState>& points) {
  CHECK(scene.faults() == 0);
  CHECK(scene.points() == points);
}

// More buckets than a GPU with a shared queue copies in one slice.
std::size_t manyPoints() { return byTier<std::size_t>(40'000, 200'000); }

// Keeps the background queue busy for a while.
struct LongWork {
  explicit LongWork(Device& device)
      : large(device, 64 << 20, Memory::device, "large"), list(device, device.backgroundQueue(), "long work") {
    list.begin();
    for (int i = 0; i < 20; ++i) list.fill(large, 1, large.bytes());
    list.end();
    ticket = device.backgroundQueue().submit(list);
  }

  Buffer large;
  CommandList list;
  Queue::Ticket ticket;
};

void checkEditsBetweenSlices(Device& device, std::uint32_t mostAtOnce, int edits) {
  const Scene scene = makeScene("sphere", 5'000);
  for (const BrushKind kind : {BrushKind::push, BrushKind::carve}) {
    CAPTURE(static_cast<int>(kind));
    EditedScene edited(device, scene.cloud, makeHashGrid(Vec3(-50), scene.radius, scene.cloud.size()), scene.radius,
                       brushOf(kind), {}, kDefaultSort, std::nullopt, kShortSlices);
    RandomEdits made(edited, 31 + static_cast<std::uint32_t>(kind), mostAtOnce);
    std::mt19937 random(3);
    int compactions = 0;
    for (int i = 0; i < edits; ++i) {
      made.one();
      const bool completed = edited.compactFurther(random() % 16);
      compactions += completed;
      if (!completed && i % 10 != 0) continue;
      CHECK(edited.faults() == 0);
      CHECK(made.agrees());
    }
    CHECK(compactions >= edits / 15);
    CHECK(edited.faults() == 0);
    CHECK(made.agrees());
    MESSAGE(compactions << " compactions of " << edited.compaction().slices() << " slices, " << made.refused()
                        << " edits refused");
  }
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "edits of every kind between the slices of a compaction leave every point in its bucket" *
                                  kMoreInFull) {
  checkEditsBetweenSlices(device, kFewAtOnce, byTier(20, 45));
}

TEST_CASE_FIXTURE(CoreGpuFixture,
                  "large edits between the slices of a compaction leave every point in its bucket" * kMoreInFull) {
  checkEditsBetweenSlices(device, kManyAtOnce, byTier(30, 150));
}

TEST_CASE_FIXTURE(GpuFixture, "compaction does not change the order of points in a bucket" * kMoreInFull) {
  const int count = byTier(24, 60);
  const Scene scene = makeScene("torus", 3'000);
  std::map<std::uint32_t, std::vector<std::uint32_t>> without;
  for (const bool compacts : {false, true}) {
    EditedScene edited(device, scene.cloud, makeHashGrid(Vec3(-50), scene.radius, scene.cloud.size()), scene.radius,
                       brushOf(BrushKind::push), {}, kDefaultSort, 1u << 16, kShortSlices);
    RandomEdits edits(edited, 99, kFewAtOnce);
    std::mt19937 random(5);
    int compactions = 0;
    for (int i = 0; i < count; ++i) {
      edits.one();
      if (compacts) compactions += edited.compactFurther(random() % 40);
    }
    REQUIRE(edits.refused() == 0);  // a build instead of an update changes the order
    if (!compacts) {
      without = edited.buckets();
      continue;
    }
    CHECK(compactions >= count / 6);
    CHECK(edited.buckets() == without);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "clouds of any size and shape are compacted without gaps") {
  std::vector<PointCloud> clouds{cloudOf({}), cloudOf({Vec3(1)}), cloudOf(std::vector<Vec3>(kCrowd, Vec3(2, 3, 4)))};
  for (const std::size_t count : {255u, 256u, 257u, 5'000u}) clouds.push_back(makeScene("cube", count).cloud);
  for (const PointCloud& cloud : clouds) {
    CAPTURE(cloud.size());
    Compacted compacted(device, cloud);
    EditedScene& scene = compacted.scene;
    for (int turn = 0; turn < 2; ++turn) {
      const auto before = scene.points();
      const std::uint32_t parity = scene.live().parity();
      CHECK(scene.compactFurther(kMany));
      CHECK(scene.live().parity() != parity);
      checkHolds(scene, before);
      CHECK(scene.report().head == before.size());
      CHECK(scene.report().points == before.size());
      CHECK(scene.report().compacting == 0);
      // Points at one position are moved to one bucket one after the other: a tick accepts a limited number of arrivals
      // there.
      if (!cloud.empty()) compacted.scatter(0, std::min<std::uint32_t>(200, cloud.size()), 30);
    }
  }
}

TEST_CASE_FIXTURE(GpuFixture, "compaction recovers abandoned slots, and is due when they run out") {
  Compacted compacted(device, makeScene("sphere", 5'000).cloud, kShortSlices, 4'000);
  EditedScene& scene = compacted.scene;
  CHECK_FALSE(scene.compaction().isDue(scene.report()));
  for (int i = 0; i < 100 && !scene.compaction().isDue(scene.report()); ++i)
    compacted.scatter(static_cast<std::uint32_t>(40 * i) % 4'900, 40, 7);
  const std::uint32_t before = scene.report().head;
  CHECK(before > 7'000);
  CHECK(before <= 9'000);
  CHECK(scene.report().points == 5'000);
  REQUIRE(scene.compactFurther(kMany));
  CHECK(scene.report().head == 5'000);
  CHECK(scene.faults() == 0);
  CHECK_FALSE(scene.compaction().isDue(scene.report()));
}

TEST_CASE_FIXTURE(GpuFixture, "a bucket changed repeatedly during compaction is recorded once and copied again") {
  Compacted compacted(device, makeScene("sphere", 5'000).cloud);
  EditedScene& scene = compacted.scene;
  scene.compactFurther(1);
  compacted.scatter(10, 1, 0.0f);
  const std::uint32_t once = scene.report().dirty;
  CHECK(once == 1);
  for (int i = 0; i < 5; ++i) compacted.scatter(10, 1, 0.0f);
  CHECK(scene.report().dirty == once);
  // After the last slice: points that moved within their bucket leave no second copy behind.
  scene.compactFurther(scene.compaction().slices());
  compacted.scatter(100, 50, 0.0f);
  CHECK(scene.report().dirty > once);
  REQUIRE(scene.compactFurther(kMany));
  CHECK(scene.report().head == 5'000);
  CHECK(scene.faults() == 0);
}

TEST_CASE_FIXTURE(GpuFixture, "a compaction with too many changed buckets restarts and loses no point") {
  Compacted compacted(device, makeScene("sphere", 5'000).cloud, {.bucketsPerSlice = 256, .mostDirty = 8});
  EditedScene& scene = compacted.scene;
  scene.compactFurther(5);
  compacted.scatter(0, 100, 20);
  const auto before = scene.points();
  const std::uint32_t parity = scene.live().parity();
  CHECK_FALSE(scene.compactFurther(kMany));
  CHECK(scene.compaction().report().failed == shared::kCompactionTooDirty);
  CHECK(scene.live().parity() == parity);
  checkHolds(scene, before);
  CHECK(scene.report().compacting == 0);
  CHECK(scene.compactFurther(kMany));
  checkHolds(scene, before);
}

TEST_CASE_FIXTURE(GpuFixture, "points without room in the back half stay unchanged, and the next compaction succeeds") {
  // At each of eight positions 999 points are copied and then one more is restored: no copy is large enough, and there
  // is no room for eight more.
  std::vector<Vec3> positions;
  for (int i = 0; i < 8'000; ++i) positions.push_back(Vec3(5.0f * static_cast<float>(i / 1'000), 0, 0));
  Compacted compacted(device, cloudOf(positions), kShortSlices, 3'000);
  EditedScene& scene = compacted.scene;
  const auto full = scene.points();
  std::vector<PointChange> goes, comes;
  for (std::uint32_t id = 0; id < 8'000; id += 1'000) {
    PointState gone = full.at(id);
    gone.gone = true;
    goes.push_back({full.at(id), gone});
    comes.push_back({gone, full.at(id)});
  }
  REQUIRE(scene.change(goes, How::incremental));
  CHECK(scene.report().points == 7'992);
  scene.compactFurther(1 + scene.compaction().slices());
  REQUIRE(scene.change(comes, How::incremental));
  CHECK_FALSE(scene.compactFurther(kMany));
  CHECK(scene.compaction().report().failed == shared::kCompactionNoSlots);
  checkHolds(scene, full);
  CHECK(scene.compactFurther(kMany));
  CHECK(scene.report().head == 8'000);
  checkHolds(scene, full);
}

TEST_CASE_FIXTURE(GpuFixture, "a full build aborts a compaction, and the next compaction is complete") {
  Compacted compacted(device, makeScene("sphere", 5'000).cloud);
  EditedScene& scene = compacted.scene;
  for (const std::uint32_t steps : {1u, 2u, 12u, 1 + scene.compaction().slices()}) {
    CAPTURE(steps);
    CHECK_FALSE(scene.compactFurther(steps));
    compacted.scatter(100 * steps % 4'000, 100, -8);
    const auto before = scene.points();
    scene.compact();
    CHECK(scene.compaction().isIdle());
    CHECK(scene.report().compacting == 0);
    checkHolds(scene, before);
    CHECK(scene.compactFurther(kMany));
    checkHolds(scene, before);
  }
}

TEST_CASE("an aborted compaction does not affect edits or the next compaction") {
  Device device({.gpu = "", .validation = Validation::off});  // validation on the GPU waits for every submission
  Compacted compacted(device, makeScene("sphere", 5'000).cloud);
  EditedScene& scene = compacted.scene;
  scene.compactFurther(7);
  device.waitIdle();
  // The next slice is queued behind other work, so that it is in flight when the compaction is aborted.
  const LongWork work(device);
  scene.compaction().advance();
  scene.compaction().abandon();
  CHECK_FALSE(scene.compaction().isIdle());
  scene.compaction().settle();
  CHECK(scene.compaction().isIdle());
  compacted.scatter(0, 200, 9);
  CHECK(scene.faults() == 0);
  const auto before = scene.points();
  CHECK(scene.compactFurther(kMany));
  checkHolds(scene, before);
}

TEST_CASE("destroying a compaction in the middle of a slice waits for the slice") {
  Device device({.gpu = "", .validation = Validation::off});  // validation on the GPU waits for every submission
  std::optional<Compacted> compacted(std::in_place, device, makeScene("sphere", 5'000).cloud);
  compacted->scene.compactFurther(7);
  device.waitIdle();
  const LongWork work(device);
  compacted->scene.compaction().advance();
  compacted.reset();
  CHECK(device.backgroundQueue().isDone(work.ticket + 1));
}

TEST_CASE("a live cloud with an editable index takes little more than twice the memory of one without" * kFull) {
  Device device({.gpu = "", .validation = Validation::off});  // only memory sizes are tested
  const Scene scene = makeScene("sphere", 400'000);
  const HashGrid grid = makeHashGrid(Vec3(-50), scene.radius, scene.cloud.size());
  constexpr std::uint64_t kBytesPerSlot = 2 * 2 * sizeof(Vec4);
  const SpatialHash plain(device, grid, static_cast<std::uint32_t>(scene.cloud.size()));
  const std::uint64_t without = kBytesPerSlot * scene.cloud.size() + plain.bytes();
  const EditedScene edited(device, scene.cloud, grid, scene.radius, brushOf(BrushKind::push));
  const std::uint64_t with = kBytesPerSlot * edited.live().slots() + edited.hash().bytes() + edited.edit().bytes() +
                             edited.compaction().bytes();
  const double ratio = static_cast<double>(with) / static_cast<double>(without);
  MESSAGE(with << " bytes against " << without << ": " << ratio << " times");
  CHECK(ratio < 2.1);
}

TEST_CASE("a large cloud is compacted in many short or few long slices, and edits run between them" * kMoreInFull) {
  Device device({.gpu = "", .validation = Validation::off});  // times are reported
  const Scene scene = makeScene("sphere", manyPoints());
  const HashGrid grid = makeHashGrid(Vec3(-50), scene.radius, scene.cloud.size());
  const std::uint32_t buckets = grid.bucketMask + 1;
  constexpr std::uint32_t kDefault = 0;
  for (const std::uint32_t bucketsPerSlice : {kDefault, buckets / 2}) {
    EditedScene edited(device, scene.cloud, grid, scene.radius, brushOf(BrushKind::push), {}, kDefaultSort,
                       std::nullopt, {.bucketsPerSlice = bucketsPerSlice});
    HashCompaction& compaction = edited.compaction();
    constexpr std::uint32_t kEdits = 10;  // or one per slice, if there are fewer slices
    const std::uint32_t apart = std::max(1u, compaction.slices() / kEdits);
    const Stopwatch watch;
    double longest_us = 0, all_us = 0, edits_us = 0;
    std::uint32_t slices = 0, edits = 0;
    compaction.begin();
    while (compaction.stage() != HashCompaction::Stage::copied) {
      device.waitIdle();
      if (compaction.stage() == HashCompaction::Stage::copying) {
        longest_us = std::max(longest_us, compaction.sliceTime_us());
        all_us += compaction.sliceTime_us();
        ++slices;
      }
      compaction.advance();
      if (slices % apart != apart / 2) continue;
      const Stopwatch editing;
      const double angle = 0.5 * ++edits;
      const DVec3 outward(std::sin(angle), 0, std::cos(angle));
      CHECK(edited.brush(49.0 * outward, outward, How::incremental));
      edits_us += editing.elapsed_us();
    }
    CHECK(slices == compaction.slices());
    // One edit per slice, if a fast GPU has few of them; and one before the end of the first slice.
    CHECK(edits >= std::min(4u, slices + 1));
    const double copied_us = watch.elapsed_us() - edits_us;
    CHECK(edited.compactFurther(1));
    CHECK(edited.report().dirty > byTier(3, 15) * edits);  // the buckets of each edit
    CHECK(edited.report().points == edited.points().size());
    CHECK(edited.faults() == 0);
    MESSAGE(slices << " slices, " << all_us << " us in all, the longest " << longest_us << " us; the end, with "
                   << edited.report().dirty << " buckets changed by " << edits << " edits, " << compaction.endTime_us()
                   << " us; " << copied_us << " us from begin to the last slice");
    constexpr std::uint32_t kShared = 1 << 11;  // buckets of a slice on a queue that touch shares
    if (bucketsPerSlice != kDefault)
      CHECK(slices == 2 + 1);  // the first slice empties slots
    else if (device.roles().backgroundShares())
      CHECK(slices >= buckets / kShared);
  }
}

}  // namespace palpate::hash_compaction_test
