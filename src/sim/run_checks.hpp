// SPDX-License-Identifier: Apache-2.0
#pragma once
/// What may keep a run from starting, and what it then says.

#include "noli/simulator.hpp"

#include <string>

namespace noli {

/// An error about the run directory.
Error wrong_directory(const std::string& where, const std::string& message);

/// What is wrong with the options or the output settings.
Status check_request(const Scene& scene, const RunOptions& options);

/// May this run use what stands at the path of its directory?
Status admit_directory(const RunOptions& options);

/// The intersections of an initial state, or else its inversions, as an error.
Error initial_contact(const Scene& scene, const VerifyReport& report);

}  // namespace noli
