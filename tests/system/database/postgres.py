"""A PostgreSQL of this test's own, in a temporary folder, on a Unix socket."""
import os
import pathlib
import pwd
import subprocess
import time


def programs():
    """The folder of the newest server programs of Debian's packages; none if there are none."""
    found = sorted(pathlib.Path("/usr/lib/postgresql").glob("*/bin/postgres"), key=lambda p: int(p.parts[4]))
    return found[-1].parent if found else None


class Postgres:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.as_user = []
        self.folder.mkdir()
        if os.getuid() == 0:  # which the server refuses to be
            user = pwd.getpwnam("postgres")
            os.chown(self.folder, user.pw_uid, user.pw_gid)
            self.as_user = ["setpriv", f"--reuid={user.pw_uid}", f"--regid={user.pw_gid}", "--clear-groups"]
        data = self.folder / "data"
        subprocess.run([*self.as_user, programs() / "initdb", "-D", data, "-A", "trust", "-U", "penumbra"], check=True, capture_output=True)
        log = open(self.folder / "log", "wb")
        self.process = subprocess.Popen([*self.as_user, programs() / "postgres", "-D", data, "-k", self.folder, "-c", "listen_addresses="],
                                        stdout=log, stderr=log)
        log.close()
        self.url = f"postgresql:///postgres?host={self.folder}&user=penumbra"
        for _ in range(300):
            if subprocess.run([programs() / "pg_isready", "-h", self.folder, "-q"]).returncode == 0:
                return
            time.sleep(0.1)
        raise AssertionError((self.folder / "log").read_text())

    def ask(self, sql):
        done = subprocess.run([programs() / "psql", self.url, "-Atc", sql], capture_output=True, text=True, check=True)
        return done.stdout.strip()

    def stop(self):
        self.process.terminate()
        self.process.wait(30)
