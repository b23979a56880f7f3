#include "mapstore/store/beside_store.h"

#include <filesystem>

namespace maploc {
namespace {

namespace fs = std::filesystem;

constexpr int kMaxLinks = 40;  // as the kernel

}  // namespace

std::string BesideStore(const std::string& store_path, std::string_view suffix) {
  std::error_code error;
  fs::path path = store_path;
  // weakly_canonical stops at a link to what does not exist yet; SQLite makes the store behind it.
  for (int i = 0; i < kMaxLinks && fs::is_symlink(path, error) && !fs::exists(path, error); ++i) {
    path = path.parent_path() / fs::read_symlink(path, error);
  }
  const fs::path real = fs::weakly_canonical(path, error);
  return (error ? store_path : real.string()) + std::string(suffix);
}

}  // namespace maploc
