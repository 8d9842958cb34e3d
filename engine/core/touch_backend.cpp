#include "engine/core/touch_backend.hpp"

#include "engine/core/error.hpp"

namespace palpate {

void TouchBackend::noEdits() const { throw Error("{}: this back end tells nobody of its edits", machine()); }

}  // namespace palpate
