// A folder whose disk a test can make fail under a running server, and put right again.
#pragma once

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/mount.h>
#include <unistd.h>

#include "tests/support/files.h"

namespace maploc::testing {

class FailingDisk {
 public:
  explicit FailingDisk(std::string folder) : folder_(std::move(folder)) {
    std::filesystem::create_directory(folder_);
  }
  virtual ~FailingDisk() = default;
  // "": it is there. Else why this machine does not have it.
  virtual std::string Missing() const { return ""; }
  virtual void Fail() = 0;
  virtual void PutRight() = 0;
  const std::string& folder() const { return folder_; }

 private:
  const std::string folder_;
};

// A file system of a few megabytes, which a file of the test's own fills. Needs the right to mount.
class SmallDisk final : public FailingDisk {
 public:
  explicit SmallDisk(const std::string& path) : FailingDisk(path) {
    const bool mounted = mount("tmpfs", path.c_str(), "tmpfs", 0, "size=8m") == 0;
    if (!mounted) missing_ = std::string("no tmpfs can be mounted: ") + std::strerror(errno);
  }
  ~SmallDisk() override {
    if (missing_.empty()) umount2(folder().c_str(), MNT_DETACH);
  }
  std::string Missing() const override { return missing_; }
  void Fail() override {
    const std::vector<char> bytes(4096, 'x');
    const int file = open(Filler().c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    while (write(file, bytes.data(), bytes.size()) > 0) {
    }
    close(file);
  }
  void PutRight() override { std::filesystem::remove(Filler()); }

 private:
  std::string Filler() const { return folder() + "/filler"; }
  std::string missing_;
};

// Of a process that starts while this lives every change to the folder fails with `error`
// (faulty_disk.cc). Needs no rights.
class PretendedDisk final : public FailingDisk {
 public:
  PretendedDisk(const std::string& path, int error) : FailingDisk(path), error_(error) {
    setenv("LD_PRELOAD", MAPLOC_BIN_DIR "/libfaulty_disk.so", 1);
    setenv("MAPLOC_FAULTY_FOLDER", path.c_str(), 1);
  }
  ~PretendedDisk() override {
    unsetenv("LD_PRELOAD");
    unsetenv("MAPLOC_FAULTY_FOLDER");
  }
  // At once whole, so that nobody reads half a number.
  void Fail() override {
    WriteFile(Switch() + ".new", std::to_string(error_));
    std::filesystem::rename(Switch() + ".new", Switch());
  }
  void PutRight() override { std::filesystem::remove(Switch()); }

 private:
  std::string Switch() const { return folder() + ".errno"; }
  const int error_;
};

}  // namespace maploc::testing
