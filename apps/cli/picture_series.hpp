// Pictures of a model through moving cameras, as a series of files or as a film.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "apps/cli/context.hpp"
#include "engine/render/camera.hpp"

namespace palpate {

/// Files that one command draws pictures into: a series if there are several.
struct PictureFiles {
  std::string name;  ///< as the user gave it
  std::vector<std::string> each;
};

/// Whether the pictures of a series are joined to a film: .mp4.
bool isFilm(const std::string& output);

/// Checks the output of a series before any work: a film, which requires ffmpeg, or a name with a number, as in
/// turn-%03d.png. Throws UsageError, and Error if ffmpeg is missing or a file exists and --force is not given.
void checkSeries(const Context& context, const std::string& output, std::uint32_t count);

/// The files of a series of `count` pictures. For a film they are in a folder beside it, which is removed with this.
class PictureSeries {
 public:
  PictureSeries(std::string output, std::uint32_t count);
  ~PictureSeries();
  PictureSeries(const PictureSeries&) = delete;
  PictureSeries& operator=(const PictureSeries&) = delete;

  const PictureFiles& files() const { return files_; }
  /// Joins the pictures to the film, if it is one; it appears under its name when it is complete. Throws Error.
  void finish() const;

 private:
  PictureFiles files_;
  std::filesystem::path folder_;  // empty: the pictures are the output
};

/// The outline of what a turntable shows: circles of the model's points about its axis, so that a camera that fits them
/// fits all views. The axis goes along `framing.up` through the middle of what is shown. Relative to the cloud's
/// origin.
PointCloud revolved(const PointCloud& cloud, const Framing& framing);

}  // namespace palpate
