"""A Slurm cluster of one machine, on the loopback, for as long as a check takes."""

import os
import pathlib
import shutil
import signal
import socket
import subprocess
import time

# Programs of Slurm need their configuration here: jobs do not inherit another place.
CONFIGURATION = pathlib.Path("/etc/slurm/slurm.conf")
MARK = "# Written by scripts/check-cluster, which removes it at its end."
START_S = 60

TEXT = """{mark}
ClusterName=check
SlurmctldHost={host}(127.0.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/none
CredType=cred/none
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/spool
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd.log
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd.pid
SlurmctldPort={port}
SlurmdPort={next_port}
ReturnToService=2
SchedulerParameters=batch_sched_delay=0,sched_interval=1
PriorityType=priority/basic
MinJobAge=600
MaxArraySize=11
NodeName={host} NodeAddr=127.0.0.1 CPUs={cores} RealMemory={memory} State=UNKNOWN
PartitionName=main Nodes={host} Default=YES MaxTime=INFINITE State=UP
"""


def missing():
    """Why there can be no cluster here, or None."""
    programs = ["slurmctld", "slurmd", "sbatch", "squeue", "scontrol"]
    absent = [name for name in programs if shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin") is None]
    if absent:
        return f"{', '.join(absent)}: apt install slurmctld slurmd slurm-client"
    if os.geteuid() != 0:
        return "slurmd has to run as root"
    if CONFIGURATION.exists() and MARK not in CONFIGURATION.read_text():
        return f"{CONFIGURATION} is that of another cluster"
    return None


class Cluster:
    """Starts a cluster, and stops it with all its jobs; MaxArraySize is small, so that arrays are divided."""

    def __init__(self, folder):
        self.folder = folder
        self.daemons = []

    def __enter__(self):
        for name in ("state", "spool"):
            (self.folder / name).mkdir(parents=True)
        host, port = socket.gethostname().split(".")[0], free_port()
        CONFIGURATION.parent.mkdir(exist_ok=True)
        CONFIGURATION.write_text(
            TEXT.format(
                mark=MARK, host=host, folder=self.folder, port=port, next_port=port + 1, cores=os.cpu_count(),
                memory=os.sysconf('SC_PHYS_PAGES') * os.sysconf('SC_PAGE_SIZE') * 9 // 10 >> 20,
            )
        )
        try:
            for name in ("slurmctld", "slurmd"):
                self.start(name)
            self.wait()
        except BaseException:
            self.__exit__()
            raise
        return self

    def start(self, name):
        path = shutil.which(name, path=f"{os.environ['PATH']}:/usr/sbin")
        with open(self.folder / f"{name}.out", "wb") as out:
            self.daemons.append(subprocess.Popen([path, "-D"], stdout=out, stderr=out, start_new_session=True))

    def wait(self):
        end = time.monotonic() + START_S
        while time.monotonic() < end:
            said = subprocess.run(["sinfo", "--noheader", "--format", "%T"], capture_output=True, text=True)
            if said.stdout.split() == ["idle"]:
                return
            for daemon in self.daemons:
                if daemon.poll() is not None:
                    raise RuntimeError(f"{daemon.args[0]} ended: see {self.folder}")
            time.sleep(0.2)
        raise RuntimeError(f"no machine of the cluster is idle after {START_S} s: see {self.folder}")

    def __exit__(self, *_):
        if self.daemons:
            subprocess.run(["scancel", "--user", "root"], capture_output=True)
            time.sleep(0.5)
        for daemon in reversed(self.daemons):
            for number in (signal.SIGTERM, signal.SIGKILL):
                if daemon.poll() is None:
                    daemon.send_signal(number)
                    try:
                        daemon.wait(10)
                    except subprocess.TimeoutExpired:
                        pass
        self.daemons = []
        CONFIGURATION.unlink(missing_ok=True)


def free_port():
    """A port so that it and the next one are free."""
    while True:
        with socket.socket() as first, socket.socket() as second:
            first.bind(("127.0.0.1", 0))
            port = first.getsockname()[1]
            try:
                second.bind(("127.0.0.1", port + 1))
            except OSError:
                continue
            return port
