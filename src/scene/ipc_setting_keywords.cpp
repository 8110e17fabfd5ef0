// SPDX-License-Identifier: Apache-2.0
/// Keywords of an IPC script that set something: time, material, solver, contact.
#include "scene/ipc_parser.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace noli::detail {

namespace {

bool is_interior_point(const std::string& name) {
    return name == "interiorPoint" || name == "IP";
}

void read_solver(ScriptWords& w) {
    const std::string name = w.word("interiorPoint");
    if (!is_interior_point(name))
        w.fail(fmt::format("found constraintSolver {}, expected interiorPoint: QP "
                           "and SQP contact cannot promise "
                           "freedom from intersections; write \"constraintSolver "
                           "interiorPoint\"",
                           name),
               Error::Code::Unsupported);
}

ScriptTimeRange read_range(ScriptWords& w) {
    const double begin = w.number("the begin");
    return {begin, w.number("the end")};
}

}  // namespace

void ScriptParser::add_setting_keywords() {
    keywords_["energy"] = [this](ScriptWords& w) { read_energy(w); };
    keywords_["timeIntegration"] = [this](ScriptWords& w) { read_integration(w); };
    keywords_["size"] = [this](ScriptWords& w) {
        script_.size = w.number("the largest extent");
    };
    keywords_["time"] = [this](ScriptWords& w) {
        script_.duration = w.number("the duration");
        script_.dt = w.number("the time step");
        require(script_.duration > 0 && script_.dt > 0,
                w,
                fmt::format("found a duration of {} s and a step of {} s, expected "
                            "both > 0; correct them",
                            script_.duration,
                            script_.dt));
    };
    keywords_["density"] = [this](ScriptWords& w) {
        script_.material.density = w.number("the density");
        check_material(w, script_.material);
    };
    keywords_["stiffness"] = [this](ScriptWords& w) {
        script_.material.young = w.number("Young's modulus");
        script_.material.poisson = w.number("Poisson's ratio");
        check_material(w, script_.material);
    };
    keywords_["turnOffGravity"] = [this](ScriptWords&) { script_.gravity = false; };
    keywords_["dampingStiff"] = [this](ScriptWords& w) {
        script_.damping_stiff = w.number("the damping");
    };
    keywords_["dampingRatio"] = [this](ScriptWords& w) {
        script_.damping_ratio = w.number("the ratio");
    };
    keywords_["script"] = [this](ScriptWords& w) {
        script_.animation = w.word("the name of an animation");
        script_.animation_words = w;
    };
    keywords_["handleRatio"] = [this](ScriptWords& w) {
        script_.handle_ratio = w.number("the ratio");
    };
    keywords_["DBCTimeRange"] = [this](ScriptWords& w) {
        script_.dirichlet_range = read_range(w);
    };
    keywords_["NBCTimeRange"] = [this](ScriptWords& w) {
        script_.neumann_range = read_range(w);
    };
    keywords_["constraintSolver"] = [this](ScriptWords& w) { read_solver(w); };
    keywords_["restart"] = [](ScriptWords& w) {
        w.fail(
            "found \"restart\", the state files of another program cannot be read; "
            "remove the line to "
            "start from the beginning",
            Error::Code::Unsupported);
    };
    keywords_["section"] = [this](ScriptWords& w) { read_section(w); };
}

void ScriptParser::read_energy(ScriptWords& w) {
    const std::string name = w.word("NH or FCR");
    if (name != "NH" && name != "FCR")
        w.fail(
            fmt::format("found the energy \"{}\", expected NH or FCR; choose one", name),
            Error::Code::Unsupported);
    script_.energy =
        name == "NH" ? Material::Model::NeoHookean : Material::Model::FixedCorotated;
}

void ScriptParser::read_integration(ScriptWords& w) {
    const std::string name = w.word("BE or NM");
    if (name != "BE" && name != "NM")
        w.fail(
            fmt::format(
                "found the time integration \"{}\", expected BE or NM; choose one", name),
            Error::Code::Unsupported);
    script_.integrator = name == "BE" ? Integrator::ImplicitEuler : Integrator::Newmark;
    if (name == "NM" && w.number_follows()) {
        script_.newmark_beta = w.number("beta");
        script_.newmark_gamma = w.number("gamma");
    }
}

void ScriptParser::read_section(ScriptWords& w) {
    bool ours = w.done() || w.peek() == "end";
    while (!w.done())
        ours = is_interior_point(w.word("a solver")) || ours;
    if (ours) return;
    ScriptWords line;
    while (lines_.next(line))
        if (line.word("") == "section" && (line.done() || line.peek() == "end")) return;
}

void ScriptParser::add_contact_keywords() {
    keywords_["ground"] = [this](ScriptWords& w) {
        const double friction = w.number("the friction");
        const double y = w.number("the height");
        script_.half_spaces.push_back({"", {0, y, 0}, {0, 1, 0}, friction});
    };
    keywords_["halfSpace"] = [this](ScriptWords& w) {
        const Vector3 point = w.vector("the origin");
        const Vector3 normal = w.vector("the normal");
        w.number("the stiffness");  // unused there too
        script_.half_spaces.push_back({"", point, normal, w.number("the friction")});
        require(normal != Vector3{},
                w,
                "found the normal 0 0 0, expected a direction; correct it");
    };
    keywords_["selfCollisionOn"] = [this](ScriptWords&) {
        script_.self_collision = true;
    };
    keywords_["selfCollisionOff"] = [this](ScriptWords&) {
        script_.self_collision = false;
    };
    keywords_["selfFric"] = [this](ScriptWords& w) {
        script_.self_friction = w.number("the friction");
    };
    keywords_["dHat"] = [this](ScriptWords& w) {
        script_.tuning[1] = script_.tuning[2] = w.number("the activation distance");
    };
    keywords_["epsv"] = [this](ScriptWords& w) {
        script_.tuning[4] = script_.tuning[5] = w.number("the velocity threshold");
    };
    keywords_["fricIterAmt"] = [this](ScriptWords& w) {
        script_.friction_iterations = std::max(0, w.integer("the number of iterations"));
    };
    keywords_["tol"] = [this](ScriptWords& w) {
        script_.tolerances = lines_.numbers(w.integer("how many numbers follow"), w);
        require(!script_.tolerances.empty(),
                w,
                "found no tolerance, expected at least one; write \"tol 1\" "
                "and a number");
    };
    keywords_["tuning"] = [this](ScriptWords& w) {
        const std::vector<double> values =
            lines_.numbers(w.integer("how many numbers follow"), w);
        for (std::size_t i = 0; i < std::min(values.size(), script_.tuning.size()); ++i)
            script_.tuning[i] = values[i];
    };
    keywords_["useAbsParameters"] = [this](ScriptWords&) { script_.absolute = true; };
    keywords_["kappaMinMultiplier"] = [this](ScriptWords& w) {
        script_.kappa_min_multiplier = w.number("the multiplier");
    };
    keywords_["minBarrierStiffnessScale"] = keywords_["kappaMinMultiplier"];
}

}  // namespace noli::detail
