// Whether two requests are the same, without keeping them.
#pragma once

#include <cstdint>

namespace google::protobuf {
class MessageLite;
}  // namespace google::protobuf

namespace maploc {

// Of all fields. Stored with the observations, so it is the same after a restart: it depends on the
// message's bytes and the standard library alone. Pure; thread-safe.
std::uint64_t PayloadHash(const google::protobuf::MessageLite& message);

}  // namespace maploc
