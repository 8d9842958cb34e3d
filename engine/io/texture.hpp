// Textures: pictures whose colours points take by their texture coordinates.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "engine/core/vec.hpp"

namespace palpate {

/// Position of coordinates outside of 0 to 1.
enum class TextureWrap : std::uint8_t { repeat, mirror, clamp };

/// A PNG or a JPEG, decoded only while its colours are taken.
struct Texture {
  std::filesystem::path file;    ///< the picture, or the file that contains `bytes`
  std::vector<std::byte> bytes;  ///< a picture within `file`; empty: `file` is the picture
  std::string name;              ///< for messages
  TextureWrap wrapU = TextureWrap::repeat, wrapV = TextureWrap::repeat;
  bool isSmooth = true;  ///< interpolated between pixels
};

inline constexpr std::uint32_t kNoTexture = 0xffffffff;

/// A position in a texture. `v` is 0 at the top of the picture and 1 at its bottom.
struct TextureSpot {
  std::uint32_t texture = kNoTexture;
  Vec2 uv{0};
};

using Rgba = std::array<std::uint8_t, 4>;

/// Multiplies `colors`, in linear light, by the textures at their spots; white becomes the texture's colour as the file
/// has it. One texture is in memory at a time. A texture that cannot be read changes nothing, and is named with the
/// reason in the returned list.
std::vector<std::string> multiplyByTextures(std::span<const Texture> textures, std::span<const TextureSpot> spots,
                                            std::span<Rgba> colors, unsigned threads = 0);

/// "the colours of the texture 'a.png' (reason)"
std::string lostTexture(std::string_view name, std::string_view reason = {});

/// The picture that a file names beside itself: by its relative path, or else by its name alone in the same folder, as
/// for paths of another machine. Backslashes separate folders too.
std::filesystem::path textureBeside(const std::filesystem::path& folder, std::string name);

}  // namespace palpate
