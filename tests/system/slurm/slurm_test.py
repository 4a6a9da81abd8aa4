"""deploy/slurm on a Slurm of its own: workers come as array tasks when there is work, one is preempted and one requeued,
the picture is the one that this machine renders alone, and no worker stays.

    slurm_test.py PENUMBRA SERVER WORKER SCENE.pbrt DEPLOY_SLURM_FOLDER
"""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

import slurm

PENUMBRA, SERVER, WORKER, SCENE, DEPLOY = sys.argv[1:6]
PICTURE = ["--resolution", "320x180", "--tile", "32", "--spp", "96", "--mix", "sa:2", "--mix", "bsdf:1+line-sa@v:1", "--quiet"]
LAYERS = "R,G,B,variance.R,variance.G,variance.B,samples"


def processes_of(name):
    """Ids of the processes that run a program and have this test's folder on their command line."""
    found = []
    for entry in pathlib.Path("/proc").glob("[0-9]*/cmdline"):
        try:
            if name.encode() in entry.read_bytes():
                found.append(int(entry.parent.name))
        except OSError:
            pass  # it has just ended
    return found


class Farm(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="penumbra_slurm_")
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        self.folder.chmod(0o755)  # munged's user must reach its own folder
        self.slurm = slurm.Slurm(self.folder)
        self.addCleanup(self.slurm.stop)
        self.environment = {**self.slurm.environment, "PENUMBRA_WORKER": WORKER, "PENUMBRA_RESERVE": "30",
                            "PENUMBRA_CACHE": str(self.folder / "cache")}
        self.start_server()

    def spawn(self, *command):
        log = open(self.folder / f"{pathlib.Path(command[0]).name}.log", "wb")
        process = subprocess.Popen([str(word) for word in command], env=self.environment, stderr=log, cwd=self.folder)
        log.close()

        def end():
            process.terminate()
            process.wait(30)

        self.addCleanup(end)
        return process

    def start_server(self):
        address = self.folder / "address"
        self.spawn(SERVER, "--listen", "127.0.0.1:0", "--store", self.folder / "store", "--address-file", address,
                   "--http", "127.0.0.1:0")
        slurm.until("the server's address", 30, address.exists)
        self.address = address.read_text().strip()
        log = (self.folder / "penumbra-server.log").read_text()
        self.metrics = re.search(r"dashboard on (\S+)", log).group(1) + "/metrics"

    def penumbra(self, *arguments):
        done = subprocess.run([PENUMBRA, *map(str, arguments)], env={**self.environment, "PENUMBRA_SERVER": self.address},
                              capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, 0, f"{arguments}: {done.stderr}")
        return done.stdout

    def autoscale(self, *more):
        return [os.path.join(DEPLOY, "autoscale"), "--server", self.address, "--metrics", self.metrics, "--most", "2",
                "--tasks-per-worker", "4", "--idle", "3s", *more, "--", "--time=10", "--cpus-per-task=1",
                f"--output={self.folder}/worker-%A_%a.out"]

    def running(self):
        return [task for task, state in self.slurm.tasks().items() if state == "R"]

    def pictures_are_alike(self, ours, alone):
        images = sorted(path.name for path in alone.glob("*.exr"))
        self.assertEqual(len(images), 2)
        for image in images:
            done = subprocess.run(["oiiotool", ours / image, "--ch", LAYERS, alone / image, "--ch", LAYERS, "--fail", "0",
                                   "--warn", "0", "--diff"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, f"{image}: {done.stdout}{done.stderr}")

    def test_a_job_on_workers_that_slurm_takes_away(self):
        # Without work, no worker.
        subprocess.run(self.autoscale("--once"), env=self.environment, check=True, timeout=60)
        self.assertEqual(self.slurm.tasks(), {})

        job = self.penumbra("submit", SCENE, *PICTURE[:-1]).strip()
        scaler = self.spawn(*self.autoscale("--every", "1"))
        slurm.until("two workers run", 60, lambda: len(self.running()) == 2)
        slurm.until("both hold tiles", 60,
                    lambda: len(re.findall(r"holds [1-9]\d* of its", self.penumbra("explain", job))) == 2)

        preempted, requeued = sorted(self.running())
        self.slurm.run("scancel", "--batch", "--signal=TERM", preempted)
        slurm.until("the preempted worker has gone", 30, lambda: preempted not in self.slurm.tasks())
        slurm.until("another came in its place", 60, lambda: len(self.running()) == 2)
        self.slurm.run("scontrol", "requeue", requeued)
        slurm.until("the requeued worker waits", 30, lambda: self.slurm.tasks().get(requeued) in ("PD", "RQ", None))
        log = self.penumbra("log", job)
        self.assertIn("handed back", log, "nobody was disturbed: the job was over too early")

        self.penumbra("wait", job)
        self.penumbra("fetch", job, "--out", self.folder / "farm")
        slurm.until("no array task is left", 60, lambda: self.slurm.tasks() == {})
        self.assertEqual(processes_of(f"{self.folder}/cache"), [])
        self.assertIsNone(scaler.poll(), "autoscale has ended")

        self.penumbra("render", SCENE, *PICTURE, "--out", self.folder / "alone", "--workers", "1")
        self.pictures_are_alike(self.folder / "farm", self.folder / "alone")

    def test_the_walltime_is_told_and_kept(self):
        """A worker drains by itself before its time is up, and says so to the server."""
        self.environment["PENUMBRA_RESERVE"] = "55"
        self.slurm.run("scontrol", "update", "PartitionName=render", "MaxTime=1")
        subprocess.run(["sbatch", "--time=1", "--cpus-per-task=1", f"--output={self.folder}/worker.out",
                        os.path.join(DEPLOY, "worker.sbatch"), self.address], env=self.environment, check=True,
                       capture_output=True, timeout=60)
        slurm.until("the worker runs", 30, self.running)
        start = time.monotonic()
        slurm.until("the worker has gone", 40, lambda: not self.slurm.tasks())
        self.assertLess(time.monotonic() - start, 40)
        self.assertIn("--drain-after has passed", (self.folder / "worker.out").read_text())


if __name__ == "__main__":
    if slurm.missing():
        print(f"SKIPPED: {', '.join(slurm.missing())} not there; see deploy/packages-farm.txt")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
