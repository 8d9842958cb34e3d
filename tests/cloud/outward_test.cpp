// Which side of estimated normals is the outside, with points that float about, parts that touch nothing, open sheets.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/io/ply_reader.hpp"
#include "tests/near.hpp"
#include "tests/shared_files.hpp"

namespace palpate::test::outward_test {

namespace {

struct Outliers {
  double share = 0;  ///< of the cloud's points, in a box half as large again
  unsigned seed = 1;
};

void addOutliers(PointCloud& cloud, const Outliers& outliers) {
  const Bounds box = boundsOf(cloud);
  std::mt19937 random(outliers.seed);
  std::uniform_real_distribution<double> side(-0.25, 1.25);
  const auto count = static_cast<std::size_t>(outliers.share * static_cast<double>(cloud.size()));
  for (std::size_t i = 0; i < count; ++i) {
    const double x = side(random), y = side(random), z = side(random);
    const DVec3 at(x, y, z);
    cloud.positions.emplace_back(box.min + at * (box.max - box.min));
  }
}

/// The share of the first `count` normals that face away from the truth after an estimate.
double reversed(PointCloud cloud, const std::vector<Vec3>& truth, std::optional<UpAxis> up = {}) {
  cloud.normals.clear();
  estimateNormals(cloud, 16, 0, up);
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < truth.size(); ++i) wrong += glm::dot(truth[i], cloud.normals[i]) < 0;
  return static_cast<double>(wrong) / static_cast<double>(truth.size());
}

/// Points of a parallelogram, in rows, all with one normal.
void addSheet(PointCloud& cloud, const DVec3& corner, const DVec3& across, const DVec3& along, const DVec3& normal) {
  const auto columns = static_cast<int>(glm::length(across)), rows = static_cast<int>(glm::length(along));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      const double u = (column + 0.5 * (row % 2)) / columns, v = static_cast<double>(row) / rows;
      cloud.positions.emplace_back(corner + u * across + v * along);
      cloud.normals.emplace_back(normal);
    }
}

/// The sides of a box without a bottom; with its top or without.
void addBox(PointCloud& cloud, const DVec3& min, const DVec3& max, bool top, bool bottom, double sign) {
  const DVec3 size = max - min, x(size.x, 0, 0), y(0, size.y, 0), z(0, 0, size.z);
  addSheet(cloud, min, x, z, {0, -sign, 0});
  addSheet(cloud, min + y, x, z, {0, sign, 0});
  addSheet(cloud, min, y, z, {-sign, 0, 0});
  addSheet(cloud, min + x, y, z, {sign, 0, 0});
  if (top) addSheet(cloud, min + z, x, y, {0, 0, sign});
  if (bottom) addSheet(cloud, min, x, y, {0, 0, -sign});
}

}  // namespace

TEST_CASE("points that float about do not turn the normals of a surface") {
  for (const char* shape : {"sphere", "torus", "bumpy-sphere", "sculpture"})
    for (const double noise : {0.0, 0.5})
      for (const double share : {0.0, 0.01, 0.05})
        for (const unsigned seed : {1u, 2u, 3u}) {
          const double spacing = meanSpacing(sampleShape(*makeShape(shape), {.count = 6000}));
          PointCloud cloud = sampleShape(*makeShape(shape), {.count = 6000, .noise = noise * spacing});
          const std::vector<Vec3> truth = cloud.normals;
          addOutliers(cloud, {share, seed});
          CAPTURE(shape);
          CAPTURE(noise);
          CAPTURE(share);
          CAPTURE(seed);
          CHECK(reversed(cloud, truth) <= (noise > 0 ? 0.004 : 0.001));
        }
}

TEST_CASE("points that float about do not turn the normals of real scans") {
  for (const char* file : {"bunny_34834.ply", "horse_48485.ply", "armadillo_43243.ply"}) {
    const auto scan = sharedFile(file);
    if (scan.empty()) return;
    const PointCloud cloud = readPly(scan);
    const double clean = reversed(cloud, cloud.normals);
    for (const double share : {0.01, 0.05}) {
      PointCloud strewn = cloud;
      addOutliers(strewn, {share});
      const double found = reversed(strewn, cloud.normals);
      MESSAGE(file, ", ", share, " outliers: ", found, " of the normals are reversed, without them ", clean);
      CHECK(found < 0.005);
    }
    CHECK(clean < 0.005);
  }
}

TEST_CASE("parts that touch nothing face outwards each, with points that float between them") {
  PointCloud cloud = sampleShape(*makeShape("torus", 40, DVec3(0, 0, 20)), {.count = 8000});
  const PointCloud held = sampleShape(*makeShape("sphere", 8, DVec3(0, 0, 20)), {.count = 2000});
  cloud.positions.insert(cloud.positions.end(), held.positions.begin(), held.positions.end());
  cloud.normals.insert(cloud.normals.end(), held.normals.begin(), held.normals.end());
  addBox(cloud, DVec3(-25, -25, -26), DVec3(25, 25, -8), true, false, 1);                // a plinth
  addSheet(cloud, DVec3(-80, -80, -34), DVec3(160, 0, 0), DVec3(0, 160, 0), {0, 0, 1});  // the ground
  const std::vector<Vec3> truth = cloud.normals;
  CHECK(reversed(cloud, truth, UpAxis::z) < 0.005);
  CHECK(reversed(cloud, truth) < 0.005);
  for (const unsigned seed : {1u, 2u, 3u, 4u, 5u, 6u}) {
    CAPTURE(seed);
    PointCloud strewn = cloud;
    addOutliers(strewn, {0.05, seed});
    CHECK(reversed(strewn, truth, UpAxis::z) < 0.01);
  }
}

TEST_CASE("a part in a closed one faces outwards, too") {
  PointCloud cloud = sampleShape(*makeShape("sphere", 40), {.count = 8000});
  const PointCloud inner = sampleShape(*makeShape("cube", 12), {.count = 4000});
  cloud.positions.insert(cloud.positions.end(), inner.positions.begin(), inner.positions.end());
  cloud.normals.insert(cloud.normals.end(), inner.normals.begin(), inner.normals.end());
  CHECK(reversed(cloud, cloud.normals) == 0);
}

TEST_CASE("an open sheet faces up, a wall the front, and a room without a ceiling faces in") {
  for (const auto& [name, up] : kUpAxes) {
    CAPTURE(name);
    const DVec3 above = directionOf(up), front = frontOf(up), third = glm::abs(glm::cross(above, front));
    PointCloud ground, facade, side;
    addSheet(ground, DVec3(0), 60.0 * front, 50.0 * third, above);
    addSheet(facade, DVec3(0), 60.0 * above, 50.0 * third, front);
    addSheet(side, DVec3(0), 60.0 * above, 50.0 * front, third);
    for (const PointCloud* sheet : {&ground, &facade, &side}) {
      CHECK(reversed(*sheet, sheet->normals, up) == 0);
      PointCloud rough = *sheet;
      std::mt19937 random(5);
      std::normal_distribution<float> noise(0, 0.1f);
      for (std::size_t i = 0; i < rough.size(); ++i) rough.positions[i] += noise(random) * rough.normals[i];
      CHECK(reversed(rough, sheet->normals, up) == 0);
    }
  }
  PointCloud room, vase;
  addBox(room, DVec3(0), DVec3(60, 50, 25), false, true, -1);
  CHECK(reversed(room, room.normals, UpAxis::z) < 0.01);
  addBox(vase, DVec3(0), DVec3(30, 30, 80), false, true, 1);
  CHECK(reversed(vase, vase.normals, UpAxis::z) < 0.01);
}

TEST_CASE("a room that is scanned from inside, with its ceiling, faces in if it has contents; an empty box faces out") {
  PointCloud box, room;
  addBox(box, DVec3(0), DVec3(60, 50, 25), true, true, 1);
  CHECK(reversed(box, box.normals) < 0.01);
  addBox(room, DVec3(0), DVec3(60, 50, 25), true, true, -1);
  addBox(room, DVec3(20, 15, 0), DVec3(40, 30, 10), true, false, 1);
  CHECK(reversed(room, room.normals) < 0.02);
}

TEST_CASE("sparse parts of a surface face the same side as its dense ones") {
  // The lower half has a hundredth of the density.
  PointCloud cloud = sampleShape(*makeShape("sphere", 40), {.count = 100'000}), uneven;
  for (std::size_t i = 0; i < cloud.size(); ++i)
    if (cloud.positions[i].z > 0 || i % 100 == 0) {
      uneven.positions.push_back(cloud.positions[i]);
      uneven.normals.push_back(cloud.normals[i]);
    }
  CHECK(reversed(uneven, uneven.normals) == 0);
}

}  // namespace palpate::test::outward_test
