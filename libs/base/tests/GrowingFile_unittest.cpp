// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/GrowingFile.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "TestFolder.h"

namespace dyslam
{
TEST(GrowingFile, GrowsUntilItIsClosed)
{
  const TestFolder folder;
  const std::string path = folder.file("a");
  EXPECT_FALSE(isGrowing(path)) << "missing";
  const int writer = createGrowingFile(path);
  const int reader = ::open(path.c_str(), O_RDONLY);
  EXPECT_TRUE(isGrowing(path));
  EXPECT_TRUE(isGrowing(reader));
  EXPECT_TRUE(isGrowing(reader)) << "asking leaves no lock";
  ::close(writer);
  EXPECT_FALSE(isGrowing(path));
  EXPECT_FALSE(isGrowing(reader));
  ::close(reader);
}

TEST(GrowingFile, AnEarlierFileIsReplacedAndStaysForItsReaders)
{
  const TestFolder folder;
  const std::string path = folder.write("a", "earlier");
  const int reader = ::open(path.c_str(), O_RDONLY);
  const int writer = createGrowingFile(path);
  EXPECT_EQ("", folder.read("a"));
  char text[8] = {};
  EXPECT_EQ(7, ::read(reader, text, sizeof text));
  EXPECT_FALSE(isGrowing(reader));
  ::close(writer);
  ::close(reader);
}

TEST(GrowingFile, HasOneWriter)
{
  const TestFolder folder;
  const std::string path = folder.file("a");
  const int writer = createGrowingFile(path);
  EXPECT_EQ(path + ": another program is recording it; stop that one, or choose another --output",
            messageOfError<UserError>([&] { (void)createGrowingFile(path); }));
  EXPECT_TRUE(std::filesystem::exists(path));
  ::close(writer);
  ::close(createGrowingFile(path));
}

TEST(GrowingFile, AFolderOrALinkIsNotWrittenTo)
{
  const TestFolder folder;
  EXPECT_TRUE(contains(messageOfError<UserError>([&] { (void)createGrowingFile(folder.path()); }),
                       "is a folder"));
  folder.write("target", "content");
  std::filesystem::create_symlink(folder.file("target"), folder.file("link"));
  ::close(createGrowingFile(folder.file("link")));
  EXPECT_EQ("content", folder.read("target"));
}

TEST(GrowingFile, DoesNotGrowOnceItsWriterWasKilled)
{
  const TestFolder folder;
  const std::string path = folder.file("a");
  int ready[2] = {};
  ASSERT_EQ(0, ::pipe(ready));
  const pid_t child = ::fork();
  if (child == 0)
  {
    (void)createGrowingFile(path);
    (void)!::write(ready[1], "x", 1);
    for (;;)
    {
      ::pause();
    }
  }
  ::close(ready[1]);  // so that the end of the child ends the wait
  char byte = 0;
  ASSERT_EQ(1, ::read(ready[0], &byte, 1));
  EXPECT_TRUE(isGrowing(path));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_FALSE(isGrowing(path));
  ::close(ready[0]);
}
}  // namespace dyslam
