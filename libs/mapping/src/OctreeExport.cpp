// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/Error.h>
#include <dyslam/core/PendingFile.h>
#include <dyslam/mapping/MapExport.h>
#include <octomap/OcTree.h>

#include <filesystem>

namespace dyslam
{
void writeOctomap(const StaticMap& map,
                  const std::string& path,
                  const MapExportOptions& options,
                  const std::function<void(std::size_t)>& on_keyframe)
{
  validate(options, "map_export");
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending != ".bt" && ending != ".ot")
  {
    throw UserError(path + ": octomap's files end in .bt (binary) or .ot (full)");
  }
  octomap::OcTree tree(options.octree_resolution);
  map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        const Pose& T = map.poses()[k];
        if (on_keyframe)
        {
          on_keyframe(k + 1);
        }
        if (cloud.size() == 0)
        {
          return;
        }
        octomap::Pointcloud points;
        points.reserve(cloud.size());
        for (const auto& p : cloud.points)
        {
          const Eigen::Vector3f q = (T * p.cast<double>()).cast<float>();
          points.push_back(q.x(), q.y(), q.z());
        }
        const Eigen::Vector3f s = (T * map.keyframes()[k].sensor.cast<double>()).cast<float>();
        constexpr bool lazy = true;
        constexpr bool once_per_leaf = true;
        tree.insertPointCloud(points, {s.x(), s.y(), s.z()}, options.octree_range, lazy,
                              once_per_leaf);
      });
  tree.updateInnerOccupancy();
  writeWhole(path,
             [&](std::ostream& out)
             {
               // An empty tree has no binary form other than its header.
               const bool good = ending == ".bt" ? tree.writeBinary(out) : tree.write(out);
               if (!good)
               {
                 out.setstate(std::ios::failbit);
               }
             });
}
}  // namespace dyslam
