#include "engine/io/known_formats.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/ext/quaternion_double.hpp>
#include <glm/geometric.hpp>

#include "engine/cloud/length_unit.hpp"
#include "engine/cloud/normals.hpp"
#include "engine/cloud/up.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel_collect.hpp"
#include "engine/io/color_scale.hpp"
#include "engine/io/e57_records.hpp"
#include "engine/io/in_quotes.hpp"

namespace palpate {

namespace {

constexpr double kMaxCoordinate = 1e30;
constexpr std::array<const char*, 3> kCartesian{"cartesianX", "cartesianY", "cartesianZ"},
    kSpherical{"sphericalRange", "sphericalAzimuth", "sphericalElevation"},
    kE57Colors{"colorRed", "colorGreen", "colorBlue"}, kE57Normals{"nor:normalX", "nor:normalY", "nor:normalZ"};

using Three = std::array<std::size_t, 3>;

std::optional<std::size_t> fieldNamed(const E57Scan& scan, std::string_view name) {
  const auto found = std::ranges::find(scan.fields, name, &E57Field::name);
  if (found == scan.fields.end() || found->kind == E57Field::Kind::text) return std::nullopt;
  return static_cast<std::size_t>(found - scan.fields.begin());
}

std::optional<Three> fieldsNamed(const E57Scan& scan, const std::array<const char*, 3>& names) {
  Three three{};
  for (std::size_t k = 0; k < 3; ++k) {
    const auto field = fieldNamed(scan, names[k]);
    if (!field) return std::nullopt;
    three[k] = *field;
  }
  return three;
}

/// Points of a scan in the file's coordinates.
class ScanPoints {
 public:
  ScanPoints(const std::filesystem::path& file, const E57Scan& scan, const E57Records& records)
      : scan_(scan),
        records_(records),
        cartesian_(fieldsNamed(scan, kCartesian)),
        spherical_(fieldsNamed(scan, kSpherical)),
        invalid_(fieldNamed(scan, cartesian_ ? "cartesianInvalidState" : "sphericalInvalidState")),
        turn_(glm::dquat(scan.rotation[0], scan.rotation[1], scan.rotation[2], scan.rotation[3])) {
    if (!cartesian_ && !spherical_)
      throw FileError(file, fmt::format("scan {} has no coordinates of its points", inQuotes(scan.name)));
  }

  DVec3 place(std::uint64_t i) const {
    const Three& fields = cartesian_ ? *cartesian_ : *spherical_;
    DVec3 p(records_.value(fields[0], i), records_.value(fields[1], i), records_.value(fields[2], i));
    if (!cartesian_) {  // range, azimuth from x to y, elevation from their plane
      const double along = p.x * std::cos(p.z);
      p = {along * std::cos(p.y), along * std::sin(p.y), p.x * std::sin(p.z)};
    }
    return turn(p) + scan_.translation;
  }
  /// Skipped without rotation: coordinates stay the same, bit by bit.
  DVec3 turn(const DVec3& v) const { return turn_ == glm::dquat(1, 0, 0, 0) ? v : turn_ * v; }
  /// Whether the point has a position: rays without an echo have none.
  bool isThere(std::uint64_t i) const {
    if (invalid_ && records_.value(*invalid_, i) != 0) return false;
    const DVec3 p = place(i);
    return std::abs(p.x) < kMaxCoordinate && std::abs(p.y) < kMaxCoordinate && std::abs(p.z) < kMaxCoordinate;
  }

 private:
  const E57Scan& scan_;
  const E57Records& records_;
  std::optional<Three> cartesian_, spherical_;
  std::optional<std::size_t> invalid_;
  glm::dquat turn_;
};

/// The smallest type that holds all values of a field.
ScalarType typeOf(const E57Field& field) {
  using Kind = E57Field::Kind;
  if (field.kind == Kind::single) return ScalarType::f32;
  if (field.kind != Kind::integer) return ScalarType::f64;
  const auto holds = [&]<class T>(T) {
    return field.least >= std::numeric_limits<T>::min() && field.most <= std::int64_t{std::numeric_limits<T>::max()};
  };
  if (holds(std::uint8_t{})) return ScalarType::u8;
  if (holds(std::uint16_t{})) return ScalarType::u16;
  if (holds(std::int16_t{})) return ScalarType::i16;
  if (holds(std::int32_t{})) return ScalarType::i32;
  if (holds(std::uint32_t{})) return ScalarType::u32;
  return ScalarType::f64;
}

/// Data that all scans have for each point besides its position.
struct Shared {
  bool colors = false, normals = false;
  std::vector<std::string> names;  // of attributes
};

bool isPlace(std::string_view name) {
  return std::ranges::count(kCartesian, name) > 0 || std::ranges::count(kSpherical, name) > 0 ||
         name == "cartesianInvalidState" || name == "sphericalInvalidState";
}

Shared sharedBy(const std::vector<E57Scan>& scans, std::vector<std::string>& lost) {
  Shared shared;
  const auto all = [&](auto&& has) { return !scans.empty() && std::ranges::all_of(scans, has); };
  shared.colors = all([](const E57Scan& scan) { return fieldsNamed(scan, kE57Colors).has_value(); });
  shared.normals = all([](const E57Scan& scan) { return fieldsNamed(scan, kE57Normals).has_value(); });
  std::vector<std::string> seen;
  for (const E57Scan& scan : scans)
    for (const E57Field& field : scan.fields) {
      const std::string& name = field.name;
      if (isPlace(name) || std::ranges::count(seen, name) > 0) continue;
      seen.push_back(name);
      if (shared.colors && std::ranges::count(kE57Colors, name) > 0) continue;
      if (shared.normals && std::ranges::count(kE57Normals, name) > 0) continue;
      if (all([&](const E57Scan& other) { return fieldNamed(other, name).has_value(); }))
        shared.names.push_back(name);
      else
        lost.push_back(field.kind == E57Field::Kind::text
                           ? fmt::format("the text {} of points", inQuotes(name))
                           : fmt::format("{}, which not all scans have", inQuotes(name)));
    }
  return shared;
}

/// Merges all scans into one cloud.
class E57Cloud {
 public:
  E57Cloud(const E57Pages& pages, const std::vector<E57Scan>& scans, std::vector<std::string>& lost)
      : pages_(pages), shared_(sharedBy(scans, lost)), severalScans_(scans.size() > 1) {
    for (const std::string& name : shared_.names) {
      ScalarType type = typeOf(scans[0].fields[*fieldNamed(scans[0], name)]);
      for (const E57Scan& scan : scans)
        if (typeOf(scan.fields[*fieldNamed(scan, name)]) != type) type = ScalarType::f64;
      cloud_.extra.push_back({name, type, {}});
    }
    if (severalScans_) cloud_.extra.push_back({"scan", ScalarType::u16, {}});
  }

  /// Adds a scan; returns the number of its points without a position.
  std::uint64_t add(const E57Scan& scan, std::size_t number) {
    const E57Records records(pages_, scan);
    const ScanPoints points(pages_.file(), scan, records);
    const auto there = parallelCollect(
        scan.points, 0, [&](std::size_t i) { return points.isThere(i); },
        [](std::size_t i) { return std::uint64_t{i}; });
    const std::size_t base = places_.size();
    places_.resize(base + there.size());
    if (shared_.colors) cloud_.colors.resize(places_.size());
    if (shared_.normals) cloud_.normals.resize(places_.size());
    for (Attribute& attribute : cloud_.extra) attribute.data.resize(places_.size() * sizeOf(attribute.type));
    parallelFor(there.size(), 0, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) places_[base + k] = points.place(there[k]);
    });
    if (shared_.colors) addColors(scan, records, there, base);
    if (shared_.normals) addNormals(scan, records, points, there, base);
    for (Attribute& attribute : cloud_.extra) addAttribute(attribute, scan, number, records, there, base);
    return scan.points - there.size();
  }

  PointCloud finish(Log* log) {
    Bounds box{DVec3(0), DVec3(0)};
    for (std::size_t i = 0; i < places_.size(); ++i)
      box = i == 0 ? Bounds{places_[0], places_[0]}
                   : Bounds{glm::min(box.min, places_[i]), glm::max(box.max, places_[i])};
    cloud_.origin = originOf(places_.size(), box, [&](std::size_t i) { return places_[i]; });
    cloud_.positions.resize(places_.size());
    bool same = true;
    for (std::size_t i = 0; i < places_.size(); ++i) {
      cloud_.positions[i] = Vec3(places_[i] - cloud_.origin);
      same = same && DVec3(cloud_.positions[i]) + cloud_.origin == places_[i];
    }
    if (!same) {
      cloud_.exactPositions.assign(places_.begin(), places_.end());
      cloud_.storedAs.position = ScalarType::f64;
    }
    if (shared_.normals) settleNormals(log);
    return std::move(cloud_);
  }

 private:
  void addColors(const E57Scan& scan, const E57Records& records, std::span<const std::uint64_t> there,
                 std::size_t base) {
    const Three fields = *fieldsNamed(scan, kE57Colors);
    std::array<std::array<double, 2>, 3> limits{};
    for (std::size_t k = 0; k < 3; ++k) {
      const E57Field& field = scan.fields[fields[k]];
      const bool whole = field.kind == E57Field::Kind::integer;
      limits[k] =
          whole ? std::array{static_cast<double>(field.least), static_cast<double>(field.most)} : std::array{0.0, 1.0};
      if (scan.colorLimits && (*scan.colorLimits)[k][1] > (*scan.colorLimits)[k][0]) limits[k] = (*scan.colorLimits)[k];
    }
    if (!scan.colorLimits) {  // then determined by the numbers
      ColorScale scale;
      bool whole = true;
      for (std::size_t k = 0; k < 3; ++k) whole = whole && scan.fields[fields[k]].kind == E57Field::Kind::integer;
      for (const std::uint64_t i : there)
        for (const std::size_t field : fields) scale.take(records.value(field, i));
      for (auto& limit : limits)
        if (limit[1] > 255 || !whole) limit = {0, scale.full(whole)};
    }
    parallelFor(there.size(), 0, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        auto& color = cloud_.colors[base + i];
        color[3] = 255;
        for (std::size_t k = 0; k < 3; ++k) {
          const double share = (records.value(fields[k], there[i]) - limits[k][0]) / (limits[k][1] - limits[k][0]);
          color[k] = static_cast<std::uint8_t>(share > 0 ? std::lround(255 * std::min(share, 1.0)) : 0);
        }
      }
    });
  }
  void addNormals(const E57Scan& scan, const E57Records& records, const ScanPoints& points,
                  std::span<const std::uint64_t> there, std::size_t base) {
    const Three fields = *fieldsNamed(scan, kE57Normals);
    parallelFor(there.size(), 0, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        DVec3 normal;
        for (int k = 0; k < 3; ++k) normal[k] = records.value(fields[static_cast<std::size_t>(k)], there[i]);
        normal = points.turn(normal);
        const double length = glm::length(normal);
        cloud_.normals[base + i] = length > 1e-6 && std::isfinite(length) ? Vec3(normal / length) : Vec3(0);
      }
    });
  }
  void addAttribute(Attribute& attribute, const E57Scan& scan, std::size_t number, const E57Records& records,
                    std::span<const std::uint64_t> there, std::size_t base) {
    const bool isNumber = severalScans_ && &attribute == &cloud_.extra.back();
    const std::size_t field = isNumber ? 0 : *fieldNamed(scan, attribute.name);
    visitScalar(attribute.type, [&]<class T>(std::type_identity<T>) {
      parallelFor(there.size(), 0, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          const T value = static_cast<T>(isNumber ? static_cast<double>(number) : records.value(field, there[i]));
          std::memcpy(attribute.data.data() + (base + i) * sizeof(T), &value, sizeof value);
        }
      });
    });
  }
  void settleNormals(Log* log) {
    std::vector<std::size_t> missing;
    for (std::size_t i = 0; i < cloud_.normals.size(); ++i)
      if (cloud_.normals[i] == Vec3(0)) missing.push_back(i);
    if (!missing.empty()) fillMissingNormals(cloud_, missing, pages_.file().filename().string(), log);
  }

  const E57Pages& pages_;
  Shared shared_;
  bool severalScans_;
  std::vector<DVec3> places_;
  PointCloud cloud_;
};

FileContents contentsOfE57(const std::filesystem::path& file) {
  const E57Pages pages(file, nullptr);
  const E57Contents contents = readE57Contents(pages);
  FileContents known;
  FileElement vertex{.name = "vertex", .count = 0, .properties = {}};
  for (const E57Scan& scan : contents.scans) {
    vertex.count += scan.points;
    for (const E57Field& field : scan.fields)
      if (std::ranges::find(vertex.properties, field.name, &FileElement::Property::name) == vertex.properties.end())
        vertex.properties.push_back({field.name});
  }
  known.elements.push_back(std::move(vertex));
  known.elements.push_back({.name = "scan", .count = contents.scans.size(), .properties = {}});
  return known;
}

StoredCloud readE57(const std::filesystem::path& file, Log* log, const CloudReadOptions& options) {
  constexpr std::size_t kMaxScans = 65535;
  const E57Pages pages(file, log);
  const E57Contents contents = readE57Contents(pages);
  const std::string name = file.filename().string();
  if (contents.scans.size() > kMaxScans)
    throw FileError(file, fmt::format("{} scans; at most {} are read", contents.scans.size(), kMaxScans));
  if (options.normalsFromFaces && log) log->say("{}: has no faces to take normals from", name);
  StoredCloud stored;
  E57Cloud cloud(pages, contents.scans, stored.lost);
  std::uint64_t invalid = 0;
  for (std::size_t k = 0; k < contents.scans.size(); ++k) invalid += cloud.add(contents.scans[k], k);
  stored.cloud = cloud.finish(log);
  stored.cloud.storedAs.comments.emplace_back(fmt::format("comment up: {}", nameOf(UpAxis::z)));
  sayUnit(stored.cloud.storedAs.comments, LengthUnit::m);  // as defined by the format
  if (invalid > 0) stored.lost.push_back(fmt::format("{} without coordinates", counted(invalid, "point")));
  if (invalid > 0 && log) log->warn("{}: {} points have no coordinates (no echo) and are skipped", name, invalid);
  const auto isPlaced = [](const E57Scan& scan) {
    return scan.rotation != std::array<double, 4>{1, 0, 0, 0} || scan.translation != DVec3(0);
  };
  const auto placed = std::ranges::count_if(contents.scans, isPlaced);
  if (placed == 1)
    stored.lost.emplace_back("the pose of a scan, which is applied");
  else if (placed > 1)
    stored.lost.push_back(fmt::format("the poses of {} scans, which are applied", placed));
  for (const E57Scan& scan : contents.scans)
    if (std::abs(scan.rotationLength - 1) > 1e-3)
      stored.lost.push_back(fmt::format("the length {:.3g} of the rotation of scan {}, which counts as 1",
                                        scan.rotationLength, inQuotes(scan.name)));
  if (contents.images > 0) stored.lost.push_back(fmt::format("{} pictures", contents.images));
  return stored;
}

}  // namespace

CloudFormat e57Format() {
  static constexpr std::array<std::string_view, 1> kEndings{".e57"};
  return {.name = "E57",
          .endings = kEndings,
          .begins = [](const FileStart& start) { return start.startsWith("ASTM-E57"); },
          .contents = contentsOfE57,
          .read = readE57};
}

}  // namespace palpate
