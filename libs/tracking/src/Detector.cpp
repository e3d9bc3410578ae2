// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/core/DisjointSets.h>
#include <dyslam/core/Error.h>
#include <dyslam/core/Quantile.h>
#include <dyslam/tracking/Detector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>

namespace dyslam
{
namespace
{
using Points = std::vector<Eigen::Vector3f>;

std::int64_t cellKey(double x, double y, double cell)
{
  const auto i = static_cast<std::int64_t>(std::floor(x / cell));
  const auto j = static_cast<std::int64_t>(std::floor(y / cell));
  return i * (std::int64_t{1} << 32) + j;
}

std::int64_t neighbourKey(std::int64_t key, int di, int dj)
{
  return key + di * (std::int64_t{1} << 32) + dj;
}

/** Ground height per cell around some points, from all returns: a low order statistic instead of
 * the minimum, because multipath echoes lie below the road. */
class GroundAround
{
 public:
  /** \param at points at which the ground height is needed \param cell size of a cell [m]
   * \param range largest x and y of the points used [m] */
  GroundAround(const Points& points,
               const std::vector<std::uint32_t>& at,
               double cell,
               double range)
      : cell_(cell),
        half_(static_cast<int>(std::ceil(range / cell)) + 1),
        width_(2 * half_ + 1),
        cells_(static_cast<std::size_t>(width_) * static_cast<std::size_t>(width_)),
        used_(cells_.size(), 0)
  {
    for (const std::uint32_t i : at)
    {
      const std::size_t own = indexOf(points[i]);
      for (int di = -1; di <= 1; ++di)
      {
        for (int dj = -1; dj <= 1; ++dj)
        {
          used_[own + static_cast<std::size_t>(di * width_ + dj)] = 1;
        }
      }
    }
    for (const Eigen::Vector3f& p : points)
    {
      if (p.allFinite() && std::abs(p.x()) < range && std::abs(p.y()) < range)
      {
        const std::size_t index = indexOf(p);
        if (used_[index] != 0)
        {
          cells_[index].add(p.z());
        }
      }
    }
  }

  /** Ground height at one of the points `at`; limited by the median of the neighbouring cells,
   * because of roofs. */
  float heightAt(const Eigen::Vector3f& p) const
  {
    constexpr float step = 0.3F;  // largest height above the median [m]
    const std::size_t own = indexOf(p);
    std::array<float, 9> around{};
    std::size_t count = 0;
    for (int di = -1; di <= 1; ++di)
    {
      for (int dj = -1; dj <= 1; ++dj)
      {
        const CellReturns& cell = cells_[own + static_cast<std::size_t>(di * width_ + dj)];
        if (cell.count > 0)
        {
          around[count++] = cell.height();
        }
      }
    }
    const float height = cells_[own].count > 0 ? cells_[own].height() : p.z();
    if (count == 0)
    {
      return height;
    }
    const auto end = around.begin() + static_cast<std::ptrdiff_t>(count);
    return std::min(height, upperMedian(around.begin(), end) + step);
  }

 private:
  struct CellReturns
  {
    std::array<float, 3> z{std::numeric_limits<float>::max(), std::numeric_limits<float>::max(),
                           std::numeric_limits<float>::max()};
    int count = 0;
    void add(float value)
    {
      ++count;
      for (float& slot : z)
      {
        if (value < slot)
        {
          std::swap(value, slot);
        }
      }
    }
    /** Height of the third lowest return; of the lowest if there are fewer than 6. The hindsight
     * labels, which know the ground from several scans, use the third lowest of at least 3, else
     * the highest. */
    float height() const { return count >= 6 ? z[2] : z[0]; }
  };
  std::size_t indexOf(const Eigen::Vector3f& p) const
  {
    const int i = static_cast<int>(std::floor(static_cast<double>(p.x()) / cell_)) + half_;
    const int j = static_cast<int>(std::floor(static_cast<double>(p.y()) / cell_)) + half_;
    return static_cast<std::size_t>(i * width_ + j);
  }

  double cell_;
  int half_;  //!< number of cells on each side of the sensor's cell
  int width_;
  std::vector<CellReturns> cells_;
  std::vector<char> used_;  //!< cells whose height, or that of a neighbour, is needed
};

/** Points of one voxel, clustered together. */
struct Node
{
  Eigen::Vector2f position = Eigen::Vector2f::Zero();
  float link_distance = 0;  //!< distance below which the node is linked with another one [m]
  std::vector<std::uint32_t> points;
};

/** Least usual length of a class [m]. */
double typicalLength(ObjectClass object_class)
{
  switch (object_class)
  {
    case ObjectClass::car:
      return 3.8;
    case ObjectClass::truck:
      return 7;
    case ObjectClass::cyclist:
      return 1.6;
    default:
      return 0.6;
  }
}

/** Largest length of a cluster by its width [m]: long vehicles are narrow. */
double longest(double width, const DetectorOptions& options)
{
  constexpr double vehicle_width = 4;
  return width < vehicle_width ? std::max(options.max_length, options.max_narrow_length)
                               : options.max_length;
}

/** Nodes of the given points: voxels of 0.1 m in the plane, in order of their first points. */
std::vector<Node> voxelNodes(const Points& points,
                             const std::vector<std::uint32_t>& selected,
                             const DetectorOptions& options)
{
  constexpr double voxel = 0.1;  // side of a voxel [m]
  std::vector<Node> nodes;
  std::unordered_map<std::int64_t, std::size_t> node_at;
  for (const std::uint32_t i : selected)
  {
    const Eigen::Vector3f& p = points[i];
    const auto [entry, is_new] = node_at.emplace(
        cellKey(static_cast<double>(p.x()), static_cast<double>(p.y()), voxel), nodes.size());
    if (is_new)
    {
      nodes.emplace_back();
      const double distance =
          options.distance + options.distance_per_range * static_cast<double>(p.head<2>().norm());
      nodes.back().position = p.head<2>();
      nodes.back().link_distance = static_cast<float>(std::min(distance, options.max_distance));
    }
    nodes[entry->second].points.push_back(i);
  }
  return nodes;
}

/** Point indices of each cluster: single linkage of the nodes. \param max_distance upper limit of
 * the nodes' link distances [m]. */
std::vector<std::vector<std::uint32_t>> linkNodes(const std::vector<Node>& nodes,
                                                  double max_distance)
{
  const auto bucketKey = [&](const Node& node)
  {
    return cellKey(static_cast<double>(node.position.x()), static_cast<double>(node.position.y()),
                   max_distance);
  };
  std::unordered_map<std::int64_t, std::vector<std::size_t>> buckets;
  for (std::size_t n = 0; n < nodes.size(); ++n)
  {
    buckets[bucketKey(nodes[n])].push_back(n);
  }
  DisjointSets sets(nodes.size());
  const auto linkWithBucket = [&](std::size_t n, const std::vector<std::size_t>& bucket)
  {
    for (const std::size_t other : bucket)
    {
      const float distance = std::max(nodes[n].link_distance, nodes[other].link_distance);
      if (other < n &&
          (nodes[n].position - nodes[other].position).squaredNorm() <= distance * distance)
      {
        sets.join(n, other);
      }
    }
  };
  for (std::size_t n = 0; n < nodes.size(); ++n)
  {
    for (int di = -1; di <= 1; ++di)
    {
      for (int dj = -1; dj <= 1; ++dj)
      {
        const auto bucket = buckets.find(neighbourKey(bucketKey(nodes[n]), di, dj));
        if (bucket != buckets.end())
        {
          linkWithBucket(n, bucket->second);
        }
      }
    }
  }

  std::vector<std::vector<std::uint32_t>> clusters;
  std::unordered_map<std::size_t, std::size_t> cluster_of;
  for (std::size_t n = 0; n < nodes.size(); ++n)  // in order of first points: deterministic
  {
    const auto [entry, is_new] = cluster_of.emplace(sets.find(n), clusters.size());
    if (is_new)
    {
      clusters.emplace_back();
    }
    auto& members = clusters[entry->second];
    members.insert(members.end(), nodes[n].points.begin(), nodes[n].points.end());
  }
  return clusters;
}
}  // namespace

void DetectorOptions::describe(OptionsVisitor& v)
{
  v.real("ground_clearance", ground_clearance, -10, 10,
         "height above ground below which points are not clustered [m]");
  v.real("ground_cell", ground_cell, 0.1, 100, "cell size of the local ground height map [m]");
  v.real("distance", distance, 0.01, 10, "largest gap within a cluster at range 0 [m]");
  v.real("distance_per_range", distance_per_range, 0, 1,
         "increase with range of the largest gap within a cluster [m/m]");
  v.real("max_distance", max_distance, 0.01, 10,
         "upper limit of the largest gap within a cluster [m]");
  v.integer("min_points", min_points, 1, 100000, "least number of points of a cluster");
  v.real("min_height", min_height, 0, 10, "least height of a cluster [m]");
  v.real("max_length", max_length, 0.1, 1000, "largest length of a cluster wider than 4 m [m]");
  v.real("max_narrow_length", max_narrow_length, 0.1, 1000,
         "largest length of a cluster narrower than 4 m, if above max_length [m]");
  v.real("max_range", max_range, 1, 1000,
         "largest horizontal range of points that are clustered [m]");
  v.degrees("yaw_step_deg", yaw_step, 0.1, 45,
            "step of the heading search of the L-shape fit [deg]");
  v.real("position_sigma", position_sigma, 0.001, 10,
         "sigma of the position of a box of many points [m]");
  v.degrees("yaw_sigma_deg", yaw_sigma, 0.1, 180,
            "sigma of the heading of a box of many points [deg]");
}

Detector::Detector(const DetectorOptions& options) : options_(options)
{
  validate(options_, "detector");
  constexpr double most_cells = 1000;  // largest number of cells up to max_range: limits memory
  if (options_.max_range > most_cells * options_.ground_cell)
  {
    throw UserError("[detector] ground_cell is too small; use at least max_range / 1000");
  }
}

void Detector::detect(Frame& frame) const
{
  frame.detections = detect(frame.cloud.points, frame.moving, frame.moving_probability);
  if (!frame.moving_by_prediction.empty())
  {
    for (Detection& detection : frame.detections)
    {
      const auto predicted =
          std::count_if(detection.points.begin(), detection.points.end(),
                        [&](std::uint32_t i) { return frame.moving_by_prediction[i]; });
      detection.predicted = 2 * static_cast<std::size_t>(predicted) > detection.points.size();
    }
  }
}

std::vector<std::uint32_t> Detector::selectMovingPoints(const Points& points,
                                                        const std::vector<bool>& moving) const
{
  std::vector<std::uint32_t> selected;
  const auto range = static_cast<float>(options_.max_range);
  for (std::size_t i = 0; i < moving.size(); ++i)
  {
    if (moving[i] && points[i].allFinite() && points[i].head<2>().norm() < range)
    {
      selected.push_back(static_cast<std::uint32_t>(i));
    }
  }
  if (selected.empty())
  {
    return selected;
  }
  const GroundAround ground(points, selected, options_.ground_cell,
                            options_.max_range + 2 * options_.ground_cell);
  const auto clearance = static_cast<float>(options_.ground_clearance);
  selected.erase(std::remove_if(selected.begin(), selected.end(),
                                [&](std::uint32_t i)
                                { return points[i].z() - ground.heightAt(points[i]) < clearance; }),
                 selected.end());
  return selected;
}

std::vector<Detection> Detector::detect(const Points& points,
                                        const std::vector<bool>& moving,
                                        const std::vector<float>& probability) const
{
  std::vector<Detection> detections;
  const std::vector<Node> nodes = voxelNodes(points, selectMovingPoints(points, moving), options_);
  for (auto& cluster : linkNodes(nodes, options_.max_distance))
  {
    if (cluster.size() < static_cast<std::size_t>(options_.min_points))
    {
      continue;
    }
    Points cluster_points;
    double probability_sum = 0;
    for (const std::uint32_t i : cluster)
    {
      cluster_points.push_back(points[i]);
      probability_sum += probability.empty() ? 1.0 : static_cast<double>(probability[i]);
    }
    const Box box = fitLShape(cluster_points, options_.yaw_step);
    if (box.size.z() < options_.min_height || box.size.x() > longest(box.size.y(), options_))
    {
      continue;
    }
    Detection detection = makeDetection(box, cluster.size(), probability_sum);
    detection.points = std::move(cluster);
    detections.push_back(std::move(detection));
  }
  return detections;
}

Detection Detector::makeDetection(const Box& box,
                                  std::size_t point_count,
                                  double probability_sum) const
{
  Detection detection;
  detection.box = box;
  const auto count = static_cast<double>(point_count);
  detection.object_class = classifyBySize(box.size);
  detection.score = probability_sum / count * std::min(1.0, count / 30);

  // The standard deviations grow with fewer points, and along the axis with the occluded length.
  const double sigma_scale = 1 + 10 / count;
  const double sigma = options_.position_sigma * sigma_scale;
  const double occluded_sigma =
      0.3 * std::max(0.0, typicalLength(detection.object_class) - box.size.x());
  const Eigen::Vector2d along(std::cos(box.yaw), std::sin(box.yaw));
  detection.covariance.setZero();
  detection.covariance.diagonal() << sigma * sigma, sigma * sigma, sigma * sigma,
      std::pow(options_.yaw_sigma * sigma_scale, 2);
  detection.covariance.topLeftCorner<2, 2>() +=
      occluded_sigma * occluded_sigma * along * along.transpose();
  if (box.size.x() < 1.3 * box.size.y() || box.size.x() < 1.2)
  {
    detection.covariance(3, 3) = 1.0;  // nearly square: the heading is not observable
  }
  return detection;
}
}  // namespace dyslam
