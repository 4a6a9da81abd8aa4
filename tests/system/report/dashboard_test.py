"""The server's HTTP side: metrics, health, access, and the dashboard in headless Chromium.

    dashboard_test.py PENUMBRA SERVER WORKER SCENE.pbrt
"""
import base64
import json
import pathlib
import re
import socket
import ssl
import subprocess
import sys
import tempfile
import time
import unittest
import urllib.error
import urllib.request

import browser
import runs

PENUMBRA, SERVER, WORKER, SCENE = sys.argv[1:5]
MIXES = ["sa:2", "bsdf:1+line-sa@v:1"]


class Server:
    """A coordinator with --http on a free port, in a folder of its own."""

    def __init__(self, *flags, http="127.0.0.1:0"):
        self.folder = tempfile.TemporaryDirectory(prefix="penumbra_http_")
        base = pathlib.Path(self.folder.name)
        self.log = open(base / "log", "w+b")
        self.process = subprocess.Popen([SERVER, "--listen", "127.0.0.1:0", "--store", base / "store", "--address-file", base / "address",
                                         "--http", http, *flags], stderr=self.log)
        for _ in range(600):
            if (base / "address").exists() or self.process.poll() is not None:
                break
            time.sleep(0.05)
        self.text = (base / "log").read_text()
        if self.process.poll() is None:
            self.address = (base / "address").read_text().strip()
            self.url = re.search(r"dashboard on (\S+)", self.text).group(1)

    def log_text(self):
        return (pathlib.Path(self.folder.name) / "log").read_text()

    def stop(self):
        self.process.terminate()
        code = self.process.wait(30)
        self.log.close()
        self.folder.cleanup()
        return code


def get(url, headers=None, method="GET", context=None):
    """(code, headers, body)."""
    request = urllib.request.Request(url, headers=headers or {}, method=method)
    try:
        with urllib.request.urlopen(request, timeout=30, context=context) as reply:
            return reply.status, reply.headers, reply.read()
    except urllib.error.HTTPError as error:
        return error.code, error.headers, error.read()


class Loopback(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.server = Server()
        cls.worker = None

    @classmethod
    def tearDownClass(cls):
        if cls.worker:
            cls.worker.terminate()
            cls.worker.wait(30)
        assert cls.server.stop() == 0

    def metrics(self):
        code, headers, body = get(self.server.url + "/metrics")
        self.assertEqual(code, 200)
        self.assertIn("text/plain; version=0.0.4", headers["Content-Type"])
        return dict(re.findall(r"^([^#\s]\S*(?:\{[^}]*\})?) (\S+)$", body.decode(), re.M))

    def wait(self, condition, seconds=120):
        end = time.monotonic() + seconds
        while not condition():
            self.assertLess(time.monotonic(), end, "took too long")
            time.sleep(0.1)

    def test_1_health_and_metrics_of_an_idle_server(self):
        self.assertEqual(get(self.server.url + "/healthz")[::2], (200, b"ok\n"))
        metrics = self.metrics()
        self.assertEqual(metrics["penumbra_workers"], "0")
        self.assertEqual(metrics['penumbra_jobs{state="running"}'], "0")
        self.assertGreater(float(metrics["penumbra_server_cpu_seconds_total"]), 0)

    def test_2_only_reads_of_what_there_is_by_its_own_name(self):
        self.assertEqual(get(self.server.url + "/nothing")[0], 404)
        self.assertEqual(get(self.server.url + "/api/jobs/none")[0], 404)
        self.assertEqual(get(self.server.url + "/../../etc/passwd")[0], 404)
        self.assertEqual(get(self.server.url + "/", method="POST")[0], 405)
        self.assertEqual(get(self.server.url + "/", {"Host": "evil.example"})[0], 403)
        _, headers, _ = get(self.server.url + "/")
        self.assertIn("default-src 'self'", headers["Content-Security-Policy"])

    def test_3_a_job_from_queue_to_end(self):
        flags = [flag for mix in MIXES for flag in ("--mix", mix)]
        job = runs.penumbra(PENUMBRA, "submit", SCENE, "--server", self.server.address, "--resolution", "96x54", "--tile", 32,
                            "--spp", 24, *flags).strip()
        with browser.Browser(1280, 900) as page:
            page.open(self.server.url)
            page.wait(f"return document.querySelector('#jobs').textContent.includes('{job}')")
            page.wait("return document.getElementById('why').textContent.includes('No worker is connected')")
            self.assertIn("none is connected", page.text("#workers"))
            self.wait(lambda: self.metrics().get("penumbra_tasks_waiting", "0") != "0")

            type(self).worker = subprocess.Popen([WORKER, "--server", self.server.address, "--threads", "1", "--cache",
                                                  pathlib.Path(self.server.folder.name) / "cache"], stderr=subprocess.DEVNULL)
            page.wait("return document.querySelector('#jobs .done') !== null", 300)
            page.wait("return !document.getElementById('picture').hidden && document.getElementById('picture').naturalWidth === 96")
            page.wait("return document.querySelectorAll('#curve path.line').length === 2")
            self.assertIn("is done", page.text("#why"))
            self.assertEqual(page.run("return document.querySelectorAll('#workers tbody tr').length"), 1)
            before = page.find("#picture").get_attribute("src")
            page.run("const s = document.getElementById('mix'); s.value = '1'; s.dispatchEvent(new Event('change'))")
            page.wait(f"return document.getElementById('picture').src !== '{before}'")
            if len(sys.argv) > 5 and sys.argv[5].startswith("/"):
                page.whole_page(sys.argv[5])
            self.assertEqual(page.complaints(), [])
            page.resize(400, 800)
            page.wait("return document.documentElement.scrollWidth === 400")
        self.assertEqual(self.metrics()['penumbra_jobs{state="done"}'], "1")
        # Pictures, and points with them, are made now and then: the last one may be on its way.
        curve = lambda: json.loads(get(f"{self.server.url}/api/jobs/{job}")[2])["mixes"][0]["curve"]
        self.wait(lambda: len(curve()) >= 2)
        curve = curve()
        self.assertLess(curve[-1]["estimated_relmse"], curve[0]["estimated_relmse"])
        code, headers, body = get(f"{self.server.url}/api/jobs/{job}/image.png?mix=0")
        self.assertEqual((code, headers["Content-Type"], body[:8]), (200, "image/png", b"\x89PNG\r\n\x1a\n"))
        for wrong in ("2", "-1", "x", "0x"):
            self.assertEqual(get(f"{self.server.url}/api/jobs/{job}/image.png?mix={wrong}")[0], 404)


class Viewers(unittest.TestCase):
    def test_slow_ones_and_large_requests_hold_nobody_up(self):
        server = Server()
        self.addCleanup(server.stop)
        port = int(server.url.rsplit(":", 1)[1])
        for text in [b"GET / HTTP/1.1\r\nHost: localhost\r\n"] * 6 + [b"GET /d3.js HTTP/1.1\r\nHost: localhost\r\n\r\n"] * 6:
            idle = socket.socket()
            self.addCleanup(idle.close)
            idle.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
            idle.connect(("127.0.0.1", port))
            idle.sendall(text)
        begun = time.monotonic()
        self.assertEqual(get(server.url + "/metrics")[0], 200)
        self.assertLess(time.monotonic() - begun, 3)
        self.assertGreaterEqual(get(server.url + "/", {"X-Long": "x" * 40000})[0], 400)
        self.assertEqual(get(server.url + "/healthz")[0], 200)

    def test_the_page_outlives_a_restart(self):
        server = Server()
        with browser.Browser(1280, 900) as page:
            page.open(server.url)
            self.assertEqual(page.text("#jobs tbody"), "none")
            self.assertEqual(server.stop(), 0)
            page.wait("return document.getElementById('summary').textContent.includes('does not answer')")
            server = Server(http=server.url.split("//")[1])
            self.addCleanup(server.stop)
            page.wait("return document.getElementById('summary').textContent.includes('0 of 0 jobs')")


class Grafana(unittest.TestCase):
    def test_asks_for_metrics_that_there_are(self):
        dashboard = json.loads((pathlib.Path(SCENE).parents[2] / "deploy/grafana/penumbra.json").read_text())
        asked = set(re.findall(r"penumbra_\w+", json.dumps([p["targets"] for p in dashboard["panels"]] + dashboard["templating"]["list"])))
        server = Server()
        self.addCleanup(server.stop)
        served = set(re.findall(r"^# TYPE (\w+)", get(server.url + "/metrics")[2].decode(), re.M))
        self.assertGreater(len(asked), 8)
        self.assertEqual(asked - served, set())


class OffLoopback(unittest.TestCase):
    def test_is_refused_without_tls_and_token(self):
        server = Server(http="0.0.0.0:0")
        self.assertEqual(server.process.wait(30), 2)
        self.assertIn("--http 0.0.0.0:0", server.text)
        server.stop()

    def test_insecure_is_spelled_out(self):
        server = Server("--insecure", http="0.0.0.0:0")
        self.addCleanup(server.stop)
        self.assertIsNone(server.process.poll(), server.text)
        self.assertEqual(get(server.url.replace("0.0.0.0", "127.0.0.1") + "/metrics", {"Host": "farm"})[0], 200)

    def test_tls_and_token(self):
        with tempfile.TemporaryDirectory() as folder:
            base = pathlib.Path(folder)
            subprocess.run(["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256", "-nodes", "-days", "1", "-subj",
                            "/CN=localhost", "-addext", "subjectAltName=IP:127.0.0.1", "-keyout", base / "key.pem", "-out", base / "cert.pem"],
                           check=True, capture_output=True)
            (base / "token").write_text("t0ken\n")
            server = Server("--tls-cert", base / "cert.pem", "--tls-key", base / "key.pem", "--tls-ca", base / "cert.pem", "--token-file",
                            base / "token", http="0.0.0.0:0")
            self.addCleanup(server.stop)
            self.assertIsNone(server.process.poll(), server.text)
            url = server.url.replace("0.0.0.0", "127.0.0.1")
            self.assertTrue(url.startswith("https://"))
            trust = ssl.create_default_context(cafile=base / "cert.pem")
            self.assertEqual(get(url + "/metrics", context=trust)[0], 401)
            self.assertEqual(get(url + "/metrics", {"Authorization": "Bearer wrong"}, context=trust)[0], 401)
            self.assertEqual(get(url + "/metrics", {"Authorization": "Bearer t0ken"}, context=trust)[0], 200)
            password = base64.b64encode(b"anyone:t0ken").decode()
            self.assertEqual(get(url + "/", {"Authorization": f"Basic {password}"}, context=trust)[0], 200)
            self.assertEqual(get(url + "/healthz", context=trust)[0], 200)
            self.assertNotIn("t0ken", server.log_text())
            with self.assertRaises((urllib.error.URLError, ConnectionError)):
                get(url.replace("https", "http") + "/healthz")


if __name__ == "__main__":
    browser.need_browser()
    unittest.main(argv=sys.argv[:1], verbosity=2)
