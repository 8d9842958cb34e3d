#include "engine/render/frame_options.hpp"

#include <span>
#include <string>
#include <utility>

#include "engine/core/error.hpp"

namespace palpate {

namespace {

// Where points are strewn at random, an area of pi r^2 is empty with probability exp(-pi (r / spacing)^2): this radius
// leaves about one such place in 160,000 spacings squared.
constexpr double kSplatRadius_spacings = 1.95;

template <class T>
T named(std::string_view option, std::string_view name, std::span<const std::pair<std::string_view, T>> choices) {
  std::string known;
  for (const auto& [text, value] : choices) {
    if (text == name) return value;
    known += known.empty() ? "" : ", ";
    known += text;
  }
  throw UsageError("{}: '{}' is not known; known are {}", option, name, known);
}

}  // namespace

ImagePass imagePassNamed(std::string_view name) {
  static constexpr std::pair<std::string_view, ImagePass> kChoices[] = {{"final", ImagePass::final},
                                                                        {"depth", ImagePass::depth},
                                                                        {"normal", ImagePass::normal},
                                                                        {"color", ImagePass::color},
                                                                        {"position", ImagePass::position}};
  return named<ImagePass>("--pass", name, kChoices);
}

ColorBy colorByNamed(std::string_view name) {
  static constexpr std::pair<std::string_view, ColorBy> kChoices[] = {
      {"rgb", ColorBy::rgb}, {"normal", ColorBy::normal}, {"depth", ColorBy::depth}, {"height", ColorBy::height}};
  return named<ColorBy>("--color", name, kChoices);
}

double automaticSplatRadius(double spacing) { return kSplatRadius_spacings * spacing; }

}  // namespace palpate
