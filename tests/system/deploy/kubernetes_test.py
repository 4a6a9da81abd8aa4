"""deploy/k8s without a cluster: kustomize puts it together, and what refers to something refers to something that is there.

    kubernetes_test.py DEPLOY_FOLDER SERVER WORKER CLIENT
"""
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

DEPLOY, SERVER, WORKER, CLIENT = sys.argv[1:5]
PROGRAMS = {"server": SERVER, "worker": WORKER, "penumbra": CLIENT}
NAMES = {"Service": "v1", "Namespace": "v1", "Secret": "v1", "StatefulSet": "apps/v1", "Deployment": "apps/v1",
         "HorizontalPodAutoscaler": "autoscaling/v2", "NetworkPolicy": "networking.k8s.io/v1"}


def flags_of(program, *command):
    done = subprocess.run([program, *command, "--help"], capture_output=True, text=True, check=True)
    return set(re.findall(r"--[a-z][a-z0-9-]*", done.stdout))


def built(folder):
    done = subprocess.run(["kubectl", "kustomize", str(folder)], capture_output=True, text=True)
    if done.returncode != 0:
        raise AssertionError(done.stderr)
    return [document for document in yaml.safe_load_all(done.stdout) if document]


class Manifests(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.temporary = tempfile.TemporaryDirectory(prefix="penumbra_k8s_")
        folder = pathlib.Path(cls.temporary.name)
        shutil.copytree(pathlib.Path(DEPLOY), folder / "deploy", ignore=shutil.ignore_patterns("secrets.d"))
        k8s = folder / "deploy" / "k8s"
        shutil.rmtree(k8s / "farm" / "secrets", ignore_errors=True)
        subprocess.run([k8s / "secrets", k8s / "farm" / "secrets", "farm.example"], check=True, capture_output=True)
        cls.secrets = k8s / "farm" / "secrets"
        cls.documents = built(k8s / "farm")

    @classmethod
    def tearDownClass(cls):
        cls.temporary.cleanup()

    def of(self, kind, name=None):
        found = [d for d in self.documents if d["kind"] == kind and name in (None, d["metadata"]["name"])]
        self.assertTrue(found, f"no {kind} {name or ''}")
        return found

    def workloads(self):
        return self.of("StatefulSet") + self.of("Deployment")

    def pods(self):
        return [(w["metadata"]["name"], w["spec"]["template"]) for w in self.workloads()]

    def containers(self):
        return [(name, c) for name, pod in self.pods() for c in pod["spec"]["containers"]]

    def test_every_document_is_of_a_known_kind_and_name(self):
        seen = set()
        for document in self.documents:
            kind = document["kind"]
            self.assertEqual(document["apiVersion"], NAMES[kind])
            key = (kind, document["metadata"]["name"])
            self.assertNotIn(key, seen)
            seen.add(key)
            self.assertLessEqual(set(document), {"apiVersion", "kind", "metadata", "spec", "data", "type"})
            if kind != "Namespace":
                self.assertEqual(document["metadata"]["namespace"], "penumbra")
        self.assertEqual(self.of("Namespace")[0]["metadata"]["name"], "penumbra")

    def test_every_selector_matches_a_pod(self):
        labels = [pod["metadata"]["labels"] for _, pod in self.pods()]

        def matches(selector, where):
            self.assertTrue(any(selector.items() <= each.items() for each in labels), f"{where}: {selector}")

        for workload in self.workloads():
            selector = workload["spec"]["selector"]["matchLabels"]
            self.assertLessEqual(selector.items(), workload["spec"]["template"]["metadata"]["labels"].items())
        for service in self.of("Service"):
            matches(service["spec"]["selector"], service["metadata"]["name"])
        for policy in self.of("NetworkPolicy"):
            spec = policy["spec"]
            own = [spec["podSelector"]]
            for rule in spec.get("ingress", []) + spec.get("egress", []):
                # A peer in another namespace is not ours to have.
                own += [peer["podSelector"] for peer in rule.get("from", []) + rule.get("to", [])
                        if "podSelector" in peer and "namespaceSelector" not in peer]
            for selector in own:
                matches(selector.get("matchLabels", {}), policy["metadata"]["name"])

    def test_references_exist(self):
        secrets = {s["metadata"]["name"]: set(s["data"]) for s in self.of("Secret")}
        for name, pod in self.pods():
            volumes = {v["name"]: v for v in pod["spec"]["volumes"]}
            claims = {c["metadata"]["name"] for w in self.of("StatefulSet") for c in w["spec"]["volumeClaimTemplates"]}
            for container in pod["spec"]["containers"]:
                mounts = {m["mountPath"]: m["name"] for m in container["volumeMounts"]}
                self.assertLessEqual(set(mounts.values()), set(volumes) | claims, name)
                # Each file that a flag names lies in a Secret that is mounted there.
                command = container.get("readinessProbe", {}).get("exec", {}).get("command", [])
                for path in re.findall(r"=(/etc/\S+)", " ".join(container["args"] + command)):
                    folder, file = path.rsplit("/", 1)
                    secret = volumes[mounts[folder]]["secret"]["secretName"]
                    self.assertIn(file, secrets[secret], path)
        stateful = self.of("StatefulSet")[0]["spec"]
        self.of("Service", stateful["serviceName"])
        target = self.of("HorizontalPodAutoscaler")[0]["spec"]["scaleTargetRef"]
        self.of(target["kind"], target["name"])
        self.assertNotIn("replicas", self.of("Deployment")[0]["spec"], "they are the autoscaler's")

    def test_ports_have_names_that_exist(self):
        named = {p["name"]: p["containerPort"] for _, c in self.containers() for p in c.get("ports", [])}
        for service in self.of("Service"):
            for port in service["spec"]["ports"]:
                self.assertEqual(named[port["targetPort"]], port["port"])
        for _, container in self.containers():
            for probe in ("startupProbe", "livenessProbe", "readinessProbe"):
                if "httpGet" in container.get(probe, {}):
                    self.assertIn(container[probe]["httpGet"]["port"], named)
        allowed = {p["port"] for n in self.of("NetworkPolicy") for r in n["spec"].get("ingress", []) for p in r["ports"]}
        self.assertEqual(allowed, set(named.values()))

    def test_flags_exist(self):
        for _, container in self.containers():
            known = flags_of(PROGRAMS[container["name"]])
            for word in container["args"]:
                self.assertIn(word.split("=")[0], known, container["name"])
            command = container.get("readinessProbe", {}).get("exec", {}).get("command")
            if command:
                self.assertEqual(command[:2], ["penumbra", "health"])
                known = flags_of(CLIENT, "health")
                for word in command[2:]:
                    self.assertIn(word.split("=")[0], known)

    def test_workers_are_guaranteed_whole_cpus(self):
        for _, container in self.containers():
            resources = container["resources"]
            self.assertEqual(resources["requests"], resources["limits"])
            self.assertRegex(resources["limits"]["cpu"], r"^\d+$")
        worker = dict(self.containers())["penumbra-worker"]
        limit = int(re.fullmatch(r"(\d+)Gi", worker["resources"]["limits"]["memory"])[1])
        most = int(re.search(r"--max-memory=(\d+)G", " ".join(worker["args"]))[1])
        self.assertLess(most, limit)

    def test_nothing_runs_as_root_or_writes_its_image(self):
        for name, pod in self.pods():
            self.assertTrue(pod["spec"]["securityContext"]["runAsNonRoot"], name)
            self.assertFalse(pod["spec"]["automountServiceAccountToken"])
            self.assertGreater(pod["spec"]["terminationGracePeriodSeconds"], 5, "a worker drains for up to 4.5 s")
        for name, container in self.containers():
            context = container["securityContext"]
            self.assertTrue(context["readOnlyRootFilesystem"], name)
            self.assertFalse(context["allowPrivilegeEscalation"])
            self.assertEqual(context["capabilities"]["drop"], ["ALL"])

    def test_the_server_starts_with_these_secrets_and_answers_the_probe(self):
        """The flags of the manifests on this machine: paths and addresses are put in their place, nothing else."""
        server = dict(self.containers())["penumbra-server"]
        with tempfile.TemporaryDirectory(prefix="penumbra_k8s_") as folder:
            def here(word):
                for there in ("/etc/penumbra/tls", "/etc/penumbra/tokens", "/etc/penumbra/probe"):
                    word = word.replace(there, str(self.secrets))
                return word.replace("/var/lib/penumbra", folder).replace("0.0.0.0:740", "127.0.0.1:0#").split("#")[0]

            address = pathlib.Path(folder) / "address"
            log = open(pathlib.Path(folder) / "log", "wb")
            process = subprocess.Popen([SERVER, *map(here, server["args"]), f"--address-file={address}"], stderr=log)
            try:
                for _ in range(600):
                    if address.exists() or process.poll() is not None:
                        break
                    time.sleep(0.05)
                self.assertIsNone(process.poll(), (pathlib.Path(folder) / "log").read_text())
                port = address.read_text().strip().rsplit(":", 1)[1]
                command = [here(w).replace("localhost:7400", f"localhost:{port}")
                           for w in server["readinessProbe"]["exec"]["command"][1:]]
                done = subprocess.run([CLIENT, *command], capture_output=True, text=True)
                self.assertEqual(done.returncode, 0, done.stderr)
            finally:
                process.terminate()
                process.wait(30)
                log.close()
            done = subprocess.run([CLIENT, *command], capture_output=True, text=True)
            self.assertEqual(done.returncode, 5, "a probe must tell a server that is gone")

    def test_the_autoscaler_reads_a_metric_that_the_server_has(self):
        metric = self.of("HorizontalPodAutoscaler")[0]["spec"]["metrics"][0]["external"]["metric"]["name"]
        self.assertIn(metric, (pathlib.Path(DEPLOY) / "k8s" / "README.md").read_text())
        source = (pathlib.Path(DEPLOY).parent / "server" / "http_metrics.cpp").read_text()
        self.assertIn(f'"{metric}"', source)


if __name__ == "__main__":
    import time
    try:
        import yaml
    except ImportError:
        yaml = None
    missing = [what for what, there in (("kubectl", shutil.which("kubectl")), ("python3-yaml", yaml)) if not there]
    if missing:
        print(f"SKIPPED: {', '.join(missing)} not there; see deploy/packages-farm.txt")
        sys.exit(77)
    unittest.main(argv=sys.argv[:1], verbosity=2)
