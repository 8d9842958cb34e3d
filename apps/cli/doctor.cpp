#include <algorithm>
#include <cstdio>

#include "apps/cli/context.hpp"
#include "apps/cli/doctor_device.hpp"
#include "apps/cli/doctor_prove.hpp"
#include "apps/cli/sharing_options.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "apps/cli/tick_times.hpp"
#include "apps/view/copied_presentation.hpp"
#include "apps/view/presentation.hpp"
#include "engine/core/counted.hpp"
#include "haptics/pace_check.hpp"
#include "haptics/realtime_priority.hpp"
#include "haptics/session/devices.hpp"
#include "haptics/session/measured_backends.hpp"
#include "haptics/tick_pacer.hpp"

namespace palpate {

namespace {

std::string_view typeName(VkPhysicalDeviceType type) {
  switch (type) {
    case VK_PHYSICAL_DEVICE_TYPE_DISCRETE_GPU:
      return "discrete";
    case VK_PHYSICAL_DEVICE_TYPE_INTEGRATED_GPU:
      return "integrated";
    case VK_PHYSICAL_DEVICE_TYPE_VIRTUAL_GPU:
      return "virtual";
    case VK_PHYSICAL_DEVICE_TYPE_CPU:
      return "CPU";
    default:
      return "other";
  }
}

std::string flagNames(VkQueueFlags flags) {
  std::string names;
  const auto add = [&](VkQueueFlags bit, const char* name) {
    if (flags & bit) names += (names.empty() ? "" : "+") + std::string(name);
  };
  add(VK_QUEUE_GRAPHICS_BIT, "graphics");
  add(VK_QUEUE_COMPUTE_BIT, "compute");
  add(VK_QUEUE_TRANSFER_BIT, "transfer");
  return names;
}

constexpr int kFasterMesa = 25;

bool drawsSlowly(const VkPhysicalDeviceDriverProperties& driver) {
  int version = kFasterMesa;
  return driver.driverID == VK_DRIVER_ID_MESA_LLVMPIPE && std::sscanf(driver.driverInfo, "Mesa %d", &version) == 1 &&
         version < kFasterMesa;
}

Json describe(std::FILE* out, std::size_t number, VkPhysicalDevice device) {
  VkPhysicalDeviceDriverProperties driver{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_DRIVER_PROPERTIES};
  VkPhysicalDeviceProperties2 properties{.sType = VK_STRUCTURE_TYPE_PHYSICAL_DEVICE_PROPERTIES_2, .pNext = &driver};
  vkGetPhysicalDeviceProperties2(device, &properties);
  VkPhysicalDeviceMemoryProperties memory;
  vkGetPhysicalDeviceMemoryProperties(device, &memory);
  std::uint64_t local = 0;
  for (std::uint32_t i = 0; i < memory.memoryHeapCount; ++i)
    if (memory.memoryHeaps[i].flags & VK_MEMORY_HEAP_DEVICE_LOCAL_BIT) local += memory.memoryHeaps[i].size;
  std::uint32_t count = 0;
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, nullptr);
  std::vector<VkQueueFamilyProperties> families(count);
  vkGetPhysicalDeviceQueueFamilyProperties(device, &count, families.data());

  const auto& p = properties.properties;
  fmt::print(out, "GPU {}: {} ({})\n", number, p.deviceName, typeName(p.deviceType));
  fmt::print(out, "  driver: {} {}, Vulkan {}.{}.{}, {} MiB of its own memory\n", driver.driverName, driver.driverInfo,
             VK_API_VERSION_MAJOR(p.apiVersion), VK_API_VERSION_MINOR(p.apiVersion), VK_API_VERSION_PATCH(p.apiVersion),
             local >> 20);
  if (drawsSlowly(driver))
    fmt::print(out,
               "  Mesa {} draws up to twice as fast; Debian 12 has it in backports:\n"
               "    apt-get install -t bookworm-backports mesa-vulkan-drivers\n",
               kFasterMesa);
  Json queues = Json::array(), features = Json::object();
  for (std::uint32_t i = 0; i < count; ++i) {
    fmt::print(out, "  queue family {}: {} x {}\n", i, families[i].queueCount, flagNames(families[i].queueFlags));
    queues.push_back({{"count", families[i].queueCount}, {"flags", flagNames(families[i].queueFlags)}});
  }
  const auto roles = chooseQueues(families);
  if (roles)
    fmt::print(out, "  touch: family {} queue {}   sight: family {} queue {}   background: family {} queue {}{}\n",
               roles->latency.family, roles->latency.index, roles->throughput.family, roles->throughput.index,
               roles->background.family, roles->background.index,
               roles->shared()             ? "   (one queue, shared behind a lock)"
               : roles->backgroundShares() ? "   (sight and background share one behind a lock)"
                                           : "");
  bool usable = roles.has_value();
  for (const FeatureState& feature : requiredFeatures(device)) {
    fmt::print(out, "  {} {}\n", feature.present ? "has  " : "LACKS", feature.name);
    features[feature.name] = feature.present;
    usable = usable && feature.present;
  }
  fmt::print(out, "  {}\n", usable ? "palpate runs on it" : "palpate cannot run on it");
  return {{"name", p.deviceName}, {"type", typeName(p.deviceType)}, {"queues", queues},
          {"features", features}, {"memory_bytes", local},          {"usable", usable}};
}

Json gpus(std::FILE* out) {
  Json json = Json::array();
  try {
    const Instance instance(Validation::off);
    for (const VkPhysicalDevice device : instance.physicalDevices()) json.push_back(describe(out, json.size(), device));
  } catch (const Error& error) {
    fmt::print(out, "GPU: none. {}\n", error.what());
  }
  return json;
}

Json toJson(const DVec3& v) { return {v.x, v.y, v.z}; }

// Prints what was found of a kind, and adds it to the result.
void describe(std::FILE* out, const std::string& kind, const DriverFinding& driver, Json& json, Mending& mending) {
  fmt::print(out, "--device {}: {}\n", kind, driver.product);
  Json attempts = Json::array();
  for (const VendorLibrary::Attempt& attempt : driver.attempts) {
    // Some errors of the loader begin with the name already.
    fmt::print(out, "  {}\n",
               attempt.error.starts_with(attempt.name) ? attempt.error : attempt.name + ": " + attempt.error);
    attempts.push_back({{"name", attempt.name}, {"error", attempt.error}});
  }
  if (!driver.file.empty()) fmt::print(out, "  loaded {}\n", driver.file);
  Json found{{"option", kind},
             {"library", driver.file},
             {"attempts", attempts},
             {"missing", driver.missing},
             {"usable", driver.device.has_value()},
             {"reason", driver.problem},
             {"device", nullptr}};
  if (driver.device) {
    const HapticDeviceFacts& facts = *driver.device;
    const DVec3 size_mm = facts.workspaceMax_mm - facts.workspaceMin_mm;
    fmt::print(out, "  {}, serial number {}, driver {}\n", facts.model, facts.serial.empty() ? "unknown" : facts.serial,
               facts.driver.empty() ? "unknown" : facts.driver);
    fmt::print(out, "  workspace {:.0f} x {:.0f} x {:.0f} mm, peak force {:.3g} N, {:.3g} N continuous, ready\n",
               size_mm.x, size_mm.y, size_mm.z, driver.limits.peakForce_N, driver.limits.continuousForce_N);
    found["device"] = {{"model", facts.model},
                       {"serial", facts.serial},
                       {"driver", facts.driver},
                       {"workspace_min_mm", toJson(facts.workspaceMin_mm)},
                       {"workspace_max_mm", toJson(facts.workspaceMax_mm)},
                       {"peak_force_N", driver.limits.peakForce_N},
                       {"continuous_force_N", driver.limits.continuousForce_N}};
  } else {
    fmt::print(out, "  not usable: {}\n", driver.problem);
  }
  json["drivers"].push_back(found);
  for (const NodeFinding& node : driver.nodes) {
    fmt::print(out, "{}: {}, {}\n", node.path, node.what, node.usable ? "usable" : "no permission for this user");
    json["nodes"].push_back({{"path", node.path}, {"what", node.what}, {"usable", node.usable}, {"fix", node.mend}});
    mending.add(node.mend);
  }
}

void describe(std::FILE* out, const std::string&, const HaplyFinding& haply, Json& json, Mending&) {
  json["haply"] = haplyService(out, haply);
}

void describe(std::FILE* out, const std::string& kind, const std::vector<HidCandidate>& candidates, Json& json,
              Mending& mending) {
  if (std::ranges::all_of(candidates, isStylus))
    fmt::print(out, "--device {}: no 3D mouse and no DualSense is plugged in\n", kind);
  for (const HidCandidate& hid : candidates) {
    fmt::print(out, "--device {}: {} at {}, {}\n", isStylus(hid) ? "openhaptics" : kind, hid.name, hid.info.path,
               hid.usable ? "ready" : hid.whyNot);
    json["hid"].push_back({{"name", hid.name},
                           {"path", hid.info.path},
                           {"vendor", hid.info.vendorId},
                           {"product", hid.info.productId},
                           {"usable", hid.usable},
                           {"reason", hid.whyNot},
                           {"fix", hid.mend}});
    mending.add(hid.mend);
  }
}

Json hapticDevices(std::FILE* out) {
  Mending mending;
  Json json{{"drivers", Json::array()}, {"nodes", Json::array()}, {"hid", Json::array()}};
  for (const DeviceSurvey& kind : surveyDevices())
    std::visit([&](const auto& finding) { describe(out, kind.kind, finding, json, mending); }, kind.finding);
  json["problems"] = surveySurroundings();
  for (const auto& problem : json["problems"]) fmt::print(out, "{}\n", problem.get<std::string>());
  const bool priority = RealtimePriority().granted();
  fmt::print(out, "Real-time priority for the servo loop: {}\n",
             priority ? "granted" : "not permitted for this user; the scheduler may delay ticks");
  json["realtime_priority"] = priority;
  if (!priority) mending.add(RealtimePriority::command());
  json["fix"] = mending.print(out);
  json["remembered"] = rememberedDevices(out);
  return json;
}

constexpr const char* kQuietly = "quietly";

struct DoctorOptions {
  double servo_s = 0, rate_Hz = 1000;
  bool network = false, test = false, forget = false, speed = false;
  std::string device, prove;
  NetworkOptions which;
};

// Sessions on the network.
Json network(std::FILE* out, const NetworkConfig& config) {
  constexpr double kListen_s = 2;
  const auto [seen, keyHolders] = discoverSessions(config, kListen_s);
  fmt::print(out, "Sessions on {}{}: {}\n",
             config.interface.empty() ? "this machine" : "the network of " + config.interface,
             config.security.empty() ? "" : " for holders of keys", seen.size());
  Json json = Json::array();
  for (const ServedSession& session : seen) {
    const double lost_percent = session.pings ? 100 * (1 - static_cast<double>(session.answered) / session.pings) : 0;
    const std::string way = !session.compatible
                                ? fmt::format("another version of palpate ({}), cannot be joined", session.version)
                            : session.roundTrip_ms ? fmt::format("round trip {:.2f} ms, {:.0f} % of {} pings lost",
                                                                 *session.roundTrip_ms, lost_percent, session.pings)
                                                   : "no reply to pings";
    fmt::print(out, "  {}: {} of {}, by {}; {}\n", session.name, counted(session.points, "point"), session.model,
               session.host, way);
    json.push_back({{"name", session.name},
                    {"host", session.host},
                    {"model", session.model},
                    {"points", session.points},
                    {"version", session.version},
                    {"compatible", session.compatible},
                    {"round_trip_ms", session.roundTrip_ms ? Json(*session.roundTrip_ms) : Json(nullptr)},
                    {"pings", session.pings},
                    {"answered", session.answered},
                    {"lost_percent", session.pings ? Json(lost_percent) : Json(nullptr)}});
  }
  if (keyHolders && seen.empty())
    fmt::print(out,
               "There are programs with keys; their sessions are visible only with keys of the same authority "
               "(--security)\n");
  return json;
}

Json servoPace(std::FILE* out, const DoctorOptions& options) {
  const PaceCheck check = checkPace(options.rate_Hz, options.servo_s);
  fmt::print(out, "Empty servo loop, {:g} s at {:g} Hz: {} of {} ticks missed{}\n", options.servo_s, options.rate_Hz,
             check.missed, check.ticks + check.missed,
             check.realtimePriority ? "" : " (no real-time priority was granted)");
  fmt::print(out, "  wake-up latency   {}\n  preempted         {}\n", inWords(check.late_us),
             inWords(check.scheduling));
  return {{"rate_Hz", options.rate_Hz},
          {"ticks", check.ticks},
          {"missed_ticks", check.missed},
          {"realtime_priority", check.realtimePriority},
          {"late_histogram_us", toJson(check.late_us)},
          {"servo_thread", toJson(check.scheduling)}};
}

// Way in which each GPU can show pictures on the display, if there is one.
Json display(std::FILE* out) {
  try {
    const Window window({64, 64}, "palpate", false);
    const Instance instance(Validation::off, window.extensions());
    Json json = Json::array();
    for (const VkPhysicalDevice gpu : instance.physicalDevices()) {
      const PresentationFound found = findPresentation(window, instance, gpu);
      VkPhysicalDeviceProperties properties;
      vkGetPhysicalDeviceProperties(gpu, &properties);
      const bool copies = found.presentation == Presentation::copy;
      const std::string why = !copies               ? ""
                              : takesCopies(window) ? found.why
                                                    : found.why + ", and this is not an X display";
      fmt::print(out, "Display: {} {}\n", properties.deviceName,
                 !copies               ? "presents pictures directly (--present swapchain)"
                 : takesCopies(window) ? "has its pictures copied (--present copy): " + why
                                       : "cannot show pictures: " + why);
      json.push_back({{"gpu", properties.deviceName},
                      {"present", !copies               ? Json("swapchain")
                                  : takesCopies(window) ? Json("copy")
                                                        : Json(nullptr)},
                      {"reason", why}});
    }
    return json;
  } catch (const Error& error) {
    fmt::print(out, "Display: none; {}\n", error.what());
    return nullptr;
  }
}

// Removes the measurements of --backend auto.
Json forgetBackends(std::FILE* out) {
  const MeasuredBackends memory;
  const std::size_t count = memory.count();
  const bool existed = memory.forget();
  fmt::print(out, "{}\n",
             existed ? fmt::format("{}: {} removed; --backend auto measures again", memory.file().string(),
                                   counted(count, "measurement"))
                     : "--backend auto has measured nothing yet");
  return existed ? Json(count) : Json(0);
}

// `quietly`: for the program that waits for the result, which reports it.
void prove(Context& context, bool quietly) {
  Json proof;
  try {
    proof = context.proof(quietly ? nullptr : context.tables());
  } catch (const GpuError& error) {
    if (!quietly) throw;
    context.writeJson({{"error", error.what()}});
    return;
  }
  context.writeJson({{"proof", proof}});
  endAfterProof(proof);
  if (const auto wrong = proof["wrong"].get<std::string>(); !quietly && !wrong.empty() && proof["substitute"].is_null())
    throw Error("{} gives wrong results: {}", proof["gpu"].get<std::string>(), wrong);
}

void doctor(Context& context, const DoctorOptions& options) {
  if (options.forget && options.device.empty()) {
    context.writeJson({{"forgotten", forgetBackends(context.tables())}});
    return;
  }
  if (!options.prove.empty()) return prove(context, options.prove == kQuietly);
  if (options.network) {
    context.writeJson({{"network", network(context.tables(), options.which.config())}});
    return;
  }
  if (options.which.config() != NetworkConfig{})
    throw UsageError("--interface, --peer, --domain and --security require --network, which lists sessions");
  std::FILE* out = context.tables();
  if (!options.device.empty()) {
    if (options.forget) {
      context.writeJson({{"forgotten", forgetDevice(out, options.device)}});
    } else if (options.test) {
      context.writeJson({{"device_test", guideDeviceCheck(out, options.device, context.log())}});
      if (StopBySignal::requested()) throw Error("the test was interrupted; nothing is remembered");
    } else {
      context.writeJson({{"device", examineDevice(out, options.device, context.log())}});
    }
    return;
  }
  Json result{{"gpus", gpus(out)}};
  result["haptics"] = hapticDevices(out);
  result["display"] = display(out);
  result["in_use"] = nullptr;
  if (options.servo_s > 0) result["servo"] = servoPace(out, options);
  if (options.speed) result["speed"] = machineSpeed(out, context);
  try {
    result["in_use"] = context.device().name();
  } catch (const Error&) {
    context.writeJson(result);
    if (result["gpus"].size() == 0)
      fmt::print(out,
                 "No usable GPU: touch, convert, info and simulate work on the processor; pictures and the window "
                 "require a Vulkan driver, which may be a software one (package mesa-vulkan-drivers)\n");
    throw;  // reports the reason
  }
  fmt::print(out, "GPU in use: {}. palpate can run here.\n", context.device().name());
  context.writeJson(result);
}

}  // namespace

void addDoctor(Options& app, Context& context, Command& command) {
  Options& sub = app.addSubcommand(
      "doctor",
      "report the GPUs and the queues used for touch, sight and background, the haptic devices and libraries found, "
      "missing permissions and the commands that grant them, and how pictures reach the display");
  auto options = std::make_shared<DoctorOptions>();
  Option servo = sub.add("--servo", options->servo_s,
                         "run an empty servo loop for this many seconds and report the ticks that this machine misses")
                     .check(between(bounds::kShortest_s, bounds::kLongest_s));
  sub.add("--rate", options->rate_Hz, "ticks per second of --servo")
      .check(between(1, 100'000))
      .needs(servo)
      .showDefault();
  Option named = sub.add("--device", options->device,
                         "only examine this device: serial number, workspace, force limits, axes, permissions; " +
                             heldDevicesHelp())
                     .check(Check{[](const std::string& device) {
                                    return isHeldDevice(device)
                                               ? std::string()
                                               : "'" + device + "' is not a device; devices are " + heldDevicesHelp();
                                  },
                                  "DEVICE"})
                     .offers(heldDeviceNames())
                     .excludes(servo);
  Option test = sub.addFlag(
      "--test", options->test,
      "test the device in your hand, step by step: poses and force in free space, directions, and the stiffest "
      "wall that does not hum; then asks whether stiffness and axes are to be used with the device from now on");
  test.needs(named);
  sub.addFlag("--forget", options->forget,
              "with --device: forget what is remembered for it (as haply:SERIAL; a kind alone: for all of them), and "
              "that the window used it; otherwise: forget which of GPU and CPU answers sooner, so that --backend auto "
              "measures it again")
      .excludes(servo)
      .excludes(test);
  sub.addFlag("--network", options->network,
              "only list the sessions on the network (palpate serve), with round trips and losses")
      .excludes(servo);
  sub.addFlag(
         "--prove", options->prove, std::vector<std::string>{"table", kQuietly},
         "only prove the GPU (--gpu): run the primitives of which every pass is made, and compare their results; a "
         "session in real time does so once for each GPU, driver and version, and uses the CPU if one is wrong "
         "(--prove=quietly: without a table)")
      .excludes(servo)
      .excludes(named);
  sub.addFlag(
         "--speed", options->speed,
         "measure what this machine can do, for 3 to 10 s: the rate of a servo loop, and edits of a million points "
         "on the CPU and on a GPU")
      .excludes(named);
  addNetworkOptions(sub, options->which);
  sub.whenNamed([&, options] { command = [&context, options] { doctor(context, *options); }; });
}

}  // namespace palpate
