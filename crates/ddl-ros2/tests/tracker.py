"""A tracker: 30 people who walk, ten times a second. Arguments: domain, number of messages."""

import math
import sys
import time

import messages as m
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.topic import Topic
from dds import QOS, until

domain, frames = map(int, sys.argv[1:])
participant = DomainParticipant(domain)
writer = DataWriter(participant, Topic(participant, "rt/tracks", m.People), qos=QOS)
until(writer.get_matched_subscriptions)
time.sleep(0.5)
begin = time.time()
for frame in range(frames):
    time.sleep(max(0, begin + frame / 10 - time.time()))
    walked = 0.12 * frame
    people = []
    for i in range(30):
        place = m.Point(walked + 0.3 * math.sin(i), 1.1 * i + 0.02 * math.sin(frame), 0)
        people.append(m.Person(f"person-{i}", place, m.Point(1.2, 0, 0), 1, [], []))
    microseconds = int(1e6 * time.time())
    stamp = m.Time(microseconds // 1_000_000, microseconds % 1_000_000 * 1000)
    writer.write(m.People(m.Header(stamp, "map"), people))
# Until everything has been sent.
time.sleep(1)
