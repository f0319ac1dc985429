#!/usr/bin/env python3
"""Compares the illuminance that `afterimage measure` finds with that of `rtrace -I` of Radiance.

    python3 -m venv /tmp/venv && /tmp/venv/bin/pip install pyradiance
    /tmp/venv/bin/python tests/radiance/compare.py target/release/afterimage --json result.json

Five scenes of diffuse surfaces, 200 points in each: a furnished room with a lamp, a room with a
window to an overcast sky, a corridor with six lamps, a court under an overcast sky, and a room that
is lit through a door alone. The means of a scene must agree within 3 %, and 95 % of the points
within 10 %. Both programs trace paths without a cache: ambient interpolation of Radiance is off
(`-aa 0`). Its irradiance is in W/m2 of three channels, and so is ours, times 10,000 lux, for models
without photometric units; neither factor of lm/W (179, 683) enters.

Exit codes: 0 all checks hold, or pyradiance is not installed (SKIPPED is printed); 1 a check fails.
"""

import argparse
import json
import math
import os
import random
import subprocess
import sys
import tempfile
from pathlib import Path

MEAN_TOLERANCE = 0.03
POINT_TOLERANCE = 0.10
POINTS = 200
LUX_PER_UNIT = 10_000.0
# The luminance of both programs' channels is compared on grey light, where all weights agree.
OVERCAST_ZENITH = 1.0

PAINTS = {
    "white": 0.75,
    "grey": 0.4,
    "dark": 0.15,
    "wood": 0.3,
    "black": 0.0,
}
LAMP_RADIANCE = 20.0


class Scene:
    """Quads with paints, and where sensors may lie."""

    def __init__(self, name, has_sky):
        self.name, self.has_sky = name, has_sky
        self.quads, self.zones = [], []

    def quad(self, corners, paint):
        self.quads.append((corners, paint))

    def floor(self, x, z, y, paint):
        """A rectangle that faces up."""
        self.quad([(x[0], y, z[1]), (x[1], y, z[1]), (x[1], y, z[0]), (x[0], y, z[0])], paint)

    def ceiling(self, x, z, y, paint):
        """A rectangle that faces down."""
        self.quad([(x[0], y, z[0]), (x[1], y, z[0]), (x[1], y, z[1]), (x[0], y, z[1])], paint)

    def along_x(self, x, y, z, paint):
        """A wall of one z."""
        self.quad([(x[0], y[0], z), (x[1], y[0], z), (x[1], y[1], z), (x[0], y[1], z)], paint)

    def along_z(self, x, y, z, paint):
        """A wall of one x."""
        self.quad([(x, y[0], z[0]), (x, y[0], z[1]), (x, y[1], z[1]), (x, y[1], z[0])], paint)

    def walls(self, x, y, z, paint):
        for side in z:
            self.along_x(x, y, side, paint)
        for side in x:
            self.along_z(side, y, z, paint)

    def box(self, x, y, z, paint):
        self.walls(x, y, z, paint)
        self.floor(x, z, y[1], paint)
        self.ceiling(x, z, y[0], paint)

    def with_opening(self, x, y, z, hole_x, hole_y, paint):
        """A wall of one z with an opening."""
        self.along_x((x[0], hole_x[0]), y, z, paint)
        self.along_x((hole_x[1], x[1]), y, z, paint)
        if hole_y[0] > y[0]:
            self.along_x(hole_x, (y[0], hole_y[0]), z, paint)
        if hole_y[1] < y[1]:
            self.along_x(hole_x, (hole_y[1], y[1]), z, paint)


    def lit_ceiling(self, x, z, y, lamps_x, lamps_z):
        """A ceiling with a row of lamps set into it, so that no light leaves them upwards: lamps of
        Radiance emit to one side, ours to both."""
        self.ceiling(x, (z[0], lamps_z[0]), y, "white")
        self.ceiling(x, (lamps_z[1], z[1]), y, "white")
        begin = x[0]
        for lamp in lamps_x:
            self.ceiling((begin, lamp[0]), lamps_z, y, "white")
            self.ceiling(lamp, lamps_z, y, "lamp")
            begin = lamp[1]
        self.ceiling((begin, x[1]), lamps_z, y, "white")

    def under_sky(self):
        """Black ground all around: below the horizon, the two skies differ."""
        self.floor((-500.0, 500.0), (-500.0, 500.0), -0.05, "black")


def lamp_room():
    s = Scene("lamp", False)
    x, y, z = (0.0, 6.0), (0.0, 3.0), (0.0, 4.0)
    s.floor(x, z, 0.0, "wood")
    s.lit_ceiling(x, z, 3.0, [(2.4, 3.6)], (1.7, 2.3))
    s.walls(x, y, z, "white")
    s.box((1.0, 2.4), (0.01, 0.74), (1.0, 1.8), "grey")
    s.box((4.6, 5.6), (0.01, 2.0), (0.05, 0.6), "dark")
    s.zones = [((0.2, 5.8), (0.85, 0.85), (2.0, 3.8))]
    return s


def window_room():
    s = Scene("window", True)
    s.under_sky()
    x, y, z = (0.0, 5.0), (0.0, 2.8), (0.0, 6.0)
    s.floor(x, z, 0.0, "grey")
    s.ceiling(x, z, 2.8, "white")
    s.along_x(x, y, 0.0, "white")
    for side in x:
        s.along_z(side, y, z, "white")
    s.with_opening(x, y, 6.0, (1.0, 4.0), (0.9, 2.3), "white")
    s.zones = [((0.3, 4.7), (0.85, 0.85), (0.5, 5.5))]
    return s


def corridor():
    s = Scene("corridor", False)
    x, y, z = (0.0, 12.0), (0.0, 2.5), (0.0, 2.0)
    s.floor(x, z, 0.0, "grey")
    s.lit_ceiling(x, z, 2.5, [(0.8 + 2 * i, 1.2 + 2 * i) for i in range(6)], (0.85, 1.15))
    s.walls(x, y, z, "white")
    s.zones = [((0.2, 11.8), (0.05, 1.5), (0.2, 1.8))]
    return s


def court():
    s = Scene("court", True)
    s.under_sky()
    s.floor((0.0, 10.0), (0.0, 10.0), 0.0, "grey")
    s.walls((0.0, 10.0), (0.0, 8.0), (0.0, 10.0), "white")
    s.ceiling((0.0, 10.0), (0.0, 2.5), 3.0, "white")
    s.floor((0.0, 10.0), (0.0, 2.5), 3.1, "white")
    for i in range(5):
        s.box((0.9 + 2 * i, 1.2 + 2 * i), (0.01, 2.99), (2.1, 2.4), "white")
    s.zones = [((0.3, 9.7), (1.0, 1.0), (0.3, 1.9)), ((0.3, 9.7), (1.0, 1.0), (2.7, 9.7))]
    return s


def through_a_door():
    s = Scene("door", False)
    x, y = (0.0, 4.0), (0.0, 2.6)
    s.floor(x, (0.0, 8.0), 0.0, "wood")
    s.lit_ceiling(x, (0.0, 8.0), 2.6, [(0.4, 1.2)], (0.4, 1.2))
    s.walls(x, y, (0.0, 8.0), "white")
    s.with_opening(x, y, 4.0, (1.5, 2.5), (0.0, 2.1), "white")
    s.zones = [((0.3, 3.7), (0.85, 0.85), (4.3, 7.7))]
    return s


SCENES = [lamp_room, window_room, corridor, court, through_a_door]


def sensors(scene):
    """Points in the zones; two thirds face up, the others any way."""
    chance = random.Random(7)
    made = []
    for i in range(POINTS):
        zone = chance.choice(scene.zones)
        at = [chance.uniform(*side) for side in zone]
        facing = (0.0, 1.0, 0.0)
        if i % 3 == 2:
            up = chance.uniform(-0.5, 1.0)
            turn = chance.uniform(0.0, 2.0 * math.pi)
            level = math.sqrt(1.0 - up * up)
            facing = (level * math.cos(turn), up, level * math.sin(turn))
        made.append((*at, *facing))
    return made


def write_obj(scene, folder):
    lines, number = ["mtllib scene.mtl"], 0
    for corners, paint in scene.quads:
        lines.append(f"usemtl {paint}")
        lines += ["v %.9g %.9g %.9g" % corner for corner in corners]
        lines.append("f " + " ".join(str(number + i) for i in range(1, 5)))
        number += 4
    (folder / "scene.obj").write_text("\n".join(lines) + "\n")
    paints = [f"newmtl {name}\nKd {v} {v} {v}\n" for name, v in PAINTS.items()]
    paints.append(f"newmtl lamp\nKd 0 0 0\nKe {LAMP_RADIANCE} {LAMP_RADIANCE} {LAMP_RADIANCE}\n")
    (folder / "scene.mtl").write_text("\n".join(paints))
    sidecar = 'unit = "m"\n'
    if scene.has_sky:
        z = OVERCAST_ZENITH
        sidecar += f'[sky]\nkind = "overcast"\nzenith = [{z}, {z}, {z}]\nground = [0, 0, 0]\n'
    (folder / "scene.afterimage.toml").write_text(sidecar)
    return folder / "scene.obj"


def write_rad(scene, folder):
    """The scene for Radiance, with +Z up as its skies need it: (x, y, z) becomes (x, -z, y)."""
    lines = []
    for name, v in PAINTS.items():
        lines.append(f"void plastic {name}\n0\n0\n5 {v} {v} {v} 0 0")
    lines.append(f"void light lamp\n0\n0\n3 {LAMP_RADIANCE} {LAMP_RADIANCE} {LAMP_RADIANCE}")
    for i, (corners, paint) in enumerate(scene.quads):
        numbers = " ".join("%.9g %.9g %.9g" % (x, -z, y) for x, y, z in corners)
        lines.append(f"{paint} polygon quad{i}\n0\n0\n12 {numbers}")
    if scene.has_sky:
        # The standard overcast sky: zenith (1 + 2 sin(elevation)) / 3.
        (folder / "sky.cal").write_text(f"bright = {OVERCAST_ZENITH} * (1 + 2 * Dz) / 3;\n")
        lines.append("void brightfunc shade\n2 bright sky.cal\n0\n0")
        lines.append("shade glow sky\n0\n0\n4 1 1 1 0")
        lines.append("sky source above\n0\n0\n4 0 0 1 180")
    (folder / "scene.rad").write_text("\n".join(lines) + "\n")


def ours(program, model, points, error):
    listed = model.parent / "points.txt"
    listed.write_text("\n".join(" ".join("%.9g" % v for v in p) for p in points) + "\n")
    command = [program, "measure", str(model), "--points", str(listed), "--error", str(error), "--json"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}:\n{done.stderr}")
    result = json.loads(done.stdout)
    return [point[3] / LUX_PER_UNIT for point in result["points"]], result


def theirs(folder, tools, points, options):
    environment = dict(os.environ, RAYPATH=f".:{tools.parent / 'lib'}", PATH=f"{tools}:{os.environ['PATH']}")
    with open(folder / "scene.oct", "wb") as octree:
        subprocess.run([tools / "oconv", "scene.rad"], cwd=folder, stdout=octree, env=environment, check=True)
    text = "\n".join("%.9g %.9g %.9g %.9g %.9g %.9g" % (x, -z, y, dx, -dz, dy) for x, y, z, dx, dy, dz in points)
    command = [tools / "rtrace", "-I", "-h", "-ab", "12", "-aa", "0", "-ad", str(options.divisions), "-as", "0"]
    command += ["-lw", "1e-7", "-lr", "-12", "-dj", "1", "-ds", "0.02", "-dt", "0", "-n", str(options.threads)]
    done = subprocess.run(
        [*command, "scene.oct"],
        cwd=folder, input=text + "\n", capture_output=True, text=True, env=environment, check=True,
    )  # fmt: skip
    return [float(line.split()[1]) for line in done.stdout.splitlines() if line.strip()]


def compare(make, options, tools):
    scene = make()
    points = sensors(scene)
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary)
        write_rad(scene, folder)
        mine, result = ours(options.program, write_obj(scene, folder), points, options.error)
        other = theirs(folder, tools, points, options)
    if len(other) != len(mine):
        sys.exit(f"{scene.name}: rtrace returned {len(other)} values for {len(mine)} points")
    mean = sum(mine) / sum(other) - 1.0
    off = sorted(abs(a - b) / b for a, b in zip(mine, other))
    found = {
        "scene": scene.name,
        "mean_percent": 100.0 * mean,
        "median_point_percent": 100.0 * off[len(off) // 2],
        "p95_point_percent": 100.0 * off[math.ceil(0.95 * len(off)) - 1],
        "our_secs": result["secs"],
        "our_error_percent": result["error_percent"],
    }
    holds = abs(mean) <= MEAN_TOLERANCE and found["p95_point_percent"] <= 100.0 * POINT_TOLERANCE
    print(
        f"{scene.name:9} mean {found['mean_percent']:+.2f} %, points: median {found['median_point_percent']:.2f} %, "
        f"95th percentile {found['p95_point_percent']:.2f} %  {'ok' if holds else 'FAILS'}",
        flush=True,
    )
    return holds, found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--error", type=float, default=1.0, help="standard error of our points, percent")
    parser.add_argument("--divisions", type=int, default=4096, help="ambient divisions of rtrace")
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--scenes", default="", help="names, separated by commas [default: all]")
    parser.add_argument("--json", metavar="FILE")
    options = parser.parse_args()
    options.program = str(Path(options.program).resolve())
    try:
        import pyradiance
    except ImportError:
        print("SKIPPED: pyradiance is not installed")
        return 0
    tools = Path(pyradiance.__file__).parent / "bin"
    wanted = [name for name in options.scenes.split(",") if name]
    chosen = [make for make in SCENES if not wanted or make().name in wanted]
    results = [compare(make, options, tools) for make in chosen]
    if options.json:
        Path(options.json).write_text(json.dumps([found for _, found in results], indent=1) + "\n")
    is_good = bool(results) and all(holds for holds, _ in results)
    print("all checks hold" if is_good else "A CHECK FAILS")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
