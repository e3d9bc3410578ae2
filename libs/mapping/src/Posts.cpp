// SPDX-License-Identifier: BSD-3-Clause
#include "Posts.h"

#include <dyslam/core/VoxelGrid.h>

#include <algorithm>
#include <cmath>

namespace dyslam
{
namespace
{
constexpr float near = 0.4F;     // largest horizontal distance of voxels of a post [m]
constexpr float around = 1.0F;   // horizontal distance within which a post stands by itself [m]
constexpr float lowest = 1.2F;   // least height of a post [m]
constexpr float widest = 0.12F;  // largest horizontal standard deviation of a post's voxels [m]
constexpr float square = 0.5F;   // side of the squares that index the voxels [m]

VoxelCell squareOf(const Eigen::Vector3f& voxel)
{
  return voxelCell(Eigen::Vector3f(voxel.x(), voxel.y(), 0), 1 / square);
}

/** Number, height and horizontal spread of the voxels near a voxel. */
class NearVoxels
{
 public:
  void add(const Eigen::Vector3f& from_voxel)
  {
    const Eigen::Vector2f flat = from_voxel.head<2>();
    ++count_;
    sum_ += flat;
    squares_ += flat.squaredNorm();
    low_ = std::min(low_, from_voxel.z());
    high_ = std::max(high_, from_voxel.z());
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
  float low_ = 0;  // at most 0, since the voxel itself is added
  float high_ = 0;
};
}  // namespace

Posts::Posts(const std::vector<Eigen::Vector3f>& voxels)
    : voxels_(voxels), next_(voxels.size(), VoxelHash::none)
{
  std::vector<std::uint32_t> last(voxels.size());  // last voxel of a square, by its first voxel
  for (std::uint32_t i = 0; i < voxels.size(); ++i)
  {
    const std::uint32_t first = squares_.findOrInsert(voxelKey(squareOf(voxels[i])), i);
    if (first != i)
    {
      next_[last[first]] = i;
    }
    last[first] = i;
  }
}

bool Posts::contain(std::size_t voxel) const
{
  constexpr int reach = 2;  // number of squares that cover `around`
  const Eigen::Vector3f& p = voxels_[voxel];
  const VoxelCell middle = squareOf(p);
  NearVoxels near_voxels;
  std::size_t others = 0;
  for (int x = -reach; x <= reach; ++x)
  {
    for (int y = -reach; y <= reach; ++y)
    {
      for (std::uint32_t i = squares_.find(voxelKey({middle.x + x, middle.y + y, 0}));
           i != VoxelHash::none; i = next_[i])
      {
        const Eigen::Vector3f offset = voxels_[i] - p;
        const float distance = offset.head<2>().norm();
        if (distance < near)
        {
          near_voxels.add(offset);
        }
        else if (distance < around)
        {
          ++others;
        }
      }
    }
  }
  return 2 * others <= near_voxels.count() && near_voxels.arePost();
}
}  // namespace dyslam
