// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/SwappedStore.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

namespace dyslam
{
namespace
{
namespace fs = std::filesystem;

struct Text
{
  std::string text;
  [[nodiscard]] std::size_t memory() const { return text.size(); }
  [[nodiscard]] std::string toBytes() const { return text; }
  static Text fromBytes(std::string_view bytes) { return {std::string(bytes)}; }
};

/** A folder of the test's own. */
std::string folder()
{
  const std::string path = testing::TempDir() + "swapped_store";
  fs::create_directories(path);
  return path;
}

MemoryLimit limitOf(std::size_t bytes)
{
  MemoryLimit limit;
  limit.file = std::make_shared<SwapFile>(folder());
  limit.bytes = bytes;
  return limit;
}

TEST(SwappedStore, TooFewBytesOfAValueAreAnError)
{
  std::string bytes;
  appendBytes(bytes, std::vector<float>{1, 2, 3});
  for (std::size_t size = 0; size <= bytes.size(); ++size)
  {
    std::string_view left(bytes.data(), size);
    std::vector<float> values;
    if (size < bytes.size())
    {
      EXPECT_THROW(takeBytes(left, values), UserError) << size;
    }
    else
    {
      takeBytes(left, values);
      EXPECT_EQ(values, (std::vector<float>{1, 2, 3}));
    }
  }
}

TEST(SwapFile, SlotsGrowAndTheirRoomIsUsedAgain)
{
  SwapFile file(folder());
  SwapFile::Slot a;
  SwapFile::Slot b;
  ASSERT_TRUE(file.write("one", a));
  ASSERT_TRUE(file.write(std::string(1000, 'b'), b));
  EXPECT_EQ(file.read(a), "one");
  EXPECT_EQ(file.read(b), std::string(1000, 'b'));
  ASSERT_TRUE(file.write(std::string(5000, 'a'), a));  // moves
  EXPECT_EQ(file.read(a), std::string(5000, 'a'));
  EXPECT_EQ(file.read(b), std::string(1000, 'b'));
  const auto size = file.size();
  SwapFile::Slot c;
  ASSERT_TRUE(file.write("where a was", c));
  file.release(b);
  SwapFile::Slot d;
  ASSERT_TRUE(file.write(std::string(1000, 'd'), d));
  EXPECT_EQ(file.size(), size);
  EXPECT_EQ(file.read(d), std::string(1000, 'd'));
  EXPECT_EQ(file.read(c), "where a was");
  EXPECT_TRUE(fs::is_empty(folder())) << "the file must have no name";
}

TEST(SwapFile, FolderThatIsNotThereIsAProblem)
{
  SwapFile file("/no/such/folder");
  SwapFile::Slot slot;
  EXPECT_FALSE(file.write("x", slot));
  EXPECT_NE(file.problem().find("/no/such/folder"), std::string::npos);
  EXPECT_NE(file.problem().find("memory.limit"), std::string::npos);
}

/** Random reads and changes of a store and of a plain vector. */
void expectSameAsInMemory(SwappedStore<Text>& store, std::size_t steps)
{
  std::mt19937 random(7);
  std::vector<std::string> plain;
  for (std::size_t step = 0; step < steps; ++step)
  {
    const std::size_t size = random() % 3000;
    const auto letter = static_cast<char>('a' + random() % 26);
    if (plain.empty() || random() % 4 == 0)
    {
      plain.emplace_back(size, letter);
      ASSERT_EQ(store.add({plain.back()}), plain.size() - 1);
    }
    const std::size_t i = random() % plain.size();
    if (random() % 2 == 0)
    {
      plain[i].resize(size, letter);
      store.edit(i).text.resize(size, letter);
    }
    const std::size_t k = random() % plain.size();
    ASSERT_EQ(store.get(k).text, plain[k]) << step;
  }
  for (std::size_t i = 0; i < plain.size(); ++i)
  {
    ASSERT_EQ(store.get(i).text, plain[i]);
  }
}

TEST(SwappedStore, ValuesDoNotDependOnTheLimit)
{
  for (const std::size_t limit : {std::size_t{1}, std::size_t{20000}})
  {
    SwappedStore<Text> store(limitOf(limit));
    expectSameAsInMemory(store, 3000);
    EXPECT_LE(store.memory(), limit + 4000);
    EXPECT_GT(store.limit().file->size(), 100000U);
  }
  SwappedStore<Text> in_memory;
  expectSameAsInMemory(in_memory, 3000);
}

TEST(SwappedStore, FullDiskKeepsEverythingInMemory)
{
  // A limit of the file's length acts as a full disk, but for the error.
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  rlimit tiny = before;
  tiny.rlim_cur = 100000;
  setrlimit(RLIMIT_FSIZE, &tiny);
  SwappedStore<Text> store(limitOf(20000));
  expectSameAsInMemory(store, 3000);
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  EXPECT_FALSE(store.limit().file->problem().empty());
  EXPECT_GT(store.memory(), 200000U);
}

TEST(SwappedStore, MovesAndClears)
{
  SwappedStore<Text> store(limitOf(1));
  store.add({"a"});
  store.add({"b"});
  SwappedStore<Text> other = std::move(store);
  EXPECT_EQ(other.get(0).text, "a");
  other.clear();
  EXPECT_EQ(other.size(), 0U);
  EXPECT_EQ(other.memory(), 0U);
  EXPECT_EQ(other.add({"c"}), 0U);
  EXPECT_EQ(other.get(0).text, "c");
}
}  // namespace
}  // namespace dyslam
