// Images of depth and colour cameras: written images are read exactly, and damaged ones are refused.
#include "engine/io/image_file.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "engine/core/error.hpp"
#include "tests/content_of.hpp"
#include "tests/png_bytes.hpp"
#include "tests/scratch_folder.hpp"

#define STB_IMAGE_WRITE_IMPLEMENTATION
#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image_write.h>
#pragma GCC diagnostic pop

namespace palpate::image_file_test {

namespace {

constexpr std::uint32_t kWidth = 7, kHeight = 5;

std::vector<std::uint16_t> ramp() {
  std::vector<std::uint16_t> values(kWidth * kHeight);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<std::uint16_t>(i * 1801 + 3);
  return values;
}

void append(void* to, void* data, int size) {
  static_cast<std::string*>(to)->append(static_cast<const char*>(data), static_cast<std::size_t>(size));
}

/// A smooth picture, so that compression loses little.
std::string jpegBytes(int width, int height) {
  std::vector<std::uint8_t> rgb;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (const int value : {4 * x, 4 * y, 128}) rgb.push_back(static_cast<std::uint8_t>(value));
  std::string bytes;
  stbi_write_jpg_to_func(append, &bytes, width, height, 3, rgb.data(), 95);
  return bytes;
}

class Refusal {
 public:
  std::string ofGrey(const std::string& bytes) const {
    return of(bytes, [](const auto& file) { readGreyImage(file); });
  }
  std::string ofColor(const std::string& bytes) const {
    return of(bytes, [](const auto& file) { readColorImage(file); });
  }

 private:
  std::string of(const std::string& bytes, auto&& read) const {
    const std::filesystem::path file = folder_ / "picture.png";
    writeBytes(file, bytes);
    try {
      read(file);
    } catch (const FileError& error) {
      CHECK(std::string(error.what()).starts_with(file.string() + ": "));
      return std::string(error.what()).substr(file.string().size() + 2);
    }
    return "read";
  }
  ScratchFolder folder_;
};

}  // namespace

TEST_CASE("a 16-bit greyscale PNG keeps every value") {
  const ScratchFolder folder;
  writeBytes(folder / "a.png", greyPng(kWidth, kHeight, ramp()));
  CHECK(imageSizeOf(folder / "a.png") == ImageSize{kWidth, kHeight});
  const GreyImage image = readGreyImage(folder / "a.png");
  CHECK(image.width == kWidth);
  CHECK(image.height == kHeight);
  CHECK(image.values == ramp());
}

TEST_CASE("colours are read from PNG and JPEG, and greyscale images give grey") {
  const ScratchFolder folder;
  writeBytes(folder / "a.png", pngBytes(2, 1, 8, 2, std::string("\1\2\3\xff\xfe\xfd", 6)));
  CHECK(readColorImage(folder / "a.png").rgb == std::vector<std::array<std::uint8_t, 3>>{{1, 2, 3}, {255, 254, 253}});
  writeBytes(folder / "grey.png", pngBytes(2, 1, 8, 0, "\x10\x90"));
  CHECK(readColorImage(folder / "grey.png").rgb ==
        std::vector<std::array<std::uint8_t, 3>>{{0x10, 0x10, 0x10}, {0x90, 0x90, 0x90}});
  writeBytes(folder / "a.jpg", jpegBytes(40, 24));
  const ColorImage jpeg = readColorImage(folder / "a.jpg");
  REQUIRE(jpeg.rgb.size() == 40 * 24);
  int worst = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 40; ++x) {
      const auto& pixel = jpeg.rgb[static_cast<std::size_t>(40 * y + x)];
      worst = std::max({worst, std::abs(pixel[0] - 4 * x), std::abs(pixel[1] - 4 * y), std::abs(pixel[2] - 128)});
    }
  CHECK(worst <= 12);
}

TEST_CASE("a PNG that is cut off anywhere, or has one flipped bit, is refused") {
  const Refusal refusal;
  const std::string whole = greyPng(kWidth, kHeight, ramp());
  REQUIRE(refusal.ofGrey(whole) == "read");
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CAPTURE(size);
    CHECK(refusal.ofGrey(whole.substr(0, size)) != "read");
  }
  for (std::size_t at = 0; at < whole.size(); ++at) {
    CAPTURE(at);
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x10);
    CHECK(refusal.ofGrey(damaged) != "read");
  }
  CHECK(refusal.ofGrey(whole.substr(0, whole.size() - 6)).find("ends within the picture") != std::string::npos);
}

TEST_CASE("a truncated JPEG is refused, not filled with grey") {
  const Refusal refusal;
  const std::string whole = jpegBytes(40, 24);
  REQUIRE(refusal.ofColor(whole) == "read");
  for (std::size_t size = 0; size + 1 < whole.size(); size += 7) {
    CAPTURE(size);
    CHECK(refusal.ofColor(whole.substr(0, size)) != "read");
  }
  CHECK(refusal.ofColor(whole.substr(0, whole.size() / 2 + 200)).find("ends within the picture") != std::string::npos);
}

TEST_CASE("an image that cannot hold depth is refused with the reason") {
  const Refusal refusal;
  const std::string kind = "is not a grey PNG of 16 bits, in which depth is stored";
  CHECK(refusal.ofGrey(pngBytes(2, 1, 8, 0, "\x10\x90")) == kind);
  CHECK(refusal.ofGrey(pngBytes(1, 1, 16, 2, std::string(6, '\1'))) == kind);
  CHECK(refusal.ofGrey(jpegBytes(16, 16)) == kind);
  CHECK(refusal.ofGrey("GIF89a") == "is neither a PNG nor a JPEG");
  CHECK(refusal.ofGrey("") == "is empty; copy it again");
  const ScratchFolder folder;
  CHECK_THROWS_WITH_AS(readGreyImage(folder / "none.png"), doctest::Contains("cannot be read"), FileError);
  CHECK_THROWS_WITH_AS(readGreyImage(folder.path()), doctest::Contains("is a folder"), FileError);
}

TEST_CASE("a wrong image size allocates no memory") {
  const Refusal refusal;
  std::string claims = greyPng(1, 1, std::vector<std::uint16_t>{7});
  // The header chunk follows the magic bytes and its length; its checksum is valid.
  const auto withSides = [&](std::uint32_t width, std::uint32_t height) {
    const std::string head = bigEndianWord(width) + bigEndianWord(height) + std::string("\x10\0\0\0\0", 5);
    return claims.substr(0, 8) + pngChunk("IHDR", head) + claims.substr(8 + 25);
  };
  REQUIRE(refusal.ofGrey(withSides(1, 1)) == "read");
  CHECK(refusal.ofGrey(withSides(8192, 8192)).find("claims 8192 x 8192 pixels, but ends after") == 0);
  CHECK(refusal.ofGrey(withSides(8193, 1)).find("a side has at most 8192") != std::string::npos);
  CHECK(refusal.ofGrey(withSides(0xffffffffu, 2)).find("a side has at most 8192") != std::string::npos);
  CHECK(refusal.ofGrey(withSides(0, 5)) != "read");
  CHECK(refusal.ofGrey(withSides(2, 2)) != "read");
}

TEST_CASE("a picture is resized by its nearest pixels") {
  ColorImage image{.width = 2, .height = 1, .rgb = {{1, 1, 1}, {2, 2, 2}}};
  const auto redOf = [](const ColorImage& of) {
    std::vector<int> red;
    for (const auto& pixel : of.rgb) red.push_back(pixel[0]);
    return red;
  };
  CHECK(redOf(resized(image, {4, 2})) == std::vector<int>{1, 1, 2, 2, 1, 1, 2, 2});
  CHECK(redOf(resized(image, {3, 1})) == std::vector<int>{1, 2, 2});
  CHECK(redOf(resized(image, {1, 1})) == std::vector<int>{2});
  CHECK(redOf(resized(image, {2, 1})) == std::vector<int>{1, 2});
}

}  // namespace palpate::image_file_test
