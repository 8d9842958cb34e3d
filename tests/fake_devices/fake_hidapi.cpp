// The part of libhidapi-hidraw that is used, driven by a script: for tests of the program through the real dynamic
// loader on machines whose kernel has no virtual devices. Lines of the script, which the variable PALPATE_FAKE_HID
// names:
//   device PATH VENDOR PRODUCT USAGE_PAGE USAGE NAME    (numbers hexadecimal)
//   denied                     the device cannot be opened
//   push AT_S FOR_S BYTES…     a report (hexadecimal), 60 times a second; seconds since the device was first opened
//   gone AT_S FOR_S            the device is unplugged
#include <hidapi.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <cwchar>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

struct hid_device_ {};

namespace {

using Clock = std::chrono::steady_clock;
constexpr double kEvery_s = 1.0 / 60;

struct Push {
  double at_s = 0, for_s = 0;
  std::vector<unsigned char> bytes;
};

struct Script {
  std::string path, name;
  unsigned vendor = 0, product = 0, usagePage = 0, usage = 0;
  bool denied = false;
  std::vector<Push> pushes;
  double gone_s = 1e9, goneFor_s = 0;
};

Script readScript() {
  Script script;
  const char* file = std::getenv("PALPATE_FAKE_HID");
  std::ifstream in(file ? file : "");
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string what;
    if (!(words >> what)) continue;
    if (what == "device") {
      words >> script.path >> std::hex >> script.vendor >> script.product >> script.usagePage >> script.usage;
      std::getline(words >> std::ws, script.name);
    } else if (what == "denied") {
      script.denied = true;
    } else if (what == "push") {
      Push push;
      words >> push.at_s >> push.for_s >> std::hex;
      for (unsigned byte; words >> byte;) push.bytes.push_back(static_cast<unsigned char>(byte));
      script.pushes.push_back(push);
    } else if (what == "gone") {
      words >> script.gone_s >> script.goneFor_s;
    } else {
      std::fprintf(stderr, "fake hidapi: cannot parse '%s'\n", line.c_str());
      std::abort();
    }
  }
  return script;
}

const Script& script() {
  static const Script theOne = readScript();
  return theOne;
}

std::optional<Clock::time_point>& firstOpened() {
  static std::optional<Clock::time_point> when;
  return when;
}
double now_s() { return firstOpened() ? std::chrono::duration<double>(Clock::now() - *firstOpened()).count() : 0; }
bool isThere() {
  const double now = now_s();
  return !script().path.empty() && !(now >= script().gone_s && now < script().gone_s + script().goneFor_s);
}

hid_device theDevice;

}  // namespace

extern "C" {

int hid_init() { return 0; }
int hid_exit() { return 0; }

hid_device_info* hid_enumerate(unsigned short, unsigned short) {
  if (!isThere()) return nullptr;
  auto* info = new hid_device_info();
  info->path = ::strdup(script().path.c_str());
  info->vendor_id = static_cast<unsigned short>(script().vendor);
  info->product_id = static_cast<unsigned short>(script().product);
  info->usage_page = static_cast<unsigned short>(script().usagePage);
  info->usage = static_cast<unsigned short>(script().usage);
  info->product_string = ::wcsdup(std::wstring(script().name.begin(), script().name.end()).c_str());
  info->manufacturer_string = ::wcsdup(L"Fake");
  info->serial_number = ::wcsdup(L"");
  info->bus_type = HID_API_BUS_USB;
  return info;
}
void hid_free_enumeration(hid_device_info* info) {
  if (!info) return;
  std::free(info->path);
  std::free(info->product_string);
  std::free(info->manufacturer_string);
  std::free(info->serial_number);
  delete info;
}

hid_device* hid_open_path(const char* path) {
  if (script().denied || !isThere() || script().path != path) return nullptr;
  if (!firstOpened()) firstOpened() = Clock::now();
  return &theDevice;
}
void hid_close(hid_device*) {}

int hid_read_timeout(hid_device*, unsigned char* data, std::size_t size, int timeout_ms) {
  const auto until = Clock::now() + std::chrono::milliseconds(timeout_ms);
  while (true) {
    if (!isThere()) {
      errno = EIO;
      return -1;
    }
    const double now = now_s();
    for (const Push& push : script().pushes) {
      if (now < push.at_s || now >= push.at_s + push.for_s) continue;
      std::this_thread::sleep_for(std::chrono::duration<double>(kEvery_s));
      const std::size_t bytes = std::min(size, push.bytes.size());
      std::copy_n(push.bytes.begin(), bytes, data);
      return static_cast<int>(bytes);
    }
    if (Clock::now() >= until) return 0;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}
int hid_write(hid_device*, const unsigned char*, std::size_t size) { return isThere() ? static_cast<int>(size) : -1; }
const wchar_t* hid_error(hid_device*) { return script().denied ? L"Permission denied" : L"No such device"; }

}  // extern "C"
