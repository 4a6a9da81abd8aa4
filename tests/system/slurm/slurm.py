"""A Slurm of this test's own: controller and node daemons of one host, in a temporary folder, without systemd, cgroups or
root. Nothing of a Slurm that is installed here is used but its programs."""
import getpass
import os
import pathlib
import pwd
import shutil
import socket
import subprocess
import time

PROGRAMS = ["munged", "slurmctld", "slurmd", "sbatch", "squeue", "scancel", "scontrol", "sinfo"]


def program(name):
    return shutil.which(name, path=os.environ.get("PATH", "") + ":/usr/sbin:/usr/local/sbin")


def missing():
    return [name for name in PROGRAMS if program(name) is None]


def free_ports(count):
    sockets = [socket.socket() for _ in range(count)]
    for each in sockets:
        each.bind(("127.0.0.1", 0))
    ports = [each.getsockname()[1] for each in sockets]
    for each in sockets:
        each.close()
    return ports


def until(what, seconds, condition):
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        found = condition()
        if found:
            return found
        time.sleep(0.2)
    raise AssertionError(f"not within {seconds} s: {what}")


class Slurm:
    NODES = ["n1", "n2"]

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.processes = []
        self.environment = {**os.environ, "SLURM_CONF": str(self.folder / "slurm.conf")}
        try:
            self.start()
        except BaseException:
            self.stop()
            raise

    def start(self):
        self.start_munge()
        self.write_configuration()
        self.spawn("slurmctld", "-D", "-c")
        for node in self.NODES:
            self.spawn("slurmd", "-D", "-N", node)
        until("two idle nodes", 60, lambda: self.run("sinfo", "-h", "-N", "-o", "%t", check=False).split() == ["idle"] * 2)

    def start_munge(self):
        """munged does not like to be root: there it is its package's user."""
        folder = self.folder / "munge"
        folder.mkdir(mode=0o755)
        key = folder / "key"
        key.write_bytes(os.urandom(128))
        key.chmod(0o400)
        as_user = []
        if os.getuid() == 0:
            user = pwd.getpwnam("munge")
            for path in (folder, key):
                os.chown(path, user.pw_uid, user.pw_gid)
            as_user = ["setpriv", f"--reuid={user.pw_uid}", f"--regid={user.pw_gid}", "--clear-groups"]
        self.munge_socket = folder / "socket"
        self.spawn("munged", "--foreground", f"--key-file={key}", f"--socket={self.munge_socket}", f"--pid-file={folder / 'pid'}",
                   f"--seed-file={folder / 'seed'}", f"--log-file={folder / 'log'}", prefix=as_user)
        until("munge's socket", 20, self.munge_socket.exists)

    def write_configuration(self):
        for name in ("state", "spool"):
            (self.folder / name).mkdir()
        controller, first, second = free_ports(3)
        host = socket.gethostname().split(".")[0]
        (self.folder / "slurm.conf").write_text(f"""
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort={controller}
AuthType=auth/munge
AuthInfo=socket={self.munge_socket}
CredType=cred/munge
SlurmUser={getpass.getuser()}
SlurmdUser={getpass.getuser()}
StateSaveLocation={self.folder}/state
SlurmdSpoolDir={self.folder}/spool/%n
SlurmctldPidFile={self.folder}/slurmctld.pid
SlurmdPidFile={self.folder}/slurmd.%n.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SchedulerType=sched/backfill
AccountingStorageType=accounting_storage/none
JobAcctGatherType=jobacct_gather/none
MpiDefault=none
SwitchType=switch/none
JobRequeue=1
KillWait=10
ReturnToService=2
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port={first} CPUs=1 State=UNKNOWN
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port={second} CPUs=1 State=UNKNOWN
PartitionName=render Nodes=n1,n2 Default=YES MaxTime=60 State=UP
""")

    def spawn(self, name, *arguments, prefix=()):
        with open(self.folder / f"{name}{len(self.processes)}.log", "wb") as log:
            self.processes.append(subprocess.Popen([*prefix, program(name), *arguments], env=self.environment, stdout=log, stderr=log,
                                                   stdin=subprocess.DEVNULL))

    def run(self, name, *arguments, check=True):
        done = subprocess.run([program(name), *arguments], env=self.environment, capture_output=True, text=True, timeout=60)
        if check and done.returncode != 0:
            raise AssertionError(f"{name} {arguments}: {done.stderr}")
        return done.stdout

    def tasks(self):
        """Array task's id -> state's short name, as squeue has them."""
        queue = self.run("squeue", "--noheader", "--array", "--format", "%i %t")
        return dict(line.split() for line in queue.splitlines())

    def logs(self):
        return "".join(f"--- {path.name}\n{path.read_text(errors='replace')[-3000:]}" for path in sorted(self.folder.glob("*.log")))

    def stop(self):
        """Jobs first, then daemons, the authority last."""
        if len(self.processes) > 1:
            self.run("scancel", "--me", check=False)
            end = time.monotonic() + 20
            while time.monotonic() < end and self.run("squeue", "--noheader", check=False):
                time.sleep(0.2)
        for process in reversed(self.processes):
            process.terminate()
            try:
                process.wait(10)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
