// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <dyslam/base/Error.h>

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace dyslam
{
/** Text values of an ini file by section and key, each with its origin.
 *
 * The syntax is MRPT's ini (`[section]`, `key = value // comment`, lines opening with `;`, `#` or
 * `//` are comments) read strictly: junk lines and repeated keys are errors. Two keys may stand
 * before the first section: `include = FILE` includes another ini (of the same folder, or a shipped
 * one), whose values the file may override, and may be repeated; `program = NAME` is the program,
 * or one command of it, that the ini is for.
 */
class Config
{
 public:
  struct Value
  {
    std::string text;
    std::string origin;   //!< for error messages: "kitti64.ini:12" or "--set odometry.method"
    std::string comment;  //!< text that toIni() writes behind the value, after " // "
  };
  using Section = std::map<std::string, Value>;

  /** \throws UserError naming file, line and fix; also for an empty file. */
  [[nodiscard]] static Config fromFile(const std::string& path);
  [[nodiscard]] static Config fromText(const std::string& text, const std::string& name);

  /** Merges another config: its values replace those of this one. */
  void merge(const Config& other);

  /** \param program with its command if it has any: "dyslam", "dyslam-train dylo"; an ini for
   * "dyslam-train" is for all commands of that program \throws UserError if the ini is for another
   * program or command. */
  void requireFor(const std::string& program) const;

  /** Sets the value of one `section.key=value`, as given to --set; replaces a value from the file.
   * \throws UserError. */
  void set(const std::string& assignment);
  void set(const std::string& section, const std::string& key, Value value);

  [[nodiscard]] bool has(const std::string& section, const std::string& key) const;
  /** Text of a value; nothing if the config does not have it. */
  [[nodiscard]] std::optional<std::string> text(const std::string& section,
                                                const std::string& key) const;
  /** The section; an empty one if the file has none. */
  [[nodiscard]] const Section& section(const std::string& name) const;
  [[nodiscard]] std::vector<std::string> sectionNames() const;

  /** \throws UnknownSetting for a section that is not among `known`, naming the program that has
   * it, or the nearest. */
  void requireKnownSections(const std::vector<std::string>& known) const;

  /** \param program as of requireFor() \throws UserError for a section that belongs to another
   * program or command, naming both. */
  void requireSectionsFor(const std::string& program) const;

  /** The config as an ini text, sections and keys in the order they were first set. */
  [[nodiscard]] std::string toIni() const;

 private:
  struct Parser;

  std::map<std::string, Section> sections_;
  std::vector<std::string> section_order_;
  std::map<std::string, std::vector<std::string>> key_order_;
  std::map<std::string, std::string> section_origin_;
  Value program_;  //!< program that the ini is for; empty text: any
};

/** The program, or its command, that a section belongs to: "dyslam", "dyslam-train", "dyslam-train
 * dylo"; empty for a section that is not known. Other programs may have sections of dyslam, too. */
[[nodiscard]] std::string programOfSection(const std::string& section);

/** A key that its section does not have, or a section that the program does not have. */
class UnknownSetting : public UserError
{
 public:
  struct Unknown
  {
    std::string section;  //!< empty: the section is known
    std::string key;      //!< empty: a section with no key, or with several
    Config::Value value;
  };
  /** \param what what is unknown, with its origin: "a.ini:3: [map]: unknown key 'x'"
   * \param advice what may have been meant; follows `what` in the message */
  UnknownSetting(const std::string& what, const std::string& advice, Unknown unknown);

  /** The error, which names the sections of `known` that have such a key, if there are any:
   * "a.ini:3: [map]: unknown key 'x'; 'x' is a key of [map_export]", with the right --set if it was
   * given so. Without them if the section is like one that has the key.
   * \param known config with every section and key of the program */
  [[nodiscard]] UserError withSectionsOf(const Config& known) const;

 private:
  std::string what_;
  Unknown unknown_;
};

/** Whether an error message is about a value of --set or of the ini `ini`: it begins with the
 * origin of the value. \param ini path; empty: none */
[[nodiscard]] bool isAboutSettings(const std::string& message, const std::string& ini);
}  // namespace dyslam
