// Depth images and their camera without a network: both encodings and byte orders, invalid cameras, and inconsistent
// messages.
#include "haptics/sharing/ros_images.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <random>

#include "engine/cloud/grid_normals.hpp"
#include "haptics/sharing/network.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::ros_images_test {

namespace {

constexpr DepthCamera kCamera{.width = 3, .height = 2, .fx = 4, .fy = 5, .cx = 1, .cy = 0.5};

template <class T>
void append(std::vector<std::uint8_t>& to, T value, bool swaps) {
  auto bytes = std::bit_cast<std::array<std::uint8_t, sizeof(T)>>(value);
  if (swaps) std::ranges::reverse(bytes);
  to.insert(to.end(), bytes.begin(), bytes.end());
}

/// An image of the camera's size with two bytes of padding after each row.
struct Picture {
  explicit Picture(std::string_view encoding, bool isBigEndian = false) {
    const bool isWide = encoding == "32FC1";
    says = {.height = 2, .width = 3, .encoding = encoding, .isBigEndian = isBigEndian, .step = isWide ? 14u : 8u};
    for (std::uint16_t row = 0; row < 2; ++row) {
      for (std::uint16_t column = 0; column < 3; ++column) {
        if (isWide)
          append(data, 0.5f + static_cast<float>(3 * row + column), isBigEndian);
        else
          append<std::uint16_t>(data, static_cast<std::uint16_t>(500 + 1000 * (3 * row + column)), isBigEndian);
      }
      if (row == 0) data.resize(data.size() + 2, 0xff);
    }
  }
  std::vector<float> take(double depthScale = 0) {
    says.data = data;
    std::vector<float> depths;
    takeRosDepths(says, kCamera, depthScale, depths);
    return depths;
  }
  std::vector<std::uint8_t> data;
  RosPicture says;
};

RosCalibration calibration() {
  return {.height = 2,
          .width = 3,
          .distortion = "plumb_bob",
          .d = {},
          .k = {4, 0, 1, 0, 5, 0.5, 0, 0, 1},
          .p = {40, 0, 1.5, 0, 0, 50, 0.25, 0, 0, 0, 1, 0}};
}

}  // namespace

TEST_CASE("depths of either encoding and byte order are read in metres") {
  for (const char* encoding : {"16UC1", "mono16", "32FC1"})
    for (const bool isBig : {false, true}) {
      CAPTURE(encoding);
      CAPTURE(isBig);
      CHECK(Picture(encoding, isBig).take() == std::vector<float>{0.5f, 1.5f, 2.5f, 3.5f, 4.5f, 5.5f});
    }
  CHECK(Picture("16UC1").take(5000)[1] == near(0.3, 1e-6));
  CHECK(Picture("32FC1").take(2)[1] == near(0.75, 1e-6));
}

TEST_CASE("pixels without a measurement are 0, however they are marked") {
  Picture picture("32FC1");
  const float infinite = std::numeric_limits<float>::infinity();
  const std::array<float, 3> none{std::numeric_limits<float>::quiet_NaN(), infinite, -1.f};
  std::memcpy(picture.data.data(), none.data(), sizeof none);
  const std::array<float, 3> far{-infinite, 2e5f, 1e5f};
  std::memcpy(picture.data.data() + 14, far.data(), sizeof far);
  CHECK(picture.take() == std::vector<float>{0, 0, 0, 0, 0, 1e5f});
}

TEST_CASE("an image that contradicts itself or the camera is refused with a reason") {
  const auto spoiled = [](const std::function<void(Picture&)>& spoil, const char* encoding = "16UC1") {
    Picture picture(encoding);
    spoil(picture);
    return errorOf<NetworkError>([&] { picture.take(); });
  };
  constexpr std::uint32_t kMax = 0xffffffffu;
  CHECK(spoiled([](Picture& p) { p.data.pop_back(); }) ==
        "an Image contradicts itself: 14 bytes are announced, and 13 there");
  CHECK(spoiled([](Picture& p) { p.says.step = 5; }) == "an Image contradicts itself: a row of 3 pixels has 5 bytes");
  CHECK(spoiled([](Picture& p) { p.says.step = kMax; }).find("bytes are announced") != std::string::npos);
  CHECK(spoiled([](Picture& p) { p.says.width = kMax; }) ==
        "an Image has 4294967295 x 2 pixels, and the camera has 3 x 2");
  CHECK(spoiled([](Picture& p) { p.says.height = 3; }) == "an Image has 3 x 3 pixels, and the camera has 3 x 2");
  CHECK(spoiled([](Picture& p) { p.data.clear(); }, "32FC1").find("and 0 there") != std::string::npos);
  CHECK(spoiled([](Picture& p) { p.says.encoding = "rgb8\x1b"; }) ==
        "an Image of depth must be 16UC1 (millimetres) or 32FC1 (metres), and this one is 'rgb8?'");
}

TEST_CASE("RGB and BGR colours are read pixel by pixel, and other encodings are refused with a reason") {
  std::vector<std::uint8_t> data;
  for (std::uint8_t i = 0; i < 9; ++i) data.push_back(i);
  data.push_back(0xff);  // padding
  for (std::uint8_t i = 9; i < 18; ++i) data.push_back(i);
  RosPicture picture{.height = 2, .width = 3, .encoding = "rgb8", .step = 10, .data = data};
  std::vector<std::array<std::uint8_t, 3>> colors;
  takeRosColors(picture, kCamera, colors);
  REQUIRE(colors.size() == 6);
  CHECK(colors[2] == std::array<std::uint8_t, 3>{6, 7, 8});
  CHECK(colors[3] == std::array<std::uint8_t, 3>{9, 10, 11});
  picture.encoding = "bgr8";
  takeRosColors(picture, kCamera, colors);
  CHECK(colors[0] == std::array<std::uint8_t, 3>{2, 1, 0});
  CHECK(colors[5] == std::array<std::uint8_t, 3>{17, 16, 15});
  const auto refused = [&](auto&& spoil) {
    RosPicture spoilt = picture;
    spoil(spoilt);
    return errorOf<NetworkError>([&] { takeRosColors(spoilt, kCamera, colors); });
  };
  CHECK(says(refused([](RosPicture& p) { p.encoding = "rgba8"; }),
             "of colour must be rgb8 or bgr8, and this one is 'rgba8'"));
  CHECK(says(refused([](RosPicture& p) { p.width = 2; }), "has 2 x 2 pixels, and the camera has 3 x 2"));
  CHECK(says(refused([](RosPicture& p) { p.step = 8; }), "a row of 3 pixels has 8 bytes"));
  CHECK(says(refused([](RosPicture& p) { p.data = p.data.first(18); }), "19 bytes are announced, and 18 there"));
  CHECK(says(refused([](RosPicture& p) { p.step = 0xffffffff; }), "contradicts itself"));
}

TEST_CASE("the camera is K for raw images and P for rectified ones") {
  CHECK(rosCamera(calibration(), false) == kCamera);
  const DepthCamera rectified = rosCamera(calibration(), true);
  CHECK(rectified.fx == 40);
  CHECK(rectified.fy == 50);
  CHECK(rectified.cx == 1.5);
  CHECK(rectified.cy == 0.25);
  CHECK(rosCameraTopic("camera/depth/image_raw") == "camera/depth/camera_info");
  CHECK(rosCameraTopic("image") == "camera_info");
  CHECK(isRectified("camera/depth/image_rect_raw"));
  CHECK_FALSE(isRectified("image_rect/image_raw"));
}

TEST_CASE("an invalid calibration is refused with a reason") {
  const auto spoiled = [](const std::function<void(RosCalibration&)>& spoil, bool rectified = false) {
    RosCalibration given = calibration();
    spoil(given);
    return errorOf<NetworkError>([&] { rosCamera(given, rectified); });
  };
  const std::array<double, 5> bent{0.1, 0, 0, 0, 0}, straight{};
  CHECK(spoiled([&](RosCalibration& c) { c.d = bent; }).find("the lens distorts (plumb_bob)") != std::string::npos);
  CHECK(spoiled([&](RosCalibration& c) { c.d = bent; }, true).empty());
  CHECK(spoiled([&](RosCalibration& c) { c.d = straight; }).empty());
  CHECK(spoiled([](RosCalibration& c) { c.k = {}; }).find("is not calibrated") != std::string::npos);
  CHECK(spoiled([](RosCalibration& c) { c.k[4] = std::nan(""); }).find("is not calibrated") != std::string::npos);
  CHECK(spoiled([](RosCalibration& c) { c.k[2] = 1e300; }).find("is not calibrated") != std::string::npos);
  CHECK(spoiled([](RosCalibration& c) { c.width = 8193; }).find("sides are from 2 to 8192") != std::string::npos);
  CHECK(spoiled([](RosCalibration& c) { c.height = 1; }).find("sides are from 2 to 8192") != std::string::npos);
  CHECK(spoiled([](RosCalibration& c) { c.binningX = 2; }).find("binned") != std::string::npos);
  CHECK(spoiled([](RosCalibration& c) { c.isPart = true; }).find("of a region") != std::string::npos);
}

TEST_CASE("frame times follow the stamps, or the clock if the stamps are unusable") {
  constexpr std::int64_t kSecond = 1'000'000'000;
  RosFrameTimes times;
  CHECK(times.timeOf(1700 * kSecond, 5) == 0);
  CHECK(times.timeOf(1700 * kSecond + kSecond / 10, 5.13) == near(0.1, 1e-6));
  CHECK(times.timeOf(1700 * kSecond + kSecond / 5, 5.2) == near(0.2, 1e-6));
  CHECK(times.timeOf(1000 * kSecond, 5.3) == near(0.3, 1e-6));  // a recording restarts
  CHECK(times.timeOf(1000 * kSecond + kSecond / 10, 5.4) == near(0.4, 1e-6));
  CHECK(times.timeOf(1000 * kSecond + kSecond / 10, 5.5) == near(0.5, 1e-6));  // its time does not advance
  CHECK(times.timeOf(std::numeric_limits<std::int64_t>::max(), 5.6) == near(0.6, 1e-6));
  CHECK(times.timeOf(std::numeric_limits<std::int64_t>::min(), 5.7) == near(0.7, 1e-6));
  const double before_s = times.timeOf(0, 5.8);
  CHECK(times.timeOf(0, 5.8) > before_s);
}

TEST_CASE("normals of a depth grid fit the surface, face the sensor, and do not span edges") {
  std::vector<Vec3> places;
  std::vector<std::uint32_t> cells;
  const DVec3 sensor(10, 0, 0), upright = glm::normalize(DVec3(0.2, 0.1, -1));
  // A slanted plane, its right half hidden by another one at half the distance; one ray hits nothing.
  for (std::uint32_t row = 0; row < 6; ++row)
    for (std::uint32_t column = 0; column < 8; ++column) {
      if (row == 2 && column == 1) continue;
      const DVec3 ray((column - 3.5) * 0.01, (row - 2.5) * 0.01, 1);
      const double far = -2.0 / glm::dot(upright, ray) * (column >= 4 ? 0.5 : 1);
      places.emplace_back(sensor + far * ray);
      cells.push_back(row * 8 + column);
    }
  const std::vector<Vec3> normals = gridNormals(places, {.width = 8, .height = 6, .cells = cells, .sensor = sensor});
  REQUIRE(normals.size() == 47);
  for (std::size_t i = 0; i < normals.size(); ++i) {
    CAPTURE(cells[i]);
    // The first ray of the row with a gap has no neighbour in that row.
    if (cells[i] == 16)
      CHECK(normals[i] == Vec3(0));
    else
      CHECK(glm::distance(DVec3(normals[i]), upright) < 1e-4);
  }
  const std::vector<Vec3> alone =
      gridNormals(std::span(places).first(1), {.width = 8, .height = 6, .cells = std::span(cells).first(1)});
  CHECK(alone[0] == Vec3(0));
  CHECK_THROWS_AS(gridNormals(places, {.width = 3, .height = 2, .cells = cells}), Error);
}

TEST_CASE("random bytes as images and cameras are read or refused") {
  std::mt19937 random(25);
  const auto any = [&](std::uint32_t most) { return static_cast<std::uint32_t>(random() % (most + 1ull)); };
  const auto number = [&](std::uint32_t usual) { return any(9) == 0 ? static_cast<std::uint32_t>(random()) : usual; };
  const auto real = [&](double usual) {
    return any(9) != 0 ? usual : std::bit_cast<double>(std::uint64_t{random()} << 32 | random());
  };
  constexpr std::array<const char*, 5> kEncodings{"16UC1", "32FC1", "mono16", "rgb8", ""};
  std::size_t read = 0, refused = 0, cameras = 0;
  for (int round = 0; round < 20'000; ++round) {
    std::vector<std::uint8_t> data(any(9) == 0 ? any(60) : 40);
    for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
    RosCalibration given = calibration();
    for (double& value : given.k) value = real(value);
    for (double& value : given.p) value = real(value);
    given.width = number(3), given.height = number(2), given.binningX = number(any(1));
    const std::array<double, 2> d{real(0), real(0)};
    given.d = d;
    DepthCamera camera = kCamera;
    try {
      camera = rosCamera(given, any(1) == 1);
      ++cameras;
      const DVec3 place = camera.placeAt(0, camera.height, 1e5);
      REQUIRE(isFinite(Vec3(place)));
    } catch (const NetworkError&) {
      ++refused;
    }
    std::vector<float> depths;
    try {
      takeRosDepths({.height = number(2),
                     .width = number(3),
                     .encoding = kEncodings[any(4)],
                     .isBigEndian = any(1) == 1,
                     .step = number(12 + any(4)),
                     .data = data},
                    camera, real(0), depths);
      ++read;
      REQUIRE(depths.size() == std::size_t{camera.width} * camera.height);
      for (const float depth : depths) REQUIRE((depth >= 0 && depth <= 1e5f));
    } catch (const NetworkError&) {
      ++refused;
      REQUIRE(depths.size() <= data.size());
    }
  }
  CHECK(read > 1000);
  CHECK(refused > 1000);
  CHECK(cameras > 1000);
}

}  // namespace palpate::ros_images_test
