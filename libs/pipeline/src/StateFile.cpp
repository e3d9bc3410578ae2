// SPDX-License-Identifier: BSD-3-Clause
#include "StateFile.h"

#include <dyslam/core/Error.h>
#include <dyslam/core/Files.h>
#include <dyslam/core/PendingFile.h>
#include <libdeflate.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <ostream>

namespace dyslam
{
namespace
{
constexpr std::string_view magic = "DYSLAM STATE 1\n";

struct PartHeader
{
  std::uint64_t size = 0;
  std::uint64_t sum = 0;
};

[[noreturn]] void fail(const std::string& path, const std::string& what)
{
  throw UserError(path + ": " + what + "; the run cannot be resumed from it, start it anew");
}
}  // namespace

std::uint32_t checksum(std::string_view bytes, std::uint32_t sum)
{
  return libdeflate_crc32(sum, bytes.data(), bytes.size());
}

void writeStateFile(const std::string& path, const std::vector<std::string_view>& parts)
{
  writeWhole(path,
             [&](std::ostream& out)
             {
               out << magic;
               for (const std::string_view part : parts)
               {
                 const PartHeader header{part.size(), checksum(part)};
                 out.write(reinterpret_cast<const char*>(&header), sizeof header);
                 out.write(part.data(), static_cast<std::streamsize>(part.size()));
               }
             });
}

std::vector<std::string> readStateFile(const std::string& path, std::size_t parts)
{
  std::ifstream file = openBinary(path);
  std::uint64_t left = std::filesystem::file_size(path);
  const auto read = [&](void* data, std::uint64_t size)
  {
    if (size > left || !file.read(static_cast<char*>(data), static_cast<std::streamsize>(size)))
    {
      requireReadable(file, path);
      fail(path, "is cut short");
    }
    left -= size;
  };
  std::string found(magic.size(), ' ');
  read(found.data(), found.size());
  if (found != magic)
  {
    fail(path, "is no state of a run of this version of DySLAM");
  }
  std::vector<std::string> result(parts);
  for (std::string& part : result)
  {
    PartHeader header;
    read(&header, sizeof header);
    if (header.size > left)
    {
      fail(path, "is cut short");
    }
    part.resize(header.size);
    read(part.data(), part.size());
    if (checksum(part) != header.sum)
    {
      fail(path, "is damaged");
    }
  }
  if (left != 0)
  {
    fail(path, "has more in it than belongs there");
  }
  return result;
}
}  // namespace dyslam
