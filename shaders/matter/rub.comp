#version 460
#extension GL_GOOGLE_include_directive : require
// Sand: forces between touching grains, and on walls and tools, with friction that remembers how far a contact was
// displaced; then each grain settles. Each of the two grains keeps its own copy of a contact, by its id.
#extension GL_EXT_control_flow_attributes : require
#include "shaders/lib/index.glsl"
#include "shaders/shared/matter_passes.h"

layout(push_constant, scalar) uniform Push { MatterRubArgs args; };

#include "shaders/lib/matter_lists.glsl"
#include "shaders/lib/matter_setting.glsl"
#include "shaders/lib/matter_body.glsl"
#include "shaders/lib/matter_model.glsl"
#include "shaders/lib/matter_sums.glsl"
#include "shaders/lib/matter_settle.glsl"

GrainRules rules;
vec3 place, velocity;
float mostOverlap;
uint before, countBefore;  // contacts of the last substep
uint expected;             // the next of those: contacts usually come in the same order again
uint after, countAfter;    // contacts of this substep

// Whether a contact existed in the last substep, and the slip that was left of it.
bool wasThere(uint other, out vec3 left) {
  for (uint k = 0; k < countBefore; ++k) {
    const uvec4 contact = args.contacts.at[before + expected];
    expected = expected + 1 < countBefore ? expected + 1 : 0;
    if (contact.w != other) continue;
    left = uintBitsToFloat(contact.xyz);
    return true;
  }
  return false;
}

// Change of velocity by a contact. `offset`: from `other` to the grain. Their relative velocity is that of the last
// substep, except for `fall`, which gravity has added to only one of them.
vec3 meet(uint other, vec3 offset, float overlap, vec3 otherVelocity, vec3 fall) {
  const vec3 moved = rules.step * (velocity - otherVelocity);
  vec3 slip = vec3(0), left;
  if (wasThere(other, left)) slip = grainSlip(rules, left, moved, fall);
  const GrainContact contact = grainContact(rules, normalize(offset), overlap, moved, slip);
  if (countAfter < kMaxContacts) args.contacts.at[after + countAfter++] = uvec4(floatBitsToUint(contact.slip), other);
  mostOverlap = max(mostOverlap, overlap);
  return contact.change;
}

vec3 meetNeighbours(uint slot) {
  const uint count = args.listLengths.at[slot];
  const vec3 size = SETTING.cells.size;
  vec3 change = vec3(0);
  for (uint first = 0; first < count; first += kListedAtOnce) {
    const uvec4 four = args.lists.at[first / kListedAtOnce * args.stride + slot];
    for (uint k = 0; k < kListedAtOnce; ++k) {
      if (first + k >= count) break;
      const uint other = slotOf(four[k]);
      const vec3 offset = offsetFrom(four[k], args.places.at[other].xyz, place, size);
      const float distance = length(offset);
      if (distance < rules.diameter && distance > 0)
        change += meet(args.ids.at[other], offset, rules.diameter - distance, velocityOf(other), vec3(0));
    }
  }
  return change;
}

vec3 meetWalls() {
  const MatterCells cells = particleCells();
  const vec3 fall = SETTING.fall;
  vec3 change = vec3(0);
  for (int wall = 0; wall < 6; ++wall) {
    const int axis = wall / 2;
    const bool low = wall % 2 == 0;
    const float distance = low ? place[axis] : cells.size[axis] - place[axis];
    const float overlap = rules.diameter / 2 - distance;
    if (isPeriodic(cells, axis) || !(overlap > 0)) continue;
    const vec3 inwards = vec3(axis == 0, axis == 1, axis == 2) * (low ? 1 : -1);
    change += meet(kFirstWall + wall, inwards, overlap, vec3(0), fall);
  }
  return change;
}

vec3 meetModel() {
  const ModelAt at = modelAbout(place);
  const float overlap = rules.diameter / 2 - at.distance;
  if (!(overlap > 0) || at.outwards == vec3(0)) return vec3(0);
  return meet(kModelContact, at.outwards, overlap, vec3(0), SETTING.fall);
}

void meetPoint(BodyMeeting met, uint number) {
  const float distance = length(met.offset);
  if (!(distance < rules.diameter && distance > 0 && met.volume > 0)) return;
  noteExchange(meet(kFirstBodyPoint + toolAtHand * SETTING.bodyPoints + number, met.offset, rules.diameter - distance,
                    met.velocity, SETTING.fall),
               met.arm);
}

void main() {
  if (!isRunning()) return;
  const uint slot = threadIndex(), parity = args.control.now.parity;
  const bool isParticle = slot < args.particles;
  const uint id = isParticle ? args.ids.at[slot] : 0;
  vec3 change = vec3(0), byWalls = vec3(0), byModel = vec3(0);
  mostOverlap = 0;
  if (isParticle) {
    rules = grainRules();
    place = args.places.at[slot].xyz;
    velocity = velocityOf(slot);
    before = (parity * args.particles + id) * kMaxContacts;
    countBefore = args.contactCounts.at[parity * args.particles + id];
    after = ((1 - parity) * args.particles + id) * kMaxContacts;
    expected = countAfter = 0;
    change = meetNeighbours(slot);
    byWalls = meetWalls();
    byModel = meetModel();
  }
  change += byWalls + byModel + changeByTools(isParticle, place);
  if (isParticle) args.contactCounts.at[(1 - parity) * args.particles + id] = countAfter;
  settleSlot(isParticle, place, velocity, change, byWalls, byModel, mostOverlap / SETTING.grains.diameter);
}
