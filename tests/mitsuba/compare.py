#!/usr/bin/env python3
"""Compares mode `full` of afterimage with the `path` integrator of Mitsuba 3 on three diffuse
scenes and on one with metal of six roughnesses.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install mitsuba
    /tmp/venv/bin/python tests/mitsuba/compare.py target/release/afterimage --json result.json

First both programs render converged pictures: their means must agree within 2 %, and the means of
blocks of 16 x 16 pixels within 5 %. Then the efficiency 1 / (MSE x seconds) is measured at several
sample counts, the programs in turns, medians of `--repeats` runs. The mean squared error is that of
linear radiance against the converged picture of the same program, without pixels next to an edge of
a surface: Mitsuba spreads its samples over the pixel, afterimage does so only with `--antialias`.
Seconds are those of tracing, without import and tree. Each program's threads are its `--threads`.

Mitsuba's variant is llvm_ad_rgb where a working LLVM is found (DRJIT_LIBLLVM_PATH, version 17 or
newer), because it is about three times as fast as scalar_rgb; otherwise scalar_rgb. Its sampler is
the default one, `independent`; depth and Russian roulette (rr_depth 5) match `--bounces`.

Exit codes: 0 all checks hold, or Mitsuba is not installed (SKIPPED is printed); 1 a check fails.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

# Leave no compiled files in the repository.
sys.dont_write_bytecode = True
import scenes  # noqa: E402

BLOCK = 16
MEAN_TOLERANCE = 0.02
BLOCK_TOLERANCE = 0.05
# Smallest allowed efficiency relative to Mitsuba's.
MIN_RATIO = 0.5
VARIANTS = ["llvm_ad_rgb", "scalar_rgb"]


def works(variant):
    """True where a variant renders; an old LLVM ends the process, so another one tries."""
    code = (
        f"import mitsuba as mi; mi.set_variant('{variant}'); "
        "import numpy; s = mi.cornell_box(); s['sensor']['film']['width'] = 8; "
        "print(numpy.array(mi.render(mi.load_dict(s), spp=4)).mean())"
    )
    return subprocess.run([sys.executable, "-c", code], capture_output=True, check=False).returncode == 0


class Afterimage:
    """The program under test."""

    name = "afterimage"

    def __init__(self, program, model, scene, options):
        self.program, self.model, self.scene, self.options = program, model, scene, options
        self.samples_option = lambda spp: ["--samples", str(spp)]

    def run(self, extra, seed, output):
        scene, options = self.scene, self.options
        command = [self.program, "render", str(self.model), "--mode", "full", "--json", "-o", str(output)]
        command += ["--size", f"{scene.size[0]}x{scene.size[1]}", "--threads", str(options.threads)]
        command += ["--bounces", options.bounces, "--seed", str(seed), *extra]
        command += ["--eye", ",".join(map(str, scene.eye)), "--look-at", ",".join(map(str, scene.at))]
        command += ["--fov-y", str(scene.fov_y_deg)]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(command)}\nended with {done.returncode}: {done.stderr.strip()}")
        return json.loads(done.stdout)

    def picture(self, extra, seed):
        """Radiance as an array of rows, and the record of the program."""
        output = self.model.with_suffix(".exr")
        record = self.run(extra, seed, output)
        return read_exr(output)["rgb"], record

    def render(self, spp, seed):
        picture, record = self.picture(self.samples_option(spp), seed)
        return picture, record["secs"]["frame"], sum(v for k, v in record["rays"].items() if k != "clamped")

    def smooth_edges(self, spp):
        """A picture whose pixels are means over their area."""
        rays = min(spp, 64)
        return self.picture(["--antialias", str(rays), "--samples", str(max(spp // rays, 1))], 1)[0]

    def edges(self):
        """True for pixels that see another triangle than one of their eight neighbours."""
        import numpy

        output = self.model.with_suffix(".edges.exr")
        self.run(["--samples", "1", "--aov", "primitive"], 0, output)
        seen = read_exr(output)["other"]
        padded = numpy.pad(seen, ((1, 1), (1, 1)), mode="edge")
        h, w = seen.shape
        shifted = [padded[y : y + h, x : x + w] for y in range(3) for x in range(3)]
        return numpy.any([s != seen for s in shifted], axis=0)


def read_exr(path):
    """The colour of an OpenEXR file, and its last other channel."""
    import mitsuba as mi
    import numpy

    bitmap = mi.Bitmap(str(path))
    names = [field.name for field in bitmap.struct_()]
    data = numpy.array(bitmap, dtype=numpy.float64)
    rgb = data[:, :, [names.index(c) for c in "RGB"]]
    return {"rgb": rgb, "other": data[:, :, -1]}


class Mitsuba:
    """Mitsuba's path tracer."""

    name = "mitsuba"

    def __init__(self, mi, scene, folder, options):
        self.mi = mi
        max_depth = -1 if options.bounces == "all" else int(options.bounces) + 2
        self.loaded = mi.load_dict(scenes.mitsuba_dict(mi, scene, folder, max_depth))
        # Kernels are compiled in the first pictures, which are not measured.
        for spp in options.samples:
            self.render(spp, 0)

    def render(self, spp, seed):
        import drjit
        import numpy

        start = time.perf_counter()
        picture = self.mi.render(self.loaded, spp=spp, seed=seed)
        drjit.eval(picture)
        drjit.sync_thread()
        secs = time.perf_counter() - start
        return numpy.array(picture, dtype=numpy.float64), secs, 0

    def converged(self, spp):
        """The mean of several pictures, because the wavefront of one is held in memory."""
        part = min(spp, 64)
        pictures = [self.render(part, 1000 + i)[0] for i in range(max(spp // part, 1))]
        return sum(pictures) / len(pictures)


def agreement(ours, theirs):
    """Relative differences of the mean, and the largest one of a block's mean."""
    h, w, _ = ours.shape

    def blocks(picture):
        return picture.reshape(h // BLOCK, BLOCK, w // BLOCK, BLOCK, 3).mean(axis=(1, 3, 4))

    a, b = blocks(ours), blocks(theirs)
    # A block that sees nothing is black in both.
    differences = abs(a - b) / b.clip(min=1e-3 * b.mean())
    return abs(ours.mean() / theirs.mean() - 1), differences.max()


def measure(programs, truths, keep, options):
    """Rows of a table: one for each sample count and program."""
    rows = []
    for spp in options.samples:
        runs = {p.name: [] for p in programs}
        for repeat in range(options.repeats):
            for program in programs:
                picture, secs, rays = program.render(spp, 10 + repeat)
                error = (picture - truths[program.name])[keep]
                runs[program.name].append(((error**2).mean(), secs, rays))
        for name, found in runs.items():
            mse, secs, rays = (statistics.median(column) for column in zip(*found))
            efficiency = statistics.median(1 / (m * s) for m, s, _ in found)
            rows.append({"program": name, "samples": spp, "mse": mse, "secs": secs, "efficiency": efficiency,
                         "mrays_per_sec": rays / secs / 1e6})
    return rows


def compare(mi, make, folder, options):
    scene = make()
    model = scenes.write_afterimage(scene, folder)
    ours, theirs = Afterimage(options.program, model, scene, options), Mitsuba(mi, scene, folder, options)
    truths = {theirs.name: theirs.converged(options.truth_samples)}
    smooth = ours.smooth_edges(max(options.truth_samples // 4, 64))
    mean, block = agreement(smooth, truths[theirs.name])
    result = {"scene": scene.name, "mean_difference": mean, "block_difference": block,
              "agrees": bool(mean <= MEAN_TOLERANCE and block <= BLOCK_TOLERANCE)}
    print(f"\n{scene.name}: mean differs by {mean:.2%}, worst block by {block:.2%}", flush=True)
    if options.pictures:
        for name, picture in [("afterimage", smooth), ("mitsuba", truths[theirs.name])]:
            mi.util.write_bitmap(f"{options.pictures}/{scene.name}-{name}.png", picture.astype("float32"))
    if options.samples:
        truths[ours.name] = ours.render(options.truth_samples, 999)[0]
        rows = measure([ours, theirs], truths, ~ours.edges(), options)
        result |= {"rows": rows, "ratio": report(rows)}
        result["is_fast_enough"] = result["ratio"] >= MIN_RATIO
    return result


def report(rows):
    """Prints the rows and returns the geometric mean of the ratios of efficiencies."""
    print("  samples  program         MSE      secs  1/(MSE s)   Mrays/s   ratio")
    ratios = []
    for ours, theirs in zip(rows[::2], rows[1::2]):
        ratios.append(ours["efficiency"] / theirs["efficiency"])
        for row in (ours, theirs):
            tail = f"{row['mrays_per_sec']:10.2f} {ratios[-1]:7.2f}" if row is ours else ""
            print(f"  {row['samples']:7} {row['program']:>11} {row['mse']:11.4e} {row['secs']:8.3f}"
                  f" {row['efficiency']:10.4g} {tail}")
    ratio = statistics.geometric_mean(ratios)
    print(f"  efficiency relative to Mitsuba, geometric mean: {ratio:.2f}", flush=True)
    return ratio


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("program", help="path of afterimage")
    parser.add_argument("--bounces", default="8", help="diffuse bounces, or 'all'")
    parser.add_argument("--samples", default="4,16,64", help="sample counts, or nothing to check agreement only")
    parser.add_argument("--truth-samples", type=int, default=1024)
    parser.add_argument("--repeats", type=int, default=3)
    parser.add_argument("--threads", type=int, default=os.cpu_count())
    parser.add_argument("--scenes", default=",".join(scenes.ALL))
    parser.add_argument("--variant", choices=VARIANTS)
    parser.add_argument("--pictures", help="folder for the converged pictures")
    parser.add_argument("--json", help="file for the result")
    options = parser.parse_args()
    options.samples = [int(n) for n in options.samples.split(",") if n]
    options.program = str(Path(options.program).resolve())
    return options


def main():
    options = arguments()
    try:
        import mitsuba as mi
    except ImportError:
        print("SKIPPED: no mitsuba (pip install mitsuba, in a virtual environment)")
        return 0
    variant = options.variant or next((v for v in VARIANTS if works(v)), None)
    if variant is None:
        print(f"SKIPPED: mitsuba {mi.__version__} has no variant that works: {', '.join(VARIANTS)}")
        return 0
    mi.set_variant(variant)
    import drjit
    import metal

    metal.register()
    drjit.set_thread_count(options.threads)
    print(f"Mitsuba {mi.__version__}, {variant}, {options.threads} threads, --bounces {options.bounces}")
    with tempfile.TemporaryDirectory() as folder:
        results = [compare(mi, scenes.ALL[s], Path(folder), options) for s in options.scenes.split(",")]
    ok = all(r["agrees"] and r.get("is_fast_enough", True) for r in results)
    document = {"mitsuba": mi.__version__, "variant": variant, "threads": options.threads,
                "bounces": options.bounces, "scenes": results, "ok": ok}
    if options.json:
        Path(options.json).write_text(json.dumps(document, indent=1) + "\n")
    print(f"\n{'all checks hold' if ok else 'A CHECK FAILS'}")
    return 0 if ok else 1


if __name__ == "__main__":
    sys.exit(main())
