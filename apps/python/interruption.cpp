#include "apps/python/interruption.hpp"

namespace palpate::python {

std::int32_t Interruption::isAsked(void* self) {
  auto& interruption = *static_cast<Interruption*>(self);
  const WithGil acquired;
  if (!acquired) return 1;
  if (!interruption.raised_ && PyErr_CheckSignals() != 0)
    interruption.raised_ = std::make_shared<py::error_already_set>();
  return interruption.raised_ ? 1 : 0;
}

void Interruption::throwRaised() {
  if (!raised_) return;
  const WithGil acquired;
  if (!acquired) return;
  const auto raised = std::exchange(raised_, nullptr);
  throw py::error_already_set(*raised);
}

}  // namespace palpate::python
