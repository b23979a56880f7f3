#include "mapstore/features/photo_header.h"

#include <array>
#include <cstdint>
#include <fstream>
#include <string_view>

namespace maploc {
namespace {

unsigned Byte(std::string_view bytes, std::size_t i) {
  return static_cast<unsigned char>(bytes[i]);
}

// `size` bytes at `at`, 0 beyond the end.
std::uint32_t Number(std::string_view bytes, std::size_t at, std::size_t size, bool big_endian) {
  if (at > bytes.size() || bytes.size() - at < size) return 0;
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < size; ++i) {
    value = value << 8 | Byte(bytes, at + (big_endian ? i : size - 1 - i));
  }
  return value;
}

// Of an APP1 segment's content: "Exif\0\0", a TIFF header, a directory of 12-byte entries.
int ExifOrientation(std::string_view segment) {
  constexpr std::string_view kMark("Exif\0\0", 6);
  constexpr std::uint32_t kOrientation = 0x0112;
  if (!segment.starts_with(kMark)) return 1;
  const std::string_view tiff = segment.substr(kMark.size());
  const bool big_endian = tiff.starts_with("MM");
  const std::size_t directory = Number(tiff, 4, 4, big_endian);
  const std::uint32_t entries = Number(tiff, directory, 2, big_endian);
  for (std::uint32_t i = 0; i < entries; ++i) {
    const std::size_t entry = directory + 2 + std::size_t{12} * i;
    if (Number(tiff, entry, 2, big_endian) != kOrientation) continue;
    const auto value = static_cast<int>(Number(tiff, entry + 8, 2, big_endian));
    return value >= 1 && value <= 8 ? value : 1;
  }
  return 1;
}

std::string ReadBytes(std::istream& file, std::size_t count) {
  std::string bytes(count, '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(count));
  bytes.resize(static_cast<std::size_t>(file.gcount()));
  return bytes;
}

// C4, C8 and CC lie in the range of frame headers but mean Huffman tables, a reserved code and
// arithmetic coding.
bool IsFrameHeader(unsigned marker) {
  return marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
}

// The marker after an FF; any number of further FF fill the space before it. 0: there is none.
unsigned ReadMarker(std::istream& file) {
  constexpr unsigned kFill = 0xff;
  if (file.get() != int{kFill}) return 0;
  unsigned marker = kFill;
  while (marker == kFill) {
    const int byte = file.get();
    marker = byte == std::istream::traits_type::eof() ? 0 : static_cast<unsigned>(byte);
  }
  return marker;
}

// The segments after the two bytes of the start, up to the frame header.
std::optional<PhotoHeader> ReadJpeg(std::istream& file) {
  constexpr unsigned kApp1 = 0xe1;
  PhotoHeader header;
  while (true) {
    const unsigned marker = ReadMarker(file);
    const std::uint32_t length = Number(ReadBytes(file, 2), 0, 2, true);
    if (marker == 0 || length < 2) return std::nullopt;
    if (!IsFrameHeader(marker) && marker != kApp1) {
      file.seekg(length - 2, std::ios::cur);
      continue;
    }
    const std::string content = ReadBytes(file, length - 2);
    if (marker == kApp1) {
      // A file can have several APP1 segments, and not all of them are EXIF (XMP uses them too).
      if (header.orientation == 1) header.orientation = ExifOrientation(content);
      continue;
    }
    // The frame header begins with one byte of precision.
    header.height_px = static_cast<int>(Number(content, 1, 2, true));
    header.width_px = static_cast<int>(Number(content, 3, 2, true));
    return header;
  }
}

std::string Size(int width_px, int height_px) {
  return std::to_string(width_px) + "x" + std::to_string(height_px);
}

std::string ShownText(const PhotoHeader& header) {
  return "EXIF orientation " + std::to_string(header.orientation) + " shows it as " +
         (header.ShownTurned() ? Size(header.height_px, header.width_px)
                               : Size(header.width_px, header.height_px) + ", turned or mirrored");
}

std::string TurnCure(const std::string& path) {
  return "turn the pixels once with `exiftran -ai " + path + "` (or ImageMagick's -auto-orient)";
}

}  // namespace

// Orientation 6, for example, shows the stored left column at the top, so that down is to the
// right.
Eigen::Vector3d PhotoHeader::ShownDown() const {
  switch (orientation) {
    case 3:
    case 4:
      return {0, -1, 0};
    case 5:
    case 6:
      return {1, 0, 0};
    case 7:
    case 8:
      return {-1, 0, 0};
    default:
      return {0, 1, 0};
  }
}

std::optional<PhotoHeader> ReadPhotoHeader(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string start = ReadBytes(file, 2);
  if (start == "\xff\xd8") return ReadJpeg(file);
  const std::string rest = ReadBytes(file, 22);
  if (start + rest.substr(0, 6) != "\x89PNG\r\n\x1a\n" || rest.size() < 22) return std::nullopt;
  PhotoHeader header;
  // IHDR is a PNG's first chunk: 6 more bytes of the signature, 4 of length and 4 of type come
  // before.
  header.width_px = static_cast<int>(Number(rest, 14, 4, true));
  header.height_px = static_cast<int>(Number(rest, 18, 4, true));
  return header;
}

Status CheckPhotoSize(const std::string& path, int width_px, int height_px, const Camera& camera,
                      const std::string& camera_source) {
  if (width_px == camera.width_px() && height_px == camera.height_px()) return Status::Ok();
  std::string text = "is " + Size(width_px, height_px) + " pixels as stored, but the camera in " +
                     camera_source + " is " + Size(camera.width_px(), camera.height_px());
  const std::optional<PhotoHeader> header = ReadPhotoHeader(path);
  if (header && header->orientation != 1) {
    return InvalidFile(path, text + "; its " + ShownText(*header) +
                                 ", and orientation is ignored (as by COLMAP): give the camera of "
                                 "the stored pixels, or " +
                                 TurnCure(path));
  }
  if (width_px == camera.height_px() && height_px == camera.width_px()) {
    text += " (turned by 90 degrees)";
  }
  return InvalidFile(path,
                     text + "; give this photo's own camera, or a photo of the camera's size");
}

std::string OrientationNote(const std::string& path) {
  const std::optional<PhotoHeader> header = ReadPhotoHeader(path);
  if (!header || header->orientation == 1) return "";
  const Eigen::Vector3d down = header->ShownDown();
  return path + " is " + Size(header->width_px, header->height_px) + " as stored, its " +
         ShownText(*header) +
         "; the stored pixels are used, so camera and gravity must be of those: where it is shown "
         "upright down is about " +
         std::to_string(static_cast<int>(down.x())) + "," +
         std::to_string(static_cast<int>(down.y())) + ",0; or " + TurnCure(path);
}

}  // namespace maploc
