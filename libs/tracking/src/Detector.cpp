// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/DisjointSets.h>
#include <dyslam/base/Error.h>
#include <dyslam/core/GroundSquare.h>
#include <dyslam/tracking/BoxFitting.h>
#include <dyslam/tracking/Detector.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

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

/** Ground height per cell around some points, from all returns. */
class LocalGround
{
 public:
  /** \param at the points whose ground is asked for \param cell size of a cell [m] \param range of
   * the points that count, in x and y [m] */
  LocalGround(const Points& points, const std::vector<std::uint32_t>& at, double cell, double range)
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

  /** Ground height at one of these points, see GroundAround::highest(). */
  float heightAt(const Eigen::Vector3f& p) const
  {
    const std::size_t own = indexOf(p);
    GroundAround around;
    for (int di = -1; di <= 1; ++di)
    {
      for (int dj = -1; dj <= 1; ++dj)
      {
        const GroundSquare& cell = cells_[own + static_cast<std::size_t>(di * width_ + dj)];
        if (cell.count() > 0)
        {
          around.add(heightOf(cell));
        }
      }
    }
    return std::min(cells_[own].count() > 0 ? heightOf(cells_[own]) : p.z(), around.highest());
  }

 private:
  /** The third lowest return, of fewer than 6 the lowest. The hindsight labels, which know the
   * ground from several scans, take the third lowest of 3 and more, of fewer the highest. */
  static float heightOf(const GroundSquare& cell)
  {
    return cell.count() >= 6 ? cell.thirdLowest() : cell.lowest();
  }
  std::size_t indexOf(const Eigen::Vector3f& p) const
  {
    const int i = static_cast<int>(std::floor(static_cast<double>(p.x()) / cell_)) + half_;
    const int j = static_cast<int>(std::floor(static_cast<double>(p.y()) / cell_)) + half_;
    return static_cast<std::size_t>(i * width_ + j);
  }

  double cell_;
  int half_;  //!< number of cells on each side of the sensor's cell
  int width_;
  std::vector<GroundSquare> cells_;
  std::vector<char> used_;  //!< cells whose height is asked for, or that of a neighbour
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

/** The given points in voxels of 0.1 m in the plane, in order of their first points.
 * \param lidar position in the frame of the points [m] */
std::vector<Node> voxelNodes(const Points& points,
                             const std::vector<std::uint32_t>& selected,
                             const Eigen::Vector2f& lidar,
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
      const double gap =
          options.cluster_gap +
          options.cluster_gap_per_range * static_cast<double>((p.head<2>() - lidar).norm());
      nodes.back().position = p.head<2>();
      nodes.back().link_distance = static_cast<float>(std::min(gap, options.max_cluster_gap));
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

Points pointsOf(const Points& points, const std::vector<std::uint32_t>& cluster)
{
  Points selected;
  selected.reserve(cluster.size());
  for (const std::uint32_t i : cluster)
  {
    selected.push_back(points[i]);
  }
  return selected;
}

/** Vertical distance between a cluster and the ray that passes below it: the rays of the next lower
 * ring, as far as they return anything, or infinity [m]. \param cluster indices of its points
 * \param lidar position of the lidar [m] */
float gapBelow(const Points& points,
               const std::vector<std::uint32_t>& cluster,
               const Eigen::Vector3f& lidar)
{
  constexpr float same_ring = 0.004F;  // slope by which points of one ring differ at most
  constexpr float sector = 0.01F;      // half of the narrowest sector in which rays count [rad]
  Eigen::Vector2f direction = Eigen::Vector2f::Zero();
  float range = 0;                                        // mean of the cluster [m]
  float lowest = std::numeric_limits<float>::infinity();  // slope of its lowest ray
  for (const std::uint32_t i : cluster)
  {
    const Eigen::Vector3f ray = points[i] - lidar;
    const float distance = ray.head<2>().norm();
    direction += ray.head<2>() / distance;
    range += distance / static_cast<float>(cluster.size());
    lowest = std::min(lowest, ray.z() / distance);
  }
  direction.normalize();
  float sine = sector;  // of half of the sector
  for (const std::uint32_t i : cluster)
  {
    const Eigen::Vector2f ray = (points[i] - lidar).head<2>().normalized();
    sine = std::max(sine, std::abs(ray.x() * direction.y() - ray.y() * direction.x()));
  }
  float below = -std::numeric_limits<float>::infinity();  // slope of the highest ray below it
  for (const Eigen::Vector3f& p : points)
  {
    const Eigen::Vector3f ray = p - lidar;
    const float distance = ray.head<2>().norm();
    const float slope = ray.z() / distance;
    if (slope < lowest - same_ring && slope > below && ray.head<2>().dot(direction) > 0 &&
        std::abs(ray.x() * direction.y() - ray.y() * direction.x()) < sine * distance)
    {
      below = slope;
    }
  }
  return range * (lowest - below);
}

/** Part of a ray inside of a box, in the plane. */
struct Chord
{
  double entry = 0;  //!< where the ray enters the box: 0 at the lidar, 1 at the end of the ray
  double exit = 1;   //!< where it leaves it; below `entry` if it misses it
};

Chord chordInBox(const Eigen::Vector3d& lidar, const Eigen::Vector3d& ray, const Box& box)
{
  const Eigen::Rotation2Dd to_box(-box.yaw);
  const Eigen::Vector2d start = to_box * (lidar - box.centre).head<2>();
  const Eigen::Vector2d direction = to_box * ray.head<2>();
  Chord chord;
  for (int k = 0; k < 2; ++k)
  {
    const double half = 0.5 * box.size[k];
    const double slope = std::abs(direction[k]) > 1e-9 ? direction[k] : 1e-9;
    const double a = (-half - start[k]) / slope;
    const double b = (half - start[k]) / slope;
    chord.entry = std::max(chord.entry, std::min(a, b));
    chord.exit = std::min(chord.exit, std::max(a, b));
  }
  return chord;
}

/** Share of the rays that go through a box in the lower half of the cluster's height and return
 * from beyond, of these and of those that end at the cluster there. The body of a vehicle lets none
 * through; windows are higher. Persons side by side let many through.
 * \param cluster indices of its points \param box around them \param lidar its position [m] */
double shareThrough(const Points& points,
                    const std::vector<std::uint32_t>& cluster,
                    const Box& box,
                    const Eigen::Vector3f& lidar)
{
  constexpr double least_chord = 0.3;  // shorter ones are at rounded corners [m]
  constexpr double beyond = 0.3;       // least distance of a return behind the box [m]
  const double bottom = box.centre.z() - 0.5 * box.size.z();
  const double middle = box.centre.z();
  const Eigen::Vector3d start = lidar.cast<double>();
  const Eigen::Vector2d towards = box.centre.head<2>() - start.head<2>();
  const double radius = 0.5 * box.size.head<2>().norm();
  std::size_t through = 0;
  for (const Eigen::Vector3f& p : points)
  {
    const Eigen::Vector3d ray = p.cast<double>() - start;
    const double along = ray.head<2>().dot(towards);
    const double across = ray.x() * towards.y() - ray.y() * towards.x();
    if (!(along > 0) || std::abs(across) > radius * ray.head<2>().norm())
    {
      continue;
    }
    const Chord chord = chordInBox(start, ray, box);
    const double length = ray.head<2>().norm();
    const double height = start.z() + 0.5 * (chord.entry + chord.exit) * ray.z();
    through += (chord.exit - chord.entry) * length > least_chord &&
                       (1 - chord.exit) * length > beyond && height > bottom && height < middle
                   ? 1
                   : 0;
  }
  const auto hits =
      std::count_if(cluster.begin(), cluster.end(),
                    [&](std::uint32_t i) { return static_cast<double>(points[i].z()) < middle; });
  return static_cast<double>(through) /
         std::max(1.0, static_cast<double>(through) + static_cast<double>(hits));
}

/** Whether a low cluster may be a vehicle or a person of which one ring of a sparse sensor shows a
 * row of points: no ray passes close below it, which would have hit it, too. */
bool mayBeHitByOneRing(const Points& points,
                       const std::vector<std::uint32_t>& cluster,
                       double length,
                       const Eigen::Vector3f& lidar)
{
  constexpr double longest_row = 6;  // longer rows are of walls and guard rails [m]
  constexpr float least_gap = 0.7F;  // to the ray below [m]
  return length <= longest_row && gapBelow(points, cluster, lidar) >= least_gap;
}
}  // namespace

void DetectorOptions::describe(OptionsVisitor& v)
{
  v.real("ground_clearance", ground_clearance, -10, 10,
         "height above ground below which points are not clustered [m]");
  v.real("hindsight_clearance", hindsight_clearance, -10, 10,
         "ground_clearance beyond 12 m of the tracks with hindsight, whose labels leave out the "
         "ground [m]");
  v.real("ground_cell", ground_cell, 0.1, 100, "cell size of the local ground height map [m]");
  v.real("cluster_gap", cluster_gap, 0.01, 10, "largest gap within a cluster at range 0 [m]");
  v.real("cluster_gap_per_range", cluster_gap_per_range, 0, 1,
         "increase with range of the largest gap within a cluster [m/m]");
  v.real("max_cluster_gap", max_cluster_gap, 0.01, 10,
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
  v.renamed("distance", "cluster_gap");
  v.renamed("distance_per_range", "cluster_gap_per_range");
  v.renamed("max_distance", "max_cluster_gap");
}

Detector::Detector(const DetectorOptions& options, MovingLabels labels)
    : options_(options), labels_(labels)
{
  validate(options_, "detector");
  if (options_.cluster_gap > options_.max_cluster_gap)
  {
    throw UserError("[detector] cluster_gap is above its upper limit, max_cluster_gap; change one");
  }
  constexpr double most_cells = 1000;  // largest number of cells up to max_range: limits memory
  if (options_.max_range > most_cells * options_.ground_cell)
  {
    throw UserError("[detector] ground_cell is too small; use at least max_range / 1000");
  }
}

void Detector::detect(Frame& frame) const
{
  frame.detections = detect(frame.cloud.points, frame.moving, frame.moving_probability,
                            frame.scan.T_vehicle_lidar.translation().cast<float>());
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
                                                        const std::vector<bool>& moving,
                                                        const Eigen::Vector3f& lidar) const
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
  const LocalGround ground(points, selected, options_.ground_cell,
                           options_.max_range + 2 * options_.ground_cell);
  constexpr float several_rings = 12;  // range within which several rings hit an object [m]
  const auto clearanceAt = [&](const Eigen::Vector3f& p)
  {
    const bool trusted =
        labels_ == MovingLabels::hindsight && (p - lidar).head<2>().norm() > several_rings;
    return static_cast<float>(trusted ? options_.hindsight_clearance : options_.ground_clearance);
  };
  selected.erase(std::remove_if(selected.begin(), selected.end(),
                                [&](std::uint32_t i)
                                {
                                  const Eigen::Vector3f& p = points[i];
                                  return p.z() - ground.heightAt(p) < clearanceAt(p);
                                }),
                 selected.end());
  return selected;
}

std::vector<Detection> Detector::detect(const Points& points,
                                        const std::vector<bool>& moving,
                                        const std::vector<float>& probability,
                                        const Eigen::Vector3f& lidar) const
{
  std::vector<Detection> detections;
  const std::vector<Node> nodes =
      voxelNodes(points, selectMovingPoints(points, moving, lidar), lidar.head<2>(), options_);
  std::vector<std::vector<std::uint32_t>> clusters;
  for (auto& cluster : linkNodes(nodes, options_.max_cluster_gap))
  {
    for (auto& part : splitGroup(points, std::move(cluster), lidar))
    {
      clusters.push_back(std::move(part));
    }
  }
  for (auto& cluster : clusters)
  {
    if (cluster.size() < static_cast<std::size_t>(options_.min_points))
    {
      continue;
    }
    double probability_sum = 0;
    for (const std::uint32_t i : cluster)
    {
      probability_sum += probability.empty() ? 1.0 : static_cast<double>(probability[i]);
    }
    const Box box = fitLShape(pointsOf(points, cluster), options_.yaw_step);
    const bool high_enough = box.size.z() >= options_.min_height ||
                             (labels_ == MovingLabels::hindsight &&
                              mayBeHitByOneRing(points, cluster, box.size.x(), lidar));
    if (!high_enough || box.size.x() > longest(box.size.y(), options_))
    {
      continue;
    }
    Detection detection = makeDetection(box, cluster.size(), probability_sum);
    detection.points = std::move(cluster);
    detections.push_back(std::move(detection));
  }
  return detections;
}

bool Detector::arePersons(const Points& points,
                          const std::vector<std::vector<std::uint32_t>>& parts) const
{
  constexpr double most_others = 0.2;  // share of points in parts that are no persons
  int persons = 0;
  std::size_t others = 0;  // points of parts that are no persons
  std::size_t all = 0;
  for (const auto& part : parts)
  {
    const bool person = part.size() >= static_cast<std::size_t>(options_.min_points) &&
                        classifyBySize(fitLShape(pointsOf(points, part), options_.yaw_step).size) ==
                            ObjectClass::pedestrian;
    persons += person ? 1 : 0;
    others += person ? 0 : part.size();
    all += part.size();
  }
  return persons >= 2 && static_cast<double>(others) <= most_others * static_cast<double>(all);
}

std::vector<std::vector<std::uint32_t>> Detector::splitGroup(const Points& points,
                                                             std::vector<std::uint32_t> cluster,
                                                             const Eigen::Vector3f& lidar) const
{
  constexpr double longest_person = 1.2;  // [m]
  constexpr double least_share = 0.2;     // of the rays that go through a group
  std::vector<std::vector<std::uint32_t>> parts;
  if (cluster.size() >= 2 * static_cast<std::size_t>(options_.min_points))
  {
    const Box box = fitLShape(pointsOf(points, cluster), options_.yaw_step);
    if (box.size.x() > longest_person && classifyBySize(box.size) != ObjectClass::truck)
    {
      DetectorOptions narrow = options_;
      narrow.cluster_gap *= 0.5;
      narrow.cluster_gap_per_range *= 0.5;
      narrow.max_cluster_gap *= 0.5;
      parts =
          linkNodes(voxelNodes(points, cluster, lidar.head<2>(), narrow), narrow.max_cluster_gap);
      if (arePersons(points, parts) && shareThrough(points, cluster, box, lidar) > least_share)
      {
        return parts;
      }
    }
  }
  parts.assign(1, std::move(cluster));
  return parts;
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
