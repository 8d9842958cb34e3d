#include "engine/io/las_plan.hpp"

#include <fmt/format.h>
#include <glm/common.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

#include "engine/cloud/spacing.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel_collect.hpp"

namespace palpate {

namespace {

constexpr double kMin = std::numeric_limits<std::int32_t>::min();
constexpr double kMaxSteps = std::numeric_limits<std::int32_t>::max();

Bounds boxInFile(const PointCloud& cloud) {
  const DVec3 first = cloud.fileCoordinates(0);
  const auto boxOf = [&](std::size_t begin, std::size_t end) {
    Bounds box{first, first};
    for (std::size_t i = begin; i < end; ++i) {
      const DVec3 p = cloud.fileCoordinates(i);
      box = {glm::min(box.min, p), glm::max(box.max, p)};
    }
    return box;
  };
  const auto both = [](const Bounds& a, const Bounds& b) {
    return Bounds{glm::min(a.min, b.min), glm::max(a.max, b.max)};
  };
  return parallelReduce(cloud.size(), 0, Bounds{first, first}, boxOf, both);
}

double largest(const DVec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Whether the integers of all points fit into 32 bits.
bool fits(const CoordinateGrid& grid, const Bounds& box) {
  for (const DVec3& corner : {grid.nearest(box.min), grid.nearest(box.max)})
    for (int k = 0; k < 3; ++k)
      if (!(corner[k] >= kMin && corner[k] <= kMaxSteps)) return false;
  return true;
}

/// `beside`: allowed distance from the grid, relative to the coordinate.
bool allOn(const CoordinateGrid& grid, const PointCloud& cloud, double beside) {
  std::atomic<bool> all = true;
  parallelBlocks(cloud.size(), 1 << 16, 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end && all; ++i) {
      const DVec3 p = cloud.fileCoordinates(i);
      const DVec3 on = grid.at(grid.nearest(p));
      for (int k = 0; k < 3; ++k)
        if (!(std::abs(on[k] - p[k]) <= beside * std::abs(p[k]))) all = false;
    }
  });
  return all;
}

/// For moved points: the same grid while its steps are below a quarter of the spacing, else steps of a tenth, a
/// hundredth and so on, as far as 32 bits allow.
CoordinateGrid refined(const CoordinateGrid& grid, const PointCloud& cloud, const Bounds& box) {
  constexpr double kMaxParts = 1e9;
  const double most = 0.25 * meanSpacing(cloud);
  CoordinateGrid finer = grid;
  for (int k = 0; k < 3; ++k)
    for (double parts = 10; most > 0 && std::abs(finer.step[k]) >= most && parts <= kMaxParts; parts *= 10) {
      CoordinateGrid next = finer;
      next.step[k] = grid.step[k] / parts;
      if (!fits(next, box)) break;
      finer = next;
    }
  return finer;
}

constexpr std::size_t kMaxLasBytes = 65535;  // maximum size of a point or a record, bytes

/// Calls f(std::type_identity<T>{}) with the stored type.
template <class F>
void visitStored(const LasField& field, F&& f) {
  visitScalar(field.raw.value_or(field.type), f);
}

/// The stored number for a value.
double storedFor(const LasField& field, double value) {
  if (field.raw && field.noData && std::isnan(value)) return *field.noData;
  return field.raw ? std::round((value - field.offset) / field.scale) : value;
}

template <class T>
bool holds(double number) {
  if constexpr (std::is_floating_point_v<T>) return static_cast<double>(static_cast<T>(number)) == number;
  // 2^64 is out of range, but the largest 64-bit integer rounds to it in double precision.
  const double end = std::ldexp(1.0, std::numeric_limits<T>::digits);
  return number >= static_cast<double>(std::numeric_limits<T>::min()) && number < end && number == std::trunc(number);
}

std::vector<std::byte> descriptorOf(const Attribute& attribute) {
  constexpr std::array<std::uint8_t, 10> kCodes{2, 1, 4, 3, 6, 5, 9, 10, 8, 7};  // indexed by ScalarType
  std::vector<std::byte> bytes(kLasDescriptor);
  bytes[2] = static_cast<std::byte>(kCodes[static_cast<std::size_t>(attribute.type)]);
  std::memcpy(bytes.data() + 4, attribute.name.data(), std::min<std::size_t>(32, attribute.name.size()));
  return bytes;
}

}  // namespace

LasGrid lasGridFor(const PointCloud& cloud) {
  constexpr double kRounding = 4e-16;  // of a decimal that is the sum of two
  const auto& known = cloud.storedAs.grid;
  if (cloud.empty()) return {known.value_or(CoordinateGrid{DVec3(1e-3), DVec3(0)})};
  const Bounds box = boxInFile(cloud);
  if (known && fits(*known, box)) {
    if (allOn(*known, cloud, 0)) return {*known};
    return {refined(*known, cloud, box), false};
  }
  const DVec3 middle = glm::round(box.center());
  for (double parts = 1; parts <= 1e9; parts *= 10) {
    CoordinateGrid decimal{DVec3(1 / parts), DVec3(0)};
    if (!fits(decimal, box)) decimal.offset = middle;
    if (fits(decimal, box) && allOn(decimal, cloud, kRounding)) return {decimal, allOn(decimal, cloud, 0)};
  }
  // Uses half the range, so that a whole cell fits at either end.
  const auto finest = [](double reach) {
    return std::exp2(std::ceil(std::log2(std::max(reach, 1e-30) / (kMaxSteps / 2))));
  };
  CoordinateGrid binary{DVec3(finest(std::max(largest(box.min), largest(box.max)))), DVec3(0)};
  if (allOn(binary, cloud, 0)) return {binary};
  binary.step = DVec3(finest(0.5 * box.longestSide()));
  binary.offset = glm::round(box.center() / binary.step) * binary.step;
  return {binary, allOn(binary, cloud, 0)};
}

double LasSource::value(std::size_t i) const {
  return visitScalar(attribute->type, [&]<class T>(std::type_identity<T>) {
    return static_cast<double>(loadScalar<T>(attribute->data.data() + i * sizeof(T)));
  });
}

bool LasSource::fits() const {
  constexpr double kWhole = 9007199254740992;  // 2^53, beyond which double precision rounds 64-bit integers
  if (field.type == attribute->type && !field.raw && field.bits == 0) return true;
  const bool mayRound = sizeOf(attribute->type) == 8 && !isFloating(attribute->type);
  const std::size_t count = attribute->data.size() / sizeOf(attribute->type);
  for (std::size_t i = 0; i < count; ++i) {
    const double whole = value(i), number = storedFor(field, whole);
    bool fit = field.bits == 0 || number < std::ldexp(1.0, static_cast<int>(field.bits));
    visitStored(field, [&]<class T>(std::type_identity<T>) { fit = fit && holds<T>(number); });
    if (!fit || (mayRound && std::abs(whole) > kWhole)) return false;
    const bool isMissing = field.noData && std::isnan(whole);
    if (field.raw && !isMissing && number * field.scale + field.offset != whole) return false;
  }
  return true;
}

void LasSource::encode(std::size_t begin, std::size_t end, std::byte* rows, std::size_t rowBytes) const {
  std::byte* to = rows + field.at;
  if (field.bits > 0) {
    for (std::size_t i = begin; i < end; ++i, to += rowBytes)
      *to |= static_cast<std::byte>(static_cast<unsigned>(value(i)) << field.shift);
    return;
  }
  if (field.type == attribute->type && !field.raw) {  // also NaN
    const std::size_t bytes = sizeOf(field.type);
    for (std::size_t i = begin; i < end; ++i, to += rowBytes)
      std::memcpy(to, attribute->data.data() + i * bytes, bytes);
    return;
  }
  visitStored(field, [&]<class T>(std::type_identity<T>) {
    for (std::size_t i = begin; i < end; ++i, to += rowBytes) {
      const T number = static_cast<T>(storedFor(field, value(i)));
      std::memcpy(to, &number, sizeof number);
    }
  });
}

LasPlan::LasPlan(const PointCloud& cloud)
    : baggage(dynamic_cast<const LasBaggage*>(cloud.storedAs.baggage.get())), grid(lasGridFor(cloud)) {
  if (baggage) {
    old = readLasHeader({}, baggage->head);
    oldEarlyCount = loadScalar<std::uint32_t>(baggage->head.data() + 107);
    colorStep_ = baggage->colorStep;
  }
  if (cloud.hasNormals()) {
    for (std::size_t k = 0; k < 3; ++k) {
      Attribute& normal = normals_.emplace_back(Attribute{std::string(kLasNormals[k]), ScalarType::f32, {}});
      normal.data.resize(cloud.size() * sizeof(float));
      for (std::size_t i = 0; i < cloud.size(); ++i)
        std::memcpy(normal.data.data() + i * sizeof(float), &cloud.normals[i][static_cast<int>(k)], sizeof(float));
    }
    for (const Attribute& normal : normals_) attributes_.push_back(&normal);
  }
  const std::vector<std::string> gone = lasNamesGivingWay(cloud);
  for (const Attribute& attribute : cloud.extra) {
    const auto fine = std::ranges::find(kLasFineColors, attribute.name);
    if (fine != kLasFineColors.end() && attribute.type == ScalarType::u16 && cloud.hasColors())
      fineColors_[static_cast<std::size_t>(fine - kLasFineColors.begin())] = &attribute;
    else if (std::ranges::find(gone, attribute.name) == gone.end())
      attributes_.push_back(&attribute);
  }
  choose(cloud);
  takeOldExtra();
  for (const Attribute* attribute : attributes_)
    if (!isTaken(*attribute)) take(*attribute);
  if (!descriptors.empty() && !baggage) minor = 4;  // first version that describes extra bytes
}

/// Chooses the point format, and the attributes that fit its fields.
void LasPlan::choose(const PointCloud& cloud) {
  const auto has = [&](const LasPointFormat& among, std::string_view name) {
    const auto field = std::ranges::find(among.fields, name, &LasField::name);
    return std::ranges::any_of(attributes_, [&](const Attribute* attribute) {
      return attribute->name == name && LasSource{*field, attribute}.fits();
    });
  };
  const LasPointFormat most = lasPointFormat(10), plain = lasPointFormat(0), before = lasPointFormat(old.format);
  bool extended = old.format >= 6 || cloud.size() > std::numeric_limits<std::uint32_t>::max();
  for (const char* name : {"scanner_channel", "scan_angle", "overlap", "nir"}) extended = extended || has(most, name);
  for (const char* name : {"classification", "return_number", "number_of_returns"})
    extended = extended || (has(most, name) && !has(plain, name));
  const bool time = before.hasTime || has(most, "gps_time"), color = before.colorAt > 0 || cloud.hasColors();
  const bool waves = before.hasWaves || has(most, "wave_packet_descriptor");
  format = lasFormatWith(extended, time, color, before.hasInfrared || has(most, "nir"), waves);
  const unsigned least = format >= 6 ? 4 : format >= 4 ? 3 : baggage ? 0 : 2;
  minor = std::max(baggage ? old.minor : 2, least);
  points = lasPointFormat(format);
  pointBytes = points.bytes;
  for (const LasField& field : points.fields)
    for (const Attribute* attribute : attributes_)
      if (attribute->name == field.name && LasSource{field, attribute}.fits()) {
        sources.push_back({field, attribute});
        break;
      }
}

/// Keeps extra attributes of the original file that the cloud still has, with their descriptions.
void LasPlan::takeOldExtra() {
  if (!baggage) return;
  const auto extra = *lasExtraFields(baggage->descriptors, lasPointFormat(old.format), old.pointBytes);
  const std::size_t described = baggage->descriptors.size() / kLasDescriptor;
  for (std::size_t begin = 0, end = 0; begin < extra.size(); begin = end) {
    const std::size_t descriptor = extra[begin].descriptor;
    while (end < extra.size() && extra[end].descriptor == descriptor) ++end;
    std::vector<LasSource> whole;
    for (std::size_t k = begin; k < end; ++k)
      for (const Attribute* attribute : attributes_) {
        const LasSource source{extra[k].field, attribute};
        if ((attribute->name == extra[k].field.name || attribute->name + "_2" == extra[k].field.name) &&
            !isTaken(*attribute) && source.fits())
          whole.push_back(source);
      }
    if (descriptor >= described || whole.size() != end - begin) continue;
    const auto raw = std::span(baggage->descriptors).subspan(descriptor * kLasDescriptor, kLasDescriptor);
    descriptors.insert(descriptors.end(), raw.begin(), raw.end());
    for (LasSource& source : whole) {
      source.field.at = pointBytes;
      pointBytes += source.field.storedBytes();
      sources.push_back(source);
    }
  }
}

void LasPlan::take(const Attribute& attribute) {
  const std::vector<std::byte> descriptor = descriptorOf(attribute);
  descriptors.insert(descriptors.end(), descriptor.begin(), descriptor.end());
  sources.push_back({{.name = attribute.name, .at = pointBytes, .type = attribute.type}, &attribute});
  pointBytes += sizeOf(attribute.type);
}

bool LasPlan::isTaken(const Attribute& attribute) const {
  return std::ranges::any_of(sources, [&](const LasSource& source) { return source.attribute == &attribute; });
}

void LasPlan::check(const std::filesystem::path& file) const {
  if (pointBytes > kMaxLasBytes || descriptors.size() > kMaxLasBytes)
    throw FileError(file, fmt::format("LAS cannot hold {} attributes of a point; write PLY", attributes_.size()));
}

const LasSource* LasPlan::sourceOf(std::string_view name) const {
  const auto found = std::ranges::find_if(sources, [&](const LasSource& source) { return source.field.name == name; });
  return found == sources.end() ? nullptr : &*found;
}

/// The original value unless the point was painted.
std::uint16_t LasPlan::color(const PointCloud& cloud, std::size_t i, std::size_t channel) const {
  const unsigned now = cloud.colors[i][channel];
  if (const Attribute* fine = fineColors_[channel]) {
    const auto was = loadScalar<std::uint16_t>(fine->data.data() + i * sizeof(std::uint16_t));
    if ((was + colorStep_ / 2) / colorStep_ == now) return was;
  }
  return static_cast<std::uint16_t>(now * colorStep_);
}

void LasPlan::encode(const PointCloud& cloud, std::size_t begin, std::size_t end, std::byte* rows) const {
  const std::size_t rowBytes = pointBytes;
  std::byte* row = rows;
  for (std::size_t i = begin; i < end; ++i, row += rowBytes) {
    const DVec3 place = grid.grid.nearest(cloud.fileCoordinates(i));
    for (int k = 0; k < 3; ++k) {
      const auto number = static_cast<std::int32_t>(place[k]);
      std::memcpy(row + k * sizeof number, &number, sizeof number);
    }
    if (points.colorAt == 0 || !cloud.hasColors()) continue;
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint16_t value = color(cloud, i, k);
      std::memcpy(row + points.colorAt + 2 * k, &value, sizeof value);
    }
  }
  for (const LasSource& source : sources) source.encode(begin, end, rows, rowBytes);
}

std::vector<std::string> lasNamesGivingWay(const PointCloud& cloud) {
  std::vector<std::string> names;
  for (const Attribute& attribute : cloud.extra) {
    const bool normal = std::ranges::find(kLasNormals, attribute.name) != kLasNormals.end();
    if (cloud.hasNormals() && normal) names.push_back(attribute.name);
  }
  return names;
}

}  // namespace palpate
