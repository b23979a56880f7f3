#include "mapstore/importers/imported_lines.h"

#include <algorithm>
#include <unordered_map>
#include <utility>

#include "mapstore/formats/line_tracks.h"

namespace maploc {

Result<ImportedLines> ReadLines(const std::string& path, std::span<const KeyFrame> frames,
                                const Similarity3& map_from_source) {
  MAPLOC_ASSIGN_OR_RETURN(const LineTracks file, ReadLineTracks(path));
  std::unordered_map<std::int64_t, std::int32_t> frame_of_image;
  for (const KeyFrame& frame : frames) {
    frame_of_image.emplace(frame.image_id, static_cast<std::int32_t>(frame_of_image.size()));
  }
  ImportedLines imported;
  for (const LineTrack& track : file.tracks) {
    LineTrackInMap line{{map_from_source * track.segment_in_source.start,
                         map_from_source * track.segment_in_source.end},
                        {},
                        {}};
    for (const std::int64_t image : track.image_ids) {
      const auto frame = frame_of_image.find(image);
      if (frame == frame_of_image.end()) {
        return InvalidFile(path, "line " + std::to_string(track.id) + ": image " +
                                     std::to_string(image) + " is not in the model");
      }
      line.frames.push_back(frame->second);
    }
    std::sort(line.frames.begin(), line.frames.end());
    imported.lines.push_back(std::move(line));
  }
  for (std::size_t row = 0; row < file.descriptor_track.size(); ++row) {
    const auto bytes = file.descriptors.row(static_cast<int>(row));
    auto& of_line =
        imported.lines[static_cast<std::size_t>(file.descriptor_track[row])].descriptors;
    of_line.insert(of_line.end(), bytes.begin(), bytes.end());
  }
  for (std::size_t i = 0; i < imported.lines.size(); ++i) {
    if (!imported.lines[i].descriptors.empty()) continue;
    return InvalidFile(path, "line " + std::to_string(file.tracks[i].id) +
                                 " has no descriptor, so nothing could match it");
  }
  if (!imported.lines.empty()) imported.kind = file.descriptors.kind;
  return imported;
}

}  // namespace maploc
