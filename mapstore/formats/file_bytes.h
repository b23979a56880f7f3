// A whole file in memory, as bytes or as text. Only for this folder.
#pragma once

#include <string>
#include <string_view>

#include "mapstore/base/status.h"

namespace maploc {

// NOT_FOUND (FILE_NOT_FOUND) for a missing one; INVALID_FILE for what is not a regular file or
// cannot be read to its end.
Result<std::string> ReadFileBytes(const std::string& path);

// As above, for text: a UTF-8 byte order mark is taken off, and where CR alone ends the lines (old
// Macs) it becomes LF. INVALID_FILE, with the line, for what is no text of one byte a character.
Result<std::string> ReadTextFile(const std::string& path);

// `text` without the mark that some editors put before UTF-8.
std::string_view WithoutByteOrderMark(std::string_view text);

}  // namespace maploc
