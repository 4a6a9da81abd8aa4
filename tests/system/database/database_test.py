"""--database: jobs in a real PostgreSQL, one server that leads and one that stands by.

    database_test.py PENUMBRA SERVER WORKER SCENE.pbrt
"""
import pathlib
import re
import socket
import subprocess
import sys
import tempfile
import time
import unittest

import postgres

PENUMBRA, SERVER, WORKER, SCENE = sys.argv[1:5]
PICTURE = ["--resolution", "96x54", "--tile", "16", "--spp", "32", "--mix", "sa:2", "--mix", "bsdf:1+line-sa@v:1"]
LAYERS = "R,G,B,variance.R,variance.G,variance.B,samples"
TAKEOVER_SECONDS = 10


class Leaders(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.rendered = tempfile.TemporaryDirectory(prefix="penumbra_database_")
        cls.addClassCleanup(cls.rendered.cleanup)
        cls.alone = pathlib.Path(cls.rendered.name)
        subprocess.run([PENUMBRA, "render", SCENE, *PICTURE, "--quiet", "--workers", "1", "--out", cls.alone], check=True)

    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="penumbra_database_")
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        self.folder.chmod(0o755)
        self.database = postgres.Postgres(self.folder / "pg")
        self.addCleanup(self.database.stop)
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"127.0.0.1:{free.getsockname()[1]}"
        self.started = 0

    def spawn(self, *command):
        self.started += 1
        path = self.folder / f"{self.started}.log"
        log = open(path, "wb")
        process = subprocess.Popen([str(word) for word in command], stderr=log)
        process.log = path
        log.close()

        def end():
            process.terminate()
            process.wait(30)

        self.addCleanup(end)
        return process

    def server(self, *flags):
        """Both listen at the same address, as behind a name that follows the leader."""
        return self.spawn(SERVER, "--listen", self.address, "--store", self.folder / "store", "--database", self.database.url, *flags)

    def says(self, process, text, seconds=60):
        start = time.monotonic()
        while text not in process.log.read_text():
            self.assertLess(time.monotonic() - start, seconds, f"'{text}' is missing:\n{process.log.read_text()}")
            time.sleep(0.05)
        return time.monotonic() - start

    def pair(self):
        leader = self.server()
        self.says(leader, "listening")
        standby = self.server()
        self.says(standby, "standing by")
        return leader, standby

    def penumbra(self, *words):
        done = subprocess.run([PENUMBRA, *map(str, words)], capture_output=True, text=True, timeout=600)
        self.assertEqual(done.returncode, 0, f"{words}: {done.stderr}")
        return done.stdout

    def begin(self):
        self.spawn(WORKER, "--server", self.address, "--threads", "1", "--cache", self.folder / "cache")
        job = self.penumbra("submit", SCENE, *PICTURE, "--server", self.address).strip()
        start = time.monotonic()
        while int(self.database.ask("SELECT count(*) FROM results")) < 3:
            self.assertLess(time.monotonic() - start, 120)
            time.sleep(0.05)
        return job

    def finish(self, job):
        self.penumbra("wait", job, "--server", self.address)
        self.penumbra("fetch", job, "--out", self.folder / "shared", "--server", self.address)
        images = sorted(path.name for path in self.alone.glob("*.exr"))
        self.assertEqual(len(images), 2)
        for image in images:
            done = subprocess.run(["oiiotool", self.folder / "shared" / image, "--ch", LAYERS, self.alone / image, "--ch",
                                   LAYERS, "--fail", "0", "--warn", "0", "--diff"], capture_output=True, text=True)
            self.assertEqual(done.returncode, 0, f"{image}: {done.stdout}{done.stderr}")
        self.assertIn("debug rendered", self.penumbra("logs", job, "--tile", "0", "--server", self.address))

    def test_a_killed_leader_is_followed_within_seconds(self):
        leader, standby = self.pair()
        job = self.begin()
        kept = int(self.database.ask("SELECT count(*) FROM results"))
        leader.kill()
        leader.wait()
        self.assertLess(self.says(standby, "listening"), TAKEOVER_SECONDS)
        self.assertGreaterEqual(int(self.database.ask("SELECT count(*) FROM results")), kept)
        self.assertEqual(self.database.ask("SELECT value FROM meta WHERE key = 'epoch'"), "2")
        self.finish(job)

    def test_a_leader_whose_lock_is_gone_can_commit_nothing(self):
        leader, standby = self.pair()
        job = self.begin()
        # The session that holds the lock ends, its server does not know.
        self.database.ask("SELECT pg_terminate_backend(pid) FROM pg_locks WHERE locktype = 'advisory' AND granted")
        self.assertEqual(leader.wait(TAKEOVER_SECONDS), 1)
        self.assertLess(self.says(standby, "listening"), TAKEOVER_SECONDS)
        self.finish(job)

    def test_an_epoch_that_has_passed_is_fenced(self):
        leader = self.server()
        self.says(leader, "listening")
        # As a new leader would, while the old one still has its connection.
        self.database.ask("UPDATE meta SET value = value + 1 WHERE key = 'epoch'")
        self.assertEqual(leader.wait(TAKEOVER_SECONDS), 1)
        self.assertRegex(leader.log.read_text(), "another server leads: epoch 2, not 1")

    def test_a_standby_ends_when_asked_to(self):
        _, standby = self.pair()
        standby.terminate()
        self.assertEqual(standby.wait(5), 0)

    def test_a_store_with_jobs_of_its_own_is_refused(self):
        alone = self.spawn(SERVER, "--listen", self.address, "--store", self.folder / "store")
        self.says(alone, "listening")
        alone.terminate()
        alone.wait(10)
        process = self.server()
        self.assertEqual(process.wait(30), 2)
        self.assertRegex(process.log.read_text(), "--database: .* was used without it")

    def test_refusals_name_the_flag(self):
        for url, text in (("postgresql:///none?host=/nowhere", "--database: "),):
            process = self.spawn(SERVER, "--listen", self.address, "--store", self.folder / "store", "--database", url)
            self.assertEqual(process.wait(30), 1, "a database that is away may come back")
            self.assertRegex(process.log.read_text(), text)
        for url in ("postgresql://[half/name", "postgresql://me:secret@localhost/name"):
            process = self.spawn(SERVER, "--listen", self.address, "--store", self.folder / "store", "--database", url)
            self.assertEqual(process.wait(30), 2)
            self.assertNotIn("secret", process.log.read_text())
        self.says(self.server(), "listening")  # makes the schema
        self.database.ask("UPDATE meta SET value = 99 WHERE key = 'schema'")
        self.database.ask("SELECT pg_terminate_backend(pid) FROM pg_locks WHERE locktype = 'advisory' AND granted")
        newer = self.server()
        self.assertEqual(newer.wait(30), 2)
        self.assertIn("schema 99 is newer than this program's 1", newer.log.read_text())


if __name__ == "__main__":
    if postgres.programs() is None:
        print("SKIPPED: PostgreSQL is not there; see deploy/packages-farm.txt")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1] + sys.argv[5:], verbosity=2)
