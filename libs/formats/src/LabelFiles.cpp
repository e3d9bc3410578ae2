// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/LabelFiles.h>

#include <algorithm>
#include <cstring>
#include <filesystem>

// All binary formats here are little-endian, as is every machine this is built for.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "a little-endian machine is needed");

namespace dyslam
{
namespace fs = std::filesystem;

std::vector<Label> readLabels(const std::string& path)
{
  const std::string bytes = readWhole(path);
  if (bytes.size() % sizeof(Label) != 0)
  {
    throw UserError(path + ": " + std::to_string(bytes.size()) +
                    " bytes are not whole 4-byte labels; the file is cut short or no .label");
  }
  std::vector<Label> labels(bytes.size() / sizeof(Label));
  if (!labels.empty())
  {
    std::memcpy(labels.data(), bytes.data(), bytes.size());
  }
  return labels;
}

std::vector<Label> readLabels(const std::string& path, std::size_t expected)
{
  auto labels = readLabels(path);
  if (labels.size() != expected)
  {
    throw UserError(path + ": has " + counted(labels.size(), "label") + ", but the scan has " +
                    counted(expected, "point") + "; are both of one recording?");
  }
  return labels;
}

void writeLabels(const std::string& path, const std::vector<Label>& labels)
{
  writeWhole(path, bytesOf(labels), Durable::no);
}

std::optional<std::string> labelFolderOf(const std::string& folder)
{
  if (folder.empty())
  {
    return std::nullopt;
  }
  for (const fs::path& path : {fs::path(folder) / "labels", fs::path(folder)})
  {
    if (!isFolder(path))
    {
      continue;
    }
    const auto entries = entriesOf(path);
    if (std::any_of(entries.begin(), entries.end(),
                    [](const auto& entry) { return entry.path().extension() == ".label"; }))
    {
      return path.string();
    }
  }
  return std::nullopt;
}
}  // namespace dyslam
