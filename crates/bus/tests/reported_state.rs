//! The refusals that follow from the reported state are those of the bus.

use motorlink_bus::{
    Command, Consent, GroupSetpoints, MotorStatus, Refusal, ReportedState, StopReason,
};
use motorlink_protocol::{Mode, MotorId, Setpoint};
use motorlink_simulator::WorldConfig;

use crate::fixture::{Fixture, ID, amps, degrees, drive_frame, every, id, ms, raw, rpm};

const MODES: [Mode; 3] = [Mode::Velocity, Mode::Current, Mode::Position];

/// What brings the line into a state.
type State = fn(&mut Fixture);

/// Each state, by its name.
const STATES: [(&str, State); 14] = [
    ("idle", |_| {}),
    ("in the current loop", |it| it.switch(Mode::Current)),
    ("in the position loop", |it| it.switch(Mode::Position)),
    ("driven", |it| drives(it, 50)),
    ("driven slowly", |it| drives(it, 5)),
    ("stopping", |it| {
        drives(it, 200);
        it.command(Command::Stop(ID)).unwrap();
        it.run(ms(50));
    }),
    ("switching", |it| {
        let mode = Mode::Current;
        it.command(Command::SwitchMode { id: ID, mode }).unwrap();
        it.run(ms(10));
    }),
    ("halted", |it| {
        it.command(Command::StopAll(StopReason::Operator)).unwrap();
        it.run(ms(1_000));
    }),
    ("scanning", |it| {
        it.command(Command::FullScan).unwrap();
        it.run(ms(100));
    }),
    ("driven by a raw frame", |it| {
        let frame = drive_frame(ID, rpm(10));
        it.command(raw(frame, every(0, 20))).unwrap();
        it.run(ms(300));
    }),
    ("faulty", |it| {
        it.world.motor_mut(ID).unwrap().break_encoder(true);
        it.run(ms(300));
    }),
    ("silent for 0.6 s", |it| {
        it.world.motor_mut(ID).unwrap().power(false);
        it.run(ms(600));
    }),
    ("silent", |it| {
        it.world.motor_mut(ID).unwrap().power(false);
        it.run(ms(3_000));
    }),
    ("driven and silent for 0.1 s", |it| {
        drives(it, 5);
        it.world.motor_mut(ID).unwrap().power(false);
        it.run(ms(100));
    }),
];

fn drives(fixture: &mut Fixture, speed: i32) {
    fixture.drive(rpm(speed)).unwrap();
    fixture.run(ms(1_500));
}

fn setpoint(mode: Mode) -> Setpoint {
    match mode {
        Mode::Current => amps(0.3),
        Mode::Position => degrees(40.0),
        _ => rpm(20),
    }
}

fn in_state(state: State) -> (Fixture, Vec<MotorStatus>) {
    let ids = [ID, id(2)];
    let mut fixture = Fixture::watching(WorldConfig::with_ids(ids), &ids);
    state(&mut fixture);
    let motors = fixture.bus.motors(fixture.now).collect();
    (fixture, motors)
}

fn check_group(state: &ReportedState<'_>, mode: Mode) -> Result<(), Refusal> {
    let mut ids = [ID, id(2)].into_iter();
    ids.try_for_each(|id| state.check_member(id, mode))
}

fn check_scan(state: &ReportedState<'_>) -> Result<(), Refusal> {
    state.check_scan()
}

/// What is said beforehand, and what the bus says.
fn both(
    state: State,
    check: impl Fn(&ReportedState<'_>) -> Result<(), Refusal>,
    command: Command,
) -> [Result<(), Refusal>; 2] {
    let (mut fixture, motors) = in_state(state);
    let before = check(&ReportedState {
        now: fixture.now,
        model: fixture.bus.model(),
        halted: fixture.bus.is_halted(),
        has_job: fixture.bus.job().is_some(),
        motors: &motors,
    });
    [before, fixture.command(command)]
}

#[test]
fn a_motor_is_refused_beforehand_for_the_reason_of_the_bus() {
    let consent = Consent::None;
    let (mut allowed, mut refused) = (0, 0);
    for (name, state) in STATES {
        for mode in MODES {
            let setpoint = setpoint(mode);
            let drive = Command::Drive {
                id: ID,
                setpoint,
                consent,
            };
            let switch = Command::SwitchMode { id: ID, mode };
            let setpoints = GroupSetpoints::new(&[(ID, setpoint), (id(2), setpoint)]).unwrap();
            let group = Command::DriveGroup { setpoints, consent };
            let found = [
                both(state, |it| it.check_drive(ID, mode), drive),
                both(state, |it| it.check_switch(ID, mode), switch),
                both(state, |it| check_group(it, mode), group),
            ];
            for (what, [before, bus]) in ["drive", "switch", "group"].iter().zip(found) {
                assert_eq!(before, bus, "{what}, {name}, to the {mode}");
                allowed += usize::from(bus.is_ok());
                refused += usize::from(bus.is_err());
            }
        }
    }
    assert!(allowed > 20 && refused > 60, "{allowed} {refused}");
}

#[test]
fn scans_and_raw_frames_are_refused_beforehand_for_the_reason_of_the_bus() {
    let hazard = raw(drive_frame(id(2), rpm(10)), every(1, 20));
    let query = raw(
        motorlink_protocol::Request::Query { id: ID }.frame(),
        every(1, 20),
    );
    for (name, state) in STATES {
        let scan = both(state, check_scan, Command::FullScan);
        assert_eq!(scan[0], scan[1], "{name}");
        let [before, bus] = both(state, |it| it.check_raw(false), query);
        let runs = bus == Err(Refusal::RawRunning);
        assert!(runs || before == bus, "{name}: {before:?} {bus:?}");
        // The bytes of a hazardous frame can be refused for more.
        let [before, bus] = both(state, |it| it.check_raw(true), hazard);
        assert!(
            before.is_ok() || before == bus,
            "{name}: {before:?} {bus:?}"
        );
    }
}

#[test]
fn a_motor_that_was_never_heard_is_not_driven() {
    let ninth: MotorId = id(9);
    let drive = Command::Drive {
        id: ninth,
        setpoint: rpm(20),
        consent: Consent::None,
    };
    let [before, bus] = both(|_| {}, |it| it.check_drive(ninth, Mode::Velocity), drive);
    assert_eq!(before, bus);
    assert_eq!(bus, Err(Refusal::NotAnswering(ninth)));
}
