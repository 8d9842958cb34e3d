#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "engine/cloud/view_normals.hpp"
#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/colmap_model.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/saving.hpp"

namespace palpate {

namespace {

/// The images that saw each point of a dense reconstruction: the file NAME.ply.vis that COLMAP's stereo fusion writes
/// beside NAME.ply (COLMAP's manual, "Output Format", "Dense Reconstruction").
/// Little-endian: u64 number of points; then for each point u32 number of views, and for each view u32 index of its
/// image in the images file, from 0 (not its id).
struct ColmapViewsOf {
  std::filesystem::path cloud;  ///< the file with these points, for messages
  std::uint64_t points = 0;     ///< number of points in it
  std::uint64_t images = 0;     ///< number of images of the fused model
};

class ViewsFile {
 public:
  ViewsFile(const std::filesystem::path& path, const ColmapViewsOf& what, std::function<void(double)> progress)
      : file_(path), what_(what) {
    file_.onProgress(std::move(progress));
  }

  void readCount() {
    const auto count = take<std::uint64_t>();
    if (!count) fail(file_.offset(), "ends where the number of points should be");
    if (*count != what_.points)
      fail(0, fmt::format("has the views of {} points, and {} has {}", *count, what_.cloud.filename().string(),
                          what_.points));
  }

  /// The result is valid until the next call.
  std::span<const std::uint32_t> readPoint(std::uint64_t point) {
    const std::uint64_t begin = file_.offset();
    const auto count = take<std::uint32_t>();
    if (!count) fail(begin, fmt::format("ends before the views of point {} of {}", point + 1, what_.points));
    images_.clear();
    for (std::uint32_t k = 0; k < *count; ++k) {
      const std::uint64_t at = file_.offset();
      const auto image = take<std::uint32_t>();
      if (!image) fail(begin, fmt::format("ends within the {} views of point {}", *count, point + 1));
      if (*image >= what_.images)
        fail(at, fmt::format("point {} was seen by image {}, counted from 0, and the model has {}", point + 1, *image,
                             what_.images));
      images_.push_back(*image);
    }
    return images_;
  }

  void requireEnd() {
    if (!file_.peek(1).empty()) fail(file_.offset(), "has data after the views of the last point");
  }

 private:
  template <class T>
  std::optional<T> take() {
    static_assert(std::endian::native == std::endian::little, "the files are little-endian");
    const auto bytes = file_.peek(sizeof(T));
    if (bytes.size() < sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    file_.consume(sizeof value);
    return value;
  }

  [[noreturn]] void fail(std::uint64_t byte, const std::string& what) const {
    const std::string cloud = what_.cloud.filename().string();
    throw FileError::atByte(file_.path(), byte,
                            fmt::format("{}; fuse {} again with COLMAP, or remove this file to read it without its "
                                        "views",
                                        what, cloud));
  }

  ChunkedFile file_;
  const ColmapViewsOf& what_;
  std::vector<std::uint32_t> images_;
};

/// Calls `visit` with the number of each point and the images that saw it, in the order of the cloud, and `progress`
/// with the share that was read. Throws FileError, with the byte and what to do, if the number of points differs, if
/// the file is too short or too long, and for images that are not in the model.
void readColmapViews(const std::filesystem::path& file, const ColmapViewsOf& what,
                     const std::function<void(std::uint64_t, std::span<const std::uint32_t>)>& visit,
                     const std::function<void(double)>& progress) {
  ViewsFile views(file, what, progress);
  views.readCount();
  for (std::uint64_t point = 0; point < what.points; ++point) visit(point, views.readPoint(point));
  views.requireEnd();
}

std::filesystem::path viewsBeside(std::filesystem::path cloud) { return cloud += ".vis"; }

bool holdsViews(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored) || !std::filesystem::is_regular_file(viewsBeside(path), ignored))
    return false;
  try {
    return !isOurs(readPlyInfo(path).comments);
  } catch (const FileError&) {  // the reader reports the error
    return false;
  }
}

std::optional<std::filesystem::path> modelBeside(const std::filesystem::path& cloud) {
  const std::filesystem::path own = cloud.has_parent_path() ? cloud.parent_path() : ".";
  for (const std::filesystem::path& folder : {own / "sparse", own})
    if (hasColmapImages(folder)) return folder;
  return std::nullopt;
}

std::vector<PointSight> readSights(const std::filesystem::path& file, const StoredCloud& stored,
                                   const ColmapModel& model, Log* log) {
  const PointCloud& cloud = stored.cloud;
  const std::vector<std::uint64_t>& gone = stored.leftOutRows;
  std::vector<PointSight> sights(cloud.size());
  const std::filesystem::path views = viewsBeside(file);
  std::function<void(double)> progress;
  if (log) progress = [&](double share) { log->progress(views.filename().string(), share); };
  const auto take = [&](std::uint64_t row, std::span<const std::uint32_t> images) {
    const auto before = std::ranges::lower_bound(gone, row);
    if (before != gone.end() && *before == row) return;
    const std::uint64_t point = row - static_cast<std::uint64_t>(before - gone.begin());
    PointSight& sight = sights[point];
    const DVec3 place = cloud.fileCoordinates(point);
    for (const std::uint32_t image : images) sight.addView(place, model.images[image].center);
    sight.weight = static_cast<double>(std::max<std::size_t>(1, images.size()));
  };
  readColmapViews(views, {.cloud = file, .points = cloud.size() + gone.size(), .images = model.images.size()}, take,
                  progress);
  return sights;
}

StoredCloud readDense(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) {
  StoredCloud stored = plyFormat().read(file, log, options);
  const auto folder = modelBeside(file);
  const std::string name = file.filename().string();
  if (!folder) {
    if (log)
      log->say(
          "{}: its views are not used: there is no model (images.bin or images.txt) in 'sparse' beside it, nor in "
          "its own folder",
          name);
    return stored;
  }
  const ColmapModel model = readColmapImages(*folder);
  const std::vector<PointSight> sights = readSights(file, stored, model, log);
  stored.cameras = frustaOf(model);
  std::vector<std::string>& comments = stored.cloud.storedAs.comments;
  if (const auto up = upOf(model); up && !upSaidIn(comments))
    comments.push_back(fmt::format("comment up: {}", nameOf(*up)));
  if (stored.cloud.hasNormals()) {
    const std::size_t turned = faceViews(stored.cloud, sights);
    if (log && turned > 0)
      log->say("{}: {} normals faced away from the images that saw them, and are flipped", name, turned);
  } else if (!stored.cloud.empty()) {
    normalsFromViews(stored.cloud, sights);
    if (log) log->say("{}: has no normals; they face the {} images that saw its points", name, model.images.size());
  }
  if (!stored.cloud.empty()) stored.lost.emplace_back("which images saw each point");
  return stored;
}

}  // namespace

CloudFormat colmapDenseFormat() {
  return {.name = "COLMAP dense",
          .holds = holdsViews,
          .contents = plyFormat().contents,
          .read = readDense,
          .lacks = plyFormat().lacks};
}

}  // namespace palpate
