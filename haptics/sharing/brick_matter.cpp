#include "haptics/sharing/brick_matter.hpp"

#include <algorithm>
#include <memory>

#include "engine/matter/matter_touch.hpp"

namespace palpate {

namespace {

void toMetres(const std::vector<Vec3>& values, std::vector<Vec3>& values_m) {
  values_m.resize(values.size());
  std::ranges::transform(values, values_m.begin(),
                         [](const Vec3& value) { return value * static_cast<float>(kMatterUnit_m); });
}

}  // namespace

MatterNews newsOf(BrickSource& source) {
  return [&source, frame = std::make_shared<CloudFrame>()](KnownMatter& known) {
    const auto asked = source.asked();
    if (!asked || !source.hasNewer(asked->time_s, known.time_s)) return false;
    source.makeFrame(asked->time_s, *frame);
    known.ids = source.ids();
    toMetres(frame->positions, known.positions);
    toMetres(frame->velocities, known.velocities);
    known.velocities.resize(known.size(), Vec3(0));
    known.time_s = frame->time_s;
    return true;
  };
}

}  // namespace palpate
