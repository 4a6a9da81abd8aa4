#!/usr/bin/env python3
"""A worker built with -DPENUMBRA_EFFECTS=OFF builds, gives the same bits for scenes that call for no effect, and says what it
leaves out of the others. (What the effects cost such scenes in time: tests/bench/needs.)"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

MIXES = ["bsdf:1+line-sa@v:1", "sa:2/pixel=line", "line-area@0:1+line-area@90:1/average"]


def build_worker(options):
    """The worker alone. A sanitizer's build, or one with other flags, is compared with a plain one: bits are the same."""
    build = options.build
    environment = {"CCACHE_BASEDIR": str(options.source), "CCACHE_NOHASHDIR": "1", **os.environ}
    for words in ([options.cmake, "-S", options.source, "-B", build, "-G", "Ninja", "-DPENUMBRA_EFFECTS=OFF",
                   "-DPENUMBRA_TESTS=OFF", f"-DCMAKE_BUILD_TYPE={options.build_type}"],
                  [options.cmake, "--build", build, "--target", "penumbra_worker"]):
        done = subprocess.run([str(w) for w in words], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              env=environment, check=False)
        if done.returncode != 0:
            sys.exit(f"{' '.join(map(str, words))}\n{done.stdout[-4000:]}")
    return build / "bin/penumbra-worker"


def programs_with(worker, options, folder):
    """The client looks for its workers beside itself."""
    folder.mkdir()
    for program in options.programs[:2]:
        shutil.copy(program, folder)
    shutil.copy(worker, folder)
    return folder / "penumbra"


def render(client, scene, out, *words):
    done = subprocess.run([str(client), "render", str(scene), "--out", str(out), "--workers", "2", "--json", *words],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"{client}: exit code {done.returncode}\n{done.stderr}")
    return json.loads(done.stdout), done.stderr


def check_same_bits(options, with_effects, without, scratch):
    words = ["--spp", "8", "--resolution", "64x48", "--seed", "3", *[w for mix in MIXES for w in ("--mix", mix)]]
    for name in ("tests/gate/scene.pbrt", "scenes/gallery/pergola.pbrt"):
        scene = options.source / name
        runs = [render(client, scene, scratch / f"{i}-{scene.stem}", *words)
                for i, client in enumerate((with_effects, without))]
        for mixes in zip(*(run["mixes"] for run, _ in runs)):
            images = [scratch / f"{i}-{scene.stem}" / mix["image"] for i, mix in enumerate(mixes)]
            done = subprocess.run([str(with_effects), "compare", *map(str, images), "--json"], stdout=subprocess.PIPE,
                                  check=True)
            if json.loads(done.stdout)["mse"] != 0:
                sys.exit(f"{name}, {mixes[0]['mix']}: another picture without effects")
            if [mix["rays"] for mix in mixes] != [mixes[0]["rays"]] * 2:
                sys.exit(f"{name}, {mixes[0]['mix']}: another number of rays without effects")


def check_named(options, without, scratch):
    for name, effect in (("lens", "lens"), ("moving-lights", "motion"), ("fog", "media")):
        run, told = render(without, options.source / f"scenes/gallery/{name}.pbrt", scratch / name, "--spp", "1",
                           "--resolution", "32x24", "--mix", "sa:1")
        if not any(effect in warning for warning in run["warnings"]):
            sys.exit(f"{name}: nothing says that {effect} is left out: {run['warnings']}\n{told}")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--source", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path)
    parser.add_argument("--build-type")
    parser.add_argument("--cmake")
    parser.add_argument("--programs", nargs=3, type=pathlib.Path)
    options = parser.parse_args()
    worker = build_worker(options)
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        with_effects = programs_with(options.programs[2], options, scratch / "with")
        without = programs_with(worker, options, scratch / "without")
        check_same_bits(options, with_effects, without, scratch)
        check_named(options, without, scratch)


if __name__ == "__main__":
    main()
