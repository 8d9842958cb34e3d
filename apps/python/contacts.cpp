#include "apps/python/contacts.hpp"

#include <utility>

namespace palpate::python {

namespace {

const char* validityOf(const PyContact& answer) {
  switch (pp::validityOf(answer.contact)) {
    case pp::Validity::fresh:
      return "fresh";
    case pp::Validity::held:
      return "held";
    case pp::Validity::none:
      break;
  }
  return "none";
}

}  // namespace

thread_local bool ContactListener::isWithin_ = false;

ContactListener::ContactListener(py::object function) : function_(std::move(function)) {
  if (PyCallable_Check(function_.ptr()) == 0) refuseType("function: must be a function, not " + described(function_));
}

void ContactListener::hear(void* user, const pp_contact_event* event) {
  auto& self = *static_cast<ContactListener*>(user);
  if (self.failed_) return;
  const WithGil held;
  if (!held || self.function_.is_none()) return;
  struct Within {
    Within() { isWithin_ = true; }
    ~Within() { isWithin_ = false; }
  } const within;
  try {
    self.function_(*event);
  } catch (const py::error_already_set& error) {
    self.sentence_ =
        "on_contact: its function has raised " + py::str(error.type().attr("__name__")).cast<std::string>() + ": " +
        py::str(error.value()).cast<std::string>() + "; this session has no force until on_contact() is called again";
    self.raised_ = std::current_exception();
    self.failed_ = true;
  }
}

void ContactListener::raise() {
  if (const std::exception_ptr raised = std::exchange(raised_, nullptr)) std::rethrow_exception(raised);
}

namespace {

// As in "(0, 0.5, -1)".
py::str shown(const double (&v)[3]) { return py::str("({:.4g}, {:.4g}, {:.4g})").format(v[0], v[1], v[2]); }

py::str shownContact(const PyContact& answer) {
  const pp_contact& c = answer.contact;
  if (c.contact == 0) return py::str("<palpate.Contact: {}, no contact>").format(validityOf(answer));
  return py::str("<palpate.Contact: {}, {:.4g} mm deep at {}, force {} N{}>")
      .format(validityOf(answer), c.penetration_mm, shown(c.proxy), shown(c.force_N), c.withheld ? ", withheld" : "");
}

py::str shownEvent(const pp_contact_event& e) {
  return py::str("<palpate.ContactEvent: hand {} {} at {:.4g} s, at {}>")
      .format(e.hand, e.begins != 0 ? "begins" : "ends", e.t_s, shown(e.proxy));
}

}  // namespace

void bindContacts(py::module_& module) {
  py::class_<pp_contact_event>(
      module, "ContactEvent",
      "Beginning or end of a contact, for Session.on_contact(): t_s (s), hand, begins, and of the tick at\n"
      "which it began, or the last one in contact, proxy and normal (model units) and force_N.")
      .def_property_readonly(
          "t_s", [](const pp_contact_event& e) { return e.t_s; },
          "Seconds: time of the tick at which the contact began or ended.")
      .def_property_readonly(
          "hand", [](const pp_contact_event& e) { return e.hand; }, "Index of the hand, from 0.")
      .def_property_readonly(
          "begins", [](const pp_contact_event& e) { return e.begins != 0; },
          "True if the contact begins, False if it ends.")
      .def_property_readonly(
          "proxy", [](const pp_contact_event& e) { return vectorOf(e.proxy); },
          "Position on the surface: three floats, model units.")
      .def_property_readonly(
          "normal", [](const pp_contact_event& e) { return vectorOf(e.normal); }, "Three floats, unit length, outward.")
      .def_property_readonly(
          "force_N", [](const pp_contact_event& e) { return vectorOf(e.force_N); },
          "Force on the hand: three floats, N.")
      .def("__repr__", &shownEvent);
  py::class_<PyContact>(
      module, "Contact",
      "Answer to one pose, of Session.touch_pose(): validity, age_s, contact, proxy and normal (model\n"
      "units), force_N, withheld, torque_mNm, penetration_mm, neighbours.")
      .def_property_readonly("validity", &validityOf,
                             "\"fresh\": from the pose's own query; \"held\": bridged, because the answer would have\n"
                             "been late; \"none\": a fault, and no force.")
      .def_property_readonly(
          "age_s", [](const PyContact& c) { return c.contact.age_s; },
          "Seconds: age of the data from which it was computed; 0 if fresh, negative without data.")
      .def_property_readonly(
          "contact", [](const PyContact& c) { return c.contact.contact != 0; }, "True if the hand touches the surface.")
      .def_property_readonly(
          "proxy", [](const PyContact& c) { return vectorOf(c.contact.proxy); },
          "Position on the surface, or of the hand without contact: three floats, model units.")
      .def_property_readonly(
          "normal", [](const PyContact& c) { return vectorOf(c.contact.normal); },
          "Three floats, unit length, outward; zero if no surface was within reach.")
      .def_property_readonly(
          "force_N", [](const PyContact& c) { return vectorOf(c.contact.force_N); },
          "Force on the hand: three floats, N.")
      .def_property_readonly(
          "withheld", [](const PyContact& c) { return c.contact.withheld != 0; },
          "True if in contact force_N is less than the surface's, because forces were gone: after at most\n"
          "0.1 s without an answer they return over half a second, otherwise once the hand has left the surface.")
      .def_property_readonly(
          "torque_mNm", [](const PyContact& c) { return vectorOf(c.torque_mNm); },
          "Torque about the hip, of a tool of many points or of a ball in matter: three floats, mN m.")
      .def_property_readonly(
          "penetration_mm", [](const PyContact& c) { return c.contact.penetration_mm; }, "From hip to proxy, mm.")
      .def_property_readonly(
          "neighbours", [](const PyContact& c) { return c.contact.neighbours; },
          "Number of points within the support radius.")
      .def("__repr__", &shownContact);
}

}  // namespace palpate::python
