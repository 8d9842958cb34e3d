// Gaussians of an edited scene: those of untouched points stay bit by bit, the others follow their points, and a
// rotated Gaussian has the covariance and the colours of the original, seen from rotated directions.
#include "engine/cloud/edited_gaussians.hpp"

#include <doctest/doctest.h>

#include <fstream>
#include <glm/gtc/quaternion.hpp>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/gaussian_harmonics.hpp"
#include "engine/cloud/spacing.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/content_of.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"
#include "tests/splat_files.hpp"

namespace palpate::test::edited_gaussians_test {

namespace {

DQuat rotationAbout(const DVec3& axis, double angle) {
  return {std::cos(angle / 2), std::sin(angle / 2) * glm::normalize(axis)};
}

/// A splat scene as it was read, and files that are made of it.
struct Scene {
  explicit Scene(SplatFile itsFile) : file(std::move(itsFile)) {
    std::ofstream(folder / "scene.ply", std::ios::binary) << file.bytes();
    cloud = readCloud(folder / "scene.ply").cloud;
    points = statesOf(cloud);
  }
  SplatFile saved(const PointCloud& edited) const {
    writeCloud(folder / "saved.ply", edited);
    return parsedSplats(contentOf(folder / "saved.ply"));
  }
  SplatFile saved() const { return saved(editedCloud(cloud, points)); }
  /// Distance of the felt point nearest to a Gaussian for which `holds`.
  double nearest(std::size_t row, auto&& holds) const {
    double least = 1e30;
    for (const PointState& point : points)
      if (holds(point))
        least = std::min(least, glm::distance(file.center(row), cloud.origin + DVec3(cloud.positions[point.number])));
    return least;
  }

  ScratchFolder folder;
  SplatFile file;
  PointCloud cloud;
  std::vector<PointState> points;
};

void checkSameSeen(const SplatFile& before, const SplatFile& after, std::size_t row, const DQuat& rotation) {
  const glm::dmat3 turn = glm::mat3_cast(rotation), expected = turn * covarianceOf(before, row) * glm::transpose(turn);
  const glm::dmat3 found = covarianceOf(after, row);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) CHECK(found[i][k] == within(expected[i][k], 1e-5));
  SceneRandom random(row);
  for (int k = 0; k < 5; ++k) {
    const DVec3 d = random.direction(), was = colorAlong(before, row, d), is = colorAlong(after, row, rotation * d);
    for (int channel = 0; channel < 3; ++channel) CHECK(is[channel] == within(was[channel], 1e-5));
  }
}

}  // namespace

TEST_CASE("rotated harmonics have in each rotated direction the value that they had before") {
  SceneRandom random(4);
  for (int trial = 0; trial < 20; ++trial) {
    const DQuat rotation = rotationAbout(random.direction(), 6.2 * random.unit());
    std::array<double, kHarmonics> before{}, after{};
    for (double& each : before) each = random.normal();
    after = before;
    HarmonicRotation(rotation).rotate(after);
    for (int k = 0; k < 20; ++k) {
      const DVec3 d = random.direction();
      const auto here = harmonicsAt(d), there = harmonicsAt(rotation * d);
      double was = 0, is = 0;
      for (std::size_t i = 0; i < kHarmonics; ++i) was += before[i] * here[i], is += after[i] * there[i];
      CHECK(is == within(was, 1e-12));
    }
    // Of lower degrees, the part that there is.
    for (const std::size_t count : {0, 3, 8, 10}) {
      std::vector<double> some(before.begin(), before.begin() + static_cast<std::ptrdiff_t>(count));
      HarmonicRotation(rotation).rotate(some);
      const std::size_t whole = count == 10 ? 8 : count;
      for (std::size_t i = 0; i < count; ++i) CHECK(some[i] == (i < whole ? after[i] : before[i]));
    }
  }
}

TEST_CASE("removing points removes their Gaussians, and leaves all others in order and bit by bit") {
  for (unsigned degree = 0; degree <= 3; ++degree) {
    Scene scene(splatBall(degree, 1000));
    for (PointState& point : scene.points) point.gone = point.position.x > 2;
    const SplatFile saved = scene.saved();
    const std::vector<std::size_t> rows = rowsIn(saved, scene.file);
    REQUIRE(rows.size() > 300);
    CHECK(rows.size() < 1200);
    CHECK(saved.names == scene.file.names);
    // Near the surface a Gaussian goes with the nearest point.
    const double spacing = meanSpacing(scene.cloud);
    std::size_t looked = 0;
    for (std::size_t i = 0; i < scene.file.rows.size(); ++i) {
      const double gone = scene.nearest(i, [](const PointState&p) { return p.gone; }),
                   kept = scene.nearest(i, [](const PointState&p) { return !p.gone; });
      if (std::min(gone, kept) > 3.9 * spacing || std::abs(gone - kept) < 1e-4) continue;
      ++looked;
      CHECK((std::ranges::find(rows, i) != rows.end()) == (kept < gone));
    }
    CHECK(looked > 700);
  }
}

TEST_CASE("a part that is taken out and the rest have all Gaussians between them") {
  Scene scene(splatBall(1, 1000, {.floaters = 0.2, .faint = 0.5, .huge = 3}));
  const auto chosen = [&](const PointState& point) { return point.position.y > 3; };
  std::vector<std::string> both;
  for (const bool part : {true, false}) {
    for (PointState& point : scene.points) point.gone = chosen(point) != part;
    const SplatFile saved = scene.saved();
    REQUIRE_FALSE(rowsIn(saved, scene.file).empty());
    both.insert(both.end(), saved.rows.begin(), saved.rows.end());
  }
  std::vector<std::string> all = scene.file.rows;
  std::ranges::sort(all), std::ranges::sort(both);
  CHECK(std::ranges::includes(both, all));
  CHECK(both.size() <= all.size() + 3);  // as many points gone as not around it: it stays with both
}

TEST_CASE("what is far from the surface, as sky is, goes with most of the scene around it") {
  SplatFile file = splatBall(0, 2000, {});
  const std::size_t sky = file.rows.size();
  for (const float z : {60.f, -60.f}) {
    file.rows.push_back(file.rows[0]);
    const std::array<float, 3> center{0, 0, z};
    std::memcpy(file.rows.back().data(), center.data(), sizeof center);
  }
  const auto hasSky = [&](const SplatFile& saved) {
    return std::ranges::count(saved.rows, file.rows[sky]) + std::ranges::count(saved.rows, file.rows[sky + 1]);
  };
  Scene scene(file);
  CHECK(hasSky(scene.saved()) == 2);
  for (PointState& point : scene.points) point.gone = point.position.z > 8;  // the top, nearest to the sky above
  CHECK(hasSky(scene.saved()) == 2);
  for (PointState& point : scene.points) point.gone = point.position.z < 8;  // all but the top
  CHECK(hasSky(scene.saved()) == 0);
}

TEST_CASE("points that move carry their Gaussians along, and change nothing else of the scene") {
  Scene scene(splatBall(2, 2000));
  const DVec3 shift(0.25, -0.5, 0.125);
  for (PointState& point : scene.points)
    if (point.position.z > 6) point.position += Vec3(shift);
  const SplatFile saved = scene.saved();
  REQUIRE(saved.rows.size() == scene.file.rows.size());
  const SplatDifference difference = differenceOf(scene.file, saved);
  CHECK(difference.rows.size() > 300);
  CHECK(difference.columns == std::set<std::string>{"x", "y", "z"});
  const double reach = 4 * meanSpacing(scene.cloud);
  for (const std::size_t i : difference.rows) {
    CHECK(scene.nearest(i, [](const PointState& p) { return p.position.z > 5; }) < reach);
    CHECK(glm::distance(saved.center(i), scene.file.center(i) + shift) < 1e-5);
  }
  for (std::size_t i = 0; i < scene.file.rows.size(); ++i)
    if (scene.nearest(i, [](const PointState& p) { return p.position.z > 5.5; }) > reach)
      CHECK((saved.rows[i] == scene.file.rows[i]));
}

TEST_CASE("a part that is rotated and scaled as a whole takes its Gaussians along, with sizes and harmonics") {
  const DQuat rotation = rotationAbout({1, 2, 0.5}, std::numbers::pi);
  for (const double scale : {1.0, 2.5})
    for (unsigned degree = 0; degree <= 3; ++degree) {
      CAPTURE(degree);
      Scene scene(splatBall(degree, 800, {}));
      const auto isPart = [](const PointState& point) { return point.position.x > -3; };
      std::vector<bool> part;
      for (PointState& point : scene.points) {
        part.push_back(isPart(point));
        if (!part.back()) continue;
        point.position = Vec3(DVec3(5, 6, 7) + scale * (rotation * DVec3(point.position)));
        point.normal = Vec3(rotation * DVec3(point.normal));
      }
      const SplatFile saved = scene.saved();
      REQUIRE(saved.rows.size() == scene.file.rows.size());
      std::size_t looked = 0;
      for (std::size_t i = 0; i < saved.rows.size(); ++i) {
        const double with = scene.nearest(i, [&](const PointState& p) { return part[p.number]; });
        const double without = scene.nearest(i, [&](const PointState& p) { return !part[p.number]; });
        if (with > without) CHECK((saved.rows[i] == scene.file.rows[i]));
        if (with >= without) continue;
        ++looked;
        CHECK(glm::distance(saved.center(i), DVec3(5, 6, 7) + scale * (rotation * scene.file.center(i))) < 1e-4);
        for (const char* name : {"scale_0", "scale_1", "scale_2"})
          CHECK(saved.at(i, name) == within(static_cast<double>(scene.file.at(i, name)) + std::log(scale), 1e-5));
        if (scale == 1) checkSameSeen(scene.file, saved, i, rotation);
      }
      CHECK(looked > 400);
    }
}

TEST_CASE("Gaussians of points that are moved far from their neighbours shift with them, and do not rotate") {
  for (const unsigned every : {3U, 7U, 40U}) {
    CAPTURE(every);
    Scene scene(splatBall(1, 800, {}));
    for (PointState& point : scene.points)
      if (point.number % every == 0) point.position += Vec3(300, 0, 0);
    const SplatFile saved = scene.saved();
    REQUIRE(saved.rows.size() == scene.file.rows.size());
    std::size_t looked = 0;
    for (std::size_t i = 0; i < saved.rows.size(); ++i) {
      const double with = scene.nearest(i, [&](const PointState& p) { return p.number % every == 0; });
      const double without = scene.nearest(i, [&](const PointState& p) { return p.number % every != 0; });
      if (with >= without) continue;
      ++looked;
      CHECK(glm::distance(saved.center(i), scene.file.center(i) + DVec3(300, 0, 0)) < 1e-3);
      checkSameSeen(scene.file, saved, i, {1, 0, 0, 0});
    }
    CHECK(looked > 5);
  }
}

TEST_CASE("where a surface bends its Gaussians rotate with it, each about its own centre") {
  Scene scene(splatBall(1, 2000, {}));
  const auto bent = [](const DVec3& p) { return DVec3(p.x, p.y, p.z + 0.02 * p.x * p.x); };
  for (PointState& point : scene.points) point.position = Vec3(bent(DVec3(point.position)));
  const SplatFile saved = scene.saved();
  std::size_t looked = 0;
  for (std::size_t i = 0; i < saved.rows.size(); ++i) {
    const DVec3 was = scene.file.center(i), normal = glm::normalize(was);
    if (was.z < 9 || std::abs(was.x) < 1) continue;
    ++looked;
    CHECK(glm::distance(saved.center(i), bent(was)) < 0.1);
    // The thin axis is along the normal of the bent surface: that of z = sqrt(100 - x^2 - y^2) + 0.02 x^2.
    const DVec3 now = glm::normalize(DVec3(normal.x / normal.z - 0.04 * was.x, normal.y / normal.z, 1));
    const double before = glm::dot(normal, covarianceOf(scene.file, i) * normal);
    CHECK(glm::dot(now, covarianceOf(saved, i) * now) == within(before, 0.02));
    CHECK(saved.at(i, "scale_0") == scene.file.at(i, "scale_0"));
  }
  CHECK(looked > 50);
}

TEST_CASE("a rigid motion of the scene keeps every Gaussian's covariance and its colour from every side") {
  const DQuat rotation = rotationAbout({0, 0, 1}, std::numbers::pi / 2);
  for (unsigned degree = 0; degree <= 3; ++degree) {
    CAPTURE(degree);
    Scene scene(splatBall(degree, 300));
    const DVec3 from(1, 2, 3), to(-4, 5, 0.5);
    PointCloud moved = scene.cloud;
    moved.storedAs.baggage = movedGaussians(*gaussiansOf(scene.cloud), rotation, from, to);
    const SplatFile saved = scene.saved(moved);
    REQUIRE(saved.rows.size() == scene.file.rows.size());
    for (std::size_t i = 0; i < saved.rows.size(); ++i) {
      CHECK(glm::distance(saved.center(i), to + rotation * (scene.file.center(i) - from)) < 1e-5);
      checkSameSeen(scene.file, saved, i, rotation);
      for (const char* name : {"nx", "ny", "nz", "opacity", "scale_0", "scale_1", "scale_2", "f_dc_0"})
        CHECK(saved.at(i, name) == scene.file.at(i, name));
    }
  }
}

TEST_CASE("paint changes the colour of degree 0 alone, to that of the point") {
  Scene scene(splatBall(3, 1000));
  for (PointState& point : scene.points)
    if (point.position.x > 4) point.color = packedColor(std::array<std::uint8_t, 4>{255, 51, 0, 255});
  const SplatFile saved = scene.saved();
  const SplatDifference difference = differenceOf(scene.file, saved);
  CHECK(difference.rows.size() > 100);
  CHECK(difference.columns == std::set<std::string>{"f"});
  for (const std::size_t i : difference.rows) {
    CHECK(saved.at(i, "f_dc_0") == within(0.5 / 0.28209479177387814, 1e-6));
    CHECK(saved.at(i, "f_dc_1") == within((0.2 - 0.5) / 0.28209479177387814, 1e-6));
    for (std::size_t k = 0; k < 45; ++k)
      CHECK(saved.at(i, fmt::format("f_rest_{}", k)) == scene.file.at(i, fmt::format("f_rest_{}", k)));
  }
}

TEST_CASE("a new point has the Gaussians of its ancestor, no wider than the spacing, behind all others") {
  Scene scene(splatBall(1, 1000));
  std::size_t wide = 0;  // of all that are felt
  for (std::size_t i = 0; i < 1000; ++i)
    if (scene.file.at(i, "scale_0") > scene.file.at(wide, "scale_0")) wide = i;
  const auto distance = [&](const PointState& point) {
    return glm::distance(scene.file.center(wide), scene.cloud.origin + DVec3(point.position));
  };
  const std::uint64_t count = scene.points.size(),
                      parent = std::ranges::min_element(scene.points, {}, distance)->number;
  PointState fresh = scene.points[parent];
  fresh.number = count, fresh.parent = parent;
  fresh.position += Vec3(0, 0, 0.5);
  scene.points.push_back(fresh);
  PointState child = fresh;  // of the new point, and painted
  child.number = count + 1, child.parent = count;
  child.position += Vec3(0, 0, 0.5);
  child.color = packedColor(std::array<std::uint8_t, 4>{255, 0, 0, 255});
  scene.points.push_back(child);
  PointState undone = fresh;
  undone.number = count + 2, undone.gone = true;
  scene.points.push_back(undone);
  const SplatFile saved = scene.saved();
  const std::size_t had = scene.file.rows.size(), added = saved.rows.size() - had;
  REQUIRE(added >= 2);
  REQUIRE(added % 2 == 0);
  for (std::size_t i = 0; i < had; ++i) REQUIRE(saved.rows[i] == scene.file.rows[i]);
  const double widest = std::log(meanSpacing(scene.cloud)) + 1e-5;
  for (std::size_t i = had; i < saved.rows.size(); ++i) {
    const bool isChild = i >= had + added / 2;
    const DVec3 back = saved.center(i) - DVec3(0, 0, isChild ? 1 : 0.5);
    const auto isSource = [&](std::size_t k) { return glm::distance(scene.file.center(k), back) < 1e-5; };
    std::size_t source = 0;
    while (source < had && !isSource(source)) ++source;
    REQUIRE(source < had);
    CHECK(saved.at(i, "opacity") == scene.file.at(source, "opacity"));
    CHECK(saved.at(i, "f_rest_3") == scene.file.at(source, "f_rest_3"));
    CHECK((saved.at(i, "f_dc_0") == scene.file.at(source, "f_dc_0")) == !isChild);
    for (const char* name : {"scale_0", "scale_1", "scale_2"}) CHECK(static_cast<double>(saved.at(i, name)) <= widest);
  }
}

}  // namespace palpate::test::edited_gaussians_test
