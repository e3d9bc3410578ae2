// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/PointTimeFiles.h>

#include <cstring>

// All binary formats here are little-endian, as is every machine this is built for.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "a little-endian machine is needed");

namespace dyslam
{
std::vector<float> readPointTimes(const std::string& path, std::size_t expected)
{
  const std::string bytes = readWhole(path);
  if (bytes.size() != expected * sizeof(float))
  {
    throw UserError(path + ": has " + counted(bytes.size(), "byte") + ", but the scan has " +
                    counted(expected, "point") +
                    "; a file has 4 bytes per point: remove the folder if it is of other scans");
  }
  std::vector<float> times(expected);
  if (!times.empty())
  {
    std::memcpy(times.data(), bytes.data(), bytes.size());
  }
  return times;
}

void writePointTimes(const std::string& path, const std::vector<float>& times)
{
  writeWhole(path, bytesOf(times), Durable::no);
}
}  // namespace dyslam
