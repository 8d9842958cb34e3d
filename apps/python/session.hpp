// A session in Python.
#pragma once

#include <mutex>
#include <optional>
#include <utility>

#include "apps/python/arrays.hpp"
#include "apps/python/contacts.hpp"
#include "apps/python/heard.hpp"
#include "apps/python/law.hpp"
#include "apps/python/network.hpp"

#include <unistd.h>

namespace palpate::python {

/// The process in which an object was opened.
/// After a fork, threads, locks and a GPU remain in the parent process.
class Home {
 public:
  bool isHere() const { return process_ == ::getpid(); }
  /// Throws palpate.Error in another process.
  void require() const {
    if (!isHere())
      throw Refusal("Error",
                    "this was opened in the parent process before fork(), and works only there; open it here, or start "
                    "processes by \"spawn\" (multiprocessing.set_start_method)",
                    PP_ERROR_STATE);
  }

 private:
  int process_ = ::getpid();
};

using CloudPointer = std::shared_ptr<PyCloud>;

/// What a session is opened of: one of a cloud, a scene, a folder of a depth camera, or a session to join.
struct Source {
  CloudPointer cloud;
  bool moving = false, stable_rows = false;  ///< of frames of the cloud
  std::uint64_t max_points = 0;
  std::optional<std::string> scene, folder;
  double speed = 1;
  bool loop = false, fuse = false;
  std::optional<JoinTuple> join;
  std::vector<std::tuple<CloudPointer, std::array<double, 3>, std::array<double, 4>>> clouds;  ///< with their poses
};

/// A brush of any kind.
struct Brush {
  std::string kind;
  pp_brush brush = pp_default_brush();

  /// Settings as listed by brushSettings(); lengths whose names do not end in _mm are in model units.
  Brush(const std::string& name, const py::kwargs& settings, double mm_per_unit);
  Brush(const Brush&) = delete;
  Brush& operator=(const Brush&) = delete;
};
/// Names of all settings, which palpate/_words.py accepts for **brush.
py::list brushSettings();

/// Only one thread at a time uses it; others wait.
class PySession {
 public:
  /// `options`: with a tool; contact, law, log and watch are set here. `contact`: with `surface` as its kind.
  /// `onMessage`: as for Heard.
  PySession(const Source& source, pp_session_options options, const pp_contact_options& contact,
            const std::string& surface, Law law, py::object onMessage);
  ~PySession();
  PySession(const PySession&) = delete;
  PySession& operator=(const PySession&) = delete;

  /// Runs `act` with exclusive use of the session, and without Python's lock.
  template <class Do>
  auto with(Do&& act) {
    home_.require();
    for (const Law* law : {&law_, &liveLaw_})
      if (law->python()) law->python()->refuseWithin();
    ContactListener::refuseWithin();
    const Heard::Delivery delivery(heard_);
    const WithoutGil released;
    const std::scoped_lock lock(inUse_);
    return interruption_.during([&] { return act(session_); });
  }

  py::array touch(const py::object& path, const std::optional<std::string>& surface);
  py::array stroke(const py::object& path, const std::string& kind, const py::kwargs& settings);
  void addFrame(double t_s, const py::object& xyz, const py::object& normals, const py::object& velocities);
  /// One tick, for all hands. `orientations`: four numbers for each hand, or none.
  std::vector<PyContact> touchPoses(std::vector<pp_pose> poses, const std::vector<double>& orientations);
  void onContact(const py::object& function);
  py::array nearest(const py::object& positions, double max_distance, bool surface);
  /// Sets those that are given.
  void setContact(const std::optional<std::string>& surface, std::optional<double> friction,
                  std::optional<double> stiffness, std::optional<double> damping, std::optional<double> max_force,
                  std::optional<double> hand_gain);
  py::array raycast(const py::object& origins, const py::object& directions, double max_distance);
  py::array rows();
  py::array render(const std::pair<std::uint32_t, std::uint32_t>& size, const pp_picture_options& options);

  /// `others`: device, builtin, path and axes of each hand after the first.
  void startLive(const std::optional<std::string>& device, double rate, const std::optional<std::string>& builtin,
                 const py::object& path, const py::object& law, bool allowPython, const py::list& others,
                 const std::optional<std::string>& axes);
  void stopLive();
  /// Throws palpate.Error once the function of on_contact() has raised.
  void refuseDeaf() const;
  py::array readTicks();
  /// Throws the exception that the force law has raised in a live session.
  void raiseOfLaw();
  std::uint64_t lateLaws() const { return liveLaw_.python() ? liveLaw_.python()->late() : 0; }

  /// For the garbage collector, which finds cycles through functions that use the session.
  int visit(visitproc call, void* data) const;
  void forget();

  void close();
  /// False in a process that was forked since.
  bool isHere() const { return home_.isHere(); }
  py::list messages() const { return told(heard_); }
  pp::Session& session() { return session_; }
  double mm_per_unit();
  /// True if its cloud was made of float32 positions.
  bool isSingle() const { return cloud_ && cloud_->isSingle(); }

 private:
  static pp::Session opened(const Source& source, const pp_session_options& options);
  pp_contact_options contactWith(const std::string& surface) const;
  py::array along(const py::object& path, const pp_brush* brush);

  Home home_;
  CloudPointer cloud_;
  Heard heard_;
  std::string surface_;
  pp_contact_options contact_;
  std::uint32_t hands_;
  bool hasTorques_;
  Law law_, liveLaw_;
  Interruption interruption_;
  std::mutex inUse_;
  double budget_us_;
  std::unique_ptr<ContactListener> listener_;
  pp_session handle_{};
  pp::Session session_;  // destroyed first
};

void bindSessionsPictures(py::class_<PySession>& session);
void bindSessionsTicks(py::class_<PySession>& session);
void bindSessionsQueries(py::class_<PySession>& session);
void bindLogs(py::module_& module);
void bindSessionsMatter(py::class_<PySession>& session);
void bindSessionsSharing(py::class_<PySession>& session);
void bindSharing(py::module_& module);

}  // namespace palpate::python
