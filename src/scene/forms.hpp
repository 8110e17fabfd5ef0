// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Keys of a scene whose JSON is not simply the fields of a struct. Each form reads
/// (complaining into the context), writes (null: nothing to write) and gives its JSON
/// Schema.

#include "noli/scene.hpp"

#include "scene/json_text.hpp"
#include "scene/read_context.hpp"

#include <string>

namespace noli {

/// "ball.msh", {"file": ...} or {"generator": ..., parameters}.
struct MeshForm {
    static void read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     MeshSource& mesh);
    static Json write(const MeshSource& mesh);
    static Json schema();
};

/// {"scale", "rotate_deg", "translate"} or {"matrix"}.
struct TransformForm {
    static void read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     Affine& affine);
    static Json write(const Affine& affine);
    static Json schema();
};

/// "rubber" or {"preset", "model", "density", "young", "poisson", "gipc_lame"}.
struct MaterialForm {
    static void read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     Material& material);
    static Json write(const Material& material);
    static Json schema();
};

/// {"box": [min, max], "frame", "surface_only"} or {"vertices": [...]}.
struct SelectForm {
    static void read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     Selection& selection);
    static Json write(const Selection& selection);
    static Json schema();
};

/// {"subject", "axis", "above" or "below", "then"}.
struct UntilForm {
    using Value = std::optional<BoundaryCondition::Until>;
    static void read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     Value& until);
    static Json write(const Value& until);
    static Json schema();
};

/// {"count": [nx, ny, nz], "spacing": [sx, sy, sz]}.
struct GridForm {
    static void read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     Body& body);
    static Json write(const Body& body);
    static Json schema();
};

/// A name: always written, so that unnamed things stay unnamed.
struct NameForm {
    static void read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     std::string& name);
    static Json write(const std::string& name) { return name; }
    static Json schema() { return Json{{"type", "string"}}; }
};

/// Any text; always written, so that an empty one stays empty.
struct TitleForm {
    static void read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     std::string& text);
    static Json write(const std::string& text) { return text; }
    static Json schema() { return Json{{"type", "string"}}; }
};

/// The end of a time window; never written when it never comes.
struct EndForm {
    static void read(ReadContext& context,
                     const Json& json,
                     const std::string& pointer,
                     double& time);
    static Json write(double time) { return time < kForever ? Json(time) : Json(); }
    static Json schema();
};

}  // namespace noli
