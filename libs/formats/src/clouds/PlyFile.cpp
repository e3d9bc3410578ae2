// SPDX-License-Identifier: BSD-3-Clause
#include "PlyFile.h"

#include <dyslam/base/Error.h>
#include <dyslam/base/Files.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <vector>

#include "CloudColumns.h"

namespace dyslam
{
namespace
{
struct Property
{
  std::string name;
  CloudNumber type;
  bool list = false;
  CloudNumber count_type;  //!< of a list
};

struct Element
{
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct PlyHeader
{
  std::string encoding;
  std::vector<Element> elements;
  std::size_t size = 0;  //!< of the text [bytes]
};

CloudNumber typeOf(std::string_view word, const std::string& path)
{
  using Kind = CloudNumber::Kind;
  struct Name
  {
    const char* text;
    CloudNumber type;
  };
  static constexpr std::array<Name, 16> names{{{"char", {Kind::signed_integer, 1}},
                                               {"int8", {Kind::signed_integer, 1}},
                                               {"uchar", {Kind::unsigned_integer, 1}},
                                               {"uint8", {Kind::unsigned_integer, 1}},
                                               {"short", {Kind::signed_integer, 2}},
                                               {"int16", {Kind::signed_integer, 2}},
                                               {"ushort", {Kind::unsigned_integer, 2}},
                                               {"uint16", {Kind::unsigned_integer, 2}},
                                               {"int", {Kind::signed_integer, 4}},
                                               {"int32", {Kind::signed_integer, 4}},
                                               {"uint", {Kind::unsigned_integer, 4}},
                                               {"uint32", {Kind::unsigned_integer, 4}},
                                               {"float", {Kind::floating, 4}},
                                               {"float32", {Kind::floating, 4}},
                                               {"double", {Kind::floating, 8}},
                                               {"float64", {Kind::floating, 8}}}};
  for (const Name& name : names)
  {
    if (word == name.text)
    {
      return name.type;
    }
  }
  throw UserError(path + ": '" + std::string(word) + "' in its header is no type of PLY");
}

[[noreturn]] void failPlyHeader(const std::string& path)
{
  throw UserError(path + ": is not a PLY file, or its header is damaged");
}

Element elementOf(const std::vector<std::string_view>& words, const std::string& path)
{
  Element element;
  std::uint32_t count = 0;
  const auto [end, error] =
      std::from_chars(words[2].data(), words[2].data() + words[2].size(), count);
  if (error != std::errc() || end != words[2].data() + words[2].size())
  {
    throw UserError(path + ": '" + std::string(words[2]) +
                    "' in its header is not a whole number, or too large");
  }
  element.name = words[1];
  element.count = count;
  return element;
}

PlyHeader plyHeaderOf(std::string_view text, const std::string& path)
{
  PlyHeader header;
  for (std::size_t at = 0; at < text.size();)
  {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const auto words = cloudWords(text.substr(at, end - at));
    const bool first = at == 0;
    at = end + 1;
    const std::string_view key = words.empty() ? std::string_view() : words[0];
    if (first != (key == "ply"))
    {
      failPlyHeader(path);
    }
    if (key == "format" && words.size() == 3)
    {
      header.encoding = words[1];
    }
    else if (key == "element" && words.size() == 3)
    {
      header.elements.push_back(elementOf(words, path));
    }
    else if (key == "property" && words.size() >= 3 && !header.elements.empty())
    {
      const bool list = words[1] == "list";
      if (words.size() != (list ? 5U : 3U))
      {
        failPlyHeader(path);
      }
      header.elements.back().properties.push_back({std::string(words.back()),
                                                   typeOf(words[words.size() - 2], path), list,
                                                   list ? typeOf(words[2], path) : CloudNumber()});
    }
    else if (key == "end_header")
    {
      header.size = std::min(at, text.size());
      return header;
    }
    else if (!first && key != "comment" && key != "obj_info" && !key.empty())
    {
      failPlyHeader(path);
    }
  }
  failPlyHeader(path);
}

/** The numbers behind the header, one by one. */
class Body
{
 public:
  Body(std::string_view bytes, const PlyHeader& header, const std::string& path)
      : bytes_(bytes),
        text_(header.encoding == "ascii"),
        swapped_(header.encoding == "binary_big_endian"),
        path_(path)
  {
    if (!text_ && !swapped_ && header.encoding != "binary_little_endian")
    {
      throw UserError(path + ": '" + header.encoding +
                      "' data cannot be read; save it as ascii or binary_little_endian");
    }
  }

  void skip(CloudNumber type, std::uint64_t count = 1)
  {
    if (text_)
    {
      for (std::uint64_t i = 0; i < count; ++i)
      {
        (void)word();
      }
      return;
    }
    // A count has 32 bits: the product fits.
    (void)take(count * type.size);
  }
  void read(CloudNumber type, std::size_t field, CloudColumns& columns)
  {
    if (text_)
    {
      columns.addText(field, word());
      return;
    }
    const auto bytes = number(type);
    columns.addBytes(field, bytes.data());
  }
  /** Length of a list. */
  std::uint64_t length(CloudNumber type)
  {
    const double value =
        text_ ? cloudNumber(word(), path_) : cloudNumber(number(type).data(), type);
    constexpr double longest = 4294967295.0;
    if (!(value >= 0 && value <= longest))
    {
      throw UserError(path_ + ": is damaged: a list of " + std::to_string(value) + " numbers");
    }
    return static_cast<std::uint64_t>(value);
  }
  /** The fewest bytes that a number of this type takes. */
  [[nodiscard]] std::uint64_t least(CloudNumber type) const { return text_ ? 1 : type.size; }
  [[nodiscard]] std::uint64_t left() const { return bytes_.size(); }

 private:
  std::string_view take(std::uint64_t count)
  {
    if (count > bytes_.size())
    {
      throw UserError(path_ + ": is cut short");
    }
    const std::string_view part = bytes_.substr(0, static_cast<std::size_t>(count));
    bytes_.remove_prefix(part.size());
    return part;
  }
  std::string_view word()
  {
    constexpr const char* blanks = " \t\r\n";
    (void)take(std::min(bytes_.find_first_not_of(blanks), bytes_.size()));
    if (bytes_.empty())
    {
      throw UserError(path_ + ": is cut short");
    }
    return take(std::min(bytes_.find_first_of(blanks), bytes_.size()));
  }
  /** The bytes of a number, little-endian. */
  std::array<char, 8> number(CloudNumber type)
  {
    std::array<char, 8> bytes{};
    const std::string_view from = take(type.size);
    std::copy(from.begin(), from.end(), bytes.begin());
    if (swapped_)
    {
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(type.size));
    }
    return bytes;
  }

  std::string_view bytes_;
  bool text_;
  bool swapped_;
  const std::string& path_;
};

/** Reads or skips the rows of an element. \param columns null to skip them. */
void passRows(const Element& element, Body& body, CloudColumns* columns, const std::string& path)
{
  std::uint64_t least = 0;
  for (const Property& property : element.properties)
  {
    least += body.least(property.list ? property.count_type : property.type);
  }
  if (element.properties.empty())
  {
    return;
  }
  if (element.count > body.left() / least)
  {
    throw UserError(path + ": is cut short: its header announces " + std::to_string(element.count) +
                    " of " + element.name);
  }
  if (columns != nullptr)
  {
    columns->reserve(element.count);
  }
  for (std::uint64_t row = 0; row < element.count; ++row)
  {
    for (std::size_t i = 0; i < element.properties.size(); ++i)
    {
      const Property& property = element.properties[i];
      if (property.list)
      {
        body.skip(property.type, body.length(property.count_type));
      }
      else if (columns != nullptr && columns->wants(i))
      {
        body.read(property.type, i, *columns);
      }
      else
      {
        body.skip(property.type);
      }
    }
  }
}
}  // namespace

Scan readPly(const std::string& path, FieldConventions& conventions)
{
  const std::string content = readWhole(path);
  const PlyHeader header = plyHeaderOf(content, path);
  Body body(std::string_view(content).substr(header.size), header, path);
  CloudColumns columns(path);
  for (const Element& element : header.elements)
  {
    if (element.name != "vertex")
    {
      passRows(element, body, nullptr, path);
      continue;
    }
    for (const Property& property : element.properties)
    {
      columns.declare(property.list ? "" : property.name, property.type);
    }
    passRows(element, body, &columns, path);
    return columns.scan(conventions);  // what follows is not needed
  }
  throw UserError(path + ": has no vertices");
}
}  // namespace dyslam
