// Clouds with duplicates, with parts of very different density and with far outliers are felt and meshed as the same
// surface with even points.
#include <fstream>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/io/cloud_formats.hpp"
#include "tests/apps/program.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::uneven_clouds_test {

namespace {

PointCloud sphere(std::size_t count) { return sampleShape(*makeShape("sphere"), {.count = count}); }

void add(PointCloud& cloud, const Vec3& position, const Vec3& normal) {
  cloud.positions.push_back(position);
  cloud.normals.push_back(normal);
}

/// The `k`th copy of all points follows the one before.
PointCloud repeated(const PointCloud& cloud, int copies) {
  PointCloud all;
  for (int copy = 0; copy < copies; ++copy)
    for (std::size_t i = 0; i < cloud.size(); ++i) add(all, cloud.positions[i], cloud.normals[i]);
  return all;
}

PointCloud withOutliers(PointCloud cloud) {
  add(cloud, {1e6f, 0, 0}, {0, 0, 1});
  add(cloud, {0, -3e6f, 1e4f}, {0, 0, 1});
  return cloud;
}

/// Of a sphere of radius 50, the half of negative x has a hundred times the density of the other.
PointCloud unevenHalves() {
  PointCloud cloud;
  for (const auto& [count, side] : {std::pair{200'000, -1}, std::pair{2'000, 1}}) {
    const PointCloud whole = sphere(static_cast<std::size_t>(count));
    for (std::size_t i = 0; i < whole.size(); ++i)
      if ((whole.positions[i].x >= 0) == (side > 0)) add(cloud, whole.positions[i], whole.normals[i]);
  }
  return cloud;
}

class Clouds {
 public:
  void write(const std::string& name, const PointCloud& cloud) const { writeCloud(folder_ / name, cloud); }
  /// A press 3 mm deep along the x axis, held for 0.3 s, and a slide of 10 mm.
  auto touched(const std::string& name, int side, const std::string& options) const {
    std::ofstream(folder_ / "path.csv") << "t_s,x,y,z\n0," << side * 60 << ",0,0\n0.3," << side * 47 << ",0,0\n0.6,"
                                        << side * 47 << ",0,0\n0.9," << side * 46 << ",10,0\n";
    const std::string trace = (folder_ / "trace.csv").string();
    works("touch " + (folder_ / name).string() + " --mm-per-unit 1 --path " + (folder_ / "path.csv").string() +
          " --trace " + trace + " " + options);
    return readTrace(trace);
  }
  auto meshed(const std::string& name) const {
    const std::string json = (folder_ / "mesh.json").string();
    works("mesh " + (folder_ / name).string() + " --mm-per-unit 1 --resolution 24 -o " +
          (folder_ / "mesh.ply").string() + " --json " + json);
    return jsonOf(json);
  }

  Outcome meshSays(const std::string& name, const std::string& options) const {
    return palpate("mesh " + (folder_ / name).string() + " --mm-per-unit 1 --resolution 64 --force " + options +
                   " -o " + (folder_ / "mesh.ply").string());
  }

 private:
  ScratchFolder folder_;
};

}  // namespace

TEST_CASE("fifty points at each position feel and mesh as one") {
  const Clouds clouds;
  clouds.write("one.ply", sphere(3000));
  clouds.write("fifty.ply", repeated(sphere(3000), 50));
  for (const char* backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    const std::string options = std::string("--rate 250 --backend ") + backend;
    const auto one = clouds.touched("one.ply", 1, options), fifty = clouds.touched("fifty.ply", 1, options);
    REQUIRE(one.size() == fifty.size());
    double worst = 0, peak = 0;
    for (std::size_t k = 0; k < one.size(); ++k) {
      worst = std::max(worst, glm::distance(one[k].force, fifty[k].force));
      peak = std::max(peak, glm::length(one[k].force));
    }
    CHECK(peak > 2);
    CHECK(worst < 1e-3);
  }
  const auto one = clouds.meshed("one.ply"), fifty = clouds.meshed("fifty.ply");
  CHECK(one["closed"] == true);
  CHECK(fifty["closed"] == true);
  CHECK(fifty["area_mm2"].get<double>() == near(one["area_mm2"].get<double>(), 1e-4));
  CHECK(fifty["volume_mm3"].get<double>() == near(one["volume_mm3"].get<double>(), 1e-4));
}

TEST_CASE("a cloud whose halves differ a hundredfold in density is felt on both") {
  const Clouds clouds;
  clouds.write("halves.ply", unevenHalves());
  for (const char* backend : {"cpu", "vulkan"})
    for (const int side : {-1, 1}) {
      CAPTURE(backend);
      CAPTURE(side);
      std::size_t touched = 0;
      double worst = 0;
      const auto rows = clouds.touched("halves.ply", side, std::string("--rate 250 --backend ") + backend);
      for (const auto& row : rows) {
        const double depth = 50 - glm::length(row.hip);
        if (depth < 1) continue;  // the sparse half is less round
        touched += row.contact;
        worst = std::max(worst, std::abs(glm::length(row.force) / (0.8 * depth) - 1));
        CHECK(angleBetween_deg(row.force, row.hip) < 8);
      }
      CHECK(touched > 100);
      CHECK(worst < (side < 0 ? 0.15 : 0.4));
    }
}

TEST_CASE(
    "a cloud whose halves differ a hundredfold in density is meshed without holes, or with the radius that is named") {
  const Clouds clouds;
  clouds.write("halves.ply", unevenHalves());
  CHECK(clouds.meshed("halves.ply")["closed"] == true);
  const Outcome open = clouds.meshSays("halves.ply", "");
  CHECK(says(open.text, "open, "));
  const std::string sign = "--radius ";
  const std::size_t at = open.text.rfind(sign);
  REQUIRE(at != open.text.npos);
  const std::string radius = std::to_string(std::stod(open.text.substr(at + sign.size())));
  const Outcome closed = clouds.meshSays("halves.ply", "--radius " + radius);
  CHECK_MESSAGE(says(closed.text, "closed, Euler number 2"), closed.text);
}

TEST_CASE("a mesh leaves out far outliers, as touch does") {
  const Clouds clouds;
  clouds.write("clean.ply", sphere(3000));
  clouds.write("outliers.ply", withOutliers(sphere(3000)));
  const auto clean = clouds.meshed("clean.ply"), far = clouds.meshed("outliers.ply");
  CHECK(far["closed"] == true);
  CHECK(far["vertices"] == clean["vertices"]);
  CHECK(far["volume_mm3"].get<double>() == near(clean["volume_mm3"].get<double>(), 1e-6));
  CHECK(clouds.touched("outliers.ply", 1, "--rate 250 --backend cpu").back().contact);
}

}  // namespace palpate::uneven_clouds_test
