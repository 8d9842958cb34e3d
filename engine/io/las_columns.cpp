#include "engine/io/las_columns.hpp"

#include <algorithm>
#include <cmath>
#include <deque>

#include <glm/common.hpp>

#include "engine/cloud/voxel_sample.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {

namespace {

constexpr double kExactSteps = 1 << 22;  // number of grid steps that float32 can distinguish
constexpr std::size_t kFew = 512;        // rows that stay in the first-level cache while all columns process them
constexpr std::size_t kMany = 1 << 17;   // points, large enough that threads rarely fault in the same large page
constexpr double kUnitTolerance = 1e-5;  // normals closer to unit length are not changed

using Numbers = std::array<std::int32_t, 3>;
static_assert(sizeof(Numbers) == sizeof(Vec3));

/// Calls f(load), where load(at) reads a value of the field from its bytes. Loops over load are branch-free.
template <class F>
void visitField(const LasField& field, F&& f) {
  if (field.bits > 0) {
    const unsigned shift = field.shift, mask = (1u << field.bits) - 1;
    return f([shift, mask](const std::byte* at) {
      return static_cast<std::uint8_t>((static_cast<unsigned>(*at) >> shift) & mask);
    });
  }
  const double scale = field.scale, offset = field.offset;
  const double none = field.noData.value_or(std::numeric_limits<double>::quiet_NaN());
  if (field.raw)
    return visitScalar(*field.raw, [&]<class T>(std::type_identity<T>) {
      f([=](const std::byte* at) {
        const double number = static_cast<double>(loadScalar<T>(at));
        return number == none ? std::numeric_limits<double>::quiet_NaN() : number * scale + offset;
      });
    });
  visitScalar(field.type,
              [&]<class T>(std::type_identity<T>) { f([](const std::byte* at) { return loadScalar<T>(at); }); });
}

/// Whether any bit of the value is set: negative zero has one.
template <class T>
bool isSet(const T& value) {
  constexpr std::array<std::byte, sizeof(T)> kNone{};
  // NOLINTNEXTLINE(bugprone-suspicious-memory-comparison): the bits are meant
  return std::memcmp(&value, kNone.data(), sizeof(T)) != 0;
}

/// Calls f(begin, end) for parts of [begin, end) that fit into the first-level cache.
template <class F>
void inFew(std::size_t begin, std::size_t end, F&& f) {
  for (; begin < end; begin += kFew) f(begin, std::min(end, begin + kFew));
}

/// Shared data is written only when it changes, since a write invalidates the cache line of all other processors.
void setOnce(std::atomic<bool>& flag, bool set) {
  if (set && !flag.load(std::memory_order_relaxed)) flag = true;
}
void addBits(std::atomic<std::uint32_t>& bits, std::uint32_t more) {
  if (more & ~bits.load(std::memory_order_relaxed)) bits |= more;
}

double squaredLength(const float* n) {
  const double x = n[0], y = n[1], z = n[2];
  return x * x + y * y + z * z;
}

}  // namespace

void LasColumns::Range::include(const Range& other) {
  for (std::size_t k = 0; k < 3; ++k) {
    least[k] = std::min(least[k], other.least[k]);
    most[k] = std::max(most[k], other.most[k]);
  }
}

LasColumns::LasColumns(const LasHeader& header, const LasPointFormat& format, const std::vector<LasExtraField>& extra,
                       unsigned threads)
    : header_(header), format_(format), threads_(threads) {
  // Names used by programs that store normals in extra bytes.
  for (const std::string_view name : kLasNormals) {
    const auto found = std::ranges::find(extra, name, [](const LasExtraField& field) { return field.field.name; });
    if (found != extra.end() && found->field.type == ScalarType::f32) normals_.push_back(found->field);
  }
  if (normals_.size() < kLasNormals.size()) normals_.clear();
  const auto isNormal = [&](const LasField& field) {
    return std::ranges::find(normals_, field.at, &LasField::at) != normals_.end();
  };
  for (const LasField& field : format.fields) columns_.push_back(std::make_unique<Column>(field));
  for (const LasExtraField& field : extra)
    if (!isNormal(field.field)) columns_.push_back(std::make_unique<Column>(field.field));
}

void LasColumns::reserve(std::size_t points) {
  reserveLarge(cloud_.positions, points);
  if (!normals_.empty()) reserveLarge(cloud_.normals, points);
  if (format_.colorAt) reserveLarge(colors_, points);
  reserved_ = points;
}

void LasColumns::makeRoom(std::size_t to) {
  size_ = to;
  places_.makeRoom(to);
  if (!normals_.empty()) vectors_.makeRoom(to);
  if (format_.colorAt) fineColors_.makeRoom(to);
  for (const auto& column : columns_)
    if (column->used) column->bytes.makeRoom(to * sizeOf(column->field.type));
}

/// Allocates memory for all points that there is room for now or soon.
void LasColumns::make(Column& column) {
  const std::scoped_lock hold(column.making);
  if (column.used) return;
  const std::size_t each = sizeOf(column.field.type);
  reserveLarge(column.attribute.data, std::max(reserved_, size_) * each);
  column.bytes.makeRoom(size_ * each);
  column.used = true;
}

double LasColumns::waited_s() const {
  double waited_s = places_.waited_s() + vectors_.waited_s() + fineColors_.waited_s();
  for (const auto& column : columns_) waited_s += column->bytes.waited_s();
  return waited_s;
}

void LasColumns::take(const std::byte* rows, std::size_t base, std::size_t count) {
  if (count == 0) return;
  places_.need(base + count);
  if (!normals_.empty()) vectors_.need(base + count);
  if (format_.colorAt) fineColors_.need(base + count);
  Range range;
  inFew(0, count, [&](std::size_t begin, std::size_t end) {
    takeFew(rows + begin * header_.pointBytes, base + begin, end - begin, range);
  });
  const std::scoped_lock hold(ranging_);
  range_.include(range);
}

void LasColumns::takeFew(const std::byte* rows, std::size_t base, std::size_t count, Range& range) {
  takePlaces(rows, base, count, range);
  if (format_.colorAt) takeColors(rows, base, count);
  if (!normals_.empty()) takeNormals(rows, base, count);
  // Columns are contiguous, and most are all zero: the bits set in any row are collected eight bytes at a time.
  const std::size_t rowBytes = header_.pointBytes;
  std::size_t windowAt = 0;
  std::uint64_t window = 0;
  bool hasWindow = false;
  for (const auto& column : columns_) {
    const LasField& field = column->field;
    const std::size_t bytes = field.storedBytes();
    if (!hasWindow || field.at < windowAt || field.at + bytes > windowAt + sizeof window) {
      windowAt = std::min(field.at, rowBytes - sizeof window);
      window = 0;
      for (std::size_t r = 0; r < count; ++r) window |= loadScalar<std::uint64_t>(rows + r * rowBytes + windowAt);
      hasWindow = true;
    }
    const std::uint64_t all = bytes == sizeof window ? ~std::uint64_t{0} : (std::uint64_t{1} << 8 * bytes) - 1;
    const std::uint64_t mask = field.bits > 0 ? ((std::uint64_t{1} << field.bits) - 1) << field.shift : all;
    const bool isZero = ((window >> 8 * (field.at - windowAt)) & mask) == 0;
    if (isZero && !field.raw) continue;
    takeColumn(*column, rows, base, count);
  }
}

void LasColumns::takePlaces(const std::byte* rows, std::size_t base, std::size_t count, Range& range) {
  const std::size_t rowBytes = header_.pointBytes;
  std::array<Numbers, kFew> few;
  for (std::size_t r = 0; r < count; ++r) std::memcpy(&few[r], rows + r * rowBytes, sizeof few[0]);
  // Four points are twelve integers, which are compared in parallel.
  constexpr std::size_t kSide = 4;
  std::array<std::int32_t, 3 * kSide> least, most;
  for (std::size_t k = 0; k < least.size(); ++k) least[k] = range.least[k % 3], most[k] = range.most[k % 3];
  for (std::size_t r = count; r % kSide != 0; ++r) few[r] = few[count - 1];
  for (std::size_t r = 0; r < count; r += kSide)
    for (std::size_t k = 0; k < least.size(); ++k) {
      const std::int32_t number = few[r + k / 3][k % 3];
      least[k] = number < least[k] ? number : least[k];
      most[k] = number > most[k] ? number : most[k];
    }
  for (std::size_t k = 0; k < least.size(); ++k) {
    range.least[k % 3] = std::min(range.least[k % 3], least[k]);
    range.most[k % 3] = std::max(range.most[k % 3], most[k]);
  }
  std::memcpy(static_cast<void*>(cloud_.positions.data() + base), few.data(), count * sizeof few[0]);
}

void LasColumns::takeNormals(const std::byte* rows, std::size_t base, std::size_t count) {
  const std::size_t rowBytes = header_.pointBytes;
  std::array<std::array<float, 3>, kFew> few;
  for (std::size_t k = 0; k < few[0].size(); ++k) {
    const std::byte* from = rows + normals_[k].at;
    for (std::size_t r = 0; r < count; ++r) few[r][k] = loadScalar<float>(from + r * rowBytes);
  }
  bool infinite = false, missing = false, scaled = false;
  for (std::size_t r = 0; r < count; ++r) {
    const double squared = squaredLength(few[r].data());
    infinite |= !(squared <= std::numeric_limits<double>::max());
    missing |= squared == 0;
    scaled |= std::abs(squared - 1) >= kUnitTolerance;
  }
  setOnce(normalKinds_.infinite, infinite);
  setOnce(normalKinds_.missing, missing);
  setOnce(normalKinds_.scaled, scaled);
  std::memcpy(static_cast<void*>(cloud_.normals.data() + base), few.data(), count * sizeof few[0]);
}

void LasColumns::takeColumn(Column& column, const std::byte* rows, std::size_t base, std::size_t count) {
  const std::size_t rowBytes = header_.pointBytes;
  visitField(column.field, [&](auto&& load) {
    using T = decltype(load(rows));
    const std::byte* from = rows + column.field.at;
    if (!column.used) {
      std::size_t first = 0;
      while (first < count && !isSet(load(from + first * rowBytes))) ++first;
      if (first == count) return;
      make(column);
    }
    column.bytes.need((base + count) * sizeof(T));
    std::byte* to = column.attribute.data.data() + base * sizeof(T);
    for (std::size_t r = 0; r < count; ++r) {
      const T value = load(from + r * rowBytes);
      std::memcpy(to + r * sizeof(T), &value, sizeof(T));
    }
  });
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
  addBits(colorBits_.all, all);
  addBits(colorBits_.unequal, unequal);
}

/// Converts the file's integers to float32 relative to an origin; if these cannot distinguish them, positions are also
/// kept in double precision.
void LasColumns::placePoints() {
  const CoordinateGrid& grid = header_.grid;
  cloud_.storedAs.grid = grid;
  if (size_ == 0) return;
  const auto at = [&](const Numbers& n) { return grid.at(DVec3(n[0], n[1], n[2])); };
  const DVec3 one = at(range_.least), other = at(range_.most);
  const DVec3 low = glm::min(one, other), high = glm::max(one, other);  // a step may be negative
  const DVec3 origin = cloud_.origin = originOf(size_, {low, high}, [&](std::size_t i) {
    Numbers numbers;
    std::memcpy(&numbers, static_cast<const void*>(&cloud_.positions[i]), sizeof numbers);
    return at(numbers);
  });
  const DVec3 steps = glm::max(glm::abs(low - origin), glm::abs(high - origin)) / glm::abs(grid.step);
  const bool exact = std::max({steps.x, steps.y, steps.z}) > kExactSteps;
  const auto place = [&](std::size_t begin, std::size_t end) {
    std::array<Numbers, kFew> few;
    std::memcpy(few.data(), static_cast<const void*>(cloud_.positions.data() + begin), (end - begin) * sizeof few[0]);
    for (std::size_t i = begin; i < end; ++i) {
      const DVec3 there = at(few[i - begin]);
      cloud_.positions[i] = Vec3(there - origin);
      if (exact) cloud_.exactPositions[i] = there;
    }
  };
  const auto placeAll = [&](std::size_t begin, std::size_t end) { inFew(begin, end, place); };
  if (exact) cloud_.exactPositions.resize(size_);
  parallelBlocks(size_, kMany, threads_, placeAll);
}

/// 16-bit colours that contain only 8 bits, in either usual encoding, are converted; others are also kept as
/// attributes. Files with all colours black have no colours.
void LasColumns::placeColors(unsigned& colorStep) {
  if (colorBits_.all == 0) return;
  const bool low = colorBits_.all < 256, high = (colorBits_.all & 0xff) == 0, both = colorBits_.unequal == 0;
  const unsigned step = low ? 1 : both ? 257 : high ? 256 : 257;
  colorStep = step;
  const bool fine = !low && !high && !both;
  for (std::size_t k = 0; fine && k < 3; ++k)
    cloud_.extra.push_back({std::string(kLasFineColors[k]), ScalarType::u16, {}});
  GrowingArray<std::array<std::uint8_t, 4>> colors(cloud_.colors);
  colors.makeRoom(size_);
  std::deque<GrowingArray<std::byte>> keptBytes;
  for (Attribute& kept : cloud_.extra) keptBytes.emplace_back(kept.data).makeRoom(size_ * sizeof(std::uint16_t));
  parallelBlocks(size_, 16 * kFew, threads_, [&](std::size_t begin, std::size_t end) {
    colors.need(end);
    for (auto& bytes : keptBytes) bytes.need(end * sizeof(std::uint16_t));
    for (std::size_t i = begin; i < end; ++i) {
      cloud_.colors[i][3] = 255;
      for (std::size_t k = 0; k < 3; ++k) {
        cloud_.colors[i][k] = static_cast<std::uint8_t>((colors_[i][k] + step / 2) / step);
        if (fine) std::memcpy(cloud_.extra[k].data.data() + 2 * i, &colors_[i][k], 2);
      }
    }
  });
  colors_ = {};
}

/// Normalises normals; returns the points without a normal. If any normal is not finite, all become attributes instead.
std::vector<std::size_t> LasColumns::placeNormals() {
  if (normals_.empty()) return {};
  if (normalKinds_.infinite) {
    for (std::size_t k = 0; k < normals_.size(); ++k) {
      Attribute& attribute = cloud_.extra.emplace_back(Attribute{normals_[k].name, normals_[k].type, {}});
      GrowingArray<std::byte> bytes(attribute.data);
      bytes.makeRoom(size_ * sizeof(float));
      parallelBlocks(size_, 16 * kFew, threads_, [&](std::size_t begin, std::size_t end) {
        bytes.need(end * sizeof(float));
        for (std::size_t i = begin; i < end; ++i)
          std::memcpy(attribute.data.data() + i * sizeof(float), &cloud_.normals[i][static_cast<int>(k)],
                      sizeof(float));
      });
    }
    cloud_.normals = {};
    return {};
  }
  if (!normalKinds_.scaled) return {};  // a missing normal is far from unit length, too
  parallelFor(size_, threads_, [&](std::size_t begin, std::size_t end) {
    for (Vec3& normal : std::span(cloud_.normals).subspan(begin, end - begin)) {
      const double squared = squaredLength(&normal.x);
      if (squared > 0 && std::abs(squared - 1) >= kUnitTolerance) normal = Vec3(DVec3(normal) / std::sqrt(squared));
    }
  });
  if (!normalKinds_.missing) return {};
  const auto isMissing = [&](std::size_t i) { return squaredLength(&cloud_.normals[i].x) == 0; };
  const auto missing = parallelCollect(size_, threads_, isMissing, [](std::size_t i) { return i; });
  return {missing.begin(), missing.end()};
}

PointCloud LasColumns::finish(unsigned& colorStep, std::vector<std::size_t>& withoutNormal) {
  placePoints();
  placeColors(colorStep);
  const std::size_t standard = format_.fields.size();
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    Column& column = *columns_[k];
    if (k >= standard && !column.used) make(column);  // a described attribute is kept even if it is zero
    if (column.used) complete(column);
    if (column.used || k >= standard) cloud_.extra.push_back(std::move(column.attribute));
  }
  // An attribute that did not fit its field (for example a fractional intensity) was stored as extra bytes, and gets
  // its name back.
  for (const LasField& field : format_.fields) {
    const auto isNamed = [&](const std::string& name) {
      return std::ranges::find(cloud_.extra, name, &Attribute::name);
    };
    if (isNamed(field.name) != cloud_.extra.end()) continue;
    if (const auto beside = isNamed(field.name + "_2"); beside != cloud_.extra.end()) beside->name = field.name;
  }
  columns_.clear();
  withoutNormal = placeNormals();
  return std::move(cloud_);
}

}  // namespace palpate
