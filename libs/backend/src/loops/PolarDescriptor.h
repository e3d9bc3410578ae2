// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace dyslam
{
/** Descriptor of a place: the greatest height above ground in each cell of a polar grid around the
 * vehicle. A rotation of the vehicle shifts its columns (the idea of Kim & Kim, "Scan Context",
 * IROS 2018). */
class PolarDescriptor
{
 public:
  static constexpr std::size_t rings = 20;
  static constexpr std::size_t sectors = 60;

  PolarDescriptor() = default;
  /** \param points vehicle frame [m] \param max_range outer radius of the outermost ring [m]
   * \param viewpoint centre of the grid in the vehicle frame [m]: predicts the descriptor of the
   * place from there, up to occlusion */
  PolarDescriptor(const std::vector<Eigen::Vector3f>& points,
                  double max_range,
                  const Eigen::Vector2f& viewpoint = Eigen::Vector2f::Zero());

  struct Match
  {
    double distance = 1;  //!< distance of the descriptors: 0 equal, 1 nothing in common
    double heading = 0;   //!< heading of the other vehicle in this vehicle's frame [rad]
  };
  using RingMeans = std::array<float, rings>;
  using Column = Eigen::Matrix<float, rings, 1>;
  /** Unpacked descriptor, for comparisons with many others. */
  struct Columns
  {
    std::array<Column, sectors> column;  //!< heights by sector, normalised to unit length, or zero
    std::uint64_t seen = 0;              //!< bit s: sector s is not empty
  };
  [[nodiscard]] Columns columns() const;

  /** Smallest distance over all headings. */
  [[nodiscard]] Match match(const PolarDescriptor& other) const;
  [[nodiscard]] static Match match(const Columns& ours, const Columns& other);

  /** Difference of the mean heights per ring, which don't depend on the heading. */
  [[nodiscard]] static double ringDifference(const RingMeans& a, const RingMeans& b);
  [[nodiscard]] const RingMeans& ringMeans() const { return ring_means_; }

  // Interface for SwappedStore.
  [[nodiscard]] static std::size_t memory() { return 0; }  // all of it is in the object
  [[nodiscard]] std::string toBytes() const;
  [[nodiscard]] static PolarDescriptor fromBytes(std::string_view bytes);

 private:
  std::array<std::uint8_t, rings * sectors> heights_{};  //!< heights [1/16 m], sector by sector
  RingMeans ring_means_{};
};
}  // namespace dyslam
