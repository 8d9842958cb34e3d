#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>
#include <span>

#include "engine/cloud/point_tree.hpp"
#include "engine/cloud/view_normals.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/colmap_model.hpp"
#include "engine/io/colmap_reliability.hpp"
#include "engine/io/ply_vertices.hpp"
#include "engine/io/point_batch.hpp"

namespace palpate {

namespace {

PlyElement columns() {
  PlyElement element{.name = "vertex", .count = 0, .properties = {}, .line = 1};
  const auto add = [&](std::initializer_list<const char*> names, ScalarType type) {
    for (const char* name : names) element.properties.push_back({.name = name, .type = type});
  };
  add({"x", "y", "z"}, ScalarType::f64);
  add({"red", "green", "blue"}, ScalarType::u8);
  add({"error"}, ScalarType::f64);
  add({"track_length"}, ScalarType::u32);
  return element;
}

/// Weights of points by track length and projection error: the inverse variance of a mean of that many observations.
std::vector<double> weightsOf(const std::vector<double>& errors, const std::vector<std::uint32_t>& tracks) {
  std::vector<double> known;
  for (const double error : errors)
    if (error > 0) known.push_back(error);
  double usual = 1;
  if (!known.empty()) {
    std::ranges::nth_element(known, known.begin() + static_cast<std::ptrdiff_t>(known.size() / 2));
    usual = known[known.size() / 2];
  }
  std::vector<double> weights(errors.size());
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double relative = errors[i] > 0 ? errors[i] / usual : 1;
    weights[i] = std::max(1u, tracks[i]) / (1 + relative * relative);
  }
  return weights;
}

/// The cameras of a model, for points whose views are unknown.
class CameraPlaces {
 public:
  explicit CameraPlaces(const ColmapModel& model) : model_(model) {
    for (const ColmapImage& image : model.images) centers_.push_back(local(image.center));
    tree_.build(centers_);
  }

  /// Centre of the nearest camera, if possible of one that looks towards the position.
  std::optional<DVec3> nearest(const DVec3& position) const {
    constexpr std::size_t kMaxAsked = 8;
    std::array<std::uint32_t, kMaxAsked> images;
    std::array<double, kMaxAsked> squares;
    const std::size_t count = std::min(kMaxAsked, model_.images.size());
    if (count == 0) return std::nullopt;
    const std::span found = std::span(images).first(
        tree_.nearest(local(position), std::span(images).first(count), std::span(squares).first(count)));
    const auto facing = std::ranges::find_if(found, [&](std::uint32_t k) {
      return glm::dot(model_.images[k].forward, position - model_.images[k].center) > 0;
    });
    return model_.images[facing == found.end() ? found.front() : *facing].center;
  }

 private:
  Vec3 local(const DVec3& place) const { return Vec3(place - model_.images.front().center); }

  const ColmapModel& model_;
  std::vector<Vec3> centers_;
  PointTree tree_;
};

/// Converts rows to a cloud, and collects the input of its normals.
class PointsOfModel {
 public:
  PointsOfModel(const std::filesystem::path& folder, const ColmapModel& model, Log* log)
      : folder_(folder), model_(model), cameras_(model), vertices_(folder, kColumns(), log) {}

  void add(const ColmapPoint& point) {
    put(point.position.x), put(point.position.y), put(point.position.z);
    for (const std::uint8_t channel : point.color) put(channel);
    put(point.error);
    const auto track = static_cast<std::uint32_t>(point.images.size());
    put(track);
    errors_.push_back(point.error);
    tracks_.push_back(track);
    PointSight& sight = sights_.emplace_back();
    for (const std::uint32_t image : point.images) sight.addView(point.position, model_.images[image].center);
    if (const auto eye = point.images.empty() ? cameras_.nearest(point.position) : std::nullopt) {
      sight.addView(point.position, *eye);
      ++untracked_;
    }
    if (++rows_ == kPointBatch) flush();
  }

  PointCloud finish(Log* log) {
    flush();
    PointCloud cloud = vertices_.finish(log);
    const std::vector<double> weights = weightsOf(errors_, tracks_);
    for (std::size_t i = 0; i < sights_.size(); ++i) sights_[i].weight = weights[i];
    std::uint64_t row = 0;
    std::erase_if(sights_, [&](const PointSight&) { return std::ranges::binary_search(vertices_.leftOut(), row++); });
    normalsFromViews(cloud, sights_);
    if (untracked_ > 0 && log)
      log->say("{}: the images that saw {} are unknown; their normals face the nearest camera", folder_.string(),
               counted(untracked_, "point"));
    return cloud;
  }

 private:
  static const PlyElement& kColumns() {
    static const PlyElement element = columns();
    return element;
  }
  template <class T>
  void put(T value) {
    const std::size_t at = packed_.size();
    packed_.resize(at + sizeof value);
    std::memcpy(packed_.data() + at, &value, sizeof value);
  }
  void flush() {
    if (const auto bad = vertices_.append(packed_.data(), rows_, false))
      throw FileError(folder_, fmt::format("point {}: {}", sights_.size() - rows_ + bad->row + 1, bad->what));
    packed_.clear();
    rows_ = 0;
  }

  const std::filesystem::path& folder_;
  const ColmapModel& model_;
  CameraPlaces cameras_;
  PlyVertices vertices_;
  std::vector<std::byte> packed_;
  std::size_t rows_ = 0;
  std::vector<double> errors_;
  std::vector<std::uint32_t> tracks_;
  std::vector<PointSight> sights_;
  std::size_t untracked_ = 0;  // points without a track
};

ColmapFolder modelIn(const std::filesystem::path& path) {
  return findColmap(path).value_or(ColmapFolder{.path = path, .chosen = {}});
}

FileContents contentsOfColmap(const std::filesystem::path& path) {
  const ColmapFolder found = modelIn(path);
  const ColmapCounts counts = countColmap(found.path);
  FileElement vertex{.name = "vertex", .count = counts.points, .properties = {}};
  for (const PlyProperty& property : columns().properties) vertex.properties.push_back({.name = property.name});
  FileContents contents{.elements = {std::move(vertex)}, .comments = {}, .madeFrom = found.chosen};
  contents.elements.push_back({.name = "image", .count = counts.images, .properties = {}});
  contents.elements.push_back({.name = "camera", .count = counts.cameras, .properties = {}});
  return contents;
}

/// `counts`: receives the points that are left out; null: all are kept.
PointCloud cloudOf(const std::filesystem::path& folder, const ColmapModel& model, ReliabilityCounts* counts, Log* log) {
  PointsOfModel points(folder, model, log);
  std::function<void(double)> progress;
  if (log) progress = [&](double share) { log->progress(folder.string(), share); };
  const auto take = [&](const ColmapPoint& point) {
    if (!counts || counts->add(reliabilityOf(point, model))) points.add(point);
  };
  readColmapPoints(folder, model, take, progress);
  return points.finish(log);
}

StoredCloud readColmap(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  const auto [folder, chosen] = modelIn(path);
  if (!chosen.empty() && log) log->say("{}: the largest model is read: {}", path.string(), chosen);
  const ColmapModel model = readColmapImages(folder);
  if (options.normalsFromFaces && log) log->say("{}: has no faces to take normals from", folder.string());
  ReliabilityCounts counts;
  StoredCloud stored{.cloud = cloudOf(folder, model, options.keepUnreliable ? nullptr : &counts, log),
                     .cameras = frustaOf(model)};
  if (counts.isMost()) {
    if (log) log->say("{}: all points are kept, because most would be removed: {}", folder.string(), counts.sentence());
    stored.cloud = cloudOf(folder, model, nullptr, log);
  } else if (counts.leftOut() > 0) {
    stored.leftOut = counts.sentence();
  }
  if (const auto up = upOf(model)) stored.cloud.storedAs.comments.push_back(fmt::format("comment up: {}", nameOf(*up)));
  const auto lose = [&](std::size_t count, std::string_view what) {
    if (count > 0) stored.lost.push_back(counted(count, what));
  };
  lose(model.images.size(), "image");
  lose(model.cameras.size(), "camera");
  if (!stored.cloud.empty()) stored.lost.emplace_back("which images saw each point");
  return stored;
}

}  // namespace

CloudFormat colmapFormat() {
  return {.name = "COLMAP",
          .endings = {},
          .folder = "a COLMAP folder",
          .holds = [](const std::filesystem::path& path) { return findColmap(path).has_value(); },
          .contents = contentsOfColmap,
          .read = readColmap};
}

}  // namespace palpate
