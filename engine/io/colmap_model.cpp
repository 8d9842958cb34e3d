#include "engine/io/colmap_model.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <optional>
#include <string_view>
#include <unordered_map>

#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/is_file.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxModelLine = std::size_t{1} << 28;  // an image's observations are one line
constexpr std::size_t kLongestName = 4096;
constexpr std::string_view kBlanks = " \t";

constexpr std::size_t kUnknownCount = ~std::size_t{0};

struct CameraModel {
  std::string_view name;
  std::size_t parameters;
};
/// Indexed by their numbers in binary files (COLMAP 4.1).
constexpr std::array<CameraModel, 18> kCameraModels{{{"SIMPLE_PINHOLE", 3},
                                                     {"PINHOLE", 4},
                                                     {"SIMPLE_RADIAL", 4},
                                                     {"RADIAL", 5},
                                                     {"OPENCV", 8},
                                                     {"OPENCV_FISHEYE", 8},
                                                     {"FULL_OPENCV", 12},
                                                     {"FOV", 5},
                                                     {"SIMPLE_RADIAL_FISHEYE", 4},
                                                     {"RADIAL_FISHEYE", 5},
                                                     {"THIN_PRISM_FISHEYE", 12},
                                                     {"RAD_TAN_THIN_PRISM_FISHEYE", 16},
                                                     {"SIMPLE_DIVISION", kUnknownCount},
                                                     {"DIVISION", kUnknownCount},
                                                     {"SIMPLE_FISHEYE", kUnknownCount},
                                                     {"FISHEYE", kUnknownCount},
                                                     {"EUCM", kUnknownCount},
                                                     {"EQUIRECTANGULAR", kUnknownCount}}};
constexpr CameraModel kUnknownModel{"unknown", kUnknownCount};

/// Thrown for a camera in a binary file whose model has an unknown number of parameters.
struct UnknownModel {
  explicit UnknownModel(std::int32_t which) : number(which) {}
  std::int32_t number;
};

/// The rows of one file, number by number; text and binary files have the same rows in the same order.
class Rows {
 public:
  virtual ~Rows() = default;
  /// Advances to the next row; false after the last.
  virtual bool next() = 0;
  virtual double real(std::string_view what) = 0;
  virtual std::uint64_t whole(std::string_view what) = 0;
  virtual std::uint32_t id(std::string_view what) = 0;
  virtual std::uint8_t channel() = 0;
  virtual const CameraModel& cameraModel() = 0;
  /// Whether a row of a camera with unknown model has another parameter after `taken` ones.
  virtual bool hasParameter(std::size_t taken) = 0;
  virtual std::string name() = 0;
  /// Skips the observations of an image.
  virtual void skipObservations() = 0;
  /// Number of images that saw the point; each id is followed by an index in the image.
  virtual std::uint64_t track() = 0;
  /// Throws if data follows the end of a row.
  virtual void endRow() = 0;
  [[noreturn]] virtual void fail(std::string_view what) const = 0;
  virtual std::uint64_t count() = 0;

  double finite(std::string_view what) {
    const double value = real(what);
    if (!std::isfinite(value)) fail(fmt::format("{} is {}, not a finite number", what, value));
    return value;
  }
};

class BinaryModelRows final : public Rows {
 public:
  /// `unknownParameters`: number of parameters of a camera whose model is unknown.
  BinaryModelRows(const std::filesystem::path& path, std::function<void(double)> progress,
                  std::size_t unknownParameters)
      : file_(path), unknownParameters_(unknownParameters) {
    file_.onProgress(std::move(progress));
    count_ = take<std::uint64_t>("the number of rows");
  }

  bool next() override {
    if (done_ == count_) {
      if (!file_.peek(1).empty()) fail(fmt::format("unexpected data after the last of {} rows", count_));
      return false;
    }
    ++done_;
    return true;
  }
  double real(std::string_view what) override { return take<double>(what); }
  std::uint64_t whole(std::string_view what) override { return take<std::uint64_t>(what); }
  std::uint32_t id(std::string_view what) override { return take<std::uint32_t>(what); }
  std::uint8_t channel() override { return take<std::uint8_t>("a colour"); }
  const CameraModel& cameraModel() override {
    const auto number = take<std::int32_t>("the model of a camera");
    if (number < 0) fail(fmt::format("camera model {}; expected a number of 0 or more", number));
    const auto model = static_cast<std::size_t>(number);
    const CameraModel& known = model < kCameraModels.size() ? kCameraModels[model] : kUnknownModel;
    if (known.parameters == kUnknownCount && unknownParameters_ == kUnknownCount) throw UnknownModel(number);
    return known;
  }
  bool hasParameter(std::size_t taken) override { return taken < unknownParameters_; }
  std::string name() override {
    std::string name;
    while (const char c = take<char>("the name of an image")) {
      if (name.size() == kLongestName) fail(fmt::format("a name of more than {} bytes", kLongestName));
      name += c;
    }
    return name;
  }
  void skipObservations() override {
    constexpr std::uint64_t kBytes = 24, kMax = std::numeric_limits<std::uint64_t>::max() / kBytes;
    const auto count = take<std::uint64_t>("the number of observations");
    if (count > kMax || !file_.skip(kBytes * count))
      fail(fmt::format("the file ends within the {} observations of an image", count));
  }
  std::uint64_t track() override { return take<std::uint64_t>("the length of a track"); }
  void endRow() override {}
  [[noreturn]] void fail(std::string_view what) const override {
    throw FileError::atByte(file_.path(), file_.offset(), what);
  }
  std::uint64_t count() override { return count_; }

 private:
  template <class T>
  T take(std::string_view what) {
    static_assert(std::endian::native == std::endian::little, "the files are little-endian");
    const auto bytes = file_.peek(sizeof(T));
    if (bytes.size() < sizeof(T))
      fail(fmt::format("the file ends where {} should be, in row {} of {}", what, done_, count_));
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    file_.consume(sizeof value);
    return value;
  }

  ChunkedFile file_;
  std::size_t unknownParameters_;
  std::uint64_t count_ = 0, done_ = 0;
};

class TextModelRows final : public Rows {
 public:
  /// `lines`: number of lines per row.
  TextModelRows(const std::filesystem::path& path, std::function<void(double)> progress, unsigned lines)
      : file_(path), lines_(lines) {
    file_.onProgress(std::move(progress));
  }

  bool next() override {
    do {
      const auto line = file_.readLine(kMaxModelLine);
      if (!line) return false;
      rest_ = *line;
    } while (rest_.empty() || rest_.front() == '#');
    return true;
  }
  double real(std::string_view what) override { return number<double>(what); }
  std::uint64_t whole(std::string_view what) override { return number<std::uint64_t>(what); }
  std::uint32_t id(std::string_view what) override { return number<std::uint32_t>(what); }
  std::uint8_t channel() override { return number<std::uint8_t>("a colour from 0 to 255"); }
  const CameraModel& cameraModel() override {
    const std::string_view name = word();
    for (const CameraModel& model : kCameraModels)
      if (model.name == name) return model;
    return kUnknownModel;
  }
  bool hasParameter(std::size_t) override {
    skipBlanks();
    return !rest_.empty();
  }
  std::string name() override {
    skipBlanks();
    std::string name(rest_);
    rest_ = {};
    return name;
  }
  // Observations are on a line of their own, which may be empty.
  void skipObservations() override {
    if (!file_.readLine(kMaxModelLine)) fail("the file ends where the observations of an image should be");
    rest_ = {};
  }
  std::uint64_t track() override {
    std::uint64_t words = 0;
    for (std::string_view all = rest_; !all.empty();) {
      const std::size_t begin = all.find_first_not_of(kBlanks);
      if (begin == all.npos) break;
      ++words;
      all.remove_prefix(std::min(all.find_first_of(kBlanks, begin), all.size()));
    }
    if (words % 2 != 0)
      fail(fmt::format("a track of {} numbers; expected pairs of an image and a position in it", words));
    return words / 2;
  }
  void endRow() override {
    skipBlanks();
    if (!rest_.empty()) fail(fmt::format("{} follows the last number of a row", inQuotes(rest_)));
  }
  [[noreturn]] void fail(std::string_view what) const override {
    throw FileError::atLine(file_.path(), file_.line(), what);
  }
  std::uint64_t count() override {
    std::uint64_t rows = 0;
    for (; next(); ++rows)
      for (unsigned line = 1; line < lines_; ++line) file_.readLine(kMaxModelLine);
    return rows;
  }

 private:
  void skipBlanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(kBlanks), rest_.size())); }
  std::string_view word() {
    skipBlanks();
    const std::string_view found = rest_.substr(0, rest_.find_first_of(kBlanks));
    rest_.remove_prefix(found.size());
    return found;
  }
  template <class T>
  T number(std::string_view what) {
    const std::string_view found = word();
    if (found.empty()) fail(fmt::format("the line ends where {} should be", what));
    const auto value = textNumber<T>(found);
    if (!value) fail(fmt::format("found {}, expected {}", inQuotes(found), what));
    return *value;
  }

  ChunkedFile file_;
  unsigned lines_;
  std::string_view rest_;  // of the line, valid until the next one is read
};

constexpr std::string_view kCameras = "cameras", kImages = "images", kPoints = "points3D";

/// Whether the text or the binary file exists.
bool hasFile(const std::filesystem::path& folder, std::string_view stem) {
  for (const std::string_view form : {"bin", "txt"})
    if (isFile(folder / fmt::format("{}.{}", stem, form))) return true;
  return false;
}

/// Prefers the binary file, as COLMAP does.
std::unique_ptr<Rows> open(const std::filesystem::path& folder, std::string_view stem,
                           std::function<void(double)> progress = {}, std::size_t unknownParameters = kUnknownCount) {
  const std::filesystem::path binary = folder / fmt::format("{}.bin", stem);
  const std::filesystem::path text = folder / fmt::format("{}.txt", stem);
  if (isFile(binary)) return std::make_unique<BinaryModelRows>(binary, std::move(progress), unknownParameters);
  if (isFile(text)) return std::make_unique<TextModelRows>(text, std::move(progress), stem == kImages ? 2 : 1);
  throw FileError(folder, fmt::format("has neither {0}.bin nor {0}.txt, one of which a COLMAP model requires", stem));
}

/// Maps ids to their index in a list; rejects duplicates.
class Ids {
 public:
  void add(const Rows& rows, std::uint32_t id, std::string_view what) {
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

DVec3 readPlace(Rows& rows, std::string_view what) {
  DVec3 place;
  for (int k = 0; k < 3; ++k) place[k] = rows.finite(what);
  return place;
}

/// From the world-to-camera rotation and translation.
void placeImage(Rows& rows, ColmapImage& image) {
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

}  // namespace

bool isColmapFolder(const std::filesystem::path& path) { return hasFile(path, kPoints) || hasFile(path, kImages); }

std::filesystem::path colmapFolderOf(const std::filesystem::path& path) {
  constexpr std::array<std::string_view, 5> kStems{kCameras, kImages, kPoints, "rigs", "frames"};
  const std::string stem = path.stem().string(), form = path.extension().string();
  const bool isPart = (form == ".txt" || form == ".bin") && std::ranges::find(kStems, stem) != kStems.end();
  if (!isPart || !isFile(path)) return path;
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  return hasFile(folder, kCameras) && hasFile(folder, kImages) && hasFile(folder, kPoints) ? folder : path;
}

bool hasColmapImages(const std::filesystem::path& folder) { return hasFile(folder, kImages); }

ColmapCounts countColmap(const std::filesystem::path& folder) {
  return {.cameras = open(folder, kCameras)->count(),
          .images = open(folder, kImages)->count(),
          .points = open(folder, kPoints)->count()};
}

namespace {

std::vector<ColmapCamera> readCameras(const std::filesystem::path& folder, std::size_t unknownParameters) {
  std::vector<ColmapCamera> list;
  Ids cameras;
  const auto rows = open(folder, kCameras, {}, unknownParameters);
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
  const auto imageRows = open(folder, kImages);
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
  const auto rows = open(folder, kPoints, progress);
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

}  // namespace palpate
