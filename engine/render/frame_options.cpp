#include "engine/render/frame_options.hpp"

#include <span>
#include <string>
#include <utility>

#include "engine/core/error.hpp"
#include "engine/core/named_values.hpp"
#include "engine/core/unknown_name.hpp"

namespace palpate {

namespace {

template <class T>
T named(std::string_view option, std::string_view name, std::span<const std::pair<std::string_view, T>> choices) {
  for (const auto& [text, value] : choices)
    if (text == name) return value;
  throw UsageError("{}: {}", option, unknownName("value", name, namesOf(choices)));
}

}  // namespace

bool showsWater(const FrameOptions& options) {
  return options.light.material == Material::water && options.pass == ImagePass::final &&
         options.color == ColorBy(ColorSource::rgb) && options.particles.radius > 0;
}

ImagePass imagePassNamed(std::string_view name) {
  static constexpr std::pair<std::string_view, ImagePass> kChoices[] = {
      {"final", ImagePass::final},   {"depth", ImagePass::depth}, {"smooth-depth", ImagePass::smoothDepth},
      {"normal", ImagePass::normal}, {"color", ImagePass::color}, {"position", ImagePass::position}};
  return named<ImagePass>("pass", name, kChoices);
}

Raster rasterNamed(std::string_view name) {
  static constexpr std::pair<std::string_view, Raster> kChoices[] = {{"compute", Raster::compute},
                                                                     {"hardware", Raster::hardware}};
  return named<Raster>("raster", name, kChoices);
}

}  // namespace palpate
