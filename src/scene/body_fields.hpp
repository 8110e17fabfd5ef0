// SPDX-License-Identifier: Apache-2.0
#pragma once
/// Every key of a scene's bodies, half-spaces and containers; see scene_fields.hpp.

#include "noli/scene.hpp"

#include "scene/choices.hpp"
#include "scene/field_spec.hpp"
#include "scene/forms.hpp"

#include <limits>

namespace noli {

template <class V>
void visit_fields(V& v, Material& m) {
    const Material d;
    v.choice("model", m.model, d.model, all(kMaterialModels), "Elastic energy.");
    v.number("density",
             m.density,
             d.density,
             {.unit = kDensity, .above = 0, .doc = "Mass density."});
    v.number("young",
             m.young,
             d.young,
             {.unit = kPressure, .above = 0, .doc = "Young's modulus: the stiffness."});
    v.number(
        "poisson",
        m.poisson,
        d.poisson,
        {.above = -1,
         .below = 0.5,
         .doc = "Poisson's ratio: 0.5 would keep the volume exactly; above 0.49 linear "
                "tetrahedra lock."});
    v.only_if(m.model == Material::Model::StableNeoHookean,
              "with \"model\": \"stable_neo_hookean\"");
    v.boolean("gipc_lame",
              m.gipc_lame,
              d.gipc_lame,
              "Use the Lame constants of the authors' program, which is a third too "
              "stiff in shear.");
    v.always();
}

template <class V>
void visit_fields(V& v, PathKey& k) {
    const PathKey d;
    v.required("time", "give the time of the key frame in seconds");
    v.number("time",
             k.time,
             std::numeric_limits<double>::quiet_NaN(),
             {.unit = kTime, .at_least = 0, .doc = "Time of the key frame."});
    v.vector("translation",
             k.translation,
             d.translation,
             {.unit = kLength, .doc = "Shift from the placement at the start."});
    v.vector("rotation_deg",
             k.rotation_deg,
             d.rotation_deg,
             {.unit = kAngle,
              .doc = "Turn Rx Ry Rz about the centre, from the placement at the start."});
}

template <class V>
void visit_condition_motion(V& v, BoundaryCondition& b) {
    using Kind = BoundaryCondition::Kind;
    const BoundaryCondition d;
    const bool load = b.kind == Kind::Force || b.kind == Kind::Acceleration;
    const Dimension unit = b.kind == Kind::Force        ? kForce
                         : b.kind == Kind::Acceleration ? kAcceleration
                                                        : kSpeed;
    v.only_if(b.kind == Kind::Velocity || load,
              "with \"kind\": \"velocity\", \"force\" or \"acceleration\"");
    v.vector(
        "linear",
        b.linear,
        d.linear,
        {.unit = unit,
         .doc = "Velocity (m/s), total force (N) or acceleration (m/s^2), by kind."});
    v.only_if(b.kind == Kind::Velocity, "with \"kind\": \"velocity\"");
    v.vector("angular_deg",
             b.angular_deg,
             d.angular_deg,
             {.unit = kAngularSpeed,
              .doc = "Angular velocity; each step turns by Rx Ry Rz about the centre."});
    v.only_if(b.kind == Kind::Velocity || b.kind == Kind::Path,
              "with \"kind\": \"velocity\" or \"path\"");
    v.maybe_vector("center",
                   b.center,
                   {.unit = kLength,
                    .doc = "Centre of rotation; default: the centre of the bounding box "
                           "of the selection."});
    v.only_if(b.kind == Kind::Path, "with \"kind\": \"path\"");
    v.list("path",
           b.path,
           "Key frames in ascending time; linear between them, held after the last.");
    v.only_if(b.kind == Kind::Sequence, "with \"kind\": \"sequence\"");
    v.files("sequence",
            b.sequence,
            "Mesh files with the positions (m, in the world) at the end of steps 1, 2, "
            "...; the last is held.");
    v.only_if(!load, "with \"kind\": \"fixed\", \"velocity\", \"path\" or \"sequence\"");
    v.choice("axes",
             b.axes,
             d.axes,
             all(kPrescribedAxes),
             "Coordinates that it prescribes; the vertices are free along the others.");
    v.always();
}

template <class V>
void visit_fields(V& v, BoundaryCondition& b) {
    using Kind = BoundaryCondition::Kind;
    const BoundaryCondition d;
    v.required("kind", "say what the condition does, for example \"kind\": \"fixed\"");
    v.choice("kind",
             b.kind,
             static_cast<Kind>(-1),
             all(kBoundaryKinds),
             "What the condition does.");
    v.template form<SelectForm>(
        "select", b.selection, "Which vertices it holds; default: all of the body.");
    visit_condition_motion(v, b);
    v.check(b.kind != Kind::Path || !b.path.empty(),
            "path",
            "found no key frames, expected at least one; write [{ \"time\": 0 }, ...]");
    v.check(b.kind != Kind::Sequence || !b.sequence.empty(),
            "sequence",
            "found no usable files, expected at least one mesh file; list them in the "
            "order of the steps");
    for (std::size_t i = 1; i < b.path.size(); ++i)
        v.check(b.path[i].time > b.path[i - 1].time,
                "path",
                "found key frames out of order, expected strictly ascending times; sort "
                "them");
    v.number("t_begin",
             b.t_begin,
             d.t_begin,
             {.unit = kTime,
              .at_least = 0,
              .doc = "Active in steps that start at this time or later."});
    v.template form<EndForm>(
        "t_end",
        b.t_end,
        "Active in steps that start before this time; default: forever.");
    v.check(b.t_end > b.t_begin,
            "t_end",
            "found an end that is not after \"t_begin\", expected a later time; enlarge "
            "\"t_end\"");
    v.template form<UntilForm>(
        "until",
        b.until,
        "Ends the condition for good at the first step that starts with every "
        "vertex beyond a plane.");
}

template <class V>
void visit_fields(V& v, Body& b) {
    const Body d;
    v.template form<NameForm>(
        "name",
        b.name,
        "Name for messages and contact pairs; default: body0, body1, ...");
    v.required(
        "mesh",
        "name a file or a generator, for example \"mesh\": { \"generator\": \"box\" }");
    v.template form<MeshForm>(
        "mesh",
        b.mesh,
        "Mesh file or generator. With tetrahedra the body is elastic; triangles, "
        "segments or points alone are an obstacle.");
    v.template form<TransformForm>("transform", b.transform, "Placement of the mesh.");
    v.template form<MaterialForm>(
        "material", b.material, "Name of a preset, or constants.");
    v.vector(
        "velocity", b.velocity, d.velocity, {.unit = kSpeed, .doc = "Initial velocity."});
    v.vector("angular_velocity_deg",
             b.angular_velocity_deg,
             d.angular_velocity_deg,
             {.unit = kAngularSpeed,
              .doc = "Initial angular velocity about the centre of the bounding box."});
    v.number("friction",
             b.friction,
             d.friction,
             {.at_least = 0,
              .doc = "Coefficient of friction; two bodies use the larger of theirs."});
    v.list("boundary", b.boundary, "Conditions on the motion of its vertices.");
    v.template form<GridForm>("grid", b, "Copies of the body on a grid.");
}

template <class V>
void visit_fields(V& v, HalfSpace& h) {
    const HalfSpace d;
    v.template form<NameForm>(
        "name",
        h.name,
        "Name for messages and contact pairs; default: plane0, plane1, ...");
    v.vector(
        "point", h.point, d.point, {.unit = kLength, .doc = "A point of the plane."});
    v.vector("normal",
             h.normal,
             d.normal,
             {.doc = "Points out of the forbidden side; any length."});
    v.check(h.normal != Vector3{},
            "normal",
            "found [0, 0, 0], expected a direction; write for example [0, 1, 0]");
    v.number("friction",
             h.friction,
             d.friction,
             {.at_least = 0, .doc = "Coefficient of friction of all bodies on it."});
}

template <class V>
void visit_fields(V& v, Container& c) {
    using Shape = Container::Shape;
    const Container d;
    v.template form<NameForm>(
        "name",
        c.name,
        "Name for messages and contact pairs; default: container0, container1, ...");
    v.required("shape", "say what bodies stay in, for example \"shape\": \"sphere\"");
    v.choice("shape",
             c.shape,
             static_cast<Shape>(-1),
             all(kContainerShapes),
             "What bodies stay in.");
    v.vector(
        "center",
        c.center,
        d.center,
        {.unit = kLength, .doc = "Its centre; of a cylinder any point of the axis."});
    v.required("radius", "give its inner radius, for example \"radius\": \"20 cm\"");
    v.number("radius",
             c.radius,
             std::numeric_limits<double>::quiet_NaN(),
             {.unit = kLength, .above = 0, .doc = "Its inner radius."});
    v.only_if(c.shape == Shape::Cylinder, "with \"shape\": \"cylinder\"");
    v.vector("axis",
             c.axis,
             d.axis,
             {.doc = "Direction of the axis, along which the cylinder is open; any "
                     "length."});
    v.always();
    v.check(c.axis != Vector3{},
            "axis",
            "found [0, 0, 0], expected a direction; write for example [0, 1, 0]");
    v.number("friction",
             c.friction,
             d.friction,
             {.at_least = 0, .doc = "Coefficient of friction of all bodies in it."});
}

}  // namespace noli
