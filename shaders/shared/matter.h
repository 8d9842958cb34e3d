// What a particle of water or sand does to another one, to a wall and to a body of boundary particles in a substep: the
// mathematics of position-based fluids (Macklin, Mueller 2013) in small substeps of one iteration (Macklin et al. 2019,
// "Small steps in physics simulation"), of boundary particles (Akinci et al. 2012) and of grains with friction (Macklin
// et al. 2014, "Unified particle physics"). Each formula is for one particle and one thing beside it, so that a pass
// gathers over neighbours in the order of their slots, and no sum depends on who came first. Who walks over them:
// engine/matter. Lengths are m, times s.
//
// The constraint of a particle is its compression C = sum w(r / support) / (that sum at rest) - 1, held at 0 or below:
// a free surface pulls at nothing. One Jacobi iteration with the same multiplier per compression for all particles is
// what keeps momentum and needs no sum of squared gradients; it is as stiff as one iteration may be, which is that of a
// fluid whose speed of sound is kStiffness spacings a substep. The pushes are the slope of an energy, the sum of C^2
// over all particles, also where walls and bodies take part: these add to the sum of a particle, and have no C of their
// own. To lend them that of the particle (Akinci et al. 2012) is the slope of no energy, and water that stands in a
// tank would begin to boil by it.
#ifndef PALPATE_SHARED_MATTER_H
#define PALPATE_SHARED_MATTER_H
#include "shaders/shared/types.h"
#include "shaders/shared/weight.h"

PALPATE_SHARED_BEGIN

// Minus the slope of wendland(r), divided by r. Times a difference of two places it is the gradient of their weight in
// unit of 1 / support^2, and where they are the same place it has no direction and is finite.
PALPATE_FORMULA Real wendlandPull(Real r) {
  const Real t = max(Real(1.0) - r, Real(0.0));
  return Real(20.0) * t * t * t;
}

// How two particles of which one is at a free surface attract each other, for a difference of two places: they push
// each other away where they are nearer than kCohesionRest, in support radii, and feel nothing of each other from 1 on.
const float kCohesionRest = 0.35f;
PALPATE_FORMULA Real cohesionPull(Real r) {
  const Real t = max(Real(1.0) - r, Real(0.0));
  return (r - Real(kCohesionRest)) * t * t;
}

// Of all weight about a place the share beyond a plane that is r support radii away; a half where it is 0.
PALPATE_FORMULA Real shareBeyond(Real r) {
  const Real t = clamp(Real(1.0) - r, Real(0.0), Real(1.0));
  const Real t2 = t * t;
  return t2 * t2 * t2 * (Real(3.5) - t * (Real(4.5) - Real(1.5) * t));
}

// Minus the slope of shareBeyond(r): the share in a layer at r, in unit of 1 / support.
PALPATE_FORMULA Real shareInLayer(Real r) {
  const Real t = clamp(Real(1.0) - r, Real(0.0), Real(1.0));
  const Real t2 = t * t;
  return t2 * t2 * t * (Real(21.0) - t * (Real(31.5) - Real(12.0) * t));
}

// What is the same for all particles of a fluid in all substeps.
PALPATE_STRUCT(WaterRules) {
  Real support;    // radius of the weights
  Real restSum;    // of the weights of all neighbours and the particle itself, at rest
  Real wallSum;    // the same where the neighbourhood is filled evenly and without grain
  Real wallInset;  // in support radii: so much farther than they are walls are taken to be, so that a particle at rest
                   // half a spacing from them misses nothing
  Real push;       // m/s for a compression of 1 and a pull of 1 / m
  Real wallPush;   // m/s for a compression of 1 and a whole share
  Real drag;       // of a velocity, for a pull of 1
  Real wallDrag;   // of a velocity, for a share of 1 / m in a layer
  Real nearest;    // no particle comes nearer to a wall
  Real step;       // s
  Real cohesion;   // 1, for a cohesion of 1 and one particle of the two that is at a surface
};
PALPATE_SINGLE(WaterRules);

// Below 0 where something is missing about the particle: at a free surface.
PALPATE_FORMULA Real compressionOf(PALPATE_OF(WaterRules) rules, Real sum) { return sum / rules.restSum - Real(1.0); }

// The part of a compression that pushes: a free surface pulls at nothing.
PALPATE_FORMULA Real pressing(Real compression) { return max(compression, Real(0.0)); }

// How much a particle is one of a free surface, from 0 to 1: of the first layer of a plane one an eighth is missing.
PALPATE_FORMULA Real atSurface(Real compression) { return min(max(Real(-10.0) * compression, Real(0.0)), Real(1.0)); }

// The change of a particle's velocity by a neighbour. `offset` leads from the neighbour to the particle, `pull` is
// wendlandPull() of its length, `compressions` the sum of both, neither below 0, and `relative` the neighbour's
// velocity less the particle's. The neighbour's own change is the same with the other sign, to the last bit. A point of
// a boundary has no compression, and counts as often as its volume says.
PALPATE_FORMULA PALPATE_VEC3 changeByNeighbour(PALPATE_OF(WaterRules) rules, PALPATE_VEC3 offset, Real pull,
                                               Real compressions, PALPATE_VEC3 relative) {
  return rules.push * pull * compressions * offset + rules.drag * pull * relative;
}

// The same by cohesion, for a neighbour r support radii away; `surfaces`: atSurface() of both together. Forces between
// pairs (Tartakovsky, Meakin 2005), but of the free surface alone: where they act within a liquid, too, they hold it in
// the order of a crystal, and it stops to flow.
PALPATE_FORMULA PALPATE_VEC3 changeByCohesion(PALPATE_OF(WaterRules) rules, PALPATE_VEC3 offset, Real r,
                                              Real surfaces) {
  return -rules.cohesion * surfaces * cohesionPull(r) * offset;
}

// The walls of a box from 0 to `size` about a place in it: along an axis.
PALPATE_STRUCT(WallsBeside) {
  Real share;  // of all weight beyond both of them
  Real layer;  // slope of that share, against the nearer one, in unit of 1 / support
  Real drag;   // sum of the shares in the layers at them, each divided by its distance, 1 / (support m)
};
PALPATE_SINGLE(WallsBeside);

PALPATE_FORMULA PALPATE_OF(WallsBeside) wallsBeside(PALPATE_OF(WaterRules) rules, Real place, Real size, bool open) {
  PALPATE_OF(WallsBeside) walls;
  walls.share = Real(0.0);
  walls.layer = Real(0.0);
  walls.drag = Real(0.0);
  if (open) return walls;
  const Real low = place / rules.support + rules.wallInset;
  const Real high = (size - place) / rules.support + rules.wallInset;
  if (low >= Real(1.0) && high >= Real(1.0)) return walls;
  const Real atLow = shareInLayer(low);
  const Real atHigh = shareInLayer(high);
  walls.share = shareBeyond(low) + shareBeyond(high);
  walls.layer = atLow - atHigh;
  walls.drag = atLow / max(place, rules.nearest) + atHigh / max(size - place, rules.nearest);
  return walls;
}

// What the walls of a box are to a particle: beyond them stands what is like it, at rest density, and moves so that the
// velocity is 0 in the plane. Where walls meet, shares are combined as if they were independent of each other.
PALPATE_STRUCT(WallEffect) {
  Real sum;            // to the sum of weights
  PALPATE_VEC3 slope;  // away from them: the change of a share, in unit of 1 / support
  Real drag;           // 1 / (support m)
};
PALPATE_SINGLE(WallEffect);

PALPATE_FORMULA PALPATE_OF(WallEffect) wallEffect(PALPATE_OF(WaterRules) rules, PALPATE_OF(WallsBeside) x,
                                                  PALPATE_OF(WallsBeside) y, PALPATE_OF(WallsBeside) z) {
  const Real freeX = Real(1.0) - x.share;
  const Real freeY = Real(1.0) - y.share;
  const Real freeZ = Real(1.0) - z.share;
  PALPATE_OF(WallEffect) effect;
  effect.sum = rules.wallSum * (Real(1.0) - freeX * freeY * freeZ);
  effect.slope = PALPATE_VEC3(x.layer * freeY * freeZ, y.layer * freeX * freeZ, z.layer * freeX * freeY);
  effect.drag = x.drag * freeY * freeZ + y.drag * freeX * freeZ + z.drag * freeX * freeY;
  return effect;
}

PALPATE_FORMULA PALPATE_VEC3 changeByWalls(PALPATE_OF(WaterRules) rules, PALPATE_OF(WallEffect) walls, Real compression,
                                           PALPATE_VEC3 velocity) {
  return rules.wallPush * compression * walls.slope - rules.wallDrag * walls.drag * velocity;
}

// Along an axis: the place that a particle may have, no nearer to a wall than `nearest`.
PALPATE_FORMULA Real keptInside(Real place, Real size, Real nearest, bool open) {
  if (open) return place;
  return clamp(place, nearest, max(size - nearest, nearest));
}

// The walls of a box, as they stop what would go through them.
PALPATE_STRUCT(StoppingWalls) {
  PALPATE_VEC3 size;
  Real nearest;
  Real step;  // s
  bool openX;
  bool openY;
  bool openZ;
};
PALPATE_SINGLE(StoppingWalls);

// A particle at the end of a substep.
PALPATE_STRUCT(Settled) {
  PALPATE_VEC3 place;
  PALPATE_VEC3 velocity;
  PALPATE_VEC3 stop;  // what walls have changed that by
};
PALPATE_SINGLE(Settled);

// From where it was predicted, by a `change` of its velocity.
PALPATE_FORMULA PALPATE_OF(Settled)
    settle(PALPATE_OF(StoppingWalls) walls, PALPATE_VEC3 predicted, PALPATE_VEC3 velocity, PALPATE_VEC3 change) {
  const PALPATE_VEC3 free = predicted + walls.step * change;
  PALPATE_OF(Settled) settled;
  settled.place = PALPATE_VEC3(keptInside(free.x, walls.size.x, walls.nearest, walls.openX),
                               keptInside(free.y, walls.size.y, walls.nearest, walls.openY),
                               keptInside(free.z, walls.size.z, walls.nearest, walls.openZ));
  settled.stop = (settled.place - free) / walls.step;
  settled.velocity = velocity + change + settled.stop;
  return settled;
}

// Contacts that a grain remembers: balls of one size touch 12 of their kind at most; overlapping ones, walls and tools
// may be a few more.
const uint kMaxContacts = 20u;
// With whom a contact is: a grain by its id, one of the six walls, the model, or a point of a body.
const uint kFirstWall = 0x80000000u;
const uint kModelContact = 0x80000008u;
const uint kFirstBodyPoint = 0x80000010u;

// What is the same for all grains: balls that do not turn.
PALPATE_STRUCT(GrainRules) {
  Real diameter;  // m
  Real share;     // of what is wrong with a contact, what one of the two puts right in a substep
  Real friction;  // Coulomb's coefficient
  Real step;      // s
};
PALPATE_SINGLE(GrainRules);

// How far two that touch are displaced along each other as a substep begins. `left`: what the last one left of it,
// which both have moved on since by what they will move now, `moved`, but for the velocity `fall` that gravity has
// added between them; nothing where they did not touch.
PALPATE_FORMULA PALPATE_VEC3 grainSlip(PALPATE_OF(GrainRules) rules, PALPATE_VEC3 left, PALPATE_VEC3 moved,
                                       PALPATE_VEC3 fall) {
  return left + moved - rules.step * fall;
}

// A contact after a substep.
PALPATE_STRUCT(GrainContact) {
  PALPATE_VEC3 change;  // of the grain's velocity, m/s
  PALPATE_VEC3 slip;  // so far the two were displaced along each other when the substep began, from where they hold, m
};
PALPATE_SINGLE(GrainContact);

// Of a grain and what it touches: `normal` leads from that to the grain, `overlap` is above 0. `slip` is how far the
// two are displaced along each other as the substep begins, and `moved` how far the grain will have moved relative to
// the other in it by itself. Friction holds by what two surfaces are displaced since they met, as a spring does
// (Cundall, Strack 1979), not by what they move in a substep: that would let every heap creep. It gives way where it
// would exceed the coefficient times the normal part.
PALPATE_FORMULA PALPATE_OF(GrainContact) grainContact(PALPATE_OF(GrainRules) rules, PALPATE_VEC3 normal, Real overlap,
                                                      PALPATE_VEC3 moved, PALPATE_VEC3 slip) {
  PALPATE_VEC3 displaced = slip + moved;
  displaced = displaced - dot(displaced, normal) * normal;
  const Real most = rules.friction * overlap;
  const Real far = length(displaced);
  if (far > most) displaced = displaced * (most / far);
  PALPATE_OF(GrainContact) contact;
  contact.slip = displaced - moved;
  contact.change = (rules.share / rules.step) * (overlap * normal - displaced);
  return contact;
}

PALPATE_SHARED_END
#endif
