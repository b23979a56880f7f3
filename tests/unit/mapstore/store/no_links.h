// A file system without hard links, as vfat and exFAT are. Needs no rights.
#pragma once

namespace maploc::testing {

// While it lives, every link() of this test program fails with EPERM.
class NoLinks {
 public:
  NoLinks();
  ~NoLinks();
  NoLinks(const NoLinks&) = delete;
  NoLinks& operator=(const NoLinks&) = delete;
};

}  // namespace maploc::testing
