// Options of a picture. Independent of Vulkan.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "engine/render/camera.hpp"
#include "haptics/session/colored_field.hpp"
#include "haptics/session/light_config.hpp"

namespace palpate {

/// What errors of a picture call its colours.
inline constexpr ColorNames kPictureColors{.by = "color", .map = "color_map", .range = "color_range"};

struct PictureRequest {
  std::uint32_t width = 1280, height = 720;  ///< pixels
  std::uint32_t samples = 4;                 ///< per pixel: 1 or 4
  CameraRequest camera;                      ///< default: the model from the front, a little above
  ColorConfig color;
  LightConfig light;
  std::optional<std::array<std::uint8_t, 3>> background;  ///< RGB; empty: a quiet gradient
  bool transparent = false;                               ///< without a background; its pixels have opacity
};

}  // namespace palpate
