#include "haptics/sharing/ros_points.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <cmath>
#include <cstring>
#include <optional>

#include "engine/cloud/normals.hpp"
#include "engine/cloud/scalar_type.hpp"
#include "haptics/sharing/network.hpp"

namespace palpate {

namespace {

constexpr std::array<RosField, 7> kFields{
    {{"x", 0}, {"y", 4}, {"z", 8}, {"normal_x", 12}, {"normal_y", 16}, {"normal_z", 20}, {"rgb", 24}}};

constexpr std::size_t kMaxFields = 256;

ScalarType scalarOf(std::uint8_t type) { return static_cast<ScalarType>(type - RosField::i8); }

template <class... Args>
[[noreturn]] void refusePoints(fmt::format_string<Args...> text, Args&&... args) {
  throw NetworkError("a PointCloud2 contradicts itself: {}", fmt::format(text, std::forward<Args>(args)...));
}

// Requires that all announced data are present.
void requireWhole(const RosPoints& points) {
  if (points.fields.size() > kMaxFields) refusePoints("its points have {} fields", points.fields.size());
  for (std::size_t i = 0; i < points.fields.size(); ++i) {
    const RosField& field = points.fields[i];
    if (field.type < RosField::i8 || field.type > RosField::f64)
      refusePoints("field {} has type {}", i + 1, field.type);
    const std::uint64_t end = field.offset + std::uint64_t{field.count} * sizeOf(scalarOf(field.type));
    if (end > points.pointStep) refusePoints("field {} ends at byte {} of points of {}", i + 1, end, points.pointStep);
  }
  const std::uint64_t row = std::uint64_t{points.width} * points.pointStep;
  if (points.height == 0 || points.width == 0) return;
  if (row > points.rowStep)
    refusePoints("a row of {} points of {} bytes has {}", points.width, points.pointStep, points.rowStep);
  // Some senders omit the padding behind the last point of the last row.
  const std::uint64_t least = std::uint64_t{points.height - 1} * points.rowStep + row;
  if (least > points.data.size())
    refusePoints("{} bytes of points are announced, and {} there", least, points.data.size());
}

// Reads one field of all points, whatever its type.
class Column {
 public:
  Column(const RosField& field, bool isBigEndian)
      : offset_(field.offset),
        type_(scalarOf(field.type)),
        swaps_(isBigEndian != (std::endian::native == std::endian::big)) {}

  ScalarType type() const { return type_; }
  double value(const std::byte* point) const {
    return visitScalar(type_, [&]<class T>(std::type_identity<T>) { return static_cast<double>(load<T>(point)); });
  }
  template <class T>
  T load(const std::byte* point) const {
    return swaps_ ? loadScalar<T, true>(point + offset_) : loadScalar<T, false>(point + offset_);
  }
  void append(const std::byte* point, std::vector<std::byte>& to) const {
    visitScalar(type_, [&]<class T>(std::type_identity<T>) {
      const T value = load<T>(point);
      const auto* bytes = reinterpret_cast<const std::byte*>(&value);
      to.insert(to.end(), bytes, bytes + sizeof(T));
    });
  }

 private:
  std::uint32_t offset_;
  ScalarType type_;
  bool swaps_;
};

std::optional<Column> columnOf(const RosPoints& points, std::string_view name) {
  for (const RosField& field : points.fields)
    if (field.name == name && field.count == 1) return Column(field, points.isBigEndian);
  return std::nullopt;
}

std::optional<std::array<Column, 3>> vectorOf(const RosPoints& points, std::array<std::string_view, 3> names) {
  const auto x = columnOf(points, names[0]), y = columnOf(points, names[1]), z = columnOf(points, names[2]);
  if (!x || !y || !z || !isFloating(x->type()) || x->type() != y->type() || x->type() != z->type()) return std::nullopt;
  return std::array{*x, *y, *z};
}

DVec3 vectorAt(const std::array<Column, 3>& columns, const std::byte* point) {
  return {columns[0].value(point), columns[1].value(point), columns[2].value(point)};
}

// Four bytes, whether declared as a float or as an integer.
std::optional<Column> colorOf(const RosPoints& points) {
  for (const char* name : {"rgb", "rgba"})
    if (auto column = columnOf(points, name); column && sizeOf(column->type()) == 4) return column;
  return std::nullopt;
}

struct OtherNumbers {
  std::string name;
  Column column;
};

// Fields with names that a file can have, without duplicates; together at most as many bytes as a point has, even if
// fields overlap.
std::vector<OtherNumbers> othersOf(const RosPoints& points) {
  constexpr std::array<std::string_view, 15> kTaken{"x",        "y",   "z",     "normal_x", "normal_y",
                                                    "normal_z", "rgb", "rgba",  "nx",       "ny",
                                                    "nz",       "red", "green", "blue",     "alpha"};
  constexpr std::size_t kLongest = 64;
  std::vector<OtherNumbers> others;
  std::size_t bytes = 0;
  for (const RosField& field : points.fields) {
    const auto isNamed = [&](const auto& other) { return other.name == field.name; };
    const bool isPlain =
        !field.name.empty() && field.name.size() <= kLongest &&
        std::ranges::all_of(field.name, [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
    if (field.count != 1 || !isPlain || std::ranges::count(kTaken, field.name) > 0 ||
        std::ranges::any_of(others, isNamed))
      continue;
    bytes += sizeOf(scalarOf(field.type));
    if (bytes > points.pointStep) break;
    others.push_back({std::string(field.name), Column(field, points.isBigEndian)});
  }
  return others;
}

// Points with a position, one after the other.
class Taking {
 public:
  explicit Taking(const RosPoints& points)
      : points_(points),
        normals_(vectorOf(points, {"normal_x", "normal_y", "normal_z"})),
        color_(colorOf(points)),
        others_(othersOf(points)) {
    const auto places = vectorOf(points, {"x", "y", "z"});
    if (!places)
      throw NetworkError("a PointCloud2 without positions: x, y and z must be float32 or float64, all three the same");
    places_ = *places;
    isWide_ = (*places)[0].type() == ScalarType::f64;
    for (const OtherNumbers& other : others_) cloud_.extra.push_back({.name = other.name, .type = other.column.type()});
  }

  void takeAll() {
    if (points_.width == 0) return;  // however many empty rows are announced
    for (std::uint64_t row = 0; row < points_.height; ++row)
      for (std::uint64_t i = 0; i < points_.width; ++i) {
        const std::size_t before = count();
        take(reinterpret_cast<const std::byte*>(points_.data.data()) + row * points_.rowStep + i * points_.pointStep);
        if (points_.height > 1 && count() > before)
          cells_.push_back(static_cast<std::uint32_t>(row * points_.width + i));
      }
  }

  TakenRosPoints finish(Log* log) {
    if (isWide_) placeOrigin();
    if (!zeroNormals_.empty() && zeroNormals_.size() == cloud_.size()) cloud_.normals.clear();
    if (!cloud_.normals.empty() && !zeroNormals_.empty())
      fillMissingNormals(cloud_, zeroNormals_, "the PointCloud2", log);
    return {.cloud = std::move(cloud_), .skipped = skipped_, .cells = std::move(cells_)};
  }

 private:
  std::size_t count() const { return isWide_ ? cloud_.exactPositions.size() : cloud_.positions.size(); }
  void take(const std::byte* point) {
    constexpr double kLargest = 1e30;  // as in files
    const DVec3 place = vectorAt(*places_, point);
    if (!(std::abs(place.x) + std::abs(place.y) + std::abs(place.z) < kLargest)) {
      ++skipped_;
      return;
    }
    if (isWide_)
      cloud_.exactPositions.push_back(place);
    else
      cloud_.positions.emplace_back(place);
    if (normals_) takeNormal(point);
    if (color_) {
      const auto color = color_->load<std::uint32_t>(point);
      cloud_.colors.push_back({std::uint8_t(color >> 16), std::uint8_t(color >> 8), std::uint8_t(color), 255});
    }
    for (std::size_t k = 0; k < others_.size(); ++k) others_[k].column.append(point, cloud_.extra[k].data);
  }

  void takeNormal(const std::byte* point) {
    const DVec3 normal = vectorAt(*normals_, point);
    const double length = std::hypot(normal.x, normal.y, normal.z);
    const bool isOne = length > 1e-6 && length < 1e30;  // false for NaN, too
    if (!isOne) zeroNormals_.push_back(cloud_.normals.size());
    cloud_.normals.push_back(isOne ? Vec3(normal / length) : Vec3(0));
  }

  void placeOrigin() {
    cloud_.storedAs.position = ScalarType::f64;
    if (cloud_.exactPositions.empty()) return;
    Bounds box{cloud_.exactPositions.front(), cloud_.exactPositions.front()};
    for (const DVec3& place : cloud_.exactPositions) box = {glm::min(box.min, place), glm::max(box.max, place)};
    cloud_.origin = originFor(box);
    for (const DVec3& place : cloud_.exactPositions) cloud_.positions.emplace_back(place - cloud_.origin);
  }

  const RosPoints& points_;
  std::optional<std::array<Column, 3>> places_, normals_;
  std::optional<Column> color_;
  std::vector<OtherNumbers> others_;
  bool isWide_ = false;
  PointCloud cloud_;
  std::vector<std::size_t> zeroNormals_;
  std::vector<std::uint32_t> cells_;
  std::uint64_t skipped_ = 0;
};

}  // namespace

std::span<const RosField> fieldsOfRosPoints() { return kFields; }

std::vector<std::uint8_t> rosDataOf(std::span<const PointState> points, const DVec3& origin, double mm_per_unit) {
  constexpr double kMetresPerMm = 1e-3;
  constexpr std::uint32_t kUnpaintedRgb = kUnpainted[0] << 16 | kUnpainted[1] << 8 | kUnpainted[2];
  static_assert(std::endian::native == std::endian::little, "is_bigendian is false");
  std::vector<std::uint8_t> data(points.size() * kRosPointStep);
  std::uint8_t* to = data.data();
  for (const PointState& point : points) {
    if (point.gone) continue;
    const Vec3 place((origin + DVec3(point.position)) * (mm_per_unit * kMetresPerMm));
    const std::uint32_t c = point.color;  // red in the lowest byte; in ROS blue is
    const std::uint32_t rgb = c == 0 ? kUnpaintedRgb : (c & 0xff) << 16 | (c & 0xff00) | (c >> 16 & 0xff);
    std::memcpy(to, &place, sizeof(place));
    std::memcpy(to + 12, &point.normal, sizeof(point.normal));
    std::memcpy(to + 24, &rgb, sizeof(rgb));
    to += kRosPointStep;
  }
  data.resize(static_cast<std::size_t>(to - data.data()));
  return data;
}

TakenRosPoints takeRosPoints(const RosPoints& points, Log* log) {
  requireWhole(points);
  Taking taking(points);
  taking.takeAll();
  return taking.finish(log);
}

}  // namespace palpate
