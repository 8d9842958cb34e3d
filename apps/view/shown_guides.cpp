#include "apps/view/shown_guides.hpp"

#include <utility>

namespace palpate {

void ShownGuides::follow(const Model& model, UpAxis up, LengthUnit unit, const GuideConfig& config) {
  const MadeOf now{config, up, unit};
  if (std::exchange(madeOf_, now) != now) guides_ = PictureGuides(config, model, up, unit);
}

std::shared_ptr<const std::vector<SpaceLine>> ShownGuides::linesWith(
    const std::shared_ptr<const std::vector<SpaceLine>>& lines, const Camera& camera, const UVec2& size_px) {
  if (!madeOf_.config.any()) return lines;
  ListOf now{lines, madeOf_, madeOf_.config.compass ? std::optional(camera) : std::nullopt, size_px};
  if (listOf_ != now) {
    listOf_ = std::move(now);
    list_ = guides_.linesWith(*lines, camera, size_px);
  }
  return list_;
}

}  // namespace palpate
