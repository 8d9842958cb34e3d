// libHD as its interface specifies, over a simulated Touch: for tests of the adapter through the real dynamic loader.
// It is strict where the real one is: a thread must make the device current, values are latched at the begin of a
// frame, the force is sent at its end, errors are kept on a stack. It has a "Left Device", and a "Right Device" if that
// has a script.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "haptics/devices/hdapi.hpp"
#include "haptics/realtime_priority.hpp"
#include "haptics/tick_pacer.hpp"
#include "tests/fake_devices/fake_device.hpp"

namespace {

using namespace palpate;
using namespace palpate::hdapi;

struct Scheduled {
  SchedulerHandle handle;
  Callback callback;
  void* data;
};

/// One stylus of the driver.
struct Stylus {
  explicit Stylus(Handle itsHandle) : handle(itsHandle) { plug(); }
  /// Starts a session: reads the script again.
  void plug() {
    device = std::make_unique<FakeDevice>(handle == 0 ? FakeDevice::kFirst : FakeDevice::kSecond);
    checks = 0;
    frame = forces = false;
    told.clear();
  }

  Handle handle;
  std::unique_ptr<FakeDevice> device;
  bool open = false, frame = false, forces = false;
  DVec3 force_N{0};
  int checks = 0;
  std::vector<const FakeFault*> told;
};

struct Library {
  std::array<Stylus, 2> styluses{Stylus(0), Stylus(1)};
  std::mutex errorsGuard;
  std::vector<ErrorInfo> errors;
  double rate_Hz = 1000;

  std::mutex guard;  // protects the schedule
  std::vector<Scheduled> scheduled;
  SchedulerHandle next = 1;
  std::atomic<bool> running = false;
  std::thread thread;

  ~Library() { stop(); }
  void stop() {
    if (!running.exchange(false)) return;
    if (thread.get_id() == std::this_thread::get_id())
      thread.detach();
    else
      thread.join();
  }
  void complain(std::uint32_t code, Handle device = kNoDevice) {
    const std::scoped_lock lock(errorsGuard);
    errors.push_back({code, static_cast<std::int32_t>(code) + 1, device});
  }
};

Library& library() {
  static Library theOne;
  return theOne;
}

thread_local Handle current = kNoDevice;

/// The stylus of a call that requires it to be current; otherwise null and an error.
Stylus* called(Handle device = current) {
  Library& hd = library();
  if (device < hd.styluses.size() && device == current && hd.styluses[device].open) return &hd.styluses[device];
  ++hd.styluses[device < hd.styluses.size() ? device : 0].device->note().threadFaults;
  hd.complain(0x0104, device);
  return nullptr;
}

void run() {
  Library& hd = library();
  const RealtimePriority priority;
  const TickPacer pacer(hd.rate_Hz, priority.granted());
  for (std::uint64_t tick = 0; hd.running; ++tick) {
    tick = pacer.waitFor(tick);
    if (hd.styluses[0].device->faultNow("stall")) continue;
    std::vector<Scheduled> now;
    {
      const std::scoped_lock lock(hd.guard);
      now = hd.scheduled;
    }
    for (const Scheduled& call : now) {
      if (call.callback(call.data) == kCallbackContinue) continue;
      const std::scoped_lock lock(hd.guard);
      std::erase_if(hd.scheduled, [&](const Scheduled& other) { return other.handle == call.handle; });
    }
  }
}

void tellFaults(Stylus& stylus) {
  const FakeFault* error = stylus.device->faultNow("error");
  if (!error || std::ranges::find(stylus.told, error) != stylus.told.end()) return;
  if (error->for_s > 1e8) stylus.told.push_back(error);  // reported once; a limited one is reported at each frame
  library().complain(static_cast<std::uint32_t>(error->number), stylus.handle);
}

/// The stylus with this name, or null.
Stylus* named(const char* name) {
  auto& styluses = library().styluses;
  if (!name || std::strcmp(name, "Default Device") == 0 || std::strcmp(name, "Left Device") == 0) return &styluses[0];
  if (std::strcmp(name, "Right Device") == 0 && std::getenv(FakeDevice::kSecond)) return &styluses[1];
  return nullptr;
}

}  // namespace

extern "C" {

Handle hdInitDevice(const char* name) {
  Library& hd = library();
  Stylus* known = named(name);
  Stylus& stylus = known ? *known : hd.styluses[0];
  if (!stylus.open) stylus.plug();
  if (std::ranges::none_of(hd.styluses, &Stylus::open)) hd.rate_Hz = 1000;
  ++stylus.device->note().opened;
  if (const FakeFault* fault = stylus.device->fault("init")) {
    hd.complain(static_cast<std::uint32_t>(fault->number), stylus.handle);
    return kNoDevice;
  }
  if (!known || stylus.open) {
    hd.complain(known ? 0x0301 : 0x0303);
    return kNoDevice;
  }
  stylus.open = true;
  current = stylus.handle;
  return stylus.handle;
}
void hdDisableDevice(Handle device) {
  Library& hd = library();
  if (device >= hd.styluses.size() || !hd.styluses[device].open) return hd.complain(0x0104, device);
  ++hd.styluses[device].device->note().closed;
  hd.styluses[device].open = false;
  current = kNoDevice;
}
void hdMakeCurrentDevice(Handle device) { current = device; }
Handle hdGetCurrentDevice() { return current; }

void hdBeginFrame(Handle device) {
  Stylus* stylus = called(device);
  if (!stylus) return;
  if (stylus->frame) {
    ++stylus->device->note().frameFaults;
    return library().complain(0x0400, device);
  }
  stylus->frame = true;
  stylus->device->advance(1 / library().rate_Hz);
  tellFaults(*stylus);
}
void hdEndFrame(Handle device) {
  Stylus* stylus = called(device);
  if (!stylus) return;
  if (!stylus->frame) {
    ++stylus->device->note().frameFaults;
    return library().complain(0x0401, device);
  }
  stylus->frame = false;
  stylus->device->push(stylus->forces ? stylus->force_N : DVec3(0));
}

ErrorInfo hdGetError() {
  Library& hd = library();
  const std::scoped_lock lock(hd.errorsGuard);
  if (hd.errors.empty()) return {};
  const ErrorInfo newest = hd.errors.back();
  hd.errors.pop_back();
  return newest;
}
#ifndef FAKE_HD_OLD
const char* hdGetErrorString(std::uint32_t code) { return code == 0x0302 ? "HD_COMM_ERROR" : "HD_FAKE_ERROR"; }
#endif
void hdEnable(Enum capability) {
  Stylus* stylus = called();
  if (stylus && capability == kForceOutput) {
    stylus->forces = true;
    stylus->device->note().enabled = 1;
  }
}
void hdDisable(Enum capability) {
  Stylus* stylus = called();
  if (stylus && capability == kForceOutput) {
    stylus->forces = false;
    stylus->device->note().enabled = 0;
  }
}

void hdGetIntegerv(Enum parameter, std::int32_t* values) {
  const Stylus* stylus = called();
  if (!stylus) return;
  if (parameter != kCurrentButtons) return library().complain(0x0100);
  if (!stylus->frame) return library().complain(0x0402);
  *values = static_cast<std::int32_t>(stylus->device->buttons());
}
void hdGetDoublev(Enum parameter, double* values) {
  const Stylus* stylus = called();
  if (!stylus) return;
  Library& hd = library();
  const FakeDevice& device = *stylus->device;
  const auto give = [&](std::initializer_list<double> list) { std::ranges::copy(list, values); };
  const DVec3 p = device.position_mm();
  switch (parameter) {
    case kCurrentPosition:
      if (!stylus->frame) return hd.complain(0x0402);
      if (device.faultNow("frozen")) return give({0, -110, -35});
      if (device.faultNow("nan")) return give({0.0 / 0.0, 0, 0});
      return give({p.x, p.y, p.z});
    case kCurrentTransform: {
      if (device.fault("no-transform")) return hd.complain(0x0100);
      const glm::dmat3 m = glm::mat3_cast(device.turn());
      return give({m[0].x, m[0].y, m[0].z, 0, m[1].x, m[1].y, m[1].z, 0, m[2].x, m[2].y, m[2].z, 0, p.x, p.y, p.z, 1});
    }
    case kUsableWorkspace:
      return give({-80, -60, -35, 80, 60, 35});
    case kMaxForce:
      return give({device.fault("weak") ? 1.5 : 3.3});
    case kMaxContinuousForce:
      return give({0.88});
    case kMotorTemperature: {
      const FakeFault* hot = device.faultNow("temperature");
      return give({0.2, hot ? hot->number : 0.2, 0.2, 0, 0, 0});
    }
    default:
      return hd.complain(0x0100);
  }
}
void hdSetDoublev(Enum parameter, const double* values) {
  Stylus* stylus = called();
  if (!stylus) return;
  if (parameter != kCurrentForce) return library().complain(0x0100);
  if (!stylus->frame) return library().complain(0x0402);
  stylus->force_N = {values[0], values[1], values[2]};
}
const char* hdGetString(Enum parameter) {
  const Stylus* stylus = called();
  if (!stylus) return nullptr;
  switch (parameter) {
    case kModelType:
      return "Touch";
    case kSerialNumber:
      return stylus->handle == 0 ? "FAKE-0001" : "FAKE-0002";
    case kDriverVersion:
      return "2024.1";
    default:
      return nullptr;
  }
}

Enum hdCheckCalibration() {
  Stylus* stylus = called();
  if (!stylus || stylus->device->faultNow("uncalibrated")) return kNeedsManualInput;
  const FakeFault* fault = stylus->device->fault("calibration");
  return fault && stylus->checks++ < fault->number ? kNeedsManualInput
         : fault && stylus->checks < 1'000'000     ? kNeedsUpdate
                                                   : kCalibrated;
}
Enum hdCheckCalibrationStyle() { return kByInkwell; }
void hdUpdateCalibration(Enum style) {
  Stylus* stylus = called();
  if (!stylus) return;
  if (style != kByInkwell) return library().complain(0x0101);
  stylus->checks = 1'000'000;
}

void hdStartScheduler() {
  Library& hd = library();
  if (hd.running.exchange(true)) return;
  hd.thread = std::thread(run);
}
void hdStopScheduler() { library().stop(); }
void hdSetSchedulerRate(unsigned long rate_Hz) {
  if (rate_Hz != 500 && rate_Hz != 1000 && rate_Hz != 2000) return library().complain(0x0101);
  library().rate_Hz = static_cast<double>(rate_Hz);
}
SchedulerHandle hdScheduleAsynchronous(Callback callback, void* data, std::uint16_t priority) {
  Library& hd = library();
  if (priority > kDefaultPriority) hd.complain(0x0500);
  const std::scoped_lock lock(hd.guard);
  hd.scheduled.push_back({hd.next, callback, data});
  return hd.next++;
}
void hdUnschedule(SchedulerHandle handle) {
  const std::scoped_lock lock(library().guard);
  std::erase_if(library().scheduled, [&](const Scheduled& call) { return call.handle == handle; });
}
std::uint8_t hdWaitForCompletion(SchedulerHandle handle, std::uint32_t code) {
  Library& hd = library();
  while (true) {
    {
      const std::scoped_lock lock(hd.guard);
      const bool there =
          std::ranges::any_of(hd.scheduled, [&](const Scheduled& call) { return call.handle == handle; });
      if (!there || code == kWaitCheck) return there;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
}

}  // extern "C"
