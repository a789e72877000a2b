//! Other programs read what this one says, and find it.

use std::{
    env, fs,
    process::Command,
    sync::{Arc, Mutex},
    thread::sleep,
    time::Duration,
};

use hiroz::{Builder as _, MessageTypeInfo, ServiceTypeInfo, node::ZNode};
use hiroz_msgs::{
    diagnostic_msgs::DiagnosticArray,
    geometry_msgs::{Twist, TwistStamped},
    nav_msgs::Odometry,
    sensor_msgs::{JointState, Temperature},
    std_srvs::srv::Trigger,
    tf2_msgs::TFMessage,
};
use motorlink_ros::node::messages::{self, RosType};
use zenoh::Wait as _;

use crate::bench::{Asking, Bench, PATIENCE};

#[test]
fn types_have_the_names_and_hashes_of_hiroz() {
    fn same<Ours: RosType, Theirs: MessageTypeInfo>() {
        let theirs = Theirs::type_info();
        assert_eq!(Ours::NAME, theirs.name);
        assert_eq!(
            format!("RIHS01_{}", Ours::HASH),
            theirs.hash.to_rihs_string()
        );
    }
    same::<messages::Twist, Twist>();
    same::<messages::TwistStamped, TwistStamped>();
    same::<messages::JointState, JointState>();
    same::<messages::Odometry, Odometry>();
    same::<messages::TfMessage, TFMessage>();
    same::<messages::Temperature, Temperature>();
    same::<messages::DiagnosticArray, DiagnosticArray>();
    let trigger = Trigger::service_type_info();
    assert_eq!(messages::Trigger::NAME, trigger.name);
    assert_eq!(
        format!("RIHS01_{}", messages::Trigger::HASH),
        trigger.hash.to_rihs_string()
    );
}

/// A robot with a namespace, and a node of hiroz that drives it ahead.
fn driven() -> (Bench, ZNode, Asking) {
    let mut bench = Bench::start(&[
        "--namespace",
        "/robot1",
        "--frame-prefix",
        "robot1/",
        "--torque-constant",
        "0.8",
    ]);
    let node = bench.node_in("robot1");
    let asking = Asking::new(&node);
    bench.drive(&asking, (0.4, 0.0), 70.0);
    (bench, node, asking)
}

#[test]
fn hiroz_reads_joints_and_odometry() {
    let (_bench, node, _asking) = driven();
    let joints = node
        .create_sub::<JointState>("joint_states")
        .build()
        .unwrap();
    let odometry = node.create_sub::<Odometry>("odom").build().unwrap();
    let transforms = node.create_sub::<TFMessage>("/tf").build().unwrap();
    let first = joints.recv_timeout(PATIENCE).unwrap();
    let mut later = first.clone();
    for _ in 0..30 {
        later = joints.recv_timeout(PATIENCE).unwrap();
    }
    assert_eq!(later.name, ["left_wheel_joint", "right_wheel_joint"]);
    for wheel in 0..2 {
        assert!(
            later.position[wheel] > first.position[wheel],
            "ahead is positive"
        );
    }
    assert!((later.velocity[0] - 8.0).abs() < 1.0, "{later:?}");
    assert_eq!(later.effort.len(), 2);

    let moved = odometry.recv_timeout(PATIENCE).unwrap();
    assert_eq!(moved.header.frame_id, "robot1/odom");
    assert_eq!(moved.child_frame_id, "robot1/base_link");
    let at = |moved: &Odometry| {
        f64::from(moved.header.stamp.sec) + f64::from(moved.header.stamp.nanosec) / 1e9
    };
    let mut newer = moved.clone();
    while at(&newer) < at(&moved) + 1.0 {
        newer = odometry.recv_timeout(PATIENCE).unwrap();
    }
    let way = newer.pose.pose.position.x - moved.pose.pose.position.x;
    assert!((way - 0.4).abs() < 0.1, "{newer:?}");
    assert!(newer.pose.pose.position.y.abs() < 0.2, "{newer:?}");
    assert!((newer.pose.covariance[0] - 0.001).abs() < 1e-9);
    assert!((newer.pose.covariance[35] - 0.01).abs() < 1e-9);
    assert!((newer.twist.covariance[14] - 1e6).abs() < 1e-3);

    let transform = transforms.recv_timeout(PATIENCE).unwrap();
    let transform = &transform.transforms[0];
    assert_eq!(transform.header.frame_id, "robot1/odom");
    assert!(transform.transform.translation.x > 0.1, "{transform:?}");
    assert!((transform.transform.rotation.w - 1.0).abs() < 0.01);
}

#[test]
fn hiroz_reads_diagnostics_and_finds_the_node() {
    let (_bench, node, _asking) = driven();
    let diagnostics = node
        .create_sub::<DiagnosticArray>("/diagnostics")
        .build()
        .unwrap();
    let temperature = node
        .create_sub::<Temperature>("motor_1/temperature")
        .build()
        .unwrap();
    let status = diagnostics.recv_timeout(PATIENCE).unwrap().status;
    let names: Vec<_> = status.iter().map(|status| status.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "/robot1/motorlink: drive",
            "/robot1/motorlink: motor 1",
            "/robot1/motorlink: motor 2"
        ]
    );
    assert_eq!(status[0].message, "drives");
    let degrees = temperature.recv_timeout(PATIENCE).unwrap();
    assert!(
        degrees.temperature > 15.0 && degrees.temperature < 60.0,
        "{degrees:?}"
    );
    assert_eq!(degrees.header.frame_id, "robot1/left_wheel");

    let graph = node.graph();
    let nodes = format!("{:?}", graph.get_node_names());
    assert!(
        nodes.contains("motorlink") && nodes.contains("/robot1"),
        "{nodes}"
    );
    let topics = format!("{:?}", graph.get_topic_names_and_types());
    for topic in [
        "/robot1/odom",
        "/robot1/joint_states",
        "/robot1/cmd_vel",
        "/tf",
        "/diagnostics",
    ] {
        assert!(topics.contains(topic), "{topic} in {topics}");
    }
}

/// Needs Python with rosbags, in `MOTORLINK_PYTHON`.
#[test]
fn rosbags_reads_and_writes_every_message() {
    let mut bench = Bench::start(&[]);
    let folder = bench.folder().join("messages");
    fs::create_dir(&folder).unwrap();
    let seen = Arc::new(Mutex::new(Vec::<(String, Vec<u8>)>::new()));
    let all = Arc::clone(&seen);
    let subscriber = bench.router.as_ref().unwrap().declare_subscriber("0/**");
    let subscriber = subscriber
        .callback(move |sample| {
            let message = (
                sample.key_expr().to_string(),
                sample.payload().to_bytes().into_owned(),
            );
            all.lock().unwrap().push(message);
        })
        .wait()
        .unwrap();
    let node = bench.node();
    let asking = Asking::new(&node);
    bench.drive(&asking, (0.4, 0.5), 50.0);
    sleep(Duration::from_secs(3));
    subscriber.undeclare().wait().unwrap();
    for (number, (key, payload)) in seen.lock().unwrap().iter().enumerate() {
        let name = key.replace('/', "%");
        fs::write(folder.join(format!("{number}%{name}")), payload).unwrap();
    }
    let python =
        env::var_os("MOTORLINK_PYTHON").expect("MOTORLINK_PYTHON names Python with rosbags");
    let script = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/read_by_rosbags.py");
    let output = Command::new(python)
        .arg(script)
        .arg(&folder)
        .output()
        .unwrap();
    let (said, complaint) = (
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr),
    );
    assert!(output.status.success(), "{said}{complaint}");
    println!("{said}");
}
