// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Error.h>
#include <dyslam/base/Printable.h>
#include <dyslam/formats/RecordingKind.h>
#include <dyslam/formats/TextFile.h>

#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>

namespace dyslam
{
namespace fs = std::filesystem;

TextFile::TextFile(const std::string& path, std::string separators)
    : path_(path), separators_(std::move(separators))
{
  if (isBag(path))
  {
    throw UserError(path + ": " + conversionAdvice(path));
  }
  file_ = openBinary(path);
}

TextFile TextFile::table(const std::string& path)
{
  return TextFile(path, "");
}

bool TextFile::next()
{
  while (nextOrEmpty())
  {
    if (!fields_.empty())
    {
      return true;
    }
  }
  return false;
}

bool TextFile::nextOrEmpty()
{
  while (std::getline(file_, line_))
  {
    if (++line_number_ == 1)
    {
      removeByteOrderMark(line_);
    }
    fields_.clear();
    separators_.empty() ? splitAtCommas() : splitAtSeparators();
    if (fields_.empty() || fields_.front().substr(0, 1) != "#")
    {
      return true;
    }
  }
  requireReadable(file_, path_);
  return false;
}

void TextFile::splitAtSeparators()
{
  const std::string_view view(line_);
  for (std::size_t begin = view.find_first_not_of(separators_); begin != std::string_view::npos;)
  {
    const std::size_t end = view.find_first_of(separators_, begin);
    fields_.push_back(view.substr(begin, end == std::string_view::npos ? end : end - begin));
    begin = end == std::string_view::npos ? end : view.find_first_not_of(separators_, end);
  }
}

void TextFile::splitAtCommas()
{
  std::string_view rest(line_);
  if (!rest.empty() && rest.back() == '\r')
  {
    rest.remove_suffix(1);
  }
  for (bool more = !rest.empty(); more;)
  {
    std::size_t end = 0;
    for (bool quoted = false; end < rest.size() && (quoted || rest[end] != ','); ++end)
    {
      quoted = rest[end] == '"' ? !quoted : quoted;
    }
    std::string_view field = rest.substr(0, end);
    if (field.size() > 1 && field.front() == '"' && field.back() == '"')
    {
      field = field.substr(1, field.size() - 2);
    }
    fields_.push_back(field);
    more = end < rest.size();
    rest.remove_prefix(more ? end + 1 : end);
  }
}

double TextFile::number(std::size_t field) const
{
  const std::string_view text = fields_.at(field);
  const std::optional<double> value = parseNumber<double>(text);
  if (!value)
  {
    fail("'" + std::string(text) + "' is not a number");
  }
  if (!std::isfinite(*value))
  {
    const bool has_digits = text.find_first_of("0123456789") != std::string_view::npos;
    fail("'" + std::string(text) + "' is " +
         (has_digits ? "too large a number" : "not a finite number"));
  }
  return *value;
}

int TextFile::integer(std::size_t field) const
{
  const std::string_view text = fields_.at(field);
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size())
  {
    fail("'" + std::string(text) + "' is not a whole number");
  }
  return value;
}

int TextFile::integerPart(std::size_t field) const
{
  const double value = number(field);
  if (std::abs(value) > std::numeric_limits<int>::max())
  {
    fail("'" + std::string(fields_.at(field)) + "' is too large a number");
  }
  return static_cast<int>(value);
}

std::vector<double> TextFile::numbers(std::size_t first) const
{
  std::vector<double> values;
  for (std::size_t i = first; i < fields_.size(); ++i)
  {
    values.push_back(number(i));
  }
  return values;
}

void TextFile::requireFields(std::size_t count, const char* what) const
{
  if (fields_.size() != count)
  {
    fail("has " + counted(fields_.size(), "field") + ", needs " + std::to_string(count) + " (" +
         what + ")");
  }
}

std::string TextFile::position() const
{
  return path_ + ":" + std::to_string(line_number_);
}

void TextFile::fail(const std::string& what) const
{
  throw UserError(position() + ": " + what);
}

void removeByteOrderMark(std::string& text)
{
  constexpr std::string_view mark = "\xEF\xBB\xBF";
  if (text.compare(0, mark.size(), mark) == 0)
  {
    text.erase(0, mark.size());
  }
}

void appendNumber(std::string& text, double value, int digits)
{
  std::array<char, 40> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::general, digits)
                       .ptr;
  text.append(buffer.data(), end);
}

void appendFixed(std::string& text, double value, int decimals)
{
  std::array<char, 350> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value,
                                 std::chars_format::fixed, decimals)
                       .ptr;
  text.append(buffer.data(), end);
}

std::string numberedName(std::size_t number, const std::string& extension)
{
  std::string digits = std::to_string(number);
  return std::string(digits.size() < 6 ? 6 - digits.size() : 0, '0') + digits + extension;
}

std::string numberedPath(const std::string& folder,
                         std::size_t number,
                         const std::string& extension)
{
  return (std::filesystem::path(folder) / numberedName(number, extension)).string();
}

std::optional<int> numberOfName(const std::string& name, const std::string& extension)
{
  const std::filesystem::path path(name);
  const std::string digits = path.stem().string();
  int number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  const bool numbered = error == std::errc() && end == digits.data() + digits.size() && number >= 0;
  return numbered && path.extension() == extension ? std::optional<int>(number) : std::nullopt;
}
}  // namespace dyslam
