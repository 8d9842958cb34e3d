#include "apps/python/law.hpp"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <system_error>
#include <utility>

namespace palpate::python {

namespace {

/// Argument of a law in Python.
struct LawInput {
  pp_pose pose;
  pp_contact contact;
  double dt_s;
};

using Vector = std::array<double, 3>;

}  // namespace

thread_local const PythonLaw* PythonLaw::under_ = nullptr;

PythonLaw::PythonLaw(py::object callable) : callable_(std::move(callable)), process_(::getpid()) {}

void PythonLaw::setLive(bool live) {
  if (live == live_) return;
  if (live) {
    begin();
    stop_ = false;
    isAsked_ = false;
    last_ = {};
    while (asked_.try_acquire() || answered_.try_acquire()) {
    }
    try {
      thread_ = std::thread([this] { serve(); });
    } catch (const std::system_error& error) {
      throw Refusal("Error",
                    "law: the system does not start another thread (" + error.code().message() +
                        "); raise the limit of threads (ulimit -u)",
                    PP_ERROR_FAILED);
    }
    live_ = true;
    return;
  }
  live_ = false;
  if (process_ != ::getpid()) return thread_.detach();  // a forked process does not have the thread
  stop_ = true;
  asked_.release();
  const WithoutGil released;  // the thread may be waiting for the lock
  thread_.join();
}

void PythonLaw::begin() {
  failed_ = false;
  raised_ = nullptr;
}

void PythonLaw::raise() {
  if (!failed_) return;
  if (const std::exception_ptr raised = std::exchange(raised_, nullptr)) std::rethrow_exception(raised);
}

PythonLaw::Answer PythonLaw::answerTo(const Question& question) {
  Answer answer{.t_s = question.pose.t_s};
  if (failed_) return answer;
  const WithGil held;
  if (!held) return answer;
  struct Under {
    explicit Under(const PythonLaw* law) : before(std::exchange(under_, law)) {}
    ~Under() { under_ = before; }
    const PythonLaw* before;
  } const under(this);
  try {
    const py::object given = callable_(LawInput{question.pose, question.contact, question.dt_s});
    const auto force_N = given.cast<Vector>();
    if (!std::ranges::all_of(force_N, [](double f) { return std::isfinite(f); }))
      refuse("law: returned a force that is not finite");
    answer.force_N = force_N;
  } catch (const py::cast_error&) {
    raised_ = std::make_exception_ptr(Refusal("ArgumentTypeError", "law: did not return a force of three numbers, N"));
    failed_ = true;
  } catch (...) {
    raised_ = std::current_exception();
    failed_ = true;
  }
  return answer;
}

void PythonLaw::serve() {
  for (asked_.acquire(); !stop_; asked_.acquire()) {
    answer_ = answerTo(question_);
    answered_.release();
  }
}

void PythonLaw::answerLive(const Question& question, double force_N[3]) {
  const auto end = std::chrono::steady_clock::now() + kPatience;
  const auto takes = [&] {
    if (!isAsked_ || !answered_.try_acquire_until(end)) return false;
    isAsked_ = false;
    last_ = answer_;
    return true;
  };
  takes();  // the answer that was late for an earlier tick
  if (!isAsked_) {
    question_ = question;
    isAsked_ = true;
    asked_.release();
    takes();
  }
  const double age_s = question.pose.t_s - last_.t_s;
  if (age_s > 0) ++late_;
  const double left = failed_ ? 0 : std::clamp((kGone_s - age_s) / (kGone_s - kHeld_s), 0.0, 1.0);
  for (std::size_t k = 0; k < 3; ++k) force_N[k] = left * last_.force_N[k];
}

void PythonLaw::call(void* user, const pp_pose* pose, const pp_contact* contact, double dt_s, double force_N[3]) {
  auto& law = *static_cast<PythonLaw*>(user);
  const Question question{*pose, *contact, dt_s};
  if (law.live_) return law.answerLive(question, force_N);
  const Answer answer = law.answerTo(question);
  std::ranges::copy(answer.force_N, force_N);
}

Law::Law(const py::object& given, bool allowPython) {
  if (given.is_none()) return;
  if (py::isinstance<py::str>(given)) {
    library_ = given.cast<std::string>();
    return;
  }
  const py::object address = py::hasattr(given, "address") ? py::object(given.attr("address")) : given;
  if (py::isinstance<py::int_>(address) && !py::isinstance<py::bool_>(address)) {
    constexpr std::uintptr_t kFirstPage = 4096;  // contains no function
    const auto place = address.cast<std::uintptr_t>();
    if (place < kFirstPage) refuse("law: " + std::to_string(place) + " is not the address of a function");
    function_ = reinterpret_cast<pp_force_law>(place);
    return;
  }
  if (PyCallable_Check(given.ptr()) == 0)
    refuseType("law: must be \"libmine.so:law\", a numba cfunc or a function, not " + described(given));
  if (!allowPython)
    refuseType(
        "law: a function in Python runs in every tick and waits for Python's lock: some 30 us while no other thread "
        "holds it, and 5 ms and more with one busy thread, which a hand feels as a force that lags and "
        "fades. Use a compiled function (\"libmine.so:law\", or a numba cfunc), or pass allow_python_law=True");
  python_ = std::make_shared<PythonLaw>(given);
  function_ = &PythonLaw::call;
}

void bindLaws(py::module_& module) {
  py::class_<LawInput>(
      module, "LawInput",
      "Argument of a force law in Python, once for each tick of contact: t_s and dt_s (s), hip, proxy\n"
      "and normal (model units), force_N (of spring and damper), penetration_mm, neighbours, fresh. The\n"
      "law returns the force on the hand, three numbers in N; the limits of magnitude and rise apply to\n"
      "it.")
      .def_property_readonly(
          "t_s", [](const LawInput& in) { return in.pose.t_s; }, "Seconds: time of the tick.")
      .def_property_readonly(
          "dt_s", [](const LawInput& in) { return in.dt_s; }, "Seconds since the tick before.")
      .def_property_readonly(
          "hip", [](const LawInput& in) { return vectorOf(in.pose.hip); },
          "The haptic interface point: three floats, model units.")
      .def_property_readonly(
          "proxy", [](const LawInput& in) { return vectorOf(in.contact.proxy); },
          "Position of the proxy on the surface: three floats, model units.")
      .def_property_readonly(
          "normal", [](const LawInput& in) { return vectorOf(in.contact.normal); },
          "Three floats, unit length, outward.")
      .def_property_readonly(
          "force_N", [](const LawInput& in) { return vectorOf(in.contact.force_N); },
          "Force on the hand of spring and damper: three floats, N.")
      .def_property_readonly(
          "penetration_mm", [](const LawInput& in) { return in.contact.penetration_mm; }, "From hip to proxy, mm.")
      .def_property_readonly(
          "neighbours", [](const LawInput& in) { return in.contact.neighbours; },
          "Number of points within the support radius.")
      .def_property_readonly(
          "fresh", [](const LawInput& in) { return in.contact.fresh != 0; },
          "True if the answer is of this tick's own query, False if it was bridged.");
}

}  // namespace palpate::python
