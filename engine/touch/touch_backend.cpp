#include "engine/touch/touch_backend.hpp"

#include "engine/core/error.hpp"

namespace palpate {

void TouchBackend::setContact(SurfaceKind, double, std::string_view) {
  throw UsageError("{}: this back end cannot change its surface", report().machine);
}

void TouchBackend::setBrush(const std::optional<BrushOptions>&) {
  throw UsageError("{}: this back end cannot change its brush", report().machine);
}

}  // namespace palpate
