"""Reads messages by rosbags, writes each again, and compares bytes, values and the hash of the type.

The folder has one file for each message, named NUMBER%DOMAIN%NAME...%TYPE%HASH.
"""

import collections
import sys
from pathlib import Path

from rosbags.typesys import Stores, get_typestore

store = get_typestore(Stores.ROS2_JAZZY)
counts = collections.Counter()
for file in sorted(Path(sys.argv[1]).iterdir()):
    *_, dds, rihs01 = file.name.split("%")
    package, kind, _, name = dds.split("::")
    name = f"{package}/{kind}/{name.removesuffix('_')}"
    assert store.hash_rihs01(name) == rihs01, (name, rihs01)
    payload = file.read_bytes()
    message = store.deserialize_cdr(payload, name)
    written = bytes(store.serialize_cdr(message, name))
    # Some writers fill up to four bytes at the end.
    assert written.rstrip(b"\0") == payload.rstrip(b"\0"), (name, payload.hex(), written.hex())
    assert abs(len(written) - len(payload)) < 4, name
    counts[name] += 1
    if name.endswith("JointState"):
        assert list(message.name) == ["left_wheel_joint", "right_wheel_joint"]
    if name.endswith("Odometry"):
        assert message.pose.covariance[35] == 0.01
expected = {
    "sensor_msgs/msg/JointState",
    "sensor_msgs/msg/Temperature",
    "nav_msgs/msg/Odometry",
    "tf2_msgs/msg/TFMessage",
    "diagnostic_msgs/msg/DiagnosticArray",
    "geometry_msgs/msg/Twist",
}
assert expected <= set(counts), counts
print(*(f"{name}: {count} messages equal" for name, count in sorted(counts.items())), sep="\n")
