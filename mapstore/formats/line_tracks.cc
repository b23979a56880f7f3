#include "mapstore/formats/line_tracks.h"

#include <fstream>
#include <set>
#include <string_view>

#include "mapstore/formats/file_bytes.h"
#include "mapstore/formats/foreign_lines.h"
#include "mapstore/formats/text_fields.h"

namespace maploc {
namespace {

constexpr std::string_view kMagic = "maploc-lines";
constexpr std::string_view kHexDigits = "0123456789abcdef";

Status Wrong(std::string_view what, std::string_view why) { return InvalidArgument(what, why); }

Result<Eigen::Vector3d> ParsePoint(TextFields& fields, std::string_view what) {
  Eigen::Vector3d point;
  for (int axis = 0; axis < 3; ++axis) {
    MAPLOC_ASSIGN_OR_RETURN(point[axis], fields.Number<double>(what));
  }
  return point;
}

Result<int> ParseCount(TextFields& fields, std::string_view what, int minimum) {
  MAPLOC_ASSIGN_OR_RETURN(const int count, fields.Number<int>(what));
  if (count < minimum || count > kMaxTrackLength) {
    return Wrong(what, std::to_string(count) + " is outside of " + std::to_string(minimum) +
                           " to " + std::to_string(kMaxTrackLength));
  }
  return count;
}

// Programs write either case.
int HexValue(char digit) {
  if (digit >= '0' && digit <= '9') return digit - '0';
  if (digit >= 'a' && digit <= 'f') return digit - 'a' + 10;
  if (digit >= 'A' && digit <= 'F') return digit - 'A' + 10;
  return -1;
}

Status ParseDescriptor(std::string_view hex, Descriptors& descriptors) {
  if (hex.size() != 2 * static_cast<std::size_t>(descriptors.kind.bytes)) {
    return Wrong("descriptor", "has " + std::to_string(hex.size()) + " hex digits, but " +
                                   descriptors.kind.name + " has " +
                                   std::to_string(2 * descriptors.kind.bytes));
  }
  for (std::size_t i = 0; i < hex.size(); i += 2) {
    const int high = HexValue(hex[i]);
    const int low = HexValue(hex[i + 1]);
    if (high < 0 || low < 0) return Wrong("descriptor", "holds a character that is not hex");
    descriptors.bytes.push_back(static_cast<std::uint8_t>(high * 16 + low));
  }
  return Status::Ok();
}

Result<LineTrack> ParseGeometry(TextFields& fields) {
  LineTrack track;
  MAPLOC_ASSIGN_OR_RETURN(track.id, fields.Number<std::int64_t>("line id"));
  if (track.id < 0) return Wrong("line id", "is negative");
  MAPLOC_ASSIGN_OR_RETURN(track.segment_in_source.start, ParsePoint(fields, "first end point"));
  MAPLOC_ASSIGN_OR_RETURN(track.segment_in_source.end, ParsePoint(fields, "second end point"));
  if (track.segment_in_source.start == track.segment_in_source.end) {
    return Wrong("second end point", "equals the first");
  }
  return track;
}

Status ParseImages(TextFields& fields, LineTrack& track) {
  MAPLOC_ASSIGN_OR_RETURN(const int count, ParseCount(fields, "number of images", 1));
  std::set<std::int64_t> seen;
  for (int i = 0; i < count; ++i) {
    MAPLOC_ASSIGN_OR_RETURN(const auto image, fields.Number<std::int64_t>("image id"));
    // Two segments of one image are two lines, so that their track is a mistake of its writer.
    if (!seen.insert(image).second) {
      return Wrong("image id", std::to_string(image) + " stands twice in the track");
    }
    track.image_ids.push_back(image);
  }
  return Status::Ok();
}

Status ParseDescriptors(TextFields& fields, LineTracks& tracks) {
  MAPLOC_ASSIGN_OR_RETURN(const int count, ParseCount(fields, "number of descriptors", 0));
  if (count > 0 && tracks.descriptors.kind.bytes == 0) {
    return Wrong("number of descriptors", "is not 0 in a file of kind none");
  }
  for (int i = 0; i < count; ++i) {
    MAPLOC_RETURN_IF_ERROR(ParseDescriptor(fields.Word(), tracks.descriptors));
    tracks.descriptor_track.push_back(static_cast<std::int32_t>(tracks.tracks.size()));
  }
  return Status::Ok();
}

Status ParseTrack(TextFields fields, std::set<std::int64_t>& ids, LineTracks& tracks) {
  MAPLOC_ASSIGN_OR_RETURN(LineTrack track, ParseGeometry(fields));
  if (!ids.insert(track.id).second) {
    return Wrong("line id", std::to_string(track.id) + " stands twice in the file");
  }
  MAPLOC_RETURN_IF_ERROR(ParseImages(fields, track));
  MAPLOC_RETURN_IF_ERROR(ParseDescriptors(fields, tracks));
  if (!fields.AtEnd()) return Wrong("line", "goes on after its last descriptor");
  if (tracks.tracks.size() == kMaxLineTracks) return Wrong("file", "holds too many lines");
  tracks.tracks.push_back(std::move(track));
  return Status::Ok();
}

Status ParseHeader(TextFields fields, LineTracks& tracks) {
  if (fields.Word() != kMagic || fields.Word() != "1") {
    return Wrong("header", "is not 'maploc-lines 1 KIND'");
  }
  const std::string kind(fields.Word());
  if (!fields.AtEnd()) return Wrong("header", "goes on after the descriptors' kind");
  if (kind != "none") {
    MAPLOC_ASSIGN_OR_RETURN(tracks.descriptors.kind, DescriptorKindFromName(kind));
  }
  return Status::Ok();
}

// Of their files only the start is looked at.
Status RefuseForeignLines(const std::string& path) {
  constexpr std::size_t kEnough = 1 << 20;
  std::string bytes(kEnough, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(bytes.data(), kEnough);
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  const std::string name = NameForeignLines(path, bytes);
  if (name.empty()) return Status::Ok();
  return InvalidFile(path, "looks like " + name +
                               ", which has no descriptors, so that nothing could match its lines; "
                               "give --images with --lines auto, which finds lines in the photos");
}

std::string Hex(std::span<const std::uint8_t> bytes) {
  std::string hex;
  for (const std::uint8_t byte : bytes) {
    hex += kHexDigits[byte >> 4];
    hex += kHexDigits[byte & 15];
  }
  return hex;
}

}  // namespace

Result<LineTracks> ReadLineTracks(const std::string& path) {
  // First, because ReadTextFile would say of a folder or a binary file only that it is no text.
  MAPLOC_RETURN_IF_ERROR(RefuseForeignLines(path));
  MAPLOC_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  LineTracks tracks;
  std::set<std::int64_t> ids;
  TextLines lines(text);
  std::string_view line;
  bool has_header = false;
  while (lines.NextRecord(line)) {
    const TextFields fields(line.substr(0, line.find('#')));
    const Status status =
        has_header ? ParseTrack(fields, ids, tracks) : ParseHeader(fields, tracks);
    has_header = true;
    if (!status.ok()) {
      return InvalidFile(path + ":" + std::to_string(lines.number()), status.message());
    }
  }
  if (!has_header) {
    return InvalidFile(path, "is empty; the first line must be 'maploc-lines 1 KIND'");
  }
  return tracks;
}

Status WriteLineTracks(const std::string& path, const LineTracks& tracks) {
  std::ofstream file(path);
  // 17 digits give every double back exactly.
  file.precision(17);
  const DescriptorKind& kind = tracks.descriptors.kind;
  file << kMagic << " 1 " << (kind.name.empty() ? "none" : kind.name)
       << "\n# ID  X1 Y1 Z1  X2 Y2 Z2  N IMAGE...  M HEX...\n";
  std::size_t row = 0;
  for (std::size_t i = 0; i < tracks.tracks.size(); ++i) {
    const LineTrack& track = tracks.tracks[i];
    const LineSegment3& segment = track.segment_in_source;
    file << track.id << "  " << segment.start.transpose() << "  " << segment.end.transpose() << "  "
         << track.image_ids.size();
    for (const std::int64_t image : track.image_ids) file << ' ' << image;
    const std::size_t first_row = row;
    while (row < tracks.descriptor_track.size() &&
           tracks.descriptor_track[row] == static_cast<std::int32_t>(i)) {
      ++row;
    }
    file << "  " << row - first_row;
    for (std::size_t r = first_row; r < row; ++r) {
      file << ' ' << Hex(tracks.descriptors.row(static_cast<int>(r)));
    }
    file << '\n';
  }
  file.flush();
  if (!file) return Status(StatusCode::kInternal, "WRITE_FAILED", path + ": could not be written");
  return Status::Ok();
}

}  // namespace maploc
