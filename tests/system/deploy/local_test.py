"""deploy/local: a standing cluster on this machine, started, used, damaged, stopped.

    local_test.py SOURCE_FOLDER BUILD_FOLDER SCENE.pbrt
"""
import os
import pathlib
import re
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

SOURCE, BUILD, SCENE = sys.argv[1:4]


def free_pair():
    """Two free ports, one after the other."""
    while True:
        with socket.socket() as one, socket.socket() as two:
            one.bind(("127.0.0.1", 0))
            try:
                two.bind(("127.0.0.1", one.getsockname()[1] + 1))
            except OSError:
                continue
            return one.getsockname()[1]


class Local(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="penumbra_local_")
        self.addCleanup(self.temporary.cleanup)
        root = pathlib.Path(self.temporary.name)
        # The script finds the programs beside itself, wherever this build lies.
        (root / "deploy").mkdir()
        (root / "deploy" / "local").symlink_to(pathlib.Path(SOURCE) / "deploy" / "local")
        (root / "build").symlink_to(BUILD)
        self.script = root / "deploy" / "local"
        self.port = free_pair()
        self.environment = {**os.environ, "PENUMBRA_LOCAL": str(root / "state"), "PENUMBRA_PORT": str(self.port)}
        self.addCleanup(self.local, "stop")

    def local(self, *words):
        return subprocess.run([self.script, *words], env=self.environment, capture_output=True, text=True, timeout=120)

    def penumbra(self, *words):
        done = subprocess.run([f"{BUILD}/bin/penumbra", *map(str, words), "--server", f"127.0.0.1:{self.port}"], capture_output=True,
                              text=True, timeout=300)
        self.assertEqual(done.returncode, 0, done.stderr)
        return done.stdout

    def processes(self):
        return [int(pid) for pid in re.findall(r"process (\d+)", self.local("status").stdout)]

    def test_start_use_damage_stop(self):
        self.assertEqual(self.local("status").returncode, 1)
        self.assertEqual(self.local("dance").returncode, 2)
        started = self.local("start", "2", "1")
        self.assertEqual(started.returncode, 0, started.stderr)
        self.assertIn(f"PENUMBRA_SERVER=127.0.0.1:{self.port}", started.stdout)
        self.assertEqual(len(self.processes()), 3)
        again = self.local("start")
        self.assertEqual(again.returncode, 1)
        self.assertIn("stop it first", again.stderr)

        job = self.penumbra("submit", SCENE, "--resolution", "64x36", "--spp", "1", "--mix", "sa:1").strip()
        self.penumbra("wait", job)
        victim = self.processes()[0]
        os.kill(victim, signal.SIGKILL)
        end = time.monotonic() + 10
        while self.local("status").returncode == 0 and time.monotonic() < end:
            time.sleep(0.1)
        status = self.local("status")
        self.assertEqual(status.returncode, 1)
        self.assertIn("has ended", status.stdout)

        running = self.processes()
        self.assertEqual(self.local("stop").returncode, 0)
        for pid in running:
            # A zombie that this machine's process 1 has not waited for yet has no program any more.
            self.assertFalse(os.path.exists(f"/proc/{pid}/exe"), pid)
        self.assertEqual(self.local("start", "1").returncode, 0)
        self.assertIn(job, self.penumbra("jobs"), "jobs stay")


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
