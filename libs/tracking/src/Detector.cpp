// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/tracking/Detector.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
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

/** Heights of the ground by cells, from every return: low, but not the very lowest (echoes by way
 * of mirrors lie below the road). */
class GroundHeights
{
 public:
  GroundHeights(const Points& points, double cell, double range) : cell_(cell)
  {
    std::unordered_map<std::int64_t, Lowest> lowest;
    for (const Eigen::Vector3f& p : points)
    {
      if (p.allFinite() && std::abs(p.x()) < range && std::abs(p.y()) < range)
      {
        lowest[key(p)].add(p.z());
      }
    }
    for (const auto& [k, low] : lowest)
    {
      raw_[k] = low.height();
    }
  }

  /** Ground below a point. A cell far above its neighbours holds a roof, not ground. */
  float below(const Eigen::Vector3f& p) const
  {
    constexpr float step = 0.3F;  // [m]
    const std::int64_t k = key(p);
    std::array<float, 9> around{};
    std::size_t count = 0;
    for (int di = -1; di <= 1; ++di)
    {
      for (int dj = -1; dj <= 1; ++dj)
      {
        const auto found = raw_.find(neighbourKey(k, di, dj));
        if (found != raw_.end())
        {
          around[count++] = found->second;
        }
      }
    }
    const auto own = raw_.find(k);
    const float height = own != raw_.end() ? own->second : p.z();
    if (count == 0)
    {
      return height;
    }
    const auto middle = around.begin() + static_cast<std::ptrdiff_t>(count / 2);
    std::nth_element(around.begin(), middle, around.begin() + static_cast<std::ptrdiff_t>(count));
    return std::min(height, *middle + step);
  }

 private:
  struct Lowest
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
    float height() const { return count >= 6 ? z[2] : z[0]; }
  };
  std::int64_t key(const Eigen::Vector3f& p) const
  {
    return cellKey(static_cast<double>(p.x()), static_cast<double>(p.y()), cell_);
  }

  double cell_;
  std::unordered_map<std::int64_t, float> raw_;
};

/** Disjoint sets; the lowest member stands for its set. */
class Sets
{
 public:
  explicit Sets(std::size_t count) : parent_(count)
  {
    std::iota(parent_.begin(), parent_.end(), std::size_t{0});
  }
  std::size_t find(std::size_t i)
  {
    while (parent_[i] != i)
    {
      parent_[i] = parent_[parent_[i]];
      i = parent_[i];
    }
    return i;
  }
  void join(std::size_t a, std::size_t b)
  {
    a = find(a);
    b = find(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

/** Points of one small cell, taken together while clustering. */
struct Node
{
  Eigen::Vector2f position = Eigen::Vector2f::Zero();
  float reach = 0;  //!< joins nodes this near
  std::vector<std::uint32_t> points;
};

/** Length that an object of this class usually has, at least [m]. */
double usualLength(ObjectClass object_class)
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
}  // namespace

void DetectorOptions::describe(OptionsVisitor& v)
{
  v.real("ground_clearance", ground_clearance, -10, 10, "lower points do not join clusters, m");
  v.real("ground_cell", ground_cell, 0.1, 100, "of the local ground heights, m");
  v.real("distance", distance, 0.01, 10, "joins points near the sensor, m");
  v.real("distance_per_range", distance_per_range, 0, 1, "added per metre of range");
  v.real("max_distance", max_distance, 0.01, 10, "joins points at most, m");
  v.integer("min_points", min_points, 1, 100000, "of a cluster");
  v.real("min_height", min_height, 0, 10, "of a cluster, m");
  v.real("max_length", max_length, 0.1, 1000, "of a cluster, m");
  v.real("max_range", max_range, 1, 1000, "m");
  v.degrees("yaw_step_deg", yaw_step, 0.1, 45, "of the search for the box's heading");
  v.real("position_sigma", position_sigma, 0.001, 10, "of a well seen box, m");
  v.degrees("yaw_sigma_deg", yaw_sigma, 0.1, 180, "of a well seen box");
}

Detector::Detector(const DetectorOptions& options) : options_(options)
{
  validate(options_, "detector");
}

void Detector::detect(Frame& frame) const
{
  frame.detections = detect(frame.cloud.points, frame.moving, frame.moving_probability);
}

std::vector<std::uint32_t> Detector::candidates(const Points& points,
                                                const std::vector<bool>& moving) const
{
  std::vector<std::uint32_t> chosen;
  const auto range = static_cast<float>(options_.max_range);
  for (std::size_t i = 0; i < moving.size(); ++i)
  {
    if (moving[i] && points[i].allFinite() && points[i].head<2>().norm() < range)
    {
      chosen.push_back(static_cast<std::uint32_t>(i));
    }
  }
  if (chosen.empty())
  {
    return chosen;
  }
  const GroundHeights ground(points, options_.ground_cell,
                             options_.max_range + 2 * options_.ground_cell);
  const auto clearance = static_cast<float>(options_.ground_clearance);
  chosen.erase(std::remove_if(chosen.begin(), chosen.end(),
                              [&](std::uint32_t i)
                              { return points[i].z() - ground.below(points[i]) < clearance; }),
               chosen.end());
  return chosen;
}

std::vector<std::vector<std::uint32_t>> Detector::clusters(
    const Points& points, const std::vector<std::uint32_t>& chosen) const
{
  constexpr double fine = 0.1;  // cell of the nodes [m]
  std::vector<Node> nodes;
  std::unordered_map<std::int64_t, std::size_t> node_at;
  for (const std::uint32_t i : chosen)
  {
    const Eigen::Vector3f& p = points[i];
    const auto [entry, is_new] = node_at.emplace(
        cellKey(static_cast<double>(p.x()), static_cast<double>(p.y()), fine), nodes.size());
    if (is_new)
    {
      nodes.emplace_back();
      const double reach =
          options_.distance + options_.distance_per_range * static_cast<double>(p.head<2>().norm());
      nodes.back().position = p.head<2>();
      nodes.back().reach = static_cast<float>(std::min(reach, options_.max_distance));
    }
    nodes[entry->second].points.push_back(i);
  }

  const double coarse = options_.max_distance;
  const auto coarseKey = [&](const Node& node)
  {
    return cellKey(static_cast<double>(node.position.x()), static_cast<double>(node.position.y()),
                   coarse);
  };
  std::unordered_map<std::int64_t, std::vector<std::size_t>> buckets;
  for (std::size_t n = 0; n < nodes.size(); ++n)
  {
    buckets[coarseKey(nodes[n])].push_back(n);
  }
  Sets sets(nodes.size());
  for (std::size_t n = 0; n < nodes.size(); ++n)
  {
    for (int di = -1; di <= 1; ++di)
    {
      for (int dj = -1; dj <= 1; ++dj)
      {
        const auto bucket = buckets.find(neighbourKey(coarseKey(nodes[n]), di, dj));
        if (bucket == buckets.end())
        {
          continue;
        }
        for (const std::size_t other : bucket->second)
        {
          const float reach = std::max(nodes[n].reach, nodes[other].reach);
          if (other < n &&
              (nodes[n].position - nodes[other].position).squaredNorm() <= reach * reach)
          {
            sets.join(n, other);
          }
        }
      }
    }
  }

  std::vector<std::vector<std::uint32_t>> result;
  std::unordered_map<std::size_t, std::size_t> cluster_of;
  for (std::size_t n = 0; n < nodes.size(); ++n)  // in order of first point: deterministic
  {
    const auto [entry, is_new] = cluster_of.emplace(sets.find(n), result.size());
    if (is_new)
    {
      result.emplace_back();
    }
    auto& members = result[entry->second];
    members.insert(members.end(), nodes[n].points.begin(), nodes[n].points.end());
  }
  return result;
}

std::vector<Detection> Detector::detect(const Points& points,
                                        const std::vector<bool>& moving,
                                        const std::vector<float>& probability) const
{
  std::vector<Detection> detections;
  for (auto& cluster : clusters(points, candidates(points, moving)))
  {
    if (cluster.size() < static_cast<std::size_t>(options_.min_points))
    {
      continue;
    }
    Points body;
    double probability_sum = 0;
    for (const std::uint32_t i : cluster)
    {
      body.push_back(points[i]);
      probability_sum += probability.empty() ? 1.0 : static_cast<double>(probability[i]);
    }
    Detection detection;
    detection.box = fitLShape(body, options_.yaw_step);
    if (detection.box.size.z() < options_.min_height ||
        detection.box.size.x() > options_.max_length)
    {
      continue;
    }
    const auto count = static_cast<double>(body.size());
    detection.object_class = guessClass(detection.box.size);
    detection.score = probability_sum / count * std::min(1.0, count / 30);

    // Little is known of where the far end of a half-seen body is, and less from few points.
    const double few = 1 + 10 / count;
    const double sigma = options_.position_sigma * few;
    const double hidden =
        0.3 * std::max(0.0, usualLength(detection.object_class) - detection.box.size.x());
    const Eigen::Vector2d along(std::cos(detection.box.yaw), std::sin(detection.box.yaw));
    detection.covariance.setZero();
    detection.covariance.diagonal() << sigma * sigma, sigma * sigma, sigma * sigma,
        std::pow(options_.yaw_sigma * few, 2);
    detection.covariance.topLeftCorner<2, 2>() += hidden * hidden * along * along.transpose();
    if (detection.box.size.x() < 1.3 * detection.box.size.y() || detection.box.size.x() < 1.2)
    {
      detection.covariance(3, 3) = 1.0;  // round: its heading is not seen
    }
    detection.points = std::move(cluster);
    detections.push_back(std::move(detection));
  }
  return detections;
}
}  // namespace dyslam
