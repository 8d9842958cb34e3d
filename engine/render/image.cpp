#include "engine/render/image.hpp"

#include <algorithm>
#include <bit>
#include <cctype>
#include <string>
#include <string_view>

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

namespace {

constexpr int kJpegQuality = 92;  // of 100; above 90 colours keep their full resolution

struct Ending {
  std::string_view text;
  ImageFormat format;
};
constexpr std::array<Ending, 3> kEndings{
    {{".png", ImageFormat::png}, {".jpg", ImageFormat::jpeg}, {".jpeg", ImageFormat::jpeg}}};

void append(void* to, void* data, int size) {
  auto& encoded = *static_cast<std::vector<std::byte>*>(to);
  const auto* bytes = static_cast<const std::byte*>(data);
  encoded.insert(encoded.end(), bytes, bytes + size);
}

}  // namespace

ImageFormat imageFormatOf(const std::filesystem::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  const auto* known = std::ranges::find(kEndings, ending, &Ending::text);
  if (known != kEndings.end()) return known->format;
  if (ending.empty() && isDeviceOrPipe(path)) return ImageFormat::png;
  throw UsageError("{}: pictures are written as .png, .jpg, .jpeg; use one of these extensions", path.string());
}

void writeImage(const std::filesystem::path& path, const Image& image) {
  PALPATE_CHECK_EQ(image.rgba.size(), std::size_t{image.width} * image.height);
  std::vector<std::byte> encoded;
  const int width = static_cast<int>(image.width), height = static_cast<int>(image.height);
  const int written = imageFormatOf(path) == ImageFormat::png
                          ? stbi_write_png_to_func(append, &encoded, width, height, 4, image.rgba.data(), width * 4)
                          : stbi_write_jpg_to_func(append, &encoded, width, height, 4, image.rgba.data(), kJpegQuality);
  if (!written) throw FileError(path, fmt::format("a picture of {} x {} pixels cannot be written", width, height));
  AtomicFile file(path);
  file.write(encoded);
  file.commit();
}

void writePfm(const std::filesystem::path& path, const DepthImage& image) {
  PALPATE_CHECK_EQ(image.depth.size(), std::size_t{image.width} * image.height);
  static_assert(std::endian::native == std::endian::little);
  AtomicFile file(path);
  // A negative scale means little-endian; rows go from bottom to top.
  file.write(fmt::format("Pf\n{} {}\n-1.0\n", image.width, image.height));
  for (std::uint32_t row = image.height; row-- > 0;)
    file.write(std::as_bytes(std::span(image.depth).subspan(std::size_t{row} * image.width, image.width)));
  file.commit();
}

}  // namespace palpate
