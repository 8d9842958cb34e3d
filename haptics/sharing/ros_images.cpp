#include "haptics/sharing/ros_images.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "engine/cloud/scalar_type.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate {

namespace {

constexpr std::uint32_t kLongestSide = 8192;  // pixels, as for images in files
constexpr double kFarthest_m = 1e5;
constexpr std::string_view kCameraTopic = "camera_info";

struct Encoding {
  std::string_view name;
  ScalarType type;
  double valuesPerMetre;
};
constexpr std::array<Encoding, 3> kEncodings{
    {{"16UC1", ScalarType::u16, 1000}, {"mono16", ScalarType::u16, 1000}, {"32FC1", ScalarType::f32, 1}}};

template <class... Args>
[[noreturn]] void refuseImage(fmt::format_string<Args...> text, Args&&... args) {
  throw NetworkError("an Image {}", fmt::format(text, std::forward<Args>(args)...));
}

// Foreign text for messages: characters that a terminal does not show are replaced.
std::string shown(std::string_view text) {
  constexpr std::size_t kMax = 40;
  std::string plain(text.substr(0, kMax));
  for (char& c : plain)
    if (c < ' ' || c > '~') c = '?';
  return plain;
}

const Encoding& encodingOf(const RosPicture& picture) {
  const auto* const found = std::ranges::find(kEncodings, picture.encoding, &Encoding::name);
  if (found == kEncodings.end())
    refuseImage("of depth must be 16UC1 (millimetres) or 32FC1 (metres), and this one is '{}'",
                shown(picture.encoding));
  return *found;
}

void requireWhole(const RosPicture& picture, const DepthCamera& camera, std::size_t bytes) {
  if (picture.width != camera.width || picture.height != camera.height)
    refuseImage("has {} x {} pixels, and the camera has {} x {}", picture.width, picture.height, camera.width,
                camera.height);
  const std::uint64_t row = std::uint64_t{picture.width} * bytes;
  if (row > picture.step)
    refuseImage("contradicts itself: a row of {} pixels has {} bytes", picture.width, picture.step);
  const std::uint64_t least = std::uint64_t{picture.height - 1} * picture.step + row;
  if (least > picture.data.size())
    refuseImage("contradicts itself: {} bytes are announced, and {} there", least, picture.data.size());
}

template <class T, bool swaps>
void takeRows(const RosPicture& picture, double metres, std::vector<float>& depth_m) {
  for (std::size_t row = 0, i = 0; row < picture.height; ++row) {
    const auto* from = reinterpret_cast<const std::byte*>(picture.data.data()) + row * picture.step;
    for (std::uint32_t column = 0; column < picture.width; ++column, from += sizeof(T)) {
      const double depth = static_cast<double>(loadScalar<T, swaps>(from)) * metres;
      depth_m[i++] = depth > 0 && depth <= kFarthest_m ? static_cast<float>(depth) : 0.f;
    }
  }
}

}  // namespace

std::string rosCameraTopic(const std::string& pictures) {
  const std::size_t slash = pictures.find_last_of('/');
  return (slash == std::string::npos ? "" : pictures.substr(0, slash + 1)) + std::string(kCameraTopic);
}

bool isRectified(const std::string& pictures) {
  const std::string_view name = std::string_view(pictures).substr(pictures.find_last_of('/') + 1);
  return name.starts_with("image_rect");
}

DepthCamera rosCamera(const RosCalibration& calibration, bool isRectified) {
  const auto refuseImage = [](const std::string& why) { throw NetworkError("a CameraInfo {}", why); };
  const bool distorts = std::ranges::any_of(calibration.d, [](double value) { return value != 0; });
  if (distorts && !isRectified)
    refuseImage(fmt::format("says that the lens distorts ({}); use rectified images: a topic image_rect",
                            shown(calibration.distortion)));
  if (calibration.binningX > 1 || calibration.binningY > 1 || calibration.isPart)
    refuseImage("is of binned images, or of a region; only whole images are supported");
  const auto isSide = [](std::uint32_t side) { return side >= 2 && side <= kLongestSide; };
  if (!isSide(calibration.width) || !isSide(calibration.height))
    refuseImage(fmt::format("is of {} x {} pixels; sides are from 2 to {}", calibration.width, calibration.height,
                            kLongestSide));
  const std::array<double, 9>& k = calibration.k;
  const std::array<double, 12>& p = calibration.p;
  const DepthCamera camera{.width = calibration.width,
                           .height = calibration.height,
                           .fx = isRectified ? p[0] : k[0],
                           .fy = isRectified ? p[5] : k[4],
                           .cx = isRectified ? p[2] : k[2],
                           .cy = isRectified ? p[6] : k[5]};
  // A camera that sees a millionth of a degree, or all around, is not valid; ROS marks a missing calibration by 0.
  const auto isFocal = [](double pixels) { return pixels > 1e-2 && pixels < 1e7; };
  if (!isFocal(camera.fx) || !isFocal(camera.fy) || !(std::abs(camera.cx) < 1e7) || !(std::abs(camera.cy) < 1e7))
    refuseImage(fmt::format("has focal lengths of {} and {} pixels, about {}, {}: the camera is not calibrated",
                            camera.fx, camera.fy, camera.cx, camera.cy));
  return camera;
}

void takeRosDepths(const RosPicture& picture, const DepthCamera& camera, double depthScale,
                   std::vector<float>& depth_m) {
  const Encoding& encoding = encodingOf(picture);
  requireWhole(picture, camera, sizeOf(encoding.type));
  depth_m.resize(std::size_t{picture.width} * picture.height);
  const double metres = 1 / (depthScale > 0 ? depthScale : encoding.valuesPerMetre);
  const bool swaps = picture.isBigEndian != (std::endian::native == std::endian::big);
  if (encoding.type == ScalarType::u16)
    swaps ? takeRows<std::uint16_t, true>(picture, metres, depth_m)
          : takeRows<std::uint16_t, false>(picture, metres, depth_m);
  else
    swaps ? takeRows<float, true>(picture, metres, depth_m) : takeRows<float, false>(picture, metres, depth_m);
}

void takeRosColors(const RosPicture& picture, const DepthCamera& camera,
                   std::vector<std::array<std::uint8_t, 3>>& colors) {
  const bool isBgr = picture.encoding == "bgr8";
  if (!isBgr && picture.encoding != "rgb8")
    refuseImage("of colour must be rgb8 or bgr8, and this one is '{}'", shown(picture.encoding));
  constexpr std::size_t kBytes = 3;
  requireWhole(picture, camera, kBytes);
  colors.resize(std::size_t{picture.width} * picture.height);
  for (std::size_t row = 0, i = 0; row < picture.height; ++row) {
    const std::uint8_t* from = picture.data.data() + row * picture.step;
    for (std::uint32_t column = 0; column < picture.width; ++column, from += kBytes)
      colors[i++] = {from[isBgr ? 2 : 0], from[1], from[isBgr ? 0 : 2]};
  }
}

double RosFrameTimes::timeOf(std::int64_t stamp_ns, double arrived_s) {
  constexpr double kMaxLate_s = 0.5;  // maximum deviation between two frames that the network causes
  const double waited_s = std::max(arrived_s - arrived_s_, 1e-6);
  // In integers, since stamps may be far apart: they are of the wall clock, or of anything else.
  const std::uint64_t step_ns = static_cast<std::uint64_t>(stamp_ns) - static_cast<std::uint64_t>(stamp_ns_);
  const double step_s = stamp_ns > stamp_ns_ ? static_cast<double>(step_ns) * 1e-9 : 0;
  if (hasBegun_) time_s_ += step_s > 0 && std::abs(step_s - waited_s) < kMaxLate_s ? step_s : waited_s;
  hasBegun_ = true;
  stamp_ns_ = stamp_ns;
  arrived_s_ = arrived_s;
  return time_s_;
}

}  // namespace palpate
