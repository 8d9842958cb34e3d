#include "haptics/session/picture.hpp"

#include <algorithm>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/edit/history.hpp"
#include "engine/gpu/device.hpp"
#include "engine/render/frame.hpp"
#include "engine/select/prepared_cloud.hpp"
#include "haptics/session/framing.hpp"

namespace palpate {

void SessionPicture::follow(const EditBatch& batch) {
  if (!drawn_ || batch.empty()) return;
  try {
    drawn_->catchUp(batch.points);
    drawn_->attributes().follow(batch.attributes);
  } catch (...) {
    drawn_.reset();  // the next picture copies all points again
    throw;
  }
}

std::optional<ColoredField> SessionPicture::shownField(const Layer& layer, const History* history,
                                                       const ColorConfig& color) {
  if (color.source()) return std::nullopt;
  const Model& model = *layer.model;
  ColoredField field(color, model.cloud, layer.attributes.fields(),
                     {.mm_per_unit = mmPerUnit(model.cloud, 0), .up = model.upright.up},
                     unitSaidIn(model.cloud.storedAs.comments), kPictureColors);
  std::vector<PointState> loaded;
  if (!history) loaded = statesOf(model.cloud);
  const std::span<const PointState> states = history ? std::span<const PointState>(history->points()) : loaded;
  field.read(states, layer.attributes.fields(), shownPoints(states, layer.attributes.mask(MaskRole::hidden)));
  drawn_->attributes().show(field.floats());
  return field;
}

Image SessionPicture::draw(const Layer& layer, const History* history, const PictureRequest& request) {
  const Model& model = *layer.model;
  Frame::checkSize(request.width, request.height);
  requireGaussians(request.light.gaussians, model.cloud, "splats");
  if (drawn_ && history && history->points().size() > drawn_->count()) drawn_.reset();
  if (!drawn_) {
    constexpr std::size_t kMinNew = 1 << 16;
    const std::size_t present = history ? history->points().size() : model.cloud.size();
    const std::size_t spare = history ? std::max(kMinNew, 2 * present - model.cloud.size()) : 0;
    drawn_.emplace(sight_, model.cloud,
                   DrawnOptions{.spare = static_cast<std::uint32_t>(spare),
                                .painted = history != nullptr,
                                .spacing = model.spacingOfDiscs(),
                                .edited = history != nullptr});
    if (history && history->version() > 0) drawn_->catchUp(history->points());
    drawn_->attributes().follow(layer.attributes.masks());
  }
  drawn_->closeSurface();
  const UpAxis up = model.upright.up;
  const std::optional<ColoredField> field = shownField(layer, history, request.color);
  FrameOptions options = frameOptionsOf(model, up, request.color, field ? &*field : nullptr, request.light,
                                        {.isSoftware = sight_.isCpu(), .barePoints = false});
  options.background = request.background;
  options.transparent = request.transparent;
  const double aspect = static_cast<double>(request.width) / request.height;
  const Camera camera = Camera::asked(request.camera, model.cloud, aspect, framingOf(model, up));
  Frame frame(sight_, request.width, request.height, request.samples > 1 ? 2 : 1);
  CommandList list(sight_, sight_.throughputQueue(), "picture");
  list.begin();
  frame.record(list, *drawn_, camera, options);
  list.end();
  sight_.throughputQueue().run(list);
  return frame.readColor();
}

}  // namespace palpate
