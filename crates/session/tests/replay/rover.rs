//! The motion of a rover in a session file: `/odom` and `/cmd_vel`.

use std::{f64::consts::FRAC_PI_6, fmt::Debug, str::FromStr};

use motorlink_messages::experiments::vehicle::{Geometry, Vehicle, Wheel};
use motorlink_protocol::family::Model;
use motorlink_session::{for_each_record, open};
use nojson::RawJson;

use super::live::{Live, id, ms, rpm};

/// Motor 1 on the left, motor 2 mounted mirrored on the right.
fn rover() -> String {
    let wheel = |address, is_right| Wheel {
        id: id(address),
        is_right,
        name: String::new(),
    };
    let vehicle = Vehicle::new(vec![wheel(1, false), wheel(2, true)]).unwrap();
    vehicle.to_json(Geometry::new(50, 300).unwrap())
}

/// The messages of a topic, with their times in nanoseconds.
fn messages(file: &[u8], topic: &str, schema: &str) -> Vec<(u64, String)> {
    let messages = mcap::MessageStream::new(file).unwrap().map(Result::unwrap);
    let messages = messages.filter(|message| message.channel.topic == topic);
    let texts = messages.map(|message| {
        assert_eq!(message.channel.schema.as_ref().unwrap().name, schema);
        let text = String::from_utf8(message.data.to_vec()).unwrap();
        (message.log_time, text)
    });
    texts.collect()
}

fn number<T: FromStr<Err: Debug>>(message: &str, path: &[&str]) -> T {
    let json = RawJson::parse(message).unwrap();
    let of = path.iter().fold(json.value(), |of, name| {
        of.to_member(name).unwrap().required().unwrap()
    });
    of.as_raw_str().parse().unwrap()
}

#[track_caller]
fn assert_near(value: f64, wanted: f64, apart: f64) {
    assert!((value - wanted).abs() <= apart, "{value} is not {wanted}");
}

#[test]
fn a_rover_goes_ahead_then_to_the_right() {
    for model in [Model::Ddsm115, Model::Ddsm400] {
        let mut live = Live::of(model);
        live.drive(1, rpm(60));
        live.drive(2, rpm(-60));
        live.run(ms(3_000));
        live.drive(2, rpm(-30));
        live.run(ms(1_000));
        let (file, _) = live.end_as(&[("page", "test"), ("rover", &rover())]);

        let odom = messages(&file, "/odom", "nav_msgs/msg/Odometry");
        let commands = messages(&file, "/cmd_vel", "geometry_msgs/msg/TwistStamped");
        assert!((180..=260).contains(&odom.len()), "{model}: {}", odom.len());
        assert!(
            (150..=210).contains(&commands.len()),
            "{model}: {}",
            commands.len()
        );
        for (ns, message) in odom.iter().chain(&commands) {
            let stamp = |name| number::<u64>(message, &["header", "stamp", name]);
            assert_eq!(stamp("sec") * 1_000_000_000 + stamp("nanosec"), *ns);
        }

        // 60 rpm of a wheel of 50 mm are 314 mm/s.
        let ahead = &odom[odom.len() - 60].1;
        let twist = ["twist", "twist", "linear", "x"];
        assert_near(number(ahead, &twist), 0.314, 0.015);
        assert_near(number(ahead, &["pose", "pose", "position", "y"]), 0.0, 0.05);
        assert_near(
            number(ahead, &["pose", "pose", "orientation", "w"]),
            1.0,
            0.005,
        );
        let turning = &odom[odom.len() - 1].1;
        assert_near(number(turning, &twist), 0.236, 0.015);
        let turn = ["twist", "twist", "angular", "z"];
        assert_near(number(turning, &turn), -0.524, 0.03);
        assert!(
            number::<f64>(turning, &["pose", "pose", "position", "x"]) > 0.9,
            "{turning}"
        );
        assert!(
            number::<f64>(turning, &["pose", "pose", "position", "y"]) < -0.03,
            "{turning}"
        );
        let half: f64 = number(turning, &["pose", "pose", "orientation", "z"]);
        let yaw = 2.0 * half.asin();
        assert_near(yaw, -0.45, 0.1);

        let (_, command) = commands.last().unwrap();
        assert_near(number(command, &["twist", "linear", "x"]), 0.235_619, 1e-6);
        assert_near(
            number(command, &["twist", "angular", "z"]),
            -FRAC_PI_6,
            1e-6,
        );

        let mut source = &file[..];
        let session = open(&mut source).unwrap().unwrap();
        assert_eq!(session.about()["rover"], rover());
        let problems = for_each_record(&mut source, &session, |_| {}).unwrap();
        assert!(problems.is_empty(), "{problems}");
    }
}

#[test]
fn a_file_without_a_rover_has_no_motion() {
    let mut live = Live::of(Model::Ddsm115);
    live.drive(1, rpm(60));
    live.run(ms(500));
    let (file, _) = live.end();
    assert!(messages(&file, "/odom", "").is_empty());
    assert!(messages(&file, "/cmd_vel", "").is_empty());
}
