#include "engine/io/colmap_model.hpp"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/colmap_rows.hpp"
#include "engine/io/file_start.hpp"

namespace palpate {

namespace {

/// Maps ids to their index in a list; rejects duplicates.
class Ids {
 public:
  void add(const ColmapRows& rows, std::uint32_t id, std::string_view what) {
    if (!places_.emplace(id, static_cast<std::uint32_t>(places_.size())).second)
      rows.fail(fmt::format("{} {} is a duplicate", what, id));
  }
  void add(std::uint32_t id) { places_.emplace(id, static_cast<std::uint32_t>(places_.size())); }
  std::optional<std::uint32_t> find(std::uint32_t id) const {
    const auto found = places_.find(id);
    if (found == places_.end()) return std::nullopt;
    return found->second;
  }

 private:
  std::unordered_map<std::uint32_t, std::uint32_t> places_;
};

DVec3 readPlace(ColmapRows& rows, std::string_view what) {
  DVec3 place;
  for (int k = 0; k < 3; ++k) place[k] = rows.finite(what);
  return place;
}

/// From the world-to-camera rotation and translation.
void placeImage(ColmapRows& rows, ColmapImage& image) {
  double w = rows.finite("the rotation of an image");
  DVec3 v = readPlace(rows, "the rotation of an image");
  const double size = std::sqrt(w * w + glm::dot(v, v));
  if (!(size > 0)) rows.fail("the rotation of an image is zero");
  w /= size;
  v /= size;
  // Rows of the rotation matrix are the camera's axes in the world.
  image.right = {1 - 2 * (v.y * v.y + v.z * v.z), 2 * (v.x * v.y - w * v.z), 2 * (v.x * v.z + w * v.y)};
  image.down = {2 * (v.x * v.y + w * v.z), 1 - 2 * (v.x * v.x + v.z * v.z), 2 * (v.y * v.z - w * v.x)};
  image.forward = {2 * (v.x * v.z - w * v.y), 2 * (v.y * v.z + w * v.x), 1 - 2 * (v.x * v.x + v.y * v.y)};
  const DVec3 t = readPlace(rows, "the position of an image");
  image.center = -(t.x * image.right + t.y * image.down + t.z * image.forward);
}

/// Pinhole intrinsics, pixels. The upper left corner of the picture is at (0, 0).
struct Intrinsics {
  double fx = 0, fy = 0, cx = 0, cy = 0;
};

/// Models with one focal length store it first, then the principal point; models with two store both first.
std::optional<Intrinsics> intrinsicsOf(const ColmapCamera& camera) {
  if (camera.model == "unknown" || camera.model == "EQUIRECTANGULAR") return std::nullopt;  // no focal length first
  const std::vector<double>& p = camera.parameters;
  const bool hasOneFocalLength = camera.model.starts_with("SIMPLE_") || camera.model.starts_with("RADIAL");
  if (p.size() < (hasOneFocalLength ? 3u : 4u) || camera.width == 0 || camera.height == 0) return std::nullopt;
  const Intrinsics found = hasOneFocalLength ? Intrinsics{p[0], p[0], p[1], p[2]} : Intrinsics{p[0], p[1], p[2], p[3]};
  constexpr double kShortest = 1e-3;  // of the picture's side
  const bool isLens = found.fx > kShortest * static_cast<double>(camera.width) &&
                      found.fy > kShortest * static_cast<double>(camera.height);
  return isLens ? std::optional(found) : std::nullopt;
}

/// Intersection of a pixel's ray with the plane one unit in front of the camera: right, and down.
DVec2 onPlane(const ColmapCamera& camera, const Intrinsics& k, double column, double row) {
  constexpr double kWidest = 1.3;  // rad
  const DVec2 place((column - k.cx) / k.fx, (row - k.cy) / k.fy);
  const double off = glm::length(place);
  if (!camera.model.ends_with("FISHEYE") || !(off > 0)) return place;
  return std::tan(std::min(off, kWidest)) / off * place;
}

}  // namespace

namespace {

bool isModel(const std::filesystem::path& path) { return hasColmapFile(path, kPoints) || hasColmapFile(path, kImages); }

/// Folders with a number as their name, in order.
std::vector<std::filesystem::path> numberedModels(const std::filesystem::path& folder) {
  constexpr std::uint64_t kMaxModels = 1000;
  std::vector<std::filesystem::path> models;
  for (std::uint64_t k = 0; k < kMaxModels; ++k) {
    const std::filesystem::path model = folder / std::to_string(k);
    std::error_code ignored;
    if (!std::filesystem::is_directory(model, ignored)) break;
    if (isModel(model)) models.push_back(model);
  }
  return models;
}

std::uint64_t pointsOf(const std::filesystem::path& model) {
  try {
    return openColmap(model, kPoints)->count();
  } catch (const FileError&) {
    return 0;
  }
}

}  // namespace

std::optional<ColmapFolder> findColmap(const std::filesystem::path& path) {
  if (isModel(path)) return ColmapFolder{.path = path, .chosen = {}};
  constexpr std::array<std::string_view, 5> kStems{kCameras, kImages, kPoints, "rigs", "frames"};
  const std::string stem = path.stem().string(), form = path.extension().string();
  if ((form == ".txt" || form == ".bin") && std::ranges::find(kStems, stem) != kStems.end() && isFile(path)) {
    const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
    for (const std::string_view each : {kCameras, kImages, kPoints})
      if (!hasColmapFile(folder, each)) return std::nullopt;
    return ColmapFolder{.path = folder, .chosen = {}};
  }
  if (isModel(path / "sparse")) return ColmapFolder{.path = path / "sparse", .chosen = {}};
  for (const std::filesystem::path& folder : {path / "sparse", path}) {
    const auto models = numberedModels(folder);
    if (models.size() == 1) return ColmapFolder{.path = models.front(), .chosen = {}};
    if (models.empty()) continue;
    std::vector<std::uint64_t> points(models.size());
    std::ranges::transform(models, points.begin(), pointsOf);
    const auto most = std::ranges::max_element(points);
    const std::filesystem::path& largest = models[static_cast<std::size_t>(most - points.begin())];
    return ColmapFolder{.path = largest,
                        .chosen = fmt::format("{} of {} models, with {}", largest.lexically_relative(path).string(),
                                              models.size(), counted(*most, "point"))};
  }
  return std::nullopt;
}

bool hasColmapImages(const std::filesystem::path& folder) { return hasColmapFile(folder, kImages); }

ColmapCounts countColmap(const std::filesystem::path& folder) {
  return {.cameras = openColmap(folder, kCameras)->count(),
          .images = openColmap(folder, kImages)->count(),
          .points = openColmap(folder, kPoints)->count()};
}

namespace {

std::vector<ColmapCamera> readCameras(const std::filesystem::path& folder, std::size_t unknownParameters) {
  std::vector<ColmapCamera> list;
  Ids cameras;
  const auto rows = openColmap(folder, kCameras, {}, unknownParameters);
  while (rows->next()) {
    ColmapCamera& camera = list.emplace_back();
    camera.id = rows->id("the id of a camera");
    cameras.add(*rows, camera.id, "camera");
    const CameraModel& known = rows->cameraModel();
    camera.model = known.name;
    camera.width = rows->whole("the width of a camera's images");
    camera.height = rows->whole("the height of a camera's images");
    const auto hasParameter = [&](std::size_t taken) {
      return known.parameters == kUnknownCount ? rows->hasParameter(taken) : taken < known.parameters;
    };
    while (hasParameter(camera.parameters.size())) camera.parameters.push_back(rows->finite("a parameter of a camera"));
    rows->endRow();
  }
  return list;
}

/// Nothing if the number of parameters of a model cannot be determined.
std::optional<std::vector<ColmapCamera>> readCameras(const std::filesystem::path& folder) {
  constexpr std::size_t kMaxParameters = 32;
  try {
    return readCameras(folder, kUnknownCount);
  } catch (const UnknownModel&) {  // try numbers until the file size is consistent
  }
  for (std::size_t parameters = 0; parameters <= kMaxParameters; ++parameters) try {
      return readCameras(folder, parameters);
    } catch (const FileError&) {  // wrong number
    }
  return std::nullopt;
}

}  // namespace

ColmapModel readColmapImages(const std::filesystem::path& folder) {
  ColmapModel model;
  Ids cameras, images;
  const auto known = readCameras(folder);
  if (known) model.cameras = *known;
  for (std::size_t k = 0; k < model.cameras.size(); ++k) cameras.add(model.cameras[k].id);
  const auto imageRows = openColmap(folder, kImages);
  while (imageRows->next()) {
    ColmapImage& image = model.images.emplace_back();
    image.id = imageRows->id("the id of an image");
    images.add(*imageRows, image.id, "image");
    placeImage(*imageRows, image);
    const std::uint32_t camera = imageRows->id("the camera of an image");
    const auto place = cameras.find(camera);
    if (!place && known)
      imageRows->fail(fmt::format("image {} is of camera {}, which does not exist", image.id, camera));
    if (place) image.camera = *place;
    image.name = imageRows->name();
    imageRows->skipObservations();
  }
  return model;
}

void readColmapPoints(const std::filesystem::path& folder, const ColmapModel& model,
                      const std::function<void(const ColmapPoint&)>& visit,
                      const std::function<void(double)>& progress) {
  std::unordered_map<std::uint32_t, std::uint32_t> images;
  for (const ColmapImage& image : model.images) images.emplace(image.id, static_cast<std::uint32_t>(images.size()));
  const auto rows = openColmap(folder, kPoints, progress);
  ColmapPoint point;
  while (rows->next()) {
    const std::uint64_t id = rows->whole("the id of a point");
    point.position = readPlace(*rows, "the position of a point");
    for (std::uint8_t& channel : point.color) channel = rows->channel();
    point.error = rows->finite("the error of a point");
    point.images.clear();
    for (std::uint64_t left = rows->track(); left > 0; --left) {
      const std::uint32_t image = rows->id("an image that saw a point");
      rows->id("a position in an image");
      const auto found = images.find(image);
      if (found == images.end())
        rows->fail(fmt::format("point {} was seen by image {}, which does not exist", id, image));
      point.images.push_back(found->second);
    }
    rows->endRow();
    visit(point);
  }
}

std::vector<CameraFrustum> frustaOf(const ColmapModel& model) {
  std::vector<CameraFrustum> frusta;
  for (const ColmapImage& image : model.images) {
    if (image.camera == kNoCamera) continue;
    const ColmapCamera& camera = model.cameras[image.camera];
    const auto intrinsics = intrinsicsOf(camera);
    if (!intrinsics) continue;
    const auto width = static_cast<double>(camera.width), height = static_cast<double>(camera.height);
    const auto corner = [&](double column, double row) {
      const DVec2 place = onPlane(camera, *intrinsics, column, row);
      return place.x * image.right + place.y * image.down + image.forward;
    };
    frusta.push_back({.centre = image.center,
                      .corners = {corner(0, 0), corner(width, 0), corner(width, height), corner(0, height)}});
  }
  return frusta;
}

std::optional<UpAxis> upOf(const ColmapModel& model) {
  DVec3 up(0);
  for (const ColmapImage& image : model.images) up -= image.down;
  return upOfCameras(up / std::max(1.0, static_cast<double>(model.images.size())));
}

}  // namespace palpate
