"""An independent DDS (Cyclone) on the loopback interface, and the node as its own process beside it."""

import os
import subprocess
import time
from pathlib import Path

# One domain for each process of the tests, away from that of a robot.
DOMAIN = 100 + os.getpid() % 100
os.environ["CYCLONEDDS_URI"] = """<CycloneDDS><Domain><General>
  <Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces><AllowMulticast>false</AllowMulticast>
</General><Discovery><ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers></Discovery>
</Domain></CycloneDDS>"""

from cyclonedds.core import Policy, Qos  # noqa: E402
from cyclonedds.domain import DomainParticipant  # noqa: E402
from cyclonedds.pub import DataWriter  # noqa: E402
from cyclonedds.sub import DataReader  # noqa: E402
from cyclonedds.topic import Topic  # noqa: E402
from cyclonedds.util import duration  # noqa: E402

# What the middleware of ROS 2 sets: reliable, and the encoding of DDS before XTypes.
POLICIES = [
    Policy.Reliability.Reliable(duration(seconds=1)),
    Policy.History.KeepLast(1000),
    Policy.DataRepresentation(use_cdrv0_representation=True),
]
QOS = Qos(Policy.Durability.Volatile, *POLICIES)
LATCHED = Qos(Policy.Durability.TransientLocal, *POLICIES)


class Robot:
    """A participant, and the nodes that it has started."""

    def __init__(self, program, log):
        self.program, self.log = program, log
        Path(log).touch()
        self.participant = DomainParticipant(DOMAIN)
        self.nodes = []

    def start(self, *options):
        command = [self.program, "--domain", str(DOMAIN), *options]
        with open(self.log, "w") as log:
            self.nodes.append(subprocess.Popen(command, stderr=log))

    def writer(self, topic, kind, qos=QOS):
        return DataWriter(self.participant, Topic(self.participant, f"rt{topic}", kind), qos=qos)

    def reader(self, topic, kind):
        return DataReader(self.participant, Topic(self.participant, f"rt{topic}", kind), qos=QOS)

    def told(self):
        return Path(self.log).read_text()


def until(condition, seconds=20):
    """Waits until the condition has a value, and returns it."""
    end = time.monotonic() + seconds
    while not (value := condition()):
        assert time.monotonic() < end, "waited too long"
        time.sleep(0.02)
    return value


def matched(*endpoints):
    """Waits until every writer has its reader, and every reader its writer."""
    for endpoint in endpoints:
        other = "get_matched_publications" if isinstance(endpoint, DataReader) else "get_matched_subscriptions"
        until(getattr(endpoint, other))
    # A reliable writer of the node may learn of its reader later.
    time.sleep(0.5)
