#include "engine/io/bag_file.hpp"

#include <array>
#include <string_view>

#include "engine/core/error.hpp"
#include "engine/io/chunked_file.hpp"

namespace palpate {

namespace {

// Of ROS 1, whose form RealSense cameras share, and of ROS 2 (MCAP, and SQLite).
constexpr std::array<std::string_view, 3> kMagics{"#ROSBAG V", "\x89MCAP", "SQLite format 3"};
constexpr std::size_t kMaxNameBytes = 16;

}  // namespace

void refuseBag(const std::filesystem::path& file) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(file, ignored)) return;
  ChunkedFile in(file);
  const auto bytes = in.peek(kMaxNameBytes);
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const std::string_view magic : kMagics)
    if (text.starts_with(magic))
      throw FileError(file,
                      "is a bag of ROS or of a RealSense camera, which is not read here; Open3D writes a RealSense "
                      "one as a folder that is (open3d.t.io.RGBDVideoReader.create(BAG).save_frames(FOLDER)), and "
                      "ROS's image_view extracts pictures");
}

}  // namespace palpate
