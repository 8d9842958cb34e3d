// Distances to neighbours on the GPU against double precision, on even, uneven and ugly clouds.
#include "engine/contact/neighbour_distances.hpp"

#include <random>

#include "engine/select/cleaning.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"

namespace palpate::neighbour_distances_test {

namespace {

double worstError(Device& device, const PointCloud& cloud, std::uint32_t neighbours) {
  const auto onGpu = neighbourDistances(device, cloud, neighbours);
  REQUIRE(onGpu);
  const BareVector<double> exact = neighbourDistances(cloud, neighbours);
  REQUIRE(onGpu->size() == exact.size());
  double worst = 0;
  for (std::size_t i = 0; i < exact.size(); ++i)
    worst = std::max(worst, std::abs((*onGpu)[i] - exact[i]) / std::max(exact[i], 1e-30));
  return worst;
}

PointCloud scattered(std::size_t points, double side, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> place(-static_cast<float>(side), static_cast<float>(side));
  PointCloud cloud;
  cloud.positions.resize(points);
  for (Vec3& position : cloud.positions)
    for (int k = 0; k < 3; ++k) position[k] = place(random);
  return cloud;
}

void append(PointCloud& cloud, const PointCloud& more) {
  cloud.positions.insert(cloud.positions.end(), more.positions.begin(), more.positions.end());
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "distances to neighbours on the GPU are those of double precision") {
  for (const char* shape : {"sphere", "plane", "bumpy-sphere"})
    for (const std::uint32_t neighbours : {1u, 8u, 31u, 32u}) {
      CAPTURE(shape);
      CAPTURE(neighbours);
      PointCloud cloud = makeScene(shape, 5'000).cloud;
      cloud.normals.clear();
      CHECK(worstError(device, cloud, neighbours) < 1e-12);
    }
}

TEST_CASE_FIXTURE(GpuFixture, "far points, crowds, heaps at one position and awkward sizes have exact distances, too") {
  PointCloud cloud = makeScene("sphere", 4'000).cloud;
  cloud.normals.clear();
  append(cloud, scattered(40, 1'000, 1));    // far from all others
  append(cloud, scattered(1'500, 0.02, 2));  // a crowd, within a cell of the sphere's spacing
  append(cloud, scattered(3, 1e5, 3));
  cloud.positions.insert(cloud.positions.end(), 40, Vec3(7, 7, 7));  // at one position, alone
  cloud.positions.insert(cloud.positions.end(), 12, Vec3(0, 0, 50));
  CHECK(worstError(device, cloud, 8) < 1e-12);
  CHECK(worstError(device, cloud, 32) < 1e-12);
  for (const std::size_t count : {9u, 10u, 63u, 64u, 65u, 257u}) {
    CAPTURE(count);
    CHECK(worstError(device, scattered(count, 10, static_cast<std::uint32_t>(count)), 8) < 1e-12);
  }
}

TEST_CASE_FIXTURE(GpuFixture, "what the GPU cannot compute is left to the CPU") {
  const PointCloud few = scattered(8, 1, 4);
  CHECK_FALSE(neighbourDistances(device, few, 8));
  CHECK_FALSE(neighbourDistances(device, few, 0));
  CHECK_FALSE(neighbourDistances(device, scattered(100, 1, 4), 33));
  CHECK_FALSE(neighbourDistances(device, {}, 8));
  PointCloud heap;
  heap.positions.assign(100, Vec3(1));
  CHECK_FALSE(neighbourDistances(device, heap, 8));
  // Squares of such small distances cannot be stored as floats.
  CHECK_FALSE(neighbourDistances(device, scattered(100, 1e-15, 4), 8));
}

TEST_CASE_FIXTURE(GpuFixture, "outliers by the GPU's distances are the same points") {
  for (const double sigma : {0.5, 1.0, 3.0}) {
    CAPTURE(sigma);
    PointCloud cloud = makeScene("bumpy-sphere", 20'000).cloud;
    cloud.normals.clear();
    append(cloud, scattered(300, 80, 5));
    const auto make = [&](const PointCloud& of, std::uint32_t neighbours, unsigned threads) {
      return neighbourDistances(device, of, neighbours, threads);
    };
    const PointSet outliers = statisticalOutliers(cloud, 8, sigma, 0, make);
    CHECK(outliers == statisticalOutliers(cloud, 8, sigma));
    CHECK(outliers.count() > 200);
  }
}

}  // namespace palpate::neighbour_distances_test
