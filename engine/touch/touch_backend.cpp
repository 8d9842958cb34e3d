#include "engine/touch/touch_backend.hpp"

#include "engine/core/error.hpp"

namespace palpate {

void requireStates(std::size_t given, std::size_t probes) {
  if (given != probes) throw Error("the states of {} contacts do not belong to {} probes", given, probes);
}

void TouchBackend::setContact(SurfaceKind, double, std::string_view) {
  throw UsageError("{}: this back end cannot change its surface", report().machine);
}

void TouchBackend::setBrush(const std::optional<BrushOptions>&) {
  throw UsageError("{}: this back end cannot change its brush", report().machine);
}

}  // namespace palpate
