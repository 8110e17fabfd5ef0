// SPDX-License-Identifier: Apache-2.0
/// IPC scripts line by line: keywords that count, that do not, and that nobody knows.
#include "scene/ipc_parser.hpp"
#include "scene/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace noli {

namespace detail {

namespace {

/// Keywords that change nothing in the result here: viewing, and the other program's own
/// solver.
const std::vector<std::string>& ignored_keywords() {
    static const std::vector<std::string> words{"view",
                                                "zoom",
                                                "cameraTracking",
                                                "playBackSpeed",
                                                "appendStr",
                                                "disableCout",
                                                "warmStart",
                                                "CCDMethod",
                                                "ccdMethod",
                                                "CCDTolerance",
                                                "linearSolver",
                                                "linSysSolver",
                                                "constraintType",
                                                "constraintOffset",
                                                "QPSolver",
                                                "useActiveSetConvergence",
                                                "noActiveSetConvergence"};
    return words;
}

bool is_ignored(const std::string& keyword) {
    const std::vector<std::string>& words = ignored_keywords();
    return std::find(words.begin(), words.end(), keyword) != words.end();
}

}  // namespace

ScriptParser::ScriptParser(const std::string& file, const std::string& text)
    : lines_(file, text) {
    script_.file = file;
    add_setting_keywords();
    add_shape_keywords();
    add_contact_keywords();
}

Script ScriptParser::parse() {
    ScriptWords words;
    while (lines_.next(words)) {
        const std::string keyword = words.word("a keyword");
        if (const auto found = keywords_.find(keyword); found != keywords_.end())
            found->second(words);
        else if (is_ignored(keyword))
            ignored_.push_back(keyword);
        else
            warn_unknown(keyword, words);
    }
    if (!ignored_.empty())
        script_.warnings.push_back(
            {script_.file,
             fmt::format("{} concern viewing or another program's solver; ignored",
                         fmt::join(ignored_, ", "))});
    return std::move(script_);
}

void ScriptParser::warn_unknown(const std::string& keyword, const ScriptWords& words) {
    std::vector<std::string> known = ignored_keywords();
    for (const auto& [name, handler] : keywords_)
        known.push_back(name);
    script_.warnings.push_back(
        {words.where(),
         fmt::format("found the unknown keyword \"{}\"{}; the line is skipped",
                     keyword,
                     did_you_mean(keyword, known))});
}

}  // namespace detail

Script parse_script(const std::string& file, const std::string& text) {
    return detail::ScriptParser(file, text).parse();
}

}  // namespace noli
