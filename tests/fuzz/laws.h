#pragma once

#include <string>

namespace lcpbench {

// What holds for any bytes that are given to a reader of problems or scenes. Empty, or the law that is broken. An
// exception that is no InputError passes through.

/// Either a problem that is written and read back bit for bit, or an InputError of one line that begins with the place.
std::string BrokenJsonLineLaw(const std::string& text);
std::string BrokenMatrixMarketLaw(const std::string& text);

/// The promises of scene_file.h: a valid world, which survives being written and read and whose contacts are found and
/// assembled, or an InputError of one line. In scene_law.cc, for which the model is needed.
std::string BrokenSceneLaw(const std::string& text);

/// Frames as the host and the worker of docs/protocol.md read them: a message that is written with the same bytes, or
/// an error of one line; and what a worker answers to them is read by the host. In protocol_law.cc.
std::string BrokenProtocolLaw(const std::string& bytes);

/// A file of a campaign's folder, its name in the first line, as a resumed campaign reads it: taken whole but for a
/// torn end, now and again, or an InputError of one line. In journal_law.cc, for which the campaign is needed.
std::string BrokenJournalLaw(const std::string& text);

}  // namespace lcpbench
