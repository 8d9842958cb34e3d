#include "tests/fake_devices/fake_device.hpp"

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "haptics/path.hpp"

namespace palpate {
namespace {

[[noreturn]] void giveUp(const std::string& why) {
  std::fprintf(stderr, "fake device: %s\n", why.c_str());
  std::abort();
}

}  // namespace

FakeDevice::FakeDevice(const char* variable) {
  if (const char* script = std::getenv(variable))
    read(script);
  else
    touch_.emplace(Path({{0, DVec3(0)}}), WorkspaceMap{});
}

void FakeDevice::read(const std::filesystem::path& script) {
  std::ifstream in(script);
  if (!in) giveUp("cannot read the script " + script.string());
  Path hand({{0, DVec3(0)}});
  WorkspaceMap map;
  SimulatedTouchOptions options;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line.substr(0, line.find('#')));
    std::string what, name;
    if (!(words >> what)) continue;
    if (what == "hand" && words >> name) {
      hand = readPathCsv(name);
    } else if (what == "map") {
      words >> map.scale >> map.offset.x >> map.offset.y >> map.offset.z;
    } else if (what == "lead") {
      words >> options.lead_s;
    } else if (what == "skip") {
      words >> skip_;
    } else if (what == "hurry") {
      hurries_ = true;
    } else if (what == "turn") {
      words >> turn_.w >> turn_.x >> turn_.y >> turn_.z;
    } else if (what == "button") {
      Press press{};
      words >> press.bit >> press.at_s >> press.for_s;
      presses_.push_back(press);
    } else if (what == "note" && words >> name) {
      note_ = mappedNote(name);
      if (!note_) giveUp("cannot write events to " + name);
      note_->frames = 0;  // the file may contain the notes of an earlier session
    } else if (what == "fault" && words >> name) {
      FakeFault fault{.name = name};
      if (words >> fault.number && words >> fault.at_s) words >> fault.for_s;
      faults_.push_back(fault);
      words.clear();
    } else {
      giveUp("cannot parse '" + line + "'");
    }
    if (words.fail()) giveUp("missing numbers in '" + line + "'");
  }
  touch_.emplace(hand, map, options);
}

const FakeFault* FakeDevice::fault(const std::string& name) const {
  for (const FakeFault& fault : faults_)
    if (fault.name == name) return &fault;
  return nullptr;
}

const FakeFault* FakeDevice::faultNow(const std::string& name) const {
  for (const FakeFault& fault : faults_)
    if (fault.name == name && fault.isOn(time_s_)) return &fault;
  return nullptr;
}

void FakeDevice::advance(double dt_s) {
  std::uint64_t frame = note_->frames;
  if (hurries_ && frame > skip_) {
    constexpr double kBehind_s = 0.05;
    if (!sinceFirst_) sinceFirst_.emplace();
    const double due = static_cast<double>(skip_ + 1) + sinceFirst_->elapsed_s() / dt_s;
    if (due > static_cast<double>(frame) + kBehind_s / dt_s) frame = static_cast<std::uint64_t>(due);
  }
  note_->frames = frame + 1;
  time_s_ = frame < skip_ ? 0 : static_cast<double>(frame - skip_) * dt_s;
  position_mm_ = touch_->read(time_s_).position;
  for (int k = 0; k < 3; ++k) note_->position_mm[k] = position_mm_[k];
}

std::uint32_t FakeDevice::buttons() const {
  std::uint32_t pressed = 0;
  for (const Press& press : presses_)
    if (time_s_ >= press.at_s && time_s_ < press.at_s + press.for_s) pressed |= press.bit;
  return pressed;
}

void FakeDevice::push(const DVec3& force_N) {
  touch_->write(force_N);
  for (int k = 0; k < 3; ++k) note_->force_N[k] = force_N[k];
  const double size_N = glm::length(force_N);
  note_->mostForce_N = std::max(note_->mostForce_N, size_N);
  for (const FakeFault& fault : faults_)
    if (fault.name != "temperature" && fault.isOn(time_s_) && fault.for_s > 1e-3 && size_N > 0) ++note_->lateForces;
}

}  // namespace palpate
