"""Small real runs for the tests, rendered by the program itself."""
import pathlib
import subprocess

MIXES = ["bsdf:4", "sa:4", "bsdf:1+line-sa@v:3"]
SIZE = "96x54"


def penumbra(program, *arguments):
    done = subprocess.run([program, *map(str, arguments)], capture_output=True, text=True, timeout=900)
    if done.returncode != 0:
        raise RuntimeError(f"penumbra {arguments}: exit {done.returncode}\n{done.stderr}")
    return done.stdout


def render(program, scene, out, *options, mixes=MIXES):
    flags = [flag for mix in mixes for flag in ("--mix", mix)]
    size = () if "--resolution" in options else ("--resolution", SIZE, "--tile", 32)
    penumbra(program, "render", scene, *size, "--out", out, "--quiet", *flags, *options)
    return pathlib.Path(out)


def with_reference(program, scene, folder):
    reference = render(program, scene, folder / "reference", "--spp", 48, "--seed", 99, mixes=["bsdf:1+sa:3"])
    image = next(reference.glob("*.exr"))
    return render(program, scene, folder / "run", "--budget", "400ms", "--reference", image,
                  "--region", "shade=24,24,60,50", "--region", "sky=0,0,32,16")


def without_reference(program, scene, folder):
    return render(program, scene, folder / "alone", "--spp", 16, "--region", "shade=24,24,60,50")


def large(program, scene, folder):
    """Of more pixels than the page shows; 1101 and 961 are odd, so that the last column and row stand for fewer."""
    size = ("--resolution", "1101x961", "--tile", 256)
    reference = render(program, scene, folder / "large-reference", "--spp", 1, "--seed", 99, *size, mixes=["sa:1"])
    image = next(reference.glob("*.exr"))
    return render(program, scene, folder / "large", "--spp", 2, "--reference", image, *size, mixes=["sa:1", "bsdf:1"])


def transient(program, scene, folder):
    return render(program, scene, folder / "transient", "--spp", 4, "--transient", "0,40,10", mixes=["sa:1", "line-sa@u:1"])
