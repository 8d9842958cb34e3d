#include <algorithm>

#include "engine/core/error.hpp"
#include "engine/io/ends_after.hpp"
#include "engine/io/ply_body.hpp"
#include "engine/io/point_batch.hpp"

namespace palpate {
namespace {

/// Iterates over rows that contain lists; errors have the byte offset.
class BinaryRows {
 public:
  BinaryRows(ChunkedFile& file, const PlyElement& element, bool swapBytes)
      : file_(file), element_(element), swapBytes_(swapBytes) {}

  [[noreturn]] void fail(std::uint64_t offset, std::string_view what) const {
    throw FileError::atByte(file_.path(), offset, what);
  }
  [[noreturn]] void failAtEnd(std::uint64_t row) const {
    fail(file_.offset(),
         fmt::format("the file ends in {} {} of {}; it is truncated", element_.name, row + 1, element_.count));
  }

  /// Copies a scalar to `to` if it is not null.
  void scalar(const PlyProperty& property, std::uint64_t row, std::byte* to) {
    const std::size_t bytes = sizeOf(property.type);
    const auto unread = file_.peek(bytes);
    if (unread.size() < bytes) failAtEnd(row);
    if (to) std::memcpy(to, unread.data(), bytes);
    file_.consume(bytes);
  }

  /// Reads the length of a list and checks it against the remaining size of the file.
  std::uint64_t listLength(const PlyProperty& property, std::uint64_t row) {
    const std::uint64_t offset = file_.offset();
    const auto length = readNumber<std::int64_t>({property.name, property.countType, false, property.countType}, row);
    if (length < 0)
      fail(offset, fmt::format("{} {}: list '{}' has {} items", element_.name, row + 1, property.name, length));
    const auto left = file_.remaining();
    if (left && static_cast<std::uint64_t>(length) > *left / sizeOf(property.type)) {
      fail(offset,
           fmt::format(
               "{} {}: list '{}' has {} items of {} bytes, but only {} bytes follow; the file is truncated or damaged",
               element_.name, row + 1, property.name, length, sizeOf(property.type), *left));
    }
    return static_cast<std::uint64_t>(length);
  }

  void skipList(const PlyProperty& property, std::uint64_t row) {
    const std::uint64_t length = listLength(property, row);
    if (!file_.skip(length * sizeOf(property.type))) failAtEnd(row);
  }

  template <class Number>
  void readList(const PlyProperty& property, std::uint64_t row, std::vector<Number>& items) {
    items.clear();
    for (std::uint64_t left = listLength(property, row); left > 0; --left)
      items.push_back(readNumber<Number>(property, row));
  }

  template <class Number>
  Number readNumber(const PlyProperty& property, std::uint64_t row) {
    std::byte raw[8];
    scalar(property, row, raw);
    return number<Number>(property.type, raw);
  }

 private:
  template <class Number>
  Number number(ScalarType type, const std::byte* raw) const {
    return visitScalar(type, [&]<class T>(std::type_identity<T>) {
      return static_cast<Number>(swapBytes_ ? loadScalar<T, true>(raw) : loadScalar<T>(raw));
    });
  }

  ChunkedFile& file_;
  const PlyElement& element_;
  bool swapBytes_;
};

/// Minimum size of a row: all lists empty.
std::uint64_t minBinaryRowBytes(const PlyElement& element) {
  std::uint64_t bytes = element.scalarBytes();
  for (const PlyProperty& property : element.properties) bytes += property.isList ? sizeOf(property.countType) : 0;
  return bytes;
}

void readPackedVertices(ChunkedFile& file, const PlyElement& element, bool swapBytes, PlyRowSink& vertices) {
  const std::size_t rowBytes = vertices.rowBytes();
  // The rows of a pipe are processed as they are received.
  const std::uint64_t rowsAtOnce = file.remaining() ? std::max<std::uint64_t>(1, vertices.bytesAtOnce() / rowBytes) : 1;
  for (std::uint64_t done = 0; done < element.count;) {
    const auto unread = file.peek(rowBytes * std::min(rowsAtOnce, element.count - done));
    const auto rows = static_cast<std::size_t>(std::min<std::uint64_t>(unread.size() / rowBytes, element.count - done));
    if (rows == 0) BinaryRows(file, element, swapBytes).failAtEnd(done);
    if (const auto bad = vertices.append(unread.data(), rows, swapBytes))
      throw FileError::atByte(file.path(), file.offset() + bad->row * rowBytes, bad->what);
    file.consume(rows * rowBytes);
    done += rows;
  }
}

/// Packs the scalars of rows that also have lists, some thousand rows at a time.
void readVerticesWithLists(ChunkedFile& file, const PlyElement& element, bool swapBytes, PlyRowSink& vertices) {
  BinaryRows walk(file, element, swapBytes);
  std::vector<std::byte> packed;
  std::vector<std::uint64_t> offsets;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    offsets.push_back(file.offset());
    std::size_t at = packed.size();
    packed.resize(at + vertices.rowBytes());
    for (const PlyProperty& property : element.properties) {
      if (property.isList) {
        walk.skipList(property, row);
      } else {
        walk.scalar(property, row, packed.data() + at);
        at += sizeOf(property.type);
      }
    }
    if (offsets.size() < kPointBatch && row + 1 < element.count) continue;
    if (const auto bad = vertices.append(packed.data(), offsets.size(), swapBytes))
      walk.fail(offsets[bad->row], bad->what);
    packed.clear();
    offsets.clear();
  }
}

}  // namespace

void checkPromise(const ChunkedFile& file, const PlyElement& element, std::uint64_t rowBytes, std::uint64_t spare) {
  const auto left = file.remaining();
  if (!left || rowBytes == 0 || element.count <= (*left + spare) / rowBytes) return;
  const std::string things = fmt::format("rows of element '{}'", element.name);
  throw endsAfter(file.path(), file.offset() + *left, *left / rowBytes, element.count, things,
                  element.hasLists() || spare > 0);
}

void readBinaryVertices(ChunkedFile& file, const PlyElement& element, bool swapBytes, PlyRowSink& vertices) {
  checkPromise(file, element, minBinaryRowBytes(element));
  if (file.remaining()) vertices.reserve(element.count);
  if (element.hasLists())
    readVerticesWithLists(file, element, swapBytes, vertices);
  else
    readPackedVertices(file, element, swapBytes, vertices);
}

void passBinaryElement(ChunkedFile& file, const PlyElement& element, bool swapBytes, PlyFaces* faces) {
  checkPromise(file, element, minBinaryRowBytes(element));
  BinaryRows walk(file, element, swapBytes);
  if (element.properties.empty()) return;
  if (!element.hasLists()) {
    const std::uint64_t rowBytes = element.scalarBytes();
    if (element.count > UINT64_MAX / rowBytes || !file.skip(element.count * rowBytes))
      throw FileError::atByte(file.path(), file.offset(),
                              fmt::format("the file ends in element '{}'; it is truncated", element.name));
    return;
  }
  const PlyProperty* indices = faces ? PlyFaces::indexList(element) : nullptr;
  const PlyProperty* uv = indices && faces->collectsCoordinates() ? PlyFaces::coordinateList(element) : nullptr;
  std::vector<std::int64_t> items;
  std::vector<double> coordinates;
  for (std::uint64_t row = 0; row < element.count; ++row) {
    const std::uint64_t offset = file.offset();
    std::uint32_t texture = 0;
    for (const PlyProperty& property : element.properties) {
      if (&property == uv) {
        walk.readList(property, row, coordinates);
      } else if (uv && property.name == kTextureNumber && !property.isList) {
        texture = static_cast<std::uint32_t>(walk.readNumber<std::int64_t>(property, row));
      } else if (&property == indices) {
        walk.readList(property, row, items);
        if (const auto wrong = faces->add(items, element.name == "tristrips")) walk.fail(offset, *wrong);
      } else if (property.isList) {
        walk.skipList(property, row);
      } else {
        walk.scalar(property, row, nullptr);
      }
    }
    if (uv) faces->addCoordinates(items, coordinates, texture);
  }
}

}  // namespace palpate
