#include "engine/core/touch_backend.hpp"

#include "engine/core/error.hpp"

namespace palpate {

void TouchBackend::noEdits() const { throw Error("{}: this back end tells nobody of its edits", machine()); }

void TouchBackend::setContact(SurfaceKind, double, std::string_view) {
  throw UsageError("{}: this back end keeps the surface that it began with", machine());
}

}  // namespace palpate
