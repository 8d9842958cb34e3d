// Every kind of surface on the GPU against double precision.
#include <algorithm>

#include "engine/contact/contact_reference.hpp"
#include "engine/touch/touch_side.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/scenes.hpp"

namespace palpate::surfaces_gpu_test {

namespace {

struct Way {
  SurfaceKind kind;
  bool localRadius;
  double friction;
  double widening = 1;
};

// Wanders over a shape on the GPU and in double precision, and compares the contacts.
void checkAgreement(Device& device, const Way& way, std::string_view shape) {
  CAPTURE(shape);
  CAPTURE(static_cast<int>(way.kind));
  const Scene scene = makeScene(shape, 6'000);
  const double radius = (way.localRadius ? 1.5 * scene.radius : scene.radius) * way.widening;
  TouchSide touch(device, scene.cloud,
                  {.radius = radius,
                   .surface = way.kind,
                   .localRadius = way.localRadius,
                   .widening = way.widening,
                   .friction = way.friction});
  ContactReference reference(
      scene.cloud, {.radius = radius, .kind = way.kind, .localRadius = way.localRadius, .widening = way.widening},
      way.friction);
  std::size_t touched = 0, disagreed = 0;
  double worstProxy = 0, worstNormal_deg = 0;
  for (const DVec3& hip : wanderingPath(scene, 70, 0.4 * scene.radius, 3)) {
    const Contact gpu = touch.query({.hip = hip}, 0), cpu = reference.query({.hip = hip}, 0);
    touched += cpu.touching;
    disagreed += gpu.touching != cpu.touching;
    if (!gpu.touching || !cpu.touching) continue;
    worstProxy = std::max(worstProxy, glm::distance(gpu.proxy, cpu.proxy) / radius);
    worstNormal_deg = std::max(worstNormal_deg, angleBetween_deg(gpu.normal, cpu.normal));
  }
  CHECK(touched > 20);
  CHECK(disagreed == 0);
  CHECK(worstProxy < 1e-4);
  CHECK(worstNormal_deg < 0.1);
  touch.finish();
}

}  // namespace

TEST_CASE_FIXTURE(GpuFixture, "sharp surfaces with a local radius and friction run without validation messages") {
  checkAgreement(device, {SurfaceKind::sharp, true, 0.3}, "torus");
}

TEST_CASE("every kind of surface agrees on the GPU and in double precision") {
  // Each combination is its own shader, which a software driver compiles for half a minute, so these cover every pair
  // of a kind and an option, and of two options. contact_step_test covers the plain sphere.
  for (const Way way : {Way{SurfaceKind::sharp, false, 0.3}, Way{SurfaceKind::average, true, 0.3},
                        Way{SurfaceKind::sharp, true, 0, 1.6}, Way{SurfaceKind::average, false, 0, 1.6},
                        Way{SurfaceKind::sphere, true, 0.3, 1.3}})
    for (const std::string_view shape : {"torus", "cube", "bumpy-sphere"}) checkAgreement(plainDevice(), way, shape);
}

}  // namespace palpate::surfaces_gpu_test
