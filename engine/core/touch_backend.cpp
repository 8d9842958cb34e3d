#include "engine/core/touch_backend.hpp"

#include "engine/core/error.hpp"

namespace palpate {

void TouchBackend::noEdits() const { throw Error("{}: this back end does not report its edits", machine()); }

void TouchBackend::setContact(SurfaceKind, double, std::string_view) {
  throw UsageError("{}: this back end cannot change its surface", machine());
}

}  // namespace palpate
