// Interaction of a particle of water or sand with another one, with a wall and with a body of boundary particles in a
// substep: the mathematics of position-based fluids (Macklin, Mueller 2013) in small substeps of one iteration (Macklin
// et al. 2019, "Small steps in physics simulation"), of boundary particles (Akinci et al. 2012) and of grains with
// friction (Macklin et al. 2014, "Unified particle physics"). Each formula is for one particle and one partner, so that
// a pass gathers over neighbours in the order of their slots, and no sum depends on an order of arrival. The loops over
// particles are in engine/matter. Lengths are m, times s.
//
// The constraint of a particle is its compression C = sum w(r / support) / (that sum at rest) - 1, held at 0 or below:
// a free surface does not pull. One Jacobi iteration with the same multiplier per compression for all particles
// conserves momentum and needs no sum of squared gradients; its stiffness is the maximum for one iteration, that of a
// fluid whose speed of sound is kStiffness spacings a substep. The pushes are the slope of an energy, the sum of C^2
// over all particles, also for walls and bodies: these add to the sum of a particle, and do not have a C of their own.
// Giving them that of the particle (Akinci et al. 2012) is not the slope of an energy, and makes standing water in a
// tank boil.
#ifndef PALPATE_SHARED_MATTER_H
#define PALPATE_SHARED_MATTER_H
#include "shaders/shared/types.h"
#include "shaders/shared/weight.h"

PALPATE_SHARED_BEGIN

// Minus the slope of wendland(r), divided by r. Times a difference of two positions it is the gradient of their weight
// in units of 1 / support^2; for equal positions it has no direction and is finite.
PALPATE_FORMULA Real wendlandPull(Real r) {
  const Real t = max(Real(1.0) - r, Real(0.0));
  return Real(20.0) * t * t * t;
}

// Attraction of two particles, one of them at a free surface, as a factor on the difference of two positions: they
// repel each other nearer than kCohesionRest, in support radii, and do not interact from 1 on.
const float kCohesionRest = 0.35f;
PALPATE_FORMULA Real cohesionPull(Real r) {
  const Real t = max(Real(1.0) - r, Real(0.0));
  return (r - Real(kCohesionRest)) * t * t;
}

// Share of all weight around a position that is beyond a plane r support radii away; a half for r = 0.
PALPATE_FORMULA Real shareBeyond(Real r) {
  const Real t = clamp(Real(1.0) - r, Real(0.0), Real(1.0));
  const Real t2 = t * t;
  return t2 * t2 * t2 * (Real(3.5) - t * (Real(4.5) - Real(1.5) * t));
}

// Minus the slope of shareBeyond(r): the share in a layer at r, in units of 1 / support.
PALPATE_FORMULA Real shareInLayer(Real r) {
  const Real t = clamp(Real(1.0) - r, Real(0.0), Real(1.0));
  const Real t2 = t * t;
  return t2 * t2 * t * (Real(21.0) - t * (Real(31.5) - Real(12.0) * t));
}

// Constants of a fluid, the same for all particles and substeps.
PALPATE_STRUCT(WaterRules) {
  Real support;    // radius of the weights
  Real restSum;    // sum of the weights of all neighbours and the particle itself, at rest
  Real wallSum;    // the same for an evenly filled neighbourhood without discrete particles
  Real wallInset;  // in support radii: walls are treated as this much farther away, so that a particle at rest, half a
                   // spacing from them, has its full sum; not below 0
  Real push;       // m/s for a compression of 1 and a pull of 1 / m
  Real wallPush;   // m/s for a compression of 1 and a whole share
  Real drag;       // of a velocity, for a pull of 1
  Real wallDrag;   // of a velocity, for a share of 1 / m in a layer
  Real nearest;    // minimum distance of a particle from a wall
  Real step;       // s
  Real cohesion;   // 1, for a cohesion of 1 and one of the two particles at a surface
};
PALPATE_SINGLE(WaterRules);

// Below 0 if neighbours are missing: at a free surface.
PALPATE_FORMULA Real compressionOf(PALPATE_OF(WaterRules) rules, Real sum) { return sum / rules.restSum - Real(1.0); }

// The part of a compression that pushes: a free surface does not pull.
PALPATE_FORMULA Real pressing(Real compression) { return max(compression, Real(0.0)); }

// How much a particle belongs to a free surface, from 0 to 1: the first layer of a plane surface lacks an eighth.
PALPATE_FORMULA Real atSurface(Real compression) { return min(max(Real(-10.0) * compression, Real(0.0)), Real(1.0)); }

// Change of a particle's velocity by a neighbour. `offset`: from the neighbour to the particle; `pull`: wendlandPull()
// of its length; `compressions`: the sum of both, neither below 0; `relative`: the neighbour's velocity minus the
// particle's. The neighbour's change is bitwise the negative. A boundary point has no compression, and is weighted by
// its volume.
PALPATE_FORMULA PALPATE_VEC3 changeByNeighbour(PALPATE_OF(WaterRules) rules, PALPATE_VEC3 offset, Real pull,
                                               Real compressions, PALPATE_VEC3 relative) {
  return rules.push * pull * compressions * offset + rules.drag * pull * relative;
}

// The same by cohesion, for a neighbour r support radii away; `surfaces`: atSurface() of both together. Forces between
// pairs (Tartakovsky, Meakin 2005), but only at the free surface: inside a liquid they would hold it in a crystalline
// order, and it would stop flowing.
PALPATE_FORMULA PALPATE_VEC3 changeByCohesion(PALPATE_OF(WaterRules) rules, PALPATE_VEC3 offset, Real r,
                                              Real surfaces) {
  return -rules.cohesion * surfaces * cohesionPull(r) * offset;
}

// The walls of a box from 0 to `size` around a position in it: along one axis.
PALPATE_STRUCT(WallsBeside) {
  Real share;  // of all weight beyond both of them
  Real layer;  // slope of that share, away from the nearer one, in units of 1 / support
  Real drag;   // sum of the shares in the layers at them, each divided by its distance, 1 / (support m)
};
PALPATE_SINGLE(WallsBeside);

PALPATE_FORMULA PALPATE_OF(WallsBeside) wallsNear(PALPATE_OF(WaterRules) rules, Real place, Real size) {
  const Real low = place / rules.support + rules.wallInset;
  const Real high = (size - place) / rules.support + rules.wallInset;
  const Real atLow = shareInLayer(low);
  const Real atHigh = shareInLayer(high);
  PALPATE_OF(WallsBeside) walls;
  walls.share = shareBeyond(low) + shareBeyond(high);
  walls.layer = atLow - atHigh;
  walls.drag = atLow / max(place, rules.nearest) + atHigh / max(size - place, rules.nearest);
  return walls;
}

// The same with walls that are `open` or far away.
PALPATE_FORMULA PALPATE_OF(WallsBeside) wallsBeside(PALPATE_OF(WaterRules) rules, Real place, Real size, bool open) {
  if (!open && !(place >= rules.support && size - place >= rules.support)) return wallsNear(rules, place, size);
  PALPATE_OF(WallsBeside) walls;
  walls.share = Real(0.0);
  walls.layer = Real(0.0);
  walls.drag = Real(0.0);
  return walls;
}

// Effect of the walls of a box on a particle: the space beyond them holds the same matter, at rest density, which moves
// so that the velocity is 0 in the plane. Where walls meet, shares are combined as if they were independent.
PALPATE_STRUCT(WallEffect) {
  Real sum;            // part of the sum of weights
  PALPATE_VEC3 slope;  // away from them: the change of a share, in units of 1 / support
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

// Along an axis: the position limited to at least `nearest` from the walls.
PALPATE_FORMULA Real keptInside(Real place, Real size, Real nearest, bool open) {
  if (open) return place;
  return clamp(place, nearest, max(size - nearest, nearest));
}

// The walls of a box that stop particles.
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
  PALPATE_VEC3 stop;  // change of the velocity by walls
};
PALPATE_SINGLE(Settled);

// From the predicted position, by a `change` of the velocity.
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

// Maximum contacts that a grain remembers: balls of one size touch at most 12 others; overlapping ones, walls and tools
// may add a few.
const uint kMaxContacts = 20u;
// Partner of a contact: a grain by its id, one of the six walls, the model, or a point of a body.
const uint kFirstWall = 0x80000000u;
const uint kModelContact = 0x80000008u;
const uint kFirstBodyPoint = 0x80000010u;

// Constants of all grains: balls that do not rotate.
PALPATE_STRUCT(GrainRules) {
  Real diameter;  // m
  Real share;     // of a contact's error, the part that one of the two corrects in a substep
  Real friction;  // Coulomb's coefficient
  Real step;      // s
};
PALPATE_SINGLE(GrainRules);

// Tangential displacement of two touching bodies at the start of a substep. `left`: what the substep before left of it,
// at its own start. In that substep they moved by `moved`, as they will in this one, less the velocity `fall` that
// gravity has added between them. Zero if they did not touch then.
PALPATE_FORMULA PALPATE_VEC3 grainSlip(PALPATE_OF(GrainRules) rules, PALPATE_VEC3 left, PALPATE_VEC3 moved,
                                       PALPATE_VEC3 fall) {
  return left + moved - rules.step * fall;
}

// A contact after a substep.
PALPATE_STRUCT(GrainContact) {
  PALPATE_VEC3 change;  // of the grain's velocity, m/s
  PALPATE_VEC3 slip;    // tangential displacement of the two at the start of the substep, from where they stick, m
};
PALPATE_SINGLE(GrainContact);

// Contact of a grain: `normal` points to it from its partner, `overlap` is above 0, `slip` is the tangential
// displacement at the start of the substep, and `moved` the grain's relative displacement in it without the contact.
// Friction acts on the displacement since first contact, like a spring (Cundall, Strack 1979): with that of one substep
// alone every heap would creep. It slips above the coefficient times the normal part.
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
