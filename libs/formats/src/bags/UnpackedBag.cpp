// SPDX-License-Identifier: BSD-3-Clause
#include "UnpackedBag.h"

#include <dyslam/base/Error.h>
#include <dyslam/formats/RecordingKind.h>

#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>

#include "Decompression.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** \param folder for temporary files */
UserError cannotUnpack(const std::string& bag, const std::string& folder, const std::string& reason)
{
  return UserError(
      bag + ": is compressed as a whole and cannot be unpacked to " + folder + ": " + reason +
      "; set TMPDIR to a folder with room, or unpack it first: " + unpackCommand(bag) + " " + bag);
}

std::string gigabytes(std::uint64_t bytes)
{
  char text[32];
  std::snprintf(text, sizeof text, "%.1f GB", 1e-9 * static_cast<double>(bytes));
  return text;
}
}  // namespace

UnpackedBag::Folder::Folder(const std::string& bag)
{
  std::error_code error;
  const fs::path parent = fs::temp_directory_path(error);
  if (error)
  {
    throw cannotUnpack(bag, "the folder for temporary files", error.message());
  }
  path_ = (parent / "dyslam_XXXXXX").string();
  if (::mkdtemp(path_.data()) == nullptr)
  {
    throw cannotUnpack(bag, parent.string(), std::strerror(errno));
  }
}

UnpackedBag::Folder::~Folder()
{
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

UnpackedBag::UnpackedBag(const std::string& path)
    : folder_(path), path_((fs::path(folder_.path()) / fs::path(path).stem()).string())
{
  const std::string parent = fs::path(folder_.path()).parent_path().string();
  std::error_code unknown;
  const fs::space_info space = fs::space(parent, unknown);
  const std::uint64_t size = zstdContentSize(path);
  if (!unknown && size > space.available)
  {
    throw cannotUnpack(path, parent,
                       "it has " + gigabytes(size) + ", there are " + gigabytes(space.available));
  }
  errno = 0;
  std::ofstream file(path_, std::ios::binary);
  unpackZstdFile(path, file);
  file.close();
  if (!file)
  {
    throw cannotUnpack(path, parent, errno != 0 ? std::strerror(errno) : "unknown reason");
  }
}
}  // namespace dyslam
