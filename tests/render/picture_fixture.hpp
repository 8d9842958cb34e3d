#pragma once

#include <array>
#include <map>
#include <random>

#include "engine/render/frame.hpp"
#include "tests/gpu_fixture.hpp"

namespace palpate {

/// Draws clouds on the test GPU. Each device has one frame per size for all tests: under validation its pipelines take
/// seconds.
class PictureFixture : public GpuFixture {
 public:
  using GpuFixture::GpuFixture;

 protected:
  Frame& frameOf(std::uint32_t width, std::uint32_t height, std::uint32_t supersample) {
    using Frames = std::map<std::array<std::uint32_t, 3>, Frame>;  // each must be destroyed before its device
    static std::map<const Device*, Frames*> ofDevices;
    Frames*& frames = ofDevices[&device];
    if (!frames) frames = &makeUntilEnd<Frames>();
    return frames->try_emplace({width, height, supersample}, device, width, height, supersample).first->second;
  }
  void draw(Frame& frame, const DrawnCloud& cloud, const Camera& camera, const FrameOptions& options) {
    CommandList list(device, device.throughputQueue(), "test frame");
    list.begin();
    frame.record(list, cloud, camera, options);
    list.end();
    device.throughputQueue().run(list);
  }
  Image picture(const PointCloud& cloud, const Camera& camera, const FrameOptions& options, std::uint32_t width,
                std::uint32_t height, std::uint32_t supersample = 2) {
    Frame& frame = frameOf(width, height, supersample);
    draw(frame, DrawnCloud(device, cloud), camera, options);
    return frame.readColor();
  }
};

/// One point at the origin whose back is seen from +z, and many points beside the picture.
inline PointCloud backBesideCrowd() {
  PointCloud cloud;
  cloud.positions.assign(400'000, Vec3(100, 0, 0));
  cloud.positions.back() = Vec3(0);
  cloud.normals.assign(cloud.size(), Vec3(0, 0, -1));
  cloud.colors.assign(cloud.size(), {200, 100, 60, 255});
  return cloud;
}

/// Random points in a cube of side 2 around `center`, with random normals; every fifth has none.
inline PointCloud strewnCloud(std::size_t count, const Vec3& center = Vec3(0), std::uint32_t seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(-1, 1);
  const auto somewhere = [&] {
    const float z = unit(random), y = unit(random);
    return Vec3(unit(random), y, z);
  };
  PointCloud cloud;
  while (cloud.size() < count) {
    const Vec3 normal = somewhere();
    if (glm::length(normal) > 1 || glm::length(normal) < 0.1f) continue;
    cloud.positions.push_back(center + somewhere());
    cloud.normals.push_back(cloud.size() % 5 == 0 ? Vec3(0) : glm::normalize(normal));
  }
  return cloud;
}

}  // namespace palpate
