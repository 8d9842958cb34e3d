// Discs wide enough to close the surface around each point: compared with the reference, with the surface, and under
// edits.
#include "engine/render/splat_radii.hpp"

#include <algorithm>
#include <bit>
#include <glm/packing.hpp>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/counter_random.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/cloud/thinning.hpp"
#include "engine/gpu/transfer.hpp"
#include "tests/near.hpp"
#include "tests/render/picture_fixture.hpp"
#include "tests/render/splat_radius_reference.hpp"

namespace palpate::splat_radii_test {

namespace {

constexpr double kWidestShare = 0.1;  // of the bounding box (SplatRadii)

class SplatRadiiFixture : public GpuFixture {
 protected:
  std::vector<float> radiiOf(const DrawnCloud& drawn) {
    std::vector<float> radii;
    for (const Vec4& normal : download<Vec4>(device, drawn.normals(), drawn.count())) radii.push_back(normal.w);
    return radii;
  }
  std::vector<float> radiiOf(const PointCloud& cloud, double spacing) {
    return radiiOf(DrawnCloud(device, cloud, {.spacing = spacing}));
  }
  /// Number of radii that differ from double precision.
  std::size_t wrong(const PointCloud& cloud, double spacing) {
    const double widest =
        std::min(static_cast<double>(shared::kSplatWidest) * spacing, kWidestShare * boundsOf(cloud).longestSide());
    const auto reference = referenceSplatRadii(cloud, spacing, widest);
    const auto radii = radiiOf(cloud, spacing);
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const double radius = static_cast<double>(radii[i]);
      wrong += !(radius >= reference[i].least && radius <= reference[i].most);
    }
    return wrong;
  }
};

PointCloud shapeCloud(std::string_view name, std::size_t count, const DVec3& center = DVec3(0), double noise = 0) {
  return sampleShape(*makeShape(name, 100.0, center), {.count = count, .noise = noise});
}

/// Random positions on the surface that no disc of their sheet covers.
std::size_t bare(std::string_view shape, const PointCloud& cloud, const std::vector<float>& radii, double within) {
  constexpr std::size_t kPlaces = 20'000;
  const auto surface = makeShape(shape, 100.0);
  const AreaMap place = surface->areaMap(1);
  const PointTree tree(cloud.positions);
  std::vector<std::uint32_t> found;
  std::size_t bare = 0;
  for (std::size_t k = 0; k < kPlaces; ++k) {
    const SurfacePoint at = place({randomUnit(5, 2 * k), randomUnit(5, 2 * k + 1)});
    found.clear();
    tree.near(at.position, within, found);
    bare += std::ranges::none_of(found, [&](std::uint32_t i) {
      return glm::distance(DVec3(cloud.positions[i]), at.position) <= static_cast<double>(radii[i]) &&
             glm::dot(DVec3(cloud.normals[i]), at.normal) > 0.5;
    });
  }
  return bare;
}

double meanOf(const std::vector<float>& values) {
  double sum = 0;
  for (const float value : values) sum += static_cast<double>(value);
  return sum / static_cast<double>(values.size());
}

}  // namespace

TEST_CASE_FIXTURE(SplatRadiiFixture,
                  "radii equal those of double precision, at any size and density, also far from zero") {
  for (const std::size_t count : {2u, 3u, 31u, 255u, 257u, 4099u}) {
    CAPTURE(count);
    const PointCloud sphere = shapeCloud("sphere", count);
    CHECK(wrong(sphere, std::max(meanSpacing(sphere), 1.0)) == 0);
  }
  const PointCloud uneven = thinnedAlong(shapeCloud("torus", 8'000), 10);
  CHECK(wrong(uneven, meanSpacing(uneven)) == 0);
  const PointCloud noisy = shapeCloud("cube", 3000, DVec3(0), 0.3);
  CHECK(wrong(noisy, meanSpacing(noisy)) == 0);
  const PointCloud away = shapeCloud("bumpy-sphere", 3000, DVec3(1000, -2000, 512));
  CHECK(wrong(away, meanSpacing(away)) == 0);
}

TEST_CASE_FIXTURE(SplatRadiiFixture, "discs close even and uneven surfaces without swelling") {
  for (const char* shape : {"sphere", "torus", "cube", "bumpy-sphere"}) {
    CAPTURE(shape);
    const PointCloud even = shapeCloud(shape, 10'000);
    const double spacing = meanSpacing(even);
    const auto radii = radiiOf(even, spacing);
    CHECK(bare(shape, even, radii, 10 * spacing) == 0);
    CHECK(meanOf(radii) < 1.1 * spacing);
    const PointCloud uneven = thinnedAlong(shapeCloud(shape, 40'000), 10);
    const double wide = meanSpacing(uneven);
    const auto unevenRadii = radiiOf(uneven, wide);
    // Random thinning leaves a few positions as empty as a hole, mostly near an edge.
    CHECK(bare(shape, uneven, unevenRadii, 10 * wide) <= 8);
    CHECK(meanOf(unevenRadii) < 1.6 * wide);
  }
}

TEST_CASE_FIXTURE(SplatRadiiFixture, "a disc beside an edge ends at the edge, others are complete") {
  const PointCloud cube = shapeCloud("cube", 6000);
  const DrawnCloud drawn(device, cube, {.spacing = meanSpacing(cube)});
  const auto radii = radiiOf(drawn);
  const auto clips = download<std::uint32_t>(device, drawn.shapes().clips, drawn.count());
  std::size_t clipped = 0, wrong = 0;
  for (std::size_t i = 0; i < cube.size(); ++i) {
    // Distance of the nearest edge.
    Vec3 away = 50.0f - glm::abs(cube.positions[i]);
    std::sort(&away[0], &away[0] + 3);
    const Vec2 clip = glm::unpackHalf2x16(clips[i]);
    const float line = clips[i] == 0 ? radii[i] : radii[i] / glm::length(clip);
    clipped += clips[i] != 0;
    wrong += std::abs(line - std::min(away.y, radii[i])) > 0.01f * radii[i];
  }
  CHECK(clipped > 200);
  CHECK(wrong <= clipped / 50);  // for a few points the other side is farther than it appears
  const PointCloud sphere = shapeCloud("sphere", 6000);
  const DrawnCloud round(device, sphere, {.spacing = meanSpacing(sphere)});
  CHECK(std::ranges::count(download<std::uint32_t>(device, round.shapes().clips, round.count()), 0u) == 6000);
}

TEST_CASE_FIXTURE(SplatRadiiFixture, "a disc on a rim over an undercut side does not stand out over that side") {
  // A ledge whose last row of points is in front of the wall under it.
  PointCloud ledge;
  for (int y = 0; y < 40; ++y)
    for (int k = 0; k < 20; ++k) {
      ledge.positions.emplace_back(0.2f - static_cast<float>(k), y, 0);
      ledge.normals.emplace_back(0, 0, 1);
      ledge.positions.emplace_back(0, y, -0.8f - static_cast<float>(k));
      ledge.normals.emplace_back(1, 0, 0);
    }
  const DrawnCloud drawn(device, ledge, {.spacing = 1});
  const auto radii = radiiOf(drawn);
  const auto clips = download<std::uint32_t>(device, drawn.shapes().clips, drawn.count());
  std::size_t rim = 0;
  for (std::size_t i = 0; i < ledge.size(); ++i) {
    if (ledge.positions[i].x < 0.1f) continue;
    ++rim;
    // In its plane, the half of its way to the wall; without this it would stand out by its radius.
    CHECK(radii[i] > 0.7f);
    const double line = static_cast<double>(radii[i] / glm::length(glm::unpackHalf2x16(clips[i])));
    CHECK(line == palpate::within(0.5 * std::hypot(0.2, 0.8), 0.01));
  }
  CHECK(rim == 40);
}

TEST_CASE_FIXTURE(SplatRadiiFixture,
                  "points that float have discs of a usual size, and a sparse surface has wide ones") {
  PointCloud cloud;
  const auto add = [&](const DVec3& position, const DVec3& normal) {
    cloud.positions.emplace_back(position);
    cloud.normals.emplace_back(glm::normalize(normal));
  };
  constexpr int kSparse = 144, kFloating = 400;
  for (int k = 0; k < kSparse; ++k) add(DVec3(3 * (k % 12), 3 * (k / 12), 0), DVec3(0, 0, 1));
  const auto unit = [](int k) { return 2 * randomUnit(7, static_cast<std::uint64_t>(k)) - 1; };
  for (int k = 0; k < kFloating; ++k)
    add(DVec3(100, 0, 0) + 11.0 * DVec3(unit(6 * k), unit(6 * k + 1), unit(6 * k + 2)),
        DVec3(unit(6 * k + 3), unit(6 * k + 4), unit(6 * k + 5)));
  const auto radii = radiiOf(cloud, 1);
  const auto wide = [](float radius) { return radius > 1.5f; };
  CHECK(std::count_if(radii.begin(), radii.begin() + kSparse, wide) == kSparse);
  CHECK(std::count_if(radii.begin() + kSparse, radii.end(), wide) < kFloating / 8);
  CHECK(wrong(cloud, 1) == 0);
}

TEST_CASE_FIXTURE(SplatRadiiFixture, "borders keep their positions") {
  PointCloud grid;
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 40; ++x) grid.positions.emplace_back(x, y, 0);
  grid.normals.assign(grid.size(), Vec3(0, 0, 1));
  const auto radii = radiiOf(grid, 1);
  CHECK(*std::ranges::max_element(radii) < 1.45f);  // near a border discs are slightly wider
  CHECK(*std::ranges::min_element(radii) > 0.7071f);
}

TEST_CASE_FIXTURE(SplatRadiiFixture,
                  "radii handle no points, one, coincident, collinear points, and points without normals") {
  PointCloud cloud;
  CHECK(DrawnCloud(device, cloud, {.spacing = 1}).largestRadius() == 0);
  cloud.positions = {Vec3(3, 4, 5)};
  cloud.normals = {Vec3(0, 0, 1)};
  CHECK(radiiOf(cloud, 1).front() == 1);
  cloud.positions.assign(3000, Vec3(3, 4, 5));
  cloud.normals.assign(3000, Vec3(0, 0, 1));
  CHECK(std::ranges::all_of(radiiOf(cloud, 1), [](float r) { return r == 1; }));

  PointCloud line;
  for (int x = 0; x < 300; ++x) line.positions.emplace_back(0.1f * static_cast<float>(x), 0, 0);
  line.normals.assign(line.size(), Vec3(0, 1, 0));
  for (const float r : radiiOf(line, 0.1)) CHECK((r > 0.05f && r < 0.145f));

  PointCloud plain = shapeCloud("sphere", 8000);
  const double spacing = meanSpacing(plain);
  plain.normals.clear();
  const auto radii = radiiOf(plain, spacing);
  CHECK(*std::ranges::min_element(radii) > 0.8 * spacing);
  CHECK(*std::ranges::max_element(radii) < 2.1 * spacing);
}

TEST_CASE_FIXTURE(SplatRadiiFixture, "after edits every radius is that of a newly drawn cloud, bit by bit") {
  PointCloud cloud = thinnedAlong(shapeCloud("torus", 9000), 10);
  const auto loaded = static_cast<std::uint32_t>(cloud.size());
  const double spacing = meanSpacing(cloud);
  DrawnCloud drawn(device, cloud, {.spare = 200, .spacing = spacing, .edited = true});
  EditLog log(device, cloud.size());
  EditLog::Reader reader(log);
  std::mt19937 random(3);
  std::uniform_real_distribution<float> share(-1, 1);
  // The slots of the edited cloud, in the box of the loaded one.
  cloud.positions.resize(loaded + 200, Vec3(0));
  cloud.normals.resize(loaded + 200, Vec3(0));
  std::vector<bool> there(cloud.size());
  std::fill_n(there.begin(), loaded, true);
  std::uint32_t head = 0;
  for (int tick = 0; tick < 4; ++tick) {
    // A dent: the points around one move, some are removed, some inserted.
    std::vector<shared::EditEntry> ring(log.capacity());
    const auto write = [&](std::uint32_t id, bool gone) {
      ring[head++ % log.capacity()] = {.position = cloud.positions[id],
                                       .id = gone ? id | shared::kPointGone : id,
                                       .normal = cloud.normals[id],
                                       .color = 0,
                                       .parent = 0};
      there[id] = !gone;
    };
    const Vec3 center = cloud.positions[random() % loaded];
    for (std::uint32_t id = 0; id < loaded; ++id) {
      if (!there[id] || glm::distance(cloud.positions[id], center) > 12) continue;
      cloud.positions[id] += Vec3{share(random), share(random), share(random)};
      cloud.normals[id] = glm::normalize(cloud.normals[id] + 0.2f * Vec3{share(random), share(random), share(random)});
      write(id, random() % 10 == 0);
    }
    for (std::uint32_t i = 0; i < 50; ++i) {
      const std::uint32_t id = loaded + 50 * static_cast<std::uint32_t>(tick) + i;
      cloud.positions[id] = center + 8.0f * Vec3{share(random), share(random), share(random)};
      cloud.normals[id] = glm::normalize(Vec3{share(random), share(random), 2});
      write(id, false);
    }
    upload(device, log.entriesBuffer(), ring);
    log.publish(head);
    drawn.catchUp(reader);
    drawn.closeSurface();

    const auto radii = radiiOf(drawn);
    SplatRadii fresh(device, drawn.bounds(), drawn.count(), spacing);
    LiveCloud::Half side{Buffer::of<Vec4>(device, drawn.count(), Memory::device, "positions"),
                         Buffer::of<Vec4>(device, drawn.count(), Memory::device, "normals"), 1};
    auto normals = download<Vec4>(device, drawn.normals(), drawn.count());
    for (Vec4& normal : normals) normal.w = 0;
    upload(device, side.positions, download<Vec4>(device, drawn.positions(), drawn.count()));
    upload(device, side.normals, normals);
    const DiscShapes shapes(device, drawn.count());
    fresh.measure(side, shapes);
    const auto freshClips = download<std::uint32_t>(device, shapes.clips, drawn.count());
    const auto clipsDrawn = download<std::uint32_t>(device, drawn.shapes().clips, drawn.count());
    normals = download<Vec4>(device, side.normals, drawn.count());
    std::size_t different = 0, present = 0;
    for (std::size_t id = 0; id < radii.size(); ++id) {
      if (!there[id]) continue;
      ++present;
      different += radii[id] != normals[id].w || clipsDrawn[id] != freshClips[id];
    }
    CHECK(present > 2000);
    CHECK(different == 0);
    CHECK(drawn.largestRadius() >= fresh.largest());
  }
}

}  // namespace palpate::splat_radii_test
