// Sessions in Python: one pose at a time, contacts, nearest positions, ray casts, rows.
#include <algorithm>
#include <limits>

#include "apps/python/session.hpp"

namespace palpate::python {

namespace {

struct Field {
  const char *name, *format;
  std::size_t offset;
};

py::array arrayOf(std::initializer_list<Field> fields, std::size_t bytes, std::uint64_t rows) {
  py::list names, formats, offsets;
  for (const Field& field : fields) {
    names.append(field.name);
    formats.append(py::str(field.format));
    offsets.append(field.offset);
  }
  return {py::dtype(names, formats, offsets, static_cast<py::ssize_t>(bytes)), static_cast<py::ssize_t>(rows)};
}

// Numbers of clouds are signed here: PP_INSERTED is -1.
py::array surfacePoints(std::uint64_t rows) {
  return arrayOf({{"position", "3f8", offsetof(pp_surface_point, position)},
                  {"normal", "3f8", offsetof(pp_surface_point, normal)},
                  {"distance", "f8", offsetof(pp_surface_point, distance)},
                  {"row", "u8", offsetof(pp_surface_point, row)},
                  {"cloud", "i4", offsetof(pp_surface_point, cloud)},
                  {"found", "?", offsetof(pp_surface_point, found)},
                  {"behind", "?", offsetof(pp_surface_point, behind)}},
                 sizeof(pp_surface_point), rows);
}

}  // namespace

std::vector<PyContact> PySession::touchPoses(std::vector<pp_pose> poses, const std::vector<double>& orientations) {
  refuseDeaf();
  std::vector<pp_contact> contacts(poses.size());
  std::vector<double> torques_mNm(3 * poses.size());
  const auto ask = [&] {
    pp::check(pp_touch_hands(handle_, poses.data(), orientations.empty() ? nullptr : orientations.data(),
                             static_cast<std::uint32_t>(poses.size()), contacts.data(), torques_mNm.data()));
  };
  if (law_.python()) law_.python()->begin();
  if (budget_us_ > 0) {  // beside a call of another thread that looks at the session
    home_.require();
    if (law_.python()) law_.python()->refuseWithin();
    ContactListener::refuseWithin();
    const Heard::Delivery delivery(heard_);
    const WithoutGil released;
    ask();
  } else {
    with([&](pp::Session&) { ask(); });
  }
  if (listener_) listener_->raise();
  if (law_.python()) law_.python()->raise();
  std::vector<PyContact> answers(poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    answers[i].contact = contacts[i];
    std::copy_n(&torques_mNm[3 * i], 3, answers[i].torque_mNm);
  }
  return answers;
}

void PySession::onContact(const py::object& function) {
  auto listener = function.is_none() ? nullptr : std::make_unique<ContactListener>(function);
  with([&](pp::Session&) {
    pp::check(pp_session_on_contact(handle_, listener ? &ContactListener::hear : nullptr, listener.get()));
  });
  listener_ = std::move(listener);
}

py::array PySession::nearest(const py::object& positions, double max_distance, bool surface) {
  const py::array from = threeColumns(positions, "positions");
  py::array found = surfacePoints(static_cast<std::uint64_t>(from.shape(0)));
  const pp_rows rows = rowsOf(from);
  auto* const to = static_cast<pp_surface_point*>(found.mutable_data());
  const auto count = static_cast<std::uint64_t>(from.shape(0));
  with([&](pp::Session&) {
    pp::check((surface ? pp_session_nearest : pp_session_nearest_points)(handle_, &rows, count, max_distance, to));
  });
  return found;
}

py::array PySession::raycast(const py::object& origins, const py::object& directions, double max_distance) {
  const py::array from = threeColumns(origins, "origins");
  const py::array along = threeColumns(directions, "directions", from.shape(0));
  py::array found = surfacePoints(static_cast<std::uint64_t>(from.shape(0)));
  const pp_rows starts = rowsOf(from), ways = rowsOf(along);
  auto* const to = static_cast<pp_surface_point*>(found.mutable_data());
  const auto count = static_cast<std::uint64_t>(from.shape(0));
  with([&](pp::Session&) { pp::check(pp_session_raycast(handle_, &starts, &ways, count, max_distance, to)); });
  return found;
}

py::array PySession::rows() {
  const std::vector<pp_row> all = with([](pp::Session& open) { return open.sourceRows(); });
  py::array rows = arrayOf({{"row", "u8", offsetof(pp_row, row)},
                            {"cloud", "i4", offsetof(pp_row, cloud)},
                            {"changed", "?", offsetof(pp_row, changed)}},
                           sizeof(pp_row), all.size());
  std::ranges::copy(all, static_cast<pp_row*>(rows.mutable_data()));
  return rows;
}

void bindSessionsTicks(py::class_<PySession>& session) {
  session
      .def(
          "touch_pose",
          [](PySession& self, double t_s, const py::object& given, bool edit) {
            const std::array<double, 3> hip = threeNumbers(given, "hip");
            pp_pose pose{.t_s = t_s, .hip = {hip[0], hip[1], hip[2]}, .no_edit = edit ? 0u : 1u, .reserved = 0};
            return self.touchPoses({pose}, {}).front();
          },
          py::arg("t_s"), py::arg("hip"), py::arg("edit") = true,
          "touch_pose(t_s, hip, edit=True) -> Contact\n\n"
          "One tick, for a servo loop of the program. t_s: s, time of the pose, later than that of the pose\n"
          "before by the duration of a tick (UsageError if it is not later; after lift() any time). hip: three\n"
          "numbers, model units. edit: with the session's brush, if it has one. With budget_us (a keyword of Session) "
          "the answer does not wait for a query\n"
          "longer than that: it is then held, fades, and says how old it is; another thread may meanwhile\n"
          "call apply_edits(), which is needed some thirty times a second with a brush, render(), mesh(),\n"
          "nearest() and raycast(). Without it threads wait for one another. A fault gives no force and the\n"
          "validity \"none\"; an exception gives no Contact, and so no force. Commands between two ticks\n"
          "leave the contact as it is. A path, live() and lift() end it: the first pose after them, and of a session,\n"
          "may take long, and if it is inside, the hand touches nothing until it has left the surface. Python itself "
          "may delay a tick by 5 ms when other\n"
          "threads run: for a device at 1 kHz use live(), or the C interface.")
      .def(
          "touch_poses",
          [](PySession& self, double t_s, const py::object& hips, const std::optional<Doubles>& orientations,
             bool edit) {
            const Doubles places = Doubles::ensure(threeColumns(hips, "hips"));
            std::vector<pp_pose> poses(static_cast<std::size_t>(places.shape(0)));
            for (std::size_t i = 0; i < poses.size(); ++i) {
              poses[i].t_s = t_s;
              std::copy_n(places.data() + 3 * i, 3, poses[i].hip);
              poses[i].no_edit = edit ? 0 : 1;
            }
            std::vector<double> turns;
            if (orientations) turns.assign(orientations->data(), orientations->data() + orientations->size());
            if (orientations && turns.size() != 4 * poses.size())
              refuse("orientations: has the shape " + shapeOf(*orientations) + ", and not a row w x y z for each hand");
            return self.touchPoses(std::move(poses), turns);
          },
          py::arg("t_s"), py::arg("hips"), py::arg("orientations") = py::none(), py::arg("edit") = true,
          "touch_poses(t_s, hips, orientations=None, edit=True) -> list of Contact\n\n"
          "As touch_pose(), for all hands of the session at once. hips: (hands, 3), model units.\n"
          "orientations: (hands, 4), rotations of their tools, unit quaternions w x y z; None: no rotation.")
      .def(
          "lift", [](PySession& self) { self.with([](pp::Session& open) { open.lift(); }); },
          "lift()\n\n"
          "All hands were lifted: the next poses of touch_pose() begin new contacts elsewhere.")
      .def(
          "apply_edits", [](PySession& self) { self.with([](pp::Session& open) { open.applyEdits(); }); },
          "apply_edits()\n\n"
          "Takes in the edits that touch_pose() with a budget has made; call it some thirty times a second. In\n"
          "a joined session this also sends them to the other programs.")
      .def("on_contact", &PySession::onContact, py::arg("function"),
           "on_contact(function)\n\n"
           "Calls function(event), with a ContactEvent, at the beginning and at the end of each contact; None:\n"
           "no more. With touch_pose() it is called before that returns; by path, once the path is over, for\n"
           "all its ticks in order; live, by read_ticks(), or before on_ticks is called, and never on the\n"
           "servo thread. It must not call the session. An exception is raised by the call that delivers\n"
           "the event, and ends the force: a live session ends, and touch_pose() and live() raise Error until\n"
           "on_contact() is called again.");
}

void bindSessionsQueries(py::class_<PySession>& session) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  session
      .def("nearest", &PySession::nearest, py::arg("positions"), py::arg("max_distance") = kEndless,
           py::arg("surface") = true,
           "nearest(positions, max_distance=inf, surface=True) -> structured array\n\n"
           "For each position, the nearest one on the surface that the hands feel, edits included. positions:\n"
           "(N, 3), model units. max_distance: model units. Returns N rows: position and normal (3, model\n"
           "units), distance (model units), row and cloud of a point next to it (as in rows()), found, and\n"
           "behind, True if asked for from behind the surface. Where found is False all else is zero.\n"
           "surface=False finds the nearest point itself, with its normal, which is much faster. The\n"
           "first call builds an index; with several threads (the session's) rows are shared among them.")
      .def("raycast", &PySession::raycast, py::arg("origins"), py::arg("directions"),
           py::arg("max_distance") = kEndless,
           "raycast(origins, directions, max_distance=inf) -> structured array\n\n"
           "For each ray, the first position of that surface on it. origins, directions: (N, 3), model units,\n"
           "the directions of any length but 0. max_distance: from the origin, model units. Returns rows as\n"
           "nearest(), with the distance along the ray; behind is True if it is hit from behind.")
      .def("rows", &PySession::rows,
           "rows() -> structured array\n\n"
           "Where each row of cloud() comes from: row, cloud (0, or the index in Session.of_clouds(); -1: a\n"
           "brush has inserted it, and row counts those), and changed, True if it was moved, painted or\n"
           "inserted since the session was opened.");
}

}  // namespace palpate::python
