// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/packets/HesaiPackets.h>

#include <array>
#include <fstream>
#include <sstream>

namespace dyslam
{
namespace
{
// Angles of the lasers [deg] after the maker's angle correction files of each model.
constexpr std::array<double, 40> pandar40_elevations{
    15,    11,    8,     5,  3,     2,     1.67, 1.33,  1,     0.67, 0.33,  0,     -0.33, -0.67,
    -1,    -1.33, -1.66, -2, -2.33, -2.67, -3,   -3.33, -3.67, -4,   -4.33, -4.67, -5,    -5.33,
    -5.67, -6,    -7,    -8, -9,    -10,   -11,  -12,   -13,   -14,  -19,   -25};
constexpr std::array<double, 64> pandar64_elevations{
    14.882, 11.032, 8.059,  5.057,   3.04,    2.028,   1.86,   1.688,   1.522,  1.351,  1.184,
    1.013,  0.846,  0.675,  0.508,   0.337,   0.169,   0,      -0.169,  -0.337, -0.508, -0.675,
    -0.845, -1.013, -1.184, -1.351,  -1.522,  -1.688,  -1.86,  -2.028,  -2.198, -2.365, -2.536,
    -2.7,   -2.873, -3.04,  -3.21,   -3.375,  -3.548,  -3.712, -3.884,  -4.05,  -4.221, -4.385,
    -4.558, -4.72,  -4.892, -5.057,  -5.229,  -5.391,  -5.565, -5.726,  -5.898, -6.061, -7.063,
    -8.059, -9.06,  -9.885, -11.032, -12.006, -12.974, -13.93, -18.889, -24.897};
constexpr std::array<double, 64> qt64_elevations{
    -52.121, -49.785, -47.577, -45.477, -43.465, -41.528, -39.653, -37.831, -36.055, -34.320,
    -32.619, -30.950, -29.308, -27.690, -26.094, -24.517, -22.964, -21.420, -19.889, -18.372,
    -16.865, -15.368, -13.880, -12.399, -10.925, -9.457,  -7.994,  -6.535,  -5.079,  -3.626,
    -2.175,  -0.725,  0.725,   2.175,   3.626,   5.079,   6.534,   7.993,   9.456,   10.923,
    12.397,  13.877,  15.365,  16.861,  18.368,  19.885,  21.415,  22.959,  24.524,  26.101,
    27.697,  29.315,  30.957,  32.627,  34.328,  36.064,  37.840,  39.662,  41.537,  43.475,
    45.487,  47.587,  49.795,  52.133};
constexpr std::array<double, 64> qt64_azimuths{
    8.736,  8.314,  7.964,  7.669,  7.417,  7.198,  7.007,  6.838,  6.688,  6.554,  6.434,
    6.326,  6.228,  6.140,  6.059,  5.987,  -5.270, -5.216, -5.167, -5.123, -5.083, -5.047,
    -5.016, -4.988, -4.963, -4.942, -4.924, -4.910, -4.898, -4.889, -4.884, -4.881, 5.493,
    5.496,  5.502,  5.512,  5.525,  5.541,  5.561,  5.584,  5.611,  5.642,  5.676,  5.716,
    5.759,  5.808,  5.862,  5.921,  -5.330, -5.396, -5.469, -5.550, -5.640, -5.740, -5.850,
    -5.974, -6.113, -6.269, -6.447, -6.651, -6.887, -7.163, -7.493, -7.892};

/** The columns of lasers stand 2.083 deg apart: most beams in turn, the steep ones in the middle
 * one. */
double pandar40Azimuth(std::size_t laser)
{
  constexpr std::array<double, 3> columns{3.125, -5.208, -1.042};
  return laser < 6 || laser >= 30 ? -1.042 : columns[laser % 3];
}

double pandar64Azimuth(std::size_t laser)
{
  constexpr std::array<double, 6> columns{1.042, 3.125, 5.208, -5.208, -3.125, -1.042};
  return laser < 6 || laser >= 54 ? -1.042 : columns[laser % 6];
}

void append(HesaiAngles& angles, double elevation, double azimuth)
{
  angles.elevations.push_back(radians_per_degree * elevation);
  angles.azimuths.push_back(radians_per_degree * azimuth);
}
}  // namespace

std::optional<HesaiAngles> designedHesaiAngles(const HesaiLayout& layout)
{
  HesaiAngles angles;
  for (std::size_t i = 0; i < layout.lasers; ++i)
  {
    const auto rank = static_cast<double>(i);
    if (layout.name == "Pandar40P")
    {
      append(angles, pandar40_elevations[i], pandar40Azimuth(i));
    }
    else if (layout.name == "Pandar64")
    {
      append(angles, pandar64_elevations[i], pandar64Azimuth(i));
    }
    else if (layout.name == "QT64")
    {
      append(angles, qt64_elevations[i], qt64_azimuths[i]);
    }
    else if (layout.name == "XT32M2X")
    {
      append(angles, 19.5 - 1.3 * rank, 0);
    }
    else if (layout.name == "XT16" || layout.name == "XT32")
    {
      append(angles, 15 - (layout.lasers == 16 ? 2 : 1) * rank, 0);
    }
    else
    {
      return std::nullopt;
    }
  }
  return angles;
}

HesaiAngles readHesaiAngles(const std::string& path, std::size_t lasers)
{
  std::ifstream file = openBinary(path);
  HesaiAngles angles;
  std::string line;
  while (std::getline(file, line))
  {
    std::istringstream fields(line);
    std::size_t channel = 0;
    double elevation = 0;
    double azimuth = 0;
    char comma_1 = 0;
    char comma_2 = 0;
    const bool has_angles =
        static_cast<bool>(fields >> channel >> comma_1 >> elevation >> comma_2 >> azimuth) &&
        comma_1 == ',' && comma_2 == ',';
    if (!has_angles)
    {
      continue;  // the title, or what some models have before or behind the angles
    }
    if (channel != angles.elevations.size() + 1)
    {
      throw UserError(path + ": channel " + std::to_string(channel) + " follows channel " +
                      std::to_string(angles.elevations.size()) +
                      "; use the maker's angle correction file as it is");
    }
    append(angles, elevation, azimuth);
  }
  requireReadable(file, path);
  if (angles.elevations.size() != lasers)
  {
    throw UserError(path + ": has the angles of " + std::to_string(angles.elevations.size()) +
                    " lasers, and the lidar has " + std::to_string(lasers) +
                    "; use the angle correction file of this lidar (channel,elevation,azimuth)");
  }
  return angles;
}
}  // namespace dyslam
