"""Parses the files of a robot for ROS 2 and prints the speed of each motor for some motions of the robot.

Each line is metres a second, radians a second to the left, and `motor=rpm` for each motor, with the sign of the wire.
"""

import math
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import yaml
from urdf_parser_py.urdf import URDF

# Of diff_drive_controller_parameter.yaml, ros2_controllers 2.54.0 (Humble) and 4.42.1 (Jazzy).
BOTH = {
    "left_wheel_names": list,
    "right_wheel_names": list,
    "wheel_separation": float,
    "wheel_radius": float,
    "wheel_separation_multiplier": float,
    "left_wheel_radius_multiplier": float,
    "right_wheel_radius_multiplier": float,
    "odom_frame_id": str,
    "base_frame_id": str,
    "pose_covariance_diagonal": list,
    "twist_covariance_diagonal": list,
    "open_loop": bool,
    "position_feedback": bool,
    "enable_odom_tf": bool,
    "cmd_vel_timeout": float,
    "publish_rate": float,
}
LIMITS = {
    "has_velocity_limits": bool,
    "max_velocity": float,
    "min_velocity": float,
    "has_acceleration_limits": bool,
    "max_acceleration": float,
}
HUMBLE = {"use_stamped_vel": bool}
HUMBLE_LIMITS = {"min_acceleration": float}
JAZZY_LIMITS = {"max_deceleration": float}
# Metres a second ahead, and radians a second to the left.
MOTIONS = [(0.3, 0.0), (-0.3, 0.0), (0.0, 1.0), (0.0, -1.0), (0.4, 0.7), (-0.1, 2.0)]

folder = Path(sys.argv[1])
controllers = yaml.safe_load((folder / "controllers.yaml").read_text())
text = (folder / "rover.urdf").read_text()
robot = URDF.from_xml_string(text)


def check_parameters():
    """Each has a name that both distributions read, or one of them, and its type."""
    managed = controllers["controller_manager"]["ros__parameters"]
    types = {name: value["type"] for name, value in managed.items() if isinstance(value, dict)}
    assert types == {
        "diff_drive_controller": "diff_drive_controller/DiffDriveController",
        "joint_state_broadcaster": "joint_state_broadcaster/JointStateBroadcaster",
    }, types
    drive = dict(controllers["diff_drive_controller"]["ros__parameters"])
    for axis, direction in (("linear", "x"), ("angular", "z")):
        limits = drive.pop(axis)
        assert [*limits] == [direction], limits
        limits = limits[direction]
        expected = {**LIMITS, **HUMBLE_LIMITS, **JAZZY_LIMITS}
        assert {name: type(value) for name, value in limits.items()} == expected, limits
        assert limits["has_velocity_limits"] and limits["has_acceleration_limits"]
        assert limits["max_velocity"] > 0 and limits["min_velocity"] == -limits["max_velocity"]
        slower = -limits["max_acceleration"]
        assert slower < 0 and limits["max_deceleration"] == limits["min_acceleration"] == slower
    assert {name: type(value) for name, value in drive.items()} == {**BOTH, **HUMBLE}, drive
    for name in ("pose_covariance_diagonal", "twist_covariance_diagonal"):
        assert [type(value) for value in drive[name]] == [float] * 6, drive[name]
    # The command times out, so that silence stops the wheels.
    assert 0 < drive["cmd_vel_timeout"] <= 0.5
    assert drive["position_feedback"] is True
    assert len(drive["left_wheel_names"]) == len(drive["right_wheel_names"])
    return controllers["diff_drive_controller"]["ros__parameters"]


def check_tree(drive):
    """The base is on the ground and between the wheels, and the joints are those that the controller names."""
    assert robot.get_root() == drive["base_frame_id"] == "base_footprint"
    (base,) = (joint for joint in robot.joints if joint.type == "fixed")
    assert (base.parent, base.child) == ("base_footprint", "base_link")
    radius = drive["wheel_radius"]
    assert base.origin.xyz == [0, 0, radius], base.origin
    wheels = {joint.name: joint for joint in robot.joints if joint.type == "continuous"}
    assert sorted(wheels) == sorted(drive["left_wheel_names"] + drive["right_wheel_names"])
    places = [joint.origin.xyz for joint in wheels.values()]
    for middle in zip(*places):
        assert abs(sum(middle)) < 1e-9, places
    for joint in wheels.values():
        assert joint.parent == "base_link" and joint.axis == [0, 1, 0]
        (shown,) = robot.link_map[joint.child].visuals
        assert shown.geometry.radius == radius and 0 < shown.geometry.length < 2 * radius
    return wheels


def check_hardware(wheels):
    """Its parameters are those that the plugin reads. Gives motor and sign of each joint."""
    control = xml.fromstring(text).find("ros2_control")
    hardware = control.find("hardware")
    assert hardware.find("plugin").text == "motorlink_hardware/MotorLinkSystem"
    values = {param.get("name"): param.text for param in hardware.findall("param")}
    assert values == {"socket": "/run/motorlink/socket"}, values
    motors = {}
    for joint in control.findall("joint"):
        values = {param.get("name"): param.text for param in joint.findall("param")}
        assert {*values} == {"id", "mirrored", "max_rpm"}, values
        motors[joint.get("name")] = (int(values["id"]), {"true": -1, "false": 1}[values["mirrored"]])
        assert [one.get("name") for one in joint.findall("command_interface")] == ["velocity"]
        states = [one.get("name") for one in joint.findall("state_interface")]
        assert states == ["position", "velocity", "temperature"], states
    assert [*motors] == [*wheels]
    return motors


def check_launch():
    """It starts the nodes in any folder: the files it names are beside it, and each controller gets its parameters."""
    launch = xml.parse(folder / "rover.launch.xml").getroot()
    nodes = [(node.get("pkg"), node.get("exec")) for node in launch.findall("node")]
    assert nodes == [
        ("robot_state_publisher", "robot_state_publisher"),
        ("controller_manager", "ros2_control_node"),
        ("controller_manager", "spawner"),
        ("controller_manager", "spawner"),
    ], nodes
    named = [value for node in launch.iter() for value in node.attrib.values() if "$(dirname)/" in value]
    named = [value.split("$(dirname)/")[1].rstrip(")'") for value in named]
    assert named == ["rover.urdf"] + ["controllers.yaml"] * 3, named
    assert all((folder / name).is_file() for name in named)
    spawned = [node.get("args").split() for node in launch.findall("node[@exec='spawner']")]
    assert sorted(words[0] for words in spawned) == ["diff_drive_controller", "joint_state_broadcaster"]
    assert all(words[1] == "--param-file" for words in spawned), spawned


drive = check_parameters()
wheels = check_tree(drive)
motors = check_hardware(wheels)
check_launch()
for ahead, left in MOTIONS:
    words = [repr(ahead), repr(left)]
    for name, joint in wheels.items():
        # As the controller: a side turns by its half of the separation.
        side = -1 if name in drive["left_wheel_names"] else 1
        turns = (ahead + side * left * drive["wheel_separation"] / 2) / drive["wheel_radius"]
        # By the description: the place of the wheel moves, and the wheel rolls on the ground.
        radius = robot.joint_map["base_joint"].origin.xyz[2]
        rolls = (ahead - left * joint.origin.xyz[1]) / radius
        assert abs(turns - rolls) <= 1e-9, (name, turns, rolls)
        motor, sign = motors[name]
        words.append(f"{motor}={sign * turns * 60 / math.tau!r}")
    print(*words)
for axis, direction in (("linear", "x"), ("angular", "z")):
    print(axis, *(drive[axis][direction][f"max_{name}"] for name in ("velocity", "acceleration")))
