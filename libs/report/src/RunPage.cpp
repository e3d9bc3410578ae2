// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Bytes.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/report/RunPage.h>

#include <stdexcept>
#include <string_view>

#include "PackedPoints.h"
#include "RunPageJson.h"

namespace dyslam
{
namespace
{
/** A script element is ended by `</script`, and `<!--` changes its parsing. */
std::string withoutMarkup(const std::string& json)
{
  std::string text;
  text.reserve(json.size());
  for (const char c : json)
  {
    if (c == '<')
    {
      text += "\\u003c";
    }
    else
    {
      text += c;
    }
  }
  return text;
}

/** Replaces the placeholder, which stands in the template once. */
class Template
{
 public:
  explicit Template(const std::string& text) : rest_(text) {}

  /** In the order of the template. */
  void fill(std::string_view placeholder, const std::string& content)
  {
    const auto at = rest_.find(placeholder);
    if (at == std::string_view::npos)
    {
      throw UserError("report/page.html: lacks " + std::string(placeholder) +
                      "; DYSLAM_SHARE must be the share/dyslam of this version");
    }
    result_.append(rest_.substr(0, at)).append(content);
    rest_.remove_prefix(at + placeholder.size());
  }
  [[nodiscard]] std::string finish() { return result_.append(rest_); }

 private:
  std::string_view rest_;
  std::string result_;
};
}  // namespace

void RunPageOptions::describe(OptionsVisitor& v)
{
  v.integer("max_points", max_points, 1, 100000000,
            "most map points in the 3D view of report.html; beyond, they are voxel-sampled");
  v.integer("max_scans", max_scans, 2, 100000000,
            "most scans in the plots of report.html; beyond, only every n-th is drawn");
}

std::string renderRunPage(const RunPage& page,
                          const std::string& page_template,
                          const RunPageOptions& options)
{
  if (page.trajectory.size() != page.scans.size() || page.odometry.size() != page.scans.size())
  {
    throw std::invalid_argument("renderRunPage: not one pose per scan");
  }
  validate(options, "report");
  PackedPoints points;
  if (page.map_points != nullptr)
  {
    points = packPoints(*page.map_points, page.map_intensity,
                        static_cast<std::size_t>(options.max_points));
  }
  const auto json = runPageJson(page, points, static_cast<std::size_t>(options.max_scans));
  Template html(page_template);
  html.fill("@TITLE@", escapedHtml(page.title));
  html.fill("@PICTURE@", base64(bytesOf(page.picture)));
  html.fill("@POINTS@", base64(points.bytes));
  html.fill("@DATA@", withoutMarkup(json.dump(-1, ' ', false,
                                              nlohmann::ordered_json::error_handler_t::replace)));
  return html.finish();
}
}  // namespace dyslam
