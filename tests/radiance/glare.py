#!/usr/bin/env python3
"""Compares the glare that `afterimage glare` finds with that of Evalglare, which Radiance brings.

    /tmp/venv/bin/python tests/radiance/glare.py target/release/afterimage --json result.json

A room with a window to an overcast sky (that of compare.py), seen from three places. `rpict` renders
the half sphere before the eye, and Evalglare finds vertical illuminance and DGP in it, with the same
constant threshold of 2,000 cd/m2. The vertical illuminances must agree within 5 %, and the DGP within
0.02.

Exit codes: 0 all checks hold, or pyradiance is not installed (SKIPPED is printed); 1 a check fails.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

from compare import LUX_PER_UNIT, window_room, write_obj, write_rad

EV_TOLERANCE = 0.05
DGP_TOLERANCE = 0.02
# Radiance counts 179 lm/W.
LUMENS_PER_WATT = 179.0
VIEWS = {
    "at the window": ((2.5, 1.2, 3.0), (2.5, 1.4, 6.0)),
    "at the side": ((2.5, 1.2, 4.5), (0.0, 1.2, 5.5)),
    "from the back": ((2.5, 1.2, 0.8), (2.5, 1.2, 6.0)),
}


def run(command, **options):
    done = subprocess.run([str(part) for part in command], capture_output=True, check=False, **options)
    if done.returncode != 0:
        sys.exit(f"{' '.join(map(str, command))}:\n{done.stderr.decode(errors='replace')}")
    return done.stdout


def ours(program, model, eye, target):
    place = [f"--eye={','.join(map(str, eye))}", f"--look-at={','.join(map(str, target))}"]
    return json.loads(run([program, "glare", model, *place, "--rays", "16", "--json"]))


def theirs(folder, tools, eye, target):
    """Vertical illuminance and DGP by Evalglare."""
    paths = {"RAYPATH": f".:{tools.parent / 'lib'}", "PATH": f"{tools}:{os.environ['PATH']}"}
    options = {"cwd": folder, "env": dict(os.environ, **paths)}
    (folder / "scene.oct").write_bytes(run([tools / "oconv", "scene.rad"], **options))
    turned = [eye[0], -eye[2], eye[1]]
    way = [target[0] - eye[0], -(target[2] - eye[2]), target[1] - eye[1]]
    view = ["-vta", "-vv", 180, "-vh", 180, "-vp", *turned, "-vd", *way, "-vu", 0, 0, 1]
    # Without ambient interpolation: the ground is so wide that its cells would leak through walls.
    quality = ["-ab", 5, "-ad", 64, "-as", 0, "-aa", 0, "-lw", 2e-3, "-lr", -8]
    picture = run([tools / "rpict", *view, "-x", 300, "-y", 300, "-ps", 1, *quality, "scene.oct"], **options)
    (folder / "view.hdr").write_bytes(picture)
    # The units of the models: luminance for a radiance of one.
    scaled = run([tools / "pcomb", "-s", LUX_PER_UNIT / LUMENS_PER_WATT, "view.hdr"], **options)
    (folder / "scaled.hdr").write_bytes(scaled)
    view = ["-vta", "-vv", 180, "-vh", 180]
    text = run([tools / "evalglare", *view, "-b", 2000, "-d", "scaled.hdr"], **options).decode()
    # "dgp,av_lum,E_v,...: 0.31 220.9 1325.3 ..."
    numbers = next(line for line in text.splitlines() if line.startswith("dgp,")).split(":")[1].split()
    return float(numbers[2]), float(numbers[0]), text


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--json", metavar="FILE")
    parser.add_argument("--verbose", action="store_true", help="print what Evalglare says")
    options = parser.parse_args()
    try:
        import pyradiance
    except ImportError:
        print("SKIPPED: pyradiance is not installed")
        return 0
    tools, program = Path(pyradiance.__file__).parent / "bin", Path(options.program).resolve()
    results, is_good = [], True
    for name, (eye, target) in VIEWS.items():
        scene = window_room()
        with tempfile.TemporaryDirectory() as temporary:
            folder = Path(temporary)
            write_rad(scene, folder)
            mine = ours(program, write_obj(scene, folder), eye, target)
            ev, dgp, text = theirs(folder, tools, eye, target)
        if options.verbose:
            print(text)
        holds = abs(mine["ev_lux"] / ev - 1.0) <= EV_TOLERANCE and abs(mine["dgp"] - dgp) <= DGP_TOLERANCE
        is_good &= holds
        results.append({"view": name, "ev_lux": mine["ev_lux"], "evalglare_ev": ev, "dgp": mine["dgp"], "evalglare_dgp": dgp})
        print(
            f"{name:14} Ev {mine['ev_lux']:.0f} and {ev:.0f} lx, DGP {mine['dgp']:.3f} +-{mine['dgp_error']:.3f} and "
            f"{dgp:.3f}  {'ok' if holds else 'FAILS'}",
            flush=True,
        )
    if options.json:
        Path(options.json).write_text(json.dumps(results, indent=1) + "\n")
    print("all checks hold" if is_good else "A CHECK FAILS")
    return 0 if is_good else 1


if __name__ == "__main__":
    sys.exit(main())
