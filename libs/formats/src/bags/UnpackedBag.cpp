// SPDX-License-Identifier: BSD-3-Clause
#include "UnpackedBag.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RecordingKind.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <system_error>

#include "BagFormats.h"
#include "Decompression.h"

namespace dyslam
{
namespace fs = std::filesystem;

namespace
{
/** \param folder for temporary files */
UserError cannotUnpack(const std::string& bag, const std::string& folder, const std::string& reason)
{
  return UserError(bag + ": is compressed as a whole and cannot be unpacked to " + folder + ": " +
                   reason + "; set TMPDIR to a folder with room, or unpack it first: " +
                   unpackCommand(bag) + " " + shellWord(bag));
}

/** The folder for temporary files. \param bag for the message \throws UserError without one. */
fs::path temporaryFolder(const std::string& bag)
{
  std::error_code error;
  const fs::path folder = fs::temp_directory_path(error);
  if (error)
  {
    throw cannotUnpack(bag, "the folder for temporary files", error.message());
  }
  return folder;
}

std::string gigabytes(std::uint64_t bytes)
{
  return formatted("%.1f GB", 1e-9 * static_cast<double>(bytes));
}
}  // namespace

UnpackedBag::Folder::Folder(const std::string& bag)
{
  const fs::path parent = temporaryFolder(bag);
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

UnpackedBag::UnpackedBag(const std::string& path, const BagUnpackingProgress& progress)
    : folder_(path), path_((fs::path(folder_.path()) / fs::path(path).stem()).string())
{
  const std::string parent = fs::path(folder_.path()).parent_path().string();
  BagUnpacking state{path, folder_.path()};
  const auto report = [&]
  {
    if (progress)
    {
      progress(state);
    }
  };
  report();
  errno = 0;
  std::ofstream file(path_, std::ios::binary);
  unpackZstdFile(path, file,
                 [&](double fraction, std::uint64_t bytes)
                 {
                   state.fraction = fraction;
                   state.bytes = bytes;
                   report();
                 });
  file.close();
  if (!file)
  {
    throw cannotUnpack(path, parent, errno != 0 ? std::strerror(errno) : "unknown reason");
  }
  state.is_done = true;
  report();
}

void requireRoomToUnpack(const std::vector<std::string>& paths)
{
  std::vector<std::string> packed;
  std::copy_if(paths.begin(), paths.end(), std::back_inserter(packed), isZstdBag);
  if (packed.empty())
  {
    return;
  }
  std::uint64_t size = 0;
  for (const std::string& path : packed)
  {
    size += zstdContentSize(path);
  }
  const fs::path folder = temporaryFolder(packed.front());
  std::error_code unknown;
  const fs::space_info space = fs::space(folder, unknown);
  if (!unknown && size > space.available)
  {
    throw cannotUnpack(packed.front(), folder.string(),
                       (packed.size() == 1 ? "it has " : "it and the other parts have ") +
                           gigabytes(size) + ", there are " + gigabytes(space.available));
  }
}
}  // namespace dyslam
