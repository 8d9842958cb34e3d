#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_buffer_reference_uvec2 : require
// The contact step of one probe that is submitted ahead of its question: waits for it, rehearsing the last one, and
// answers like contact_step.comp, by one workgroup.
#ifdef PALPATE_CLOCK
#extension GL_ARB_shader_clock : require
uint clockTicks() { return clock2x32ARB().x; }
#else
uint clockTicks() { return 0; }
#endif
#include "shaders/lib/index.glsl"
#include "shaders/lib/await_question.glsl"
#include "shaders/lib/contact_step.glsl"

shared uint arrived[kQuestionWords];

vec3 arrivedVector(uint place) {
  return vec3(uintBitsToFloat(arrived[place]), uintBitsToFloat(arrived[place + 1]),
              uintBitsToFloat(arrived[place + 2]));
}

// The question, once the host has written it, of a step that was submitted ahead of it. Its tick is 0 if that does not
// happen in time, or if it is withdrawn. The first subgroup polls.
ContactQuestion awaitedQuestion(uint lastTick, uint most) {
  barrier();  // the last one may still be read
  if (gl_SubgroupID == 0) {
    QuestionWords words = QuestionWords(uvec2(args.pose));  // SwiftShader crashes on a cast between references
    bool there = false;
    for (uint polls = 0; polls < most && !there; ++polls) there = pollQuestion(words, 0, lastTick);
    [[unroll]] for (uint k = 0; k < kWordsEach; ++k)
      if (awaitedPlace(k) < kQuestionWords) arrived[awaitedPlace(k)] = there ? awaitedWords[k] : 0;
  }
  barrier();
  ContactQuestion question;
  question.pose.hip = arrivedVector(0);
  question.pose.tick = arrived[kQuestionWithdrawnAt] == 0 ? arrived[kQuestionTickAt] : 0;
  question.carried.lastHip = arrivedVector(4);
  question.carried.touching = arrived[7];
  question.carried.spring = arrivedVector(8);
  question.carried.face = arrived[11];
  question.carried.motion = vec3(0.0);
  question.carried.facing = arrivedVector(15);
  question.carried.velocity = arrivedVector(18);
  question.carried.started = arrived[21];
  question.pointsAge = uintBitsToFloat(arrived[22]);
  question.sinceLast = uintBitsToFloat(arrived[23]);
  question.withdrawn = 0;
  question.seal = 0;
  return question;
}

// While a step waits in real time, it repeats the last one without an answer: the points, the index and the code of the
// next one are then in this processor's caches. Of one round of cells at most, and so many loop steps.
const uint kRehearsalBudget = 2000;
ContactQuestion rehearsal(ContactState own) {
  ContactQuestion question;
  question.pose.hip = own.lastHip;
  question.pose.tick = 0;
  question.carried = own;
  question.carried.started = 0;
  question.pointsAge = 0.0;
  question.sinceLast = 0.0;
  question.withdrawn = 0;
  question.seal = 0;
  return question;
}

// Moves the proxy, and returns the surface that it was evaluated on last.
Surface follow(Probe probe, uint mostCells, uint budget) {
  tick = tickFrom(probe.touching, probe.sticking, probe.face, facing, probe.lastHip, probe.proxy, vec3(0.0),
                  args.radius, kFriction);
  Surface surface = Surface(false, 0.0, vec3(0.0), 0, false);

  // One loop for all purposes: shader compilers inline every call, and the patch and its surface are most of the
  // program.
  do {
    if (tick.purpose == kWalks) tick.at = placeOnWay(probe, tick.substep);
    bool spent = workDone > budget;
    bool fetched = false;  // a patch around the place was gathered: a NaN is out of reach of every patch, also its own
    while (!fetched && !patchReaches(tick.at)) {
      fetched = patchGathered;
      gatherPatch(args.spill, probe.hip, fetched ? tick.at : firstPlace(probe), patchReach(args.radius), mostCells);
      if (!fetched) spent = workDone > budget;
    }
    if (tick.purpose == kWalks && spent) {
      tick.truncated = true;
      tick.face = kFaceInside;
      break;
    }
    surface = feel(tick.at);
    if (tick.purpose == kWalks) ++workDone;
  } while (goesOn(tick, surface, vec3(0.0), args.radius, kFriction, probe.substeps, probe.traced, workDone > budget));
  return surface;
}

void main() {
  const uint begun = clockTicks();
  const uint logHead = args.logHead.at[0];
  uint there = begun;
  bool rehearses = true;
  Probe probe;
  Surface surface;
  [[dont_unroll]] for (uint look = 0; rehearses; ++look) {  // one copy of the code, to be rehearsed
    // Loaded before the wait, and each time: kept from one to the next they would cost registers.
    const ContactState own = stateAt(args.state, 0);
    const bool mayRehearse = look == 0 && args.pose.head.rehearses != 0;
    ContactQuestion question = awaitedQuestion(args.pose.head.lastTick, mayRehearse ? 1 : args.pose.head.polls);
    there = clockTicks();
    rehearses = mayRehearse && arrived[kQuestionTickAt] == 0;
    if (rehearses) question = rehearsal(own);
    if (!rehearses && question.pose.tick == 0) return;
    probe = probeOf(question, own, args.radius);
    workDone = 0;
    patchGathered = false;
    patchThinned = false;
    if (kPointsMove) {
      patchAge = question.pointsAge;
      patchVelocity = probe.velocity;
    }
    facing = probe.facing;
    surface = follow(probe, rehearses ? min(args.mostCells, kContactWorkgroup) : args.mostCells,
                     rehearses ? kRehearsalBudget : kContactWorkBudget);
  }
  const vec3 proxy = tick.touching ? tick.proxy : vec3(0.0);
  const uint touching = !tick.touching ? kFree : tick.sticking ? kSticking : kSliding;
  vec3 velocity = vec3(0.0);
  if (kPointsMove && surface.defined)
    velocity = velocityAt(args.spill, args.velocities, tick.at - patchCentre, args.radius, facing);
  if (gl_LocalInvocationIndex >= kSampleWords) return;

  ContactSample answer;
  answer.spring = proxy;
  answer.touching = touching;
  answer.normal = surface.normal;
  answer.neighbours = surface.neighbours;
  answer.tick = arrived[kQuestionTickAt];
  answer.trackingSteps = tick.trackingSteps;
  answer.logHead = logHead;
  answer.flags = (tick.truncated ? kSampleTruncated : 0) | (patchThinned ? kSampleThinned : 0);
  answer.flags |= tick.face << kSampleFaceShift;
  answer.velocity = velocity;
  writeAnswer(0, answer);
  if (gl_LocalInvocationIndex != 0) return;
  args.state.at[0].touching = touching;
  args.state.at[0].facing = facing;
  args.state.at[0].lastHip = arrivedVector(0);
  args.state.at[0].face = tick.face;
  args.state.at[0].started = 1;
  args.state.at[0].motion = -probe.lastHip;
  args.state.at[0].spring = proxy;
  if (kPointsMove) args.state.at[0].velocity = velocity;
  args.result.ticks.waited = there - begun;
  args.result.ticks.answered = clockTicks() - there;
}
