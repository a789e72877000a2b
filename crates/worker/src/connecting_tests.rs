use std::time::Duration;

use motorlink_bus::{Consent, IdQueryOutcome, StopReason};
use motorlink_messages::{Connection, LineError, UsbId, VirtualMotors};
use motorlink_protocol::{Setpoint, SpeedTarget};
use motorlink_simulator::LineCondition;
use wasm_bindgen_test::wasm_bindgen_test;

use super::*;
use crate::mock_serial::{Bench, CH340, MockPort};

const ONE: MotorId = MotorId::FIRST;

/// The page is connected and drives motor 1 at +100 rpm.
async fn driving(bench: &Bench, port: &MockPort) {
    bench.plug(port);
    bench.connect();
    bench.until_connected().await;
    bench
        .until("a reply", |bench| {
            let owner = bench.owner.borrow();
            let PortState::Open(open) = &owner.port else {
                return false;
            };
            let mut motors = open.host.bus.motors(bench.now());
            open.host.bus.model_known() && motors.any(|motor| motor.last.is_some())
        })
        .await;
    bench.command(Command::Drive {
        id: ONE,
        setpoint: Setpoint::velocity(SpeedTarget::new(100).unwrap()),
        consent: Consent::None,
    });
    bench.until("+100 rpm", |_| port.speed(1) > 90.0).await;
}

/// The speed of a motor on the virtual line, and the fault that waits until it is at rest.
fn virtual_motor(bench: &Bench) -> (f32, Option<LineCondition>) {
    let owner = bench.owner.borrow();
    let PortState::Open(open) = &owner.port else {
        return (0.0, None);
    };
    let Line::Virtual(_, world) = &open.host.line else {
        panic!("a serial line");
    };
    let motor = world.motor(ONE).unwrap();
    (motor.speed_rpm(), open.next_wire)
}

/// Both motors obey the frames of the one that the user started.
#[wasm_bindgen_test]
async fn a_shared_id_begins_at_standstill() {
    let bench = Bench::new();
    bench.send(ToWorker::ConnectVirtual(VirtualLine {
        motors: VirtualMotors::One,
        model: Model::Ddsm115,
    }));
    bench.until_connected().await;
    bench.pause(Duration::from_millis(500)).await;
    bench.command(Command::Drive {
        id: ONE,
        setpoint: Setpoint::velocity(SpeedTarget::new(100).unwrap()),
        consent: Consent::None,
    });
    bench
        .until("+100 rpm", |bench| virtual_motor(bench).0 > 90.0)
        .await;
    bench.send(ToWorker::VirtualWire(LineCondition::SharedId));
    assert_eq!(virtual_motor(&bench).1, Some(LineCondition::SharedId));
    bench
        .until("the fault", |bench| virtual_motor(bench).1.is_none())
        .await;
    assert!(virtual_motor(&bench).0.abs() < 1.0);
    let is_confirmed = |notice: &Notice| match notice {
        Notice::StopEnded(report) => report.motors.iter().all(|motor| motor.confirmed),
        _ => false,
    };
    bench
        .until("its report", |bench| {
            bench.notices().iter().any(is_confirmed)
        })
        .await;
}

/// Whether this frame brakes motor 1, or switches it to the velocity loop in which it brakes.
fn stops(frame: &[u8]) -> bool {
    matches!(frame, [1, 0x64, 0, 0, _, _, _, 0xFF, ..] | [1, 0xA0, ..])
}

fn stops_left_driven(bench: &Bench) -> Vec<Vec<(MotorId, bool)>> {
    let notices = bench.notices();
    let ended = notices.iter().filter_map(|notice| match notice {
        Notice::StopEnded(report) if report.reason == StopReason::LeftDriven => Some(
            report
                .motors
                .iter()
                .map(|motor| (motor.id, motor.confirmed))
                .collect(),
        ),
        _ => None,
    });
    ended.collect()
}

#[wasm_bindgen_test]
async fn what_was_driven_when_the_adapter_was_pulled_out_is_stopped_first_when_it_is_back() {
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    driving(&bench, &port).await;
    bench.unplug(&port);
    bench.pause(Duration::from_millis(50)).await;
    let back = bench.port_to(CH340, port.world.clone());
    bench.plug(&back);
    bench
        .until("the stop", |bench| !stops_left_driven(bench).is_empty())
        .await;
    assert!(stops(&back.frames()[0]), "{:02X?}", back.frames());
    assert_eq!(stops_left_driven(&bench), [[(ONE, true)]]);
    assert!(back.speed(1).abs() < 1.0);
    bench.until_connected().await;
}

/// The script that starts the worker, with its claims and its files.
fn with_files() {
    let script = include_str!("../../../boot/adapters.js");
    js_sys::eval(&format!("(() => {{ {script} }})()")).unwrap();
}

fn without_files() {
    js_sys::eval("delete self.claimAdapter").unwrap();
}

/// Two motors of one ID on two adapters of one make: only the one that turns is stopped. The other one gets queries only.
async fn the_one_that_turns_is_found(usb: Option<UsbId>) {
    let bench = Bench::new();
    let port = bench.port(usb, &[1]);
    driving(&bench, &port).await;
    drop(bench);

    let bench = Bench::new();
    let twin = bench.port(usb, &[1]);
    let turning = bench.port_to(usb, port.world.clone());
    bench.plug(&twin);
    bench.plug(&turning);
    bench.connect_left(&[1]);
    bench
        .until("the stop", |bench| !stops_left_driven(bench).is_empty())
        .await;
    assert_eq!(stops_left_driven(&bench), [[(ONE, true)]]);
    bench.until_connected().await;
    assert!(turning.speed(1).abs() < 1.0);
    let drives = |frame: &Vec<u8>| matches!(frame.as_slice(), [1, 0x64, ..]);
    assert!(!twin.frames().is_empty());
    assert!(!twin.frames().iter().any(drives), "{:02X?}", twin.frames());
    let first = turning.frames().into_iter().find(drives).unwrap();
    assert!(stops(&first), "{first:02X?}");
}

#[wasm_bindgen_test]
async fn of_two_identical_adapters_the_one_with_a_turning_wheel_is_found_by_asking() {
    the_one_that_turns_is_found(CH340).await;
}

#[wasm_bindgen_test]
async fn of_two_ports_without_usb_ids_the_one_with_a_turning_wheel_is_found_by_asking() {
    the_one_that_turns_is_found(None).await;
}

#[wasm_bindgen_test]
async fn an_adapter_that_was_there_all_along_is_not_taken_for_the_one_that_was_pulled_out() {
    let bench = Bench::new();
    let twin = bench.port(CH340, &[2]);
    let port = bench.port(CH340, &[1]);
    bench.plug(&twin);
    driving(&bench, &port).await;
    let asked = twin.frames().len();
    bench.unplug(&port);
    bench.pause(Duration::from_millis(600)).await;
    let back = bench.port_to(CH340, port.world.clone());
    bench.plug(&back);
    bench
        .until("the stop", |bench| !stops_left_driven(bench).is_empty())
        .await;
    assert!(stops(&back.frames()[0]), "{:02X?}", back.frames());
    assert_eq!(twin.frames().len(), asked);
}

/// Its twin, whose motor has the same ID, is opened then. It gets a stop, too, but the motor stays remembered.
#[wasm_bindgen_test]
async fn an_adapter_that_is_lost_while_it_is_tried_may_have_the_turning_wheel() {
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    driving(&bench, &port).await;
    drop(bench);

    let bench = Bench::new();
    let turning = bench.port_to(CH340, port.world.clone());
    let twin = bench.port(CH340, &[1]);
    bench.plug(&turning);
    bench.plug(&twin);
    bench.connect_left(&[1]);
    bench
        .until("the trial", |_| !turning.frames().is_empty())
        .await;
    bench.unplug(&turning);
    bench.until_connected().await;
    bench.pause(Duration::from_millis(300)).await;
    assert!(turning.speed(1) > 90.0);
    let mut owner = bench.owner.borrow_mut();
    let left = owner.left.of(CH340).motors.iter();
    assert_eq!(left.map(|motor| motor.id).collect::<Vec<_>>(), [ONE]);
}

#[wasm_bindgen_test]
async fn a_motor_left_driven_that_does_not_answer_does_not_hide_the_others() {
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    bench.plug(&port);
    bench.connect_left(&[7]);
    bench.until_connected().await;
    bench
        .until("motor 1", |bench| {
            let updates = bench.updates.borrow();
            let known = |update: &motorlink_messages::Update| {
                update
                    .motors
                    .iter()
                    .any(|motor| motor.id == ONE && motor.last.is_some())
            };
            updates.last().is_some_and(known)
        })
        .await;
}

/// A worker opens the port of a motor that another one has left driven, on a line that is dead. Beside it, there are ports
/// of these makes without a motor.
async fn left_driven_on_a_dead_line(others: &[Option<UsbId>]) -> (Bench, MockPort) {
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    driving(&bench, &port).await;
    drop(bench);

    let bench = Bench::new();
    let port = bench.port_to(CH340, port.world.clone());
    set_line(&bench, &port, LineCondition::Dead);
    bench.plug(&port);
    for make in others {
        let other = bench.port(*make, &[]);
        bench.plug(&other);
    }
    bench.connect_left(&[1]);
    (bench, port)
}

fn set_line(bench: &Bench, port: &MockPort, condition: LineCondition) {
    let now = bench.now();
    port.world.borrow_mut().set_line_condition(now, condition);
}

/// The line is good again when the model is looked for.
#[wasm_bindgen_test]
async fn a_motor_left_driven_that_answers_late_is_stopped() {
    let (bench, port) = left_driven_on_a_dead_line(&[]).await;
    bench
        .until("the stop", |bench| !stops_left_driven(bench).is_empty())
        .await;
    assert_eq!(stops_left_driven(&bench), [[(ONE, false)]]);
    assert!(port.speed(1) > 90.0);
    set_line(&bench, &port, LineCondition::Good);
    bench
        .until("the other stop", |bench| {
            stops_left_driven(bench).len() == 2
        })
        .await;
    assert_eq!(stops_left_driven(&bench)[1], [(ONE, true)]);
    assert!(port.speed(1).abs() < 1.0);
    bench.until_connected().await;
}

/// The line is good again once the port is open.
async fn it_is_stopped_when_its_port_is_open(others: &[Option<UsbId>]) {
    let (bench, port) = left_driven_on_a_dead_line(others).await;
    bench.until_connected().await;
    assert!(port.speed(1) > 90.0);
    set_line(&bench, &port, LineCondition::Good);
    bench
        .until("standstill", |_| port.speed(1).abs() < 1.0)
        .await;
    bench
        .until("the report", |bench| {
            stops_left_driven(bench).last() == Some(&vec![(ONE, true)])
        })
        .await;
}

#[wasm_bindgen_test]
async fn a_motor_left_driven_that_answers_when_its_port_is_open_is_stopped() {
    it_is_stopped_when_its_port_is_open(&[]).await;
}

#[wasm_bindgen_test]
async fn beside_an_adapter_of_another_make_it_is_stopped_too() {
    it_is_stopped_when_its_port_is_open(&[None]).await;
}

#[wasm_bindgen_test]
async fn what_is_driven_is_on_file_before_its_first_frame_and_the_next_worker_stops_it_first() {
    with_files();
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    // The file of the last test.
    driving(&bench, &port).await;
    // As when the tab is killed: nothing is written any more, and the browser closes the file.
    drop(bench);
    let bench = Bench::new();
    release_claim();
    let again = bench.port_to(CH340, port.world.clone());
    bench.plug(&again);
    bench.connect();
    bench
        .until("the stop", |bench| !stops_left_driven(bench).is_empty())
        .await;
    assert!(stops(&again.frames()[0]), "{:02X?}", again.frames());
    assert_eq!(stops_left_driven(&bench), [[(ONE, true)]]);
    bench.until_connected().await;

    // Standstill is confirmed, so the worker after that one has nothing to stop.
    drop(bench);
    let bench = Bench::new();
    release_claim();
    let last = bench.port_to(CH340, port.world.clone());
    bench.plug(&last);
    bench.connect();
    bench.until_connected().await;
    bench.pause(Duration::from_millis(300)).await;
    assert!(stops_left_driven(&bench).is_empty());
    assert!(!last.frames().iter().any(|frame| stops(frame)));
    release_claim();
    without_files();
}

#[wasm_bindgen_test]
async fn the_file_names_a_motor_before_a_frame_drives_it() {
    // Frames and writes in their order.
    let kept = "self.claimAdapter = async () => ({ found: [], write(bytes) { self.kept.push(bytes); return true; } });
        self.kept = [];";
    js_sys::eval(kept).unwrap();
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    let seen = Rc::new(std::cell::RefCell::new(None));
    let on_frame = {
        let seen = Rc::clone(&seen);
        move |frame: &[u8]| {
            if matches!(frame, [1, 0x64, ..]) && seen.borrow().is_none() {
                let kept: js_sys::Array = js_sys::eval("self.kept").unwrap().into();
                let last = js_sys::Uint8Array::new(&kept.get(kept.length() - 1)).to_vec();
                let left = LeftBehind::of_file(&last).unwrap().unwrap();
                *seen.borrow_mut() = Some(left.motors.iter().any(|motor| motor.id == ONE));
            }
        }
    };
    *port.on_frame.borrow_mut() = Some(Box::new(on_frame));
    driving(&bench, &port).await;
    assert_eq!(*seen.borrow(), Some(true));
    without_files();
}

#[wasm_bindgen_test]
async fn a_browser_without_files_drives_and_says_so_once() {
    without_files();
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    driving(&bench, &port).await;
    bench.command(Command::StopAll(StopReason::Operator));
    bench.until("a stop", |_| port.speed(1).abs() < 1.0).await;
    let told = bench.notices().into_iter();
    assert_eq!(
        told.filter(|notice| *notice == Notice::NotRemembered)
            .count(),
        1
    );
}

#[wasm_bindgen_test]
async fn a_port_that_is_busy_for_a_second_opens_without_a_word() {
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    port.refuse("NetworkError", 20);
    bench.plug(&port);
    bench.connect();
    bench.until_connected().await;
}

#[wasm_bindgen_test]
async fn a_port_that_stays_busy_is_named_after_two_seconds() {
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    port.refuse("NetworkError", 1_000);
    bench.plug(&port);
    let began = bench.now();
    bench.connect();
    let failed = |bench: &Bench| matches!(bench.connection(), Connection::Failed(_));
    bench.until("the failure", failed).await;
    let took = bench.now().since(began);
    assert_eq!(
        bench.connection(),
        Connection::Failed(ConnectError::OpenFailed)
    );
    assert!(took >= Duration::from_secs(2), "{took:?}");
    assert!(took < Duration::from_millis(2_600), "{took:?}");
}

#[wasm_bindgen_test]
async fn a_port_that_the_browser_forbids_is_named_at_once() {
    for name in ["SecurityError", "NotAllowedError"] {
        let bench = Bench::new();
        let port = bench.port(CH340, &[1]);
        port.refuse(name, 1);
        bench.plug(&port);
        bench.connect();
        let failed = |bench: &Bench| matches!(bench.connection(), Connection::Failed(_));
        bench.until("the failure", failed).await;
        assert_eq!(
            bench.connection(),
            Connection::Failed(ConnectError::Forbidden)
        );
        assert_eq!(port.opened(), Some(0.0));
    }
}

#[wasm_bindgen_test]
async fn a_read_that_never_ends_does_not_keep_the_port_from_being_opened_again() {
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    port.hang();
    bench.plug(&port);
    bench.connect();
    bench.until_connected().await;
    bench.send(ToWorker::Disconnect);
    let closed = |bench: &Bench| bench.connection() == Connection::Disconnected;
    bench.until("the end", closed).await;
    bench.connect();
    bench.until_connected().await;
}

#[wasm_bindgen_test]
async fn a_port_whose_stream_is_renewed_after_an_overrun_stays_open_and_the_cause_is_counted() {
    let bench = Bench::new();
    let port = bench.port(CH340, &[1]);
    driving(&bench, &port).await;
    for (name, error, count) in [
        ("BufferOverrunError", LineError::Overrun, 1),
        ("FramingError", LineError::Framing, 2),
    ] {
        port.fail(name, Some(50));
        bench.pause(Duration::from_millis(1_100)).await;
        assert!(matches!(bench.connection(), Connection::Connected(_)));
        let told = Notice::LineError { error, count };
        assert!(bench.notices().contains(&told), "{:?}", bench.notices());
    }
    assert_eq!(port.opened(), Some(1.0));
}

#[wasm_bindgen_test]
async fn a_motor_that_gets_power_after_connect_is_found_and_nothing_is_said_twice() {
    let bench = Bench::new();
    let port = bench.port(CH340, &[7]);
    let seven = MotorId::new(7).unwrap();
    let power = |on| port.world.borrow_mut().motor_mut(seven).unwrap().power(on);
    power(false);
    bench.plug(&port);
    bench.connect();
    bench.until_connected().await;
    bench.pause(Duration::from_millis(2_500)).await;
    power(true);
    let found = Notice::IdQueryEnded(IdQueryOutcome::One(seven));
    bench
        .until("motor 7", |bench| bench.notices().contains(&found))
        .await;
    let silent = Notice::IdQueryEnded(IdQueryOutcome::NoReply);
    let told = bench.notices().into_iter();
    assert_eq!(told.filter(|notice| *notice == silent).count(), 1);
}
