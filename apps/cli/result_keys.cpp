// The keys of --json of the commands that write their result in place. A test compares them with what is written.
#include "apps/cli/results.hpp"
#include "apps/cli/touch_results.hpp"

namespace palpate {

namespace {

constexpr DescribedKey kMake[]{{"file", "", "written file"}, {"shape", "", "its shape"}, {"points", "", "its points"}};

constexpr DescribedKey kRender[]{{"file", "", "written picture"},
                                 {"points", "", "points of the model"},
                                 {"gpu", "", "GPU that drew it"},
                                 {"gaussians", "", "number of Gaussians, if the picture shows those of a splat scene"}};

constexpr DescribedKey kMesh[]{{"file", "", "written mesh"},
                               {"points", "", "points of the model"},
                               {"gpu", "", "GPU that made it"},
                               {"resolution", "", "cells along the longest side"},
                               {"surface", "", "meshed surface"},
                               {"cell_mm", "mm", "edge of a cell"},
                               {"radius_mm", "mm", "support radius"},
                               {"vertices", "", "vertices"},
                               {"triangles", "", "triangles"},
                               {"edges", "", "edges"},
                               {"border_edges", "", "edges of one triangle"},
                               {"crowded_edges", "", "edges of more than two triangles"},
                               {"flat_triangles", "", "triangles without area"},
                               {"parts", "", "connected parts"},
                               {"closed", "", "true if the mesh has no border"},
                               {"euler", "", "Euler's characteristic"},
                               {"area_mm2", "mm^2", "area"},
                               {"volume_mm3", "mm^3", "enclosed volume"},
                               {"blocks", "", "blocks of cells at the surface"},
                               {"gpu_bytes", "B", "memory on the GPU"},
                               {"gpu_bytes_predicted", "B", "the same as predicted"},
                               {"gpu_us", "us", "time on the GPU, by pass"},
                               {"wall_us", "us", "time in all"}};

constexpr DescribedKey kConvert[]{{"input", "", "read file"},
                                  {"output", "", "written file"},
                                  {"from", "", "format that was read"},
                                  {"to", "", "format that was written"},
                                  {"points", "", "points, or Gaussians of a splat scene"},
                                  {"triangles", "", "triangles"},
                                  {"kept", "", "kept attributes"},
                                  {"lost", "", "lost attributes"},
                                  {"frames", "", "frames of a depth camera"},
                                  {"fused", "", "of them, fused"},
                                  {"unplaced", "", "of them, without a pose"},
                                  {"lost_frames", "", "of them, unreadable"},
                                  {"gaussians", "", "number of Gaussians, if OUT is a splat scene"},
                                  {"steps", "", "one for each step that selected, cleaned or set points"},
                                  {"steps[].step", "", "option that selected, cleaned or set points"},
                                  {"steps[].points_before", "", "points before it"},
                                  {"steps[].points", "", "points after it"}};

// With --to: one for each file, with the keys of a single file, or its error.
constexpr DescribedKey kConvertMany[]{{"files", "", "one for each input"},
                                      {"files[].error", "", "why a file was not converted"},
                                      {"failed", "", "files that were not converted"}};

// Results of `palpate info` for a simulated scene.
constexpr DescribedKey kSceneInfo[]{{"matter", "", "kind of matter"},
                                    {"particles", "", "particles, or nodes of a soft body"},
                                    {"substeps", "", "substeps per millisecond"},
                                    {"spacing_mm", "mm", "spacing at rest"},
                                    {"box_mm", "mm", "size of the box"},
                                    {"mass_kg", "kg", "total mass"},
                                    {"bytes", "B", "memory of the simulation"},
                                    {"gain", "1", "ratio of the felt force to the simulated one"},
                                    {"layers", "", "layers of particles along each side"},
                                    {"tool", "", "radius_mm and mass_kg of the ball in the hand"},
                                    {"young_Pa", "Pa", "Young's modulus of a soft body"},
                                    {"poisson", "1", "Poisson's ratio of a soft body"},
                                    {"viscosity_Pa_s", "Pa s", "viscosity of a soft body"}};

constexpr DescribedKey kSimulate[]{{"time_s", "s", "simulated time"},
                                   {"backend", "", "back end that simulated"},
                                   {"particles", "", "particles"},
                                   {"layers", "", "layers along each side; null: a soft body"},
                                   {"substeps", "", "substeps per millisecond"},
                                   {"step_us", "us", "time of a step of a millisecond"},
                                   {"kinetic_J", "J", "kinetic energy"},
                                   {"potential_J", "J", "potential energy"},
                                   {"momentum_kg_m_s", "kg m/s", "momentum"},
                                   {"max_compression", "1", "largest compression"},
                                   {"front_mm", "mm", "farthest particle along x"},
                                   {"pressure_Pa", "Pa", "pressure at --probe; else null"},
                                   {"gain", "1", "ratio of the felt force to the simulated one"},
                                   {"coupling_N_mm", "N/mm", "stiffness of the spring between hand and ball"},
                                   {"model", "", "what the standing model displaces and bears; else null"}};

constexpr DescribedKey kServe[]{{"name", "", "name of the session"},
                                {"points", "", "points of the model"},
                                {"mm_per_unit", "mm", "touch scale: millimetres in the hand per unit"},
                                {"clients", "", "programs that fetched the points"},
                                {"requests", "", "their requests"},
                                {"blocks", "", "blocks of points sent"},
                                {"pings", "", "pings answered"},
                                {"refused", "", "requests refused"},
                                {"sculptors", "", "hands that edited"},
                                {"pieces", "", "pieces of strokes received"},
                                {"states", "", "states of points received"},
                                {"duplicate_pieces", "", "pieces received more than once"},
                                {"sent", "", "messages about edits sent"},
                                {"partial", "", "programs that streamed the points around their hand"},
                                {"partial_points", "", "points sent to them"},
                                {"partial_steps", "", "updates sent to them"},
                                {"frames", "", "frames of a moving model"},
                                {"edited", "", "points that edits changed"}};

constexpr DescribedKey kKeys[]{{"folder", "", "folder of the keys"},
                               {"name", "", "their holder"},
                               {"authority", "", "authority that signed them"},
                               {"new_authority", "", "whether it is new"},
                               {"until", "", "last day of validity"}};

constexpr DescribedKey kDoctor[]{
    {"gpus", "", "GPUs that Vulkan reports"},
    {"gpus[].name", "", "name that the driver gives"},
    {"gpus[].type", "", "discrete GPU, integrated GPU, virtual GPU, CPU or other"},
    {"gpus[].usable", "", "whether palpate can use it"},
    {"gpus[].memory_bytes", "B", "its own memory"},
    {"gpus[].features", "", "what palpate requires, by name: whether it is there"},
    {"gpus[].queues", "", "queue families"},
    {"gpus[].queues[].count", "", "queues of the family"},
    {"gpus[].queues[].flags", "", "what they can do, as in graphics+compute+transfer"},
    {"haptics", "", "haptic libraries, the Haply service, devices and permissions"},
    {"device", "", "the examined device (--device), and nothing else"},
    {"device_test", "", "the tested device (--test), and nothing else"},
    {"device_test.free_force_N", "N", "largest force in free space; must be 0"},
    {"device_test.largest_gap_s", "s", "longest time between two poses"},
    {"device_test.noise_mm", "mm", "RMS noise of the position, noisiest axis"},
    {"device_test.axes", "",
     "axis of the pose as the hand moves right, up and towards the "
     "user: 1 is +x, -3 is -z, 0: not moved"},
    {"device_test.recommended_axes", "", "as in x,z,-y, for --axes; null: the axes are right, or not known"},
    {"device_test.oscillation_s", "s", "duration of the hum, until the force was zero"},
    {"device_test.stable_stiffness_N_per_mm", "N/mm", "stiffest wall that did not hum; null: none"},
    {"device_test.recommended_stiffness_N_per_mm", "N/mm", "0.7 of it, for --stiffness"},
    {"forgotten", "",
     "devices that were forgotten (--forget), or without --device the number of measurements of --backend auto, and "
     "nothing else"},
    {"display", "", "how pictures of each GPU reach the display; null: there is none"},
    {"display[].gpu", "", "name of the GPU"},
    {"display[].present", "", "swapchain or copy, as for --present; null: it cannot show pictures"},
    {"display[].reason", "", "why not directly; empty for swapchain"},
    {"in_use", "", "GPU in use; null: none"},
    {"servo", "", "ticks that this machine misses (--servo)"},
    {"speed", "", "measured speeds (--speed)"},
    {"speed.servo", "", "of a servo loop alone"},
    {"speed.servo.rate_Hz", "Hz", "rate that it was asked for"},
    {"speed.servo.reached_Hz", "Hz", "rate that it reached"},
    {"speed.servo.missed_ticks", "", "ticks that it missed"},
    {"speed.points", "", "points of the cloud that was edited"},
    {"speed.backends", "", "the CPU, and the GPU unless it is a software driver"},
    {"speed.backends[].backend", "", "cpu or vulkan"},
    {"speed.backends[].machine", "", "the processor or GPU"},
    {"speed.backends[].reason", "", "why it was not measured; empty if it was"},
    {"speed.backends[].edits", "", "ticks with an edit"},
    {"speed.backends[].edits[].touched", "", "points that the edit reached"},
    {"speed.backends[].edits[].p50_us", "us", "median duration of the tick"},
    {"speed.backends[].edits[].p99_us", "us", "its 99th percentile"},
    {"speed.backends[].edits[].ticks", "", "ticks measured"},
    {"speed.measured_s", "s", "duration of --speed"},
    {"network", "", "sessions on the network (--network)"}};

}  // namespace

std::vector<ResultFacts> allResults() {
  std::vector<ResultFacts> all;
  listTouchResults(all);
  listReplayResults(all);
  listInfoResults(all);
  listResults(all, "info", "", kSceneInfo);
  listResults(all, "make", "", kMake);
  listResults(all, "convert", "", kConvert);
  listResults(all, "convert", "files[].", kConvert);
  listResults(all, "convert", "", kConvertMany);
  listResults(all, "render", "", kRender);
  listResults(all, "mesh", "", kMesh);
  listResults(all, "simulate", "", kSimulate);
  listResults(all, "serve", "", kServe);
  listResults(all, "keys", "", kKeys);
  listResults(all, "doctor", "", kDoctor);
  listBenchResults(all);
  return all;
}

}  // namespace palpate
