#include "apps/view/measure.hpp"

#include <charconv>

#include "engine/core/error.hpp"
#include "haptics/session/bounds.hpp"

namespace palpate {

void Measure::take(const PickedPosition& picked) {
  if (picked_.size() == 2) picked_.clear();
  picked_.push_back(picked);
  ++version_;
}

void Measure::belongTo(const std::string& file) {
  if (file != file_) forget();
  file_ = file;
}

void Measure::forget() {
  picked_.clear();
  ++version_;
}

std::optional<double> Measure::distance() const {
  if (picked_.size() < 2) return std::nullopt;
  return glm::distance(picked_[0].place, picked_[1].place);
}

std::optional<DVec2> Measure::middle_px(const Camera& camera, const UVec2& size_px) const {
  if (!distance()) return std::nullopt;
  const auto at = camera.project(0.5 * (picked_[0].place + picked_[1].place), DVec2(size_px));
  return at ? std::optional(DVec2(*at)) : std::nullopt;
}

double Measure::scaleFor(const std::string& text) const {
  double true_mm = 0;
  const char* const end = text.data() + text.size();
  const auto [last, error] = std::from_chars(text.data(), end, true_mm);
  if (error != std::errc() || last != end || !(true_mm > 0))
    throw Error("true length: '{}' is not a positive length in mm", text);
  const double units = distance().value_or(0);
  if (!(units > 0)) throw Error("nothing is measured: click two different positions on the model first");
  const double scale = true_mm / units;
  if (!(scale >= bounds::kMinScale && scale <= bounds::kMaxScale))
    throw Error("{} mm for {:.6g} units are {} mm per unit, which is not between {} and {}", true_mm, units, scale,
                bounds::kMinScale, bounds::kMaxScale);
  return scale;
}

}  // namespace palpate
