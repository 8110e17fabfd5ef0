// SPDX-License-Identifier: Apache-2.0
/// Keywords of IPC scripts.
#include "scene/ipc_script_data.hpp"
#include "scene/suggest.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <map>

namespace noli {

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

bool is_interior_point(const std::string& name) {
    return name == "interiorPoint" || name == "IP";
}

class ScriptParser {
  public:
    ScriptParser(const std::string& file, const std::string& text) : lines_(file, text) {
        script_.file = file;
        add_setting_keywords();
        add_shape_keywords();
        add_contact_keywords();
    }

    Script parse() {
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

  private:
    using Handler = std::function<void(ScriptWords&)>;

    void add_setting_keywords() {
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

    void add_shape_keywords() {
        keywords_["shape"] = [this](ScriptWords& w) {
            expect_input(w);
            ScriptShape shape;
            shape.place = w;
            shape.path = w.word("the path of a mesh");
            script_.shapes.push_back(shape);
        };
        keywords_["shapes"] = [this](ScriptWords& w) {
            expect_input(w);
            const int count = w.integer("the number of shapes");
            for (int i = 0; i < count; ++i)
                script_.shapes.push_back(
                    read_shape(next_line(w, "a line for every shape")));
        };
        keywords_["shapeMatrix"] = [this](ScriptWords& w) { read_matrix(w); };
        keywords_["rotateModel"] = [this](ScriptWords& w) {
            ScriptRotation rotation{.axis = w.vector("the axis")};
            rotation.degrees = w.number("the angle in degrees");
            require(rotation.axis != Vector3{},
                    w,
                    "found the axis 0 0 0, expected a direction; correct it");
            script_.rotation = rotation;
        };
        keywords_["meshCO"] = [this](ScriptWords& w) {
            ScriptObstacle obstacle;
            obstacle.place = w;
            obstacle.path = w.word("the path of a mesh");
            obstacle.origin = w.vector("the origin");
            obstacle.scale = w.number("the scale");
            w.number("the stiffness");  // unused there too
            obstacle.friction = w.number("the friction");
            if (w.peek() == "rotate") {
                w.word("");
                obstacle.rotation_deg = w.vector("the rotation in degrees");
            }
            require(obstacle.scale > 0,
                    w,
                    "found a scale that is not positive, expected an extent in m; "
                    "correct it");
            script_.obstacles.push_back(obstacle);
        };
    }

    void add_contact_keywords() {
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
            script_.friction_iterations =
                std::max(0, w.integer("the number of iterations"));
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
            for (std::size_t i = 0; i < std::min(values.size(), script_.tuning.size());
                 ++i)
                script_.tuning[i] = values[i];
        };
        keywords_["useAbsParameters"] = [this](ScriptWords&) { script_.absolute = true; };
        keywords_["kappaMinMultiplier"] = [this](ScriptWords& w) {
            script_.kappa_min_multiplier = w.number("the multiplier");
        };
        keywords_["minBarrierStiffnessScale"] = keywords_["kappaMinMultiplier"];
    }

    void warn_unknown(const std::string& keyword, const ScriptWords& words) {
        std::vector<std::string> known = ignored_keywords();
        for (const auto& [name, handler] : keywords_)
            known.push_back(name);
        script_.warnings.push_back(
            {words.where(),
             fmt::format("found the unknown keyword \"{}\"{}; the line is skipped",
                         keyword,
                         did_you_mean(keyword, known))});
    }

    void read_energy(ScriptWords& w) {
        const std::string name = w.word("NH or FCR");
        if (name != "NH" && name != "FCR")
            w.fail(fmt::format("found the energy \"{}\", expected NH or FCR; choose one",
                               name),
                   Error::Code::Unsupported);
        script_.energy =
            name == "NH" ? Material::Model::NeoHookean : Material::Model::FixedCorotated;
    }

    void read_integration(ScriptWords& w) {
        const std::string name = w.word("BE or NM");
        if (name != "BE" && name != "NM")
            w.fail(fmt::format(
                       "found the time integration \"{}\", expected BE or NM; choose one",
                       name),
                   Error::Code::Unsupported);
        script_.integrator =
            name == "BE" ? Integrator::ImplicitEuler : Integrator::Newmark;
        if (name == "NM" && w.number_follows()) {
            script_.newmark_beta = w.number("beta");
            script_.newmark_gamma = w.number("gamma");
        }
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

    /// Lines up to "section end" count only if interior point is named: it is the only
    /// solver here.
    void read_section(ScriptWords& w) {
        bool ours = w.done() || w.peek() == "end";
        while (!w.done())
            ours = is_interior_point(w.word("a solver")) || ours;
        if (ours) return;
        ScriptWords line;
        while (lines_.next(line))
            if (line.word("") == "section" && (line.done() || line.peek() == "end"))
                return;
    }

    static ScriptTimeRange read_range(ScriptWords& w) {
        const double begin = w.number("the begin");
        return {begin, w.number("the end")};
    }

    static void expect_input(ScriptWords& w) {
        const std::string type = w.word("\"input\"");
        if (type != "input")
            w.fail(fmt::format("found shapes of type \"{}\", expected input; write a "
                               "mesh file instead",
                               type),
                   Error::Code::Unsupported);
    }

    ScriptWords next_line(const ScriptWords& opening, const char* what) {
        ScriptWords words;
        if (!lines_.next(words))
            opening.fail(fmt::format(
                "found the end of the file, expected {}; add the lines", what));
        return words;
    }

    void read_matrix(ScriptWords& w) {
        expect_input(w);
        std::array<int, 3> grid{};
        for (int& n : grid) {
            n = w.integer("the number of copies along an axis");
            require(n >= 1,
                    w,
                    fmt::format("found {} copies, expected at least one; correct it", n));
        }
        const Vector3 origin =
            w.number_follows() ? w.vector("the place of the first copy") : Vector3{};
        ScriptShape shape = read_shape(next_line(w, "a line with a shape"));
        shape.grid = grid;
        shape.spacing =
            shape.translation;  // in a matrix the first three numbers are distances
        shape.translation = origin;
        script_.shapes.push_back(shape);
    }

    ScriptLines lines_;
    Script script_;
    std::map<std::string, Handler> keywords_;
    std::vector<std::string> ignored_;
};

}  // namespace

Script parse_script(const std::string& file, const std::string& text) {
    return ScriptParser(file, text).parse();
}

}  // namespace noli
