"""Runs the tasks of a benchmark, by docs/slurm.sh, on a real Slurm of two nodes on this machine.

    check_cluster.py PROGRAM

Each check ends with the same files as the benchmark on this machine alone. Jobs and files decide, not messages.
Needs root, slurmctld, slurmd and munge; `cargo xtask nightly cluster` brings them in.
"""

import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tempfile
import time

NODES = ["n1", "n2"]
# Slurm notices a lost node after half a minute and restarts its tasks two minutes later.
LIMIT = 600
OUT = pathlib.Path("target/cluster").absolute()
ALL = ["eth", "hotel", "univ", "zara1", "zara2"]
PROGRAM = [os.path.abspath(sys.argv[1]), "benchmark", "--profile", "smoke"]
os.environ["DDL"] = PROGRAM[0]
SCRIPT = str(pathlib.Path(__file__).parents[2] / "docs/slurm.sh")
RESULTS = ["model.safetensors", "proposal.safetensors", "report.json", "moments.json"]
CONFIGURATION = """\
ClusterName=test
SlurmctldHost={host}(127.0.0.1)
SlurmctldPort=16817
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
AuthInfo=socket={folder}/socket
StateSaveLocation={folder}/state
SlurmdSpoolDir={folder}/%n
SlurmctldPidFile={folder}/slurmctld.pid
SlurmdPidFile={folder}/slurmd-%n.pid
SlurmctldLogFile={folder}/slurmctld.log
SlurmdLogFile={folder}/slurmd-%n.log
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
MailProg=/bin/true
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_Core
SlurmdParameters=config_overrides
ReturnToService=2
KillWait=10
SlurmdTimeout=10
NodeName=n1 NodeHostname={host} NodeAddr=127.0.0.1 Port=16821 CPUs=1 RealMemory=2000
NodeName=n2 NodeHostname={host} NodeAddr=127.0.0.1 Port=16822 CPUs=1 RealMemory=2000
PartitionName=main Nodes=n1,n2 Default=YES MaxTime=INFINITE State=UP
"""


def until(what, happened):
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        if result := happened():
            return result
        time.sleep(0.2)
    sys.exit(f"{what} did not happen within {LIMIT} s; logs are in {OUT}")


class Slurm:
    """A Slurm in a temporary folder, without systemd. Its programs find it by the variable SLURM_CONF."""

    def __init__(self):
        self.folder = pathlib.Path(tempfile.mkdtemp(prefix="slurm-"))
        # munge refuses folders that others can write to, and a socket that others cannot reach.
        self.folder.chmod(0o755)
        for name in ["state", *NODES]:
            (self.folder / name).mkdir()
        key = self.folder / "key"
        key.write_bytes(os.urandom(1024))
        key.chmod(0o400)
        configuration = self.folder / "slurm.conf"
        host = os.uname().nodename.split(".")[0]
        configuration.write_text(CONFIGURATION.format(host=host, folder=self.folder))
        os.environ["SLURM_CONF"] = str(configuration)
        files = {"key-file": "key", "socket": "socket", "pid-file": "pid", "log-file": "log", "seed-file": "seed"}
        options = [f"--{option}={self.folder}/{name}" for option, name in files.items()]
        self.daemons = [self.daemon("munged", "--foreground", *options), self.daemon("slurmctld", "-D")]
        self.nodes = {node: self.daemon("slurmd", "-D", "-N", node) for node in NODES}
        self.wait_for_nodes()

    @staticmethod
    def daemon(*command):
        return subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)

    def wait_for_nodes(self):
        until("both nodes idle (are the ports 16817, 16821, 16822 free?)", lambda: ask("sinfo -h -t idle -o %D") == "2")

    def kill_node(self, node):
        """Ends a node as a power failure would: its daemon and all processes on it, by SIGKILL."""
        self.nodes[node].kill()
        self.nodes[node].wait()
        marks = {f"SLURM_CONF={self.folder}/slurm.conf".encode(), f"SLURMD_NODENAME={node}".encode()}
        for process in pathlib.Path("/proc").glob("[0-9]*"):
            try:
                if marks <= set((process / "environ").read_bytes().split(b"\0")):
                    # The daemon of a job does not have the job's variables.
                    parent = (process / "stat").read_text().rsplit(")", 1)[1].split()[1]
                    if pathlib.Path("/proc", parent, "comm").read_text().startswith("slurmstepd"):
                        os.kill(int(parent), signal.SIGKILL)
                    os.kill(int(process.name), signal.SIGKILL)
            except OSError:
                pass  # it has just ended
        self.nodes[node] = self.daemon("slurmd", "-D", "-N", node)

    def stop(self):
        ask("scancel --me --signal=KILL --full")
        ask("scancel --me")
        for daemon in [*self.nodes.values(), *reversed(self.daemons)]:
            daemon.terminate()
            daemon.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


def ask(command):
    return subprocess.run(command.split(), capture_output=True, text=True, check=False).stdout.strip()


def elements():
    """Waiting and running tasks: number, state, reason, node."""
    lines = ask("squeue --noheader --array --format=%F_%K|%T|%r|%N").splitlines()
    return [line.split("|") for line in lines if "_N/A" not in line]


def running():
    return [element for element in elements() if element[1] == "RUNNING"]


def jobs():
    return set(ask("squeue --noheader --format=%F").split())


class Benchmark:
    """The benchmark of the first folds in a folder of this name."""

    def __init__(self, name, folds):
        self.name, self.folds = name, folds

    def run(self, *words):
        with open(OUT / f"{self.name}.log", "ab") as log:
            command = [*PROGRAM, "--folds", ",".join(self.folds), "--out", str(OUT / self.name), *words]
            ended = subprocess.run(command, stdin=subprocess.DEVNULL, stdout=log, stderr=log, check=False)
        check(ended.returncode == 0, f"{' '.join(command)} failed")

    def submit(self):
        self.run("--executor", "none")
        options = ["--job-name=ddl", f"--output={OUT}/%A_%a.log"]
        folder = str(OUT / self.name)
        submit(*options, f"--array=0-{len(self.folds) - 1}", SCRIPT, folder, "--threads", "1")
        collect = f"{PROGRAM[0]} benchmark --out {folder} --collect"
        submit(*options, "--dependency=singleton", "--wrap", collect)

    def finish(self):
        """Until its jobs have ended, with results that equal those made without Slurm."""
        until("the end of its jobs", lambda: not jobs())
        self.compare()

    def compare(self):
        files = [f"{fold}-full-1/run/{file}" for fold in self.folds for file in RESULTS]
        if len(self.folds) == len(ALL):
            files += ["report.json", "report.md", "moments.json"]
        for file in files:
            if (OUT / self.name / file).read_bytes() != (OUT / "here" / file).read_bytes():
                sys.exit(f"{self.name}/{file} differs from here/{file}")

    def until_trained(self):
        """Until the first stage of every task is trained and the second is running."""
        stages = [OUT / self.name / f"{fold}-full-1/run/proposal.safetensors" for fold in self.folds]
        until("a trained first stage", lambda: all(stage.exists() for stage in stages))


def submit(*words):
    subprocess.run(["sbatch", *words], check=True, stdout=subprocess.DEVNULL)


def restarts(task):
    return ask(f"scontrol show job {task}").split(" Restarts=")[1].split()[0]


def check(condition, message):
    if not condition:
        sys.exit(f"{message}; logs are in {OUT}")


def here(_):
    """all folds on this machine alone"""
    Benchmark("here", ALL).run()


def submitted(_):
    """an array of all folds and a job for the report: same `report.json`, `report.md`, `moments.json`"""
    benchmark = Benchmark("submitted", ALL)
    benchmark.submit()
    benchmark.finish()


def lost_node(slurm):
    """a node is lost: its task restarts, with the same results"""
    benchmark = Benchmark("lost-node", ALL[:2])
    benchmark.submit()
    benchmark.until_trained()
    lost = next(element[0] for element in running() if element[3] == NODES[0])
    slurm.kill_node(NODES[0])
    until("a restart of its task", lambda: restarts(lost) == "1")
    benchmark.finish()


def warned(_):
    """Slurm warns of the time limit: the task saves, is queued again, and resumes to the same results"""
    os.environ.update(SBATCH_TIMELIMIT="2", SBATCH_SIGNAL="B:INT@110")
    benchmark = Benchmark("warned", ALL[:2])
    benchmark.submit()
    again = until("a warned task in the queue", lambda: [one for one in elements() if one[2] == "BeginTime"])[0][0]
    del os.environ["SBATCH_TIMELIMIT"], os.environ["SBATCH_SIGNAL"]
    for task, *_ in elements():
        ask(f"scontrol update JobId={task} TimeLimit=60")
    ask(f"scontrol update JobId={again} StartTime=now")
    check(restarts(again) == "1", "it was not restarted once")
    benchmark.finish()


def cancelled(_):
    """a task is cancelled: it saves and is not queued again; the same commands resume to the same results"""
    benchmark = Benchmark("cancelled", ALL[:1])
    benchmark.submit()
    benchmark.until_trained()
    ask(f"scancel {running()[0][0]}")
    until("the end of its jobs", lambda: not jobs())
    log = OUT / f"cancelled/{ALL[0]}-full-1/log.txt"
    check("interrupted" in log.read_text(), "the training did not save")
    benchmark.submit()
    benchmark.finish()


shutil.rmtree(OUT, ignore_errors=True)
OUT.mkdir(parents=True)
slurm = Slurm()
try:
    for one in [here, submitted, lost_node, warned, cancelled]:
        start = time.monotonic()
        one(slurm)
        print(f"| {one.__doc__} | {time.monotonic() - start:.0f} s |", flush=True)
finally:
    slurm.stop()
