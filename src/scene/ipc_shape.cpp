// SPDX-License-Identifier: Apache-2.0
/// The line of a shape in an IPC script.
#include "scene/ipc_script_data.hpp"
#include "scene/suggest.hpp"

#include <fmt/format.h>

namespace noli {

namespace {

ScriptCondition read_condition(ScriptWords& w, bool dirichlet) {
    ScriptCondition c;
    c.box_min = w.vector("a corner of the box");
    c.box_max = w.vector("a corner of the box");
    c.linear = w.vector(dirichlet ? "the velocity" : "the acceleration");
    if (dirichlet) c.angular_deg = w.vector("the angular velocity");
    if (w.number_follows()) c.t_begin = w.number("the begin");
    if (w.number_follows()) c.t_end = w.number("the end");
    return c;
}

void read_extra(ScriptWords& w, ScriptShape& shape) {
    const std::string extra = w.word("");
    if (extra == "material") {
        shape.material = ScriptMaterial{w.number("the density"),
                                        w.number("Young's modulus"),
                                        w.number("Poisson's ratio")};
        check_material(w, *shape.material);
    } else if (extra == "initVel") {
        shape.velocity = w.vector("the initial velocity");
        shape.angular_velocity_deg = w.vector("the initial angular velocity");
    } else if (extra == "linearVelocity") {
        shape.linear = w.vector("the velocity");
    } else if (extra == "angularVelocity") {
        shape.angular_deg = w.vector("the angular velocity");
    } else if (extra == "DBC") {
        shape.dirichlet.push_back(read_condition(w, true));
    } else if (extra == "NBC") {
        shape.neumann.push_back(read_condition(w, false));
    } else if (extra == "meshSeq") {
        shape.sequence_folder = w.word("the folder of the sequence");
    } else {
        const std::vector<std::string> known{"material",
                                             "initVel",
                                             "linearVelocity",
                                             "angularVelocity",
                                             "DBC",
                                             "NBC",
                                             "meshSeq"};
        w.fail(fmt::format("found \"{}\" after a shape, expected {}{}",
                           extra,
                           quoted_list(known),
                           did_you_mean(extra, known)));
    }
}

}  // namespace

void check_material(const ScriptWords& w, const ScriptMaterial& m) {
    require(m.density > 0 && m.young > 0 && m.poisson > -1 && m.poisson < 0.5,
            w,
            fmt::format("found density {}, Young's modulus {}, Poisson's ratio {}, "
                        "expected > 0, > 0 and between "
                        "-1 and 0.5; correct them",
                        m.density,
                        m.young,
                        m.poisson));
}

ScriptShape read_shape(ScriptWords w) {
    ScriptShape shape;
    shape.place = w;
    shape.path = w.word("the path of a mesh");
    shape.translation = w.vector("the translation");
    shape.rotation_deg = w.vector("the rotation in degrees");
    shape.scale = w.vector("the scale");
    while (!w.done())
        read_extra(w, shape);
    return shape;
}

}  // namespace noli
