#include "engine/contact/contact_step.hpp"

#include <algorithm>

#include "engine/contact/contact_reference.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/scenes.hpp"

namespace palpate::contact_step_test {

namespace {

class ContactFixture : public GpuFixture {
 public:
  using GpuFixture::GpuFixture;

 protected:
  // Replays a path on the GPU and on the reference and compares the results.
  struct Outcome {
    std::size_t ticks = 0, touched = 0, disagreed = 0, neighboursDiffer = 0;
    double worstProxy = 0;  // distance of the proxies, support radii
    double worstNormal_deg = 0;
  };
  static void checkAgrees(const Outcome& outcome) {
    CHECK(outcome.disagreed == 0);
    CHECK(outcome.worstProxy < 1e-4);
    CHECK(outcome.worstNormal_deg < 0.1);
  }
  Outcome compare(const Scene& scene, const std::vector<DVec3>& path, double cell = 0) {
    TouchSide touch(device, scene.cloud, {.radius = scene.radius, .cell = cell});
    ContactReference reference(scene.cloud, scene.radius);
    Outcome outcome;
    for (const DVec3& hip : path) {
      const Pose pose{.hip = hip};
      const Contact gpu = touch.query(pose, 0), cpu = reference.query(pose, 0);
      REQUIRE(gpu.valid);
      ++outcome.ticks;
      outcome.touched += cpu.touching;
      outcome.neighboursDiffer += gpu.neighbours != cpu.neighbours;
      if (gpu.touching != cpu.touching) {
        ++outcome.disagreed;
        continue;
      }
      if (!cpu.touching) CHECK(gpu.proxy == hip);
      outcome.worstProxy = std::max(outcome.worstProxy, glm::distance(gpu.proxy, cpu.proxy) / scene.radius);
      if (glm::length(cpu.normal) > 0 && glm::length(gpu.normal) > 0)
        outcome.worstNormal_deg = std::max(outcome.worstNormal_deg, angleBetween_deg(gpu.normal, cpu.normal));
    }
    touch.finish();
    return outcome;
  }
};

}  // namespace

TEST_CASE_FIXTURE(CoreValidated<ContactFixture>,
                  "GPU contact agrees with the reference over random paths on every shape" * kMoreInFull) {
  for (const std::string_view name : shapeNames()) {
    CAPTURE(name);
    const Scene scene = makeScene(name, 8'000);
    std::vector<DVec3> path;
    for (const std::uint32_t seed : {1u, 2u, 3u}) {
      const auto wandering = wanderingPath(scene, 150, 0.5 * scene.radius, seed);
      for (std::size_t i = 0; i < wandering.size(); i += byTier<std::size_t>(5, 1)) path.push_back(wandering[i]);
      path.push_back(1000.0 * path.back());  // releases contact before the next path
    }
    const Outcome outcome = compare(scene, path);
    CHECK(outcome.touched > outcome.ticks / 5);
    CHECK(outcome.touched < outcome.ticks);
    checkAgrees(outcome);
    CHECK(outcome.neighboursDiffer < outcome.ticks / 20);  // points within rounding of the support radius
  }
}

TEST_CASE_FIXTURE(ContactFixture,
                  "GPU contact agrees with the reference far from the origin and at negative coordinates") {
  for (const DVec3 center : {DVec3(1e6, -2e6, 3e6), DVec3(-700, -700, -700)}) {
    const Scene scene = makeScene("torus", 10'000, center);
    const Outcome outcome = compare(scene, wanderingPath(scene, 150, 0.5 * scene.radius, 5));
    CHECK(outcome.touched > 30);
    checkAgrees(outcome);
  }
}

TEST_CASE_FIXTURE(ContactFixture, "GPU contact agrees with the reference for every cell size down to the smallest") {
  const Scene scene = makeScene("bumpy-sphere", 10'000);
  const auto path = wanderingPath(scene, 100, 0.5 * scene.radius, 4);
  for (const double cell : {smallestCell(scene.radius), 0.5 * scene.radius, 3 * scene.radius, 1000.0}) {
    CAPTURE(cell);
    const Outcome outcome = compare(scene, path, cell);
    checkAgrees(outcome);
  }
}

TEST_CASE_FIXTURE(ContactFixture,
                  "GPU contact agrees with the reference when a support radius overflows shared memory") {
  Scene scene = makeScene("sphere", 20'000);
  scene.radius = 16 * scene.spacing;
  const Outcome outcome = compare(scene, wanderingPath(scene, 60, 0.2 * scene.radius, 4));
  CHECK(outcome.touched > 10);
  checkAgrees(outcome);
}

TEST_CASE_FIXTURE(ContactFixture, "clouds of at most two points are never touched") {
  const auto cloudOf = [](std::size_t count, const Vec3& at) {
    PointCloud cloud;
    cloud.positions.assign(count, at);
    cloud.normals.assign(count, Vec3(0, 0, 1));
    return cloud;
  };
  for (const std::size_t count : {0, 1, 2}) {
    CAPTURE(count);
    const PointCloud cloud = cloudOf(count, Vec3(1, 2, 3));
    TouchSide touch(device, cloud, {.radius = 1});
    for (const double z : {5.0, 3.5, 3.1, 2.9, 2.0}) {
      const Contact contact = touch.query({.hip = {1, 2, z}}, 0);
      CHECK(contact.valid);
      CHECK_FALSE(contact.touching);
    }
  }
}

TEST_CASE_FIXTURE(ContactFixture, "a hundred thousand coincident points form a surface that can be touched") {
  PointCloud cloud;
  cloud.positions.assign(100'000, Vec3(1, 2, 3));
  cloud.normals.assign(100'000, Vec3(0, 0, 1));
  TouchSide touch(device, cloud, {.radius = 1});
  CHECK_FALSE(touch.query({.hip = {1, 2, 3.5}}, 0).touching);
  const Contact contact = touch.query({.hip = {1, 2, 2.8}}, 0);
  CHECK(contact.valid);
  CHECK(contact.touching);
  CHECK(contact.proxy.z == near(3, 1e-5));
}

TEST_CASE_FIXTURE(ContactFixture, "a HIP that starts inside a sphere is not caught on its way out") {
  const Scene scene = makeScene("sphere", 20'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius});
  for (double r = 48; r < 54; r += 0.5) CHECK_FALSE(touch.query({.hip = {0, 0, r}}, 0).touching);
  CHECK(touch.query({.hip = {0, 0, 49}}, 0).touching);
}

TEST_CASE_FIXTURE(ContactFixture, "a fast HIP cannot pass the surface between two ticks") {
  const Scene scene = makeScene("sphere", 20'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius});
  CHECK_FALSE(touch.query({.hip = {0, 0, 70}}, 0).touching);
  const Contact contact = touch.query({.hip = {0, 0, 40}}, 0);
  CHECK(contact.touching);
  CHECK(contact.proxy.z == within(50, 0.1));
}

TEST_CASE_FIXTURE(ContactFixture, "a HIP that is not a number gives an invalid contact, and the next one is valid") {
  const Scene scene = makeScene("sphere", 5'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius});
  CHECK_FALSE(touch.query({.hip = {0, std::nan(""), 0}}, 0).valid);
  CHECK(touch.query({.hip = {0, 0, 60}}, 0).valid);
}

TEST_CASE_FIXTURE(ContactFixture, "the averaged surface of a sphere has its theoretical bias on the GPU") {
  const Scene scene = makeScene("sphere", 50'000);
  TouchSide touch(device, scene.cloud, {.radius = scene.radius});
  const double expected = averageSurfaceBias(scene.radius, 50);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    const DVec3 direction = glm::normalize(DVec3{normal(random), normal(random), normal(random)});
    touch.query({.hip = 53.0 * direction}, 0);
    const Contact contact = touch.query({.hip = 49.0 * direction}, 0);
    REQUIRE(contact.touching);
    CHECK(50.0 - glm::length(contact.proxy) == near(expected, 0.1));
    CHECK(angleBetween_deg(contact.normal, direction) < 0.5);
    for (const double far : {53.0, 500.0})
      touch.query({.hip = far * direction}, 0);  // releases contact, then leaves the support radius of every point
  }
}

}  // namespace palpate::contact_step_test
