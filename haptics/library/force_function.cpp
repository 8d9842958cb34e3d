#include "haptics/library/force_function.hpp"

#include <cmath>
#include <limits>

#include "engine/core/counted.hpp"
#include "engine/core/error.hpp"
#include "haptics/devices/shared_library.hpp"
#include "haptics/hand_force.hpp"
#include "haptics/library/options.hpp"

namespace palpate::library {

namespace {

pp_force_law loaded(const std::string& library) {
  const std::size_t colon = library.rfind(':');
  if (colon == std::string::npos || colon == 0 || colon + 1 == library.size())
    throw UsageError("law: '{}' is not LIBRARY:FUNCTION, as in libmine.so:law", library);
  const std::string file = library.substr(0, colon), name = library.substr(colon + 1);
  const LoadedLibrary opened = loadLibrary(file);
  if (!opened.handle) throw Error("law: {}", opened.error);
  void* const function = functionIn(opened.handle, name);
  if (!function) throw Error("law: {} has no function {}", file, name);
  return reinterpret_cast<pp_force_law>(function);
}

}  // namespace

pp_contact contactOf(const Contact& contact, const Pose& pose, const DVec3& force_N, double mm_per_unit) {
  pp_contact told{};
  putVector(contact.proxy, told.proxy);
  putVector(contact.normal, told.normal);
  putVector(force_N, told.force_N);
  told.penetration_mm = contact.touching ? mm_per_unit * glm::length(contact.proxy - pose.hip) : 0;
  told.neighbours = contact.neighbours;
  told.contact = contact.touching;
  told.fresh = contact.fresh;
  told.valid = contact.valid;
  told.age_s = dataAge_s(contact, pose.time_s);
  return told;
}

ForceFunction::ForceFunction(pp_force_law law, void* user, const std::string& library, double mm_per_unit)
    : law_(library.empty() ? law : loaded(library)), user_(user), mm_per_unit_(mm_per_unit) {}

DVec3 ForceFunction::call(void* user, const Contact& contact, const Pose& pose, double dt_s,
                          const DVec3& usual_N) noexcept {
  const auto& self = *static_cast<const ForceFunction*>(user);
  pp_pose told{};
  told.t_s = pose.time_s;
  putVector(pose.hip, told.hip);
  told.no_edit = !pose.sculpts;
  const pp_contact answer = contactOf(contact, pose, usual_N, self.mm_per_unit_);
  double force_N[3]{};
  self.law_(self.user_, &told, &answer, dt_s, force_N);
  const DVec3 given_N(force_N[0], force_N[1], force_N[2]);
  if (std::isfinite(glm::length(given_N))) return given_N;
  if (self.faults_->count.fetch_add(1) == 0) self.faults_->first_s = pose.time_s;
  return DVec3(std::numeric_limits<double>::quiet_NaN());  // no force, as at any fault
}

std::optional<std::string> ForceFunction::takeFault() {
  const std::uint64_t count = faults_->count.exchange(0);
  if (count == 0) return std::nullopt;
  return fmt::format("law: gave a force that is not finite at {}, first at {:.3f} s; there was no force then",
                     counted(count, "tick"), faults_->first_s.load());
}

}  // namespace palpate::library
