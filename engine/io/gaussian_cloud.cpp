#include "engine/io/gaussian_cloud.hpp"

#include <fmt/format.h>

#include "engine/cloud/gaussian_records.hpp"
#include "engine/cloud/gaussian_surface.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/counted.hpp"

namespace palpate {

StoredCloud surfaceOfGaussians(const std::string& name, GaussianScene scene, Log* log) {
  const std::size_t gaussians = scene.size(), bad = leaveOutBad(scene);
  const Stopwatch watch;
  GaussianSurface surface = surfaceOf(scene);
  if (log) {
    log->say(
        "{}: {}, {:.3g} apart, are the surface of {}; made in {:.0f} ms. Left out: {} faint, {} oversized, {} "
        "far from all others, {} not finite",
        name, counted(surface.cloud.size(), "point"), surface.spacing, counted(gaussians, "Gaussian"),
        watch.elapsed_us() * 1e-3, surface.faint, surface.oversized, surface.outlying, bad);
    if (surface.cloud.empty() && gaussians > 0) log->warn("{}: no Gaussian is visible; there is no surface", name);
  }
  StoredCloud stored{.cloud = std::move(surface.cloud)};
  const auto lose = [&](std::size_t count, std::string_view why) {
    if (count > 0) stored.lost.push_back(fmt::format("{} {}", counted(count, "Gaussian"), why));
  };
  lose(bad, "whose numbers are not finite or whose rotation is zero");
  lose(surface.oversized, "that are oversized");
  lose(surface.outlying, "far from all others");
  return stored;
}

}  // namespace palpate
