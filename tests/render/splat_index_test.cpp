// What is drawn follows edits at the cost of the touched points: the index of the discs and the discs themselves are
// compared, after random edits, with those of a cloud that is measured as a whole, and the index with the host's truth.
#include "engine/render/splat_index.hpp"

#include <bit>
#include <random>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/thinning.hpp"
#include "engine/gpu/transfer.hpp"
#include "tests/labels.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::splat_index_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr double kSide = 100;

/// A cloud under edits on the host: all states, and where they were before.
class EditedCloud {
 public:
  EditedCloud(const PointCloud& cloud, std::uint32_t spare)
      : loaded_(static_cast<std::uint32_t>(cloud.size())), states_(cloud.size() + spare) {
    for (std::uint32_t id = 0; id < states_.size(); ++id)
      states_[id] = {.position = id < loaded_ ? cloud.positions[id] : Vec3(0),
                     .gone = id >= loaded_,
                     .number = id,
                     .normal = id < loaded_ ? cloud.normals[id] : Vec3(0, 0, 1),
                     .parent = id};
  }

  const std::vector<PointState>& states() const { return states_; }
  static bool isThere(const PointState& state) { return !state.gone; }
  std::uint32_t places() const { return static_cast<std::uint32_t>(states_.size()); }

  void set(std::uint32_t id, const Vec3& position, const Vec3& normal, bool there) {
    before_.push_back(states_[id]);
    states_[id].position = position;
    states_[id].normal = normal;
    states_[id].gone = !there;
    changes_.push_back(states_[id]);
  }
  /// A random stroke within `reach` of a random point: points there move, turn or vanish, and new ones appear.
  void stroke(std::mt19937& random, float reach) {
    std::uniform_real_distribution<float> share(-1, 1);
    const auto some = [&] {
      const float z = share(random), y = share(random);
      return Vec3(share(random), y, z);
    };
    const Vec3 center = states_[random() % loaded_].position;
    for (std::uint32_t id = 0; id < places(); ++id) {
      const PointState state = states_[id];
      if (!isThere(state)) {
        if (random() % 8 == 0) set(id, center + 0.7f * reach * some(), glm::normalize(some() + Vec3(0, 0, 2)), true);
      } else if (glm::distance(state.position, center) <= reach) {
        const std::uint32_t kind = random() % 12;
        const float far = kind == 1 ? 20.0f : 0.3f;
        set(id, kind == 2 ? state.position : state.position + far * some(),
            kind == 3 ? state.normal : glm::normalize(state.normal + 0.3f * some()), kind != 0);
      }
    }
  }
  /// Takes the last changes back, in reverse.
  void undo() {
    const std::vector<PointState> before = std::move(before_);
    before_.clear();
    for (auto state = before.rbegin(); state != before.rend(); ++state)
      set(state->number, state->position, state->normal, isThere(*state));
  }
  std::vector<PointState> takeChanges() { return std::exchange(changes_, {}); }
  void endStroke() { before_.clear(); }

 private:
  std::uint32_t loaded_;
  std::vector<PointState> states_, before_, changes_;
};

class SplatIndexFixture : public PictureFixture {
 protected:
  /// Number of buckets of the index whose points are not those of the truth, in the order of their ids.
  std::size_t wrongBuckets(const DrawnCloud& drawn, const EditedCloud& truth) {
    const SplatIndex& index = drawn.radii()->index();
    const HashGrid& grid = index.grid();
    std::vector<std::vector<std::uint32_t>> expected(grid.bucketMask + 1);
    for (std::uint32_t id = 0; id < truth.places(); ++id)
      if (EditedCloud::isThere(truth.states()[id]))
        expected[bucketOf(grid, cellOf(grid, truth.states()[id].position))].push_back(id);
    const std::size_t slots = index.view().slots;
    const auto positions = download<Vec4>(device, index.ordered().positions, slots);
    const auto normals = download<Vec4>(device, index.ordered().normals, slots);
    const auto ranges = download<UVec2>(device, index.ranges(), expected.size());
    std::size_t wrong = 0, found = 0;
    for (std::size_t bucket = 0; bucket < expected.size(); ++bucket) {
      std::vector<std::uint32_t> there;
      bool same = true;
      for (std::uint32_t slot = ranges[bucket].x; slot < ranges[bucket].y; ++slot) {
        const auto id = std::bit_cast<std::uint32_t>(positions[slot].w);
        there.push_back(id);
        same = same && id < truth.places() && Vec3(positions[slot]) == truth.states()[id].position &&
               Vec3(normals[slot]) == truth.states()[id].normal;
      }
      wrong += !same || there != expected[bucket];
    }
    for (const Vec4& position : positions) found += std::bit_cast<std::uint32_t>(position.w) != shared::kEmptySlot;
    std::size_t present = 0;
    for (const auto& ids : expected) present += ids.size();
    return wrong + (found != present ? 1 : 0);
  }

  /// Number of discs that differ from those of the same points measured as a whole.
  std::size_t wrongDiscs(const DrawnCloud& drawn, const EditedCloud& truth) {
    const std::uint32_t count = drawn.count();
    const auto normals = download<Vec4>(device, drawn.normals(), count);
    const auto clips = download<std::uint32_t>(device, drawn.shapes().clips, count);
    const auto widths = download<std::uint32_t>(device, drawn.shapes().widths, drawn.shapes().widths.bytes() / 4);
    std::vector<Vec4> points(count, Vec4(Vec3(0), std::bit_cast<float>(shared::kEmptySlot))),
        directions(count, Vec4(0));
    for (std::uint32_t id = 0; id < count; ++id) {
      if (!EditedCloud::isThere(truth.states()[id])) continue;
      points[id] = Vec4(truth.states()[id].position, std::bit_cast<float>(id));
      directions[id] = Vec4(truth.states()[id].normal, 0);
    }
    const LiveCloud::Half side{Buffer::of<Vec4>(device, count, Memory::device, "positions"),
                               Buffer::of<Vec4>(device, count, Memory::device, "normals"), 1};
    upload(device, side.positions, points);
    upload(device, side.normals, directions);
    const DiscShapes freshShapes(device, count);
    SplatRadii fresh(device, drawn.bounds(), count, drawn.spacing());
    fresh.measure(side, freshShapes);
    const auto freshNormals = download<Vec4>(device, side.normals, count);
    const auto expectedClips = download<std::uint32_t>(device, freshShapes.clips, count);
    std::size_t wrong = 0;
    for (std::uint32_t id = 0; id < count; ++id)
      if (EditedCloud::isThere(truth.states()[id]))
        wrong += std::bit_cast<std::uint32_t>(normals[id].w) != std::bit_cast<std::uint32_t>(freshNormals[id].w) ||
                 clips[id] != expectedClips[id] ||
                 std::bit_cast<float>(widths[id / shared::kDiscBlock]) < normals[id].w;
    return wrong;
  }

  /// The drawn cloud follows the changes, and everything is compared.
  void checkFollows(DrawnCloud& drawn, EditedCloud& truth) {
    drawn.catchUp(truth.takeChanges());
    drawn.closeSurface();
    CHECK(wrongBuckets(drawn, truth) == 0);
    CHECK(wrongDiscs(drawn, truth) == 0);
  }

  /// Whether the picture is that of a drawn cloud to which the present points are given as a whole.
  bool looksAsWhole(const DrawnCloud& drawn, const PointCloud& loaded, const EditedCloud& truth,
                    const DrawnOptions& options) {
    CloudFrame present;
    for (const PointState& state : truth.states()) {
      if (!EditedCloud::isThere(state)) continue;
      present.positions.push_back(state.position);
      present.normals.push_back(state.normal);
      present.ids.push_back(state.number);
    }
    DrawnCloud whole(device, loaded, options);
    whole.place(present);
    whole.closeSurface();
    Frame& frame = frameOf(96, 96, 1);
    const Camera camera = Camera::fitting(loaded, 1);
    draw(frame, whole, camera, {});
    const Image expected = frame.readColor();
    draw(frame, drawn, camera, {});
    const Image image = frame.readColor();
    std::size_t painted = 0;
    for (const auto& pixel : image.rgba) painted += pixel != image.rgba[0];
    CHECK(painted > 100);
    return image.rgba == expected.rgba;
  }
};

PointCloud shapeCloud(std::string_view name, std::size_t count, double noise = 0) {
  return sampleShape(*makeShape(name, kSide, DVec3(0)), {.count = count, .noise = noise});
}

}  // namespace

TEST_CASE_FIXTURE(SplatIndexFixture,
                  "after random strokes the discs and the picture are those of the whole cloud, bit by bit") {
  struct Example {
    std::string_view shape;
    std::size_t count;
    float reach;
  };
  for (const Example& example : {Example{"torus", 6'007, 9}, Example{"cube", 4'099, 12}, Example{"sphere", 257, 30}}) {
    CAPTURE(example.shape);
    const PointCloud cloud = thinnedAlong(shapeCloud(example.shape, example.count), 4);
    const DrawnOptions options{.spare = 131, .spacing = meanSpacing(cloud), .edited = true};
    DrawnCloud drawn(device, cloud, options);
    EditedCloud truth(cloud, options.spare);
    const DiscWork loaded = drawn.radii()->work();
    std::mt19937 random(7);
    for (int tick = 0; tick < 3; ++tick) {
      truth.endStroke();
      truth.stroke(random, example.reach);
      checkFollows(drawn, truth);
    }
    truth.undo();
    checkFollows(drawn, truth);
    CHECK(drawn.radii()->work().builds == loaded.builds);
    CHECK(drawn.radii()->work().searches == loaded.searches);
    CHECK(looksAsWhole(drawn, cloud, truth, options));
  }
}

TEST_CASE_FIXTURE(SplatIndexFixture, "a small edit measures few discs, and one without a change none") {
  const PointCloud cloud = shapeCloud("sphere", 20'000);
  DrawnCloud drawn(device, cloud, {.spacing = meanSpacing(cloud), .edited = true});
  EditedCloud truth(cloud, 0);
  const DiscWork loaded = drawn.radii()->work();
  for (const std::uint32_t id : {0u, 777u, 19'999u})
    truth.set(id, 1.002f * cloud.positions[id], cloud.normals[id], true);
  checkFollows(drawn, truth);
  const DiscWork small = drawn.radii()->work();
  CHECK(small.builds == loaded.builds);
  CHECK(small.searches == loaded.searches);
  CHECK(small.measured - loaded.measured >= 3);
  CHECK(small.measured - loaded.measured < 400);
  drawn.catchUp(std::vector{truth.states()[777]});
  drawn.closeSurface();
  CHECK(drawn.radii()->work().measured == small.measured);
}

TEST_CASE_FIXTURE(SplatIndexFixture, "marks of followed edits do not outlast their picture") {
  const PointCloud cloud = shapeCloud("sphere", 20'000);
  DrawnCloud drawn(device, cloud, {.spare = 100, .spacing = meanSpacing(cloud), .edited = true});
  EditedCloud truth(cloud, 100);
  std::mt19937 random(3);
  const auto marks = [&] {
    const SplatRadii& radii = *drawn.radii();
    const auto words = download<std::uint32_t>(device, radii.changed(), (radii.grid().bucketMask + 32) / 32);
    return std::ranges::count_if(words, [](std::uint32_t word) { return word != 0; });
  };
  for (int tick = 0; tick < 3; ++tick) {
    truth.stroke(random, 8);
    drawn.catchUp(truth.takeChanges());
    CHECK(marks() > 10);
    drawn.closeSurface();
    CHECK(marks() == 0);
    drawn.catchUp(std::vector{truth.states()[5]});  // as it is
    CHECK(marks() == 0);
  }
  CHECK(drawn.radii()->work().clears == 1);
}

TEST_CASE_FIXTURE(SplatIndexFixture, "several edits before one picture are followed, of the same points, too") {
  for (const std::size_t count : {1u, 31u, 32u, 33u, 1'025u}) {
    CAPTURE(count);
    PointCloud cloud = shapeCloud("cube", count);
    DrawnCloud drawn(device, cloud, {.spare = 40, .spacing = 5, .edited = true});
    EditedCloud truth(cloud, 40);
    const DiscWork loaded = drawn.radii()->work();
    std::mt19937 random(11);
    for (int tick = 0; tick < 5; ++tick) {
      truth.stroke(random, 25);
      if (tick % 2 == 1) truth.undo();
      drawn.catchUp(truth.takeChanges());
    }
    checkFollows(drawn, truth);
    CHECK(drawn.radii()->work().builds == loaded.builds);
  }
}

TEST_CASE_FIXTURE(SplatIndexFixture, "after a brush over everything, or with no slots left, the index is built again") {
  const PointCloud cloud = shapeCloud("sphere", 17'000);
  DrawnCloud drawn(device, cloud, {.spare = 300, .spacing = meanSpacing(cloud), .edited = true});
  EditedCloud truth(cloud, 300);
  std::mt19937 random(2);
  const auto builds = [&] { return drawn.radii()->work().builds; };
  const std::uint64_t loaded = builds();
  SUBCASE("more moves than an update holds") {
    for (std::uint32_t id = 0; id < cloud.size(); ++id)
      truth.set(id, 0.99f * cloud.positions[id], cloud.normals[id], true);
    checkFollows(drawn, truth);
    CHECK(builds() == loaded + 1);
  }
  SUBCASE("more arrivals in a bucket than an update orders") {
    for (std::uint32_t id = 100; id < 900; ++id) truth.set(id, Vec3(1, 2, 3), cloud.normals[id], true);
    checkFollows(drawn, truth);
    CHECK(builds() == loaded + 1);
  }
  SUBCASE("buckets outgrow all slots") {
    for (std::uint32_t id = 0; id < 16'000; ++id) truth.set(id, 1.06f * cloud.positions[id], cloud.normals[id], true);
    checkFollows(drawn, truth);
    CHECK(builds() == loaded + 1);
  }
  // Later edits are followed again.
  truth.stroke(random, 4);
  checkFollows(drawn, truth);
  CHECK(builds() == loaded + 1);
}

TEST_CASE_FIXTURE(SplatIndexFixture,
                  "crowds, also of equally near points, have the discs of the whole cloud after edits") {
  // A lattice has many equally near points, and around its middle there are more points than a search visits.
  PointCloud cloud;
  for (int x = -8; x <= 8; ++x)
    for (int y = -8; y <= 8; ++y)
      for (int z = 0; z < 3; ++z) cloud.positions.emplace_back(x, y, z);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> share(-1, 1);
  for (std::uint32_t i = 0; i < shared::splatMostVisits(device.subgroupSize()) + 50; ++i)
    cloud.positions.emplace_back(0.4f * share(random), 5 + 0.4f * share(random), 1.5f);
  for (std::size_t i = 0; i < cloud.size(); ++i)
    cloud.normals.push_back(i % 3 == 0 ? Vec3(0, 0, 1) : glm::normalize(Vec3(0, 1, i % 2 == 0 ? 1 : -1)));
  DrawnCloud drawn(device, cloud, {.spare = 60, .spacing = 1, .edited = true});
  EditedCloud truth(cloud, 60);
  for (int tick = 0; tick < 2; ++tick) {
    truth.stroke(random, tick == 0 ? 0.1f : 2);
    checkFollows(drawn, truth);
  }
}

TEST_CASE_FIXTURE(SplatIndexFixture, "discs follow a far crowd that shares their bucket") {
  const PointCloud sphere = shapeCloud("sphere", 1'200);
  const double spacing = meanSpacing(sphere);
  // The crowd is first in the file: of a bucket with too many points, those behind it are not visited.
  std::uint32_t crowd = 0, spare = 0;
  SUBCASE("points without normals, and a crowd that comes") { spare = 60; }
  SUBCASE("a crowd that leaves room for others in its bucket") {
    crowd = shared::splatMostInBucket(device.subgroupSize()) + 5;
  }
  const std::uint32_t places = crowd + static_cast<std::uint32_t>(sphere.size()) + spare;
  const HashGrid grid =
      makeHashGrid(Vec3(boundsOf(sphere).min), static_cast<double>(shared::kSplatFirstSearch) * spacing, places);
  const IVec3 shares = cellOf(grid, sphere.positions[600]);
  IVec3 far = shares + IVec3(500, 0, 0);
  while (bucketOf(grid, far) != bucketOf(grid, shares)) ++far.x;
  REQUIRE(far.x < shared::kSplatFarCell);
  const Vec3 place = grid.origin + (Vec3(far) + 0.5f) / grid.inverseCell;
  REQUIRE(cellOf(grid, place) == far);
  PointCloud cloud;
  cloud.positions.assign(crowd, place);
  cloud.normals.assign(crowd, Vec3(0, 0, 1));
  cloud.positions.insert(cloud.positions.end(), sphere.positions.begin(), sphere.positions.end());
  for (const Vec3& normal : sphere.normals) cloud.normals.push_back(crowd > 0 ? normal : Vec3(0));
  DrawnCloud drawn(device, cloud, {.spare = spare, .spacing = spacing, .edited = true});
  REQUIRE(drawn.radii()->index().grid().bucketMask == grid.bucketMask);
  EditedCloud truth(cloud, spare);
  for (std::uint32_t id = 0; id < crowd / 20; ++id) truth.set(id, place, Vec3(0, 0, 1), false);
  for (std::uint32_t k = 0; k < spare; ++k) truth.set(places - spare + k, place, Vec3(0), true);
  checkFollows(drawn, truth);
}

TEST_SUITE_END();

TEST_CASE_FIXTURE(SplatIndexFixture, "an edit costs what is drawn its own points, whatever the size of the cloud") {
  constexpr std::uint32_t kEdited = 100;
  std::vector<std::uint64_t> measured;
  for (const std::size_t count : {10'000u, 100'000u, 1'000'000u}) {
    CAPTURE(count);
    const PointCloud cloud = shapeCloud("sphere", count);
    DrawnCloud drawn(device, cloud, {.spacing = meanSpacing(cloud), .edited = true});
    const DiscWork& work = drawn.radii()->work();
    const DiscWork loaded = work;
    // The points around one, in three edits: they are moved, turned and painted.
    std::vector<std::pair<float, std::uint32_t>> around;
    for (std::uint32_t id = 0; id < count; ++id)
      around.emplace_back(glm::distance(cloud.positions[id], cloud.positions[count / 2]), id);
    std::ranges::nth_element(around, around.begin() + kEdited);
    std::vector<PointState> states;
    for (const auto& [distance, id] : std::span(around).first(kEdited))
      states.push_back(
          {.position = 0.9999f * cloud.positions[id], .number = id, .normal = cloud.normals[id], .parent = id});
    const auto edit = [&] {
      drawn.catchUp(states);
      drawn.closeSurface();
    };
    edit();
    for (PointState& state : states) state.normal = glm::normalize(state.normal + Vec3(0.1f, 0, 0));
    edit();
    const DiscWork edited = work;
    for (PointState& state : states) state.color = 0xff0000ff;
    edit();
    CHECK(edited.measured == work.measured);
    CHECK(edited.cells == work.cells);
    CHECK(work.builds == loaded.builds);
    CHECK(work.searches == loaded.searches);
    CHECK(work.clears == loaded.clears);
    CHECK(work.cells >= 2 * kEdited);
    CHECK(work.cells <= 3 * kEdited);
    CHECK(work.measured - loaded.measured >= 2 * kEdited);
    measured.push_back(work.measured - loaded.measured);
  }
  MESSAGE("discs measured for two edits of ", kEdited, " points: ", measured[0], ", ", measured[1], ", ", measured[2]);
  CHECK(*std::ranges::max_element(measured) < 1.5 * static_cast<double>(*std::ranges::min_element(measured)));
}

}  // namespace palpate::splat_index_test
