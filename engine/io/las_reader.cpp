#include "engine/io/las_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <mutex>

#include <glm/common.hpp>

#include "engine/cloud/normals.hpp"
#include "engine/cloud/up.hpp"
#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/saving.hpp"

namespace palpate {

namespace {

constexpr std::size_t kBlock = 4096;                         // points that one thread takes at a time
constexpr std::size_t kSlab = std::size_t{1} << 27;          // bytes that are read at a time
constexpr std::size_t kMostReserved = std::size_t{1} << 27;  // points: a sparse file is long without holding any
constexpr double kExactSteps = 1 << 22;                      // float32 tells so many steps of the grid apart

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

std::string textOf(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::string> linesOf(const std::string& text) {
  std::vector<std::string> lines;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    if (end > begin) lines.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return lines;
}

LasHead readHead(ChunkedFile& file) {
  LasHead head;
  head.header = readLasHeader(file.path(), file.peek(kLasHeader14));
  const auto bytes = file.peek(head.header.pointsAt);
  if (bytes.size() < head.header.pointsAt)
    throw FileError::atByte(file.path(), bytes.size(),
                            fmt::format("the file ends before its points, which are said to "
                                        "begin at byte {}",
                                        head.header.pointsAt));
  head.bytes.assign(bytes.begin(), bytes.begin() + head.header.pointsAt);
  file.consume(head.header.pointsAt);
  head.format = lasPointFormat(head.header.format);
  std::uint64_t describedAt = 0;
  for (const LasRecord& record : lasRecords(file.path(), head.header, head.bytes)) {
    if (record.is(kLasSpec, kLasExtraBytes)) {
      head.descriptors.assign(record.data.begin(), record.data.end());
      describedAt = record.at;
    }
    if (record.is(kLasOurs, kLasComments)) head.comments = linesOf(textOf(record.data));
  }
  auto extra = lasExtraFields(head.descriptors, head.format, head.header.pointBytes);
  if (!extra)
    throw FileError::atByte(file.path(), describedAt,
                            fmt::format("describes more extra bytes than the {} that points have",
                                        head.header.pointBytes - head.format.bytes));
  head.extra = std::move(*extra);
  if (textOf(std::span(head.bytes).subspan(58, 32)).starts_with(kLasOurs)) {
    PointCloud ours;
    markAsOurs(ours);
    head.comments.insert(head.comments.begin(), ours.storedAs.comments.front());
  }
  return head;
}

}  // namespace

LasReader::LasReader(const std::filesystem::path& path)
    : file_(path), head_(readHead(file_)), baggage_(std::make_shared<LasBaggage>()) {
  checkCount();
}

void LasReader::checkCount() const {
  const auto there = file_.remaining();
  const LasHeader& header = head_.header;
  if (there && header.points > *there / header.pointBytes)
    throw FileError::atByte(file_.path(), header.minor == 4 ? 247 : 107,
                            fmt::format("the header promises {} points of {} bytes, and {} bytes are there",
                                        header.points, header.pointBytes, *there));
}

PointCloud LasReader::read(Log* log, std::vector<std::string>& lost) {
  if (log) file_.onProgress([&](double share) { log->progress(file_.path().filename().string(), share); });
  const auto add = [&](const LasField& field) {
    columns_.push_back({field,
                        std::make_unique<std::atomic<bool>>(false),
                        std::make_unique<std::atomic<bool>>(false),
                        {field.name, field.type, {}}});
  };
  for (const LasField& field : head_.format.fields) add(field);
  for (const LasExtraField& extra : head_.extra) add(extra.field);
  readPoints();
  takeTail();
  placePoints();
  placeColors();
  takeColumns(lost);
  takeNormals(log);
  StoredAs& stored = cloud_.storedAs;
  stored.position = ScalarType::f64;
  stored.comments = head_.comments;
  if (!upSaidIn(stored.comments)) stored.comments.emplace_back(fmt::format("comment up: {}", nameOf(UpAxis::z)));
  baggage_->format = "LAS";
  baggage_->head = std::move(head_.bytes);
  baggage_->descriptors = std::move(head_.descriptors);
  stored.baggage = std::move(baggage_);
  return std::move(cloud_);
}

void LasReader::readPoints() {
  const LasHeader& header = head_.header;
  const std::size_t slab = std::max<std::size_t>(1, kSlab / header.pointBytes);
  const std::size_t reserved = std::min<std::uint64_t>(file_.remaining() ? header.points : 0, kMostReserved);
  places_.reserve(reserved);
  if (head_.format.colorAt) colors_.reserve(reserved);
  for (Column& column : columns_) column.attribute.data.reserve(reserved * sizeOf(column.field.type));
  for (std::uint64_t done = 0; done < header.points;) {
    const auto count = static_cast<std::size_t>(std::min<std::uint64_t>(slab, header.points - done));
    const auto rows = file_.peek(count * header.pointBytes);
    if (rows.size() < count * header.pointBytes)
      throw FileError::atByte(file_.path(), file_.offset() + rows.size(),
                              fmt::format("the file ends inside point {} of {}",
                                          done + rows.size() / header.pointBytes + 1, header.points));
    const std::size_t base = places_.size();
    grow(base + count);
    parallelBlocks(count, kBlock, 0, [&](std::size_t begin, std::size_t end) {
      decode(rows.data() + begin * header.pointBytes, base + begin, end - begin);
    });
    file_.consume(count * header.pointBytes);
    done += count;
  }
}

/// A column a thread: what writes zeros into fresh memory waits for the system.
void LasReader::grow(std::size_t to) {
  places_.resize(to);
  if (head_.format.colorAt) colors_.resize(to);
  parallelBlocks(columns_.size(), 1, 0, [&](std::size_t begin, std::size_t) {
    Column& column = columns_[begin];
    column.attribute.data.resize(to * sizeOf(column.field.type));
  });
}

void LasReader::decode(const std::byte* rows, std::size_t base, std::size_t count) {
  const std::size_t rowBytes = head_.header.pointBytes;
  for (std::size_t r = 0; r < count; ++r) std::memcpy(&places_[base + r], rows + r * rowBytes, sizeof places_[0]);
  if (head_.format.colorAt) decodeColors(rows, base, count);
  for (Column& column : columns_) {
    visitField(column.field, [&](auto&& load) {
      using T = decltype(load(rows));
      std::byte* to = column.attribute.data.data() + base * sizeof(T);
      bool used = false;
      for (std::size_t r = 0; r < count; ++r) {
        const T value = load(rows + r * rowBytes + column.field.at);
        std::memcpy(to + r * sizeof(T), &value, sizeof(T));
        used |= value != T{0};
      }
      if (used) *column.used = true;
    });
    if (column.field.wide && anyRounded(column.field, rows, rowBytes, count)) *column.rounded = true;
  }
}

void LasReader::decodeColors(const std::byte* rows, std::size_t base, std::size_t count) {
  const std::size_t rowBytes = head_.header.pointBytes;
  std::uint32_t all = 0, unequal = 0;
  for (std::size_t r = 0; r < count; ++r) {
    auto& color = colors_[base + r];
    std::memcpy(&color, rows + r * rowBytes + head_.format.colorAt, sizeof color);
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
void LasReader::placePoints() {
  const CoordinateGrid& grid = head_.header.grid;
  cloud_.storedAs.grid = grid;
  if (places_.empty()) return;
  DVec3 low(std::numeric_limits<double>::infinity()), high = -low;
  std::mutex lock;
  parallelFor(places_.size(), 0, [&](std::size_t begin, std::size_t end) {
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
  cloud_.origin = originFor({low, high});
  const DVec3 steps = glm::max(glm::abs(low - cloud_.origin), glm::abs(high - cloud_.origin)) / glm::abs(grid.step);
  const bool exact = std::max({steps.x, steps.y, steps.z}) > kExactSteps;
  parallelParts(2, [&](std::size_t part) {
    if (part == 0) cloud_.positions.resize(places_.size());
    if (part == 1 && exact) cloud_.exactPositions.resize(places_.size());
  });
  parallelFor(places_.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const DVec3 place = grid.at(DVec3(places_[i][0], places_[i][1], places_[i][2]));
      cloud_.positions[i] = Vec3(place - cloud_.origin);
      if (exact) cloud_.exactPositions[i] = place;
    }
  });
  places_ = {};
}

/// Colours of 16 bits that hold 8, in either way that programs have, become those; others are kept besides. Files whose
/// colours are all black have none.
void LasReader::placeColors() {
  if (colorBits_.all == 0) return;
  const bool low = colorBits_.all < 256, high = (colorBits_.all & 0xff) == 0, both = colorBits_.unequal == 0;
  const unsigned step = low ? 1 : both ? 257 : high ? 256 : 257;
  baggage_->colorStep = step;
  cloud_.colors.resize(colors_.size());
  const bool fine = !low && !high && !both;
  std::array<Attribute*, 3> kept{};
  for (std::size_t k = 0; fine && k < 3; ++k)
    cloud_.extra.push_back({std::string(kLasFineColors[k]), ScalarType::u16, {}});
  for (std::size_t k = 0; fine && k < 3; ++k) {
    kept[k] = &cloud_.extra[k];
    kept[k]->data.resize(colors_.size() * sizeof(std::uint16_t));
  }
  parallelFor(colors_.size(), 0, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      cloud_.colors[i][3] = 255;
      for (std::size_t k = 0; k < 3; ++k) {
        cloud_.colors[i][k] = static_cast<std::uint8_t>((colors_[i][k] + step / 2) / step);
        if (fine) std::memcpy(kept[k]->data.data() + 2 * i, &colors_[i][k], 2);
      }
    }
  });
  colors_ = {};
}

void LasReader::takeColumns(std::vector<std::string>& lost) {
  const std::size_t standard = head_.format.fields.size();
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    Column& column = columns_[k];
    if (*column.rounded) lost.push_back(fmt::format("whole numbers of '{}' beyond 2^53", column.field.name));
    if (k >= standard || *column.used) cloud_.extra.push_back(std::move(column.attribute));
  }
  columns_.clear();
}

/// As programs name them that keep normals in extra bytes.
void LasReader::takeNormals(Log* log) {
  std::array<std::vector<Attribute>::iterator, 3> found;
  for (std::size_t k = 0; k < 3; ++k) {
    found[k] = std::ranges::find(cloud_.extra, kLasNormals[k], &Attribute::name);
    if (found[k] == cloud_.extra.end() || found[k]->type != ScalarType::f32) return;
  }
  constexpr double kUnitTolerance = 1e-5;  // nearer to 1 a normal stays as it is
  std::vector<std::size_t> missing;
  std::vector<Vec3> normals(cloud_.size());
  for (std::size_t i = 0; i < cloud_.size(); ++i) {
    for (int k = 0; k < 3; ++k)
      normals[i][k] = loadScalar<float>(found[static_cast<std::size_t>(k)]->data.data() + i * sizeof(float));
    const DVec3 n(normals[i]);
    const double squared = glm::dot(n, n);
    if (!std::isfinite(squared)) return;  // whatever they are, they stay attributes
    if (squared == 0) missing.push_back(i);
    if (squared > 0 && std::abs(squared - 1) >= kUnitTolerance) normals[i] = Vec3(n / std::sqrt(squared));
  }
  cloud_.normals = std::move(normals);
  std::erase_if(cloud_.extra, [](const Attribute& attribute) {
    return std::ranges::find(kLasNormals, attribute.name) != kLasNormals.end();
  });
  if (!missing.empty()) fillMissingNormals(cloud_, missing, file_.path().filename().string(), log);
}

void LasReader::takeTail() {
  const std::uint64_t at = file_.offset();
  for (auto bytes = file_.peek(1); !bytes.empty(); bytes = file_.peek(1)) {
    baggage_->tail.insert(baggage_->tail.end(), bytes.begin(), bytes.end());
    file_.consume(bytes.size());
  }
  std::string names;
  std::size_t count = 0;
  const auto name = [&](const LasRecord& record) {
    if (record.is(kLasSpec, kLasExtraBytes) || record.is(kLasOurs, kLasComments)) return;
    names += fmt::format("{}{} {}", count++ == 0 ? "" : ", ", inQuotes(record.user), record.id);
  };
  for (const LasRecord& record : lasRecords(file_.path(), head_.header, head_.bytes)) name(record);
  for (const LasRecord& record : lasLongRecords(file_.path(), head_.header, baggage_->tail, at)) name(record);
  if (count > 0) baggage_->sentence = fmt::format("{} record{} of LAS: {}", count, count == 1 ? "" : "s", names);
}

}  // namespace palpate
