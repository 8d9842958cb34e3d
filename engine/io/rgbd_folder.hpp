// Depth cameras recorded into a folder of pictures.
#pragma once

#include <filesystem>
#include <optional>

#include "engine/cloud/up.hpp"
#include "engine/core/depth_stream.hpp"
#include "engine/core/log.hpp"
#include "engine/io/image_file.hpp"
#include "engine/io/rgbd_list.hpp"

namespace palpate {

/// Whether a path is a folder that RgbdFolder reads.
bool isRgbdFolder(const std::filesystem::path& path);
/// Description of the readable folders for messages.
std::string rgbdFoldersRead();

struct RgbdOptions {
  std::filesystem::path intrinsics = {};  ///< readCamera(); empty: the folder's own, else the usual camera's
  double depthScale = 0;                  ///< values per metre; 0: according to the intrinsics or the kind of folder
};

/// Frames of a folder in one of the layouts of rgbd_layout.cpp. Pictures are read when their frame is requested.
class RgbdFolder final : public DepthStream {
 public:
  /// Logs its assumptions (`log` may be null). Throws FileError for invalid lists, for a folder without a valid frame,
  /// and if the size of the pictures differs from the camera's.
  explicit RgbdFolder(const std::filesystem::path& folder, const RgbdOptions& options = {}, Log* log = nullptr);

  const DepthCamera& camera() const override { return camera_; }
  bool next(DepthFrame& frame) override;
  bool isRecorded() const override { return true; }
  void rewind() override { next_ = 0; }
  std::uint64_t skipTo(double time_s) override;
  std::uint64_t frames() const override { return frames_.size(); }
  double duration_s() const override { return frames_.back().time_s; }

  /// Name of the layout: "TUM" and so on.
  std::string_view kind() const { return layout_->name; }
  double depthScale() const { return depthScale_; }  ///< values per metre
  std::size_t poses() const;                         ///< number of frames with a pose
  std::size_t colors() const;                        ///< number of frames with colours
  /// Up axis in the world of the poses, if the cameras were held upright; without poses that of the camera.
  std::optional<UpAxis> up() const;

 private:
  void findCamera(const std::filesystem::path& folder, const RgbdOptions& options, std::optional<ImageSize> size);
  void read(const RgbdFiles& files, DepthFrame& frame);

  const RgbdLayout* layout_;
  DepthCamera camera_;
  double depthScale_ = 0, rate_Hz_ = 30;
  std::vector<RgbdFiles> frames_;
  std::size_t next_ = 0;
  Log* log_;
  bool hasResized_ = false;  // already logged
};

}  // namespace palpate
