// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/io/GzOutput.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <fstream>
#include <iterator>
#include <string>

#include "../src/rawlog/GzInput.h"
#include "TestFolder.h"

namespace dyslam
{
namespace
{
/** Compressible, and of no period that members could hide. */
std::string content(std::size_t size)
{
  std::string text;
  std::uint32_t state = 1;
  while (text.size() < size)
  {
    state = state * 1664525U + 1013904223U;
    text += std::to_string(state >> 22U) + ",";
  }
  text.resize(size);
  return text;
}

std::string bytesOf(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write(const std::string& path, const std::string& text, std::size_t step, int level = 1)
{
  GzOutput file(path, level);
  for (std::size_t i = 0; i < text.size(); i += step)
  {
    file.Write(&text[i], std::min(step, text.size() - i));
  }
  file.close();
}

std::string readByZlib(const std::string& path)
{
  std::string text(8 * GzOutput::member_size, ' ');
  gzFile file = gzopen(path.c_str(), "rb");
  const int got = gzread(file, text.data(), static_cast<unsigned>(text.size()));
  EXPECT_EQ(gzclose_r(file), Z_OK);
  text.resize(got < 0 ? 0 : static_cast<std::size_t>(got));
  return text;
}

/** As far as it can be read. */
std::string readByUs(const std::string& path, std::size_t step, bool* cut = nullptr)
{
  GzInput file(path);
  std::string text;
  std::string part(step, ' ');
  try
  {
    while (!file.atEnd())
    {
      file.Read(part.data(), step);
      text += part;
    }
  }
  catch (const std::runtime_error&)
  {
  }
  if (cut != nullptr)
  {
    *cut = file.cut();
  }
  return text;
}

TEST(GzFiles, AreReadByZlibAndByUs)
{
  const TestFolder folder;
  const std::string path = folder.file("x.gz");
  const std::size_t member = GzOutput::member_size;
  for (const std::size_t size : {std::size_t{0}, std::size_t{1000}, member, 3 * member + 1000})
  {
    const std::string text = content(size);
    write(path, text, 777);
    EXPECT_TRUE(readByZlib(path) == text) << size;
    EXPECT_TRUE(readByUs(path, 1) == text) << size;
  }
}

TEST(GzFiles, BytesDependOnTheContentAlone)
{
  const TestFolder folder;
  const std::string text = content(2 * GzOutput::member_size + 12345);
  write(folder.file("small.gz"), text, 100);
  write(folder.file("large.gz"), text, text.size());
  EXPECT_TRUE(bytesOf(folder.file("small.gz")) == bytesOf(folder.file("large.gz")));
  write(folder.file("stored.gz"), text, text.size(), 0);
  EXPECT_GT(bytesOf(folder.file("stored.gz")).size(), text.size());
  EXPECT_TRUE(readByUs(folder.file("stored.gz"), 1) == text);
}

TEST(GzFiles, AStreamOfOneLargeMemberIsRead)
{
  const TestFolder folder;
  const std::string text = content(3 * GzOutput::member_size);
  gzFile file = gzopen(folder.file("x.gz").c_str(), "wb1");
  gzwrite(file, text.data(), static_cast<unsigned>(text.size()));
  ASSERT_EQ(gzclose_w(file), Z_OK);
  EXPECT_TRUE(readByUs(folder.file("x.gz"), 1024) == text);
}

TEST(GzFiles, ADamagedMemberIsBrokenNotCut)
{
  const TestFolder folder;
  const std::string text = content(3 * GzOutput::member_size);
  write(folder.file("x.gz"), text, text.size());
  std::string bytes = bytesOf(folder.file("x.gz"));
  for (std::size_t i = bytes.size() / 2; i < bytes.size() / 2 + 100; ++i)
  {
    bytes[i] = static_cast<char>(~bytes[i]);
  }
  std::ofstream(folder.file("x.gz"), std::ios::binary) << bytes;
  GzInput file(folder.file("x.gz"));
  std::string read(text.size(), ' ');
  EXPECT_THROW(file.Read(read.data(), read.size()), std::runtime_error);
  EXPECT_TRUE(file.broken());
  EXPECT_FALSE(file.cut());
}

TEST(GzFiles, PlainFilesAreRead)
{
  const TestFolder folder;
  const std::string text = content(2 * GzOutput::member_size);
  std::ofstream(folder.file("x"), std::ios::binary) << text;
  EXPECT_TRUE(readByUs(folder.file("x"), 1024) == text);
}

TEST(GzFiles, OfACutFileAllBeforeTheCutIsRead)
{
  const TestFolder folder;
  const std::string text = content(3 * GzOutput::member_size);
  write(folder.file("x.gz"), text, text.size());
  const std::string whole = bytesOf(folder.file("x.gz"));
  std::ofstream(folder.file("cut.gz"), std::ios::binary) << whole.substr(0, whole.size() / 2);
  bool cut = false;
  const std::string read = readByUs(folder.file("cut.gz"), 1, &cut);
  EXPECT_TRUE(cut);
  EXPECT_GT(read.size(), GzOutput::member_size);
  EXPECT_TRUE(text.compare(0, read.size(), read) == 0);
}

TEST(GzFiles, WhatFollowsTheLastMemberIsPassedOver)
{
  const TestFolder folder;
  const std::string text = content(1000);
  write(folder.file("x.gz"), text, text.size());
  const std::string whole = bytesOf(folder.file("x.gz"));
  for (const std::string& rest : {std::string(), std::string(100000, '\0'),
                                  std::string(3, '\0') + "something else", std::string("\x1f")})
  {
    (void)folder.write("x.gz", whole + rest);
    EXPECT_TRUE(readByUs(folder.file("x.gz"), 1) == text);
    EXPECT_TRUE(readByZlib(folder.file("x.gz")) == text);
    GzInput file(folder.file("x.gz"));
    std::string read(text.size(), ' ');
    (void)file.Read(read.data(), read.size());
    EXPECT_TRUE(file.atEnd());
    const std::size_t zeros = rest.find_first_not_of('\0');
    EXPECT_EQ(file.restAt().has_value(), zeros != std::string::npos);
    EXPECT_EQ(file.restAt().value_or(whole.size() + zeros), whole.size() + zeros);
    EXPECT_EQ(file.whyIncomplete(), file.restAt() ? "the compressed data are damaged" : "");
  }
}

/** Not the end of the file. */
TEST(GzFiles, AMemberWithADamagedHeaderIsFound)
{
  const TestFolder folder;
  const std::string text = content(3 * GzOutput::member_size);
  write(folder.file("first.gz"), text.substr(0, GzOutput::member_size), text.size());
  write(folder.file("x.gz"), text, text.size());
  const std::size_t second = bytesOf(folder.file("first.gz")).size();
  std::string bytes = bytesOf(folder.file("x.gz"));
  bytes[second + 1] = 'x';
  (void)folder.write("x.gz", bytes);
  GzInput file(folder.file("x.gz"));
  std::string read(text.size(), ' ');
  EXPECT_THROW(file.Read(read.data(), read.size()), std::runtime_error);
  EXPECT_EQ(file.restAt(), second);
  EXPECT_TRUE(file.broken());
  EXPECT_FALSE(file.cut());
}
}  // namespace
}  // namespace dyslam
