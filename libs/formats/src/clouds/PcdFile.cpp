// SPDX-License-Identifier: BSD-3-Clause
#include "PcdFile.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>
#include <dyslam/base/Printable.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "CloudColumns.h"

namespace dyslam
{
namespace
{
struct Field
{
  std::string name;
  CloudNumber type;
  std::uint64_t count = 1;   //!< numbers per point
  std::uint64_t offset = 0;  //!< in a point [bytes]
};

struct PcdHeader
{
  std::vector<std::string> names;
  std::vector<std::string> sizes;
  std::vector<std::string> types;
  std::vector<std::string> counts;
  std::string encoding;
  std::string width = "0";
  std::string height = "1";
  std::string points;
  std::size_t size = 0;  //!< of the text [bytes]
};

/** Reads the next line off the text, without its end. */
std::string_view takeLine(std::string_view& text)
{
  const std::size_t end = std::min(text.find('\n'), text.size());
  std::string_view line = text.substr(0, end);
  text.remove_prefix(std::min(end + 1, text.size()));
  return line;
}

/** \throws UserError "path: is not a PCD file ...". */
[[noreturn]] void failPcdHeader(const std::string& path)
{
  throw UserError(path + ": is not a PCD file: its header is missing or damaged");
}

PcdHeader pcdHeaderOf(std::string_view text, const std::string& path)
{
  const std::size_t whole = text.size();
  PcdHeader header;
  while (header.encoding.empty() && !text.empty())
  {
    std::vector<std::string> words;
    for (const std::string_view word : cloudWords(takeLine(text)))
    {
      words.emplace_back(word);
    }
    if (words.empty() || words[0][0] == '#')
    {
      continue;
    }
    const std::string key = words[0];
    const std::string first = words.size() > 1 ? words[1] : "";
    words.erase(words.begin());
    if (key == "FIELDS" || key == "COLUMNS")
    {
      header.names = words;
    }
    else if (key == "SIZE" || key == "TYPE" || key == "COUNT")
    {
      (key == "SIZE" ? header.sizes : key == "TYPE" ? header.types : header.counts) = words;
    }
    else if (key == "WIDTH" || key == "HEIGHT" || key == "POINTS" || key == "DATA")
    {
      (key == "WIDTH"    ? header.width
       : key == "HEIGHT" ? header.height
       : key == "POINTS" ? header.points
                         : header.encoding) = first;
    }
    else if (key != "VERSION" && key != "VIEWPOINT")
    {
      failPcdHeader(path);
    }
  }
  header.size = whole - text.size();
  if (header.encoding.empty() || header.names.empty())
  {
    failPcdHeader(path);
  }
  return header;
}

/** A number of the header. \throws UserError unless it is whole and below 2^32. */
std::uint64_t numberIn(const std::string& word, const std::string& path)
{
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size())
  {
    throw UserError(path + ": '" + word + "' in its header is not a whole number, or too large");
  }
  return value;
}

/** Some versions of PCL count the bytes of padding before a field with the size of that field
 * instead of the one before it, which may come to none or fewer. Corrects the counts of such a
 * header, which has sizes and counts for all fields. */
void correctPadding(PcdHeader& header, const std::string& path)
{
  const auto countOf = [&](std::size_t field)
  {
    const std::string& word = header.counts[field];
    const bool negative = word[0] == '-';
    const auto count = static_cast<std::int64_t>(numberIn(word.substr(negative ? 1 : 0), path));
    return negative ? -count : count;
  };
  const auto bytesOf = [&](std::size_t field)
  {
    constexpr std::uint64_t largest = sizeof(double);
    return countOf(field) *
           static_cast<std::int64_t>(std::min(numberIn(header.sizes[field], path), largest));
  };
  std::vector<std::size_t> padding;
  bool is_wrong = false;
  for (std::size_t i = 1; i < header.counts.size(); ++i)
  {
    if (header.names[i] == "_")
    {
      padding.push_back(i);
      is_wrong = is_wrong || countOf(i) <= 0;
    }
  }
  std::int64_t moved = 0;  // end of a point's last field [bytes]
  for (std::size_t k = 0; is_wrong && k < padding.size(); ++k)
  {
    const std::size_t field = padding[k];
    const bool at_end = field + 1 == header.counts.size();
    const std::int64_t change = at_end ? -moved : bytesOf(field + 1) - bytesOf(field - 1);
    const std::int64_t count = countOf(field) + change;
    if (count < 0)
    {
      failPcdHeader(path);
    }
    header.counts[field] = std::to_string(count);
    moved += change;
  }
}

std::vector<Field> fieldsOf(PcdHeader header, const std::string& path)
{
  const std::size_t count = header.names.size();
  if (header.sizes.size() != count || header.types.size() != count ||
      (!header.counts.empty() && header.counts.size() != count))
  {
    throw UserError(path + ": its header names " + std::to_string(count) +
                    " fields, but not as many sizes, types and counts");
  }
  if (header.encoding == "binary")  // the others have no padding
  {
    correctPadding(header, path);
  }
  std::vector<Field> fields;
  std::uint64_t offset = 0;
  for (std::size_t i = 0; i < count; ++i)
  {
    Field field;
    field.name = header.names[i];
    field.type.kind = header.types[i] == "F"   ? CloudNumber::Kind::floating
                      : header.types[i] == "I" ? CloudNumber::Kind::signed_integer
                                               : CloudNumber::Kind::unsigned_integer;
    field.type.size = static_cast<std::size_t>(numberIn(header.sizes[i], path));
    if (!field.type.valid() ||
        (header.types[i] != "F" && header.types[i] != "I" && header.types[i] != "U"))
    {
      throw UserError(path + ": field '" + field.name + "' is of a type that cannot be read (" +
                      header.types[i] + header.sizes[i] + "); save it as float32");
    }
    field.count = header.counts.empty() ? 1 : numberIn(header.counts[i], path);
    field.offset = offset;
    offset += field.count * field.type.size;
    fields.push_back(std::move(field));
  }
  return fields;
}

std::uint64_t pointsOf(const PcdHeader& header, const std::string& path)
{
  const std::uint64_t grid = numberIn(header.width, path) * numberIn(header.height, path);
  const std::uint64_t points = header.points.empty() ? grid : numberIn(header.points, path);
  if (grid != points && header.width != "0")
  {
    throw UserError(path + ": its header says " + counted(points, "point") + ", but " +
                    header.width + " x " + header.height);
  }
  return points;
}

[[noreturn]] void failShort(const std::string& path, std::uint64_t points)
{
  throw UserError(path + ": is cut short: its header announces " + counted(points, "point"));
}

/** LZF: runs of bytes, and copies of bytes that came before. */
std::string uncompressed(std::string_view from, std::size_t size, const std::string& path)
{
  const auto damaged = [&path] { return UserError(path + ": its compressed data are damaged"); };
  constexpr std::size_t largest_ratio = 128;
  if (size / largest_ratio > from.size())
  {
    throw damaged();
  }
  std::string to;
  to.reserve(size);
  const auto next = [&]
  {
    if (from.empty())
    {
      throw damaged();
    }
    const auto byte = static_cast<std::uint8_t>(from[0]);
    from.remove_prefix(1);
    return std::size_t{byte};
  };
  while (!from.empty())
  {
    const std::size_t control = next();
    if (control < 32)
    {
      const std::size_t run = control + 1;
      if (run > from.size() || to.size() + run > size)
      {
        throw damaged();
      }
      to.append(from.substr(0, run));
      from.remove_prefix(run);
      continue;
    }
    std::size_t length = (control >> 5U) + 2;
    length += length == 9 ? next() : 0;
    const std::size_t back = ((control & 31U) << 8U) + next() + 1;
    if (back > to.size() || to.size() + length > size)
    {
      throw damaged();
    }
    for (std::size_t i = 0; i < length; ++i)
    {
      to.push_back(to[to.size() - back]);  // may overlap
    }
  }
  if (to.size() != size)
  {
    throw damaged();
  }
  return to;
}

/** All points' first field, then all points' second, and so on. */
std::string compressedData(std::string_view body,
                           std::uint64_t points,
                           std::uint64_t stride,
                           const std::string& path)
{
  std::array<std::uint32_t, 2> sizes{};
  if (body.size() < sizeof sizes)
  {
    failShort(path, points);
  }
  std::memcpy(sizes.data(), body.data(), sizeof sizes);
  body.remove_prefix(sizeof sizes);
  if (body.size() < sizes[0] || stride == 0 || points != sizes[1] / stride ||
      sizes[1] % stride != 0)
  {
    failShort(path, points);
  }
  return uncompressed(body.substr(0, sizes[0]), sizes[1], path);
}

void fillFromText(std::string_view body,
                  const std::vector<Field>& fields,
                  std::uint64_t points,
                  CloudColumns& columns)
{
  std::uint64_t numbers = 0;
  for (const Field& field : fields)
  {
    numbers += field.count;
  }
  if (numbers == 0 || points > body.size() / numbers)  // a digit for each, at least
  {
    failShort(columns.path(), points);
  }
  columns.reserve(points);
  for (std::uint64_t point = 0; point < points;)
  {
    if (body.empty())
    {
      failShort(columns.path(), points);
    }
    const auto words = cloudWords(takeLine(body));
    if (words.empty())
    {
      continue;
    }
    if (words.size() != numbers)
    {
      throw UserError(columns.path() + ": point " + std::to_string(point) + " has " +
                      counted(words.size(), "number") + ", not " + std::to_string(numbers));
    }
    std::size_t word = 0;
    for (std::size_t i = 0; i < fields.size(); ++i)
    {
      if (fields[i].count > 0)
      {
        columns.addText(i, words[word]);
      }
      word += static_cast<std::size_t>(fields[i].count);
    }
    ++point;
  }
}
}  // namespace

Scan readPcd(const std::string& path, FieldConventions& conventions)
{
  const std::string content = readWhole(path);
  const PcdHeader header = pcdHeaderOf(content, path);
  const std::vector<Field> fields = fieldsOf(header, path);
  const std::uint64_t points = pointsOf(header, path);
  CloudColumns columns(path);
  if (header.width != "0")
  {
    columns.setOrder(numberIn(header.height, path), numberIn(header.width, path));
  }
  std::uint64_t stride = 0;
  for (const Field& field : fields)
  {
    columns.declare(field.name, field.type);
    stride += field.count * field.type.size;
  }
  std::string_view body = std::string_view(content).substr(header.size);
  if (header.encoding == "ascii")
  {
    fillFromText(body, fields, points, columns);
    return columns.scan(conventions);
  }
  const bool compressed = header.encoding == "binary_compressed";
  if (!compressed && header.encoding != "binary")
  {
    throw UserError(path + ": '" + header.encoding +
                    "' data cannot be read; save it as ascii, binary or binary_compressed");
  }
  std::string unpacked;
  if (compressed && points > 0)
  {
    unpacked = compressedData(body, points, stride, path);
    body = unpacked;
  }
  if (stride == 0 || points > body.size() / stride)
  {
    failShort(path, points);
  }
  columns.reserve(points);
  for (std::size_t i = 0; i < fields.size(); ++i)
  {
    const Field& field = fields[i];
    const std::uint64_t step = compressed ? field.count * field.type.size : stride;
    const std::uint64_t first = compressed ? field.offset * points : field.offset;
    for (std::uint64_t point = 0; field.count > 0 && columns.wants(i) && point < points; ++point)
    {
      columns.addBytes(i, body.data() + first + point * step);
    }
  }
  return columns.scan(conventions);
}
}  // namespace dyslam
