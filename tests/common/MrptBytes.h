// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <mrpt/serialization/CArchive.h>

#include <cstddef>
#include <string>

namespace dyslam::test
{
/** The bytes that MRPT writes for an object. */
inline std::string bytesOf(const mrpt::serialization::CSerializable& object)
{
  struct Bytes
  {
    std::size_t Write(const void* buffer, std::size_t count)
    {
      text.append(static_cast<const char*>(buffer), count);
      return count;
    }
    static std::size_t Read(void*, std::size_t) { return 0; }
    static std::string getStreamDescription() { return ""; }
    std::string text;
  };
  Bytes bytes;
  auto archive = mrpt::serialization::archiveFrom(bytes);
  archive << object;
  return bytes.text;
}
}  // namespace dyslam::test
