// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/formats/LabelFiles.h>
#include <dyslam/formats/TextFile.h>

#include <cstring>
#include <filesystem>
#include <system_error>

// All binary formats here are little-endian, as is every machine this is built for.
static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "a little-endian machine is needed");

namespace dyslam
{
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
    throw UserError(path + ": has " + std::to_string(labels.size()) + " labels, but the scan has " +
                    std::to_string(expected) + " points");
  }
  return labels;
}

void writeLabels(const std::string& path, const std::vector<Label>& labels)
{
  writeWhole(
      path,
      std::string_view(reinterpret_cast<const char*>(labels.data()), labels.size() * sizeof(Label)),
      Durable::no);
}

std::string anyLabelFile(const std::string& folder)
{
  if (folder.empty())
  {
    return "";
  }
  for (const std::filesystem::path& labels :
       {std::filesystem::path(folder) / "labels", std::filesystem::path(folder)})
  {
    std::error_code ignored;
    for (std::filesystem::directory_iterator file(labels, ignored), end; file != end;
         file.increment(ignored))
    {
      if (file->path().extension() == ".label")
      {
        return file->path().string();
      }
    }
  }
  return "";
}
}  // namespace dyslam
