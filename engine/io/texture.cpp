#include "engine/io/texture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "engine/core/error.hpp"
#include "engine/core/parallel.hpp"
#include "engine/io/color_scale.hpp"
#include "engine/io/image_file.hpp"
#include "engine/io/in_quotes.hpp"

namespace palpate {

namespace {

/// Index of a pixel; `at` may lie outside of the picture.
std::size_t wrapped(std::int64_t at, std::int64_t size, TextureWrap wrap) {
  if (wrap == TextureWrap::clamp) return static_cast<std::size_t>(std::clamp<std::int64_t>(at, 0, size - 1));
  const std::int64_t period = wrap == TextureWrap::mirror ? 2 * size : size;
  at = (at % period + period) % period;
  return static_cast<std::size_t>(at < size ? at : period - 1 - at);
}

class Pixels {
 public:
  explicit Pixels(const Texture& texture)
      : texture_(texture),
        image_(texture.bytes.empty() ? readColorImage(texture.file, kLongestTextureSide)
                                     : colorImageIn(texture.file, texture.bytes, kLongestTextureSide)) {}

  /// Red, green and blue, 0 to 255.
  Vec3 at(Vec2 uv) const {
    constexpr float kFarthest = 1e6f;  // coordinates beyond, or that are not numbers, are those of the corner
    if (!(std::abs(uv.x) < kFarthest && std::abs(uv.y) < kFarthest)) uv = Vec2(0);
    // The colour of a pixel is at its centre.
    const double x = double(uv.x) * image_.width - (texture_.isSmooth ? 0.5 : 0),
                 y = double(uv.y) * image_.height - (texture_.isSmooth ? 0.5 : 0);
    const auto left = static_cast<std::int64_t>(std::floor(x)), top = static_cast<std::int64_t>(std::floor(y));
    if (!texture_.isSmooth) return pixel(left, top);
    const auto right = static_cast<float>(x - std::floor(x)), down = static_cast<float>(y - std::floor(y));
    return glm::mix(glm::mix(pixel(left, top), pixel(left + 1, top), right),
                    glm::mix(pixel(left, top + 1), pixel(left + 1, top + 1), right), down);
  }

 private:
  Vec3 pixel(std::int64_t x, std::int64_t y) const {
    const auto& rgb =
        image_.rgb[wrapped(y, image_.height, texture_.wrapV) * image_.width + wrapped(x, image_.width, texture_.wrapU)];
    return {rgb[0], rgb[1], rgb[2]};
  }

  const Texture& texture_;
  ColorImage image_;
};

}  // namespace

std::vector<std::string> multiplyByTextures(std::span<const Texture> textures, std::span<const TextureSpot> spots,
                                            std::span<Rgba> colors, unsigned threads) {
  std::array<double, 256> linear;
  for (std::size_t k = 0; k < linear.size(); ++k) linear[k] = linearOf(static_cast<std::uint8_t>(k));
  std::vector<std::string> lost;
  for (std::size_t which = 0; which < textures.size(); ++which) {
    try {
      const Pixels pixels(textures[which]);
      parallelFor(colors.size(), threads, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
          if (spots[i].texture != which) continue;
          const Vec3 seen = pixels.at(spots[i].uv);
          for (std::size_t k = 0; k < 3; ++k) {
            const auto byte = static_cast<std::uint8_t>(std::lround(seen[static_cast<int>(k)]));
            const std::uint8_t base = colors[i][k];
            colors[i][k] = base == 255 ? byte : srgbByte(linear[byte] * linear[base]);
          }
        }
      });
    } catch (const FileError& error) {
      lost.push_back(lostTexture(textures[which].name, error.what()));
    }
  }
  return lost;
}

std::string lostTexture(std::string_view name, std::string_view reason) {
  const std::string what = fmt::format("the colours of the texture {}", inQuotes(name));
  return reason.empty() ? what : fmt::format("{} ({})", what, reason);
}

std::filesystem::path textureBeside(const std::filesystem::path& folder, std::string name) {
  std::ranges::replace(name, '\\', '/');
  std::error_code ignored;
  const std::filesystem::path named = folder / name;
  if (std::filesystem::is_regular_file(named, ignored)) return named;
  return folder / named.filename();
}

}  // namespace palpate
