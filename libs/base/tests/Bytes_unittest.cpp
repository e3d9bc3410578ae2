// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
namespace
{
TEST(Bytes, OfNumbersAndVectorsAreTheirMemory)
{
  const std::vector<std::uint8_t> numbers{1, 0, 255};
  EXPECT_EQ(bytesOf(numbers), std::string_view("\x01\x00\xff", 3));
  const std::vector<Eigen::Vector3f> points{{0, 0, 1}, {1, 0, 0}};  // 1: 0x3F800000
  std::string expected(24, '\0');
  expected[10] = expected[14] = '\x80';
  expected[11] = expected[15] = '\x3F';
  EXPECT_EQ(bytesOf(points), expected);
  EXPECT_TRUE(bytesOf(std::vector<float>()).empty());
}

TEST(Bytes, ThatWereAppendedAreTaken)
{
  std::string bytes;
  appendBytes(bytes, 7);
  appendBytes(bytes, std::vector<double>{1, 2});
  std::string_view rest = bytes;
  int number = 0;
  std::vector<double> values;
  takeBytes(rest, number);
  takeBytes(rest, values);
  EXPECT_EQ(number, 7);
  EXPECT_EQ(values, (std::vector<double>{1, 2}));
  EXPECT_TRUE(rest.empty());
  EXPECT_THROW(takeBytes(rest, number), UserError);
  std::string_view cut = std::string_view(bytes).substr(sizeof number, sizeof(std::uint64_t) + 8);
  EXPECT_THROW(takeBytes(cut, values), UserError);
}
}  // namespace
}  // namespace dyslam
