#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "engine/cloud/up.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/ply_vertices.hpp"
#include "engine/io/point_batch.hpp"
#include "engine/io/text_number.hpp"
#include "engine/io/text_words.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxPtxLine = std::size_t{1} << 16;
constexpr std::size_t kPlain = 4, kColored = 7;  // numbers per point
constexpr std::uint64_t kMaxScans = 65535;

/// Pose of a scan: the rows of its matrix; the last one is the translation.
using PtxPlace = std::array<DVec3, 4>;

bool isEcho(const std::array<double, kColored>& point) { return point[0] != 0 || point[1] != 0 || point[2] != 0; }

/// Iterates over the scans of a file.
class PtxScans {
 public:
  explicit PtxScans(const std::filesystem::path& path) : file_(path) {}

  [[noreturn]] void fail(std::string_view what) const { throw file_.errorInLine(what); }
  ChunkedFile& file() { return file_; }
  std::uint64_t scans() const { return scans_; }
  const PtxPlace& place() const { return place_; }

  /// Advances to the next scan; returns its declared number of points, or nothing at the end of the file.
  std::optional<std::uint64_t> next() {
    if (!line()) return std::nullopt;
    if (++scans_ > kMaxScans) fail(fmt::format("more than {} scans", kMaxScans));
    const std::uint64_t columns = count("the number of columns of the scan");
    need("the number of rows of the scan");
    const std::uint64_t rows = count("the number of rows of the scan");
    if (rows > 0 && columns > ~std::uint64_t{0} / rows) fail("a scan of too many points");
    for (int k = 0; k < 4; ++k) numbers<3>("the scanner's position and axes");
    for (DVec3& row : place_) {
      const auto four = numbers<4>("a row of the scan's matrix");
      row = {four[0], four[1], four[2]};
    }
    return columns * rows;
  }

  /// The numbers of the next point. If the first point with an echo has colours, they are NaN where others have none.
  std::array<double, kColored> point(std::uint64_t number, std::uint64_t promised) {
    if (!line()) fail(fmt::format("the file ends after {} of {} points of scan {}", number, promised, scans_));
    const std::size_t found = words_.words().size();
    const bool isRow = found == kPlain || found == kColored;
    std::array<double, kColored> values{};
    std::fill(values.begin() + kPlain, values.end(), std::numeric_limits<double>::quiet_NaN());
    for (std::size_t k = 0; isRow && k < found; ++k) values[k] = value(k, "a number of a point");
    if (columns_ == 0 && isRow && isEcho(values)) columns_ = found;
    if (!isRow || (isEcho(values) && found > columns_))
      fail(fmt::format(
          "a point of {} numbers; expected x y z and an intensity, and colours if the first points have them", found));
    return values;
  }
  bool isColored() const { return columns_ == kColored; }

 private:
  bool line() {
    do {
      const auto text = file_.readLine(kMaxPtxLine);
      words_.clear();
      if (!text) return false;
      words_.split(*text);
    } while (words_.empty());
    return true;
  }
  void need(std::string_view what) {
    if (!line()) fail(fmt::format("the file ends where {} should be", what));
  }
  double value(std::size_t k, std::string_view what) const {
    const auto number = textNumber<double>(words_.words()[k]);
    if (!number) fail(fmt::format("found {}, expected {}", inQuotes(words_.words()[k]), what));
    return *number;
  }
  std::uint64_t count(std::string_view what) const {
    const auto number = words_.words().size() == 1 ? textNumber<std::uint64_t>(words_.words()[0]) : std::nullopt;
    if (!number) fail(fmt::format("found {}, expected {}", inQuotes(words_.words()[0]), what));
    return *number;
  }
  template <std::size_t kCount>
  std::array<double, kCount> numbers(std::string_view what) {
    need(what);
    if (words_.words().size() != kCount)
      fail(fmt::format("found {} numbers, expected {} for {}", words_.words().size(), kCount, what));
    std::array<double, kCount> found;
    for (std::size_t k = 0; k < kCount; ++k) {
      found[k] = value(k, what);
      if (!std::isfinite(found[k])) fail(fmt::format("{} is not a finite number", what));
    }
    return found;
  }

  ChunkedFile file_;
  TextWords words_;
  PtxPlace place_{};
  std::uint64_t scans_ = 0;
  std::size_t columns_ = 0;
};

PlyElement ptxElement(bool colored) {
  PlyElement element{.name = "vertex", .count = 0, .properties = {}, .line = 1};
  const auto add = [&](std::initializer_list<const char*> names, ScalarType type) {
    for (const char* name : names) element.properties.push_back({.name = name, .type = type});
  };
  add({"x", "y", "z", "intensity"}, ScalarType::f64);
  if (colored) add({"red", "green", "blue"}, ScalarType::f32);
  add({"scan"}, ScalarType::u16);
  return element;
}

/// Collects the rows of the cloud.
class PtxCloud {
 public:
  PtxCloud(const std::filesystem::path& path, bool colored, Log* log)
      : colored_(colored), vertices_(path, ptxElement(colored), log) {}

  void add(const std::array<double, kColored>& point, const PtxPlace& place, std::uint64_t scan) {
    const DVec3 at = point[0] * place[0] + point[1] * place[1] + point[2] * place[2] + place[3];
    for (int axis = 0; axis < 3; ++axis) put(at[axis]);
    put(point[3]);
    for (std::size_t k = kPlain; colored_ && k < kColored; ++k) {
      put(static_cast<float>(point[k]));
      whole_ = whole_ && !(point[k] != std::trunc(point[k]));
    }
    put(static_cast<std::uint16_t>(scan));
    if (++rows_ == kPointBatch) flush();
  }
  PlyVertices& finish() {
    flush();
    if (whole_) vertices_.countColorSteps();
    return vertices_;
  }

 private:
  template <class T>
  void put(T value) {
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    packed_.insert(packed_.end(), bytes, bytes + sizeof value);
  }
  void flush() {
    vertices_.append(packed_.data(), rows_, false);  // invalid points are left out
    packed_.clear();
    rows_ = 0;
  }

  bool colored_, whole_ = true;
  PlyVertices vertices_;
  std::vector<std::byte> packed_;
  std::size_t rows_ = 0;
};

FileContents contentsOfPtx(const std::filesystem::path& path) {
  PtxScans scans(path);
  FileElement vertex{.name = "vertex", .count = 0, .properties = {}};
  while (const auto points = scans.next())
    for (std::uint64_t k = 0; k < *points; ++k) vertex.count += isEcho(scans.point(k, *points));
  for (const PlyProperty& property : ptxElement(scans.isColored()).properties)
    if (property.name != "scan" || scans.scans() > 1) vertex.properties.push_back({property.name});
  return {.elements = {std::move(vertex), {.name = "scan", .count = scans.scans(), .properties = {}}}, .comments = {}};
}

StoredCloud readPtx(const std::filesystem::path& path, Log* log, const CloudReadOptions& options) {
  const std::string name = path.filename().string();
  PtxScans scans(path);
  if (log) scans.file().onProgress([&](double share) { log->progress(name, share); });
  if (options.normalsFromFaces && log) log->say("{}: has no faces to take normals from", name);
  std::optional<PtxCloud> cloud;
  std::uint64_t silent = 0, moved = 0;
  while (const auto points = scans.next()) {
    const PtxPlace stays{DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1), DVec3(0)};
    moved += scans.place() != stays;
    for (std::uint64_t k = 0; k < *points; ++k) {
      const auto point = scans.point(k, *points);
      if (!isEcho(point)) {
        ++silent;
        continue;
      }
      if (!cloud) cloud.emplace(path, scans.isColored(), log);
      cloud->add(point, scans.place(), scans.scans() - 1);
    }
  }
  StoredCloud stored;
  if (!cloud) return stored;
  PlyVertices& vertices = cloud->finish();
  stored.cloud = vertices.finish(log);
  stored.lost = vertices.lost();
  if (scans.scans() == 1) std::erase_if(stored.cloud.extra, [](const Attribute& a) { return a.name == "scan"; });
  stored.cloud.storedAs.comments.emplace_back(fmt::format("comment up: {}", nameOf(UpAxis::z)));
  if (silent > 0) stored.lost.push_back(fmt::format("{} without an echo", counted(silent, "point")));
  if (silent > 0 && log) log->warn("{}: {} points are left out, as no echo came back", name, silent);
  if (moved > 0) stored.lost.push_back(fmt::format("the poses of {} scans, which are applied", scans.scans()));
  if (scans.scans() > 0) stored.lost.emplace_back("the grids of the scans");
  return stored;
}

/// Checks the numbers of words in the lines before a scan's points.
bool beginsAsPtx(const FileStart& start) {
  constexpr std::array<std::size_t, 10> kNumbers{1, 1, 3, 3, 3, 3, 4, 4, 4, 4};
  if (!start.isText()) return false;
  const auto lines = start.lines(kNumbers.size());
  for (std::size_t k = 0; k < lines.size(); ++k)
    if (lines[k].size() != kNumbers[k] || !std::ranges::all_of(lines[k], isNumberWord)) return false;
  return lines.size() == kNumbers.size();
}

}  // namespace

CloudFormat ptxFormat() {
  static constexpr std::array<std::string_view, 1> kEndings{".ptx"};
  return {.name = "PTX", .endings = kEndings, .begins = beginsAsPtx, .contents = contentsOfPtx, .read = readPtx};
}

}  // namespace palpate
