#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Supplement section 10, Figs. 9-10: share of friction, barrier and elastic Hessian work, friction on and off.

The claim: projecting friction costs a third to a half of projecting the barrier. Ours are the seconds of
gradient and projected Hessian together, per energy (columns t_elastic, t_barrier, t_friction of stats.csv),
with gn+ as we ship it and with the numerically projected Hessian of IPC. Writes fig9_10.md, fig9.svg and
fig10.svg.
"""
import argparse
import os
import pathlib

import runs
import study_scenes

SCENES = ("rings_1e4", "impact", "heavy_top", "mats_1e4", "crossing_1e6", "press_1e5", "rollers")
MODELS = {"gn+": {"hessian": "gn+"}, "ipc": {"model": "ipc"}}
DOLPHIN = "timed/dolphinFunnel_50.txt"


def with_friction(scene, mu):
    bodies = [{**body, "friction": mu} for body in scene["bodies"]]
    planes = [{**plane, "friction": mu} for plane in scene.get("half_spaces", [])]
    out = {**scene, "bodies": bodies}
    if planes:
        out["half_spaces"] = planes
    return out


def measure(arguments, name, scene, steps, mu, model):
    fresh = dict.fromkeys(("model", "hessian", "mollifier", "barrier_exponent"))
    scene = runs.merged(runs.merged(with_friction(scene, mu), {"contact": fresh}),
                        {"contact": MODELS[model]})
    label = f"friction-{name}-{mu:g}-{model}"
    done = runs.run(arguments.noli, runs.as_in_paper(scene), label, arguments.work, steps, arguments.timeout,
                    threads=os.cpu_count())
    print(f"{label}: {done.count()} iterations, {done.wall_s:.1f} s", flush=True)
    return done


def line(name, mu, model, run):
    p = run.phases
    share = lambda phase: f"{100 * p[phase] / run.wall_s:.1f} %"
    ratio = f"{p['t_friction'] / p['t_barrier']:.2f}" if p["t_friction"] > 0 else ""
    return (f"| {name} | {mu:g} | {model} | {run.count()} | {run.wall_s:.2f} | {share('t_elastic')} | "
            f"{share('t_barrier')} | {share('t_friction')} | {ratio} |")


def bars(path, names, all_runs, phases, title):
    import matplotlib
    matplotlib.use("Agg")
    import matplotlib.pyplot as plt
    figure, axes = plt.subplots(figsize=(7, 3.6))
    bottom = [0.0] * len(names)
    for label, of in phases.items():
        heights = [100 * of(run) / run.wall_s for run in all_runs]
        axes.bar(names, heights, bottom=bottom, label=label)
        bottom = [a + b for a, b in zip(bottom, heights)]
    axes.set_ylabel("% of the run's time")
    axes.set_title(title, fontsize=9)
    axes.tick_params(axis="x", labelrotation=30, labelsize=7)
    axes.legend(fontsize=7)
    figure.tight_layout()
    figure.savefig(path)
    plt.close(figure)


HESSIANS = {"elastic": lambda r: r.phases["t_elastic"], "barrier": lambda r: r.phases["t_barrier"],
            "friction": lambda r: r.phases["t_friction"]}


def rest(run):
    return run.wall_s - sum(of(run) for of in HESSIANS.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--noli", default=str(runs.ROOT / "build/release/noli"))
    parser.add_argument("--out", type=pathlib.Path, default=runs.ROOT / "out/paper")
    parser.add_argument("--work", type=pathlib.Path, default=runs.ROOT / "out/paper/runs")
    parser.add_argument("--timeout", type=float, default=600, help="seconds per run")
    arguments = parser.parse_args()
    arguments.out.mkdir(parents=True, exist_ok=True)

    lines = ["# Figs. 9-10", "", "| scene | mu | model | Newton | wall s | elastic | barrier | friction | "
             "friction / barrier |", "| --- " * 9 + "|"]
    shown, ratios = {}, {model: [] for model in MODELS}
    for name in SCENES:
        make, steps, _ = study_scenes.SCENES[name]
        scene = make(arguments.noli)
        if scene is None:
            continue
        for mu, model in ((0.3, "gn+"), (0.3, "ipc"), (0.0, "gn+")):
            run = measure(arguments, name, scene, steps, mu, model)
            lines.append(line(name, mu, model, run))
            if mu > 0:
                ratios[model].append(run.phases["t_friction"] / run.phases["t_barrier"])
            if mu > 0 and model == "gn+":
                shown[name] = run
    dolphin = runs.script_scene(DOLPHIN, arguments.noli)
    funnel = {}
    for mu in (0.01, 0.0) if dolphin else ():
        funnel[f"mu {mu:g}"] = run = measure(arguments, "dolphin", dolphin, 30, mu, "gn+")
        lines.append(line("dolphin", mu, "gn+", run))
    for model, values in ratios.items():
        verdict = "holds" if all(1 / 3 <= v <= 1 / 2 for v in values) else "does not hold"
        lines += ["", f"Claim \"friction costs a third to a half of the barrier\", against {model}: {verdict}; "
                  f"ours {min(values):.2f} to {max(values):.2f}."]
    (arguments.out / "fig9_10.md").write_text("\n".join(lines) + "\n")
    bars(arguments.out / "fig9.svg", list(shown), list(shown.values()), HESSIANS,
         "Gradients and projected Hessians (mu = 0.3, gn+)")
    if funnel:
        bars(arguments.out / "fig10.svg", list(funnel), list(funnel.values()),
             {**HESSIANS, "everything else": rest}, "Dolphin in the funnel")
    print("\n".join(lines))


if __name__ == "__main__":
    main()
