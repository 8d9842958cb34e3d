#include "engine/io/colmap_views.hpp"

#include <bit>
#include <cstring>
#include <optional>
#include <utility>
#include <vector>

#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"

namespace palpate {

namespace {

class ViewsFile {
 public:
  ViewsFile(const std::filesystem::path& path, const ColmapViewsOf& what, std::function<void(double)> progress)
      : file_(path), what_(what) {
    file_.onProgress(std::move(progress));
  }

  void readCount() {
    const auto count = take<std::uint64_t>();
    if (!count) fail(file_.offset(), "ends where the number of points should be");
    if (*count != what_.points)
      fail(0, fmt::format("has the views of {} points, and {} has {}", *count, what_.cloud.filename().string(),
                          what_.points));
  }

  /// The result is valid until the next call.
  std::span<const std::uint32_t> readPoint(std::uint64_t point) {
    const std::uint64_t begin = file_.offset();
    const auto count = take<std::uint32_t>();
    if (!count) fail(begin, fmt::format("ends before the views of point {} of {}", point + 1, what_.points));
    images_.clear();
    for (std::uint32_t k = 0; k < *count; ++k) {
      const std::uint64_t at = file_.offset();
      const auto image = take<std::uint32_t>();
      if (!image) fail(begin, fmt::format("ends within the {} views of point {}", *count, point + 1));
      if (*image >= what_.images)
        fail(at, fmt::format("point {} was seen by image {}, counted from 0, and the model has {}", point + 1, *image,
                             what_.images));
      images_.push_back(*image);
    }
    return images_;
  }

  void requireEnd() {
    if (!file_.peek(1).empty()) fail(file_.offset(), "has data after the views of the last point");
  }

 private:
  template <class T>
  std::optional<T> take() {
    static_assert(std::endian::native == std::endian::little, "the files are little-endian");
    const auto bytes = file_.peek(sizeof(T));
    if (bytes.size() < sizeof(T)) return std::nullopt;
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    file_.consume(sizeof value);
    return value;
  }

  [[noreturn]] void fail(std::uint64_t byte, const std::string& what) const {
    const std::string cloud = what_.cloud.filename().string();
    throw FileError::atByte(file_.path(), byte,
                            fmt::format("{}; fuse {} again with COLMAP, or remove this file to read it without its "
                                        "views",
                                        what, cloud));
  }

  ChunkedFile file_;
  const ColmapViewsOf& what_;
  std::vector<std::uint32_t> images_;
};

}  // namespace

void readColmapViews(const std::filesystem::path& file, const ColmapViewsOf& what,
                     const std::function<void(std::uint64_t, std::span<const std::uint32_t>)>& visit,
                     const std::function<void(double)>& progress) {
  ViewsFile views(file, what, progress);
  views.readCount();
  for (std::uint64_t point = 0; point < what.points; ++point) visit(point, views.readPoint(point));
  views.requireEnd();
}

}  // namespace palpate
