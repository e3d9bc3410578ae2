// SPDX-License-Identifier: BSD-3-Clause
#include "Posts.h"

#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr float near = 0.4F;     // horizontal distance of places of the same post [m]
constexpr float around = 1.0F;   // within which a post stands by itself [m]
constexpr float lowest = 1.2F;   // height of a post [m]
constexpr float widest = 0.12F;  // standard deviation of its places, horizontally [m]
constexpr float square = 0.5F;   // side of the squares [m]

VoxelCell squareOf(const Eigen::Vector3f& place)
{
  return voxelCell(Eigen::Vector3f(place.x(), place.y(), 0), 1 / square);
}

/** The places near a place: their height and how far they spread. */
class NearPlaces
{
 public:
  void add(const Eigen::Vector3f& from_place)
  {
    const Eigen::Vector2f flat = from_place.head<2>();
    ++count_;
    sum_ += flat;
    squares_ += flat.squaredNorm();
    low_ = std::min(low_, from_place.z());
    high_ = std::max(high_, from_place.z());
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] bool arePost() const
  {
    const auto n = static_cast<float>(count_);
    const float variance = squares_ / n - (sum_ / n).squaredNorm();
    return high_ - low_ > lowest && variance < widest * widest;
  }

 private:
  std::size_t count_ = 0;
  Eigen::Vector2f sum_ = Eigen::Vector2f::Zero();
  float squares_ = 0;
  float low_ = 0;  // the place itself is one of them
  float high_ = 0;
};
}  // namespace

Posts::Posts(const std::vector<Eigen::Vector3f>& places)
    : places_(places), next_(places.size(), VoxelHash::none)
{
  std::vector<std::uint32_t> last(places.size());  // of the square that begins with a place
  for (std::uint32_t i = 0; i < places.size(); ++i)
  {
    const std::uint32_t first = squares_.findOrInsert(voxelKey(squareOf(places[i])), i);
    if (first != i)
    {
      next_[last[first]] = i;
    }
    last[first] = i;
  }
}

bool Posts::contain(std::size_t place) const
{
  constexpr int reach = 2;  // squares, for `around`
  const Eigen::Vector3f& p = places_[place];
  const VoxelCell middle = squareOf(p);
  NearPlaces near_places;
  std::size_t others = 0;
  for (int x = -reach; x <= reach; ++x)
  {
    for (int y = -reach; y <= reach; ++y)
    {
      for (std::uint32_t i = squares_.find(voxelKey({middle.x + x, middle.y + y, 0}));
           i != VoxelHash::none; i = next_[i])
      {
        const Eigen::Vector3f offset = places_[i] - p;
        const float distance = offset.head<2>().norm();
        if (distance < near)
        {
          near_places.add(offset);
        }
        else if (distance < around)
        {
          ++others;
        }
      }
    }
  }
  return 2 * others <= near_places.count() && near_places.arePost();
}
}  // namespace dyslam
