#include "haptics/session/framing.hpp"

#include <algorithm>

namespace palpate {

namespace {

// Margin of the picture and radius of the disc if all points are at one position, model units.
constexpr double kAroundLone = 1, kLone = 0.3;

// Points of a file fill a volume only if its user says so (Material::water).
Particles particlesOf(const Model& model) {
  return {.radius = model.discRadius() > 0 ? model.discRadius() : kWaterRadius_spacings * model.spacing,
          .spacing = model.spacing,
          .standing = static_cast<std::uint32_t>(model.standing())};
}

}  // namespace

Framing framingOf(const Model& model, UpAxis up) {
  Framing framing{.shown = model.shown, .up = up, .front = model.upright.frontFor(up)};
  framing.fromAbove = model.upright.isInterior;
  if (!(model.spacing > 0)) framing.margin = kAroundLone;
  // The discs of many points are smaller than the picture's own margin.
  constexpr double kFew = 0.02, kWidest = 0.1;  // of the longest side: a spacing, and the radius of a disc
  const double side = model.shownBounds().longestSide();
  if (model.spacing > kFew * side) framing.margin = std::min(model.spacing, kWidest * side);
  return framing;
}

double discRadiusOf(const Model& model) {
  if (model.discRadius() > 0) return model.discRadius();
  return model.spacing > 0 || model.cloud.empty() ? 0 : kLone;
}

FrameOptions frameOptionsOf(const Model& model, UpAxis up, const ColorConfig& color, const ColoredField* field,
                            const LightConfig& light, const LightFor& picture) {
  FrameOptions options;
  options.color = color.source().value_or(ColorSource::rgb);
  if (field) options.color = field->colors(color);
  options.colorMap = color.mapOf();
  options.splatRadius = discRadiusOf(model);
  options.gaussians = drawsGaussians(light.gaussians, model.cloud, picture.barePoints);
  options.hidesBacks = light.hidesBacks.value_or(model.upright.isInterior);
  options.up = directionOf(up);
  options.shown = model.shown;
  LightFor shown = picture;
  shown.ownColors = options.color != ColorBy(ColorSource::material);
  options.light = lightOf(light, model, shown);
  options.particles = particlesOf(model);
  return options;
}

std::string hiddenBacksNote(const Model& model, const LightConfig& light) {
  if (light.hidesBacks || !model.upright.isInterior) return "";
  return "it looks like a room or a street scanned from inside, so surfaces are not drawn from their backs; the "
         "setting backs draws them: shown";
}

}  // namespace palpate
