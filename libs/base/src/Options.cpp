// SPDX-License-Identifier: BSD-3-Clause
#include <dyslam/base/Angle.h>
#include <dyslam/base/Error.h>
#include <dyslam/base/Options.h>
#include <dyslam/base/Words.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <utility>

namespace dyslam
{
namespace
{

std::string toText(double value)
{
  std::array<char, 32> buffer{};
  const auto end = std::to_chars(buffer.data(), buffer.data() + buffer.size(), value).ptr;
  return {buffer.data(), end};
}

/** Error message for a value out of range. */
template <typename Number>
void checkRange(const std::string& where, Number value, Number min, Number max)
{
  if (!(value >= min && value <= max))
  {
    throw UserError(where + " = " + toText(static_cast<double>(value)) + " is out of range; use " +
                    toText(static_cast<double>(min)) + " to " + toText(static_cast<double>(max)));
  }
}

void checkWord(const std::string& where,
               const std::string& value,
               const std::vector<std::string>& words)
{
  if (std::find(words.begin(), words.end(), value) == words.end())
  {
    throw UserError(where + ": " + unknownWord("value", value, words));
  }
}

/** Throws UserError for a text that would not be read back unchanged from an ini. */
void checkText(const std::string& where, const std::string& value)
{
  const std::string line = " " + value;
  if (line.find(" //") != std::string::npos || line.find("\t//") != std::string::npos)
  {
    throw UserError(where + " = " + value +
                    ": // begins a comment in ini files; use a text without it");
  }
}

class KeyLister : public OptionsVisitor
{
 public:
  std::vector<std::string> keys;
  std::map<std::string, std::string> present_of_old;  //!< keys that were renamed
  void real(const char* key, double&, double, double, const char*) override
  {
    keys.emplace_back(key);
  }
  void integer(const char* key, int&, int, int, const char*) override { keys.emplace_back(key); }
  void flag(const char* key, bool&, const char*) override { keys.emplace_back(key); }
  void text(const char* key, std::string&, const char*) override { keys.emplace_back(key); }
  void word(const char* key, std::string&, const std::vector<std::string>&, const char*) override
  {
    keys.emplace_back(key);
  }
  void renamed(const char* old_key, const char* key) override { present_of_old[old_key] = key; }
};

class Loader : public OptionsVisitor
{
 public:
  Loader(const Config::Section& values, std::string section)
      : values_(values), section_(std::move(section))
  {
  }

  void real(const char* key, double& value, double min, double max, const char*) override
  {
    if (const auto* given = find(key))
    {
      value = number<double>(*given, key, "a number");
      checkRange(where(*given, key), value, min, max);
    }
  }
  void integer(const char* key, int& value, int min, int max, const char*) override
  {
    if (const auto* given = find(key))
    {
      value = number<int>(*given, key, "a whole number");
      checkRange(where(*given, key), value, min, max);
    }
  }
  void flag(const char* key, bool& value, const char*) override
  {
    if (const auto* given = find(key))
    {
      if (given->text != "true" && given->text != "false")
      {
        throw UserError(where(*given, key) + " = " + given->text +
                        " is not a switch; use true or false");
      }
      value = given->text == "true";
    }
  }
  void text(const char* key, std::string& value, const char*) override
  {
    if (const auto* given = find(key))
    {
      checkText(where(*given, key), given->text);
      value = given->text;
    }
  }
  void word(const char* key,
            std::string& value,
            const std::vector<std::string>& words,
            const char*) override
  {
    if (const auto* given = find(key))
    {
      checkWord(where(*given, key), given->text, words);
      value = given->text;
    }
  }

 private:
  const Config::Value* find(const char* key) const
  {
    const auto found = values_.find(key);
    return found == values_.end() ? nullptr : &found->second;
  }
  std::string where(const Config::Value& value, const char* key) const
  {
    return value.origin + ": [" + section_ + "] " + key;
  }
  template <typename Number>
  Number number(const Config::Value& given, const char* key, const char* kind) const
  {
    Number result{};
    const char* begin = given.text.data();
    const char* end = begin + given.text.size();
    const auto [stop, error] = std::from_chars(begin, end, result);
    if (error != std::errc() || stop != end)
    {
      throw UserError(where(given, key) + " = " + given.text + " is not " + kind);
    }
    return result;
  }

  const Config::Section& values_;
  std::string section_;
};

class Saver : public OptionsVisitor
{
 public:
  Saver(Config& config, std::string section) : config_(config), section_(std::move(section)) {}

  void real(const char* key, double& value, double, double, const char* help) override
  {
    put(key, toText(value), help);
  }
  void integer(const char* key, int& value, int, int, const char* help) override
  {
    put(key, std::to_string(value), help);
  }
  void flag(const char* key, bool& value, const char* help) override
  {
    put(key, value ? "true" : "false", help);
  }
  void text(const char* key, std::string& value, const char* help) override
  {
    put(key, value, help);
  }
  void word(const char* key,
            std::string& value,
            const std::vector<std::string>& words,
            const char* help) override
  {
    put(key, value, std::string(help) + " (" + joined(words) + ")");
  }

 private:
  void put(const char* key, const std::string& value, const std::string& help)
  {
    config_.set(section_, key, {value, "effective", help});
  }
  Config& config_;
  std::string section_;
};

class Checker : public OptionsVisitor
{
 public:
  explicit Checker(std::string section) : section_(std::move(section)) {}
  void real(const char* key, double& value, double min, double max, const char*) override
  {
    checkRange(where(key), value, min, max);
  }
  void integer(const char* key, int& value, int min, int max, const char*) override
  {
    checkRange(where(key), value, min, max);
  }
  void flag(const char*, bool&, const char*) override {}
  void text(const char* key, std::string& value, const char*) override
  {
    checkText(where(key), value);
  }
  void word(const char* key,
            std::string& value,
            const std::vector<std::string>& words,
            const char*) override
  {
    checkWord(where(key), value, words);
  }

 private:
  std::string where(const char* key) const { return "[" + section_ + "] " + key; }
  std::string section_;
};
}  // namespace

void OptionsVisitor::degrees(
    const char* key, double& radians, double min, double max, const char* help)
{
  // 1e-9 deg steps: the round trip through radians would otherwise save 30 as 29.999999999999996.
  const double before = std::round(radians / radians_per_degree * 1e9) / 1e9;
  double value = before;
  real(key, value, min, max, help);
  if (value != before)
  {
    radians = value * radians_per_degree;
  }
}

PrefixedVisitor::PrefixedVisitor(OptionsVisitor& visitor,
                                 std::string prefix,
                                 const std::string& about)
    : visitor_(visitor), prefix_(std::move(prefix)), about_(about + ": ")
{
}

void PrefixedVisitor::real(const char* key, double& value, double min, double max, const char* help)
{
  visitor_.real((prefix_ + key).c_str(), value, min, max, (about_ + help).c_str());
}

void PrefixedVisitor::integer(const char* key, int& value, int min, int max, const char* help)
{
  visitor_.integer((prefix_ + key).c_str(), value, min, max, (about_ + help).c_str());
}

void PrefixedVisitor::flag(const char* key, bool& value, const char* help)
{
  visitor_.flag((prefix_ + key).c_str(), value, (about_ + help).c_str());
}

void PrefixedVisitor::text(const char* key, std::string& value, const char* help)
{
  visitor_.text((prefix_ + key).c_str(), value, (about_ + help).c_str());
}

void PrefixedVisitor::word(const char* key,
                           std::string& value,
                           const std::vector<std::string>& words,
                           const char* help)
{
  visitor_.word((prefix_ + key).c_str(), value, words, (about_ + help).c_str());
}

void PrefixedVisitor::renamed(const char* old_key, const char* key)
{
  visitor_.renamed((prefix_ + old_key).c_str(), (prefix_ + key).c_str());
}

void load(Options& options, const Config& config, const std::string& section)
{
  const auto& values = config.section(section);
  KeyLister lister;
  options.describe(lister);
  for (const auto& [key, value] : values)
  {
    if (std::find(lister.keys.begin(), lister.keys.end(), key) == lister.keys.end())
    {
      const auto old = lister.present_of_old.find(key);
      if (old != lister.present_of_old.end())
      {
        throw UserError(value.origin + ": [" + section + "] " + key + " was renamed to " +
                        old->second);
      }
      throw UnknownSetting(value.origin + ": [" + section + "]: unknown key '" + key + "'",
                           meantWord(key, lister.keys), {"", key, value});
    }
  }
  Loader loader(values, section);
  options.describe(loader);
}

void save(const Options& options, Config& config, const std::string& section)
{
  // describe() takes references for the loader's sake. Saver and Checker only read them, so that
  // nothing is assigned, also if the object is const.
  Saver saver(config, section);
  const_cast<Options&>(options).describe(saver);
}

void validate(const Options& options, const std::string& section)
{
  Checker checker(section);
  const_cast<Options&>(options).describe(checker);
}

void ConfigLoader::requireAllUsed() const
{
  config_.requireKnownSections(used_);
}
}  // namespace dyslam
