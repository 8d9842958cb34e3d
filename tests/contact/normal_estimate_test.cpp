// Normals from the GPU against double precision and against shapes whose normals are known.
#include "engine/contact/normal_estimate.hpp"

#include <set>

#include "engine/cloud/normals.hpp"
#include "engine/cloud/point_tree.hpp"
#include "engine/edit/normal_fit.hpp"
#include "engine/gpu/queue.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/spatial_hash.hpp"
#include "shaders/shared/normal_estimate.h"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"

namespace palpate {

namespace {

float worstCosine(std::span<const Vec3> a, std::span<const Vec3> b) {
  REQUIRE(a.size() == b.size());
  float worst = 1;
  for (std::size_t i = 0; i < a.size(); ++i) worst = std::min(worst, glm::dot(a[i], b[i]));
  return worst;
}

PointCloud cloudAt(std::vector<Vec3> positions) {
  PointCloud cloud;
  cloud.positions = std::move(positions);
  return cloud;
}

// The normal of one point by the same rule: NormalFit over the support radius.
Vec3 fittedInDouble(const PointTree& tree, std::span<const Vec3> positions, const Vec3& at, double radius) {
  std::vector<std::uint32_t> around;
  tree.within(DVec3(at), radius, around);
  NormalFit fit(radius);
  for (const std::uint32_t j : around) fit.add(DVec3(positions[j]) - DVec3(at));
  return Vec3(fit.normal(DVec3(0)).normal);
}

void checkUnit(const PointCloud& cloud) {
  REQUIRE(cloud.normals.size() == cloud.size());
  for (const Vec3& normal : cloud.normals) REQUIRE(glm::length(normal) == doctest::Approx(1).epsilon(1e-4));
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "estimated on the GPU, normals are those of double precision and look outwards") {
  for (const char* shape : {"sphere", "torus", "bumpy-sphere"}) {
    CAPTURE(shape);
    Scene scene = makeScene(shape, 30'000);
    PointCloud onGpu = scene.cloud, onCpu = scene.cloud;
    onGpu.normals.clear();
    onCpu.normals.clear();
    const NormalEstimateCost cost = estimateNormals(device, onGpu);
    estimateNormals(onCpu);
    CHECK(cost.onHost == 0);
    checkUnit(onGpu);
    CHECK(worstCosine(onGpu.normals, scene.cloud.normals) > std::cos(0.06));
    CHECK(worstCosine(onGpu.normals, onCpu.normals) > std::cos(0.06));
    const PointTree tree(scene.cloud.positions);
    float worst = 1;
    for (std::size_t i = 0; i < onGpu.size(); i += 7)
      worst =
          std::min(worst, std::abs(glm::dot(onGpu.normals[i], fittedInDouble(tree, scene.cloud.positions,
                                                                             scene.cloud.positions[i], scene.radius))));
    CHECK(worst > std::cos(0.002));
  }
}

TEST_CASE_FIXTURE(GpuFixture, "noisy points take a wider neighbourhood, on the GPU as on the CPU") {
  const Scene clean = makeScene("torus", 20'000);
  const Scene scene = makeScene("torus", 20'000, DVec3(0), 0.25 * clean.spacing);
  PointCloud onGpu = cloudAt(scene.cloud.positions), onCpu = onGpu;
  const NormalEstimateCost cost = estimateNormals(device, onGpu);
  estimateNormals(onCpu);
  CHECK(cost.onHost < onGpu.size() / 10);
  for (const PointCloud* cloud : {&onGpu, &onCpu}) {
    std::vector<float> cosines;
    for (std::size_t i = 0; i < cloud->size(); ++i)
      cosines.push_back(glm::dot(cloud->normals[i], scene.cloud.normals[i]));
    std::ranges::sort(cosines);
    CHECK(cosines.front() > 0.5f);
    CHECK(cosines[cosines.size() / 20] > std::cos(0.125));  // sixteen points alone give 0.15
  }
}

TEST_CASE_FIXTURE(GpuFixture, "around the edges and corners of a cube normals still look outwards") {
  const Scene scene = makeScene("cube", 30'000);
  PointCloud cloud = scene.cloud;
  cloud.normals.clear();
  estimateNormals(device, cloud);
  // In a corner the plane cuts across three faces; nowhere does it turn beyond the diagonal's 55 degrees by much.
  CHECK(worstCosine(cloud.normals, scene.cloud.normals) > std::cos(1.1));
}

TEST_CASE_FIXTURE(GpuFixture, "sizes around a workgroup, far from the origin and on its negative side") {
  for (const std::size_t count : {255u, 256u, 257u, 65'537u}) {
    for (const DVec3& center : {DVec3(0), DVec3(-3000, -70, -1e4)}) {
      CAPTURE(count);
      CAPTURE(center.x);
      Scene scene = makeScene("sphere", count);
      PointCloud cloud = cloudAt(scene.cloud.positions);  // as in a file of floats: nothing is kept in an origin
      for (Vec3& position : cloud.positions) position += Vec3(center);
      estimateNormals(device, cloud);
      checkUnit(cloud);
      CHECK(worstCosine(cloud.normals, scene.cloud.normals) > std::cos(0.1));
    }
  }
}

TEST_CASE_FIXTURE(GpuFixture, "clouds without a surface get unit normals, those of the CPU") {
  std::vector<std::vector<Vec3>> clouds{{},
                                        {Vec3(1)},
                                        {Vec3(0), Vec3(1, 2, 3)},
                                        {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)},
                                        std::vector<Vec3>(20'000, Vec3(4))};
  clouds.emplace_back();
  for (int i = 0; i < 300; ++i) clouds.back().emplace_back(static_cast<float>(i), 0.0f, 0.0f);
  for (auto& positions : clouds) {
    CAPTURE(positions.size());
    PointCloud onGpu = cloudAt(positions), onCpu = cloudAt(positions);
    estimateNormals(device, onGpu);
    estimateNormals(onCpu);
    checkUnit(onGpu);
    for (std::size_t i = 0; i < onGpu.size(); ++i) {
      CHECK(std::abs(glm::dot(onGpu.normals[i], onCpu.normals[i])) > 0.9999f);
      CHECK(glm::dot(onGpu.normals[i], onGpu.normals[0]) > 0.9999f);
    }
  }
}

TEST_CASE_FIXTURE(GpuFixture, "duplicates change nothing, and the same cloud gives the same normals") {
  const Scene scene = makeScene("torus", 3'000);
  PointCloud once = cloudAt(scene.cloud.positions), again = once, doubled = once;
  for (int copy = 0; copy < 20; ++copy)
    doubled.positions.insert(doubled.positions.end(), once.positions.begin(), once.positions.end());
  estimateNormals(device, once, 1);
  estimateNormals(device, again, 3);
  estimateNormals(device, doubled);
  CHECK(once.normals == again.normals);
  for (std::size_t i = 0; i < doubled.size(); ++i) REQUIRE(doubled.normals[i] == once.normals[i % once.size()]);
}

TEST_CASE_FIXTURE(GpuFixture,
                  "places much denser or sparser than the rest are fitted over fitting radii, or by the CPU") {
  const Scene scene = makeScene("sphere", 20'000);
  PointCloud cloud = cloudAt(scene.cloud.positions);
  std::vector<Vec3> truth = scene.cloud.normals;
  const auto addSphere = [&](std::size_t count, double size, const DVec3& center) {
    const PointCloud other = sampleShape(*makeShape("sphere", size, center), {.count = count});
    for (std::size_t i = 0; i < other.size(); ++i) {
      cloud.positions.push_back(Vec3(other.fileCoordinates(i)));
      truth.push_back(other.normals[i]);
    }
  };
  addSphere(4'000, 8, DVec3(90, 0, 0));  // six times denser by length
  addSphere(400, 60, DVec3(0, 150, 0));  // four times sparser
  SUBCASE("within what the radius adapts to") {}
  SUBCASE("beyond it: thousands of points in one cell, and points with nobody near") {
    addSphere(70'000, 0.5, DVec3(-90, 0, 0));
    addSphere(60, 90, DVec3(0, -300, 0));
  }
  const NormalEstimateCost cost = estimateNormals(device, cloud);
  checkUnit(cloud);
  if (cloud.size() > 50'000) CHECK(cost.onHost > 60);
  CHECK(worstCosine(cloud.normals, truth) > std::cos(0.3));
}

TEST_CASE_FIXTURE(GpuFixture, "the named neighbours stand nearest in the eight sectors of the plane") {
  const Scene scene = makeScene("sphere", 20'000);
  LiveCloud live(device, scene.cloud);
  SpatialHash hash(device, makeHashGrid(Vec3(-60), scene.radius, live.count()), live.count());
  hash.build(live);
  const Buffer planes = Buffer::of<Vec4>(device, live.count(), Memory::device, "planes");
  const Buffer named =
      Buffer::of<std::uint32_t>(device, live.count() * shared::kSectors, Memory::device, "named neighbours");
  CommandList list(device, device.touch(), "estimate");
  list.begin();
  const NormalEstimate estimate(device);
  estimate.record(list, hash.view(live.side(), live.count()), planes, named, scene.radius);
  list.end();
  device.touch().run(list);
  const auto ids = download<std::uint32_t>(device, named, live.count() * shared::kSectors);
  for (std::uint32_t i = 0; i < live.count(); i += 997) {
    std::set<std::uint32_t> own;
    std::size_t inSectors = 0;
    for (std::uint32_t s = 0; s < shared::kSectors; ++s) {
      const std::uint32_t other = ids[i * shared::kSectors + s];
      if (other == shared::kNoNeighbour) continue;
      ++inSectors;
      own.insert(other);
    }
    CHECK(inSectors >= shared::kEnoughSectors);
    CHECK(own.size() == inSectors);  // a different one in each
    double nearest = 1e9;
    std::uint32_t who = 0;
    for (std::uint32_t j = 0; j < live.count(); ++j) {
      const double distance = glm::distance(scene.cloud.positions[i], scene.cloud.positions[j]);
      if (j != i && distance < nearest) nearest = distance, who = j;
    }
    CHECK(own.contains(who));
    for (const std::uint32_t j : own) {
      REQUIRE(j < live.count());
      CHECK(j != i);
      CHECK(glm::distance(scene.cloud.positions[i], scene.cloud.positions[j]) < 4 * scene.spacing);
    }
  }
}

}  // namespace palpate
