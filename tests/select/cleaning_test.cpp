// Outliers, duplicates and subsampling against brute force, at awkward sizes and on degenerate clouds.
#include "engine/select/cleaning.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <glm/common.hpp>
#include <map>
#include <set>

#include "engine/cloud/counter_random.hpp"
#include "engine/select/chosen_points.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"

namespace palpate::cleaning_test {

namespace {

// A noisy plate with some points off it; every `repeated`-th point repeats an earlier one.
PointCloud plate(std::size_t count, std::size_t repeated = 0) {
  PointCloud cloud;
  for (std::size_t i = 0; i < count; ++i) {
    const auto at = [&](std::uint64_t k) { return static_cast<float>(randomUnit(7, 3 * i + k)); };
    cloud.positions.emplace_back(at(0), at(1), i % 97 == 5 ? 3 * at(2) : 0.01f * at(2));
    if (repeated > 0 && i % repeated == repeated - 1) cloud.positions[i] = cloud.positions[i / 2];
  }
  return cloud;
}

std::vector<double> distancesByForce(const PointCloud& cloud, std::size_t neighbours) {
  std::vector<double> means;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    std::vector<double> all;
    for (std::size_t j = 0; j < cloud.size(); ++j)
      if (j != i) all.push_back(glm::distance(DVec3(cloud.positions[i]), DVec3(cloud.positions[j])));
    std::ranges::sort(all);
    all.resize(std::min(neighbours, all.size()));
    double sum = 0;
    for (const double each : all) sum += each;
    means.push_back(all.empty() ? 0 : sum / static_cast<double>(all.size()));
  }
  return means;
}

PointSet outliersByForce(const std::vector<double>& distances, double sigma) {
  double mean = 0, squares = 0;
  for (const double each : distances) mean += each / static_cast<double>(distances.size());
  for (const double each : distances) squares += (each - mean) * (each - mean);
  const double deviation = std::sqrt(squares / (static_cast<double>(distances.size()) - 1));
  PointSet set;
  for (std::size_t i = 0; i < distances.size(); ++i)
    if (distances[i] > mean + sigma * deviation) set.set(i);
  return set;
}

PointSet setOf(std::initializer_list<std::uint64_t> points) {
  PointSet set;
  for (const std::uint64_t each : points) set.set(each);
  return set;
}

}  // namespace

TEST_CASE("statistical outliers are those of a search through all pairs") {
  for (const std::size_t repeated : {0u, 3u}) {
    for (const std::size_t count : {2u, 3u, 8u, 9u, 10u, 500u, 4097u}) {
      CAPTURE(count);
      CAPTURE(repeated);
      const PointCloud cloud = plate(count, repeated);
      const std::vector<double> expected = distancesByForce(cloud, 8);
      const BareVector<double> found = neighbourDistances(cloud, 8);
      REQUIRE(found.size() == count);
      bool same = true;
      for (std::size_t i = 0; i < count; ++i) same = same && found[i] == within(expected[i], 1e-12);
      CHECK(same);
      CHECK(statisticalOutliers(cloud, 8, 1) == outliersByForce(expected, 1));
      CHECK(statisticalOutliers(cloud, 8, 1, 3) == statisticalOutliers(cloud, 8, 1, 1));
    }
  }
  const std::vector<double> one = distancesByForce(plate(500), 1);
  CHECK(statisticalOutliers(plate(500), 1, 2.5) == outliersByForce(one, 2.5));
}

TEST_CASE("clouds without neighbours have no outliers, and many equal points take no longer") {
  CHECK(statisticalOutliers({}, 8, 1) == PointSet());
  CHECK(outlierShare(5, 100) == "5.0 % of the points");
  CHECK(outlierShare(139, 1000) == "13.9 % of the points; a larger sigma, such as 3, finds fewer");
  CHECK(statisticalOutliers(plate(1), 8, 1) == PointSet());
  CHECK(neighbourDistances(plate(1), 8) == BareVector<double>{0});
  PointCloud crowd;
  crowd.positions.assign(300'000, Vec3(1, 2, 3));
  crowd.positions.emplace_back(50, 2, 3);
  CHECK(statisticalOutliers(crowd, 8, 1) == setOf({300'000}));
  CHECK(radiusOutliers(crowd, 8, 0.5) == setOf({300'000}));
  CHECK(duplicatePoints(crowd).count() == 299'999);
  CHECK(onePointPerCell(crowd, 0.5).count() == 2);
}

TEST_CASE("radius outliers have fewer neighbours than are required, of all pairs") {
  for (const std::size_t count : {1u, 2u, 9u, 1000u}) {
    const PointCloud cloud = plate(count, 5);
    for (const double radius : {0.01, 0.05, 10.0})
      for (const std::uint32_t neighbours : {1u, 4u, 40u}) {
        PointSet expected;
        for (std::size_t i = 0; i < count; ++i) {
          std::size_t near = 0;
          for (std::size_t j = 0; j < count; ++j)
            near += j != i && glm::distance(DVec3(cloud.positions[i]), DVec3(cloud.positions[j])) < radius;
          if (near < neighbours) expected.set(i);
        }
        CHECK(radiusOutliers(cloud, neighbours, radius) == expected);
      }
  }
}

TEST_CASE("duplicates are exact, in the file's precision, and the first point stays") {
  PointCloud cloud = plate(5000, 4);
  std::set<std::array<float, 3>> known;
  PointSet expected;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (const Vec3& p = cloud.positions[i]; !known.insert({p.x, p.y, p.z}).second) expected.set(i);
  CHECK(expected.count() > 1000);
  CHECK(duplicatePoints(cloud) == expected);
  CHECK(duplicatePoints(cloud, 1) == duplicatePoints(cloud, 5));

  PointCloud doubles;  // equal as float32, different in the file
  doubles.exactPositions = {{1.0000000001, 0, 0}, {1, 0, 0}, {1, 0, 0}, {-0.0, 5, 0}, {0.0, 5, 0}};
  for (const DVec3& each : doubles.exactPositions) doubles.positions.emplace_back(each);
  CHECK(duplicatePoints(doubles) == setOf({2, 4}));
  CHECK(duplicatePoints({}) == PointSet());
}

TEST_CASE("subsampling keeps an original point in each cell, the one nearest to its middle") {
  for (const DVec3& origin : {DVec3(0), DVec3(637000.25, -849000, 12)}) {
    PointCloud cloud = plate(4097, 6);
    cloud.origin = origin;
    constexpr double kSide = 0.07;
    std::map<std::array<double, 3>, std::pair<double, std::size_t>> cells;
    for (std::size_t i = 0; i < cloud.size(); ++i) {
      const DVec3 p = cloud.origin + DVec3(cloud.positions[i]), cell = glm::floor(p / kSide);
      const double off = glm::length(p - kSide * (cell + 0.5));
      auto [found, isNew] = cells.try_emplace({cell.x, cell.y, cell.z}, off, i);
      if (!isNew && off < found->second.first) found->second = {off, i};
    }
    PointSet expected;
    for (const auto& [cell, best] : cells) expected.set(best.second);
    CHECK(onePointPerCell(cloud, kSide) == expected);
    CHECK(onePointPerCell(cloud, kSide, 1) == onePointPerCell(cloud, kSide, 4));
    CHECK(onePointPerCell(cloud, 1e-4).count() == 4097 - duplicatePoints(cloud).count());
  }
  CHECK(onePointPerCell({}, 1) == PointSet());
  CHECK(onePointPerCell(plate(1), 1e9) == PointSet::range(0, 1));
  PointCloud far = plate(100);
  far.positions.emplace_back(1e30f, 0, 0);
  CHECK(errorOf([&] { onePointPerCell(far, 1e-3); }).find("too large to be subsampled; remove far points first") !=
        std::string::npos);
}

TEST_CASE("random points are as many as asked for, the same for a seed, and evenly drawn") {
  constexpr std::uint64_t kPoints = 100'000, kDrawn = 1000;
  const PointSet drawn = randomPoints(kPoints, kDrawn, 1);
  CHECK(drawn.count() == kDrawn);
  CHECK(drawn == randomPoints(kPoints, kDrawn, 1));
  CHECK_FALSE(drawn == randomPoints(kPoints, kDrawn, 2));
  double sum = 0;
  drawn.forEach([&](std::uint64_t point) { sum += static_cast<double>(point); });
  CHECK(sum / kDrawn == within(kPoints / 2, 3 * kPoints / std::sqrt(12.0 * kDrawn)));
  CHECK(randomPoints(5, 5, 1) == PointSet::range(0, 5));
  CHECK(randomPoints(5, 9, 1) == PointSet::range(0, 5));
  CHECK(randomPoints(0, 9, 1) == PointSet());
  CHECK(randomPoints(5, 0, 1) == PointSet());
}

TEST_CASE("chosen points keep all that they have, and triangles follow their corners") {
  PointCloud cloud = plate(10);
  cloud.origin = {5, 6, 7};
  cloud.exactPositions.resize(10);
  cloud.storedAs.comments = {"comment kept"};
  Attribute wide{"id", ScalarType::i64, {}};
  wide.data.resize(80);
  for (std::int64_t i = 0; i < 10; ++i) {
    const std::int64_t value = 9007199254740993 + i;
    std::memcpy(wide.data.data() + 8 * i, &value, 8);
    cloud.exactPositions[static_cast<std::size_t>(i)] = DVec3(1e-9 * static_cast<double>(i), 0.1, 1e9);
    cloud.normals.emplace_back(0, 0, static_cast<float>(i));
    cloud.colors.push_back({1, 2, 3, static_cast<std::uint8_t>(i)});
  }
  cloud.extra.push_back(wide);
  const PointCloud chosen = chosenPoints(cloud, setOf({1, 4, 9}));
  REQUIRE(chosen.size() == 3);
  const std::array<std::size_t, 3> from{1, 4, 9};
  for (std::size_t i = 0; i < 3; ++i) {
    CHECK(chosen.positions[i] == cloud.positions[from[i]]);
    CHECK(chosen.exactPositions[i] == cloud.exactPositions[from[i]]);
    CHECK(chosen.normals[i] == cloud.normals[from[i]]);
    CHECK(chosen.colors[i] == cloud.colors[from[i]]);
    CHECK(std::memcmp(chosen.extra[0].data.data() + 8 * i, wide.data.data() + 8 * from[i], 8) == 0);
  }
  CHECK(chosen.origin == cloud.origin);
  CHECK(chosen.storedAs.comments == cloud.storedAs.comments);
  CHECK(chosenPoints(cloud, {}).empty());
  const std::vector<std::array<std::uint32_t, 3>> triangles{{1, 4, 9}, {1, 2, 4}, {9, 4, 1}, {9, 4, 8}};
  const std::vector<std::uint32_t> points{1, 4, 9};
  CHECK(chosenTriangles(triangles, points) == std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {2, 1, 0}});
  CHECK(chosenTriangles(triangles, {}).empty());
}

}  // namespace palpate::cleaning_test
