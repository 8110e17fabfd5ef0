// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "noli/result.hpp"
#include "noli/scene.hpp"

#include "scene/json_text.hpp"

#include <string>
#include <vector>

namespace noli {

/// What reading one scene file collects besides the scene.
struct ReadContext {
    std::string file;         ///< as the user named it
    std::string base_folder;  ///< where relative paths of meshes start
    std::vector<Error> errors{};
    std::vector<SceneWarning> warnings{};

    void fail(const std::string& pointer,
              std::string message,
              Error::Code code = Error::Code::InvalidScene) {
        errors.push_back({code, file + ":" + pointer, std::move(message)});
    }
    void warn(const std::string& pointer, std::string message) {
        warnings.push_back({file + ":" + pointer, std::move(message)});
    }
};

/// "-5", "the text \"abc\"", "an object": a value as messages quote it.
std::string found_value(const Json& value);

}  // namespace noli
