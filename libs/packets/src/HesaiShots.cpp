// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/packets/HesaiPackets.h>

#include <array>

namespace dyslam
{
namespace
{
// How long before the end of a firing each laser shoots [us].
constexpr std::array<double, 40> pandar40_before_end{
    42.22, 28.47, 16.04, 3.62,  45.49, 31.74, 47.46, 54.67, 20.62, 33.71,
    40.91, 8.19,  20.62, 27.16, 50.73, 8.19,  14.74, 36.98, 45.49, 52.70,
    23.89, 31.74, 38.95, 11.47, 18.65, 25.19, 48.76, 6.23,  12.77, 35.01,
    21.92, 9.50,  43.52, 29.77, 17.35, 4.92,  42.22, 28.47, 16.04, 3.62};
constexpr std::array<double, 64> pandar64_before_end{
    23.180, 21.876, 20.572, 19.268, 17.964, 16.660, 11.444, 46.796, 7.532,  36.956, 50.732,
    54.668, 40.892, 44.828, 31.052, 34.988, 48.764, 52.700, 38.924, 42.860, 29.084, 33.020,
    46.796, 25.148, 36.956, 50.732, 27.116, 40.892, 44.828, 31.052, 34.988, 48.764, 25.148,
    38.924, 42.860, 29.084, 33.020, 52.700, 6.228,  54.668, 15.356, 27.116, 10.140, 23.180,
    4.924,  21.876, 14.052, 17.964, 8.836,  19.268, 3.620,  20.572, 12.748, 16.660, 7.532,
    11.444, 6.228,  15.356, 10.140, 4.924,  3.620,  14.052, 8.836,  12.748};

/** Of a QT64, which pauses after each eight lasers, and longer after each sixteen [us]. */
double shotOfQt64(std::size_t laser)
{
  return 12.31 + 2.057 * static_cast<double>(laser) + 0.39 * static_cast<double>(laser / 8) +
         0.6 * static_cast<double>(laser / 16);
}

/** Of a QT128, whose two sequences leave out the second or the first quarter of the lasers: a laser
 * of the upper half, one of the third quarter, and the one 64 before the first of them shoot in a
 * row, in the second sequence with those of the upper half exchanged [us]. */
double shotOfQt128(std::size_t laser, bool second)
{
  constexpr std::size_t quarter = 32;
  constexpr double within_row = 0.856;
  constexpr double row_period = 3.168;
  // Rank of each laser of eight in the order of the third and of the last quarter: four passes over
  // the quarter shoot two of each eight.
  constexpr std::array<std::size_t, 8> third{0, 3, 1, 2, 2, 1, 3, 0};
  constexpr std::array<std::size_t, 8> last{1, 2, 0, 3, 3, 0, 2, 1};
  const std::size_t part = laser / quarter;
  if (part == (second ? 1U : 0U))
  {
    return 0;  // does not shoot
  }
  const bool is_third = part == 2 || part == 0;
  const std::size_t eight = laser % quarter / 8;
  const std::size_t pass = (is_third ? third : last)[laser % 8];
  const std::size_t row = 8 * pass + 2 * eight + (laser % 8 > 3 ? 1 : 0);
  const std::size_t place = part < 2 ? 2 : is_third == second ? 0 : 1;
  return 0.6 + row_period * static_cast<double>(row) + within_row * static_cast<double>(place);
}

/** [us] */
double shotOf(const HesaiLayout& layout, std::size_t laser, bool second)
{
  const double end = 1e6 * layout.azimuth_after;
  if (layout.name == "Pandar40P")
  {
    return end - pandar40_before_end[laser];
  }
  if (layout.name == "Pandar64")
  {
    return end - pandar64_before_end[laser];
  }
  if (layout.name == "QT64")
  {
    return shotOfQt64(laser);
  }
  if (layout.name == "QT128")
  {
    return shotOfQt128(laser, second);
  }
  const double step = layout.name == "XT32"      ? 1.512
                      : layout.name == "XT16"    ? 3.024
                      : layout.name == "XT32M2X" ? 2.888
                                                 : 0;
  // Two lasers of an XT32M2X shoot at a time.
  const std::size_t rank = layout.name == "XT32M2X" ? laser % 16 : laser;
  return step > 0 ? 0.368 + step * static_cast<double>(rank) : 0;
}
}  // namespace

std::vector<double> hesaiShots(const HesaiLayout& layout, bool second)
{
  std::vector<double> shots;
  for (std::size_t laser = 0; laser < layout.lasers; ++laser)
  {
    shots.push_back(1e-6 * shotOf(layout, laser, second));
  }
  return shots;
}
}  // namespace dyslam
