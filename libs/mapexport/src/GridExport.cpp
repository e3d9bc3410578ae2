// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/PendingFile.h>
#include <dyslam/base/Printable.h>
#include <dyslam/io/GzOutput.h>
#include <dyslam/mapexport/MapExport.h>
#include <mrpt/maps/COccupancyGridMap2D.h>
#include <mrpt/serialization/CArchive.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "GridGround.h"
#include "GridObstacles.h"
#include "OccupancyCells.h"
#include "YamlText.h"

namespace dyslam
{
namespace
{
const std::string image_key = "image: ";

constexpr int azimuth_bins = 1440;
constexpr double ray_range = 40.0;    // farther returns do not clear cells [m]
constexpr double longest_side = 1e6;  // of a picture that libpng writes [pixels]

using Grid = OccupancyCells;

/** Sets the origin of a grid from `low` to `high`. \return its columns and rows */
Eigen::Vector2d fitGrid(const Eigen::Vector2d& low, const Eigen::Vector2d& high, Grid& grid)
{
  grid.origin = (low / grid.resolution).array().floor() * grid.resolution;
  Eigen::Vector2d size;
  for (const int axis : {0, 1})
  {
    if (grid.numberOf(low[axis], axis) < 0)  // the origin was rounded up
    {
      grid.origin[axis] -= grid.resolution;
    }
    size[axis] = grid.numberOf(high[axis], axis) + 1;
  }
  return size;
}

/** The least region with all points, its upper borders included. \pre there are points */
MapRegion regionOf(const MapPoints& map)
{
  MapRegion region;
  std::swap(region.low, region.high);
  for (const auto& p : map.points)
  {
    const Eigen::Vector2d q = p.head<2>().cast<double>();
    region.low = region.low.cwiseMin(q);
    region.high = region.high.cwiseMax(q);
  }
  return region;
}

/** A grid of unknown cells for the points, or for the area of the options. */
Grid emptyGrid(const MapPoints& map, const MapExportOptions& options, const Eigen::Vector3d& origin)
{
  Grid grid;
  grid.resolution = options.grid_resolution;
  if (map.size() == 0 && options.area.empty())
  {
    grid.cells = cv::Mat(1, 1, CV_8U, cv::Scalar(Grid::unknown));
    return grid;
  }
  const MapRegion region = options.area.empty() ? regionOf(map) : areaOf(options, origin);
  // Borders of an area are mostly those of cells, up to rounding.
  const double inwards = options.area.empty() ? 0 : 1e-6 * grid.resolution;
  const Eigen::Vector2d low = region.low.array() + inwards;
  const Eigen::Vector2d high = region.high.array() - inwards;
  Eigen::Vector2d size = fitGrid(low, high, grid);
  while (size.x() * size.y() > options.grid_max_cells || size.maxCoeff() > longest_side)
  {
    grid.resolution *= 2;
    size = fitGrid(low, high, grid);
  }
  grid.cells = cv::Mat(static_cast<int>(size.y()), static_cast<int>(size.x()), CV_8U,
                       cv::Scalar(Grid::unknown));
  return grid;
}

/** Marks the cells from a to b (b excluded) as free. */
void clearRay(Grid& grid, const Eigen::Vector2d& a, const Eigen::Vector2d& b)
{
  const double length = (b - a).norm();
  const int steps = static_cast<int>(length / (0.5 * grid.resolution));
  for (int i = 0; i < steps; ++i)
  {
    const Eigen::Vector2d p = a + (b - a) * (static_cast<double>(i) / steps);
    const cv::Point cell = grid.cellOf(p.x(), p.y());
    grid.set(cell, Grid::free_space);
  }
}

/** Marks the triangle between two rays as free, up to where they are `width` apart [m]. */
void clearBetween(Grid& grid,
                  const Eigen::Vector2d& sensor,
                  const Eigen::Vector2d& a,
                  const Eigen::Vector2d& b,
                  double width)
{
  constexpr int bits = 4;  // fractions of a cell
  const Eigen::Vector2d to_a = a - sensor;
  const Eigen::Vector2d to_b = b - sensor;
  const double sine = to_a.x() * to_b.y() - to_a.y() * to_b.x();
  const double angle = std::abs(std::atan2(sine, to_a.dot(to_b)));
  const double length =
      std::min({to_a.norm(), to_b.norm(), width / angle}) - grid.resolution;  // less its end cell
  if (length <= 0)
  {
    return;
  }
  std::array<cv::Point, 3> triangle;
  for (const auto& [corner, p] : {std::pair(0, sensor),
                                  {1, sensor + length * to_a.normalized()},
                                  {2, sensor + length * to_b.normalized()}})
  {
    const Eigen::Vector2d cell = (p - grid.origin) / grid.resolution;
    triangle[corner] = {cvRound((cell.x() - 0.5) * (1 << bits)),
                        cvRound((grid.cells.rows - 0.5 - cell.y()) * (1 << bits))};
  }
  cv::fillConvexPoly(grid.cells, triangle.data(), static_cast<int>(triangle.size()),
                     cv::Scalar(Grid::free_space), cv::LINE_8, bits);
}

/** Position of the first lidar at each keyframe, map frame [m]. */
std::vector<Eigen::Vector3d> lidarsOf(const StaticMap& map)
{
  std::vector<Eigen::Vector3d> lidars;
  for (std::size_t k = 0; k < map.poses().size(); ++k)
  {
    lidars.emplace_back(map.poses()[k] * map.keyframes()[k].sensorOf(0).cast<double>());
  }
  return lidars;
}

/** Farthest returns around a lidar, by direction. */
struct FarthestReturns
{
  explicit FarthestReturns(const Eigen::Vector2d& at)
      : sensor(at), range(azimuth_bins, 0.0), ends(azimuth_bins)
  {
  }

  void add(const Eigen::Vector2d& p)
  {
    const Eigen::Vector2d d = p - sensor;
    const auto bin = static_cast<std::size_t>((std::atan2(d.y(), d.x()) + M_PI) / (2 * M_PI) *
                                              (azimuth_bins - 1));
    if (d.norm() <= ray_range && d.norm() > range[bin])
    {
      range[bin] = d.norm();
      ends[bin] = p;
    }
  }

  /** In order of their azimuths. */
  [[nodiscard]] std::vector<Eigen::Vector2d> returns() const
  {
    std::vector<Eigen::Vector2d> result;
    for (std::size_t bin = 0; bin < azimuth_bins; ++bin)
    {
      if (range[bin] > 0)
      {
        result.push_back(ends[bin]);
      }
    }
    return result;
  }

  Eigen::Vector2d sensor;
  std::vector<double> range;  //!< 0: none
  std::vector<Eigen::Vector2d> ends;
};

/** In every direction the ray to the farthest return below the obstacles' upper border is free, and
 * so is what lies between two rays no more than two voxels apart, as their thinned returns are. */
void clearRays(Grid& grid,
               const StaticMap& map,
               const GridGround& ground,
               double highest,
               const MapProgress& on_keyframe)
{
  map.forEachStaticCloud(
      [&](std::size_t k, const KeyframeCloud& cloud)
      {
        const Pose& T = map.poses()[k];
        std::vector<FarthestReturns> lidars;
        for (std::size_t i = 0; i < cloud.size(); ++i)
        {
          const std::size_t lidar = cloud.lidarOf(i);
          while (lidars.size() <= lidar)
          {
            const Eigen::Vector3f& sensor = map.keyframes()[k].sensorOf(lidars.size());
            lidars.emplace_back((T * sensor.cast<double>()).head<2>());
          }
          const Eigen::Vector3d p = T * cloud.points[i].cast<double>();
          if (ground.above(p) <= highest && ground.isSeenAt(p))
          {
            lidars[lidar].add(p.head<2>());
          }
        }
        for (const FarthestReturns& lidar : lidars)
        {
          const std::vector<Eigen::Vector2d> returns = lidar.returns();
          for (std::size_t i = 0; i < returns.size(); ++i)
          {
            clearRay(grid, lidar.sensor, returns[i]);
            clearBetween(grid, lidar.sensor, returns[i], returns[(i + 1) % returns.size()],
                         2 * map.voxelSize());
          }
        }
        if (on_keyframe)
        {
          on_keyframe(k + 1);
        }
      });
}

void markPoints(Grid& grid,
                const StaticMap& map,
                const MapPoints& points,
                const GridGround& ground,
                const MapExportOptions& o)
{
  const ObstacleColumns columns(points, ground, map.voxelSize(), map.keyframes().size(), o);
  for (const bool obstacles : {false, true})
  {
    for (const auto& point : points.points)
    {
      const Eigen::Vector3d p = point.cast<double>();
      if (obstacles ? columns.isObstacle(p)
                    : ground.above(p) < o.obstacle_min_height && ground.isSeenAt(p))
      {
        grid.set(grid.cellOf(p.x(), p.y()), obstacles ? Grid::occupied : Grid::free_space);
      }
    }
  }
  if (grid.resolution < map.voxelSize())
  {
    markFineObstacles(map, columns, grid);
  }
}

std::string yamlOf(const Grid& grid, const std::string& image, const Eigen::Vector3d& origin)
{
  const std::string text = formatted(
      "\nmode: trinary\nresolution: %.6g\norigin: [%.6f, %.6f, 0.0]\n"
      "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
      grid.resolution, grid.origin.x() + origin.x(), grid.origin.y() + origin.y());
  return image_key + yamlText(image) + text;
}

std::string yamlPath(const std::string& image)
{
  return std::filesystem::path(image).replace_extension(".yaml").string();
}

void writePngAndYaml(const Grid& grid, const std::string& path, const Eigen::Vector3d& origin)
{
  std::vector<std::uint8_t> png;
  if (!cv::imencode(".png", grid.cells, png))
  {
    throw UserError(path + ": encoding the picture failed");
  }
  writeWhole(path, bytesOf(png));
  const std::filesystem::path file(path);
  writeWhole(yamlPath(path), yamlOf(grid, file.filename().string(), origin));
}

/** MRPT's cells hold the probability of being free. Its coordinates are float32, so that the grid
 * stays relative to the origin. */
void writeGridmap(const Grid& grid, const std::string& path)
{
  const auto side = [&](int cells) { return static_cast<float>(cells * grid.resolution); };
  const auto x0 = static_cast<float>(grid.origin.x());
  const auto y0 = static_cast<float>(grid.origin.y());
  mrpt::maps::COccupancyGridMap2D map(x0, x0 + side(grid.cells.cols), y0,
                                      y0 + side(grid.cells.rows),
                                      static_cast<float>(grid.resolution));
  for (int row = 0; row < grid.cells.rows; ++row)
  {
    for (int col = 0; col < grid.cells.cols; ++col)
    {
      const std::uint8_t cell = grid.cells.at<std::uint8_t>(row, col);
      const float free = cell == Grid::occupied ? 0.02F : cell == Grid::free_space ? 0.98F : 0.5F;
      map.setCell(col, grid.cells.rows - 1 - row, free);
    }
  }
  constexpr int compression_level = 6;
  GzOutput file(path, compression_level);
  auto archive = mrpt::serialization::archiveFrom(file);
  archive << map;
  file.close();
}
}  // namespace

double writeOccupancyGrid(const StaticMap& map,
                          const std::string& path,
                          const MapExportOptions& options,
                          const Eigen::Vector3d& origin,
                          const MapProgress& on_keyframe)
{
  validate(options, "map_export");
  const MapPoints points = map.points();
  Grid grid = emptyGrid(points, options, origin);
  const GridGround ground(points, lidarsOf(map));
  clearRays(grid, map, ground, options.obstacle_max_height, on_keyframe);
  markPoints(grid, map, points, ground, options);
  if (std::filesystem::path(path).extension() == ".gridmap")
  {
    writeGridmap(grid, path);
  }
  else
  {
    writePngAndYaml(grid, path, origin);
  }
  return grid.resolution;
}

bool isGridImage(const std::string& path)
{
  std::error_code ignored;
  std::ifstream yaml(yamlPath(path));
  for (std::string line; std::filesystem::exists(path, ignored) && std::getline(yaml, line);)
  {
    if (line.rfind(image_key, 0) == 0)
    {
      const std::string image = fromYamlText(line.substr(image_key.size()));
      return std::filesystem::path(image).filename() == std::filesystem::path(path).filename();
    }
  }
  return false;
}
}  // namespace dyslam
