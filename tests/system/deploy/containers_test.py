"""deploy/containers without a container engine: the packages that an image gets hold every library that its program
loads, and the Containerfile's stages and files fit together.

    containers_test.py DEPLOY_FOLDER SERVER WORKER CLIENT
"""
import os
import pathlib
import re
import shutil
import subprocess
import sys
import unittest

DEPLOY, SERVER, WORKER, CLIENT = sys.argv[1:5]
TEXT = (pathlib.Path(DEPLOY) / "containers" / "Containerfile").read_text().replace("\\\n", " ")
# In every Debian image.
BASE = {"libc6", "libgcc-s1"}


def stages():
    """Stage -> (what it is built from, its lines)."""
    found, name = {}, None
    for line in TEXT.splitlines():
        start = re.match(r"FROM (\S+) AS (\S+)", line)
        if start:
            name = start[2]
            found[name] = (start[1], [])
        elif name:
            found[name][1].append(line)
    return found


def packages_of(stage):
    base, lines = stages()[stage]
    installed = set(re.findall(r"\b(lib[a-z0-9+.-]+|zlib1g)\b", " ".join(l for l in lines if "apt-get install" in l)))
    return installed | (packages_of(base) if base in stages() else set())


def needed(program):
    """Packages of the libraries that the program itself names."""
    names = re.findall(r"\(NEEDED\).*\[(\S+)\]", subprocess.run(["readelf", "-d", program], capture_output=True, text=True, check=True).stdout)
    where = dict(re.findall(r"(\S+) => (\S+)", subprocess.run(["ldd", program], capture_output=True, text=True, check=True).stdout))
    real = {os.path.realpath(where[name]) for name in names if name in where}
    # /lib and /usr/lib are one, but dpkg knows each file by one of them. One question: each reads all its lists.
    owners = {}
    for line in subprocess.run(["dpkg", "-S", *real, *(path.removeprefix("/usr") for path in real)], capture_output=True,
                               text=True).stdout.splitlines():
        package, path = line.split(": ", 1)
        owners["/usr" + path.removeprefix("/usr")] = package.split(":")[0]
    unknown = {path for path in real if "/usr" + path.removeprefix("/usr") not in owners}
    if unknown:
        raise AssertionError(f"no package has {unknown}")
    return set(owners.values())


class Containers(unittest.TestCase):
    def test_images_hold_the_libraries_of_their_programs(self):
        for stage, program in (("client", CLIENT), ("server", SERVER), ("worker", WORKER)):
            self.assertEqual(needed(program) - BASE - packages_of(stage), set(), stage)

    def test_none_runs_as_root(self):
        for stage in ("client", "server", "worker"):
            users = [line.split()[1] for line in stages()[stage][1] if line.startswith("USER")]
            self.assertEqual(users[-1], "10001:10001")

    def test_programs_and_stages_exist(self):
        for stage, (base, lines) in stages().items():
            self.assertTrue(base in stages() or base.startswith("docker.io/library/debian:12"), base)
            for line in lines:
                copied = re.match(r"COPY --from=(\S+) /src/build/bin/(\S+) ", line)
                if copied:
                    self.assertIn(copied[1], stages())
                    self.assertIn(copied[2], [os.path.basename(p) for p in (SERVER, WORKER, CLIENT)])


if __name__ == "__main__":
    if not shutil.which("dpkg"):
        print("SKIPPED: dpkg not there")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
