// Bodies in matter: rigid ones of boundary points (Akinci et al. 2012), and the spring and damper on which a hand holds
// one (virtual coupling; Colgate, Stanley, Brown 1995). m, m/s, rad/s, kg, N.
#ifndef PALPATE_SHARED_MATTER_BODIES_H
#define PALPATE_SHARED_MATTER_BODIES_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Pose and motion of a body.
PALPATE_STRUCT(BodyPose) {
  PALPATE_VEC3 place;
  PALPATE_VEC3 velocity;
  PALPATE_VEC3 spin;
  PALPATE_MAT3 turn;  // rotation from its own axes to the world's
  Real grown;         // points up to this far from its middle count: a body placed in matter grows from there, m
};
PALPATE_SINGLE(BodyPose);

// A position in the frame of the body: from its middle, along its own axes.
PALPATE_FORMULA PALPATE_VEC3 inBody(PALPATE_OF(BodyPose) pose, PALPATE_VEC3 place) {
  return transpose(pose.turn) * (place - pose.place);
}

// A point of a body near a position.
PALPATE_STRUCT(BodyMeeting) {
  PALPATE_VEC3 offset;    // from the point to the position
  PALPATE_VEC3 arm;       // from the middle of the body to the point
  PALPATE_VEC3 velocity;  // of the point
  Real r;                 // the length of the offset, in support radii
  Real volume;            // that the point represents, in cubes of the spacing
};
PALPATE_SINGLE(BodyMeeting);

// `offset`: from the point to the position, along the axes of the body.
PALPATE_FORMULA PALPATE_OF(BodyMeeting)
    bodyMeeting(PALPATE_OF(BodyPose) pose, PALPATE_VEC3 place, PALPATE_VEC3 offset, Real support, Real volume) {
  PALPATE_OF(BodyMeeting) met;
  met.offset = pose.turn * offset;
  met.arm = place - pose.place - met.offset;
  met.velocity = pose.velocity + cross(pose.spin, met.arm);
  met.r = length(offset) / support;
  // Points appear after the matter has made room for them: a spacing later, and over another spacing.
  met.volume = volume * clamp((pose.grown - length(met.arm)) / (Real(0.5) * support) - Real(1.0), Real(0.0), Real(1.0));
  return met;
}

// Change of the velocity of matter inside a ball, which is emptied: it moves outwards by at most `most` in a step, m,
// until it is `radius` from the middle, or as far as the ball has grown.
PALPATE_FORMULA PALPATE_VEC3 pushedOut(PALPATE_OF(BodyPose) pose, PALPATE_VEC3 place, Real radius, Real most,
                                       Real step) {
  const PALPATE_VEC3 away = place - pose.place;
  const Real far = length(away);
  const Real deep = min(min(radius, pose.grown) - far, most);
  if (!(deep > Real(0.0))) return PALPATE_VEC3(Real(0.0));
  const PALPATE_VEC3 up = PALPATE_VEC3(Real(0.0), Real(1.0), Real(0.0));
  return deep / step * (far > Real(0.0) ? away / far : up);
}

// Spring and damper between a body and a hand.
PALPATE_STRUCT(ToolSpring) {
  Real mass;       // kg, of the body
  Real stiffness;  // N/m
  Real damping;    // N s/m
  Real step;       // s, of a substep
};
PALPATE_SINGLE(ToolSpring);

// The velocity of the body at the end of a substep, in which the hand moves by `handMove` and ends at `stretch` from
// the body's position at its start. Implicit, so that the spring is stable for every mass and step.
PALPATE_FORMULA PALPATE_VEC3 velocityOnSpring(PALPATE_OF(ToolSpring) spring, PALPATE_VEC3 velocity,
                                              PALPATE_VEC3 stretch, PALPATE_VEC3 handMove) {
  const Real share =
      spring.damping * spring.step / spring.mass + spring.stiffness * spring.step * spring.step / spring.mass;
  const PALPATE_VEC3 pull = (spring.stiffness * spring.step * stretch + spring.damping * handMove) / spring.mass;
  return (velocity + pull) / (Real(1.0) + share);
}

PALPATE_SHARED_END
#endif
