// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/ScanTable.h>
#include <dyslam/formats/TextFile.h>

#include <algorithm>
#include <charconv>
#include <string_view>

namespace dyslam
{
namespace
{
/** A CSV table with the names of its columns in the first line. */
class ScanTableFile
{
 public:
  explicit ScanTableFile(const std::string& path)
      : path_(path),
        file_(TextFile::table(path)),
        columns_(file_.next() ? file_.fields().size() : 0)
  {
  }
  /** Index of a column, to be called before next(). \throws UserError if there is none. */
  [[nodiscard]] std::size_t column(const char* name) const
  {
    const auto found = std::find(file_.fields().begin(), file_.fields().end(), name);
    if (found == file_.fields().end())
    {
      throw UserError(path_ + ": has no column '" + name + "'; is it the table of a run?");
    }
    return static_cast<std::size_t>(found - file_.fields().begin());
  }
  /** Reads the next row. \throws UserError for another number of fields than in the first line. */
  [[nodiscard]] bool next()
  {
    if (!file_.next())
    {
      return false;
    }
    if (file_.fields().size() != columns_)
    {
      file_.fail("has " + counted(file_.fields().size(), "field") + ", not " +
                 std::to_string(columns_) + " as the first line");
    }
    return true;
  }
  [[nodiscard]] std::string_view text(std::size_t column) const { return file_.fields()[column]; }
  [[nodiscard]] double number(std::size_t column) const { return file_.number(column); }
  /** A field as a number of a scan or of points. \throws UserError. */
  [[nodiscard]] std::size_t count(std::size_t column) const
  {
    const std::string_view text = file_.fields()[column];
    std::size_t value = 0;
    const auto parsed = std::from_chars(text.data(), text.data() + text.size(), value);
    if (parsed.ec != std::errc() || parsed.ptr != text.data() + text.size())
    {
      file_.fail("'" + std::string(text) + "' is not a whole number");
    }
    return value;
  }

 private:
  std::string path_;
  TextFile file_;
  std::size_t columns_;
};
}  // namespace

std::set<std::size_t> unregisteredScans(const std::string& path)
{
  ScanTableFile file(path);
  const std::size_t frame = file.column("frame");
  const std::size_t registered = file.column("registered");
  std::set<std::size_t> scans;
  while (file.next())
  {
    const std::size_t scan = file.count(frame);
    if (file.text(registered) == "0")
    {
      scans.insert(scan);
    }
  }
  return scans;
}

std::vector<ScanPartRow> readScanParts(const std::string& path)
{
  ScanTableFile file(path);
  const std::size_t frame = file.column("frame");
  const std::size_t label = file.column("sensor_label");
  const std::size_t stamp = file.column("stamp");
  const std::size_t points = file.column("points");
  std::vector<ScanPartRow> rows;
  while (file.next())
  {
    rows.push_back(
        {file.count(frame), std::string(file.text(label)), file.number(stamp), file.count(points)});
  }
  return rows;
}
}  // namespace dyslam
