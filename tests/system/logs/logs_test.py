"""What server and worker log: JSON lines with ids, no secret at any level, and a client that reads what workers said of
each tile without seeing their files.

    logs_test.py PENUMBRA SERVER WORKER SCENE.pbrt CERTS
"""
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time
import unittest

PENUMBRA, SERVER, WORKER, SCENE, CERTS = sys.argv[1:6]
TILES = 6  # of 96x64 in tiles of 32


class Logs(unittest.TestCase):
    def setUp(self):
        self.temporary = tempfile.TemporaryDirectory(prefix="penumbra_logs_")
        self.addCleanup(self.temporary.cleanup)
        self.folder = pathlib.Path(self.temporary.name)
        self.flags = []

    def spawn(self, name, *command):
        log = open(self.folder / f"{name}.log", "ab")
        process = subprocess.Popen([str(word) for word in command], stderr=log, stdout=log)
        log.close()

        def end():
            process.terminate()
            process.wait(30)

        self.addCleanup(end)
        return process

    def start_server(self, *flags):
        address = self.folder / "address"
        address.unlink(missing_ok=True)
        server = self.spawn("server", SERVER, "--listen", "127.0.0.1:0", "--store", self.folder / "store", "--address-file", address,
                            *flags)
        for _ in range(600):
            if address.exists() or server.poll() is not None:
                break
            time.sleep(0.05)
        self.assertIsNone(server.poll(), self.text("server"))
        self.address = address.read_text().strip()
        return server

    def start_worker(self, program, *flags):
        return self.spawn("worker", program, "--server", self.address, "--threads", "1", "--cache", self.folder / "cache", *flags)

    def text(self, name):
        return (self.folder / f"{name}.log").read_text()

    def lines(self, name):
        return [json.loads(line) for line in self.text(name).splitlines()]

    def penumbra(self, *words, code=0, flags=None):
        done = subprocess.run([PENUMBRA, *map(str, words), "--server", self.address, *(self.flags if flags is None else flags)],
                              capture_output=True, text=True, timeout=300)
        self.assertEqual(done.returncode, code, done.stderr)
        return done.stdout + done.stderr

    def submit(self):
        return self.penumbra("submit", SCENE, "--resolution", "96x64", "--tile", "32", "--spp", "4", "--mix", "sa:1").strip()

    def test_each_event_is_a_line_of_json_with_its_ids(self):
        self.start_server("--log-format", "json", "--log-level", "debug")
        self.start_worker(WORKER, "--log-format", "json", "--log-level", "debug")
        job = self.submit()
        self.penumbra("wait", job)
        for line in self.lines("server") + self.lines("worker"):
            self.assertRegex(line["time"], r"^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\d\.\d{3}Z$")
            self.assertIn(line["program"], ("server", "worker"))
            self.assertIn("message", line)
        for name in ("server", "worker"):
            of_tasks = [line for line in self.lines(name) if "task" in line]
            self.assertGreaterEqual(len(of_tasks), TILES, name)
            for line in of_tasks:
                self.assertEqual(line["job"], job)
                self.assertIn("/", line["worker"])
        done = {line["tile"] for line in self.lines("server") if "tile" in line and "done" in line["message"]}
        self.assertEqual(done, set(range(TILES)))
        self.assertTrue(any(line["message"] == "done" and line["job"] == job for line in self.lines("server")))

    def test_text_stays_the_default(self):
        self.start_server()
        self.assertRegex(self.text("server"), r"^\[\d{4}-.*\] \[server\] \[info\] listening on ")

    def test_what_workers_said_of_a_tile_is_read_from_the_server(self):
        server = self.start_server()
        self.start_worker(WORKER)
        job = self.submit()
        self.penumbra("wait", job)
        all_of_it = self.penumbra("logs", job)
        tasks = set(re.findall(r"task (\d+) .*\| \d+\.\d{3} debug rendered", all_of_it))
        self.assertGreaterEqual(len(tasks), TILES)
        self.assertNotIn("| ", self.penumbra("log", job), "`log` says what became of tasks, and no more")
        for tile in range(TILES):
            of_tile = self.penumbra("logs", job, "--tile", tile)
            x, y = 32 * (tile % 3), 32 * (tile // 3)
            self.assertIn(f"rendered [{x},{x + 32})x[{y},{y + 32})", of_tile)
            self.assertEqual(len(re.findall(r"rendered \[", of_tile)) * TILES, len(tasks))
        for command in ("log", "logs"):
            self.assertIn("--tile: 6 is not below 6", self.penumbra(command, job, "--tile", TILES, code=2))
        self.penumbra("logs", "none", code=2)
        # They outlive the server.
        server.kill()
        server.wait()
        self.start_server()
        self.assertIn("debug rendered", self.penumbra("logs", job, "--tile", 5))

    def test_a_failure_comes_with_what_its_worker_logged(self):
        self.start_server()
        job = self.submit()
        scene = pathlib.Path(SCENE).read_bytes()
        blobs = [path for path in (self.folder / "store").rglob("*") if path.is_file() and path.read_bytes() == scene]
        self.assertEqual(len(blobs), 1)
        blobs[0].unlink()
        self.start_worker(WORKER)
        self.penumbra("wait", job, code=1)
        self.assertRegex(self.penumbra("logs", job), r"\| \d+\.\d{3} warning .*lost a file")

    def test_no_secret_is_ever_logged(self):
        certs = self.folder / "certs"
        for words in (["server", "localhost,127.0.0.1"], ["worker", "node"], ["client", "ada"], ["token", "ada", "submit"],
                      ["token", "farm", "work"], ["token", "eve", "submit"]):
            subprocess.run([CERTS, certs, *words], check=True, capture_output=True)
        (certs / "tokens").write_text("".join(l for l in (certs / "tokens").read_text().splitlines(True) if " eve " not in l))
        tls = lambda name: ["--tls-cert", certs / f"{name}.pem", "--tls-key", certs / f"{name}-key.pem", "--tls-ca", certs / "ca.pem"]
        for format in ("json", "text"):
            loud = ["--log-level", "trace", "--log-format", format]
            server = self.start_server(*tls("server"), "--token-file", certs / "tokens", "--http", "127.0.0.1:0", *loud)
            worker = self.start_worker(WORKER, *tls("node"), "--token-file", certs / "farm.token", *loud)
            self.flags = [str(w) for w in (*tls("ada"), "--token-file", certs / "ada.token", "--log-level", "trace")]
            job = self.submit()
            said = self.penumbra("wait", job) + self.penumbra("logs", job)
            # A token that is not known, in a call and in a request of the dashboard.
            wrong = [str(w) for w in (*tls("ada"), "--token-file", certs / "eve.token")]
            said += self.penumbra("jobs", code=1, flags=wrong)
            url = re.search(r"dashboard on (https://[^\s\"]+)", self.text("server"))[1]
            subprocess.run(["curl", "-sk", "-H", f"Authorization: Bearer {(certs / 'eve.token').read_text().strip()}", f"{url}/metrics"],
                           capture_output=True)
            for process in (worker, server):
                process.terminate()
                self.assertEqual(process.wait(30), 0)
            said += self.text("server") + self.text("worker")
            self.assertIn(job, said)
            for user in ("ada", "farm", "eve"):
                self.assertNotIn((certs / f"{user}.token").read_text().strip(), said, f"{user}'s token, {format}")
            for name in ("server", "node", "ada"):
                key = (certs / f"{name}-key.pem").read_text().splitlines()[1]
                self.assertNotIn(key, said)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=2)
