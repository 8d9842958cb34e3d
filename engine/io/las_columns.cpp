#include "engine/io/las_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include <glm/common.hpp>

#include "engine/core/large_array.hpp"
#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

constexpr double kExactSteps = 1 << 22;  // float32 tells so many steps of the grid apart

/// Calls f(load, Out) with what takes one value of a field from its bytes. Loops over it have no branch.
template <class F>
void visitField(const LasField& field, F&& f) {
  if (field.bits > 0) {
    const unsigned shift = field.shift, mask = (1u << field.bits) - 1;
    return f([shift, mask](const std::byte* at) {
      return static_cast<std::uint8_t>((static_cast<unsigned>(*at) >> shift) & mask);
    });
  }
  const double scale = field.scale, offset = field.offset;
  if (field.raw && field.wide && field.isSigned)
    return f([=](const std::byte* at) { return static_cast<double>(loadScalar<std::int64_t>(at)) * scale + offset; });
  if (field.raw && field.wide)
    return f([=](const std::byte* at) { return static_cast<double>(loadScalar<std::uint64_t>(at)) * scale + offset; });
  if (field.raw)
    return visitScalar(*field.raw, [&]<class T>(std::type_identity<T>) {
      f([=](const std::byte* at) { return static_cast<double>(loadScalar<T>(at)) * scale + offset; });
    });
  if (field.wide && field.isSigned)
    return f([](const std::byte* at) { return static_cast<double>(loadScalar<std::int64_t>(at)); });
  if (field.wide) return f([](const std::byte* at) { return static_cast<double>(loadScalar<std::uint64_t>(at)); });
  visitScalar(field.type,
              [&]<class T>(std::type_identity<T>) { f([](const std::byte* at) { return loadScalar<T>(at); }); });
}

/// Whether a whole number of 64 bits among `count` rows is none in double precision.
bool anyRounded(const LasField& field, const std::byte* rows, std::size_t rowBytes, std::size_t count) {
  constexpr std::uint64_t kWhole = std::uint64_t{1} << 53;
  bool any = false;
  for (std::size_t r = 0; r < count; ++r) {
    const auto value = loadScalar<std::uint64_t>(rows + r * rowBytes + field.at);
    const std::uint64_t size = field.isSigned && value >> 63 ? 0 - value : value;
    any |= size > kWhole;
  }
  return any;
}

}  // namespace

LasColumns::LasColumns(const LasHeader& header, const LasPointFormat& format, const std::vector<LasExtraField>& extra,
                       unsigned threads)
    : header_(header), format_(format), threads_(threads) {
  for (const LasField& field : format.fields) columns_.push_back(std::make_unique<Column>(field));
  for (const LasExtraField& field : extra) columns_.push_back(std::make_unique<Column>(field.field));
}

void LasColumns::reserve(std::size_t points) {
  places_.reserve(points);
  if (format_.colorAt) colors_.reserve(points);
  reserved_ = points;
}

void LasColumns::grow(std::size_t to) {
  size_ = to;
  places_.resize(to);
  if (format_.colorAt) colors_.resize(to);
  std::vector<Column*> made;
  std::vector<std::span<std::byte>> fresh;
  for (const auto& column : columns_) {
    if (!column->used) continue;
    std::vector<std::byte>& data = column->attribute.data;
    const std::size_t bytes = to * sizeOf(column->field.type);
    if (bytes > data.capacity()) reserveLarge(data, std::max(bytes, 2 * data.capacity()));
    fresh.push_back(freshMemory(data, bytes));
    made.push_back(column.get());
  }
  fetchTogether(fresh, threads_);
  parallelBlocks(made.size(), 1, threads_,
                 [&](std::size_t k, std::size_t) { made[k]->attribute.data.resize(to * sizeOf(made[k]->field.type)); });
}

/// With zeros for all points that there are.
void LasColumns::make(Column& column) {
  const std::scoped_lock hold(column.making);
  if (column.used) return;
  const std::size_t each = sizeOf(column.field.type);
  reserveLarge(column.attribute.data, std::max(reserved_, size_) * each);
  resizeLarge(column.attribute.data, size_ * each, 1);
  column.used = true;
}

void LasColumns::take(const std::byte* rows, std::size_t base, std::size_t count) {
  const std::size_t rowBytes = header_.pointBytes;
  for (std::size_t r = 0; r < count; ++r) std::memcpy(&places_[base + r], rows + r * rowBytes, sizeof places_[0]);
  if (format_.colorAt) takeColors(rows, base, count);
  for (const auto& column : columns_) {
    visitField(column->field, [&](auto&& load) {
      using T = decltype(load(rows));
      const std::byte* from = rows + column->field.at;
      std::size_t first = 0;  // that is not zero
      while (first < count && load(from + first * rowBytes) == T{0}) ++first;
      if (first == count) return;
      if (!column->used) make(*column);
      std::byte* to = column->attribute.data.data() + base * sizeof(T);
      for (std::size_t r = first; r < count; ++r) {
        const T value = load(from + r * rowBytes);
        std::memcpy(to + r * sizeof(T), &value, sizeof(T));
      }
    });
    if (column->field.wide && anyRounded(column->field, rows, rowBytes, count)) column->rounded = true;
  }
}

void LasColumns::takeColors(const std::byte* rows, std::size_t base, std::size_t count) {
  const std::size_t rowBytes = header_.pointBytes;
  std::uint32_t all = 0, unequal = 0;
  for (std::size_t r = 0; r < count; ++r) {
    auto& color = colors_[base + r];
    std::memcpy(&color, rows + r * rowBytes + format_.colorAt, sizeof color);
    for (const std::uint32_t value : color) {
      all |= value;
      unequal |= (value >> 8) ^ (value & 0xff);
    }
  }
  colorBits_.all |= all;
  colorBits_.unequal |= unequal;
}

/// The numbers of the file become float32 about an origin of the cloud; where these cannot tell them apart, they are
/// kept in double precision besides.
void LasColumns::placePoints(PointCloud& cloud) {
  const CoordinateGrid& grid = header_.grid;
  cloud.storedAs.grid = grid;
  if (places_.empty()) return;
  DVec3 low(std::numeric_limits<double>::infinity()), high = -low;
  std::mutex lock;
  parallelFor(places_.size(), threads_, [&](std::size_t begin, std::size_t end) {
    std::array<std::int32_t, 3> least = places_[begin], most = least;
    for (std::size_t i = begin; i < end; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        least[k] = std::min(least[k], places_[i][k]);
        most[k] = std::max(most[k], places_[i][k]);
      }
    const DVec3 one = grid.at(DVec3(least[0], least[1], least[2])), other = grid.at(DVec3(most[0], most[1], most[2]));
    const std::scoped_lock hold(lock);
    low = glm::min(low, glm::min(one, other));  // a step may be negative
    high = glm::max(high, glm::max(one, other));
  });
  cloud.origin = originFor({low, high});
  const DVec3 steps = glm::max(glm::abs(low - cloud.origin), glm::abs(high - cloud.origin)) / glm::abs(grid.step);
  const bool exact = std::max({steps.x, steps.y, steps.z}) > kExactSteps;
  resizeLarge(cloud.positions, places_.size(), threads_);
  if (exact) resizeLarge(cloud.exactPositions, places_.size(), threads_);
  parallelFor(places_.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const DVec3 place = grid.at(DVec3(places_[i][0], places_[i][1], places_[i][2]));
      cloud.positions[i] = Vec3(place - cloud.origin);
      if (exact) cloud.exactPositions[i] = place;
    }
  });
  places_ = {};
}

/// Colours of 16 bits that hold 8, in either way that programs have, become those; others are kept besides. Files whose
/// colours are all black have none.
void LasColumns::placeColors(PointCloud& cloud, unsigned& colorStep) {
  if (colorBits_.all == 0) return;
  const bool low = colorBits_.all < 256, high = (colorBits_.all & 0xff) == 0, both = colorBits_.unequal == 0;
  const unsigned step = low ? 1 : both ? 257 : high ? 256 : 257;
  colorStep = step;
  resizeLarge(cloud.colors, colors_.size(), threads_);
  const bool fine = !low && !high && !both;
  std::array<Attribute*, 3> kept{};
  for (std::size_t k = 0; fine && k < 3; ++k)
    cloud.extra.push_back({std::string(kLasFineColors[k]), ScalarType::u16, {}});
  for (std::size_t k = 0; fine && k < 3; ++k) {
    kept[k] = &cloud.extra[k];
    resizeLarge(kept[k]->data, colors_.size() * sizeof(std::uint16_t), threads_);
  }
  parallelFor(colors_.size(), threads_, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      cloud.colors[i][3] = 255;
      for (std::size_t k = 0; k < 3; ++k) {
        cloud.colors[i][k] = static_cast<std::uint8_t>((colors_[i][k] + step / 2) / step);
        if (fine) std::memcpy(kept[k]->data.data() + 2 * i, &colors_[i][k], 2);
      }
    }
  });
  colors_ = {};
}

PointCloud LasColumns::finish(std::vector<std::string>& lost, unsigned& colorStep) {
  PointCloud cloud;
  placePoints(cloud);
  placeColors(cloud, colorStep);
  const std::size_t standard = format_.fields.size();
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    Column& column = *columns_[k];
    if (column.rounded) lost.push_back(fmt::format("whole numbers of '{}' beyond 2^53", column.field.name));
    if (k >= standard && !column.used) make(column);  // what a file describes is there, though it be zero
    if (column.used || k >= standard) cloud.extra.push_back(std::move(column.attribute));
  }
  columns_.clear();
  return cloud;
}

}  // namespace palpate
