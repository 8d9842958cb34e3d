#pragma once

#include <span>

#include "engine/core/attribute_change.hpp"
#include "engine/core/bare_vector.hpp"
#include "engine/edit/point_states.hpp"

namespace palpate {

/// A point that strokes of a layer have changed: before the first of them, after the last one, and as it is without
/// anything else that has changed it since.
struct LayerRecord {
  PointState before, after;  ///< of a point that they inserted: its parent before them, gone
  DVec3 displacement{0};     ///< the sum of those of its strokes
  PointState present;        ///< as at strength 1
  bool isUntouched = false;  ///< nothing else has changed it
  bool isOfMany = false;     ///< other layers have, too: they add up in any order, and so do not turn along
};

/// The points of a layer at rest at strength 1, and where each belongs on the surface before the strokes. That is where
/// the strokes found it, unless they have brought points together from afar, as deep cuts do: then those of a
/// neighbourhood share the surface before evenly (a discrete harmonic map; Eck et al. 1995), so that the surface in
/// between has no rags. Points that exist before the strokes alone fill what would be sparse. Ascending by number, with
/// the points around. `records`: ascending by number. `present`: all points, those of the records as there.
BareVector<LayerPlace> layerPlaces(std::span<const LayerRecord> records, const PointStates& present);

}  // namespace palpate
