// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/mapexport/MapExport.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include "RayCells.h"

namespace dyslam
{
namespace
{
octomap::point3d toOctomap(const Eigen::Vector3d& p)
{
  const Eigen::Vector3f q = p.cast<float>();
  return {q.x(), q.y(), q.z()};
}

/** octomap counts cells by 16 bits, half of them on each side of the origin. \throws UserError for
 * a map that reaches beyond, where octomap would leave the points out. */
void requireWithinKeys(const StaticMap& map,
                       const std::string& path,
                       const MapExportOptions& options)
{
  constexpr double cells = 32768;
  double farthest = 0;
  map.forEachPart(
      [&](const MapPoints& part)
      {
        for (const auto& p : part.points)
        {
          farthest = std::max(farthest, static_cast<double>(p.cwiseAbs().maxCoeff()));
        }
      });
  for (const Pose& pose : map.poses())
  {
    farthest = pose.matrix().allFinite()
                   ? std::max(farthest, pose.translation().cwiseAbs().maxCoeff())
                   : farthest;
  }
  const double margin = 2 * options.octree_resolution;
  if (farthest + margin < cells * options.octree_resolution)
  {
    return;
  }
  double enough = options.octree_resolution;
  while (farthest + 2 * enough >= cells * enough)
  {
    enough *= 2;
  }
  const std::string text = formatted(
      ": the map reaches %.0f m from its origin, but octomap's 16-bit keys reach %.0f m "
      "at map_export.octree_resolution=%g; take %g, or parts of the recording "
      "(--skip-first-n, --only-first-n)",
      farthest, cells * options.octree_resolution, options.octree_resolution, enough);
  throw UserError(path + text);
}

/** Calls `use(lidar, point)` for the points of a keyframe, in the map frame. */
template <typename Use>
void forEachPoint(const StaticMap& map, std::size_t k, const KeyframeCloud& cloud, const Use& use)
{
  for (std::size_t i = 0; i < cloud.size(); ++i)
  {
    use(cloud.lidarOf(i), toOctomap(map.poses()[k] * cloud.points[i].cast<double>()));
  }
}

/** Cells of the tree with a point of the map. */
CellSet staticCells(const StaticMap& map, const octomap::OcTree& tree)
{
  CellSet cells;
  map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        forEachPoint(map, k, cloud,
                     [&](std::size_t, const octomap::point3d& point)
                     { cells.insert(tree.coordToKey(point)); });
      });
  return cells;
}

/** octomap's insertPointCloud() with one ray per cell, with a faster set of cells. The rays of
 * several lidars are one scan: a cell that one of them hits is occupied. Cells with a point of the
 * map are not cleared: rays that graze a surface or pass beside a post would outvote the hits,
 * which the map stores up to `points_per_voxel` times only. */
class ScanInserter
{
 public:
  /** \param area of which the cells are inserted \param is_static cells that no ray clears */
  ScanInserter(octomap::OcTree& tree, double range, const MapRegion& area, CellSet is_static)
      : tree_(tree), range_(range), area_(area), static_(std::move(is_static))
  {
  }

  /** Adds the rays of one lidar to the scan. */
  void addRays(const std::vector<octomap::point3d>& points, const octomap::point3d& sensor)
  {
    ends_.clear();
    for (const octomap::point3d& point : points)
    {
      const octomap::OcTreeKey end = tree_.coordToKey(point);
      if (ends_.insert(end))
      {
        castRay(sensor, end);
      }
    }
  }

  /** Inserts the scan and begins the next one. */
  void insert()
  {
    free_.forEach(
        [&](const octomap::OcTreeKey& key)
        {
          if (isInArea(key) && !static_.contains(key))
          {
            tree_.updateNode(key, false, lazy);
          }
        });
    for (const octomap::OcTreeKey& key : occupied_)
    {
      if (isInArea(key))
      {
        tree_.updateNode(key, true, lazy);
      }
    }
    free_.clear();
    hit_.clear();
    occupied_.clear();
  }

 private:
  static constexpr bool lazy = true;

  [[nodiscard]] bool isInArea(const octomap::OcTreeKey& key) const
  {
    return area_.isWhole() ||
           area_.contains({tree_.keyToCoord(key[0]), tree_.keyToCoord(key[1]), 0});
  }

  /** Whether a ray may have cells in the area; false only if it has none. */
  [[nodiscard]] bool mayCross(const octomap::point3d& from, const octomap::point3d& to) const
  {
    const Eigen::Array2d a(from.x(), from.y());
    const Eigen::Array2d b(to.x(), to.y());
    const double cell = tree_.getResolution();
    return (a.min(b) <= area_.high.array() + cell).all() &&
           (a.max(b) >= area_.low.array() - cell).all();
  }

  /** Of a ray that is too long, the part within range is free. */
  void castRay(const octomap::point3d& sensor, const octomap::OcTreeKey& end)
  {
    octomap::point3d to = tree_.keyToCoord(end);
    if ((to - sensor).norm() <= range_)
    {
      if (hit_.insert(end))
      {
        occupied_.push_back(end);
      }
    }
    else
    {
      to = sensor + (to - sensor).normalized() * static_cast<float>(range_);
    }
    if (mayCross(sensor, to) && tree_.computeRayKeys(sensor, to, ray_))
    {
      for (const octomap::OcTreeKey& key : ray_)
      {
        free_.insert(key);
      }
    }
  }

  octomap::OcTree& tree_;
  double range_;
  MapRegion area_;
  CellSet static_;
  CellSet free_;
  CellSet ends_;  //!< of the lidar's rays
  CellSet hit_;
  std::vector<octomap::OcTreeKey> occupied_;  //!< hit_, in the order of the points
  octomap::KeyRay ray_;
};

/** What OcTree::writeBinary() writes; that prints " done." on stderr. */
void writeBinaryTree(octomap::OcTree& tree, std::ostream& out)
{
  tree.toMaxLikelihood();
  tree.prune();
  out << "# Octomap OcTree binary file\n"
         "# (feel free to add / change comments, but leave the first line as it is!)\n#\n"
      << "id " << tree.getTreeType() << "\nsize " << tree.size() << "\nres " << tree.getResolution()
      << "\ndata\n";
  tree.writeBinaryData(out);
}
}  // namespace

void writeOctomap(const StaticMap& map,
                  const std::string& path,
                  const MapExportOptions& options,
                  const Eigen::Vector3d& origin,
                  const MapProgress& on_keyframe)
{
  validate(options, "map_export");
  const std::string ending = std::filesystem::path(path).extension().string();
  if (ending != ".bt" && ending != ".ot")
  {
    throw UserError(path + ": octomap's files end in .bt (binary) or .ot (full)");
  }
  requireWithinKeys(map, path, options);
  octomap::OcTree tree(options.octree_resolution);
  ScanInserter inserter(tree, options.octree_range, areaOf(options, origin),
                        staticCells(map, tree));
  map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        const Pose& T = map.poses()[k];
        std::vector<std::vector<octomap::point3d>> points(1);  // by lidar
        forEachPoint(map, k, cloud,
                     [&](std::size_t lidar, const octomap::point3d& point)
                     {
                       points.resize(std::max(points.size(), lidar + 1));
                       points[lidar].push_back(point);
                     });
        for (std::size_t lidar = 0; lidar < points.size(); ++lidar)
        {
          const Eigen::Vector3f& sensor = map.keyframes()[k].sensorOf(lidar);
          if (!points[lidar].empty())
          {
            inserter.addRays(points[lidar], toOctomap(T * sensor.cast<double>()));
          }
        }
        inserter.insert();
        if (on_keyframe)
        {
          on_keyframe(k + 1);
        }
      });
  tree.updateInnerOccupancy();
  writeWhole(path,
             [&](std::ostream& out)
             {
               if (ending == ".bt")
               {
                 writeBinaryTree(tree, out);
               }
               else if (!tree.write(out))
               {
                 out.setstate(std::ios::failbit);
               }
             });
}
}  // namespace dyslam
