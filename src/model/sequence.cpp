// SPDX-License-Identifier: Apache-2.0
#include "model/sequence.hpp"

#include "mesh/read.hpp"
#include "mesh/source.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <utility>
#include <vector>

namespace noli {

namespace {

/// A condition that takes positions from files, and what it needs to take them.
class Taker {
  public:
    /// In:  tets  those of the condition's body
    Taker(const Model& model, const std::vector<int>& tets, ModelCondition& condition)
        : model_(&model), condition_(&condition) {
        const auto [first, last] =
            std::equal_range(model.body.begin(), model.body.end(), condition.body);
        first_ = static_cast<int>(first - model.body.begin());
        count_ = static_cast<int>(last - first);
        condition.sequence.resize(condition.what.sequence.size());
        find_whole_tets(tets);
    }

    /// Frame `step` from the positions in a file.
    Status take(std::size_t step, const std::vector<Vec3d>& x) const {
        const std::string& file = condition_->what.sequence[step];
        if (x.size() != static_cast<std::size_t>(count_))
            return bad(fmt::format(
                "\"{}\" has {} vertices, expected {} as in the body's mesh; write the "
                "sequence again from that mesh",
                file,
                x.size(),
                count_));
        const auto at = [&](int v) { return x[static_cast<std::size_t>(v - first_)]; };
        for (const int t : whole_tets_) {
            const Int4& v = model_->tets[static_cast<std::size_t>(t)];
            const Vec3d o = at(v[0]);
            if (dot(cross(at(v[1]) - o, at(v[2]) - o), at(v[3]) - o) <= 0.0)
                return bad(
                    fmt::format("\"{}\" turns the tetrahedron of vertices {}, {}, {} and "
                                "{} inside out; correct that frame",
                                file,
                                v[0] - first_,
                                v[1] - first_,
                                v[2] - first_,
                                v[3] - first_));
        }
        std::vector<Vec3d>& frame = condition_->sequence[step];
        frame.reserve(condition_->vertices.size());
        for (const int v : condition_->vertices)
            frame.push_back(at(v) - model_->origin);
        return Done{};
    }

    /// Under its own place.
    [[nodiscard]] Error placed(Error error) const {
        error.where = condition_->where + ": " + error.where;
        return error;
    }

  private:
    /// Tetrahedra whose four corners all follow the sequence.
    void find_whole_tets(const std::vector<int>& tets) {
        std::vector<std::uint8_t> follows(static_cast<std::size_t>(count_), 0);
        for (const int v : condition_->vertices)
            follows[static_cast<std::size_t>(v - first_)] = 1;
        for (const int t : tets) {
            const Int4& tet = model_->tets[static_cast<std::size_t>(t)];
            if (std::all_of(tet.v, tet.v + 4, [&](int v) {
                    return follows[static_cast<std::size_t>(v - first_)] != 0;
                }))
                whole_tets_.push_back(t);
        }
    }

    [[nodiscard]] Error bad(std::string message) const {
        return {Error::Code::BadMesh, condition_->where, std::move(message)};
    }

    const Model* model_;
    ModelCondition* condition_;
    int first_ = 0, count_ = 0;  ///< vertices of the body
    std::vector<int> whole_tets_;
};

std::vector<std::vector<int>> tets_by_body(const Model& model) {
    std::vector<std::vector<int>> tets(model.body_names.size());
    for (int t = 0; t < model.num_tets(); ++t) {
        const int corner = model.tets[static_cast<std::size_t>(t)][0];
        const int body = model.body[static_cast<std::size_t>(corner)];
        tets[static_cast<std::size_t>(body)].push_back(t);
    }
    return tets;
}

}  // namespace

Status load_sequences(const std::string& base_folder, Model& model) {
    const bool any = std::any_of(model.conditions.begin(),
                                 model.conditions.end(),
                                 [](const auto& c) { return !c.what.sequence.empty(); });
    if (!any) return Done{};
    const std::vector<std::vector<int>> tets = tets_by_body(model);
    std::vector<Taker> takers;
    std::vector<std::string> files;  // each once, in the order of first use
    std::map<std::string, std::vector<std::pair<std::size_t, std::size_t>>>
        uses;  // of a file: taker, step
    for (ModelCondition& condition : model.conditions) {
        const std::vector<std::string>& sequence = condition.what.sequence;
        if (sequence.empty()) continue;
        for (std::size_t step = 0; step < sequence.size(); ++step) {
            const std::string path = resolve_path(sequence[step], base_folder);
            auto& of_file = uses[path];
            if (of_file.empty()) files.push_back(path);
            of_file.emplace_back(takers.size(), step);
        }
        takers.emplace_back(
            model, tets[static_cast<std::size_t>(condition.body)], condition);
    }
    for (const std::string& path : files) {
        const auto& of_file = uses[path];
        const Result<Mesh> frame = read_mesh(path, {.positions_only = true});
        if (!frame) return takers[of_file.front().first].placed(frame.error());
        for (const auto& [taker, step] : of_file)
            if (Status taken = takers[taker].take(step, frame.value().x); !taken)
                return taken;
    }
    return Done{};
}

}  // namespace noli
