#include "engine/render/image.hpp"

#include <bit>

#include "engine/core/atomic_file.hpp"
#include "engine/core/check.hpp"
#include "engine/core/error.hpp"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace palpate {

void writePng(const std::filesystem::path& path, const Image& image) {
  PALPATE_CHECK_EQ(image.rgba.size(), std::size_t{image.width} * image.height);
  std::vector<std::byte> encoded;
  const auto append = [](void* to, void* data, int size) {
    const auto* bytes = static_cast<const std::byte*>(data);
    static_cast<std::vector<std::byte>*>(to)->insert(static_cast<std::vector<std::byte>*>(to)->end(), bytes,
                                                     bytes + size);
  };
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  if (!stbi_write_png_to_func(append, &encoded, width, height, 4, image.rgba.data(), width * 4))
    throw FileError(path, fmt::format("a picture of {} x {} pixels cannot be written as PNG", width, height));
  AtomicFile file(path);
  file.write(encoded);
  file.commit();
}

void writePfm(const std::filesystem::path& path, const DepthImage& image) {
  PALPATE_CHECK_EQ(image.depth.size(), std::size_t{image.width} * image.height);
  static_assert(std::endian::native == std::endian::little);
  AtomicFile file(path);
  // A negative scale says little-endian; rows go from the bottom up.
  file.write(fmt::format("Pf\n{} {}\n-1.0\n", image.width, image.height));
  for (std::uint32_t row = image.height; row-- > 0;)
    file.write(std::as_bytes(std::span(image.depth).subspan(std::size_t{row} * image.width, image.width)));
  file.commit();
}

}  // namespace palpate
