#include "engine/io/ply_vertices.hpp"

#include <algorithm>
#include <cmath>

#include <glm/common.hpp>

#include "engine/cloud/normals.hpp"
#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "engine/io/color_scale.hpp"
#include "engine/io/column_names.hpp"

namespace palpate {
namespace {

constexpr double kFarthest = 1e30;  // squares of distances must stay finite in double, offsets in float

static_assert(sizeof(Vec3) == 3 * sizeof(float) && sizeof(DVec3) == 3 * sizeof(double));

/// Whether single precision holds every value of the type.
bool fitsFloat(ScalarType type) { return sizeOf(type) < 4 || type == ScalarType::f32; }

bool isFiniteBelow(double value, double most) { return std::abs(value) < most; }

/// "z is nan; expected finite numbers": of the first one that is not finite, or else of the largest one.
std::string numberNotTaken(const DVec3& numbers, const std::array<const char*, 3>& names) {
  int worst = 0;
  for (int k = 2; k >= 0; --k)
    if (!std::isfinite(numbers[k]) ||
        (std::isfinite(numbers[worst]) && std::abs(numbers[k]) >= std::abs(numbers[worst])))
      worst = k;
  return fmt::format("{} is {}; expected finite numbers", names[static_cast<std::size_t>(worst)], numbers[worst]);
}

/// Writes one column of `rows` to `to`, `step` values apart.
template <class T, bool kSwap, class Out, class Convert>
void scatter(const std::byte* from, std::size_t rowBytes, std::size_t count, Out* to, std::size_t step,
             Convert&& convert) {
  for (std::size_t r = 0; r < count; ++r, from += rowBytes, to += step) *to = convert(loadScalar<T, kSwap>(from));
}

}  // namespace

PlyVertices::PlyVertices(const std::filesystem::path& file, const PlyElement& vertex, Log* log, BadRows badRows)
    : file_(file), badRows_(badRows) {
  for (const PlyProperty& property : vertex.properties) {
    if (property.isList) {
      if (log) log->warn("{}: the vertex list property '{}' is not kept", file.filename().string(), property.name);
      continue;
    }
    columns_.push_back({rowBytes_, property.type, Role::extra, 0, property.name});
    rowBytes_ += sizeOf(property.type);
  }
  for (const std::string_view name : {"x", "y", "z"}) {
    if (named(name) == columns_.end()) {
      throw FileError::atLine(
          file, vertex.line,
          fmt::format("the vertex element has no scalar property '{}'; points need x, y and z", name));
    }
  }
  assignGroup(Role::position, {"x", "y", "z"});
  hasNormals_ = assignGroup(Role::normal, {"nx", "ny", "nz"});
  hasColors_ = assignGroup(Role::color, {"red", "green", "blue", "alpha"}) ||
               assignGroup(Role::color, {"diffuse_red", "diffuse_green", "diffuse_blue", "alpha"}) ||
               assignGroup(Role::color, {"r", "g", "b", "a"});
  for (Column& column : columns_) {
    if (column.role != Role::extra) continue;
    column.index = cloud_.extra.size();
    cloud_.extra.push_back({column.name, column.type, {}});
  }
}

/// The column of that name; else the first one whose name matches case-insensitively, or is an alias.
std::vector<PlyVertices::Column>::iterator PlyVertices::named(std::string_view name) {
  auto found = std::ranges::find(columns_, name, &Column::name);
  const auto lower = [](std::string text) {
    for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
    return text;
  };
  if (found == columns_.end())
    found = std::ranges::find_if(columns_, [&](const Column& c) { return lower(c.name) == name; });
  if (found == columns_.end())
    found = std::ranges::find_if(columns_, [&](const Column& c) { return sharedColumnName(c.name) == name; });
  return found;
}

/// Assigns `role` to the columns of these names if the first three exist; a fourth is optional.
bool PlyVertices::assignGroup(Role role, std::initializer_list<std::string_view> names) {
  for (std::size_t k = 0; k < 3; ++k)
    if (named(names.begin()[k]) == columns_.end()) return false;
  StoredAs& stored = cloud_.storedAs;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto column = named(names.begin()[k]);
    if (column == columns_.end()) continue;
    column->role = role;
    column->index = k;
    const ScalarType type = column->type;
    if (role == Role::position && !fitsFloat(type)) wide_ = true;
    if (role == Role::normal && type == ScalarType::f64) stored.normal = type;
    if (role == Role::color && type != ScalarType::u8) rawColors_ = true;
    if (role == Role::color && isFloating(type)) wholeColors_ = false, stored.color = type;
    if (k == 3) stored.alpha = true;
  }
  if (wide_) stored.position = ScalarType::f64;
  return true;
}

void PlyVertices::reserve(std::uint64_t promised) {
  constexpr std::uint64_t kMaxRows = std::uint64_t{1} << 27;  // a sparse file may be long without containing data
  const auto rows = static_cast<std::size_t>(std::min(promised, kMaxRows));
  if (wide_) cloud_.exactPositions.reserve(rows);
  if (!wide_) cloud_.positions.reserve(rows);
  if (hasNormals_) cloud_.normals.reserve(rows);
  if (hasColors_ && rawColors_) raw_.reserve(rows);
  if (hasColors_ && !rawColors_) cloud_.colors.reserve(rows);
  for (Attribute& attribute : cloud_.extra) attribute.data.reserve(rows * sizeOf(attribute.type));
}

std::optional<PlyVertices::BadRow> PlyVertices::append(const std::byte* rows, std::size_t count, bool swapBytes) {
  if (count == 0) return std::nullopt;  // there is no first row to report
  const std::size_t base = count_;
  resize(count_ + count);
  for (const Column& column : columns_) {
    visitScalar(column.type, [&]<class T>(std::type_identity<T>) {
      if (swapBytes)
        appendColumn<T, true>(column, rows, base, count);
      else
        appendColumn<T, false>(column, rows, base, count);
    });
  }
  rows_ += count;
  if (badRows_ == BadRows::leaveOut)
    leaveOutBadRows(base);
  else if (auto bad = checkPositions(base))
    return bad;
  return normalise(base);
}

void PlyVertices::resize(std::size_t count) {
  count_ = count;
  if (wide_) cloud_.exactPositions.resize(count);
  if (!wide_) cloud_.positions.resize(count);
  if (hasNormals_) cloud_.normals.resize(count);
  if (hasColors_ && rawColors_) raw_.resize(count);
  if (hasColors_ && !rawColors_) cloud_.colors.resize(count, {0, 0, 0, 255});
  for (Attribute& attribute : cloud_.extra) attribute.data.resize(count * sizeOf(attribute.type));
}

/// Checks the rows from `base` on, which are the last ones read so far.
void PlyVertices::leaveOutBadRows(std::size_t base) {
  std::size_t kept = base;
  for (std::size_t i = base; i < count_; ++i) {
    const DVec3 p = wide_ ? cloud_.exactPositions[i] : DVec3(cloud_.positions[i]);
    if (!isFiniteBelow(std::abs(p.x) + std::abs(p.y) + std::abs(p.z), kFarthest)) {
      leftOut_.push_back(rows_ - (count_ - i));
      continue;
    }
    if (kept < i) moveRow(i, kept);
    ++kept;
  }
  if (kept < count_) resize(kept);
}

void PlyVertices::moveRow(std::size_t from, std::size_t to) {
  if (wide_) cloud_.exactPositions[to] = cloud_.exactPositions[from];
  if (!wide_) cloud_.positions[to] = cloud_.positions[from];
  if (hasNormals_) cloud_.normals[to] = cloud_.normals[from];
  if (hasColors_ && rawColors_) raw_[to] = raw_[from];
  if (hasColors_ && !rawColors_) cloud_.colors[to] = cloud_.colors[from];
  for (Attribute& attribute : cloud_.extra) {
    const std::size_t bytes = sizeOf(attribute.type);
    std::memcpy(attribute.data.data() + to * bytes, attribute.data.data() + from * bytes, bytes);
  }
}

std::vector<std::string> PlyVertices::lost() const {
  std::vector<std::string> lost = lostPoints();
  if (hasFineColors_) lost.emplace_back("colours finer than 8 bits a channel");
  return lost;
}

std::vector<std::string> PlyVertices::lostPoints() const {
  std::vector<std::string> lost;
  if (!leftOut_.empty())
    lost.push_back(fmt::format("{} without a finite position below 1e30", counted(leftOut_.size(), "point")));
  if (darkColors_ > 0)
    lost.push_back(fmt::format("colours of {} that are not numbers, which are black", counted(darkColors_, "point")));
  return lost;
}

template <class T, bool kSwap>
void PlyVertices::appendColumn(const Column& column, const std::byte* rows, std::size_t base, std::size_t count) {
  const std::byte* from = rows + column.offset;
  const auto toFloat = [](T value) { return static_cast<float>(value); };
  const auto toDouble = [](T value) { return static_cast<double>(value); };
  auto* colorBytes = reinterpret_cast<std::uint8_t*>(cloud_.colors.data() + (hasColors_ && !rawColors_ ? base : 0));
  auto* rawColors = reinterpret_cast<float*>(raw_.data() + (hasColors_ && rawColors_ ? base : 0));
  switch (column.role) {
    case Role::position:
      if (wide_)
        scatter<T, kSwap>(from, rowBytes_, count, &cloud_.exactPositions[base].x + column.index, 3, toDouble);
      else
        scatter<T, kSwap>(from, rowBytes_, count, &cloud_.positions[base].x + column.index, 3, toFloat);
      break;
    case Role::normal:
      scatter<T, kSwap>(from, rowBytes_, count, &cloud_.normals[base].x + column.index, 3, toFloat);
      break;
    case Role::color:
      // Some programs declare unsigned bytes with a signed type.
      if (rawColors_)
        scatter<T, kSwap>(from, rowBytes_, count, rawColors + column.index, 4, [](T value) {
          return static_cast<float>(std::is_same_v<T, std::int8_t> && value < 0 ? value + 256 : value);
        });
      else
        scatter<T, kSwap>(from, rowBytes_, count, colorBytes + column.index, 4,
                          [](T value) { return static_cast<std::uint8_t>(value); });
      break;
    case Role::extra: {
      std::byte* to = cloud_.extra[column.index].data.data() + base * sizeof(T);
      for (std::size_t r = 0; r < count; ++r) {
        const T value = loadScalar<T, kSwap>(from + r * rowBytes_);
        std::memcpy(to + r * sizeof(T), &value, sizeof(T));
      }
    }
  }
}

std::optional<PlyVertices::BadRow> PlyVertices::checkPositions(std::size_t base) const {
  for (std::size_t i = base; i < count_; ++i) {
    const DVec3 p = wide_ ? cloud_.exactPositions[i] : DVec3(cloud_.positions[i]);
    if (isFiniteBelow(std::abs(p.x) + std::abs(p.y) + std::abs(p.z), kFarthest)) continue;
    return BadRow{i - base, numberNotTaken(p, {"x", "y", "z"}) + " below 1e30"};
  }
  return std::nullopt;
}

std::optional<PlyVertices::BadRow> PlyVertices::normalise(std::size_t base) {
  constexpr double kUnitTolerance =
      1e-5;  // normals closer to unit length are not changed, so that they are written back unchanged
  if (!hasNormals_) return std::nullopt;
  for (std::size_t i = base; i < count_; ++i) {
    const DVec3 n(cloud_.normals[i]);
    const double lengthSquared = glm::dot(n, n);
    if (std::abs(lengthSquared - 1.0) < kUnitTolerance) continue;
    if (!std::isfinite(lengthSquared) && badRows_ == BadRows::refuse)
      return BadRow{i - base, numberNotTaken(n, {"nx", "ny", "nz"})};
    if (lengthSquared > 0 && std::isfinite(lengthSquared)) {
      cloud_.normals[i] = Vec3(n / std::sqrt(lengthSquared));
    } else {
      cloud_.normals[i] = Vec3(0);
      zeroNormals_.push_back(i);
    }
  }
  return std::nullopt;
}

PointCloud PlyVertices::finish(Log* log) {
  if (wide_) placeOrigin();
  if (rawColors_) settleColors();
  if (log)
    for (const std::string& what : lostPoints()) log->warn("{}: not kept: {}", file_.filename().string(), what);
  if (!zeroNormals_.empty()) fillMissingNormals(cloud_, zeroNormals_, file_.filename().string(), log);
  return std::move(cloud_);
}

void PlyVertices::settleColors() {
  const bool hasAlpha = cloud_.storedAs.alpha, whole = wholeColors_ || colorSteps_;
  ColorScale alphas;
  for (const auto& row : raw_)
    if (hasAlpha) alphas.take(row[3]);
  const ColorScale scale = scaleOfColors(raw_);
  const double full = scale.full(whole), fullAlpha = alphas.full(whole);
  const ScalarType stored = scale.storedAs(whole);
  if (stored != ScalarType::f32 || wholeColors_) cloud_.storedAs.color = stored;
  constexpr double kRounded = 1e-3;  // in bytes; a step of 16 bits is 4e-3
  cloud_.colors.resize(raw_.size());
  for (std::size_t i = 0; i < raw_.size(); ++i) {
    bool dark = false;
    for (std::size_t k = 0; k < 3; ++k) {
      dark = dark || std::isnan(raw_[i][k]);
      cloud_.colors[i][k] = colorByte(raw_[i][k], full);
      const double inBytes = 255 * raw_[i][k] / full;
      hasFineColors_ = hasFineColors_ || std::abs(inBytes - cloud_.colors[i][k]) > kRounded;
    }
    cloud_.colors[i][3] = hasAlpha ? colorByte(raw_[i][3], fullAlpha) : std::uint8_t{255};
    darkColors_ += dark;
  }
  raw_ = {};
}

/// Splits double coordinates into an origin and float32 positions; drops the doubles if that is lossless.
void PlyVertices::placeOrigin() {
  const BareVector<DVec3>& exact = cloud_.exactPositions;
  if (exact.empty()) return;
  Bounds box{exact.front(), exact.front()};
  for (const DVec3& p : exact) box = {glm::min(box.min, p), glm::max(box.max, p)};
  cloud_.origin = originOf(exact.size(), box, [&](std::size_t i) { return exact[i]; });
  cloud_.positions.resize(exact.size());
  bool lossless = true;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    cloud_.positions[i] = Vec3(exact[i] - cloud_.origin);
    lossless = lossless && cloud_.origin + DVec3(cloud_.positions[i]) == exact[i];
  }
  if (lossless) cloud_.exactPositions = {};
}

}  // namespace palpate
