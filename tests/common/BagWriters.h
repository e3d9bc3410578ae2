// SPDX-License-Identifier: BSD-3-Clause
// Writers of small ROS bags, for tests. They know nothing of the readers.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace dyslam::test
{
struct TestMessage
{
  std::string topic;
  std::string type;  //!< as ROS 1 writes it
  double stamp = 0;  //!< of the recording [s]
  std::string data;
};

struct BagStyle
{
  std::string compression = "none";  //!< of chunks: none, bz2, lz4 or zstd
  std::size_t messages_per_chunk = 3;
  bool index = true;   //!< message indexes, and definitions at the end
  bool chunks = true;  //!< mcap: false puts messages outside of chunks
  bool closed = true;  //!< false: as a recorder that was killed leaves it
};

void writeRos1Bag(const std::string& path,
                  const std::vector<TestMessage>& messages,
                  const BagStyle& style = {});
/** \param encoding of the messages: cdr or ros1. */
void writeMcap(const std::string& path,
               const std::vector<TestMessage>& messages,
               const BagStyle& style = {},
               const std::string& encoding = "cdr");
/** \param packed messages are compressed one by one with zstd. */
void writeSqliteBag(const std::string& path,
                    const std::vector<TestMessage>& messages,
                    bool packed = false);
/** Compressed with zstd. */
[[nodiscard]] std::string zstdOf(const std::string& data);
/** By the ending of the path; CDR for .db3 and .mcap. */
void writeBag(const std::string& path, const std::vector<TestMessage>& messages);
/** True for the files whose messages are CDR. */
[[nodiscard]] bool holdsCdr(const std::string& path);
}  // namespace dyslam::test
