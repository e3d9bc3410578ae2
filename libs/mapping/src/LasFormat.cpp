// SPDX-License-Identifier: BSD-3-Clause
// LAS 1.4 R15 (ASPRS), point data record format 6. Debian 12 has no library for it.
#include <dyslam/core/Error.h>

#include <algorithm>
#include <cmath>

#include "CloudFormat.h"

namespace dyslam
{
namespace
{
constexpr double scale = 0.001;  // coordinates are whole millimetres from the offset
constexpr std::uint16_t header_size = 375;
constexpr std::uint16_t vlr_header_size = 54;
constexpr std::uint16_t extra_bytes_size = 192;  // of one description
constexpr std::uint16_t record_size = 30;

void appendText(std::string& out, const std::string& text, std::size_t size)
{
  out += text.substr(0, size);
  out.append(size - std::min(size, text.size()), '\0');
}

/** Describes one float32 behind the record (table 24 of the specification). */
void appendExtraBytes(std::string& out, const std::string& name, const std::string& description)
{
  constexpr char float32 = 9;
  const std::size_t begin = out.size();
  out.append(2, '\0');  // reserved
  out.push_back(float32);
  out.push_back('\0');  // options: no_data, min, max, scale and offset are not stated
  appendText(out, name, 32);
  out.append(extra_bytes_size - 32 - (out.size() - begin - 32) - 32, '\0');
  appendText(out, description, 32);
}

class LasFormat : public CloudFormat
{
 public:
  explicit LasFormat(const CloudLayout& layout) : layout_(layout) {}

  [[nodiscard]] std::string header(const CloudSummary& summary) const override
  {
    const std::uint32_t vlrs = layout_.normals ? 1 : 0;
    const std::uint32_t data_at = header_size + vlrs * (vlr_header_size + 3U * extra_bytes_size);
    std::string out("LASF");
    appendNumber<std::uint16_t>(out, 0);   // file source ID
    appendNumber<std::uint16_t>(out, 16);  // global encoding: a CRS would be WKT, as format 6 wants
    out.append(16, '\0');                  // GUID
    out.push_back(1);
    out.push_back(4);
    appendText(out, "EXTRACTION", 32);
    appendText(out, "DySLAM", 32);
    appendNumber<std::uint16_t>(out, 0);  // day and year of creation: same map, same bytes
    appendNumber<std::uint16_t>(out, 0);
    appendNumber<std::uint16_t>(out, header_size);
    appendNumber<std::uint32_t>(out, data_at);
    appendNumber<std::uint32_t>(out, vlrs);
    out.push_back(6);
    appendNumber<std::uint16_t>(out, static_cast<std::uint16_t>(record_size + 12 * vlrs));
    out.append(24, '\0');  // counts of older versions: 0 for format 6
    appendBounds(out, summary);
    appendNumber<std::uint64_t>(out, 0);  // waveforms
    appendNumber<std::uint64_t>(out, 0);  // extended records, none
    appendNumber<std::uint32_t>(out, 0);
    appendNumber<std::uint64_t>(out, summary.count);
    appendNumber<std::uint64_t>(out, summary.count);  // of first returns
    out.append(14 * sizeof(std::uint64_t), '\0');
    if (layout_.normals)
    {
      appendNormalsRecord(out);
    }
    return out;
  }

  void append(const MapPoints& points, std::size_t i, std::string& out) const override
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      appendNumber(out, wholeSteps(static_cast<double>(points.points[i][axis])));
    }
    constexpr float brightest = 65535;
    const float intensity = std::clamp(points.intensity[i], 0.0F, 1.0F);
    appendNumber(out, static_cast<std::uint16_t>(std::lround(brightest * intensity)));
    constexpr char only_return = 1 | 1 << 4;
    out.push_back(only_return);
    out.push_back(0);                     // flags
    out.push_back(1);                     // class: unclassified
    out.push_back(0);                     // user data
    appendNumber<std::int16_t>(out, 0);   // scan angle
    appendNumber<std::uint16_t>(out, 0);  // point source
    appendNumber<double>(out, 0);         // GPS time
    for (int axis = 0; axis < 3 && layout_.normals; ++axis)
    {
      appendNumber(out, points.normals[i][axis]);
    }
  }

 private:
  static std::int32_t wholeSteps(double metres)
  {
    return static_cast<std::int32_t>(std::lround(metres / scale));
  }

  void appendBounds(std::string& out, const CloudSummary& summary) const
  {
    for (int k = 0; k < 3; ++k)
    {
      appendNumber<double>(out, scale);
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      appendNumber<double>(out, layout_.origin[axis]);
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      // As a reader computes them from the whole steps.
      const auto bound = [&](double v)
      { return summary.count == 0 ? 0.0 : wholeSteps(v) * scale + layout_.origin[axis]; };
      appendNumber<double>(out, bound(summary.high[axis]));
      appendNumber<double>(out, bound(summary.low[axis]));
    }
  }

  static void appendNormalsRecord(std::string& out)
  {
    appendNumber<std::uint16_t>(out, 0);  // reserved
    appendText(out, "LASF_Spec", 16);
    appendNumber<std::uint16_t>(out, 4);  // record ID: extra bytes
    appendNumber<std::uint16_t>(out, 3 * extra_bytes_size);
    appendText(out, "normals", 32);
    appendExtraBytes(out, "NormalX", "towards the sensor");
    appendExtraBytes(out, "NormalY", "towards the sensor");
    appendExtraBytes(out, "NormalZ", "towards the sensor");
  }

  CloudLayout layout_;
};
}  // namespace

std::unique_ptr<CloudFormat> makeLasFormat(const CloudLayout& layout)
{
  return std::make_unique<LasFormat>(layout);
}
}  // namespace dyslam
