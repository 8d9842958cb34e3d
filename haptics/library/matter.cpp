// The C interface: scenes of matter, in sessions and alone, and their points.
#include "haptics/library/held_session.hpp"
#include "haptics/library/open_matter.hpp"
#include "haptics/library/options.hpp"
#include "haptics/session/simulation.hpp"

using namespace palpate;
using namespace palpate::library;

namespace {

template <class Do>
pp_status with(pp_matter matter, Do&& act) {
  return guarded([&] {
    const auto found = objectOf<OpenMatter>(matter.id);
    const Claims::Held held(found->claims(), Claim::all);
    act(*found);
  });
}

pp_frame opened(std::shared_ptr<const FrameObject> frame) {
  return library::opened<pp_frame>(std::const_pointer_cast<FrameObject>(std::move(frame)));
}

void giveParameter(const std::vector<SimulationParameter>& all, std::uint64_t index, pp_parameter* parameter) {
  if (index >= all.size())
    throw UsageError("index: {} is out of range; the scene has {} parameters", index, all.size());
  required(parameter, "parameter") = parameterOf(all[index]);
}

// Matter may be controlled while another thread touches, even without a budget.
template <class Do>
pp_status governing(pp_session session, Do&& act) {
  return library::with(session, Claim::look, [&](OpenSession& open) { act(open); });
}

}  // namespace

uint32_t pp_can_simulate(void) { return canSimulate() ? 1 : 0; }

pp_status pp_session_open_matter(const char* scene, const pp_session_options* options, pp_session* session) {
  clear(session);
  return guarded([&] {
    const std::string name = &required(scene, "scene");
    openSession(options, session, [&] {
      Subject subject;
      subject.model = {.file = name, .matter = openScene(name)};
      return subject;
    });
  });
}

pp_status pp_session_frame(pp_session session, pp_frame* frame) {
  clear(frame);
  return looking(session, [&](OpenSession& open) { required(frame, "frame") = opened(open.frame()); });
}

pp_status pp_frame_view(pp_frame frame, pp_moving_points* points) {
  clear(points);
  return guarded([&] {
    const auto found = objectOf<FrameObject>(frame.id);
    pp_moving_points view{};
    view.points = viewOf(found->cloud);
    if (!found->velocities.empty()) view.velocities = &found->velocities.front().x;
    view.moving = found->moving;
    view.t_s = found->time_s;
    required(points, "points") = view;
  });
}

pp_status pp_frame_close(pp_frame frame) {
  return guarded([&] { handles().remove(HandleKind::frame, frame.id); });
}

pp_status pp_session_pause(pp_session session, uint32_t on) {
  return governing(session, [&](OpenSession& open) { open.simulation().pause(on != 0); });
}

pp_status pp_session_reset(pp_session session) {
  return governing(session, [&](OpenSession& open) { open.reset(); });
}

pp_status pp_session_parameter_count(pp_session session, uint64_t* count) {
  clear(count);
  return governing(session, [&](OpenSession& open) {
    const std::size_t there = open.simulation().parameters().size();
    required(count, "count") = there;
  });
}

pp_status pp_session_get_parameter(pp_session session, uint64_t index, pp_parameter* parameter) {
  clear(parameter);
  return governing(session,
                   [&](OpenSession& open) { giveParameter(open.simulation().parameters(), index, parameter); });
}

pp_status pp_session_set_parameter(pp_session session, const char* name, double value) {
  return governing(session, [&](OpenSession& open) { open.setParameter(&required(name, "name"), value); });
}

pp_status pp_session_get_motion(pp_session session, pp_motion* motion) {
  clear(motion);
  return governing(session, [&](OpenSession& open) { giveInfo(motion, open.motion(), "motion"); });
}

pp_status pp_matter_open(const char* scene, const pp_matter_options* options, pp_matter* matter) {
  clear(matter);
  return guarded([&] {
    const std::string name = &required(scene, "scene");
    required(matter, "matter");
    const pp_matter_options given = optionsFrom(options, "options");
    const auto watch = std::make_shared<Watch>(given.watch);
    std::shared_ptr<OpenMatter> made;
    watch->runCut([&] { made = std::make_shared<OpenMatter>(name, given, watch); });
    *matter = library::opened<pp_matter>(std::move(made));
  });
}

pp_status pp_matter_close(pp_matter matter) {
  return guarded([&] {
    const auto found = objectOf<OpenMatter>(matter.id);
    if (!found->claims().home().isThis()) return handles().abandon(HandleKind::matter, matter.id);
    const Claims::Held held(found->claims(), Claim::all);
    handles().remove(HandleKind::matter, matter.id);
  });
}

pp_status pp_matter_step(pp_matter matter, uint64_t steps) {
  return with(matter, [&](OpenMatter& open) { open.watch().run([&] { open.step(steps); }); });
}

pp_status pp_matter_reset(pp_matter matter) {
  return with(matter, [](OpenMatter& open) { open.reset(); });
}

pp_status pp_matter_frame(pp_matter matter, pp_frame* frame) {
  clear(frame);
  return with(matter, [&](OpenMatter& open) { required(frame, "frame") = opened(open.frame()); });
}

pp_status pp_matter_parameter_count(pp_matter matter, uint64_t* count) {
  clear(count);
  return with(matter, [&](OpenMatter& open) { required(count, "count") = open.parameters().size(); });
}

pp_status pp_matter_get_parameter(pp_matter matter, uint64_t index, pp_parameter* parameter) {
  clear(parameter);
  return with(matter, [&](OpenMatter& open) { giveParameter(open.parameters(), index, parameter); });
}

pp_status pp_matter_set_parameter(pp_matter matter, const char* name, double value) {
  return with(matter, [&](OpenMatter& open) { open.setParameter(&required(name, "name"), value); });
}

pp_status pp_matter_get_state(pp_matter matter, pp_matter_state* state) {
  clear(state);
  return with(matter, [&](OpenMatter& open) { giveInfo(state, open.state(), "state"); });
}
