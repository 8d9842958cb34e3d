#include "engine/io/colmap_dense_format.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "engine/cloud/view_normals.hpp"
#include "engine/core/error.hpp"
#include "engine/io/colmap_frusta.hpp"
#include "engine/io/colmap_model.hpp"
#include "engine/io/colmap_views.hpp"
#include "engine/io/ply_format.hpp"
#include "engine/io/ply_header.hpp"
#include "engine/io/saving.hpp"

namespace palpate {

namespace {

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
