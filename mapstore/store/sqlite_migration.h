// What a migration does that SQL cannot.
#pragma once

#include "mapstore/base/status.h"
#include "mapstore/store/sqlite_database.h"

namespace maploc {

// Stores of schema version 5 kept covariances of points, which their checksums end with.
inline constexpr int kVersionWithCovariances = 5;

// Before that column is dropped: makes the checksums fit what is left. A row whose checksum did not
// fit does not fit then either, so that damage stays known. Reads no other blob.
Status TakeCovariancesOffChecksums(SqliteDatabase& database);

}  // namespace maploc
