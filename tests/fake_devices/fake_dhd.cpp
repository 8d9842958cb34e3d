// libdhd as its interface specifies, over a simulated stylus: for tests of the Force Dimension adapter.
#include <memory>

#include "tests/fake_devices/fake_device.hpp"

namespace {

using namespace palpate;

constexpr double kTick_s = 1e-3;

struct Library {
  std::unique_ptr<FakeDevice> device = std::make_unique<FakeDevice>();
  bool open = false, forces = false;
  int error = 0;
};
Library& library() {
  static Library theOne;
  return theOne;
}
int fail(int error) {
  library().error = error;
  return -1;
}
/// Whether the device is open and has no fault.
bool answers(char id) {
  if (id != 0 || !library().open) return fail(7), false;
  if (library().device->faultNow("error")) return fail(2), false;
  return true;
}

}  // namespace

extern "C" {

int dhdOpenID(char index) {
  Library& dhd = library();
  if (!dhd.open) dhd.device = std::make_unique<FakeDevice>();
  ++dhd.device->note().opened;
  if (dhd.device->fault("init") || index != 0) return fail(3);
  if (dhd.open) return fail(4);
  dhd.open = true;
  return 0;
}
int dhdClose(char id) {
  if (!library().open || id != 0) return fail(7);
  ++library().device->note().closed;
  library().open = library().forces = false;
  return 0;
}
int dhdGetDeviceCount() { return library().device->fault("none") ? 0 : 1; }
// x towards the user, y to the right, z up; metres.
int dhdGetPosition(double* x, double* y, double* z, char id) {
  if (!answers(id)) return -1;
  FakeDevice& device = *library().device;
  device.advance(kTick_s);
  const DVec3 p = 1e-3 * device.position_mm();
  *x = device.faultNow("nan") ? 0.0 / 0.0 : p.z;
  *y = p.x;
  *z = p.y;
  return 1;  // position read again within the time guard: also valid
}
int dhdSetForce(double x, double y, double z, char id) {
  if (!answers(id)) return -1;
  library().device->push(library().forces ? DVec3(y, z, x) : DVec3(0));
  return 0;
}
unsigned int dhdGetButtonMask(char id) { return answers(id) ? library().device->buttons() : 0; }
int dhdEnableForce(unsigned char on, char id) {
  if (!answers(id)) return -1;
  library().forces = on != 0;
  library().device->note().enabled = on;
  return 0;
}
#ifndef FAKE_DHD_OLD
int dhdSetWatchdog(unsigned char, char id) { return answers(id) ? 0 : -1; }
#endif
const char* dhdGetSystemName(char id) { return answers(id) ? "omega.3" : nullptr; }
int dhdGetSerialNumber(unsigned short* number, char id) {
  if (!answers(id)) return -1;
  if (library().device->fault("serial")) return fail(2);
  *number = 40123;
  return 0;
}
const char* dhdErrorGetLastStr() {
  switch (library().error) {
    case 2:
      return "communication error";
    case 3:
      return "no device found";
    case 4:
      return "device already open";
    default:
      return "device not ready";
  }
}
void dhdGetSDKVersion(int* major, int* minor, int* release, int* revision) {
  *major = 3;
  *minor = 17;
  *release = 6;
  *revision = 0;
}

}  // extern "C"
