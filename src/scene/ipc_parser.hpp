// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The work behind parse_script, in three files: ipc_setting_keywords.cpp and
/// ipc_shape_keywords.cpp hold what the keywords mean, ipc_parse.cpp the rest.

#include "scene/ipc_script_data.hpp"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace noli::detail {

class ScriptParser {
  public:
    ScriptParser(const std::string& file, const std::string& text);

    /// Throws ScriptFailure.
    Script parse();

  private:
    using Handler = std::function<void(ScriptWords&)>;

    /// Time, material, solver and when conditions hold.
    void add_setting_keywords();
    void read_energy(ScriptWords& w);
    void read_integration(ScriptWords& w);
    /// Lines up to "section end" count only if interior point is named: it is the only
    /// solver here.
    void read_section(ScriptWords& w);

    /// Contact, friction and planes.
    void add_contact_keywords();

    /// What the scene consists of.
    void add_shape_keywords();
    void read_matrix(ScriptWords& w);
    ScriptWords next_line(const ScriptWords& opening, const char* what);

    void warn_unknown(const std::string& keyword, const ScriptWords& words);

    ScriptLines lines_;
    Script script_;
    std::map<std::string, Handler> keywords_;
    std::vector<std::string> ignored_;
};

}  // namespace noli::detail
