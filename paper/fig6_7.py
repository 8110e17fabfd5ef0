#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Supplement section 7, Figs. 6 and 7: the unit tests of contact types and of conforming, close and sharp
contact, run with the exact test after every step and drawn from the frames. Writes fig6.png, fig7.png and
fig6_7.md (gaps, contacts, intersections per case)."""
import argparse
import os
import pathlib
import shutil
import sys

import runs

# One tetrahedron held below, one falling onto it; the same cases as tests/scene/supplement_fig6_test.cpp.
TOP_FACE = ((-1, 0, -1), (1, 0, -1), (0, 0, 1), (0, -1, 0))
TIP_DOWN = ((0.05, 0.05, -0.1), (-0.4, 0.8, -0.4), (0.6, 0.8, -0.4), (0.1, 0.8, 0.5))
TOP_EDGE_X = ((-1, 0, 0), (1, 0, 0), (0, -1, -0.7), (0, -1, 0.7))
BOTTOM_EDGE_Z = ((0.1, 0.05, -1), (0.1, 0.05, 1), (-0.6, 1, 0), (0.8, 1, 0))
BOTTOM_EDGE_X = ((-0.8, 0.05, 0.0), (0.9, 0.05, 0.0), (0.05, 1, -0.7), (0.05, 1, 0.7))
TIP_OVER_EDGE = ((0.1, 0.05, 0.0), (-0.4, 0.8, -0.4), (0.6, 0.8, -0.4), (0.1, 0.8, 0.5))
TIP_UP = ((0, 0, 0), (-0.5, -0.8, -0.5), (0.5, -0.8, -0.5), (0, -0.8, 0.6))
TIP_OVER_TIP = ((0, 0.05, 0), (-0.5, 0.85, -0.5), (0.5, 0.85, -0.5), (0, 0.85, 0.6))
OFF_CENTRE = tuple((x + 0.003, y, z) for x, y, z in TIP_OVER_TIP)
HELD = [{"kind": "fixed"}]


def tet_file(folder, name, points):
    path = folder / f"{name}.mesh"
    path.write_text("MeshVersionFormatted 2\nDimension 3\nVertices 4\n"
                    + "".join(f"{x} {y} {z} 0\n" for x, y, z in points)
                    + "Tetrahedra 1\n1 2 3 4 0\nEnd\n")
    return {"file": str(path), "fix_orientation": True}


def two_tets(folder, name, below, above, speed=1.0):
    return {"format_version": 1, "name": name, "dt": 0.01, "duration": 10, "bodies": [
        {"name": "below", "mesh": tet_file(folder, name + "_below", below), "boundary": HELD},
        {"name": "above", "mesh": tet_file(folder, name + "_above", above), "velocity": [0, -speed, 0]}]}


def two_cubes(name, shift, gap, scale=1.0):
    cube = {"generator": "box", "cells": [2, 2, 2]}
    return {"format_version": 1, "name": name, "dt": 0.01, "duration": 10, "bodies": [
        {"name": "below", "mesh": cube, "boundary": HELD},
        {"name": "above", "mesh": {**cube, "size": [scale] * 3},
         "transform": {"translate": [shift, 0.5 + 0.5 * scale + gap, 0]}}]}


def cases(folder):
    return {
        "fig6": {"point on triangle": two_tets(folder, "pt", TOP_FACE, TIP_DOWN),
                 "edge across edge": two_tets(folder, "ee", TOP_EDGE_X, BOTTOM_EDGE_Z),
                 "parallel edges": two_tets(folder, "ee_parallel", TOP_EDGE_X, BOTTOM_EDGE_X),
                 "point on edge": two_tets(folder, "pe", TOP_EDGE_X, TIP_OVER_EDGE),
                 "point on point": two_tets(folder, "pp", TIP_UP, TIP_OVER_TIP)},
        "fig7": {"aligned": two_cubes("aligned", 0.0, 0.02),
                 "close": two_cubes("close", 0.0, 3e-5),
                 "shifted": two_cubes("shifted", 0.25, 0.02),
                 "small on large": two_cubes("small", 0.1, 0.02, 0.5),
                 "sharp on sharp": two_tets(folder, "sharp", TIP_UP, OFF_CENTRE, 5.0)}}


def bodies_of(frame):
    """The two bodies of a frame as VTK polygons: connected pieces, the lower one first."""
    import vtk
    reader = vtk.vtkOBJReader()
    reader.SetFileName(str(frame))
    pieces = vtk.vtkPolyDataConnectivityFilter()
    pieces.SetInputConnection(reader.GetOutputPort())
    pieces.SetExtractionModeToSpecifiedRegions()
    out = []
    for region in range(2):
        pieces.InitializeSpecifiedRegionList()
        pieces.AddSpecifiedRegion(region)
        clean = vtk.vtkCleanPolyData()
        clean.SetInputConnection(pieces.GetOutputPort())
        clean.PointMergingOff()
        clean.Update()
        body = vtk.vtkPolyData()
        body.DeepCopy(clean.GetOutput())
        out.append(body)
    return sorted(out, key=lambda body: body.GetCenter()[1])


def panel(frame, title, column, columns):
    """One case as a renderer that fills its column of the window."""
    import vtk
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(1, 1, 1)
    renderer.SetViewport(column / columns, 0, (column + 1) / columns, 1)
    for body, colour in zip(bodies_of(frame), ((0.60, 0.66, 0.72), (0.90, 0.55, 0.22))):
        mapper = vtk.vtkPolyDataMapper()
        mapper.SetInputData(body)
        actor = vtk.vtkActor()
        actor.SetMapper(mapper)
        look = actor.GetProperty()
        look.SetColor(*colour)
        look.SetInterpolationToFlat()
        look.SetAmbient(0.35)
        look.SetDiffuse(0.75)
        look.EdgeVisibilityOn()
        look.SetEdgeColor(0.15, 0.15, 0.15)
        renderer.AddActor(actor)
    text = vtk.vtkTextActor()
    text.SetInput(title)
    text.SetPosition(12, 10)
    text.GetTextProperty().SetColor(0, 0, 0)
    text.GetTextProperty().SetFontSize(18)
    renderer.AddActor2D(text)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(1.6, 0.9, 2.6)
    camera.SetFocalPoint(0, 0, 0)
    renderer.ResetCamera()
    camera.Zoom(0.95)
    return renderer


def picture(path, drawn):
    import vtk
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(4)
    window.SetSize(260 * len(drawn), 300)
    for k, (title, frame) in enumerate(drawn):
        window.AddRenderer(panel(frame, title, k, len(drawn)))
    window.Render()
    grab = vtk.vtkWindowToImageFilter()
    grab.SetInput(window)
    writer = vtk.vtkPNGWriter()
    writer.SetFileName(str(path))
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


def with_display():
    """VTK of the distribution needs an X server; without one, starts again under a virtual one."""
    if os.environ.get("DISPLAY"):
        return
    if not shutil.which("xvfb-run"):
        raise SystemExit("fig6_7: no display and no xvfb-run; install xvfb")
    os.execvp("xvfb-run", ["xvfb-run", "-a", sys.executable, *sys.argv])


def first_contact(rows):
    """The first step that ends with the bodies inside dhat of each other."""
    return next((int(row["step"]) for row in rows if int(row["contacts"]) > 0), len(rows))


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--noli", default=str(runs.ROOT / "build/release/noli"))
    parser.add_argument("--out", type=pathlib.Path, default=runs.ROOT / "out/paper")
    parser.add_argument("--work", type=pathlib.Path, default=runs.ROOT / "out/paper/runs")
    arguments = parser.parse_args()
    with_display()
    arguments.out.mkdir(parents=True, exist_ok=True)
    arguments.work.mkdir(parents=True, exist_ok=True)
    lines = ["# Figs. 6 and 7", "", "| figure | case | steps | Newton | most contacts | smallest gap / dhat | "
             "intersections | inversions |", "| --- " * 8 + "|"]
    bad = 0
    for figure, of in cases(arguments.work).items():
        drawn = []
        for title, scene in of.items():
            name = f"{figure}-{scene['name']}"
            done = runs.run(arguments.noli, runs.as_in_paper(scene), name, arguments.work, 60, 60,
                            options=["--verify", "--frames-every", "1", "--format", "obj"])
            record = runs.record(arguments.work / name)
            hits = sum(int(row["intersections"]) for row in done.rows)
            turned = sum(int(row["inversions"]) for row in done.rows)
            bad += hits + turned + (not done.complete)
            lines.append(f"| {figure} | {title} | {done.steps} | {done.count()} | {done.contacts} | "
                         f"{done.min_gap / record['dhat_m']:.3f} | {hits} | {turned} |")
            frame = arguments.work / name / "run/frames" / f"frame_{first_contact(done.rows):06d}.obj"
            drawn.append((title, frame))
        picture(arguments.out / f"{figure}.png", drawn)
    (arguments.out / "fig6_7.md").write_text("\n".join(lines) + "\n")
    print("\n".join(lines))
    return 1 if bad else 0


if __name__ == "__main__":
    raise SystemExit(main())
