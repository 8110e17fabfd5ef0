// SPDX-License-Identifier: Apache-2.0
#pragma once
/// The mesh of a body: from a file or from a generator by name. The table of generators
/// here is what the scene reader, its JSON Schema and the documentation go by.

#include "noli/result.hpp"
#include "noli/scene.hpp"

#include "mesh/check.hpp"
#include "mesh/mesh.hpp"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace noli {

/// A parameter of a generator: one number, or two or three of a kind.
struct GeneratorParameter {
    enum class Kind {
        Length,        ///< m, > 0
        LengthOrZero,  ///< m, >= 0
        Number,
        Count,  ///< whole number
        Flag,   ///< 1 or 0: true or false
    };
    const char* name;
    Kind kind;
    std::vector<double> fallback;  ///< as many numbers as the parameter has
    double at_least;               ///< of Number and Count, inclusive
    double at_most;                ///< inclusive
    const char* doc;
};

/// The values of all parameters of a generator, given or default.
using GeneratorValues = std::map<std::string, std::vector<double>>;

struct GeneratorEntry {
    const char* name;
    const char* doc;
    std::vector<GeneratorParameter> parameters;
    std::function<Result<Mesh>(const GeneratorValues&)> make;
};

/// All generators, in the order of the documentation.
const std::vector<GeneratorEntry>& generator_table();

/// The entry of that name, or null.
const GeneratorEntry* find_generator(const std::string& name);

/// `path` itself if absolute or if the folder is empty, else folder/path, without "." and
/// "..".
std::string resolve_path(const std::string& path, const std::string& base_folder);

/// Whether read_mesh would find a file: also for TetGen names without extension, and for
/// .seg and .pt beside an .obj of the same name.
bool mesh_file_exists(const std::string& path);

/// What is asked of the mesh of a body: vertices stay as they are in the file, for
/// selections and sequences count them.
CheckOptions body_check_options(bool fix_orientation = false);

/// read_mesh, without segments that only name edges of triangles or boundaries of
/// regions, as Gmsh and MEDIT write them: in other formats they are meant.
Result<Mesh> read_body_mesh(const std::string& path);

/// Reads or generates the mesh, and checks it; vertices keep the order of the file.
/// Warnings of the check are added to `warnings`. Errors: FileNotReadable, BadMesh;
/// InvalidScene for an unknown generator or parameter.
Result<Mesh> load_body_mesh(const MeshSource& source,
                            const std::string& base_folder,
                            std::vector<std::string>* warnings = nullptr);

}  // namespace noli
