"""deploy/systemd without systemd running: its own checker reads the units, and what they say fits the programs.

    systemd_test.py DEPLOY_FOLDER SERVER WORKER
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

DEPLOY, SERVER, WORKER = sys.argv[1:4]
UNITS = {"penumbra-server.service": SERVER, "penumbra-worker@.service": WORKER}
# Of systemd's own scale, 0 (nothing is exposed) to 10.
MOST_EXPOSED = 20  # tenths


def text_of(unit):
    return (pathlib.Path(DEPLOY) / "systemd" / unit).read_text()


def analyze(*arguments):
    return subprocess.run(["systemd-analyze", *map(str, arguments)], capture_output=True, text=True)


class Units(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="penumbra_systemd_")
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        for unit, program in UNITS.items():
            # The checker looks for the programs; here they lie in the build tree.
            text = re.sub(r"/usr/local/bin/penumbra-\w+", program, text_of(unit))
            (self.folder / unit).write_text(re.sub(r"Documentation=.*\n", "", text))

    def test_systemd_accepts_them(self):
        for unit in ("penumbra-server.service", "penumbra-worker@1.service"):
            done = analyze("verify", "--man=no", self.folder / unit)
            about_ours = [line for line in done.stderr.splitlines() if "penumbra" in line]
            self.assertEqual((done.returncode, about_ours), (0, []), unit)

    def test_little_is_exposed(self):
        for unit in ("penumbra-server.service", "penumbra-worker@1.service"):
            done = analyze("security", "--offline=true", f"--threshold={MOST_EXPOSED}", "--no-pager", self.folder / unit)
            self.assertEqual(done.returncode, 0, done.stdout[-300:] + done.stderr)

    def test_flags_exist(self):
        for unit, program in UNITS.items():
            known = set(re.findall(r"--[a-z-]+", subprocess.run([program, "--help"], capture_output=True, text=True).stdout))
            start = re.search(r"ExecStart=((?:.*\\\n)*.*)", text_of(unit))[1]
            for flag in re.findall(r" (--[a-z-]+)", start):
                self.assertIn(flag, known, unit)

    def test_credentials_are_those_that_flags_name(self):
        for unit in UNITS:
            loaded = set(re.findall(r"LoadCredential=(\w+):", text_of(unit)))
            self.assertEqual(set(re.findall(r"%d/(\w+)", text_of(unit))), loaded)

    def test_a_stop_lasts_longer_than_a_drain(self):
        for unit in UNITS:
            seconds = int(re.search(r"TimeoutStopSec=(\d+)", text_of(unit))[1])
            self.assertGreater(seconds, 10, "a worker drains for up to 4.5 s")
            self.assertRegex(text_of(unit), r"Restart=(always|on-failure)")


if __name__ == "__main__":
    if not shutil.which("systemd-analyze"):
        print("SKIPPED: systemd-analyze not there; see deploy/packages-farm.txt")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
