#include "engine/io/rgbd_folder.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/io/camera_text.hpp"
#include "engine/io/colmap_model.hpp"
#include "engine/io/image_file.hpp"
#include "engine/io/is_file.hpp"

namespace palpate {

namespace {

/// PrimeSense camera, as assumed by the TUM benchmark and Open3D without calibration.
constexpr DepthCamera kUsualCamera{.width = 640, .height = 480, .fx = 525, .fy = 525, .cx = 319.5, .cy = 239.5};
constexpr double kUsualRate_Hz = 30;

std::filesystem::path ownIntrinsics(const std::filesystem::path& folder) {
  for (const char* name : {"intrinsics.json", "intrinsic.json", "camera_intrinsic.json"})
    if (isFile(folder / name)) return folder / name;
  return {};
}

}  // namespace

bool isRgbdFolder(const std::filesystem::path& path) {
  // A reconstruction may contain a folder of depth.
  return (isTumFolder(path) || isRedwoodFolder(path)) && !isColmapFolder(path);
}

std::string_view rgbdFoldersRead() { return "a TUM folder (with depth.txt) or a Redwood folder (with a folder depth)"; }

RgbdFolder::RgbdFolder(const std::filesystem::path& folder, const RgbdOptions& options, Log* log)
    : isTum_(isTumFolder(folder)), log_(log) {
  if (!isRgbdFolder(folder)) throw FileError(folder, fmt::format("is not {}", rgbdFoldersRead()));
  findCamera(folder, options, log);
  list_ = isTum_ ? listTum(folder) : listRedwood(folder, rate_Hz_);
  if (depthScale_ == 0) depthScale_ = list_.depthScale;
  const auto good = std::ranges::find_if(list_.frames, [](const RgbdFiles& files) { return files.lost.empty(); });
  if (good == list_.frames.end())
    throw FileError(folder, fmt::format("none of its {} frames can be read; the first one: {}", list_.frames.size(),
                                        list_.frames.front().lost));
  if (!isFile(good->depth)) return;
  const ImageSize size = imageSizeOf(good->depth);
  if (size != ImageSize{camera_.width, camera_.height})
    throw FileError(good->depth, fmt::format("has {} x {} pixels, and the camera {} x {}; give the intrinsics of the "
                                             "camera that took it",
                                             size.width, size.height, camera_.width, camera_.height));
}

void RgbdFolder::findCamera(const std::filesystem::path& folder, const RgbdOptions& options, Log* log) {
  camera_ = kUsualCamera;
  rate_Hz_ = kUsualRate_Hz;
  depthScale_ = options.depthScale;
  const std::filesystem::path file = options.intrinsics.empty() ? ownIntrinsics(folder) : options.intrinsics;
  if (file.empty()) {
    if (log)
      log->say("{}: has no intrinsics; assuming {} x {} pixels, focal lengths {} and {}, principal point {}, {}",
               folder.string(), camera_.width, camera_.height, camera_.fx, camera_.fy, camera_.cx, camera_.cy);
    return;
  }
  const CameraText text = readCamera(file);
  camera_ = text.camera;
  if (depthScale_ == 0) depthScale_ = text.depthScale.value_or(0);
  rate_Hz_ = text.rate_Hz.value_or(kUsualRate_Hz);
}

bool RgbdFolder::next(DepthFrame& frame) {
  if (next_ == list_.frames.size()) return false;
  frame.number = next_++;
  const RgbdFiles& files = list_.frames[frame.number];
  frame.time_s = files.time_s;
  if (!files.lost.empty()) throw Error("{}", files.lost);
  read(files, frame);
  return true;
}

void RgbdFolder::read(const RgbdFiles& files, DepthFrame& frame) {
  const GreyImage depth = readGreyImage(files.depth);
  const ImageSize size{camera_.width, camera_.height};
  if (ImageSize{depth.width, depth.height} != size)
    throw FileError(files.depth, fmt::format("has {} x {} pixels, and the camera {} x {}", depth.width, depth.height,
                                             size.width, size.height));
  frame.depth_m.resize(depth.values.size());
  const auto metres = static_cast<float>(1 / depthScale_);
  std::ranges::transform(depth.values, frame.depth_m.begin(),
                         [&](std::uint16_t value) { return static_cast<float>(value) * metres; });
  if (std::ranges::all_of(depth.values, [](std::uint16_t value) { return value == 0; }))
    throw FileError(files.depth, "has no depth at all: each pixel is 0");
  frame.pose = files.pose;
  frame.colors.clear();
  if (files.color.empty()) return;
  ColorImage color = readColorImage(files.color);
  if (ImageSize{color.width, color.height} != size) {
    if (!std::exchange(hasResized_, true) && log_)
      log_->say("{}: has {} x {} pixels; colours are resampled to the {} x {} of depth, pixel by nearest pixel",
                files.color.string(), color.width, color.height, size.width, size.height);
    color = resized(color, size);
  }
  frame.colors = std::move(color.rgb);
}

std::uint64_t RgbdFolder::skipTo(double time_s) {
  const std::size_t before = next_;
  while (next_ + 1 < list_.frames.size() && list_.frames[next_ + 1].time_s <= time_s) ++next_;
  return next_ - before;
}

std::size_t RgbdFolder::poses() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(list_.frames, [](const RgbdFiles& files) { return files.pose.has_value(); }));
}

std::size_t RgbdFolder::colors() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(list_.frames, [](const RgbdFiles& files) { return !files.color.empty(); }));
}

std::optional<UpAxis> RgbdFolder::up() const {
  if (poses() == 0) return UpAxis::minusY;
  DVec3 ups(0);
  for (const RgbdFiles& files : list_.frames)
    if (files.pose) ups += files.pose->turn * DVec3(0, -1, 0);
  // Redwood's world is usually that of the first camera.
  const std::optional<UpAxis> up = upOfCameras(ups / static_cast<double>(poses()));
  return up || isTum_ ? up : UpAxis::minusY;
}

}  // namespace palpate
