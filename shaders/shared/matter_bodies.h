// Bodies in matter: rigid ones of boundary points (Akinci et al. 2012), and the spring and damper on which a hand holds
// one (virtual coupling; Colgate, Stanley, Brown 1995). m, m/s, rad/s, kg, N.
#ifndef PALPATE_SHARED_MATTER_BODIES_H
#define PALPATE_SHARED_MATTER_BODIES_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// Where a body is, and how it moves.
PALPATE_STRUCT(BodyPose) {
  PALPATE_VEC3 place;
  PALPATE_VEC3 velocity;
  PALPATE_VEC3 spin;
  PALPATE_MAT3 turn;  // from its own axes to the world's
};
PALPATE_SINGLE(BodyPose);

// A place as the body sees it: from its middle, along its own axes.
PALPATE_FORMULA PALPATE_VEC3 inBody(PALPATE_OF(BodyPose) pose, PALPATE_VEC3 place) {
  return transpose(pose.turn) * (place - pose.place);
}

// A point of a body near a place.
PALPATE_STRUCT(BodyMeeting) {
  PALPATE_VEC3 offset;    // from the point to the place
  PALPATE_VEC3 arm;       // from the middle of the body to the point
  PALPATE_VEC3 velocity;  // of the point
  Real r;                 // the length of the offset, in support radii
  Real volume;            // that the point stands for, in cubes of the spacing
};
PALPATE_SINGLE(BodyMeeting);

// `offset`: from the point to the place, along the axes of the body.
PALPATE_FORMULA PALPATE_OF(BodyMeeting) bodyMeeting(PALPATE_OF(BodyPose) pose, PALPATE_VEC3 place, PALPATE_VEC3 offset,
                                                    Real support, Real volume) {
  PALPATE_OF(BodyMeeting) met;
  met.offset = pose.turn * offset;
  met.arm = place - pose.place - met.offset;
  met.velocity = pose.velocity + cross(pose.spin, met.arm);
  met.r = length(offset) / support;
  met.volume = volume;
  return met;
}

// What holds a body to a hand.
PALPATE_STRUCT(ToolSpring) {
  Real mass;       // kg, of the body
  Real stiffness;  // N/m
  Real damping;    // N s/m
  Real step;       // s, of a substep
};
PALPATE_SINGLE(ToolSpring);

// The velocity of the body at the end of a substep, in which the hand goes `handMove` and comes to `stretch` from where the
// body was as it began. Implicit, so that no mass and no step is too small for the spring.
PALPATE_FORMULA PALPATE_VEC3 velocityOnSpring(PALPATE_OF(ToolSpring) spring, PALPATE_VEC3 velocity, PALPATE_VEC3 stretch,
                                              PALPATE_VEC3 handMove) {
  const Real share =
      spring.damping * spring.step / spring.mass + spring.stiffness * spring.step * spring.step / spring.mass;
  const PALPATE_VEC3 pull = (spring.stiffness * spring.step * stretch + spring.damping * handMove) / spring.mass;
  return (velocity + pull) / (Real(1.0) + share);
}

PALPATE_SHARED_END
#endif
