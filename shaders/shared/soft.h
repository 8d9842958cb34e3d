// Forces of a soft body's cell on its eight nodes: total-Lagrangian elasticity on a lattice that is fixed at rest, so
// that no neighbour search is needed. A cell has one deformation gradient, in its middle (one-point hexahedron); the
// four modes that it does not resolve, in which a cell bends and twists, have the energy that bending has by Young's
// modulus (physical hourglass control; Flanagan, Belytschko 1981; Belytschko, Bindeman 1993), so that a beam has its
// correct stiffness with any number of cells. The material is stable neo-Hookean (Smith, de Goes, Kim 2018, "Stable
// neo-Hookean flesh simulation"), which follows Hooke's law for small strains, has no stress from a rotation of any
// size, and stays finite if a cell is crushed or inverted: the purpose of corotation, without a polar decomposition.
// Displacements are from rest, so that single precision is spent on strains and not on positions. The loops over cells
// and nodes are in engine/matter/soft_body.cpp. Lengths are m, times s, stresses Pa.
//
// Nodes of a cell are numbered by bits: x is 1, y is 2, z is 4, and a set bit means the far corner. Modes are numbered
// in the same way: mode k is the product of the axes' signs whose bits are in k. 0 is the sum of all, 1, 2 and 4 are
// the differences along the axes, 3, 5, 6 and 7 are bending and twisting.
#ifndef PALPATE_SHARED_SOFT_H
#define PALPATE_SHARED_SOFT_H
#include "shaders/shared/real.h"

PALPATE_SHARED_BEGIN

// A value for each corner of a cell, or for each mode.
PALPATE_STRUCT(Corners) { PALPATE_VEC3 at[8]; };
PALPATE_SINGLE(Corners);

// Constants of all cells of a body.
PALPATE_STRUCT(SoftRules) {
  Real shear;       // of the energy, Pa
  Real bulk;        // of the energy, Pa
  Real restVolume;  // ratio of volumes at which the volumetric part alone would be at rest
  Real viscosity;   // Pa s
  Real bend;        // stiffness of a mode of two axes for each m^3 of the cell, Pa / m^2
  Real twist;       // of the mode of three axes
  Real bendDrag;    // damping of both for each m^3, Pa s / m^2
  Real perEdges;    // 1 / (4 spacing): gradient for a mode of one axis, 1 / m
};
PALPATE_SINGLE(SoftRules);

// Replaces two values by their sum, and by the high one minus the low one.
PALPATE_FORMULA void takePair(PALPATE_INOUT(PALPATE_VEC3) low, PALPATE_INOUT(PALPATE_VEC3) high) {
  const PALPATE_VEC3 first = low;
  low = high + first;
  high = high - first;
}

// Replaces a mean and half a difference by the values of the two sides.
PALPATE_FORMULA void givePair(PALPATE_INOUT(PALPATE_VEC3) mean, PALPATE_INOUT(PALPATE_VEC3) difference) {
  const PALPATE_VEC3 middle = mean;
  mean = middle - difference;
  difference = middle + difference;
}

// From the values at corners to their modes: axis by axis, as in a Walsh-Hadamard transform. Unrolled, so that every
// value has a register.
PALPATE_FORMULA void takeModes(PALPATE_INOUT(PALPATE_OF(Corners)) values) {
  takePair(values.at[0], values.at[1]);
  takePair(values.at[2], values.at[3]);
  takePair(values.at[4], values.at[5]);
  takePair(values.at[6], values.at[7]);
  takePair(values.at[0], values.at[2]);
  takePair(values.at[1], values.at[3]);
  takePair(values.at[4], values.at[6]);
  takePair(values.at[5], values.at[7]);
  takePair(values.at[0], values.at[4]);
  takePair(values.at[1], values.at[5]);
  takePair(values.at[2], values.at[6]);
  takePair(values.at[3], values.at[7]);
}

// From modes to the values at the corners.
PALPATE_FORMULA void giveModes(PALPATE_INOUT(PALPATE_OF(Corners)) modes) {
  givePair(modes.at[0], modes.at[1]);
  givePair(modes.at[2], modes.at[3]);
  givePair(modes.at[4], modes.at[5]);
  givePair(modes.at[6], modes.at[7]);
  givePair(modes.at[0], modes.at[2]);
  givePair(modes.at[1], modes.at[3]);
  givePair(modes.at[4], modes.at[6]);
  givePair(modes.at[5], modes.at[7]);
  givePair(modes.at[0], modes.at[4]);
  givePair(modes.at[1], modes.at[5]);
  givePair(modes.at[2], modes.at[6]);
  givePair(modes.at[3], modes.at[7]);
}

// Gradient of the displacements in the middle of a cell; with 1 on its diagonal it is the deformation gradient F.
PALPATE_FORMULA PALPATE_MAT3 gradientOf(PALPATE_OF(SoftRules) rules, PALPATE_OF(Corners) modes) {
  return PALPATE_MAT3(rules.perEdges * modes.at[1], rules.perEdges * modes.at[2], rules.perEdges * modes.at[4]);
}

// Ratio of a cell's present volume to its volume at rest.
PALPATE_FORMULA Real volumeShare(PALPATE_MAT3 f) { return dot(f[0], cross(f[1], f[2])); }

// Energy of a strain, Pa, up to a constant.
PALPATE_FORMULA Real softEnergy(PALPATE_OF(SoftRules) rules, PALPATE_MAT3 f) {
  const Real squares = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]);
  const Real over = volumeShare(f) - rules.restVolume;
  return Real(0.5) * (rules.shear * (squares - log(squares + Real(1.0))) + rules.bulk * over * over);
}

// First Piola-Kirchhoff stress: the slope of the energy, plus the rate of Green's strain times twice the viscosity,
// which is zero for a rotation. `f` is the deformation gradient, `rate` its rate, 1 / s.
PALPATE_FORMULA PALPATE_MAT3 softStress(PALPATE_OF(SoftRules) rules, PALPATE_MAT3 f, PALPATE_MAT3 rate) {
  const PALPATE_VEC3 areaX = cross(f[1], f[2]);
  const PALPATE_VEC3 areaY = cross(f[2], f[0]);
  const PALPATE_VEC3 areaZ = cross(f[0], f[1]);
  const Real squares = dot(f[0], f[0]) + dot(f[1], f[1]) + dot(f[2], f[2]);
  const Real pull = rules.shear * (Real(1.0) - Real(1.0) / (squares + Real(1.0)));
  const Real press = rules.bulk * (dot(f[0], areaX) - rules.restVolume);
  const Real xx = pull + rules.viscosity * Real(2.0) * dot(f[0], rate[0]);
  const Real yy = pull + rules.viscosity * Real(2.0) * dot(f[1], rate[1]);
  const Real zz = pull + rules.viscosity * Real(2.0) * dot(f[2], rate[2]);
  const Real xy = rules.viscosity * (dot(f[0], rate[1]) + dot(f[1], rate[0]));
  const Real xz = rules.viscosity * (dot(f[0], rate[2]) + dot(f[2], rate[0]));
  const Real yz = rules.viscosity * (dot(f[1], rate[2]) + dot(f[2], rate[1]));
  return PALPATE_MAT3(xx * f[0] + xy * f[1] + xz * f[2] + press * areaX,
                      xy * f[0] + yy * f[1] + yz * f[2] + press * areaY,
                      xz * f[0] + yz * f[1] + zz * f[2] + press * areaZ);
}

// Forces of a cell of `volume` (m^3 of matter) on its nodes, N, from modes of their displacements and velocities. The
// sum over the nodes is 0.
PALPATE_FORMULA PALPATE_OF(Corners)
    cellForces(PALPATE_OF(SoftRules) rules, Real volume, PALPATE_OF(Corners) moved, PALPATE_OF(Corners) velocity) {
  const PALPATE_MAT3 f = gradientOf(rules, moved) + PALPATE_MAT3(Real(1.0));
  const PALPATE_MAT3 stress = softStress(rules, f, gradientOf(rules, velocity));
  const Real perGradient = -volume * rules.perEdges;
  PALPATE_OF(Corners) forces;
  forces.at[0] = PALPATE_VEC3(Real(0.0));
  forces.at[1] = perGradient * stress[0];
  forces.at[2] = perGradient * stress[1];
  forces.at[4] = perGradient * stress[2];
  forces.at[3] = -volume * (rules.bend * moved.at[3] + rules.bendDrag * velocity.at[3]);
  forces.at[5] = -volume * (rules.bend * moved.at[5] + rules.bendDrag * velocity.at[5]);
  forces.at[6] = -volume * (rules.bend * moved.at[6] + rules.bendDrag * velocity.at[6]);
  forces.at[7] = -volume * (rules.twist * moved.at[7] + rules.bendDrag * velocity.at[7]);
  giveModes(forces);
  return forces;
}

// The rest shape of a sculpted cell, which is no longer a cube of the lattice. Displacements are still counted from the
// cube; the deformation gradient is that over the rest shape, F = grad(x) grad(rest)^-1, and the bending that counts is
// the present one minus that at rest, rotated and stretched by F.
PALPATE_STRUCT(CellRest) {
  PALPATE_MAT3 inverse;  // of the gradient of the rest shape over the cube
  PALPATE_VEC3 bent[4];  // modes 3, 5, 6 and 7 of the rest shape, m
  Real volume;           // of the rest shape, relative to that of the cube
  Real bend;             // factor on the rules' stiffness in bending: as for a cube of its volume
};
PALPATE_SINGLE(CellRest);

// From the modes of the corners' displacements at rest from the cube's. Their gradient must not be singular.
PALPATE_FORMULA PALPATE_OF(CellRest) cellRestOf(PALPATE_OF(SoftRules) rules, PALPATE_OF(Corners) modes) {
  const PALPATE_MAT3 gradient = gradientOf(rules, modes) + PALPATE_MAT3(Real(1.0));
  PALPATE_OF(CellRest) rest;
  rest.volume = volumeShare(gradient);
  rest.inverse = transpose(PALPATE_MAT3(cross(gradient[1], gradient[2]) / rest.volume,
                                        cross(gradient[2], gradient[0]) / rest.volume,
                                        cross(gradient[0], gradient[1]) / rest.volume));
  rest.bent[0] = modes.at[3];
  rest.bent[1] = modes.at[5];
  rest.bent[2] = modes.at[6];
  rest.bent[3] = modes.at[7];
  rest.bend = exp(log(rest.volume) * Real(-2.0 / 3.0));
  return rest;
}

// Deformation gradient of a sculpted cell, over its rest shape.
PALPATE_FORMULA PALPATE_MAT3 sculptedGradient(PALPATE_OF(SoftRules) rules, PALPATE_OF(CellRest) rest,
                                              PALPATE_OF(Corners) moved) {
  return (gradientOf(rules, moved) + PALPATE_MAT3(Real(1.0))) * rest.inverse;
}

// cellForces() of a sculpted cell. `volume`: of the matter in the cube, m^3.
PALPATE_FORMULA PALPATE_OF(Corners) sculptedForces(PALPATE_OF(SoftRules) rules, Real volume, PALPATE_OF(CellRest) rest,
                                                   PALPATE_OF(Corners) moved, PALPATE_OF(Corners) velocity) {
  const PALPATE_MAT3 f = sculptedGradient(rules, rest, moved);
  const PALPATE_MAT3 rate = gradientOf(rules, velocity) * rest.inverse;
  const Real bend = rest.bend * rules.bend;
  const Real twist = rest.bend * rules.twist;
  const Real drag = rest.bend * rules.bendDrag;
  const PALPATE_VEC3 xy = bend * (moved.at[3] - f * rest.bent[0]) + drag * (velocity.at[3] - rate * rest.bent[0]);
  const PALPATE_VEC3 xz = bend * (moved.at[5] - f * rest.bent[1]) + drag * (velocity.at[5] - rate * rest.bent[1]);
  const PALPATE_VEC3 yz = bend * (moved.at[6] - f * rest.bent[2]) + drag * (velocity.at[6] - rate * rest.bent[2]);
  const PALPATE_VEC3 xyz = twist * (moved.at[7] - f * rest.bent[3]) + drag * (velocity.at[7] - rate * rest.bent[3]);
  // A stretch of the cell also stretches its bending at rest.
  PALPATE_MAT3 stress = softStress(rules, f, rate);
  stress[0] -= rest.bent[0].x * xy + rest.bent[1].x * xz + rest.bent[2].x * yz + rest.bent[3].x * xyz;
  stress[1] -= rest.bent[0].y * xy + rest.bent[1].y * xz + rest.bent[2].y * yz + rest.bent[3].y * xyz;
  stress[2] -= rest.bent[0].z * xy + rest.bent[1].z * xz + rest.bent[2].z * yz + rest.bent[3].z * xyz;
  const PALPATE_MAT3 overCube = stress * transpose(rest.inverse);
  const Real restVolume = volume * rest.volume;
  const Real perGradient = -restVolume * rules.perEdges;
  PALPATE_OF(Corners) forces;
  forces.at[0] = PALPATE_VEC3(Real(0.0));
  forces.at[1] = perGradient * overCube[0];
  forces.at[2] = perGradient * overCube[1];
  forces.at[4] = perGradient * overCube[2];
  forces.at[3] = -restVolume * xy;
  forces.at[5] = -restVolume * xz;
  forces.at[6] = -restVolume * yz;
  forces.at[7] = -restVolume * xyz;
  giveModes(forces);
  return forces;
}

// Share of the node `corner` of a cell in a position in it, which is from 0 to 1 along each axis.
PALPATE_FORMULA Real cornerShare(PALPATE_VEC3 place, int corner) {
  const Real x = (corner & 1) != 0 ? place.x : Real(1.0) - place.x;
  const Real y = (corner & 2) != 0 ? place.y : Real(1.0) - place.y;
  const Real z = (corner & 4) != 0 ? place.z : Real(1.0) - place.z;
  return x * y * z;
}

// A contact at a point of the skin.
PALPATE_STRUCT(SoftTouch) {
  Real stiffness;  // N / m
  Real damping;    // N s / m
  Real friction;   // Coulomb's coefficient
};
PALPATE_SINGLE(SoftTouch);

// Force on the skin, N: a spring and a damper along `normal`, which points from the other object into the body, never a
// pull; and friction against `relative`, the velocity of the skin minus that of the other object.
PALPATE_FORMULA PALPATE_VEC3 touchForce(PALPATE_OF(SoftTouch) touch, PALPATE_VEC3 normal, Real depth,
                                        PALPATE_VEC3 relative) {
  const Real apart = dot(relative, normal);
  const Real press = max(touch.stiffness * depth - touch.damping * apart, Real(0.0));
  const PALPATE_VEC3 slide = relative - apart * normal;
  const Real speed = length(slide);
  const Real rub = min(touch.damping * speed, touch.friction * press);
  return press * normal - (speed > Real(0.0) ? rub / speed : Real(0.0)) * slide;
}

// Depth of a position in the walls of a box from 0 to `size`, along each axis; below 0 in the far walls.
PALPATE_FORMULA PALPATE_VEC3 depthsInWalls(PALPATE_VEC3 place, PALPATE_VEC3 size) {
  return max(-place, PALPATE_VEC3(Real(0.0))) - max(place - size, PALPATE_VEC3(Real(0.0)));
}

// Force of a wall across an axis on the skin, N; `depth` as depthsInWalls() returns it.
PALPATE_FORMULA PALPATE_VEC3 wallForce(PALPATE_OF(SoftTouch) touch, int axis, Real depth, PALPATE_VEC3 velocity) {
  if (depth == Real(0.0)) return PALPATE_VEC3(Real(0.0));
  PALPATE_VEC3 normal = PALPATE_VEC3(Real(0.0));
  normal[axis] = depth > Real(0.0) ? Real(1.0) : Real(-1.0);
  return touchForce(touch, normal, abs(depth), velocity);
}

// Force of all walls of the box on a skin point, N.
PALPATE_FORMULA PALPATE_VEC3 wallsForce(PALPATE_OF(SoftTouch) touch, PALPATE_VEC3 size, PALPATE_VEC3 place,
                                        PALPATE_VEC3 velocity) {
  const PALPATE_VEC3 depths = depthsInWalls(place, size);
  return wallForce(touch, 0, depths.x, velocity) + wallForce(touch, 1, depths.y, velocity) +
         wallForce(touch, 2, depths.z, velocity);
}

// Force of a ball on a skin point, N. `offset`: of the point from the middle of the ball; `relative`: the velocity of
// the skin minus that of the ball there.
PALPATE_FORMULA PALPATE_VEC3 ballForce(PALPATE_OF(SoftTouch) touch, Real radius, PALPATE_VEC3 offset,
                                       PALPATE_VEC3 relative) {
  const Real away = length(offset);
  if (!(away < radius && away > Real(0.0))) return PALPATE_VEC3(Real(0.0));
  return touchForce(touch, offset / away, radius - away, relative);
}

// Normal of a surface that is carried by the deformation gradient: F^-T n, not normalised; the cofactors need no
// inverse.
PALPATE_FORMULA PALPATE_VEC3 carriedNormal(PALPATE_MAT3 f, PALPATE_VEC3 normal) {
  return normal.x * cross(f[1], f[2]) + normal.y * cross(f[2], f[0]) + normal.z * cross(f[0], f[1]);
}

// The same with unit length, from the gradient of the displacements; if that is zero the normal keeps its bits. If the
// surface is crushed flat, its normal at rest is returned.
PALPATE_FORMULA PALPATE_VEC3 unitNormalCarried(PALPATE_MAT3 change, PALPATE_VEC3 normal) {
  const PALPATE_VEC3 carried = carriedNormal(change + PALPATE_MAT3(Real(1.0)), normal);
  const Real size = length(carried);
  return change == PALPATE_MAT3(Real(0.0)) || !(size > Real(0.0)) ? normal : carried / size;
}

PALPATE_SHARED_END
#endif
