#include "engine/motion/map_view.hpp"

#include <atomic>
#include <bit>

#include "engine/core/parallel.hpp"

namespace palpate {

namespace {

void lower(std::uint64_t& value, std::uint64_t to) {
  const std::atomic_ref shared(value);
  std::uint64_t now = shared.load(std::memory_order_relaxed);
  while (to < now && !shared.compare_exchange_weak(now, to, std::memory_order_relaxed)) {
  }
}

}  // namespace

void viewMap(const SurfelMap& map, const shared::FusionView& view, MapView& image) {
  const std::size_t pixels = std::size_t{view.width} * view.height;
  image.view = view;
  // Depth, whose bits are in the order of its values since it is positive, above the id.
  std::vector<std::uint64_t> nearest(pixels, ~std::uint64_t{0});
  parallelFor(map.ids(), map.options().threads, [&](std::size_t begin, std::size_t end) {
    for (std::size_t id = begin; id < end; ++id) {
      if (!map.holds(id)) continue;
      const shared::Surfel& surfel = map.surfel(id);
      const shared::Projection projection = shared::projectionOf(view, surfel.place);
      if (!projection.inView || glm::dot(surfel.normal, surfel.place - view.centre) >= 0) continue;
      lower(nearest[std::size_t{projection.pixel.y} * view.width + projection.pixel.x],
            std::uint64_t{std::bit_cast<std::uint32_t>(projection.place.z)} << 32 | id);
    }
  });
  image.ids.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) image.ids[i] = static_cast<std::uint32_t>(nearest[i]);
}

}  // namespace palpate
