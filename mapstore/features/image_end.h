// Whether a picture's file has its end. Decoders fill what is missing with grey, or keep what the
// memory held, and tell nobody. Only for this folder.
#pragma once

#include <string_view>

namespace maploc {

// True where the bytes are a JPEG or a PNG that stops before its end marker; false for whole ones
// and for all other formats. What follows the end (phones append videos) does not matter.
bool EndsEarly(std::string_view bytes);

// Whether the last kEndMarkBytes of a file end as a JPEG or a PNG does when nothing follows it.
inline constexpr int kEndMarkBytes = 12;
bool EndsWithMark(std::string_view last_bytes);

}  // namespace maploc
