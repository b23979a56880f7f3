// Damaged files through the binary itself: exit code 1, one line that names the file and the place
// in it, and a store that is as it was, byte by byte.
#include <filesystem>

#include "tests/contract/store/store_fixture.h"
#include "tests/integration/tools/facade_model.h"
#include "tests/support/run_binary.h"
#include "tests/support/seed.h"

namespace maploc::testing {
namespace {

class BadFiles : public ::testing::Test {
 protected:
  BadFiles() {
    Random random = TestRandom();
    const FacadeModel facade = MakeFacade(random);
    std::filesystem::create_directory(binary_);
    WriteBinaryModel(binary_, facade.model);
    EXPECT_TRUE(WriteColmapModel(text_, facade.model).ok());
    EXPECT_TRUE(WriteColmapDatabase(database_, facade.model, facade.features).ok());
    GiveMap(**OpenSqliteStore(store_));
  }
  Output Run(const std::string& arguments) { return RunBinary("maploc-map " + arguments); }
  Output Import(const std::string& model) {
    return Run("import-colmap --map facade --gravity 0,0,-1 --scale 1 --store " + store_ +
               " --model " + model + " --database " + database_);
  }
  void ExpectImportRefused(const std::string& model, const std::string& cause) {
    const std::string before = ReadFile(store_);
    ExpectFailed(Import(model), cause);
    EXPECT_TRUE(ReadFile(store_) == before);
    EXPECT_FALSE(std::filesystem::exists(store_ + "-wal"));
  }
  // Every command that opens a store, the one that writes included.
  void ExpectStoreRefused(const std::string& cause) {
    const std::string before = ReadFile(store_);
    for (const std::string command :
         {"list", "verify", "strategy --map yard --segment 0 --pin 2p"}) {
      ExpectFailed(Run(command + " --store " + store_), store_ + cause);
    }
    ExpectFailed(Import(binary_), store_ + cause);
    EXPECT_TRUE(ReadFile(store_) == before);
  }

  const TemporaryFolder folder_;
  const std::string store_ = folder_.File("store.db");
  const std::string binary_ = folder_.File("binary");
  const std::string text_ = folder_.File("text");
  const std::string database_ = folder_.File("database.db");
};

TEST_F(BadFiles, PhotosThatAreNotTheModelsAreToldWithTheCure) {
  const std::string import = "import-colmap --map facade --store " + store_ + " --model " + text_ +
                             " --database " + database_ + " --images " + folder_.path();
  ExpectFailed(Run(import), "img0.jpg: is not there, or may not be read; --images is the folder");
  WriteFile(folder_.File("img0.jpg"), "P5 4 3 255\n" + std::string(12, '\x80'));
  ExpectFailed(Run(import), "has 1000x800; give the photos that the model was made of");
}

// Each thread of the import comes upon such a name.
TEST_F(BadFiles, NamesThatNoFileCanHaveAreToldLikeMissingPhotos) {
  const std::string too_long(300, 'x');
  std::string images = ReadFile(text_ + "/images.txt");
  for (std::size_t at = 0; (at = images.find("img", at)) != std::string::npos;) {
    images.replace(at, 3, too_long);
    at += too_long.size();
  }
  WriteFile(text_ + "/images.txt", images);
  ExpectFailed(
      Run("import-colmap --map facade --descriptors sift_root_u8 --gravity 0,0,-1 --store " +
          store_ + " --model " + text_ + " --images " + folder_.path()),
      "x0.jpg: is not there, or may not be read");
}

// The map "yard" of this store has lines.
TEST_F(BadFiles, AVersionWithoutTheLinesOfTheOneBeforeIsRemarked) {
  const Output run = Run("import-colmap --map yard --gravity 0,0,-1 --scale 1 --store " + store_ +
                         " --model " + text_ + " --database " + database_);
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.error, ::testing::HasSubstr("note: the new version has no lines, but version 1"));
}

// Else the refusals below would say nothing.
TEST_F(BadFiles, WholeOnesAreTaken) {
  for (const std::string& model : {binary_, text_}) {
    const Output run = Import(model);
    EXPECT_EQ(run.exit_code, 0) << run.error;
  }
  EXPECT_THAT(Run("list --store " + store_).out, ::testing::HasSubstr("facade"));
}

TEST_F(BadFiles, ATruncatedBinaryModelIsNamedWithItsByte) {
  for (const std::string part : {"cameras.bin", "images.bin", "points3D.bin"}) {
    const std::string path = binary_ + "/" + part;
    const std::string whole = ReadFile(path);
    for (const std::size_t size : {std::size_t{0}, whole.size() / 2, whole.size() - 1}) {
      WriteFile(path, whole.substr(0, size));
      ExpectImportRefused(binary_, path + ": byte ");
    }
    WriteFile(path, whole);
  }
}

TEST_F(BadFiles, ATruncatedDatabaseIsNamed) {
  const std::string whole = ReadFile(database_);
  for (const std::size_t size : {std::size_t{0}, whole.size() / 2, whole.size() - 4096}) {
    WriteFile(database_, whole.substr(0, size));
    ExpectImportRefused(binary_, database_ + ": is ");
  }
}

TEST_F(BadFiles, ABrokenLineOfATextModelIsNamedWithItsNumber) {
  for (const std::string part : {"cameras.txt", "images.txt", "points3D.txt"}) {
    const std::string path = text_ + "/" + part;
    const std::string whole = ReadFile(path);
    WriteFile(path, whole + "9 what is this\n");
    const auto lines = std::count(whole.begin(), whole.end(), '\n');
    ExpectImportRefused(text_, path + ":" + std::to_string(lines + 1) + ": ");
    WriteFile(path, whole);
  }
}

TEST_F(BadFiles, AStoreThatIsNotSqliteIsRefused) {
  WriteFile(store_, "# notes\nbuy milk\n");
  ExpectStoreRefused(": is not a maploc store");
}

TEST_F(BadFiles, AnotherApplicationsDatabaseIsNoStore) {
  WriteFile(store_, ReadFile(database_));
  ExpectStoreRefused(": is not a maploc store");
}

TEST_F(BadFiles, ATruncatedStoreIsRefused) {
  WriteFile(store_, ReadFile(store_).substr(0, 3 * 4096));
  ExpectStoreRefused(": the store is truncated or damaged");
}

// SQLite itself takes an empty name for a temporary database: the import would be gone.
TEST_F(BadFiles, AnEmptyStoreNameIsRefused) {
  const std::string flags =
      " --map facade --gravity 0,0,-1 --scale 1 --model " + binary_ + " --database " + database_;
  ExpectFailed(Run("import-colmap --store ''" + flags), "store: the name is empty");
  ExpectFailed(Run("list --store ''"), "store: the name is empty");
}

TEST_F(BadFiles, ANameThatNoFileSystemTakesIsAFailureAndNotACrash) {
  const std::string name(5000, 'n');
  ExpectImportRefused(name, name);
  ExpectFailed(Run("import-colmap --map m --model " + binary_ + " --store " + name), name);
}

// Half of an unfinished change would become a map, and nobody would know.
TEST_F(BadFiles, ADatabaseWithAJournalBesideItIsRefused) {
  WriteFile(database_ + "-journal", "\xd9\xd5\x05\xf9\x20\xa1\x63\xd7 pages as they were");
  ExpectImportRefused(binary_, database_ + ": has a rollback journal beside it");
}

TEST_F(BadFiles, WhichOfTwoFormsWasReadIsTold) {
  for (const char* part : {"cameras.txt", "images.txt", "points3D.txt"}) {
    std::filesystem::copy_file(text_ + "/" + part, binary_ + "/" + part);
  }
  const Output run = Import(binary_ + " --json");
  EXPECT_EQ(run.exit_code, 0) << run.error;
  EXPECT_THAT(run.error, ::testing::HasSubstr("note: " + binary_ + ": the model's .bin files"));
  EXPECT_THAT(run.out, ::testing::HasSubstr("\"notices\": ["));
  WriteFile(binary_ + "/points3D.txt", "1 0 0 0 0 0 0 0\n");
  ExpectImportRefused(binary_, binary_ + ": holds the model twice");
}

TEST_F(BadFiles, AMapNameThatIsNoTextIsRefused) {
  ExpectFailed(Run("import-colmap --map 'Stra\xDF' --model " + binary_ + " --database " +
                   database_ + " --store " + store_),
               "map name: is not UTF-8 at byte 4");
}

}  // namespace
}  // namespace maploc::testing
