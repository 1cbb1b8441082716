#pragma once

/// The results of the verification suite as text and as JSON.

#include "verify/suite.h"

#include <string>

namespace faceta {

/// "name  claim" of every property, a line each.
std::string list_properties();

/// For a terminal: one row a subject, one column a property, within 100 columns (one subject alone:
/// one row a property, with figures); failures in words, excuses with their reasons, notes, and a
/// line of sums. `colour`: with ANSI colours.
std::string suite_text(const SuiteReport& report, bool colour);

/// One JSON object:
///   version           of the program, as given
///   passed            whether no property failed
///   effort            "fast" or "full"
///   seed              what the random numbers came from
///   isa               the instruction set whose kernels were sampled
///   family_level      chance of any false alarm in the whole suite
///   test_level        that of one statistical test (Sidak)
///   seconds           wall clock
///   counts            passed, failed, excused, not_applicable: number of checks
///   properties        [name, claim, of: "subject" or "model", figure] of those that were asked
///   models            [name, title, results] of the models asked as a whole
///   subjects          [name, model, origin: "exemplar", "settings" or "scene", exemplar or where
///                     (file:line:column), lossless, parameters: {name: text}, seconds, results]
///   notes             what was not verified or not as it is, in words
/// and each of the results has
///   property          its name
///   verdict           "passed", "failed", "excused" or "not applicable"
///   figure            the property's own measure (what it is: `properties`), null if not finite
///   text              what failed and where, or why there is nothing to prove; may be empty
///   reason, reference of an excuse; absent otherwise
///   seconds           of one thread
/// Fields may be added, never renamed.
std::string suite_json(const SuiteReport& report, const std::string& version);

} // namespace faceta
