// Pictures on a GPU with small workgroups.
#include <cmath>

#include "engine/cloud/analytic_shape.hpp"
#include "engine/cloud/spacing.hpp"
#include "tests/labels.hpp"
#include "tests/lost_gpu/lost_gpu.hpp"
#include "tests/render/gaussian_reference.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::small_gpu_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr std::uint32_t kWidth = 96, kHeight = 72;

Camera cameraAt(double distance) {
  Camera camera;
  camera.eye = {0.3 * distance, 0.2 * distance, 0.93 * distance};
  return camera;
}

}  // namespace

TEST_CASE("a GPU with small workgroups draws the same picture") {
  const PointCloud cloud = sampleShape(*makeShape("torus", 100.0, DVec3(0)), {.count = 20'000, .seed = 7});
  const auto pictureOf = [&](Device& device, const Light& light) {
    Frame frame(device, kWidth, kHeight, 2);
    const DrawnCloud drawn(device, cloud);
    CommandList list(device, device.throughputQueue(), "picture");
    list.begin();
    frame.record(list, drawn, cameraAt(250), {.splatRadius = 2 * meanSpacing(cloud), .light = light});
    list.end();
    device.throughputQueue().run(list);
    return frame.readColor();
  };
  const Light all{.material = Material::stone, .occlusion = true, .cavity = true, .ground = true, .eyeDome = true};
  const Image expected = pictureOf(plainDevice(), {}), expectedLight = pictureOf(plainDevice(), all);
  const LostGpuLayer layer(kMinGpu);
  Device small({.gpu = "", .validation = askedCoreValidation()});
  CHECK(pictureOf(small, {}).rgba == expected.rgba);
  CHECK(pictureOf(small, all).rgba == expectedLight.rgba);
  CHECK(small.instance().messages().take().empty());
}

TEST_CASE("a GPU with small workgroups draws the same Gaussians") {
  std::vector<FileGaussian> gaussians;
  for (int k = 0; k < 3'000; ++k)
    gaussians.push_back(
        {.center = DVec3(std::sin(k), std::cos(3 * k), std::sin(2 * k)), .color = DVec3(std::sin(5 * k))});
  PointCloud cloud = sampleShape(*makeShape("sphere", 2.0), {.count = 200});
  cloud.storedAs.baggage = recordsOf(gaussians);
  const auto pictureOf = [&](Device& device) {
    Frame frame(device, kWidth, kHeight, 1);
    const DrawnCloud drawn(device, cloud);
    CommandList list(device, device.throughputQueue(), "picture");
    list.begin();
    frame.record(list, drawn, cameraAt(4), {.gaussians = true});
    list.end();
    device.throughputQueue().run(list);
    return frame.readColor();
  };
  const Image expected = pictureOf(plainDevice());
  const LostGpuLayer layer(kMinGpu);
  Device small({.gpu = "", .validation = askedCoreValidation()});
  CHECK(pictureOf(small).rgba == expected.rgba);
  CHECK(small.instance().messages().take().empty());
}

TEST_SUITE_END();

}  // namespace palpate::small_gpu_test
