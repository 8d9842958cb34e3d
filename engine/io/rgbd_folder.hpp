// Depth cameras that were recorded into a folder of pictures.
#pragma once

#include <filesystem>
#include <memory>
#include <optional>

#include "engine/cloud/up.hpp"
#include "engine/core/depth_stream.hpp"
#include "engine/core/log.hpp"
#include "engine/io/rgbd_list.hpp"

namespace palpate {

/// Whether a path is a folder that RgbdFolder reads.
bool isRgbdFolder(const std::filesystem::path& path);
/// What is read, for messages: "a TUM or Redwood folder (depth.txt, or depth and trajectory.log)".
std::string_view rgbdFoldersRead();

struct RgbdOptions {
  std::filesystem::path intrinsics = {};  ///< JSON (parseCamera()); empty: the folder's own, or else the usual camera's
  double depthScale = 0;                  ///< values per metre; 0: as the intrinsics or the kind of folder say
};

/// Frames of a folder of the TUM benchmark or of Redwood and Open3D (rgbd_list.hpp). A picture is read when its frame
/// is asked for.
class RgbdFolder final : public DepthStream {
 public:
  /// Says to `log` (null: to nobody) what it had to assume. Throws FileError for lists that are wrong, for a folder
  /// none of whose frames may be one, and for pictures that the camera does not have.
  explicit RgbdFolder(const std::filesystem::path& folder, const RgbdOptions& options = {}, Log* log = nullptr);

  const DepthCamera& camera() const override { return camera_; }
  bool next(DepthFrame& frame) override;
  bool isRecorded() const override { return true; }
  void rewind() override { next_ = 0; }
  std::uint64_t skipTo(double time_s) override;
  std::uint64_t frames() const override { return list_.frames.size(); }
  double duration_s() const override { return list_.frames.back().time_s; }

  /// "TUM" or "Redwood".
  std::string_view kind() const { return isTum_ ? "TUM" : "Redwood"; }
  double depthScale() const { return depthScale_; }  ///< values per metre
  std::size_t poses() const;                         ///< frames that have one
  std::size_t colors() const;                        ///< frames that have some
  /// Which way is up in the world of the poses, as far as the cameras were held upright; without poses the camera's.
  std::optional<UpAxis> up() const;

 private:
  void findCamera(const std::filesystem::path& folder, const RgbdOptions& options, Log* log);
  void read(const RgbdFiles& files, DepthFrame& frame);

  bool isTum_;
  DepthCamera camera_;
  double depthScale_ = 0, rate_Hz_ = 0;
  RgbdList list_;
  std::size_t next_ = 0;
  Log* log_;
  bool hasResized_ = false;  // and said so
};

}  // namespace palpate
