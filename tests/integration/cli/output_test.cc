// What is printed and does not arrive: a full disk under every command of every binary.
#include <cstdlib>

#include "tests/integration/cli/campus_fixture.h"

namespace maploc::testing {
namespace {

using ::testing::HasSubstr;

class OutputTest : public CampusTest {
 protected:
  // Standard output is a full disk.
  static Output RunFull(const std::string& command) {
    const TemporaryFolder folder;
    const std::string line =
        std::string(MAPLOC_BIN_DIR) + "/" + command + " >/dev/full 2>" + folder.File("error");
    const int status = std::system(line.c_str());
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, "", folder.Read("error")};
  }
  static void ExpectLost(const std::string& command) {
    SCOPED_TRACE(command);
    const Output run = RunFull(command);
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_THAT(run.error, HasSubstr("standard output cannot be written: "));
  }
};

TEST_F(OutputTest, HelpThatDoesNotArriveIsAFailure) {
  ExpectLost("maploc --help");
  for (const char* command : {"localize", "replay", "end-session", "load", "simulate"}) {
    ExpectLost(std::string("maploc ") + command + " --help");
  }
  ExpectLost("maploc-map --help");
  for (const char* command :
       {"import-colmap", "list", "segments", "stats", "strategy", "explain", "robots", "sessions",
        "revoke", "verify", "level", "backup", "restore", "plot"}) {
    ExpectLost(std::string("maploc-map ") + command + " --help");
  }
  ExpectLost("maploc-server --help");
  ExpectLost("maploc-server --version");
}

TEST_F(OutputTest, AReportThatDoesNotArriveIsAFailure) {
  const std::string photo = folder_->File("grey.pgm");
  WriteFile(photo, "P5 64 48 255\n" + std::string(64 * 48, '\x80'));
  WriteFile(folder_->File("camera.txt"), "1 PINHOLE 64 48 50 50 32 24\n");
  const std::string recording =
      " --map campus --colmap " + Campus("model") + " --database " + Campus("database.db") + " ";
  const std::string localize = "maploc localize" + At() + "--map campus --image " + photo +
                               " --camera " + folder_->File("camera.txt");
  ExpectLost(localize);
  ExpectLost(localize + " --json");
  ExpectLost("maploc load" + At() + recording + "--seconds 0.2 --robots 1 --json");
  ExpectLost("maploc simulate --write-world " + folder_->File("world") + " --json");
  ExpectLost("maploc simulate" + At() +
             "--map campus --seasons summer --robots 1 --queries 2 --json");
}

TEST_F(OutputTest, AnOperatorsReportThatDoesNotArriveIsAFailure) {
  ExpectLost("maploc-map list --store " + Store());
  ExpectLost("maploc-map import-colmap --map second --model " + Campus("model") + " --database " +
             Campus("database.db") + " --descriptors orb --lines none --gravity 0,0,-1 --store " +
             folder_->File("other") + " --json");
  ExpectLost("maploc-map level --map campus --store " + Store() + " --gravity 0,0,-1 --json");
  ExpectLost("maploc-map backup --store " + Store() + " --to " + folder_->File("copy") + " --json");
  ExpectLost("maploc-map restore --store " + folder_->File("third") + " --from " +
             folder_->File("copy") + " --json");
  for (const char* command :
       {"list", "segments --map campus", "stats --map campus", "strategy --map campus --segment 0",
        "explain --map campus --segment 0", "robots --map campus", "sessions", "verify"}) {
    ExpectLost("maploc-map " + std::string(command) + " --store " + Store() + " --json");
  }
  ExpectLost("maploc-map plot --map campus --out " + folder_->File("plan.svg") + " --store " +
             Store() + " --json");
}

// The session was counted, so its id must not be lost with the report.
TEST_F(OutputTest, AReplayWhoseReportIsLostTellsItsSession) {
  const Output run = RunFull(Replay() + "--json");
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_THAT(run.error, HasSubstr("session "));
  const std::string id = run.error.substr(run.error.find("session ") + 8, 32);
  EXPECT_THAT(RunBinary("maploc-map sessions --store " + Store() + " --json").out, HasSubstr(id));
  ExpectLost("maploc end-session" + At() + "--session " + id);
  ExpectLost("maploc-map revoke --store " + Store() + " --session " + id + " --json");
}

TEST_F(OutputTest, APictureThatCannotBeWrittenIsAFailure) {
  const std::string photo = folder_->File("grey.pgm");
  WriteFile(photo, "P5 64 48 255\n" + std::string(64 * 48, '\x80'));
  WriteFile(folder_->File("camera.txt"), "1 PINHOLE 64 48 50 50 32 24\n");
  std::filesystem::create_symlink("/dev/full", folder_->File("full.png"));
  for (const auto& [picture, said] : {std::pair("full.png", "could not be written"),
                                      std::pair("no/such.png", "could not be written"),
                                      std::pair("photo", "must end in .png, .jpg"),
                                      std::pair("photo.xyz", "must end in .png, .jpg")}) {
    Output run =
        RunBinary("maploc localize" + At() + "--map campus --image " + photo + " --camera " +
                  folder_->File("camera.txt") + " --draw " + folder_->File(picture));
    EXPECT_THAT(run.out, HasSubstr("in map campus"));  // the answer is not lost with its picture
    run.out.clear();
    ExpectFailed(run, "--draw: ");
    EXPECT_THAT(run.error, HasSubstr(said));
  }
}

// A sensor's 12 bits in 16: the picture that is drawn is the one that features were found in.
TEST_F(OutputTest, APictureOfTwelveBitsIsNotDrawnDark) {
  const std::string photo = folder_->File("twelve.pgm");
  std::string pixels;
  for (int i = 0; i < 64 * 48; ++i) pixels += std::string("\x0f\xff", 2);
  WriteFile(photo, "P5 64 48 65535\n" + pixels);
  WriteFile(folder_->File("camera.txt"), "1 PINHOLE 64 48 50 50 32 24\n");
  const Output run =
      RunBinary("maploc localize" + At() + "--map campus --image " + photo + " --camera " +
                folder_->File("camera.txt") + " --draw " + folder_->File("drawn.ppm"));
  EXPECT_EQ(run.exit_code, 0) << run.error;
  const std::string drawn = folder_->Read("drawn.ppm");
  ASSERT_GT(drawn.size(), 64u * 48u * 3u);
  // The first row, above the caption.
  EXPECT_EQ(drawn.substr(drawn.size() - 64 * 48 * 3, 64 * 3), std::string(64 * 3, '\xff'));
}

}  // namespace
}  // namespace maploc::testing
