// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "FullDisk.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

class PendingFiles : public testing::Test
{
 protected:
  void SetUp() override { writeWhole(path("a"), "earlier"); }

  [[nodiscard]] std::string path(const std::string& name) const { return folder_.file(name); }
  [[nodiscard]] std::string content(const std::string& name) const { return folder_.read(name); }

  const TestFolder folder_;
};

TEST_F(PendingFiles, GetTheirNameByCommit)
{
  {
    PendingFile pending(path("a"));
    EXPECT_EQ(path("a.tmp"), pending.temporary());
    std::ofstream(pending.temporary()) << "new";
    EXPECT_EQ("earlier", content("a"));
    pending.commit();
    EXPECT_EQ("new", content("a"));
  }
  EXPECT_EQ("new", content("a"));
  EXPECT_FALSE(fs::exists(path("a.tmp")));
}

TEST_F(PendingFiles, GoWithoutCommit)
{
  {
    const PendingFile pending(path("a"));
    std::ofstream(pending.temporary()) << "half";
  }
  EXPECT_EQ("earlier", content("a"));
  EXPECT_FALSE(fs::exists(path("a.tmp")));
}

TEST_F(PendingFiles, WriteWholeKeepsTheEarlierFileUntilAllIsWritten)
{
  EXPECT_THROW(writeWhole(path("a"),
                          [](std::ostream& out)
                          {
                            out << "half";
                            out.setstate(std::ios::failbit);
                          }),
               UserError);
  EXPECT_EQ("earlier", content("a"));
  EXPECT_FALSE(fs::exists(path("a.tmp")));
  const std::string bytes("\0new\n", 5);
  writeWhole(path("a"), bytes);
  EXPECT_EQ(bytes, content("a"));
}

TEST_F(PendingFiles, AreCutToWhatIsGoodUnderEitherName)
{
  const std::string name = path("b");
  PendingFile pending(name);
  pending.keep();
  std::ofstream(pending.temporary()) << "good and more";
  cutPending(pending, 4);
  EXPECT_EQ("good", content("b.tmp"));
  fs::rename(pending.temporary(), name);
  cutPending(pending, 2);
  EXPECT_EQ("go", content("b.tmp"));
  EXPECT_FALSE(fs::exists(name));
  EXPECT_THROW(cutPending(pending, 3), UserError);
  fs::remove(pending.temporary());
  EXPECT_THROW(cutPending(pending, 1), UserError);
}

TEST_F(PendingFiles, AFullDiskIsAnError)
{
  const test::FullDisk full_disk;
  EXPECT_THROW(writeWhole(path("a"), "few bytes that fail at the close"), UserError);
  EXPECT_EQ("earlier", content("a"));
}

TEST_F(PendingFiles, RefuseWhatCannotBeWritten)
{
  EXPECT_THROW(PendingFile{folder_.path()}, UserError);
  EXPECT_THROW(writeWhole(path("no/such/folder/a"), ""), UserError);
  EXPECT_THROW(PendingFile(path("never written")).commit(), UserError);
}
}  // namespace
}  // namespace dyslam
