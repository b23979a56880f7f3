#include "mapstore/store/schema.h"

#include <array>

namespace maploc {
namespace {

constexpr std::string_view kVersion1 = R"sql(
CREATE TABLE meta (
  name TEXT PRIMARY KEY,
  value INTEGER NOT NULL
) STRICT, WITHOUT ROWID;
INSERT INTO meta VALUES ('change_counter', 0);

CREATE TABLE map_versions (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  name TEXT NOT NULL,
  version INTEGER NOT NULL CHECK (version >= 1),
  state INTEGER NOT NULL CHECK (state IN (0, 1)),
  metric INTEGER NOT NULL CHECK (metric IN (0, 1)),
  scale REAL NOT NULL CHECK (scale > 0),
  rotation_x REAL NOT NULL, rotation_y REAL NOT NULL,
  rotation_z REAL NOT NULL, rotation_w REAL NOT NULL,
  translation_x REAL NOT NULL, translation_y REAL NOT NULL, translation_z REAL NOT NULL,
  point_kind TEXT NOT NULL, point_kind_bytes INTEGER NOT NULL CHECK (point_kind_bytes BETWEEN 0 AND 512),
  point_kind_metric INTEGER NOT NULL CHECK (point_kind_metric IN (1, 2)),
  line_kind TEXT NOT NULL, line_kind_bytes INTEGER NOT NULL CHECK (line_kind_bytes BETWEEN 0 AND 512),
  line_kind_metric INTEGER NOT NULL CHECK (line_kind_metric IN (1, 2)),
  created_unix_ns INTEGER NOT NULL,
  segment_count INTEGER NOT NULL DEFAULT 0,
  point_count INTEGER NOT NULL DEFAULT 0,
  line_count INTEGER NOT NULL DEFAULT 0,
  usable_line_count INTEGER NOT NULL DEFAULT 0,
  UNIQUE (name, version)
) STRICT;

CREATE TABLE segments (
  map INTEGER NOT NULL REFERENCES map_versions (id),
  segment INTEGER NOT NULL CHECK (segment >= 0),
  usable_line_count INTEGER NOT NULL,
  path_count INTEGER NOT NULL,
  path BLOB NOT NULL,
  PRIMARY KEY (map, segment)
) STRICT;

CREATE TABLE segment_features (
  map INTEGER NOT NULL,
  segment INTEGER NOT NULL,
  type INTEGER NOT NULL CHECK (type IN (1, 2)),
  landmark_count INTEGER NOT NULL CHECK (landmark_count >= 0),
  descriptor_count INTEGER NOT NULL CHECK (descriptor_count >= 0),
  checksum INTEGER NOT NULL,
  ids BLOB NOT NULL,
  geometry BLOB NOT NULL,
  owners BLOB NOT NULL,
  descriptors BLOB NOT NULL,
  PRIMARY KEY (map, segment, type),
  FOREIGN KEY (map, segment) REFERENCES segments (map, segment)
) STRICT;

CREATE TABLE sessions (
  id TEXT PRIMARY KEY,
  map INTEGER NOT NULL REFERENCES map_versions (id),
  robot TEXT NOT NULL,
  start_unix_ns INTEGER NOT NULL,
  end_unix_ns INTEGER NOT NULL,
  end INTEGER NOT NULL CHECK (end IN (0, 1, 2)),
  revoked INTEGER NOT NULL CHECK (revoked IN (0, 1)),
  queries INTEGER NOT NULL DEFAULT 0,
  localized INTEGER NOT NULL DEFAULT 0
) STRICT, WITHOUT ROWID;
CREATE INDEX sessions_by_map ON sessions (map);

CREATE TABLE session_labels (
  session TEXT NOT NULL REFERENCES sessions (id),
  name TEXT NOT NULL,
  value TEXT NOT NULL,
  PRIMARY KEY (session, name)
) STRICT, WITHOUT ROWID;

CREATE TABLE observations (
  session TEXT NOT NULL REFERENCES sessions (id),
  sequence INTEGER NOT NULL CHECK (sequence >= 1),
  segment INTEGER NOT NULL CHECK (segment >= -1),
  outcome INTEGER NOT NULL CHECK (outcome BETWEEN 1 AND 6),
  point_matches INTEGER NOT NULL, point_inliers INTEGER NOT NULL,
  usable_line_matches INTEGER NOT NULL, usable_line_inliers INTEGER NOT NULL,
  vertical_line_matches INTEGER NOT NULL, vertical_line_inliers INTEGER NOT NULL,
  strategy INTEGER NOT NULL CHECK (strategy BETWEEN 1 AND 4),
  fell_back INTEGER NOT NULL CHECK (fell_back IN (0, 1)),
  iterations INTEGER NOT NULL,
  gravity_disagreement_rad REAL NOT NULL,
  confidence REAL NOT NULL,
  total_ms REAL NOT NULL,
  time_unix_ns INTEGER NOT NULL,
  PRIMARY KEY (session, sequence)
) STRICT, WITHOUT ROWID;

CREATE TABLE segment_sessions (
  map INTEGER NOT NULL,
  segment INTEGER NOT NULL,
  session TEXT NOT NULL REFERENCES sessions (id),
  queries INTEGER NOT NULL, localized INTEGER NOT NULL,
  point_matches INTEGER NOT NULL, point_inliers INTEGER NOT NULL,
  usable_line_matches INTEGER NOT NULL, usable_line_inliers INTEGER NOT NULL,
  vertical_line_matches INTEGER NOT NULL, vertical_line_inliers INTEGER NOT NULL,
  median_point_matches REAL NOT NULL,
  median_usable_line_matches REAL NOT NULL,
  median_vertical_line_matches REAL NOT NULL,
  strategy_before INTEGER NOT NULL CHECK (strategy_before BETWEEN 1 AND 3),
  strategy_after INTEGER NOT NULL CHECK (strategy_after BETWEEN 1 AND 3),
  PRIMARY KEY (map, segment, session),
  FOREIGN KEY (map, segment) REFERENCES segments (map, segment)
) STRICT, WITHOUT ROWID;
CREATE INDEX segment_sessions_by_session ON segment_sessions (session, segment);

CREATE TABLE selector_options (
  id INTEGER PRIMARY KEY,
  half_life_sessions REAL NOT NULL CHECK (half_life_sessions > 0),
  change_discount REAL NOT NULL,
  independent_matches_per_query REAL NOT NULL,
  min_localized_queries INTEGER NOT NULL,
  prior_matches REAL NOT NULL,
  prior_inlier_ratio REAL NOT NULL,
  hysteresis REAL NOT NULL,
  cost_1p1l REAL NOT NULL,
  cost_2p REAL NOT NULL,
  cost_mixed REAL NOT NULL
) STRICT;

CREATE TABLE decisions (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  map INTEGER NOT NULL,
  segment INTEGER NOT NULL,
  time_unix_ns INTEGER NOT NULL,
  cause TEXT NOT NULL,
  options INTEGER NOT NULL REFERENCES selector_options (id),
  pinned INTEGER CHECK (pinned BETWEEN 1 AND 3),
  strategy INTEGER NOT NULL CHECK (strategy BETWEEN 1 AND 3),
  source INTEGER NOT NULL CHECK (source BETWEEN 1 AND 3),
  reason TEXT NOT NULL,
  predicted_success REAL NOT NULL,
  sessions INTEGER NOT NULL, queries INTEGER NOT NULL, localized INTEGER NOT NULL,
  point_matches REAL NOT NULL, point_inliers REAL NOT NULL,
  usable_line_matches REAL NOT NULL, usable_line_inliers REAL NOT NULL,
  vertical_line_matches REAL NOT NULL, vertical_line_inliers REAL NOT NULL,
  typical_point_matches REAL NOT NULL,
  typical_usable_line_matches REAL NOT NULL,
  typical_vertical_line_matches REAL NOT NULL,
  FOREIGN KEY (map, segment) REFERENCES segments (map, segment)
) STRICT;
CREATE INDEX decisions_by_segment ON decisions (map, segment, id);
)sql";

// The selector looks at the posterior, ranks all strategies and knows what draws yield. Options of
// version 1 get the defaults below; its decisions are derived anew with them.
constexpr std::string_view kVersion2 = R"sql(
ALTER TABLE selector_options ADD COLUMN independent_queries_per_session REAL NOT NULL DEFAULT 20;
ALTER TABLE selector_options ADD COLUMN criterion INTEGER NOT NULL DEFAULT 1 CHECK (criterion IN (1, 2));
ALTER TABLE selector_options ADD COLUMN max_iterations INTEGER NOT NULL DEFAULT 10000;
ALTER TABLE selector_options ADD COLUMN two_points_good REAL NOT NULL DEFAULT 1;
ALTER TABLE selector_options ADD COLUMN two_points_bad REAL NOT NULL DEFAULT 1;
ALTER TABLE selector_options ADD COLUMN point_and_line_good REAL NOT NULL DEFAULT 1;
ALTER TABLE selector_options ADD COLUMN point_and_line_bad REAL NOT NULL DEFAULT 1;
ALTER TABLE selector_options ADD COLUMN point_and_verticals_good REAL NOT NULL DEFAULT 1;
ALTER TABLE selector_options ADD COLUMN point_and_verticals_bad REAL NOT NULL DEFAULT 1;
ALTER TABLE decisions ADD COLUMN second_choice INTEGER NOT NULL DEFAULT 3 CHECK (second_choice BETWEEN 1 AND 3);
ALTER TABLE decisions ADD COLUMN third_choice INTEGER NOT NULL DEFAULT 3 CHECK (third_choice BETWEEN 1 AND 3);
ALTER TABLE decisions ADD COLUMN weighted_queries REAL NOT NULL DEFAULT 0;
ALTER TABLE decisions ADD COLUMN weighted_localized REAL NOT NULL DEFAULT 0;
ALTER TABLE decisions ADD COLUMN independent_points REAL NOT NULL DEFAULT 0;
ALTER TABLE decisions ADD COLUMN independent_usable_lines REAL NOT NULL DEFAULT 0;
ALTER TABLE decisions ADD COLUMN independent_vertical_lines REAL NOT NULL DEFAULT 0;
)sql";

// States and history follow from rows, pins and options alone, so the history is no longer stored.
// The caller of the migration fills segment_states and the fingerprint (DeriveAllAnew). A row's
// options are those of the decision that it caused. A session may itself have the id "pin" or
// "unpin": its decision has the session's end as its time and is no pin.
constexpr std::string_view kVersion3 = R"sql(
INSERT INTO meta VALUES ('derivation_fingerprint', 0);

ALTER TABLE segment_sessions ADD COLUMN options INTEGER REFERENCES selector_options (id);
UPDATE segment_sessions SET options = (
  SELECT d.options FROM decisions d
  WHERE d.map = segment_sessions.map AND d.segment = segment_sessions.segment
    AND d.cause = segment_sessions.session
  ORDER BY d.id DESC LIMIT 1);

CREATE TABLE pins (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  map INTEGER NOT NULL,
  segment INTEGER NOT NULL,
  time_unix_ns INTEGER NOT NULL,
  strategy INTEGER CHECK (strategy BETWEEN 1 AND 3),
  options INTEGER NOT NULL REFERENCES selector_options (id),
  FOREIGN KEY (map, segment) REFERENCES segments (map, segment)
) STRICT;
CREATE INDEX pins_by_segment ON pins (map, segment, id);
INSERT INTO pins (map, segment, time_unix_ns, strategy, options)
  SELECT d.map, d.segment, d.time_unix_ns, d.pinned, d.options FROM decisions d
  WHERE d.cause IN ('pin', 'unpin') AND NOT EXISTS (
    SELECT 1 FROM sessions s WHERE s.id = d.cause AND s.end_unix_ns = d.time_unix_ns)
  ORDER BY d.id;
DROP TABLE decisions;

CREATE TABLE segment_states (
  map INTEGER NOT NULL,
  segment INTEGER NOT NULL,
  options INTEGER NOT NULL REFERENCES selector_options (id),
  pinned INTEGER CHECK (pinned BETWEEN 1 AND 3),
  strategy INTEGER NOT NULL CHECK (strategy BETWEEN 1 AND 3),
  second_choice INTEGER NOT NULL CHECK (second_choice BETWEEN 1 AND 3),
  third_choice INTEGER NOT NULL CHECK (third_choice BETWEEN 1 AND 3),
  source INTEGER NOT NULL CHECK (source BETWEEN 1 AND 3),
  reason TEXT NOT NULL,
  predicted_success REAL NOT NULL,
  sessions INTEGER NOT NULL, queries INTEGER NOT NULL, localized INTEGER NOT NULL,
  point_matches REAL NOT NULL, point_inliers REAL NOT NULL,
  usable_line_matches REAL NOT NULL, usable_line_inliers REAL NOT NULL,
  vertical_line_matches REAL NOT NULL, vertical_line_inliers REAL NOT NULL,
  typical_point_matches REAL NOT NULL,
  typical_usable_line_matches REAL NOT NULL,
  typical_vertical_line_matches REAL NOT NULL,
  weighted_queries REAL NOT NULL, weighted_localized REAL NOT NULL,
  independent_points REAL NOT NULL,
  independent_usable_lines REAL NOT NULL,
  independent_vertical_lines REAL NOT NULL,
  PRIMARY KEY (map, segment),
  FOREIGN KEY (map, segment) REFERENCES segments (map, segment)
) STRICT, WITHOUT ROWID;
)sql";

// A new version of a map starts with what sessions taught about the landmarks that it shares with
// older ones. Versions that were there before inherit nothing.
constexpr std::string_view kVersion4 = R"sql(
CREATE TABLE inheritance (
  map INTEGER NOT NULL,
  segment INTEGER NOT NULL,
  source_map INTEGER NOT NULL,
  source_segment INTEGER NOT NULL,
  weight REAL NOT NULL CHECK (weight > 0 AND weight <= 1),
  PRIMARY KEY (map, segment, source_map, source_segment),
  FOREIGN KEY (map, segment) REFERENCES segments (map, segment),
  FOREIGN KEY (source_map, source_segment) REFERENCES segments (map, segment)
) STRICT, WITHOUT ROWID;
CREATE INDEX inheritance_by_source ON inheritance (source_map, source_segment);
)sql";

// Landmarks get the directions from which they were seen. Older rows have none, and an empty blob
// leaves their checksums valid. Outcomes go up to 7: SQLite cannot alter a CHECK, so the table is
// made anew.
constexpr std::string_view kVersion5 = R"sql(
ALTER TABLE segment_features ADD COLUMN viewing BLOB NOT NULL DEFAULT x'';
ALTER TABLE segment_features ADD COLUMN covariances BLOB NOT NULL DEFAULT x'';
ALTER TABLE map_versions ADD COLUMN shared_error_rad REAL NOT NULL DEFAULT 0 CHECK (shared_error_rad >= 0);

CREATE TABLE new_observations (
  session TEXT NOT NULL REFERENCES sessions (id),
  sequence INTEGER NOT NULL CHECK (sequence >= 1),
  segment INTEGER NOT NULL CHECK (segment >= -1),
  outcome INTEGER NOT NULL CHECK (outcome BETWEEN 1 AND 7),
  point_matches INTEGER NOT NULL, point_inliers INTEGER NOT NULL,
  usable_line_matches INTEGER NOT NULL, usable_line_inliers INTEGER NOT NULL,
  vertical_line_matches INTEGER NOT NULL, vertical_line_inliers INTEGER NOT NULL,
  strategy INTEGER NOT NULL CHECK (strategy BETWEEN 1 AND 4),
  fell_back INTEGER NOT NULL CHECK (fell_back IN (0, 1)),
  iterations INTEGER NOT NULL,
  gravity_disagreement_rad REAL NOT NULL,
  confidence REAL NOT NULL,
  total_ms REAL NOT NULL,
  time_unix_ns INTEGER NOT NULL,
  inlier_rms_pixels REAL NOT NULL DEFAULT 0,
  gravity_rejected INTEGER NOT NULL DEFAULT 0 CHECK (gravity_rejected IN (0, 1)),
  gravity_tilt_x_rad REAL NOT NULL DEFAULT 0,
  gravity_tilt_y_rad REAL NOT NULL DEFAULT 0,
  PRIMARY KEY (session, sequence)
) STRICT, WITHOUT ROWID;
INSERT INTO new_observations (
    session, sequence, segment, outcome, point_matches, point_inliers, usable_line_matches,
    usable_line_inliers, vertical_line_matches, vertical_line_inliers, strategy, fell_back,
    iterations, gravity_disagreement_rad, confidence, total_ms, time_unix_ns)
  SELECT session, sequence, segment, outcome, point_matches, point_inliers, usable_line_matches,
    usable_line_inliers, vertical_line_matches, vertical_line_inliers, strategy, fell_back,
    iterations, gravity_disagreement_rad, confidence, total_ms, time_unix_ns FROM observations;
DROP TABLE observations;
ALTER TABLE new_observations RENAME TO observations;
)sql";

// Nothing used the covariances. (TakeCovariancesOffChecksums comes before.)
constexpr std::string_view kVersion6 = R"sql(
ALTER TABLE segment_features DROP COLUMN covariances;
)sql";

// A session's end costs the same whatever came before: rows are found in their folding order, the
// fold goes on from a checkpoint (DeriveAllAnew writes the first ones), and a server reads what has
// changed alone.
constexpr std::string_view kVersion7 = R"sql(
ALTER TABLE segment_sessions ADD COLUMN start_unix_ns INTEGER NOT NULL DEFAULT 0;
UPDATE segment_sessions SET start_unix_ns = (
  SELECT s.start_unix_ns FROM sessions s WHERE s.id = segment_sessions.session);
CREATE INDEX segment_sessions_in_order
  ON segment_sessions (map, segment, start_unix_ns, session);
ALTER TABLE segment_states ADD COLUMN changed INTEGER NOT NULL DEFAULT 0;
CREATE INDEX segment_states_by_change ON segment_states (map, changed);

CREATE TABLE segment_folds (
  map INTEGER NOT NULL,
  segment INTEGER NOT NULL,
  start_unix_ns INTEGER NOT NULL,
  session TEXT NOT NULL REFERENCES sessions (id),
  sessions INTEGER NOT NULL,
  options INTEGER NOT NULL REFERENCES selector_options (id),
  row_options INTEGER NOT NULL REFERENCES selector_options (id),
  state BLOB NOT NULL,
  PRIMARY KEY (map, segment, start_unix_ns, session),
  FOREIGN KEY (map, segment) REFERENCES segments (map, segment)
) STRICT, WITHOUT ROWID;
)sql";

// Which version robots get is a decision of its own: until then it was the newest. A deleted
// version keeps its rows of statistics, which newer versions inherit.
constexpr std::string_view kVersion8 = R"sql(
ALTER TABLE map_versions ADD COLUMN enabled_order INTEGER NOT NULL DEFAULT 0 CHECK (enabled_order >= 0);
ALTER TABLE map_versions ADD COLUMN deleted INTEGER NOT NULL DEFAULT 0 CHECK (deleted IN (0, 1));
UPDATE map_versions SET enabled_order = version WHERE state = 1;
)sql";

// A map opens without its landmarks: what place recognition needs of each segment stands beside
// it. (WriteMissingPlaces writes it for the segments that are there.)
constexpr std::string_view kVersion9 = R"sql(
CREATE TABLE segment_places (
  map INTEGER NOT NULL,
  segment INTEGER NOT NULL,
  landmark_count INTEGER NOT NULL CHECK (landmark_count >= 0),
  row_count INTEGER NOT NULL CHECK (row_count >= 0),
  reach REAL NOT NULL,
  checksum INTEGER NOT NULL,
  ids BLOB NOT NULL,
  row_counts BLOB NOT NULL,
  owners BLOB NOT NULL,
  descriptors BLOB NOT NULL,
  PRIMARY KEY (map, segment),
  FOREIGN KEY (map, segment) REFERENCES segments (map, segment)
) STRICT;
)sql";

// A query that a robot repeats counts once, also when it is answered a second time.
constexpr std::string_view kVersion10 = R"sql(
ALTER TABLE observations ADD COLUMN request_id TEXT NOT NULL DEFAULT '';
CREATE UNIQUE INDEX observations_by_request ON observations (session, request_id)
  WHERE request_id <> '';
)sql";

constexpr std::array kMigrations = {kVersion1, kVersion2, kVersion3, kVersion4, kVersion5,
                                    kVersion6, kVersion7, kVersion8, kVersion9, kVersion10};

}  // namespace

std::span<const std::string_view> StoreMigrations() { return kMigrations; }

}  // namespace maploc
