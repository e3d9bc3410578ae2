// SPDX-License-Identifier: BSD-3-Clause
#include "KittiBoxes.h"

#include <dyslam/formats/SustechFiles.h>

#include <algorithm>
#include <cstddef>
#include <filesystem>

namespace dyslam
{
namespace fs = std::filesystem;

std::vector<LabelledBox> readBoxFolder(const std::string& folder,
                                       const std::vector<KittiLayout::Entry>& entries)
{
  std::vector<LabelledBox> all;
  for (const KittiLayout::Entry& entry : entries)
  {
    const fs::path file = fs::path(folder) / (fs::path(entry.scan).stem().string() + ".json");
    if (fs::exists(file))
    {
      const auto boxes = readSustechJson(file.string(), static_cast<int>(entry.number));
      all.insert(all.end(), boxes.begin(), boxes.end());
    }
  }
  return all;
}

void assignMissingIds(const std::string& path,
                      std::vector<LabelledBox>& boxes,
                      std::vector<std::string>& warnings)
{
  int last = -1;
  std::size_t without_id = 0;
  for (const LabelledBox& box : boxes)
  {
    last = std::max(last, box.id);
    without_id += box.id < 0 ? 1 : 0;
  }
  if (without_id == 0)
  {
    return;
  }
  warnings.push_back(path + ": " + std::to_string(without_id) + " of " +
                     std::to_string(boxes.size()) +
                     " boxes have no usable obj_id; each gets one of its own, from " +
                     std::to_string(last + 1) + " on");
  for (LabelledBox& box : boxes)
  {
    box.id = box.id < 0 ? ++last : box.id;
  }
}
}  // namespace dyslam
