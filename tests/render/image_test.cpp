#include "engine/render/image.hpp"

#include <doctest/doctest.h>

#include <cstring>
#include <fstream>
#include <iterator>
#include <string>

#include "engine/core/error.hpp"
#include "tests/scratch_folder.hpp"

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace palpate::image_test {

namespace {

std::string bytesOf(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Image testImage(std::uint32_t width, std::uint32_t height) {
  Image image{width, height, {}};
  for (std::uint32_t i = 0; i < width * height; ++i)
    image.rgba.push_back(
        {static_cast<std::uint8_t>(i * 7), static_cast<std::uint8_t>(i >> 3), static_cast<std::uint8_t>(i * i), 255});
  return image;
}

}  // namespace

TEST_CASE("a PNG contains the picture pixel by pixel, and is identical every time") {
  const ScratchFolder folder;
  for (const auto& [width, height] : {std::pair{1u, 1u}, {33u, 17u}, {200u, 150u}}) {
    const Image image = testImage(width, height);
    writeImage(folder / "a.png", image);
    writeImage(folder / "b.png", image);
    CHECK(bytesOf(folder / "a.png") == bytesOf(folder / "b.png"));
    int w = 0, h = 0, channels = 0;
    unsigned char* pixels = stbi_load((folder / "a.png").string().c_str(), &w, &h, &channels, 4);
    REQUIRE(pixels);
    CHECK(w == static_cast<int>(width));
    CHECK(h == static_cast<int>(height));
    CHECK(std::memcmp(pixels, image.rgba.data(), image.rgba.size() * 4) == 0);
    stbi_image_free(pixels);
  }
}

TEST_CASE("a name that ends in .jpg or .jpeg gives a JPEG of the same picture") {
  const ScratchFolder folder;
  Image image{200, 150, {}};
  for (int y = 0; y < 150; ++y)
    for (int x = 0; x < 200; ++x)
      image.rgba.push_back({static_cast<std::uint8_t>(x), static_cast<std::uint8_t>(y), 128, 255});
  for (const char* name : {"a.jpg", "b.jpeg", "c.JPG"}) {
    writeImage(folder / name, image);
    CHECK(bytesOf(folder / name).starts_with("\xff\xd8\xff"));
    int w = 0, h = 0, channels = 0;
    unsigned char* pixels = stbi_load((folder / name).string().c_str(), &w, &h, &channels, 4);
    REQUIRE(pixels);
    CHECK(w == 200);
    CHECK(h == 150);
    int furthest = 0;
    for (std::size_t i = 0; i < image.rgba.size(); ++i)
      for (std::size_t k = 0; k < 3; ++k) furthest = std::max(furthest, std::abs(pixels[4 * i + k] - image.rgba[i][k]));
    CHECK(furthest < 8);
    stbi_image_free(pixels);
  }
}

TEST_CASE("a name with an unknown extension is refused with the list of formats") {
  const ScratchFolder folder;
  for (const char* name : {"a.tif", "b.png.bak", "c.pngx", "bare"}) {
    CHECK_THROWS_WITH_AS(writeImage(folder / name, testImage(2, 2)), doctest::Contains(".jpg"), UsageError);
    CHECK_FALSE(std::filesystem::exists(folder / name));
  }
  writeImage(folder / "LOUD.PNG", testImage(2, 2));
  CHECK(bytesOf(folder / "LOUD.PNG").starts_with("\x89PNG"));
}

TEST_CASE("a PFM contains the depths bit by bit, bottom row first") {
  const ScratchFolder folder;
  const DepthImage image{2, 3, {1.5f, 2.0f, 0.0f, 3.25f, 1e-20f, 1e20f}};
  writePfm(folder / "depth.pfm", image);
  std::string expected = "Pf\n2 3\n-1.0\n";
  for (const float value : {1e-20f, 1e20f, 0.0f, 3.25f, 1.5f, 2.0f}) {
    char bytes[4];
    std::memcpy(bytes, &value, 4);
    expected.append(bytes, 4);
  }
  CHECK(bytesOf(folder / "depth.pfm") == expected);
}

TEST_CASE("a picture that cannot be written is an error with its path") {
  const ScratchFolder folder;
  CHECK_THROWS_WITH_AS(writeImage(folder / "no" / "such.png", testImage(2, 2)), doctest::Contains("such.png"),
                       FileError);
  CHECK_THROWS_AS(writePfm(folder / "no" / "such.pfm", DepthImage{1, 1, {0}}), FileError);
}

}  // namespace palpate::image_test
