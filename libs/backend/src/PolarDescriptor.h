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
/** The appearance of a place from above: the greatest height over the ground in each cell of a
 * polar grid around the vehicle. A turn of the vehicle shifts its columns (the idea of Kim & Kim,
 * "Scan Context", IROS 2018). */
class PolarDescriptor
{
 public:
  static constexpr std::size_t rings = 20;
  static constexpr std::size_t sectors = 60;

  PolarDescriptor() = default;
  /** \param points vehicle frame [m] \param max_range of the outermost ring [m]
   * \param viewpoint centre of the grid in the vehicle frame [m]: predicts the descriptor of the
   * place from there, up to occlusion */
  PolarDescriptor(const std::vector<Eigen::Vector3f>& points,
                  double max_range,
                  const Eigen::Vector2f& viewpoint = Eigen::Vector2f::Zero());

  struct Match
  {
    double distance = 1;  //!< 0 same, 1 nothing in common
    double heading = 0;   //!< of the other's vehicle in this one's frame [rad]
  };
  using RingMeans = std::array<float, rings>;
  using Column = Eigen::Matrix<float, rings, 1>;
  /** A descriptor unpacked, for comparison with many others. */
  struct Columns
  {
    std::array<Column, sectors> column;  //!< of unit length, or zero
    std::uint64_t seen = 0;              //!< bit s: something is in sector s
  };
  [[nodiscard]] Columns columns() const;

  /** Best over all headings. */
  [[nodiscard]] Match match(const PolarDescriptor& other) const;
  [[nodiscard]] static Match match(const Columns& ours, const Columns& other);

  /** Mean height per ring does not change with heading; this is how much it differs. */
  [[nodiscard]] static double ringDifference(const RingMeans& a, const RingMeans& b);
  [[nodiscard]] const RingMeans& ringMeans() const { return ring_means_; }

  // For SwappedStore.
  [[nodiscard]] static std::size_t memory() { return 0; }  // all of it is in the object
  [[nodiscard]] std::string toBytes() const;
  [[nodiscard]] static PolarDescriptor fromBytes(std::string_view bytes);

 private:
  std::array<std::uint8_t, rings * sectors> heights_{};  //!< 1/16 m, sector by sector
  RingMeans ring_means_{};
};
}  // namespace dyslam
