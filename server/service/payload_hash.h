// Whether two requests are the same, without keeping them.
#pragma once

#include <cstdint>

namespace google::protobuf {
class MessageLite;
}  // namespace google::protobuf

namespace maploc {

// Of all fields. Depends on the program: to be compared within one process. Pure; thread-safe.
std::uint64_t PayloadHash(const google::protobuf::MessageLite& message);

}  // namespace maploc
