// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Config.h>

#include <algorithm>
#include <initializer_list>
#include <string>
#include <utility>
#include <vector>

namespace dyslam
{
/** Visitor of every field of an options struct: loading, saving and checking are visitors.
 *
 * A help text must be clear by itself, in effective.ini: quantity of what, condition [unit]. */
class OptionsVisitor
{
 public:
  virtual ~OptionsVisitor() = default;
  /** A number within [min, max]. */
  virtual void real(const char* key, double& value, double min, double max, const char* help) = 0;
  virtual void integer(const char* key, int& value, int min, int max, const char* help) = 0;
  virtual void flag(const char* key, bool& value, const char* help) = 0;
  virtual void text(const char* key, std::string& value, const char* help) = 0;
  /** A text that has to be one of `words`. */
  virtual void word(const char* key,
                    std::string& value,
                    const std::vector<std::string>& words,
                    const char* help) = 0;

  /** A key of earlier versions: where it is given, load() names the present one. */
  virtual void renamed(const char* /*old_key*/, const char* /*key*/) {}

  /** Radians in code, degrees in the file, where the bounds are degrees, too: the key ends in
   * `_deg`, `_deg_s`, `_deg_s2` or `_deg_m`. */
  void degrees(const char* key, double& radians, double min, double max, const char* help);

  template <typename Enum>
  void choice(const char* key,
              Enum& value,
              std::initializer_list<std::pair<const char*, Enum>> names,
              const char* help);
};

/** Describes an options struct within another one: prepends a prefix to every key, and to every
 * help text what it is about ("vehicles: ..."). */
class PrefixedVisitor : public OptionsVisitor
{
 public:
  PrefixedVisitor(OptionsVisitor& visitor, std::string prefix, const std::string& about);
  void real(const char* key, double& value, double min, double max, const char* help) override;
  void integer(const char* key, int& value, int min, int max, const char* help) override;
  void flag(const char* key, bool& value, const char* help) override;
  void text(const char* key, std::string& value, const char* help) override;
  void word(const char* key,
            std::string& value,
            const std::vector<std::string>& words,
            const char* help) override;
  void renamed(const char* old_key, const char* key) override;

 private:
  OptionsVisitor& visitor_;
  std::string prefix_;
  std::string about_;
};

/** Base of every options struct: defaults stand in the declaration, describe() names each field
 * once.
 *
 * Strict loading (unknown keys, bad values and values out of range are errors), saving with help
 * texts, and range checks all use describe(), so that they cannot drift apart.
 */
struct Options
{
  virtual ~Options() = default;
  /** Passes each field to the visitor. Assigns to a field only what a visitor has changed: save()
   * and validate() also describe objects that are const. */
  virtual void describe(OptionsVisitor& visitor) = 0;
};

/** Fill `options` from a section; keys not in the file keep their values.
 * \throws UnknownSetting for an unknown key, UserError for a renamed key, and for a value that does
 * not parse or is out of range. */
void load(Options& options, const Config& config, const std::string& section);

/** Write every field with its help text into a section. Reading it back gives equal values. */
void save(const Options& options, Config& config, const std::string& section);

/** \throws UserError naming the key whose value is out of range (for options set in code). */
void validate(const Options& options, const std::string& section);

/** Loads the options of one config and records which sections were requested. */
class ConfigLoader
{
 public:
  explicit ConfigLoader(const Config& config) : config_(config) {}

  /** Load a section into T's options and add it to the effective config. */
  template <typename T>
  [[nodiscard]] T get(const std::string& section);

  /** \throws UnknownSetting if the config has a section that was never requested. */
  void requireAllUsed() const;
  /** Config with every requested section and the values in effect. */
  [[nodiscard]] const Config& effective() const { return effective_; }

 private:
  const Config& config_;
  Config effective_;
  std::vector<std::string> used_;
};

/** Loads all options of a program: calls `load(loader)`, which gets them from a loader of `config`.
 * \return the effective config \throws UserError for a section that `load` does not get, and for a
 * key that its section does not have; it names the sections that have such a key. */
template <typename Load>
Config loadAll(const Config& config, const Load& load);

template <typename Enum>
void OptionsVisitor::choice(const char* key,
                            Enum& value,
                            std::initializer_list<std::pair<const char*, Enum>> names,
                            const char* help)
{
  std::vector<std::string> words;
  std::string current;
  for (const auto& [name, candidate] : names)
  {
    words.emplace_back(name);
    if (candidate == value)
    {
      current = name;
    }
  }
  const std::string before = current;
  word(key, current, words, help);
  for (const auto& [name, candidate] : names)
  {
    if (current != before && current == name)
    {
      value = candidate;
    }
  }
}

template <typename T>
T ConfigLoader::get(const std::string& section)
{
  T options;
  load(options, config_, section);
  save(options, effective_, section);
  if (std::find(used_.begin(), used_.end(), section) == used_.end())
  {
    used_.push_back(section);
  }
  return options;
}

template <typename Load>
Config loadAll(const Config& config, const Load& load)
{
  try
  {
    ConfigLoader loader(config);
    load(loader);
    loader.requireAllUsed();
    return loader.effective();
  }
  catch (const UnknownSetting& error)
  {
    const Config none;
    ConfigLoader defaults(none);
    load(defaults);
    throw error.withSectionsOf(defaults.effective());
  }
}
}  // namespace dyslam
