#include "engine/io/rgbd_folder.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/io/camera_text.hpp"
#include "engine/io/colmap_model.hpp"
#include "engine/io/file_start.hpp"

namespace palpate {

namespace {

/// Those of the folder itself first, then those that lie beside the folders of several recordings.
constexpr std::array<std::string_view, 10> kIntrinsics{"intrinsics.json",       "intrinsic.json",
                                                       "camera_intrinsic.json", "cam_params.json",
                                                       "intrinsic_depth.txt",   "intrinsic/intrinsic_depth.txt",
                                                       "intrinsics.txt",        "camera-intrinsics.txt",
                                                       "../cam_params.json",    "../camera-intrinsics.txt"};
constexpr std::uint16_t kSaturated = 65535;  // also the mark of 7-Scenes for a pixel without depth

std::filesystem::path ownIntrinsics(const std::filesystem::path& folder) {
  for (const std::string_view name : kIntrinsics)
    if (isFile(folder / name)) return folder / name;
  return {};
}

}  // namespace

bool isRgbdFolder(const std::filesystem::path& path) {
  // A reconstruction may contain a folder of depth.
  return rgbdLayoutOf(path) && !findColmap(path);
}

std::string rgbdFoldersRead() { return "a folder of " + rgbdLayoutsRead(false); }

RgbdFolder::RgbdFolder(const std::filesystem::path& folder, const RgbdOptions& options, Log* log)
    : layout_(rgbdLayoutOf(folder)), log_(log) {
  if (!isRgbdFolder(folder)) throw FileError(folder, fmt::format("is not a folder of {}", rgbdLayoutsRead(true)));
  frames_ = listFrames(folder, *layout_, log);
  const auto isGood = [](const RgbdFiles& files) { return files.lost.empty(); };
  if (std::ranges::none_of(frames_, isGood))
    throw FileError(folder, fmt::format("none of its {} frames can be read; the first one: {}", frames_.size(),
                                        frames_.front().lost));
  const auto first =
      std::ranges::find_if(frames_, [&](const RgbdFiles& files) { return isGood(files) && isFile(files.depth); });
  std::optional<ImageSize> size;
  if (first != frames_.end()) size = imageSizeOf(first->depth);
  findCamera(folder, options, size);
  if (size && *size != ImageSize{camera_.width, camera_.height})
    throw FileError(first->depth, fmt::format("has {} x {} pixels, and the camera {} x {}; give the intrinsics of the "
                                              "camera that took it",
                                              size->width, size->height, camera_.width, camera_.height));
}

void RgbdFolder::findCamera(const std::filesystem::path& folder, const RgbdOptions& options,
                            std::optional<ImageSize> size) {
  CameraText text{.camera = layout_->usualCamera};
  const std::filesystem::path file = options.intrinsics.empty() ? ownIntrinsics(folder) : options.intrinsics;
  if (!file.empty())
    text = readCamera(file, size);
  else if (log_)
    log_->say("{}: has no intrinsics; assuming {} x {} pixels, focal lengths {} and {}, principal point {}, {}",
              folder.string(), text.camera.width, text.camera.height, text.camera.fx, text.camera.fy, text.camera.cx,
              text.camera.cy);
  camera_ = text.camera;
  depthScale_ = options.depthScale > 0 ? options.depthScale : text.depthScale.value_or(layout_->depthScale);
  constexpr double kUsualRate_Hz = 30;
  for (RgbdFiles& frame : frames_)
    if (frame.isNumbered) frame.time_s /= text.rate_Hz.value_or(kUsualRate_Hz);
}

bool RgbdFolder::next(DepthFrame& frame) {
  if (next_ == frames_.size()) return false;
  frame.number = next_++;
  const RgbdFiles& files = frames_[frame.number];
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
  std::ranges::transform(depth.values, frame.depth_m.begin(), [&](std::uint16_t value) {
    return value == kSaturated ? 0.f : static_cast<float>(value) * metres;
  });
  if (std::ranges::all_of(frame.depth_m, [](float value) { return value == 0; }))
    throw FileError(files.depth, fmt::format("has no depth at all: each pixel is 0 or {}", kSaturated));
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
  while (next_ + 1 < frames_.size() && frames_[next_ + 1].time_s <= time_s) ++next_;
  return next_ - before;
}

std::size_t RgbdFolder::poses() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(frames_, [](const RgbdFiles& files) { return files.pose.has_value(); }));
}

std::size_t RgbdFolder::colors() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(frames_, [](const RgbdFiles& files) { return !files.color.empty(); }));
}

std::optional<UpAxis> RgbdFolder::up() const {
  if (poses() == 0) return UpAxis::minusY;
  DVec3 ups(0);
  for (const RgbdFiles& files : frames_)
    if (files.pose) ups += files.pose->turn * DVec3(0, -1, 0);
  if (const auto up = upOfCameras(ups / static_cast<double>(poses()))) return up;
  // The world may be that of the first camera.
  const auto first = std::ranges::find_if(frames_, [](const RgbdFiles& files) { return files.pose.has_value(); });
  constexpr double kSame = 1e-6;
  return std::abs(first->pose->turn.w) > 1 - kSame ? std::optional(UpAxis::minusY) : std::nullopt;
}

}  // namespace palpate
