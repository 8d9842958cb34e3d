#include "haptics/library/defaults.hpp"

#include <algorithm>
#include <cstring>

#include "engine/mesh/mesh_plan.hpp"
#include "haptics/session/picture_request.hpp"
#include "haptics/session/session_config.hpp"
#include "haptics/sharing/session_joiner.hpp"

namespace palpate::library {

namespace {

/// Writes the defaults of the fields that the program knows; fields that this library does not know are zero.
template <class Options>
void init(Options* to, std::uint32_t size) {
  if (!to) return;
  Options options = usual<Options>();
  options.size = size;
  std::memset(to, 0, size);
  std::memcpy(to, &options, std::min<std::size_t>(size, sizeof options));
}

template <class Options>
Options sized() {
  Options options{};
  options.size = sizeof(Options);
  return options;
}

}  // namespace

template <>
pp_feel usual() {
  const ForceOptions force;
  auto feel = sized<pp_feel>();
  feel.stiffness_N_per_mm = force.stiffness_N_per_mm;
  feel.damping_N_s_per_mm = force.damping_N_s_per_mm;
  feel.max_force_N = force.maxForce_N;
  return feel;
}

template <>
pp_tool usual() {
  const ToolConfig tool;
  auto options = sized<pp_tool>();
  options.points = static_cast<std::uint32_t>(tool.points);
  options.size_mm = tool.size_mm;
  for (int k = 0; k < 3; ++k) options.axis[k] = tool.axis[k];
  return options;
}

template <>
pp_session_options usual() {
  const SessionConfig config;
  auto options = sized<pp_session_options>();
  options.rate_Hz = config.rate_Hz;
  options.undo_memory_MiB = config.undo.memory_MiB;
  options.hands = 1;
  return options;
}

template <>
pp_path usual() {
  auto path = sized<pp_path>();
  path.type = PP_FLOAT64;
  path.columns = 3;
  return path;
}

template <>
pp_brush usual() {
  const BrushConfig usual;
  auto brush = sized<pp_brush>();
  brush.falloff = usual.falloff;
  brush.tau_mm = usual.tau_mm;
  brush.beta = usual.beta;
  brush.radius_mm = usual.radius_mm;
  brush.strength = usual.strength;
  for (int k = 0; k < 3; ++k) brush.color[k] = usual.color[static_cast<std::size_t>(k)];
  brush.color[3] = 255;
  brush.keeps_density = usual.keepsDensity ? 1 : 0;
  return brush;
}

template <>
pp_picture_options usual() {
  const PictureRequest usual;
  auto options = sized<pp_picture_options>();
  options.width = usual.width;
  options.height = usual.height;
  options.samples = usual.samples;
  options.fov_deg = 45;
  return options;
}

template <>
pp_mesh_options usual() {
  auto options = sized<pp_mesh_options>();
  options.lattice = MeshOptions{}.lattice;
  return options;
}

template <>
pp_stream_options usual() {
  auto options = sized<pp_stream_options>();
  options.speed = StreamConfig{}.speed;
  return options;
}

template <>
pp_join_options usual() {
  auto options = sized<pp_join_options>();
  options.patience_s = Joining{}.patience_s;
  return options;
}

}  // namespace palpate::library

// A program of any version passes the size of the struct that it knows.
#define PALPATE_INIT(name) \
  void pp_init_##name(pp_##name* options, uint32_t size) { palpate::library::init(options, size); }

PALPATE_INIT(cloud_arrays)
PALPATE_INIT(read_options)
PALPATE_INIT(write_options)
PALPATE_INIT(feel)
PALPATE_INIT(tool)
PALPATE_INIT(vulkan_device)
PALPATE_INIT(session_options)
PALPATE_INIT(session_info)
PALPATE_INIT(path)
PALPATE_INIT(brush)
PALPATE_INIT(picture_options)
PALPATE_INIT(mesh_options)
PALPATE_INIT(live_options)
PALPATE_INIT(live_state)
PALPATE_INIT(motion)
PALPATE_INIT(matter_options)
PALPATE_INIT(matter_state)
PALPATE_INIT(replay_options)
PALPATE_INIT(frames_options)
PALPATE_INIT(frame_arrays)
PALPATE_INIT(stream_options)
PALPATE_INIT(replay_result)
PALPATE_INIT(network)
PALPATE_INIT(join_options)
PALPATE_INIT(sharing)
PALPATE_INIT(serve_options)
PALPATE_INIT(server_info)

#undef PALPATE_INIT
