"""Parses the files of a ROS 2 setup and checks the names that controller and driver read."""

import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import yaml

folder = Path(sys.argv[1])
controllers = yaml.safe_load((folder / "controllers.yaml").read_text())
drive = controllers["diff_drive_controller"]["ros__parameters"]
managed = controllers["controller_manager"]["ros__parameters"]
assert managed["diff_drive_controller"]["type"] == "diff_drive_controller/DiffDriveController"
assert drive["wheel_separation"] == 0.3 and drive["wheel_radius"] == 0.0503, drive
# 200 rpm are 20.944 rad/s.
assert abs(drive["linear"]["x"]["max_velocity"] - 1.053) < 1e-9, drive
assert abs(drive["angular"]["z"]["max_velocity"] - 7.023) < 1e-9, drive
# The command times out, so that silence stops the wheels.
assert 0 < drive["cmd_vel_timeout"] <= 0.5

robot = xml.parse(folder / "robot.urdf").getroot()
hardware = robot.find("ros2_control/hardware")
assert hardware.find("plugin").text == "ddsm115_ros2_driver/DDSM115SystemHardware"
values = {param.get("name"): param.text for param in hardware.findall("param")}
assert values == {"usb_path": "/dev/ttyUSB0", "serial_baud": "115200"}, values
joints = {joint.get("name"): joint for joint in robot.findall("ros2_control/joint")}
assert [*joints] == drive["left_wheel_names"] + drive["right_wheel_names"], joints
kinematic = {joint.get("name") for joint in robot.findall("joint")}
assert kinematic == set(joints), kinematic
expected = {"left_wheel_joint": ("1", "false"), "right_wheel_joint": ("2", "true")}
for name, joint in joints.items():
    values = {param.get("name"): param.text for param in joint.findall("param")}
    assert values == dict(zip(("motor_id", "invert_direction"), expected[name])), values
    assert [one.get("name") for one in joint.findall("command_interface")] == ["velocity"]
    states = [one.get("name") for one in joint.findall("state_interface")]
    assert states == ["position", "velocity", "effort"], states
