#pragma once

#include <string>

#include "engine/edit/history.hpp"
#include "engine/edit/layer_attributes.hpp"

namespace palpate {

/// An entry of a history for a person: what it is, such as "selection" or "stroke in layer 1", and the points that it
/// changes, such as "1204 points"; the latter is empty where it is of none.
struct ChangeInWords {
  std::string what, points;
};
/// Of the last change, while it is done.
ChangeInWords inWords(const HistoryChange& change, const PointStates& present, const LayerAttributes& attributes);

}  // namespace palpate
