#include "support/text_file.h"

#include "support/output_error.h"
#include "tests/support/full_disk.h"
#include "tests/support/refusal.h"

namespace lcpbench {
namespace {

namespace fs = std::filesystem;

class TextFile : public FolderTest {
 protected:
  std::ptrdiff_t Files() const { return std::distance(fs::directory_iterator(folder_), {}); }
};

TEST_F(TextFile, TakesItsPlaceWhenItIsClosedAndNotBefore) {
  Write("x", "old");
  {
    TextOutput file(Path("x"));
    file.Write("new");
    EXPECT_EQ(Bytes("x"), "old");
    file.Close();
    EXPECT_EQ(Bytes("x"), "new");
  }
  {
    TextOutput file(Path("x"));
    file.Write("newer");
  }
  EXPECT_EQ(Bytes("x"), "new");
  EXPECT_EQ(Files(), 1);
}

TEST_F(TextFile, AFullDiskLeavesTheOldFileAloneAndSaysWhy) {
  Write("x", "old");
  const std::string text(100000, 'a');
  for (const rlim_t bytes : {rlim_t{0}, rlim_t{1}, rlim_t{70000}, rlim_t{99999}}) {
    std::string told;
    try {
      const FullDisk full(bytes);
      WriteTextFile(Path("x"), text);
    } catch (const OutputError& error) {
      told = error.what();
    }
    EXPECT_EQ(told, Path("x") + ": writing failed: File too large");
    EXPECT_EQ(Bytes("x"), "old");
    EXPECT_EQ(Files(), 1);
  }
  EXPECT_THROW(WriteTextFile("/dev/full", "text"), OutputError);
}

TEST_F(TextFile, KeepsPermissionsAndFollowsSymbolicLinks) {
  Write("x", "old");
  fs::permissions(Path("x"), fs::perms::owner_read | fs::perms::owner_write);
  fs::create_directory(folder_ / "there");
  fs::create_symlink("../x", folder_ / "there" / "link");
  fs::create_symlink("absent", folder_ / "there" / "dangling");
  WriteTextFile(Path("there/link"), "new");
  WriteTextFile(Path("there/dangling"), "made");
  EXPECT_TRUE(fs::is_symlink(folder_ / "there" / "link"));
  EXPECT_TRUE(fs::is_symlink(folder_ / "there" / "dangling"));
  EXPECT_EQ(Bytes("x"), "new");
  EXPECT_EQ(Bytes("there/absent"), "made");
  EXPECT_EQ(fs::status(Path("x")).permissions(), fs::perms::owner_read | fs::perms::owner_write);
  // A new file has those of any new one.
  Write("usual", "");
  EXPECT_EQ(fs::status(Path("there/absent")).permissions(), fs::status(Path("usual")).permissions());
}

TEST_F(TextFile, WhatCannotBeCreatedIsTheUsersMistake) {
  fs::create_symlink("loop", folder_ / "loop");
  ExpectRefused([&] { WriteTextFile(Path("none/x"), ""); }, "cannot be written: No such file or directory");
  ExpectRefused([&] { WriteTextFile(Path("loop"), ""); }, "cannot be written: Too many levels");
  ExpectRefused([&] { WriteTextFile(folder_.string(), ""); }, "cannot be written: Is a directory");
}

}  // namespace
}  // namespace lcpbench
