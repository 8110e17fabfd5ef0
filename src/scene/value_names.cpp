// SPDX-License-Identifier: Apache-2.0
#include "noli/scene.hpp"

#include "scene/choices.hpp"

namespace noli {

namespace {

template <class E>
std::span<const Choice<E>> choices_of();

template <>
std::span<const Choice<Integrator>> choices_of() {
    return all(kIntegrators);
}
template <>
std::span<const Choice<LinearSolver>> choices_of() {
    return all(kLinearSolvers);
}
template <>
std::span<const Choice<ContactModel>> choices_of() {
    return all(kContactModels);
}
template <>
std::span<const Choice<MollifierModel>> choices_of() {
    return all(kMollifierModels);
}

}  // namespace

template <class E>
std::vector<std::string> value_names() {
    std::vector<std::string> names;
    for (const Choice<E>& choice : choices_of<E>())
        names.emplace_back(choice.name);
    return names;
}

template <class E>
std::optional<E> value_named(const std::string& name) {
    for (const Choice<E>& choice : choices_of<E>())
        if (name == choice.name) return choice.value;
    return std::nullopt;
}

template std::vector<std::string> value_names<Integrator>();
template std::vector<std::string> value_names<LinearSolver>();
template std::vector<std::string> value_names<ContactModel>();
template std::vector<std::string> value_names<MollifierModel>();
template std::optional<Integrator> value_named(const std::string&);
template std::optional<LinearSolver> value_named(const std::string&);
template std::optional<ContactModel> value_named(const std::string&);
template std::optional<MollifierModel> value_named(const std::string&);

}  // namespace noli
