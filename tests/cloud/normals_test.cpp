#include "engine/cloud/normals.hpp"

#include <doctest/doctest.h>

#include <numeric>
#include <string>

#include "engine/cloud/analytic_shape.hpp"

namespace palpate::test::normals_test {
namespace {

/// Cosine of the worst angle between the estimated normals and the true ones; negative if any is reversed.
float worstCosine(PointCloud cloud, unsigned threads = 0) {
  const std::vector<Vec3> truth = cloud.normals;
  estimateNormals(cloud, 16, threads);
  float worst = 1;
  for (std::size_t i = 0; i < cloud.size(); ++i) worst = std::min(worst, glm::dot(truth[i], cloud.normals[i]));
  return worst;
}

}  // namespace

TEST_CASE("estimated normals are accurate within degrees and face outwards") {
  CHECK(worstCosine(sampleShape(*makeShape("torus"), {.count = 50'000})) > std::cos(0.03));
  CHECK(worstCosine(sampleShape(*makeShape("bumpy-sphere"), {.count = 50'000})) > std::cos(0.05));
  CHECK(worstCosine(sampleShape(*makeShape("torus"), {.count = 50'000, .noise = 0.1})) > std::cos(0.35));
  CHECK(worstCosine(sampleShape(*makeShape("plane", 1e-4), {.count = 1000})) > 0.9999f);
}

TEST_CASE("each connected part of a cloud has normals that face outwards") {
  PointCloud cloud = sampleShape(*makeShape("sphere", 10), {.count = 5000});
  const PointCloud other = sampleShape(*makeShape("torus", 10, DVec3(30, 0, -7)), {.count = 5000});
  cloud.positions.insert(cloud.positions.end(), other.positions.begin(), other.positions.end());
  cloud.normals.insert(cloud.normals.end(), other.normals.begin(), other.normals.end());
  CHECK(worstCosine(cloud) > std::cos(0.1));
}

TEST_CASE("edges between planes are kept, and smooth surfaces are unchanged") {
  for (const char* shape : {"cube", "bumpy-sphere"}) {
    const PointCloud cloud = sampleShape(*makeShape(shape), {.count = 20'000});
    std::vector<FittedPlane> planes(cloud.size());
    NeighbourGraph graph{.degree = 16, .neighbours = std::vector<std::uint32_t>(16 * cloud.size())};
    std::vector<std::uint32_t> all(cloud.size());
    std::iota(all.begin(), all.end(), 0u);
    fitNearestPlanes(cloud.positions, all, 16, planes, graph);
    const std::vector<Vec3> kept = keepEdges(cloud.positions, planes);
    double before = 0, after = 0;
    std::size_t changed = 0;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      if (kept[i] == planes[i].normal) continue;
      ++changed;
      before += 1 - std::abs(glm::dot(planes[i].normal, cloud.normals[i]));
      after += 1 - std::abs(glm::dot(kept[i], cloud.normals[i]));
    }
    if (std::string(shape) == "bumpy-sphere") {
      CHECK(changed == 0);
    } else {
      CHECK(changed > 1000);
      CHECK(after < 0.4 * before);
    }
  }
}

TEST_CASE("normals do not depend on duplicates or the number of threads") {
  PointCloud cloud = sampleShape(*makeShape("torus"), {.count = 5000});
  PointCloud doubled = cloud;
  for (int copy = 0; copy < 20; ++copy)
    doubled.positions.insert(doubled.positions.end(), cloud.positions.begin(), cloud.positions.end());
  estimateNormals(cloud, 16, 1);
  estimateNormals(doubled, 16, 3);
  for (std::size_t i = 0; i < doubled.size(); ++i) REQUIRE(doubled.normals[i] == cloud.normals[i % cloud.size()]);
}

TEST_CASE("degenerate clouds get unit normals") {
  PointCloud cloud;
  estimateNormals(cloud);
  CHECK_FALSE(cloud.hasNormals());
  std::vector<std::vector<Vec3>> clouds{
      {Vec3(1)}, {Vec3(0), Vec3(1, 2, 3)}, {Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)}, std::vector<Vec3>(20'000, Vec3(4))};
  clouds.emplace_back();
  for (int i = 0; i < 100; ++i) clouds.back().emplace_back(static_cast<float>(i), 0.0f, 0.0f);
  for (const auto& positions : clouds) {
    cloud.positions = positions;
    estimateNormals(cloud);
    REQUIRE(cloud.normals.size() == positions.size());
    for (const Vec3& normal : cloud.normals) CHECK(std::abs(glm::length(normal) - 1) < 1e-5f);
  }
  CHECK(std::abs(cloud.normals[50].x) < 1e-5f);  // perpendicular to the line
}

}  // namespace palpate::test::normals_test
