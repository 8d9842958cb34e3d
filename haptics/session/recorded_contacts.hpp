// The contacts with which a recording that begins in a running session, and its replay, continue.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate {

class TouchBackend;

/// The contacts of a back end as numbers. It continues from exactly these, as a replay does. Between ticks, after its
/// edits; throws errors of earlier queries.
std::vector<double> recordContacts(TouchBackend& backend);
/// Restores the contacts from the end of LoggedCommand::Kind::begin. Returns the numbers before them: the state of the
/// loop. Throws Error if their number differs.
std::vector<double> restoreContacts(std::string_view content, TouchBackend& backend);
std::string contentOf(std::span<const double> numbers);

}  // namespace palpate
